#!/bin/sh
# 27_losses: what the loss of a process costs with a scene of 1 GB (default lattice:134; SCENE=NAME:SIZE). Columns:
# MB of the scene; seconds from the start of `deal fan -1 -j 2 rtworker` to the first pixels; from the kill of the two
# processes that render to the next pixels; from the kill of the worker, which holds the scene, to the next pixels.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"

scene=${SCENE:-lattice:134}
spdgen -s "${scene#*:}" "${scene%:*}" >scene.nff || stop 'spdgen failed'
{ pack scene scene.nff; partition -u tile:64x64 1024x1024; } >tasks
mkfifo in
children() { ps -o pid= --ppid "$1" | tr -d " "; }
done_now() { grep -aoE '^done 0 [0-9]+ ' out | sort -u | wc -l; }
# next N: waits until N tasks are done
next() {
	until [ "$(done_now)" -ge "$1" ]; do
		kill -0 "$fan" 2>/dev/null || stop "the run has ended: $(cat said)"
		sleep .05
	done
}
# since S: the seconds that have passed since then
since() { echo "$1 $(date +%s.%N)" | awk '{ printf "%.1f", $2 - $1 }'; }
# after PID ...: kills the processes, and prints the seconds to the next pixels
after() {
	begin=$(date +%s.%N)
	kill -KILL "$@"
	sleep .2 # what they had sent before arrives
	next $(($(done_now) + 1))
	since "$begin"
}
begin=$(date +%s.%N)
deal fan -1 -j 2 rtworker -a "${SAMPLES:-100}" - <in >out 2>said &
deal=$!
exec 9>in
cat tasks >&9 &
fan=$(until children $deal | grep .; do sleep .05; done)
next 1
first=$(since "$begin")
next 3
worker=$(children "$fan")
# shellcheck disable=SC2046  # a word each
child=$(after $(children "$worker")) || exit
next $(($(done_now) + 2))
whole=$(after "$worker") || exit
printf 'scene\tMB\tstart s\tchildren killed s\tworker killed s\n%s\t%d\t%s\t%s\t%s\n' "$scene" \
	$(($(wc -c <scene.nff) / 1000000)) "$first" "$child" "$whole"
kill -KILL $deal
