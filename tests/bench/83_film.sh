#!/bin/sh
# 83_film: 30 frames of a moving camera on the 14 workstations of the GDC paper, one of half and one of a third more
# power, by the shipped methods and real processes: replay waits as long as each pixel of gears took on one worker here.
# A frame takes SECONDS_A_FRAME (1). Two frames are under way at once, so the tasks of the next one fill the end of each. The
# table has lower bound / makespan, where the bound knows all costs; 14 start-ups on two processors are left out.
# Target: adaptive within 1.5 % of the bound.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
frames=30 size=256x256 power=13.789
spdgen -s 2 gears >gears.nff || exit 3
for n in $(seq 0 $((frames - 1))); do
	awk -v angle="$(echo "$n" | awk '{ print $1 * .05 }')" '
		/^from/ { print "from", $2 * cos(angle) - $3 * sin(angle), $2 * sin(angle) + $3 * cos(angle), $4; next }
		{ print }' gears.nff >frame.nff && pack scene frame.nff && echo "frame $n 256 256" || exit 3
done >states
# shellcheck disable=SC2154  # lib.sh sets pin
partition -u run:256 $size@states | $pin rtworker - >one.frags || stop 'rtworker failed'
scale=$(fragstat -s one.frags | awk -v s="$((frames * ${SECONDS_A_FRAME:-1}))" -v p=$power '$1 == "cpu_s" { print s * p / $2 }')
workstation_hosts >hosts
for method in ${METHODS:-interleaved masterslave adaptive}; do
	rm -f run.frags
	"balance-$method" $size@states 14 /dev/null fan -S hosts replay -x "$scale" one.frags </dev/null |
		gather -r run.frags -o x%02d.png || stop "$method failed"
	fragstat -s -S hosts run.frags | awk -F '\t' -v method="$method" '{ v[$1] = $2 } END {
		print method, v["bound_s"] / (v["makespan_s"] - v["startup_s"] / v["slots"]) }'
done | tee all
awk '$1 == "adaptive" { printf "adaptive, %d frames: %.4f of the bound, target .985: %s\n", '$frames', $2, ($2 >= .985 ? "met" : "MISSED") }' all
