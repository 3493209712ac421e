# For tests that need test hosts. Begin with `want_hosts=N` and `. "$(dirname "$0")/hosts.sh"` in the place of lib.sh.
# The test starts again among N hosts (0: without hosts), or is skipped if test hosts are impossible. hosts.sh reads
# lib.sh and marked.sh.
# shellcheck shell=sh disable=SC2034,SC2154
tests=$(cd "$(dirname "$0")" && pwd) && tests=${tests%/tests*}/tests || exit 3
hosts() { "$tests/hosts" "$@"; }
why=$(hosts check 2>&1) || { echo "1..0 # SKIP $why"; exit 0; }
[ -n "${TEST_HOSTS-}" ] || [ "$want_hosts" -eq 0 ] || exec "$tests/hosts" with "$want_hosts" "$0"
. "$tests/lib.sh"
. "$tests/marked.sh"

# Powers of which one machine has enough; where they cannot be set, all have the same.
unequal() {
	for power in 'host1 .4' 'host2 .25' 'host3 .1'; do
		# shellcheck disable=SC2086
		hosts power $power 2>"$tmp/.said" || { diag "$(cat "$tmp/.said")"; break; }
	done
}
# put HOST FILE: standard input becomes a program there
put() { hosts run "$1" sh -c 'cat >"$1" && chmod +x "$1"' put "$2"; }
