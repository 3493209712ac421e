# TAP for shell tests. Begin with `. "$(dirname "$0")/lib.sh"`, end with `finish`; the test runs in a
# temporary directory $tmp, removed on every exit; $root is the clone, whose programs come first on PATH.
# shellcheck shell=sh disable=SC2034
set -u
root=$(cd "$(dirname "$0")/.." && pwd) && tmp=$(mktemp -d) || exit 3
trap 'rm -rf "$tmp"' EXIT
trap 'exit 130' HUP INT TERM PIPE
PATH=${BIN:-$root/bin}:$PATH
cd "$tmp" || exit 3
n=0 failures=0

# The clone's programs are tested, never copies installed elsewhere.
for source in "$root"/bin/*.c; do
	name=${source##*/}
	[ -x "${BIN:-$root/bin}/${name%.c}" ] && continue
	echo "Bail out! ${name%.c} is not built, expected \`make\` before the tests"
	exit 3
done

diag() { printf '%s\n' "$*" | sed 's/^/# /'; }
pass() { n=$((n + 1)); echo "ok $n - $1"; }
fail() { # NAME [WHY]
	n=$((n + 1)) failures=$((failures + 1))
	echo "not ok $n - $1"
	[ $# -lt 2 ] || diag "$2"
}
# ok NAME COMMAND ...: it exits 0
ok() { name=$1; shift; if "$@" >"$tmp/.said" 2>&1; then pass "$name"; else fail "$name" "exit $? of: $* $(tail -n 20 "$tmp/.said")"; fi; }
# is NAME GOT EXPECTED
is() { if [ "$2" = "$3" ]; then pass "$1"; else fail "$1" "got: $2
expected: $3"; fi; }
# like NAME TEXT ERE: some line of the text matches
like() { if printf '%s\n' "$2" | grep -Eq -e "$3"; then pass "$1"; else fail "$1" "got: $2
expected a match of: $3"; fi; }
# run COMMAND ...: exit status in $status, output in $out and $err
run() { status=0; "$@" >"$tmp/.out" 2>"$tmp/.err" || status=$?; out=$(cat "$tmp/.out") err=$(cat "$tmp/.err"); }
# skip NAME WHY
skip() { n=$((n + 1)); echo "ok $n # SKIP $1: $2"; }
finish() { echo "1..$n"; exit $((failures > 0)); }
