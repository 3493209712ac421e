#!/bin/sh
# 25_copies: memory of workers on one machine, when all tasks of gears 9 are done and the input is still open: the sum of
# their proportional set sizes, for a worker of each slot (fan) and for one worker with as many slots (fan -1). Then the
# elapsed time of whole runs on two slots against one, which needs two idle cores; medians of 3.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"

spdgen -s "${SIZE:-9}" gears >gears.nff || stop 'spdgen failed'
{ pack scene gears.nff; partition 512x512; } >tasks
mkfifo in
descendants() { for p in $(ps -o pid= --ppid "$1"); do echo "$p"; descendants "$p"; done; }
# memory COMMAND ...: prints the MB of the workers
memory() {
	"$@" - <in >out &
	fan=$!
	exec 9>in
	cat tasks >&9
	until [ "$(grep -aoE 'done 0 [0-9]+ ' out | sort -u | wc -l)" -eq 512 ]; do
		kill -0 $fan || stop "failed: $*"
		sleep .2
	done
	sleep .5
	for process in $(descendants $fan); do awk '/^Pss:/ { print $2 }' "/proc/$process/smaps_rollup"; done |
		awk '{ sum += $1 } END { printf "%.0f\n", sum / 1024 }'
	exec 9>&-
	wait $fan || stop "failed: $*"
	gather -o out.png out && { [ -e one.png ] || mv out.png one.png; } || stop 'no picture'
	[ ! -e out.png ] || cmp one.png out.png || stop 'the pictures differ'
}
one=$(memory fan -j 1 rtworker) || exit
printf 'slots\tfan MB\tfan -1 MB\n1\t%s\t%s\n' "$one" "$one"
for slots in 2 4 8; do
	many=$(memory fan -j $slots rtworker) && shared=$(memory fan -1 -j $slots rtworker) || exit
	printf '%s\t%s\t%s\n' $slots "$many" "$shared"
done
report 'memory, 8 slots of one worker / 1' "$(echo "$shared $one" | awk '{ print $1 / $2 }')" '' 1.3
i=0
while [ $((i += 1)) -le 3 ]; do
	echo "$(wall_s "balance adaptive -j 1 -o a.png gears.nff") $(wall_s "balance adaptive -j 2 -o b.png gears.nff")"
done | awk '{ print $2 / $1 }' >ratios
report 'time of a run, 2 slots / 1' "$(median 1 <ratios)" '' .55
