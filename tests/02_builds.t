#!/bin/sh
# The compilers and sanitizers find nothing, and every build renders the same picture.
. "$(dirname "$0")/lib.sh"
needs gcc clang valgrind /usr/include/cmocka.h
cd "$root" || exit 3

# build NAME CC CFLAGS [TARGET ...]: into build/NAME, apart from the programs that other tests run
build() {
	name=$1 cc=$2 flags=$3
	shift 3
	make -s -j2 BUILD="build/$name" CC="$cc" CFLAGS="$flags" "${@:-all}"
}
sanitize='-O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all'
ok 'gcc warns of nothing' build gcc gcc '-O2 -Werror' all unit
ok 'clang warns of nothing' build clang clang '-O2 -Werror' all unit
ok 'it builds with sanitizers' build sanitized gcc "$sanitize -Werror" all unit

# hardened BUILD: each program is position independent, relocations are read-only and bound at the start, and there are
# calls to check the stack and the sizes of buffers; each object is marked for CET on x86-64. (Programs are not,
# because Debian's start-up files are not marked.)
hardened() {
	make -n -B BUILD="build/$1" CC="$1" CFLAGS='-O2 -Werror' "build/$1/base/clock.o" | grep -e -fstack-clash-protection || return
	[ "$($1 -dumpmachine)" != x86_64-linux-gnu ] ||
		readelf -n "build/$1/libstormring.a" | awk '/^File:/ { n++ } /IBT, SHSTK/ { with++ } END { print n - with, "objects of", n, "without CET"; exit !n || n > with }' || return
	[ -x "build/$1/bin/deal" ] && for program in "build/$1"/bin/*; do
		[ "$(dd if="$program" bs=1 skip=1 count=3 2>/dev/null)" = ELF ] || continue
		readelf -W -h -l -d --dyn-syms "$program" >"$tmp/elf" || return
		for sign in 'Type: +DYN' 'FLAGS_1.* NOW.* PIE' GNU_RELRO __stack_chk_fail '_chk(@|$)'; do
			grep -Eq "$sign" "$tmp/elf" || { echo "$program: has no $sign"; return 1; }
		done
	done
}
for name in gcc clang; do ok "programs built by $name are hardened" hardened $name; done
ok 'it builds without optimisation' build plain gcc '-O0 -Werror' build/plain/base/clock.o
is 'CFLAGS and LDFLAGS come last, so they win' "$(make -n -B BUILD=build/plain CC=gcc CFLAGS='-O0 -fno-pie -fno-stack-protector' \
	LDFLAGS=-no-pie build/plain/bin/imgcmp 2>&1 | grep -e '-o build/plain/bin/imgcmp' |
	grep -Ec 'stack-protector-strong .*-fno-stack-protector .*-pie .*-no-pie ')" 1

# test_base tries to run out of memory.
for unit in tests/unit/test_*.c; do
	name=$(basename "$unit" .c)
	ok "$name is clean under ASan and UBSan" env ASAN_OPTIONS=allocator_may_return_null=1 "build/sanitized/unit/$name"
done

# picture BUILD: renders a small picture through every stage
picture() {
	PATH=$root/build/$1/bin:$PATH
	{ pack scene "$tmp/gears.nff" && partition -u tile:16x8 40x32; } |
		deal -q 1 fan -j 2 rtworker - | gather -o "$tmp/$1.pfm" -r "$tmp/$1.frags" &&
		imgcmp "$tmp/$1.pfm" "$tmp/reference.pfm" && fragstat "$tmp/$1.frags" &&
		gather -m "$tmp/$1.frags" && nff2pov "$tmp/gears.nff" >"$tmp/$1.pov"
}
spdgen -s 2 gears >"$tmp/gears.nff"
partition 40x32 | rtworker "$tmp/gears.nff" | gather -o "$tmp/reference.pfm"
for name in gcc clang sanitized; do ok "the pipeline built as $name renders the same bits" picture "$name"; done

memcheck='valgrind -q --error-exitcode=9 --leak-check=full --trace-children=no'
# shellcheck disable=SC2086
{
	ok 'valgrind finds nothing in a unit test' $memcheck build/gcc/unit/test_task
	partition 4x4 >"$tmp/tasks"
	spdgen -s 1 balls >"$tmp/balls.nff"
	ok 'valgrind finds nothing in a worker' sh -c "$memcheck build/gcc/bin/rtworker '$tmp/balls.nff' <'$tmp/tasks'"
}
finish
