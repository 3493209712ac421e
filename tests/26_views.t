#!/bin/sh
# views: it meets the keys, moves evenly between them, and names what is wrong with a key.
# shellcheck disable=SC2154  # lib.sh sets them
. "$(dirname "$0")/lib.sh"

# key NAME FROM AT UP ANGLE
key() {
	printf '%s\n' '# a comment' "from $2" "at $3" 'resolution 16 12 # of pixels' "up $4" "angle $5" \
		'map 1 .5 .5 .5 0' 'map 2 1 1 1 3' >"$1"
}
key a.spec '10 0 5' '0 0 0' '0 0 1' 30
key b.spec '0 10 5' '0 0 0' '0 0 1' 30
key c.spec '-10 0 5' '0 0 0' '0 0 1' 30
key d.spec '0 -10 5' '0 0 0' '0 0 1' 30
# word WORD FILE: prints its numbers, rounded
word() { awk -v w="$1" '$1 == w { for (i = 2; i <= NF; i++) printf "%.3f ", $i + 1e-9 }' "$2"; }

run views -n 5 -o v%d.spec a.spec b.spec c.spec
is 'five views of three keys' "$status$out$err" 0
for pair in 0:a 2:b 4:c; do ok "view ${pair%:*} is a key" cmp "v${pair%:*}.spec" "${pair#*:}.spec"; done
is 'there are no other views' "$(echo v*.spec)" 'v0.spec v1.spec v2.spec v3.spec v4.spec'
is 'a view half way round is at the same height' "$(word from v1.spec)" '7.071 7.071 5.000 '
is 'all lines except from are the same' "$(grep -v '^from' v3.spec)" "$(grep -v '^from' a.spec)"
sed '/^#/d; s/^up/\n&/' b.spec >bare.spec
ok 'keys may differ in comments and blank lines' views -n 3 -o v%d.spec a.spec bare.spec
rm -f v?.spec
run views -c -n 8 -o v%02d.spec a.spec b.spec c.spec d.spec
is '-c comes back to the first key' "$status $(echo v*.spec | wc -w) $(word from v07.spec)" '0 8 7.071 -7.071 5.000 '
ok '-c: the last but one view is the last key' cmp v06.spec d.spec
rm -f v*.spec
run views -n 1 -o v%d.spec b.spec c.spec
ok 'a single view is the first key' cmp v0.spec b.spec
sed 's/^from.*/& # the eye/' b.spec >comment.spec
views -n 1 -o v%d.spec comment.spec c.spec
ok 'with its comments' cmp v0.spec comment.spec

key near.spec '1 0 0' '0 0 0' '0 0 1' 20
key far.spec '104 0 0' '4 0 0' '0 1 0' 60
views -n 3 -o v%d.spec near.spec far.spec
is 'the distance changes by even factors, the point looked at evenly' \
	"$(word from v1.spec)$(word at v1.spec)" '12.000 0.000 0.000 2.000 0.000 0.000 '
is 'the direction up turns by even angles' "$(word up v1.spec)" '0.000 0.707 0.707 '
is 'the tangent of half the angle changes by even factors' "$(word angle v1.spec)" '35.392 '
key top.spec '0 0 20' '0 0 0' '0 1 0' 30
views -n 3 -o v%d.spec b.spec top.spec
is 'from the side to above, the camera does not go round' "$(word from v1.spec | cut -d ' ' -f 1)" 0.000
{
	printf '%s\n' '# vtk DataFile Version 3.0' t ASCII 'DATASET RECTILINEAR_GRID' 'DIMENSIONS 2 2 2'
	for axis in X Y Z; do printf '%s\n' "${axis}_COORDINATES 2 float" '0 1'; done
	printf '%s\n' 'POINT_DATA 8' 'SCALARS s float' 'LOOKUP_TABLE default' '1 2 1 2 1 2 1 2'
} >g.vtk
ok 'vcworker reads the views' vcworker -i g.vtk v?.spec

sed 's/$/\r/' a.spec >a.crlf
sed 's/$/\r/' b.spec >b.crlf
views -n 3 -o v%d.spec a.spec b.spec
views -n 3 -o w%d.spec a.crlf b.crlf
ok 'lines may end in carriage returns and newlines' cmp v1.spec w1.spec
# refused NAME ERE ARGUMENT ...
refused() { name=$1 ere=$2; shift 2; run views "$@"; like "$name" "$status $err" "^2 $ere"; }
sed 's/^from .*/from 6e400 0 4/' a.spec >far.spec
refused 'a number beyond all' 'views: far.spec:[0-9]+: from: 6e400, expected a number from -1e18 to 1e18$' -n 3 -o v%d.spec far.spec b.spec
sed 's/^map 2/map 3/' b.spec >map.spec
sed '/^map 2/d' b.spec >less.spec
sed '/^up/d' b.spec >noup.spec
key word.spec 'x 0 5' '0 0 0' '0 0 1' 30
key here.spec '0 0 0' '0 0 0' '0 0 1' 30
: >empty.spec
refused 'another map' 'views: map.spec:8: `map 3 1 1 1 3`, expected `map 2 1 1 1 3`, as in a.spec: only the view' \
	-n 3 -o v%d.spec a.spec map.spec
refused 'less' 'views: less.spec: has fewer lines than a.spec, expected' -n 3 -o v%d.spec a.spec less.spec
{ cat b.spec; echo 'limit 1'; } >more.spec
refused 'more' "views: more.spec:[0-9]*: .limit 1., expected the file's end, as in a.spec" -n 3 -o v%d.spec a.spec more.spec
refused 'no up' 'views: noup.spec: no up, expected' -n 3 -o v%d.spec a.spec noup.spec
refused 'no number' 'views: word.spec:2: from: x, expected a number' -n 3 -o v%d.spec a.spec word.spec
refused 'no direction' 'views: here.spec: from has no length' -n 3 -o v%d.spec a.spec here.spec
refused 'opposite' 'views: c.spec: from is opposite to that of a.spec, expected another' -n 3 -o v%d.spec a.spec c.spec
printf '%s\n' 'from 5 0 0' 'at 0 0 0' 'up 0 0 1' 'angle 20' 'hither 1' >a.view
printf '%s\n' '# other side' 'up 0 0 1' 'hither 4' 'at 0 0 0' 'from 0 5 0' 'angle 20' >b.view
run views -n 3 -o v%d.view a.view b.view
is 'views of a scene: hither changes evenly' "$status$err $(word from v1.view)$(word hither v1.view)" '0 3.536 3.536 0.000 2.500 '
spdgen -s 1 balls >balls.nff
ok 'rtworker reads the views' rtworker -i balls.nff v?.view
sed '/^hither/d' b.view >plain.view
refused 'hither in one key' 'views: plain.view: no hither, expected it in all keys or in none' -n 3 -o v%d.view a.view plain.view
refused 'empty' 'views: a key is an empty file' -n 3 -o v%d.spec a.spec empty.spec
refused 'no file' 'views: none: cannot be read' -n 3 -o v%d.spec a.spec none
refused 'a key would be overwritten' 'views: -o v1.spec: is also an input' -n 3 -o v%d.spec a.spec v1.spec
refused 'the same by another name' 'views: -o ./v1.spec: is also an input' -n 3 -o ./v%d.spec a.spec v1.spec
ln -s b.spec l2.spec
refused 'the same by a link' 'views: -o l2.spec: is also an input' -n 3 -o l%d.spec a.spec b.spec
refused 'opposite, after other views' 'views: c.spec: from is opposite' -n 9 -o half%d.spec b.spec a.spec c.spec
is 'a refusal leaves no file' "$(echo half*)" 'half*'
refused 'no pattern' 'views: -o v.spec: expected one %d' -n 3 -o v.spec a.spec b.spec
refused 'a line end in the pattern' 'views: -o a[?]v%d.spec: expected one %d' -n 3 -o 'a
v%d.spec' a.spec b.spec
refused 'no number of them' 'views: -n 0: expected a number' -n 0 -o v%d.spec a.spec b.spec
refused 'one key' 'usage: views' -n 3 -o v%d.spec a.spec
cp a.spec t=0.spec && cp b.spec t=1.spec
views -n 3 -o plain%d.spec a.spec b.spec
ok 'keys whose names have =' timeout 60 views -n 3 -o equal%d.spec t=0.spec t=1.spec
ok 'keys whose names have =: the same views' sh -c 'for i in 0 1 2; do cmp plain$i.spec equal$i.spec || exit; done'
run views -n 3 -o none/v%d.spec a.spec b.spec
is 'no directory: exit 3' "$status" 3
finish
