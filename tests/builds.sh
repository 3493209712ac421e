# For tests that build apart from the programs of the clone. Read it after lib.sh.
# shellcheck shell=sh disable=SC2154
cd "$root" || exit 3
# build NAME CC CFLAGS [TARGET ...]: into build/NAME
build() {
	name=$1 cc=$2 flags=$3
	shift 3
	make -s -j2 BUILD="build/$name" CC="$cc" CFLAGS="$flags" "${@:-all}"
}

spdgen -s 2 gears >"$tmp/gears.nff"
partition 40x32 | rtworker "$tmp/gears.nff" | gather -o "$tmp/reference.pfm"
# same BIN: a small picture goes through every stage, and has the same bits
same() {
	rm -f "$tmp"/same.*
	PATH=$(cd "$1" && pwd):$PATH
	{ pack scene "$tmp/gears.nff" && partition -u tile:16x8 40x32; } |
		deal -q 1 fan -j 2 rtworker - | gather -o "$tmp/same.pfm" -r "$tmp/same.frags" &&
		imgcmp "$tmp/same.pfm" "$tmp/reference.pfm" && fragstat "$tmp/same.frags" &&
		gather -m "$tmp/same.frags" && nff2pov "$tmp/gears.nff" >"$tmp/same.pov"
}
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
