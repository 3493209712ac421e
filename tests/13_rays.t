#!/bin/sh
# rtworker -n: it counts rays by SPD's procedure, as Eric Haines published for SPD's scenes, and as one counts by hand; and
# their tests.
. "$(dirname "$0")/lib.sh"

# count QUANTITY: a number of the table in $out
count() { echo "$out" | awk -F '\t' -v key="$1" '$1 == key { print $2 }'; }
# near NAME COUNTED PUBLISHED: within 1 %
near() { ok "$1: $2 is within 1 % of $3" awk -v a="$2" -v b="$3" 'BEGIN { exit !(a >= .99 * b && a <= 1.01 * b) }'; }

# Published in SPD's README, version 3.14, for 512x512 and depth 5: eye rays that hit, reflected, refracted and shadow rays.
# Those refracted of gears include total internal reflections.
while read -r scene size hit reflected refracted shadow; do
	spdgen -s "$size" "$scene" >scene.nff
	run rtworker -n scene.nff
	is "$scene: exit 0, and a ray for each corner" "$status:$(count eye_rays)" 0:263169
	near "$scene, eye rays that hit" "$(count eye_hits)" "$hit"
	near "$scene, reflected" "$(count reflected_rays)" "$reflected"
	near "$scene, refracted or turned back" "$(($(count refracted_rays) + $(count turned_back)))" "$refracted"
	near "$scene, shadow rays" "$(count shadow_rays)" "$shadow"
done <<'END'
balls 4 263169 175095 0 954368
gears 4 245086 304643 207564 2246955
mount 6 173125 354769 354769 412922
rings 7 263169 315236 0 1085002
teapot 12 161120 225248 0 407656
tetra 6 49788 0 0 46112
tree 11 169836 0 0 1097419
END

# by_hand NAME DEPTH WANT: counts the rays of the scene on standard input in a frame of 4x2, which has 15 corners. WANT: rays/hits
# of each kind, and those turned back. The eye looks from the origin along y. All surfaces fill the view.
by_hand() {
	{ echo 'v from 0 0 0 at 0 1 0 up 0 0 1 angle 40 hither 0 resolution 64 64' && cat; } >hand.nff
	run rtworker -n -d "$2" -s 4x2 hand.nff
	is "$1" "$status:$(for kind in eye reflected refracted shadow; do
		printf '%s/%s ' "$(count ${kind}_rays)" "$(count ${kind}_hits)"
	done)$(count turned_back)" "0:$3"
}
by_hand 'nothing' 5 '15/0 0/0 0/0 0/0 0' </dev/null
by_hand 'black and dull: a shadow ray to each light in front, one of which is blocked' 5 '15/15 0/0 0/0 30/15 0' <<'END'
l 9 0 0
l -9 0 0
l 0 9 0
f 0 0 0 0 0 0 0 0
p 4 -9 5 -9 9 5 -9 9 5 9 -9 5 9
p 4 -8 4 -9 -8 4 9 -8 -1 9 -8 -1 -9
END
by_hand 'two mirrors: a ray for each level' 4 '15/15 45/45 0/0 0/0 0' <<'END'
f 1 1 1 0 .5 9 0 0
p 4 -99 5 -99 99 5 -99 99 5 99 -99 5 99
p 4 -99 -5 -99 99 -5 -99 99 -5 99 -99 -5 99
END
by_hand 'panes of clear glass: each reflects, though Ks is 0, and each uses up a level' 3 '15/15 30/15 30/30 0/0 0' <<'END'
f 1 1 1 0 0 9 .5 1
p 4 -99 5 -99 99 5 -99 99 5 99 -99 5 99
p 4 -99 6 -99 99 6 -99 99 6 99 -99 6 99
p 4 -99 7 -99 99 7 -99 99 7 99 -99 7 99
p 4 -99 8 -99 99 8 -99 99 8 99 -99 8 99
END
# A mirroring sphere so small that rounding puts a hit at its centre.
printf '%s\n' 'b 1 1 1 v from 0 0 0 at 0 1 0 up 0 0 1 angle 40 hither 0 resolution 1 1' 'f 1 1 1 0 .5 9 0 0' \
	's 0 5 0 1e-17' >dot.nff
for set in sse2 avx2 avx512; do
	rtworker -x $set -h >/dev/null 2>&1 || continue
	run sh -c "partition 1x1 | rtworker -x $set dot.nff | gather -o dot.pfm"
	is "$set: a sphere smaller than rounding mirrors the background" "$status:$(tail -c 12 dot.pfm | od -An -tf4 | xargs)" \
		'0:0.5 0.5 0.5'
done
# Through a pane into glass of index 2, and there onto a wall at 45 degrees.
by_hand 'total internal reflection: reflected once, and not refracted' 3 '15/15 30/0 15/15 0/0 15' <<'END'
f 1 1 1 0 0 9 .5 2
p 4 -9 5 -9 9 5 -9 9 5 9 -9 5 9
p 4 -99 -79 99 99 -79 99 99 119 -99 -99 119 -99
END
# stormring-nff(5), "Surfaces in one place": a ray meets the first of them, and a shadow ray all.
pane='p 4 -9 5 -9 9 5 -9 9 5 9 -9 5 9'
printf '%s\n' 'f 1 0 0 1 0 9 0 0' "$pane" 'f 1 1 1 0 0 9 .5 1' "$pane" >panes
by_hand 'an opaque pane before one of glass in one place' 5 '15/15 0/0 0/0 0/0 0' <panes
printf '%s\n' 'f 1 1 1 0 0 9 .5 1' "$pane" 'f 1 0 0 1 0 9 0 0' "$pane" >panes
by_hand 'one of glass before an opaque one' 5 '15/15 15/0 15/0 0/0 0' <panes
# floor T PANES OUT: a picture of the light that comes to a floor through panes
floor() {
	printf '%s\n' 'v from 0 0 0 at 0 1 0 up 0 0 1 angle 40 hither 0 resolution 8 8' 'l 0 -9 0' 'f 1 1 1 1 0 9 0 0' \
		"$pane" "f 1 1 1 0 0 9 $1 1" >floor.nff
	for at in $2; do echo "p 4 -99 $at -99 99 $at -99 99 $at 99 -99 $at 99"; done >>floor.nff
	partition 8x8 | rtworker floor.nff | gather -o "$3"
}
floor .25 '-5' one.pfm
floor .5 '-5 -5' two.pfm
floor .5 '-5 -5.5' apart.pfm
floor .5 '-5' single.pfm
nok() { ok "$1" sh -c '! "$@"' - "$2" "$3" "$4"; }
nok 'a second pane in the same place makes the shadow darker' cmp -s single.pfm two.pfm
ok 'a shadow ray through two panes in one place: both count' cmp one.pfm two.pfm
ok 'as two panes apart' cmp apart.pfm two.pfm
spdgen -s 2 gears >gears.nff
rtworker -n -x sse2 gears.nff >narrow
rtworker -n - <gears.nff >wide
ok 'the same counts by all vector instructions, and from standard input' cmp narrow wide
for hierarchy in bvh slabs none; do rtworker -n -b $hierarchy -s 16x16 gears.nff >by.$hierarchy; done
grep -v 'tests\|bytes' by.bvh >rays.bvh
for hierarchy in slabs none; do
	grep -v 'tests\|bytes' by.$hierarchy >rays.$hierarchy
	ok "-b $hierarchy: the same rays" cmp rays.bvh rays.$hierarchy
	nok "-b $hierarchy: other tests" cmp -s by.bvh by.$hierarchy
done
out=$(cat by.none)
is 'without a hierarchy no volume is tested' "$(count volume_tests) $(count hierarchy_bytes)" '0 0'
is 'rays are the sum of their kinds' "$(count rays)" \
	"$(($(count eye_rays) + $(count reflected_rays) + $(count refracted_rays) + $(count shadow_rays)))"

# A light far away, as one writes the sun, widens neither edges nor boxes.
spdgen -s 3 tetra | sed 's/^l .*/l 2e16 -18e16 -5e16/' >sun.nff
out=$(spdgen -s 3 tetra | rtworker -n -s 64x64)
hits=$(count eye_hits) volumes=$(count volume_tests)
out=$(rtworker -n -s 64x64 sun.nff)
is 'a light at 1e17: as many eye rays hit' "$(count eye_hits)" "$hits"
ok '... and as few boxes are tested' test "$(count volume_tests)" -lt "$((2 * volumes))"

# The first paper's scenes: the numbers of `protocol complexity`.
while read -r scene rays; do
	run sh -c "spdgen -s 2 $scene | rtworker -n"
	is "$scene, rays" "$(count rays)" "$rays"
done <<'END'
tetra 329805
balls 1251015
gears 3777007
END

for bad in '-n -a 4' '-n -w 0.1' '-n -i' '-n -s 0x4' '-n missing.nff' -R; do
	# shellcheck disable=SC2086  # a word each
	run rtworker $bad gears.nff
	is "refused: rtworker $bad" "$status:$out" 2:
done
run sh -c 'rtworker -n gears.nff >/dev/full'
is 'a full disk exits 3' "$status" 3
finish
