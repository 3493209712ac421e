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
# One build for both. Without _GNU_SOURCE the C library's headers have no more, and a call of what they lack is an error.
ok 'clang builds it by POSIX alone, and warns of nothing' make -s -j2 POSIX=1 BUILD=build/clang-posix CC=clang CFLAGS='-O2 -Werror' all unit
is 'no file gets more' "$(make -n -B POSIX=1 all unit | grep -c GNU_SOURCE)" 0
ok 'nor of what Linux has besides' build clang clang '-O2 -Werror' build/clang/os/linux.o build/clang/crop/confine.o
ok 'programs built by clang are hardened' hardened clang build/clang-posix/bin build/clang-posix
ok 'the pipeline built by clang renders the same bits' same build/clang-posix/bin
if [ -n "${NIGHT-}" ]; then
	ok 'clang warns of nothing, with all that Linux has' build clang clang '-O2 -Werror' all unit
	ok 'gcc builds it by POSIX alone, and warns of nothing' make -s -j2 POSIX=1 CFLAGS='-O2 -Werror' all unit
fi
for unit in build/clang-posix/unit/test_*; do
	case $unit in *.d) continue ;; esac
	# What only computes asks nothing of the system.
	case ${NIGHT-}$unit in build/*/test_trace* | build/*/test_volume* | build/*/test_spd | build/*/test_triangulate) continue ;; esac
	ok "by POSIX: ${unit##*/}" "$unit"
done
# shellcheck disable=SC2329  # run by ok
by_posix() (BIN=$root/build/clang-posix/bin && export BIN && exec "tests/$1.t")
for test in 10_streams 12_partition 30_gather 40_identical; do
	ok "by POSIX: $test" by_posix $test
done
finish
