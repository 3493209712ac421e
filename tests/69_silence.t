#!/bin/sh
# A worker whose sshd is stopped, or whose host is cut off, sees no end of its input and no error of its output. It ends by
# itself after the silence that fan states. The sshd of this test is tests/relay, which is stopped.
. "$(dirname "$0")/lib.sh"
# shellcheck source=tests/marked.sh
. "$root/tests/marked.sh"

# shellcheck disable=SC2154  # lib.sh sets them
spdgen -s 2 tetra >tetra.nff
ln -s "$root/tests/relay" relay
partition 64x64 >job.task
rtworker tetra.nff <job.task | gather -o good.pfm
# pids DIR: those of both cat of the relay
pids() { cat "$1/pids"; }
# stop DIR: stops them
stop() { for p in $(pids "$1"); do kill -STOP "$p"; done; }
continue_all() { for d in relay?*; do [ ! -e "$d/pids" ] || for p in $(pids "$d"); do kill -CONT "$p"; done; done 2>/dev/null; }
stopped() { for p in $(pids "$1"); do grep -q '^State:.T' "/proc/$p/status" || return; done; }
up() { [ "$(grep -a -c '^up ' events)" -ge "$1" ]; }
# ended PID ...: no such process runs; a dead one may wait to be reaped
ended() { for p; do [ -z "$(tr -d "\0" <"/proc/$p/cmdline")" ] || return; done 2>/dev/null; }
# cut NAME OPTIONS WORKER ...: stops the relay of an idle worker, which must end while the relay stands
cut() {
	name=$1 options=$2
	shift 2
	rm -rf relay0 events out.pfm
	: >events
	printf 'far slots=2 via="./relay relay0 %%c"\n' >hosts
	[ -n "$options" ] || printf 'far via="./relay relay0 %%c"\n' >hosts
	{
		pack scene tetra.nff
		cat job.task
		await 60 up 1
		await 60 seen_done
		pids=$(program rtworker)
		stop relay0
		await 60 stopped relay0
		# shellcheck disable=SC2086
		if [ -n "$pids" ] && await 120 ended $pids && stopped relay0; then echo ended >verdict; else echo stays >verdict; fi
	} | MARK=$mark deal sh -c "fan -t 1 $options -S hosts $* | tee events" 2>said | gather -o out.pfm 2>>said
	is "$name: the worker ends by itself, under a stopped relay" "$(cat verdict)" ended
	like "$name: it says why" "$(cat relay0/said)" ': nothing came on standard input for 10 s: it ends$'
	ok "$name: the picture is the same" cmp out.pfm good.pfm
	continue_all
	end_all
	await 60 none_alive
}
seen_done() { [ "$(grep -a -c '^done ' events)" -ge 64 ]; }
cut 'an idle worker' '' rtworker -
cut 'a worker of two slots' -1 rtworker -
cut 'a tree' '' deal fan -j 2 rtworker -
finish
