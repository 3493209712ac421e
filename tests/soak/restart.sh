#!/bin/sh
# restart.sh [POINTS [SEED]]: kill -9 of the last stage or of the whole group, at random moments of runs that keep a
# log; then the same command until it is done. The picture is the same, and no task of the log is rendered again.
. "$(dirname "$0")/../lib.sh"
points=${1:-$(soaked 200)} seed=${2:-${FIRST:-$(date +%s)}}
# shellcheck disable=SC2154  # lib.sh sets tmp
trap '[ -z "${pid-}" ] || kill -9 "-$pid" 2>/dev/null; rm -rf "$tmp"' EXIT
# pick N: a number below N, the next of the seed's
pick() { seed=$(((seed * 1103515245 + 12345) % 2147483648)) && picked=$((seed / 65536 % $1)); }
ms() { echo $(($(date +%s%N) / 1000000)); }
spdgen -s 2 gears >gears.nff
patient # no pixel may come twice, and static methods lose those of a lost slot
size=96x96
# start METHOD: in a session of its own, so that its group can be killed
start() { setsid balance "$1" -j 3 -s $size -W '-a 16' -r log -o out.pfm gears.nff 2>>said & pid=$!; }
partition $size | rtworker -a 16 gears.nff | gather -o good.pfm
first=$seed
diag "seed $seed"
set -- interleaved masterslave hybrid gdc ss sc ds dc
for method in "$@"; do
	rm -f log out.pfm
	begin=$(ms)
	start "$method"
	wait "$pid"
	is "$method: not interrupted: exit 0" $? 0
	ok "$method: not interrupted: the picture" cmp out.pfm good.pfm
	took=$(($(ms) - begin)) # the last one's
done

point=0 kills=0 again=0 tasks=0
while [ $((point += 1)) -le "$points" ]; do
	rm -f log out.pfm said
	pick $#
	eval "method=\$$((picked + 1))"
	name="point $point, $method:" tries=0
	while :; do
		start "$method"
		# The first is always killed, the second now and then, the third never.
		pick 3
		if [ $tries = 0 ] || { [ $tries = 1 ] && [ "$picked" = 0 ]; }; then
			pick $((took + 1))
			delay=$picked
			pick 2
			[ "$picked" = 0 ] && whom=-$pid what='the whole group' || whom=$pid what='the last stage'
			sleep "$(printf '%d.%03d' $((delay / 1000)) $((delay % 1000)))"
			name="$name kill -9 of $what after $delay ms,"
			kill -9 "$whom" 2>/dev/null && kills=$((kills + 1))
		fi
		wait "$pid"
		status=$?
		[ $status = 137 ] || break
		[ -e out.pfm ] && ! cmp -s out.pfm good.pfm && fail "$name a whole picture or none" 'another picture'
		tries=$((tries + 1))
	done
	is "$name then the same command: exit 0" "$status" 0
	ok "$name the same picture" cmp out.pfm good.pfm
	# At the end the ring gives a task to more than one node.
	[ "$method" = gdc ] || is "$name no pixel came twice" "$(gather -P -o twice.pfm log 2>&1 | grep -o '[0-9]* pixels came twice.*')" ''
	grep -a -o 'done 0 [0-9]* cpu_us' log >computed
	tasks=$((tasks + $(sort -u computed | wc -l))) again=$((again + $(sort computed | uniq -d | wc -l)))
done
pid=''
diag "$kills kills; of $tasks tasks $again were computed when a kill came and their pixels not logged: done again"
[ "$tap_failed" = 0 ] || fail "to repeat: tests/soak/restart.sh $points $first" ''
finish
