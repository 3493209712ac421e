#!/bin/sh
# 95_scene_views: FRAMES (100) views of gears of size 9, a turn round it: as views of one scene, by one rtworker and by
# balance adaptive on two slots; and by that as it was before, a scene of its own for each frame. All are compared with the
# time of their rays, as the tasks say it, and one build of the scene by two threads: in CPU seconds, which load changes less,
# and in wall time. Then the latency of a chain that stays alive: from a view record to the last pixel of its 64x64 picture,
# the median of the frames. Target: 1.1 times rays and build. Needs a machine without other load.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
frames=${FRAMES:-100} size=${SIZE:-512x512} frame=$(echo "$size" | tr x ' ')

spdgen -s 9 gears >gears.nff || exit 3
grep -E '^(from|at|up|angle|hither) ' gears.nff >key0.view
for turn in 1 2 3; do
	awk '/^from/ { print "from", -$3, $2, $4; next } { print }' key$((turn - 1)).view >key$turn.view
done
views -c -n "$frames" -o v%03d.view key?.view || exit 3
for n in $(seq 0 $((frames - 1))); do echo "frame $n $frame"; done >frames

# each FRAME: the scene with the view of the frame in the place of its own
each() {
	awk 'FILENAME != "gears.nff" { word[$1] = $0; next } $1 in word { print word[$1]; next } { print }' \
		"v$(printf %03d "$1").view" gears.nff
}
old() {
	while read -r line; do
		# shellcheck disable=SC2086  # words
		set -- $line
		each "$2" | pack scene -
		echo "$line"
	done <frames
}
new() { job -e frames gears.nff v*.view; }

# measure STATES CHAIN: prints CPU and wall seconds of the film, and the CPU seconds of its rays
measure() {
	rm -f log states && mkfifo states || exit 3
	"$1" >states 2>said &
	begin=$(date +%s.%N)
	cpu=$(pin='' && cpu_s 1 "$2 | gather -r log -o x%03d.pfm") || stop "$2 failed"
	end=$(date +%s.%N)
	wait
	echo "$cpu $begin $end $(fragstat -s log | awk '$1 == "cpu_s" { print $2 }')" | awk '{ print $1, $3 - $2, $4 }'
}
built cpu
partition -u run:1 1x1 >one.task
build=$(pin='' && cpu_s 1 'rtworker -j 2 gears.nff <one.task') && build_wall=$(wall_s 'rtworker -j 2 gears.nff <one.task') || exit 3
echo "frames  way        CPU s  wall s  rays CPU s  build CPU s  CPU / (rays + build)  wall / (rays / slots + build)"
adaptive="balance-adaptive $size@states 2 /dev/null fan -1 -j 2 rtworker </dev/null"
for way in alone new old; do
	case $way in
	alone) measure new "partition $size@states | rtworker" ;;
	*) measure $way "$adaptive" ;;
	esac | awk -v way=$way -v n="$frames" -v b="$build" -v w="$build_wall" -v slots="$([ $way = alone ] && echo 1 || echo 2)" '{
		printf "%6d  %-6s %9.2f %7.2f %11.2f %12.2f %21.3f %30.3f\n", n, way, $1, $2, $3, b, $1 / ($3 + b), $2 / ($3 / slots + w) }'
	md5sum x*.pfm >$way.sums
done | tee all
cmp new.sums old.sums && cmp new.sums alone.sums || stop 'the pictures differ'
report 'CPU of views of one scene / (rays + one build)' "$(awk '$2 == "new" { print $7 }' all)" '' 1.1
report 'wall time of views of one scene / (rays / slots + one build)' "$(awk '$2 == "new" { print $8 }' all)" '' 1.1

# ---- one view after the other, in a chain that stays alive --------------------------------------------------------
mkfifo to && : >from
deal -q auto -e fan -1 -j 2 rtworker <to >from &
exec 9>to
pack scene gears.nff >&9
n=0
for view in v*.view; do
	begin=$(date +%s%N)
	{ pack view "$view"; partition -F $n -u tile:16x16 64x64; } >&9
	until [ "$(grep -ac "^done $n " from)" -ge 16 ]; do :; done
	[ $n -eq 0 ] || echo $((($(date +%s%N) - begin) / 1000))
	n=$((n + 1))
done >latency
exec 9>&-
wait
printf 'from a view record to its last pixel, 64x64: median %s ms\n' "$(median 1 <latency | awk '{ print $1 / 1000 }')"
