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
# same BUILD: a small picture goes through every stage, and has the same bits
same() {
	PATH=$root/build/$1/bin:$PATH
	{ pack scene "$tmp/gears.nff" && partition -u tile:16x8 40x32; } |
		deal -q 1 fan -j 2 rtworker - | gather -o "$tmp/$1.pfm" -r "$tmp/$1.frags" &&
		imgcmp "$tmp/$1.pfm" "$tmp/reference.pfm" && fragstat "$tmp/$1.frags" &&
		gather -m "$tmp/$1.frags" && nff2pov "$tmp/gears.nff" >"$tmp/$1.pov"
}
