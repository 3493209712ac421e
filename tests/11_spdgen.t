#!/bin/sh
# spdgen: its list, its output, its refusals. build/unit/test_spd checks that the scenes are those of SPD.
. "$(dirname "$0")/lib.sh"

run spdgen -h
is '-h exits 0' "$status" 0
like '-h prints the usage' "$out" '^usage: spdgen '

run spdgen -l
is '-l exits 0' "$status" 0
like '-l lists balls at its default size' "$out" '^balls 4 7382 '
like '-l lists gears at its default size' "$out" '^gears 4 9345 '
like '-l lists tetra at its default size' "$out" '^tetra 6 4096 '
run spdgen -l -s 2
like '-l -s 2 lists gears at size 2' "$out" '^gears 2 1169 '
spdgen -l | grep -v '^#' | while read -r name size primitives _; do
	[ "$(spdgen "$name" | grep -c '^[sp] ')" = "$primitives" ] || echo "$name $size"
done >wrong
is 'spdgen writes the number of primitives that it lists' "$(cat wrong)" ''
spdgen tetra >default
spdgen -s 6 tetra >named
ok 'the default size is the listed one' cmp default named

# turn SCENE: prints the turn of the camera in the imbalanced view, in whole degrees
turn() {
	for view in balanced imbalanced; do spdgen -p 17 -s 1 -V $view "$1"; done | awk '
		$1 == "from" || $1 == "at" { for (i = 2; i <= 4; i++) seen[++n] = $i }
		END {
			for (i = 1; i <= 3; i++) {
				a = seen[i + 3] - seen[i]; b = seen[i + 9] - seen[i + 6]
				ab += a * b; aa += a * a; bb += b * b
			}
			cosine = ab / sqrt(aa * bb)
			print int(atan2(sqrt(1 - cosine ^ 2), cosine) * 180 / atan2(0, -1) + .5)
		}'
}
for scene in balls gears tetra; do
	spdgen -s 2 $scene >plain
	spdgen -s 2 -V balanced $scene >named
	ok "$scene is balanced by default" cmp plain named
	spdgen -s 2 -V imbalanced $scene >other
	is "$scene, imbalanced, differs only in the direction of the camera" \
		"$(diff plain other | sed -n 's/^\([<>] [a-z]*\).*/\1/p' | tr '\n' ' ')" '< at > at '
	like "the camera of $scene turns by the angle of spdgen(1)" "$(cat "$root/man/spdgen.1")" \
		"^$scene +0[.][0-9]+ +[01][.][0-9]+ +$(turn $scene) degrees "
done

for bad in '-V upward balls' '-V balls' '-s 0 balls' '-s -1 balls' '-s 1.5 balls' '-s x balls' '-s 8 balls' \
	'-s 41 gears' '-s 12 tetra' '-s 99999999999 tetra' '-p 5 balls' '-p 18 balls' 'teacup' '' 'balls gears' \
	'-l balls' '-q balls'; do
	# shellcheck disable=SC2086  # a word each
	run spdgen $bad
	is "refused: spdgen $bad" "$status:$out" 2:
	like "a message gives the reason: spdgen $bad" "$err" '^(spdgen: |usage: spdgen )'
done
ok 'the largest size is accepted' sh -c 'spdgen -s 40 gears | head -c 100 | grep -q resolution'

run sh -c 'spdgen balls >/dev/full'
is 'a full disk exits 3' "$status" 3
like 'a message names standard output' "$err" '^spdgen: standard output:'
finish
