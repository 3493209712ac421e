#!/bin/sh
# nff2pov: refusals, hither, and POV-Ray renders the same picture from its output as rtworker from the scene.
. "$(dirname "$0")/lib.sh"

run nff2pov -h
is '-h exits 0' "$status" 0
for bad in '-x 0 s.nff' '-x -1 s.nff' '-x nan s.nff' '-y s.nff' 's.nff s.nff' 'missing.nff'; do
	# shellcheck disable=SC2086  # a word each
	run nff2pov $bad
	is "refused: nff2pov $bad" "$status:$out" 2:
done
spdgen -s 1 balls | sed 's/^s 0 0 0 .*/s 0 0 0 nan/' >nan.nff
run nff2pov nan.nff
is 'a bad scene exits 2' "$status:$out" 2:
like 'a bad scene: the message has file and line' "$err" "^nff2pov: nan.nff:19: sphere's radius is 'nan', expected a number"
spdgen -s 1 balls >balls.nff
nff2pov balls.nff >a.pov
nff2pov - <balls.nff >b.pov
nff2pov <balls.nff >c.pov
ok '- is standard input' cmp a.pov b.pov
ok 'standard input is the default' cmp a.pov c.pov
like 'the head has the command of POV-Ray' "$(head -n 3 a.pov)" 'povray .* File_Gamma=1 \+FP16 -A -D'

sed 's/^hither .*/hither 3/' balls.nff >near.nff
run nff2pov near.nff
is 'a hither that hides a primitive exits 1' "$status" 1
like 'a message names the hidden primitive' "$err" '^nff2pov: near.nff: hither 3 may hide part of primitive 1,'
like 'a hither that hides a primitive: the scene is still written' "$out" '^sphere '

# POV-Ray refuses short cones. The line is that of the word, after comments and entities over several lines.
printf '%s\n' 'v from 0 -5 0 at 0 0 0 up 0 0 1 angle 40 hither 0 resolution 8 8 # s c p' 's 0 0' '0 1 p 3 0 0 0 1 0 0' \
	'0 1 0 pp 3 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1' 'c 0 0 0 1 0 0 1.001e-10 .5' '# c' >tall.nff
{ cat tall.nff; printf '%s\n' 's 0 0 0 1 c' '0 0 0 1 0 0 1e-13 .5' 'c 2 0 0 1 2 5e-11 5e-11 1'; } >short.nff
run nff2pov tall.nff
is 'a cone over 1e-10 high' "$status:$err" 0:
run nff2pov short.nff
is 'shorter cones: status 1, and the first one is named' "$status:$err" \
	'1:nff2pov: short.nff:7: POV-Ray refuses this cone and others, less than 1e-10 high: expected a larger -x'
like 'shorter cones: the scene is still written' "$out" '^cone '
run nff2pov -x 100 short.nff
like 'at 100 times the size only the first is too short' "$status:$err" '^1:nff2pov: short.nff:7: .* this cone, less '
run nff2pov -x 10000 - <short.nff
is 'at 10000 times the size none is' "$status:$err" 0:

# same NAME FACTOR WxH FILE: the pictures are the same within tolerances
same() {
	nff2pov -x "$2" "$4" >s.pov || return
	pov_ray +Is.pov +Os.ppm "+W${3%x*}" "+H${3#*x}" File_Gamma=1 +FP16 -A -D +WT1 >povray.log 2>&1 ||
		{ tail -n 5 povray.log; return 1; }
	partition "$3" | rtworker "$4" | gather -o s.pfm || return
	imgcmp -d 0.001 -r 0.00001 s.pfm s.ppm && imgcmp -q -t 0.003922 -f 0.0005 s.pfm s.ppm
}
if command -v povray >/dev/null; then
	for scene in cones glass polygons; do
		ok "POV-Ray agrees on $scene" same "$scene" 100 200x150 "$root/scenes/$scene.nff"
		ok "POV-Ray agrees on a tall picture of $scene" same "$scene" 100 60x200 "$root/scenes/$scene.nff"
	done
	{ echo 'f 1 1 1 0 0 1 .9 1.2' && echo 's 2.5 -5 4 3' && echo 'f 1 1 1 0 0 1 .8 1.6' && echo 'c 3 -6 3 1  3 -6 5 .5'
		sed 's/^hither .*/hither 0/' "$root/scenes/glass.nff"; } >within.nff
	ok 'POV-Ray agrees from inside a cone of glass in a ball of glass' same within 100 128x128 within.nff
	pov_reads() { nff2pov -x "$1" "$2" >s.pov; pov_ray +Is.pov -F -D +W8 +H8 -GA >/dev/null; }
	ok 'POV-Ray reads a cone over 1e-10 high' pov_reads 1 tall.nff
	ok 'POV-Ray refuses shorter ones' sh -c 'nff2pov short.nff >s.pov; ! povray +Is.pov -F -D +W8 +H8 -GA >/dev/null 2>&1'
	ok 'POV-Ray reads them at 10000 times the size' pov_reads 10000 short.nff
	# Every other kind of primitive at the least size and without area: POV-Ray takes it.
	printf '%s\n' 'v from 0 -5 0 at 0 0 0 up 0 0 1 angle 40 hither 0 resolution 8 8' 's 0 0 0 1e-18' 'c 0 0 0 1e-18 0 0 1 0' \
		'c 0 0 0 1e18 0 0 1 0' 'p 3 0 0 0 1e-18 0 0 0 1e-18 0' 'p 3 0 0 0 1 0 0 2 0 0' 'p 3 0 0 0 0 0 0 0 0 0' \
		'pp 3 0 0 0 0 0 1 1e-18 0 0 0 0 -1 0 1e-18 0 0 1 0' 'pp 3 -1 0 0 1 0 0 1 0 0 -1 0 0 0 0 1 0 0 0' 's 1e18 0 0 1e18' >odd.nff
	ok 'POV-Ray takes every other primitive' pov_reads 1 odd.nff
	ok 'POV-Ray agrees on balls' same balls 100 128x128 balls.nff
	# A lamp in each kind of surface. These let light through: POV-Ray tries the surface that shaded last by itself, and
	# then counts a lamp in it as shaded. At 100 times the size its single precision moves polygons away from lamps.
	for lamp in "$root"/tests/fuzz/corpus/nff/lamp-*.nff; do
		ok "POV-Ray agrees on $(basename "$lamp" .nff)" same 'a lamp' 10 128x96 "$lamp"
	done
	spdgen -s 2 gears >gears.nff
	ok 'POV-Ray agrees on gears' same gears 100 128x128 gears.nff
	spdgen -s 3 tetra >tetra.nff
	ok 'POV-Ray agrees on tetra' same tetra 1 128x128 tetra.nff
	for scene in jacks:2 lattice:2 mount:3 nurbtst:1 rings:2 sample:1 shells:1 sombrero:1 teapot:3 tree:4; do
		spdgen -s "${scene#*:}" "${scene%:*}" >small.nff
		ok "POV-Ray agrees on ${scene%:*}" same "${scene%:*}" 100 128x128 small.nff
	done
	for scene in balls gears tetra; do
		spdgen -s 2 -V imbalanced $scene >low.nff
		ok "POV-Ray agrees on $scene in its imbalanced view" same $scene 100 128x128 low.nff
	done
else
	skip 'agreement with POV-Ray' 'povray is not installed'
fi
finish
