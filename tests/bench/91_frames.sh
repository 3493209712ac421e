#!/bin/sh
# 91_frames: many pictures in one stream on two workers: a year of the ocean atlas, one grid a month; and a turn round
# the wind, one view each 15 degrees. Both without delay, and over links of 10 ms each way with queues deep enough for
# them. Efficiency is the time of one worker for the whole stream / 2 / the wall time of the run; it is below 1 if each
# worker loads every grid. Median of ROUNDS; STREAMS and WHERE name some of the cases. BEFORE=DIR compares programs of
# another version, in turns.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=${ROUNDS:-5} size=800x600

built delay
month=0
while [ $month -lt 12 ]; do
	nc2vtk -t $month /usr/share/ferret-vis/data/ocean_atlas_subset.nc TEMP >"$(printf 'month%02d.vtk' $month)" || stop 'ocean_atlas_subset.nc'
	month=$((month + 1))
done
nc2vtk /usr/share/ncarg/data/cdf/nc4uvt.nc 'speed=hypot(U,V)' >wind.vtk || stop 'nc4uvt.nc'
cat >atlas.spec <<'END'
from 200 -260 300
at 200 0 -40
up 0 0 1
angle 34
resolution 800 600
scale 1 1 .02
map -2 .1 .2 .8 .002
map 15 .2 .8 .3 .01
map 22 .95 .8 .1 .02
map 30 .95 .2 .1 .06
END
awk 'BEGIN { for (v = 0; v < 24; v++) printf "%02d %.9g %.9g\n", v, 400 * sin(v * atan2(0, -1) / 12), -400 * cos(v * atan2(0, -1) / 12) }' |
	while read -r view x y; do
		sed "s/^from .*/from $x $y 330/; s/^resolution .*/resolution 800 600/" "$root/scenes/wind-smooth.spec" >"view$view.spec"
	done

number=0
for grid in month*.vtk; do
	pack grid "$grid"
	[ $number -gt 0 ] || pack spec atlas.spec
	partition -F $number -u run:1000 $size
	number=$((number + 1))
done >year.task
pack grid wind.vtk >turn.task
number=0
for view in view*.spec; do
	pack spec "$view"
	partition -F $number -u run:1000 $size
	number=$((number + 1))
done >>turn.task
echo ': slots=2' >here
echo "apart slots=2 via=\"$tmp/delay 10 sh -c %c\"" >apart

# run PROGRAMS STREAM WHERE: prints the wall time
run() {
	q=0
	[ "$3" = here ] || q=128
	PATH=$1:$PATH wall_s "deal -q $q fan -S $3 vcworker <$2.task | gather -o x%d.pfm" || stop "$2 $3 failed"
}
printf 'stream  where   one worker s  now s  efficiency%s\n' "${BEFORE:+  before s  efficiency  before/now}"
for stream in ${STREAMS:-year turn}; do
	for where in ${WHERE:-here apart}; do
		: >now
		: >before
		: >alone
		i=0
		while [ $((i += 1)) -le "$rounds" ]; do
			wall_s "$pin vcworker <$stream.task >alone.frags" >>alone
			run "$root/bin" $stream $where >>now
			[ -z "${BEFORE-}" ] || run "$BEFORE" $stream $where >>before
		done
		for f in alone now before; do [ ! -s $f ] || median 1 <$f; done | paste -s -d ' ' | awk -v s=$stream -v w=$where '{
			printf "%-7s %-6s %13.2f %6.2f %11.3f", s, w, $1, $2, $1 / 2 / $2
			if (NF > 2) printf "%10.2f %11.3f %11.3f", $3, $1 / 2 / $3, $3 / $2
			print "" }'
	done
done
