# TAP for shell tests. A test begins with `. "$(dirname "$0")/lib.sh"` and ends with `finish`. It runs in a temporary
# directory $tmp, which every exit removes. $root is the clone, whose programs come first on PATH.
# shellcheck shell=sh disable=SC2034
set -u
root=$(cd "$(dirname "$0")" && pwd) && root=${root%/tests*} tmp=$(mktemp -d) || exit 3
trap 'rm -rf "$tmp"' EXIT
trap 'exit 130' HUP INT TERM PIPE
PATH=${BIN:=$root/bin}:$PATH
cd "$tmp" || exit 3
export XDG_CACHE_HOME=/dev/null # hosts keep no state, unless a test names a directory
tap_n=0 tap_failed=0

# Tests run the programs of the clone, never installed copies. Six programs need a library that may be missing.
for tap_source in "$root"/bin/*.c; do
	tap_program=${tap_source##*/} tap_program=${tap_program%.c}
	case $tap_program in nc2vtk | grib2vtk | mesh2nff | stormview | tsvstat | vol2vtk) continue ;; esac
	[ -x "$BIN/$tap_program" ] || { echo "Bail out! $tap_program is not built, expected \`make\` first"; exit 3; }
done

# Programs get the locale of the caller; the tools of the tests print numbers with a point.
awk() { LC_ALL=C command awk "$@"; }
od() { LC_ALL=C command od "$@"; }
seq() { LC_ALL=C command seq "$@"; }
sort() { LC_ALL=C command sort "$@"; }

diag() { printf '%s\n' "$*" | sed 's/^/# /'; }
pass() { tap_n=$((tap_n + 1)); echo "ok $tap_n - $1"; }
# fail NAME WHY
fail() { tap_n=$((tap_n + 1)) tap_failed=1; echo "not ok $tap_n - $1"; diag "$2"; }
# ok NAME COMMAND ...: the command exits with 0
ok() {
	tap_name=$1; shift
	if "$@" >"$tmp/.said" 2>&1; then pass "$tap_name"
	else fail "$tap_name" "exit $? of: $* $(echo; tail -n 20 "$tmp/.said")"
	fi
}
# is NAME GOT EXPECTED
is() { if [ "$2" = "$3" ]; then pass "$1"; else fail "$1" "got: $2, expected: $3"; fi; }
# like NAME TEXT ERE: a line of the text matches
like() { if printf '%s\n' "$2" | grep -Eq -e "$3"; then pass "$1"; else fail "$1" "no match of $3 in: $2"; fi; }
# run COMMAND ...: leaves the exit status in $status and the output in $out and $err
run() { status=0; "$@" >"$tmp/.out" 2>"$tmp/.err" || status=$?; out=$(cat "$tmp/.out") err=$(cat "$tmp/.err"); }
# there NAME ...: these programs, or files if the name is a path, exist; $missing is the first that does not
there() {
	for missing; do
		case $missing in */*) [ -e "$missing" ] ;; *) command -v "$missing" >/dev/null ;; esac || return
	done
}
# compile NAME: tests/NAME.c, linked with the library of the clone, becomes a program in this directory
compile() {
	# shellcheck disable=SC2046  # a word each
	cc -std=c11 -D_GNU_SOURCE -O -I"$root/lib" -o "$1" "$root/tests/$1.c" "$root/build/libstormring.a" $(cat "$root/build/libs") ||
		{ echo "Bail out! tests/$1.c does not compile"; exit 3; }
}
# all_in DIRECTORY: makes it, with all programs; scripts are copies, because they run the programs beside them
all_in() {
	mkdir "$1"
	cp "$root"/bin/balance* "$root/bin/stormring.sh" "$1"
	for tap_program in "$root"/bin/*; do [ -e "$1/${tap_program##*/}" ] || ln -s "$tap_program" "$1"; done
}
# patient: from now on fan, if it has no -t, waits longer for silent slots. For tests that a lost slot would fail, because a
# static method lacks its pixels, or because of its message: load alone can make a slot silent for the default time.
patient() { make_patient && PATH=$tmp/patient:$PATH; }
# patiently COMMAND ...: the same for one command
patiently() { make_patient && PATH=$tmp/patient:$PATH "$@"; }
make_patient() {
	[ ! -d "$tmp/patient" ] || return 0
	all_in "$tmp/patient"
	rm "$tmp/patient/fan"
	# shellcheck disable=SC2016  # for the script
	printf '#!/bin/sh\ncase ${1-} in --*) ;; *) set -- -t 600 "$@" ;; esac\nexec %s "$@"\n' "'$root/bin/fan'" >"$tmp/patient/fan"
	chmod +x "$tmp/patient/fan"
}
# pov_ray WORD ...: runs POV-Ray, once more where a loaded machine did not start its thread in time
pov_ray() {
	for tap_try in 1 2 3 4 5; do
		tap_status=0
		tap_said=$(povray "$@" 2>&1) || tap_status=$?
		case $tap_said in *'Timed out waiting for worker thread'*) ;; *) break ;; esac
	done
	printf '%s\n' "$tap_said"
	return "$tap_status"
}
# needs NAME ...: skips the whole file of tests if one of them is missing
needs() { there "$@" || { echo "1..0 # SKIP $missing is not there"; exit 0; }; }
# skip NAME WHY: reports a skipped assertion
skip() { tap_n=$((tap_n + 1)); echo "ok $tap_n # SKIP $1: $2"; }
# soaked N: N, for a soak by hand; a tenth, for make nightly
soaked() { if [ "${NIGHT-}" = true ]; then echo $(($1 / 10)); else echo "$1"; fi; }
# finish: after a wait in vain (marked.sh) the test has failed, and says so again, because `run` may hide the first message
finish() { [ ! -e "$tmp/.vain" ] || { tap_failed=1; diag "$(cat "$tmp/.vain")"; }; echo "1..$tap_n"; exit $tap_failed; }
