# For tests that watch processes. Read it after lib.sh. Processes started with MARK=$mark in their environment keep it,
# and so do their children. No shell of the test itself has the mark. At the end the processes that remain are killed.
# shellcheck shell=sh disable=SC2154
mark=stormring-test-$$
# alive: prints the pids of processes with the mark
alive() { grep -lz "^MARK=$mark\$" /proc/[0-9]*/environ 2>/dev/null | sed 's,/proc/\(.*\)/environ,\1,'; }
# program NAME [WORDS]: prints those with this name whose command line begins with WORDS
program() {
	for p in $(alive); do
		[ "$(cat "/proc/$p/comm" 2>/dev/null)" = "$1" ] || continue
		case $(tr '\0' ' ' <"/proc/$p/cmdline") in "${2-}"*) echo "$p" ;; esac
	done
}
now_ms() { echo $(($(date +%s%N) / 1000000)); }
# Load decides all times, so no test fails because of seconds. SECONDS is the limit on an idle machine; a loaded one gets
# forty times as long. Processes that must not end by themselves meanwhile have work for hours.
await() { # SECONDS COMMAND ...: waits until the command succeeds
	await_end=$(($(now_ms) + $1 * 40000))
	shift
	until "$@"; do
		[ "$(now_ms)" -lt $await_end ] || return 1
		sleep .05
	done
}
# unexpected FILE: prints the messages of a run without those that load alone can cause: a slot that gets no processor for
# seconds is lost and connected again, or never connects before the others have done the work
unexpected() { grep -vE 'lost [(]silent[)] with [0-9]+ tasks, connecting again$|: is up$|never connected$' "$1"; }
none_alive() { [ -z "$(alive)" ]; }
working() { [ "$(program rtworker | wc -l)" -ge "$1" ]; }
# wrap_rtworker: makes ./bin, which has all programs. Where its rtworker is to render, and not to print a job or to be listed
# by fan, it runs the script on standard input.
wrap_rtworker() {
	mkdir bin
	cp "$root"/bin/balance* "$root/bin/stormring.sh" bin
	for program in "$root"/bin/*; do [ -e "bin/${program##*/}" ] || ln -s "$program" bin; done
	rm bin/rtworker bin/fan
	# shellcheck disable=SC2016  # for the scripts
	{
		printf '#!/bin/sh\nlisting=$1 && export listing\nexec %s "$@"\n' "'$root/bin/fan'" >bin/fan
		printf '#!/bin/sh\ncase " ${listing-} $* " in *" -i "* | *" -l"*) exec %s "$@" ;; esac\n' "'$root/bin/rtworker'"
		cat
	} >bin/rtworker
	chmod +x bin/rtworker bin/fan
}
end_all() { for p in $(alive); do kill -9 "$p"; done 2>/dev/null; }
trap 'end_all; rm -rf "$tmp"' EXIT
