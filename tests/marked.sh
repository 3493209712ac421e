# For tests that watch processes. Read it after lib.sh. Processes started with MARK=$mark in their environment keep it,
# and so do their children. No shell of the test itself has the mark. At the end the processes that remain are killed.
# shellcheck shell=sh disable=SC2034,SC2154
mark=stormring-test-$$
# alive: prints the pids of processes with the mark
alive() {
	for p in $(grep -lz "^MARK=$mark\$" /proc/[0-9]*/environ 2>/dev/null); do
		p=${p#/proc/}
		echo "${p%/environ}"
	done
}
# program NAME [WORDS]: prints those with this name whose command line begins with WORDS
program() {
	for p in $(alive); do
		comm=''
		{ read -r comm <"/proc/$p/comm"; } 2>/dev/null
		[ "$comm" = "$1" ] || continue
		[ -z "${2-}" ] || case $(tr '\0' ' ' <"/proc/$p/cmdline") in "$2"*) ;; *) continue ;; esac
		echo "$p"
	done
}
now_ms() { echo $(($(date +%s%N) / 1000000)); }
vain() { echo "$1" >>"$tmp/.vain"; diag "$1" >&2; } # MESSAGE: the test has failed
# Load decides all times, so no test fails because of seconds. SECONDS is the limit on an idle machine; a loaded one gets
# forty times as long. Processes that must not end by themselves meanwhile have work for hours.
await() { # SECONDS COMMAND ...: waits until the command succeeds; a test that waits in vain fails, also in a subshell
	await_left=$(($1 * 800))
	shift
	until "$@"; do
		if [ $((await_left -= 1)) -lt 0 ]; then
			vain "waited in vain: $*"
			return 1
		fi
		sleep .05
	done
}
# in_time COMMAND ...: runs the command; a test whose command goes on for 20 minutes fails
in_time() {
	in_time_status=0
	timeout 1200 "$@" || in_time_status=$?
	[ $in_time_status -ne 124 ] || vain "had no end: $*"
	return $in_time_status
}
# never_waits ERE LOG: the run did not wait until a slot was lost. `said` has no such message, or the log has tasks that were done
# after the loss, as on a loaded machine.
never_waits() { ! grep -Eq "$1" said || [ "$(grep -aE '^(done|gone) ' "$2" | tail -n 1 | cut -c 1-4)" = 'done' ]; }
# unexpected FILE: prints the messages of a run without those that load alone can cause: a slot that gets no processor for
# seconds is lost and connected again, or never connects before the others have done the work
unexpected() { grep -vE 'lost [(]silent[)] with [0-9]+ tasks, (connecting|forked) again$|: is up$|never connected$' "$1"; }
none_alive() { [ -z "$(alive)" ]; }
working() { [ "$(program rtworker | wc -l)" -ge "$1" ]; }
# wrap WORKER DIRECTORY: makes the directory, which has all programs. Where its worker is to render, and not to print a job or
# to be listed by fan, it runs the script on standard input. With patience=SECONDS in the environment, its fan waits that long
# for silent slots: workers that a script holds back are silent, on a loaded machine for long.
wrap() {
	all_in "$2"
	rm "$2/$1" "$2/fan"
	# shellcheck disable=SC2016  # for the scripts
	{
		printf '#!/bin/sh\nlisting=$1 && export listing\nexec %s ${patience:+-t "$patience"} "$@"\n' "'$root/bin/fan'" >"$2/fan"
		printf '#!/bin/sh\ncase " ${listing-} $* " in *" -i "* | *" -l"*) exec %s "$@" ;; esac\n' "'$root/bin/$1'"
		cat
	} >"$2/$1"
	chmod +x "$2/$1" "$2/fan"
}
# hold_rtworker: makes the directory holding. Its rtworker holds back what it has to say after 2000 bytes, until the file go
# is there. So whatever the load, held workers have tasks when a test goes on, and the run is not over.
hold_rtworker() {
	wrap rtworker holding <<-END
		'$root/bin/rtworker' "\$@" | {
			dd bs=1 count=2000 2>'$tmp/dd.said'
			: >'$tmp/held.'\$\$
			until [ -e '$tmp/go' ]; do sleep .05; done
			cat
		}
	END
}
held() { [ "$(find "$tmp" -maxdepth 1 -name 'held.*' | wc -l)" -ge "$1" ]; } # this many workers
held_workers() { program rtworker "$root/bin/rtworker"; } # not the scripts around them
end_all() { for p in $(alive); do kill -9 "$p"; done 2>/dev/null; }
trap 'end_all; rm -rf "$tmp"' EXIT
