#!/bin/sh
# spdgen: its list, its output, its refusals. build/unit/test_spd compares every digit of more sizes with SPD's.
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
like 'gears at size 2' "$out" '^gears 2 1169 '
# counted SCENE SIZE: its spheres, cones, polygons and patches, by the formulas at the head of SPD's programs; but shells
# has one sphere more than they say, and no square, and sample says nothing
counted() {
	awk -v name="$1" -v s="$2" 'BEGIN {
		if (name == "balls") print (9 ^ (s + 1) - 1) / 8, 0, 1, 0
		if (name == "gears") print 0, 0, 146 * s ^ 3 + 1, 0
		if (name == "jacks") print 6 * (8 ^ s - 1) / 7, 3 * (8 ^ s - 1) / 7, 0, 0
		if (name == "lattice") print (s + 1) ^ 3, 3 * s * (s + 1) ^ 2, 0, 0
		if (name == "mount") print 4, 0, 2 * 4 ^ s, 0
		if (name == "nurbtst") print 0, 0, 0, 2 * 30 * 25
		if (name == "rings") print 5 * s * (s + 1) * (2 * s + 1), 5 * s * (s + 1) * (2 * s + 1), 1, 0
		if (name == "sample") print 0, 1, 16, 3 * 288
		if (name == "shells") print 180 * 2 ^ s + 1, 0, 0, 0
		if (name == "sombrero") print 0, 0, 2 * (32 * 2 ^ (s - 1) - 1) ^ 2, 0
		if (name == "teapot") print 0, 0, s ^ 2, 32 * 2 * s ^ 2 - 8 * s
		if (name == "tetra") print 0, 0, 4 ^ s, 0
		if (name == "tree") print 2 ^ (s + 1) - 1, 2 ^ (s + 1) - 1, 1, 0
	}'
}
# found <SCENE: the same, as they are written; then the lights and the sum of each number under 1000 times its position
# mod 97
found() {
	awk '{ n[$1]++ }
		{ for (i = 1; i <= NF; i++) if ($i ~ /^[-0-9]/ && ++at && $i < 1000 && $i > -1000) sum += $i * (at % 97) }
		END { printf "%d %d %d %d %d %.9g\n", n["s"], n["c"], n["p"], n["pp"], n["l"], sum }'
}
# For each scene SPD's default size, its number of lights, and the sums of sizes 1, 2, 3 and that one, as measured in what
# SPD's own programs write.
while read -r name default lights sums; do
	spdgen -s "$default" "$name" >named
	spdgen "$name" >default
	ok "$name: the default size is SPD's" cmp default named
	# shellcheck disable=SC2086  # four sums
	set -- $sums
	for size in 1 2 3 "$default"; do
		spdgen -s "$size" "$name" >scene
		is "$name, size $size: entities, lights and sum" "$(found <scene)" "$(counted "$name" "$size") $lights $1"
		is "$name, size $size: as many primitives are listed" \
			"$(spdgen -l -s "$size" | awk -v name="$name" '$1 == name { print $2, $3 }')" \
			"$size $(counted "$name" "$size" | awk '{ print $1 + $2 + $3 + $4 }')"
		ok "$name, size $size: rtworker reads it" rtworker -i scene
		shift
	done
	like "$name: and the size that is listed" "$(spdgen -l)" "^$name $default [0-9]+ "
	text=$(spdgen -h | sed -n "s/^  $name  *$default  //p")
	is "$name: the page says what -h says" "$(grep -xA 1 "[.]It Cm $name" "$root/man/spdgen.1" | tail -n 1)" "$text."
done <<'END'
balls 4 3 17397.3063 18234.0518 26193.0871 90704.5016
gears 4 5 98842.3609 590471.708 1830897.85 4206607.15
jacks 1 1 8166.9247 8359.70669 8910.77887 8166.9247
lattice 12 6 23020.5616 41419.0951 78878.7591 2384468.82
mount 6 1 18920.5779 23827.2704 39542.0255 1432585.39
nurbtst 1 1 466401.666 466401.666 466401.666 466401.666
rings 7 3 30365.8086 128653.538 449390.324 9127134.06
sample 1 1 151589.015 151589.015 151589.015 151589.015
shells 5 1 -25403.4006 -59782.094 -139297.683 -603842.907
sombrero 1 1 -538177.337 -2245395.87 -9286169.19 -538177.337
teapot 6 2 40462.5423 118886.652 247727.165 948651.113
tetra 6 1 16686.3564 18928.3564 25676.3564 604718.044
tree 11 7 22024.8769 22863.5406 25424.0433 1700605.9
END
is 'these are all scenes' "$(spdgen -l | grep -vc '^#')" 13
is '-l leaves out scenes that do not go up to the size' "$(spdgen -l -s 100 | cut -d ' ' -f 1 | tr '\n' ' ')" \
	'# lattice nurbtst sample teapot '

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
	'-l balls' '-q balls' '-s 0 teapot' '-s 8 jacks' '-s 135 lattice' '-s 12 mount' '-s 1000001 nurbtst' '-s 79 rings' \
	'-s -2 sample' '-s 16 shells' '-s 8 sombrero' '-s 393 teapot' '-s 22 tree' '-V imbalanced jacks'; do
	# shellcheck disable=SC2086  # a word each
	run spdgen $bad
	is "refused: spdgen $bad" "$status:$out" 2:
	like "a message gives the reason: spdgen $bad" "$err" '^(spdgen: |usage: spdgen )'
done
run spdgen -s 8 sombrero
is 'the message about a size names the largest' "$err" 'spdgen: -s 8: sombrero goes up to size 7'
ok 'the largest size is accepted' sh -c 'spdgen -s 40 gears | head -c 100 | grep -q resolution'

run sh -c 'spdgen balls >/dev/full'
is 'a full disk exits 3' "$status" 3
like 'a message names standard output' "$err" '^spdgen: standard output:'
finish
