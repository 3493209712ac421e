#!/bin/sh
# 95_stormview [SIDE]: looking around in the wind with scenes/wind-smooth.spec at SIDE (512) pixels while the mouse drags
# at 60 events a second for DRAG (5) seconds: milliseconds from an input to the first coarse picture, median and 95th
# percentile, and to the whole one; shares of pixels that came too late. On two slots here, over links of 10 and of 50 ms
# each way, and, as root, on four test hosts. Then 20 whole pictures, and the same tasks without the viewer. WHERE names
# some of the cases.
where=${WHERE:-here 10ms 50ms hosts} hosts=$(cd "$(dirname "$0")/.." && pwd)/hosts
case "${TEST_HOSTS-} $where $(id -u)" in ' '*hosts*' 0') exec "$hosts" with 4 "$0" "$@" ;; esac
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
side=${1:-512} drag=${DRAG:-5}
built delay
nc2vtk -c -o wind.vtk /usr/share/ncarg/data/cdf/nc4uvt.nc 'speed=hypot(U,V)' || stop 'nc4uvt.nc'
awk -v s="$drag" 'BEGIN {
	print "0 rest"
	for (i = 0; i < 60 * s; i++) printf "%.3f drag %d %d\n", i * 1000 / 60, 3 + i % 3, i % 5 - 2
	printf "%.3f rest\n", s * 1000 }' >drags
awk 'BEGIN { for (i = 0; i < 20; i++) print "0 key right\n0 rest" }' >turns
for ms in 10 50; do echo "apart slots=2 via=\"$tmp/delay $ms sh -c %c\"" >${ms}ms; done

# view EVENTS OPTIONS: runs stormview; leaves its figures in the file times
view() {
	stormview -e "$1" -t times -s "${side}x$side" wind.vtk "$root/scenes/wind-smooth.spec" \
		sh -c "tee down | $rules fan $2 vcworker" >look.spec || stop "$2 failed"
}
# value NAME
value() { awk -v name="$1" '$1 == name { print $2; found = 1 } END { if (!found) print "-" }' times; }
rules=$(sed -n 's/.*\(deal -.*\) fan.*/\1/p' "$root/bin/view.sh")
[ -n "$rules" ] || stop 'bin/view.sh has no rules'
echo '| where | views | coarse ms | p95 | whole ms | too late |'
echo '| --- | ---: | ---: | ---: | ---: | ---: |'
for place in $where; do
	at="-1 -S $place"
	[ "$place" != here ] || at='-j 2'
	if [ "$place" = hosts ]; then
		[ -n "${TEST_HOSTS-}" ] || { echo '| hosts | not without root | | | | |'; continue; }
		at="-1 -S $TEST_HOSTS/hosts"
	fi
	view drags "$at"
	echo "$place $(value views) $(value coarse_median_ms) $(value coarse_p95_ms) $(value whole_median_ms) $(value stale_pixels) $(value pixels)" |
		awk '{ printf "| %s | %d | %.0f | %.0f | %.0f | %.0f %% |\n", $1, $2, $3, $4, $5, 100 * $6 / $7 }'
	[ "$place" != here ] || { coarse=$(value coarse_median_ms) p95=$(value coarse_p95_ms); }
done
echo
case " $where " in
*' here '*)
	begin=$(date +%s.%N)
	view turns "-j 2"
	with=$(echo "$begin $(date +%s.%N)" | awk '{ print $2 - $1 }')
	cp down again # without a bye, which would end the command at once
	[ "$(tail -c 4 again)" != bye ] || head -c -4 down >again
	alone=$(wall_s "$rules fan -j 2 vcworker <again >frags")
	report 'milliseconds to the coarse picture, median' "$coarse" '' 50
	report 'milliseconds to the coarse picture, 95th percentile' "$p95" '' 100
	report '20 whole pictures, beside the same tasks without the viewer' "$(echo "$with $alone" | awk '{ print $1 / $2 }')" '' 1.3
	;;
esac
