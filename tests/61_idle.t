#!/bin/sh
# Invariant 4 for idle chains: a stage that waits for work notices at once that its reader has gone, and uses no
# processor time while it waits.
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"

spdgen -s 1 tetra >tetra.nff
some_alive() { [ "$(alive | wc -l)" -ge "$1" ]; }
# ticks: prints the clock ticks of CPU time of all processes with the mark
ticks() { for p in $(alive); do cut -d ' ' -f 14,15 "/proc/$p/stat"; done 2>/dev/null | awk '{ n += $1 + $2 } END { print n }'; }

# In some second, as it takes a loaded machine a while to start them all.
costs_nothing() {
	before=$(ticks)
	sleep 1
	used=$(($(ticks) - before))
	[ $used -le 3 ]
}

mkfifo in out
# idle PROCESSES COMMAND ...: its input stays open and empty, its reader is there, then leaves
idle() {
	want=$1
	shift
	env MARK="$mark" "$@" <in >out 2>said &
	exec 8>in 9<out
	await 5 some_alive "$want"
	await 5 costs_nothing
	ok "$*: waiting takes no CPU time ($used ticks a second)" test $used -le 3
	exec 9<&-
	ok "$*: ends when its reader has gone" await 2 none_alive
	end_all
	wait
	is "$*: no message" "$(cat said)" ""
	exec 8>&-
}
idle 1 rtworker tetra.nff
idle 3 fan -j 2 rtworker tetra.nff
idle 4 deal fan -j 2 rtworker tetra.nff
idle 8 deal fan -j 2 deal fan -j 1 rtworker tetra.nff
finish
