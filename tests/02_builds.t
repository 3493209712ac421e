#!/bin/sh
# The compilers warn of nothing, the programs are hardened, and every build renders the same picture.
. "$(dirname "$0")/lib.sh"
needs gcc clang valgrind /usr/include/cmocka.h
. "$root/tests/builds.sh"

# make check may have compiled all by gcc with -Werror.
gcc=build
strict() {
	cc -v 2>&1 | grep -q '^gcc version' && [ -e build/strict ] && [ -z "$(find lib bin tests/unit -newer build/strict)" ] && return
	gcc=build/gcc
	build gcc gcc '-O2 -Werror' all unit
}
ok 'gcc warns of nothing' strict
# It compiles the unit tests in 02_sanitized.t.
ok 'clang warns of nothing' build clang clang '-O2 -Werror'

# hardened COMPILER BIN BUILD: each program is position independent, relocations are read-only and bound at the start, and there are
# calls to check the stack and the sizes of buffers; each object is marked for CET on x86-64. (Programs are not,
# because Debian's start-up files are not marked.)
hardened() {
	make -n -B BUILD="build/$1" CC="$1" CFLAGS='-O2 -Werror' "build/$1/base/clock.o" | grep -e -fstack-clash-protection || return
	[ "$($1 -dumpmachine)" != x86_64-linux-gnu ] ||
		readelf -n "$3/libstormring.a" | awk '/^File:/ { n++ } /IBT, SHSTK/ { with++ } END { print n - with, "objects of", n, "without CET"; exit !n || n > with }' || return
	[ -x "$2/deal" ] && for program in "$2"/*; do
		[ "$(dd if="$program" bs=1 skip=1 count=3 2>/dev/null)" = ELF ] || continue
		readelf -W -h -l -d --dyn-syms "$program" >"$tmp/elf" || return
		for sign in 'Type: +DYN' 'FLAGS_1.* NOW.* PIE' GNU_RELRO __stack_chk_fail '_chk(@|$)'; do
			grep -Eq "$sign" "$tmp/elf" || { echo "$program: has no $sign"; return 1; }
		done
	done
}
ok 'programs built by gcc are hardened' hardened gcc "$(programs $gcc)" $gcc
ok 'programs built by clang are hardened' hardened clang build/clang/bin build/clang
# Static programs have no table of symbols.
pie() { readelf -W -h -l -d "$1" | awk '/Type: +DYN/ { dyn = 1 } /FLAGS_1.* NOW.* PIE/ { now = 1 } /GNU_RELRO/ { relro = 1 } END { exit !(dyn && now && relro) }'; }
for program in build/static/*; do
	if there "$program"; then ok "$program is position independent" pie "$program"
	else skip 'static programs are position independent' "$missing is not there"
	fi
done
ok 'it builds without optimisation' build plain gcc '-O0 -Werror' build/plain/base/clock.o
is 'CFLAGS and LDFLAGS come last, so they win' "$(make -n -B BUILD=build/plain CC=gcc CFLAGS='-O0 -fno-pie -fno-stack-protector' \
	LDFLAGS=-no-pie build/plain/bin/imgcmp 2>&1 | grep -e '-o build/plain/bin/imgcmp' |
	grep -Ec 'stack-protector-strong .*-fno-stack-protector .*-pie .*-no-pie ')" 1

ok 'the pipeline built by gcc renders the same bits' same "$(programs $gcc)"
ok 'the pipeline built by clang renders the same bits' same build/clang/bin

memcheck='valgrind -q --error-exitcode=9 --leak-check=full --trace-children=no'
# shellcheck disable=SC2086
{
	ok 'valgrind finds nothing in a unit test' $memcheck $gcc/unit/test_task
	partition 4x4 >"$tmp/tasks"
	spdgen -s 1 balls >"$tmp/balls.nff"
	ok 'valgrind finds nothing in a worker' sh -c "$memcheck $(programs $gcc)/rtworker '$tmp/balls.nff' <'$tmp/tasks'"
}
finish
