#!/bin/sh
# gcc and clang warn of nothing, clang's programs are hardened, and render the same picture. For gcc's: 02_builds.t.
# The programs that have nothing beyond POSIX.1-2008 pass the unit tests and some others.
. "$(dirname "$0")/lib.sh"
needs gcc clang /usr/include/cmocka.h
. "$root/tests/builds.sh"

# make may have compiled all by gcc without a warning.
strict() {
	cc -v 2>&1 | grep -q '^gcc version' && [ -e build/strict ] && [ -z "$(find lib bin tests/unit -newer build/strict)" ] && return
	build gcc gcc '-O2 -Werror' all unit
}
ok 'gcc warns of nothing' strict
ok 'clang warns of nothing' build clang clang '-O2 -Werror' all unit
ok 'programs built by clang are hardened' hardened clang build/clang/bin build/clang
ok 'the pipeline built by clang renders the same bits' same build/clang/bin

# Without _GNU_SOURCE the C library's headers have no more, and a call of what they lack is an error.
ok 'it builds by POSIX alone, and warns of nothing' make -s -j2 POSIX=1 CFLAGS='-O2 -Werror' all unit
is 'no file gets more' "$(make -n -B POSIX=1 all unit | grep -c GNU_SOURCE)" 0
for unit in build/posix/unit/test_*; do
	case $unit in *.d) continue ;; esac
	ok "by POSIX: ${unit##*/}" "$unit"
done
# shellcheck disable=SC2329  # run by ok
by_posix() (BIN=$root/build/posix/bin && export BIN && exec "tests/$1.t")
for test in 10_streams 12_partition 30_gather 40_identical; do
	ok "by POSIX: $test" by_posix $test
done
finish
