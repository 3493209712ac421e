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
# programs BUILD: where the programs of this build are
programs() { if [ "$1" = build ]; then echo bin; else echo "$1/bin"; fi; }
# same BIN: a small picture goes through every stage, and has the same bits
same() {
	rm -f "$tmp"/same.*
	PATH=$root/$1:$PATH
	{ pack scene "$tmp/gears.nff" && partition -u tile:16x8 40x32; } |
		deal -q 1 fan -j 2 rtworker - | gather -o "$tmp/same.pfm" -r "$tmp/same.frags" &&
		imgcmp "$tmp/same.pfm" "$tmp/reference.pfm" && fragstat "$tmp/same.frags" &&
		gather -m "$tmp/same.frags" && nff2pov "$tmp/gears.nff" >"$tmp/same.pov"
}
