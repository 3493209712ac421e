#!/bin/sh
# gridcut, balance bricks: the pictures of the bricks become that of the whole grid, also with surfaces in a cut, rays in a
# cut, and the eye in a cut; the order of sight; memory; hosts that fail; refusals.
# shellcheck disable=SC2154  # lib.sh sets them
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"

# grid NAME NX NY NZ AWK: nodes at 0, 1, 2, ... and y descending; AWK sets s at i, j, k
grid() {
	awk -v nx="$2" -v ny="$3" -v nz="$4" 'BEGIN {
		printf "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS %d %d %d\n", nx, ny, nz
		print "X_COORDINATES " nx " float"; for (i = 0; i < nx; i++) print i
		print "Y_COORDINATES " ny " float"; for (j = ny - 1; j >= 0; j--) print j
		print "Z_COORDINATES " nz " double"; for (k = 0; k < nz; k++) print k * (1 + .05 * k)
		print "POINT_DATA " nx * ny * nz "\nSCALARS wind float 1\nLOOKUP_TABLE default"
		for (k = 0; k < nz; k++) for (j = ny - 1; j >= 0; j--) for (i = 0; i < nx; i++) { '"$5"'; print s }
	}' >"$1.vtk"
}
# spec FROM AT LINE ...: a map and these lines
spec() {
	printf '%s\n' "from $1" "at $2" 'up 0 0 1' 'angle 40' 'resolution 49 41' 'map 25 .2 .2 1 0' 'map 32 1 .5 0 .3' \
		'map 32 0 1 0 0' 'map 60 0 1 1 .2'
	shift 2
	printf '%s\n' "$@"
}
# picture GRID SPEC [OPTIONS]: prints its picture
picture() { drawn=$1 by=$2; shift 2; partition 49x41 | vcworker "$@" "$drawn" "$by" | gather -k 16 -o out.pam && cat out.pam; }
# composed GRID SPEC PARTS [OPTIONS]: composed.pam is the picture of the bricks, whole.pam that of the grid
composed() {
	grid=$1 of=$2 parts=$3
	shift 3
	rm -f part-*
	picture $grid $of "$@" >whole.pam && gridcut -n "$parts" -o part-%02d.vtk $grid || return
	for brick in part-*.vtk; do picture "$brick" $of "$@" >"${brick%.vtk}.pam" || return; done
	# shellcheck disable=SC2046  # a word each
	blend -k 16 -o composed.pam $(gridcut -s $of part-*.vtk | sed 's/vtk$/pam/')
}
# equal NAME GRID SPEC PARTS [OPTIONS]: both are equal within 1 - limit; no pixel may have another surface
equal() {
	name=$1
	shift
	if composed "$@"; then ok "$name, cut $3" imgcmp -t .0001 composed.pam whole.pam; else fail "$name, cut $3" 'no picture'; fi
}

# ---- the same picture --------------------------------------------------------------------------------------------
grid wave 24 18 7 's = i == 5 && j == 5 && k == 3 ? "nan" : 30 + 20 * sin(i / 3 + k / 2) * cos(j / 4)'
light='light 9 -9 30
attenuation .02'
spec '12 -30 25' '14 10 3' >map.spec
spec '12 -30 25' '14 10 3' 'iso 45 1 1 1 .5' 'iso 20 1 0 0 .4' >iso.spec
spec '40 30 9' '14 10 3' "$light" >lit.spec
spec '-14.2 12.1 4.3' '-3 3 2' 'iso 45 1 1 1 .5' "$light" 'scale -1 1 1.5' >inside.spec
spec '40 30 9' '14 10 3' 'clip 2.5 1.1 .4 20.5 15 6.2' 'slice x 10 .6' 'slice y 8.5 .6' 'slice z 1.05 .6' \
	'iso 45 1 1 1 .5' "$light" >boxed.spec
for parts in 1,1,1 3,1,1 1,1,6 2,3,2 23,1,1; do for of in map iso lit inside boxed; do equal "$of" wave.vtk $of.spec $parts; done; done
for of in iso inside; do equal "$of by the exact method" wave.vtk $of.spec 2,3,2 -m gauss:5; done

# A surface in each cut: the value of a layer of nodes. Rays pass upwards and downwards.
grid layers 9 9 9 's = 20 + 5 * k'
for z in -9 25; do
	spec "3.1 2.2 $z" '4 4 6' 'iso 40 1 1 1 .5' 'iso 35 1 0 0 .5' 'iso 25 0 0 1 .5' 'scale 1 1 .7' >through.spec
	equal "surfaces in the cuts, from z = $z" layers.vtk through.spec 1,1,8
	equal "surfaces in the cuts, from z = $z, by the exact method" layers.vtk through.spec 1,1,8 -m gauss:3
done
spec '3.1 2.2 25' '4 4 6' 'slice z 4.4 .5' 'slice z 2.2 .5' 'slice y 3 .5' >slices.spec
equal 'slices in the cuts' layers.vtk slices.spec 1,8,8
# A column of rays runs within cuts, and the middle one along edges of bricks.
spec '4 -20 6' '4 4 6' 'iso 40 1 1 1 .5' >within.spec
equal 'rays in the cuts' layers.vtk within.spec 2,1,8
spec '20 20 5.2' '4 4 5.2' 'iso 40 1 1 1 .5' >edge.spec
equal 'rays through edges' layers.vtk edge.spec 4,4,4
spec '4 4 5.2' '20 20 5.2' 'iso 40 1 1 1 .5' >vertex.spec
equal 'the eye on a corner of bricks' layers.vtk vertex.spec 2,2,2
spec '4 20 5.2' '4 4 5.2' 'iso 40 1 1 1 .5' 'scale -1 1 1' | sed 's/^from 4/from -4/; s/^at 4/at -4/' >mirror.spec
equal 'rays in the cuts of a mirrored grid' layers.vtk mirror.spec 4,1,4

# ---- the order of sight ------------------------------------------------------------------------------------------
on_line() { tr '\n' ' ' | sed 's/ $//'; }
gridcut -n 3,1,1 -o row-%d.vtk wave.vtk
spec '10 -30 3' '10 9 3' >middle.spec
is 'the nearest brick comes first, here that in the middle' "$(gridcut -s middle.spec row-2.vtk row-0.vtk row-1.vtk | head -n 1)" row-1.vtk
spec '90 9 3' '10 9 3' >right.spec
is 'from the right' "$(gridcut -s right.spec row-*.vtk | on_line)" 'row-2.vtk row-1.vtk row-0.vtk'
refused() { name=$1 ere=$2; shift 2; run "$@"; like "$name" "$status $err" "^2 gridcut: $ere"; }
refused 'a brick is missing' 'bricks are missing: row-0.vtk has none beside it along x, expected' gridcut -s map.spec row-0.vtk row-2.vtk
refused 'a brick twice' 'row-0.vtk and row-0.vtk have a cell in common' gridcut -s map.spec row-0.vtk row-0.vtk row-1.vtk
grid thin 4 3 3 's = i' && sed -i '/^X_COO/{n;n;s/.*/1e-7/}' thin.vtk
gridcut -n 3,1,1 -o thin-%d.vtk thin.vtk
refused 'a thin brick is missing' 'bricks are missing: thin-1.vtk has none beside it along x' gridcut -s map.spec thin-1.vtk thin-2.vtk
gridcut -n 1,2,1 -o two-%d.vtk wave.vtk
gridcut -n 2,2,1 -o quarter-%d.vtk wave.vtk
run balance bricks -j 1 -s 20000x20000 -o large.png row-0.vtk row-1.vtk row-2.vtk map.spec
like 'balance bricks: more pixels than blend takes' "$status:$err" '^2:balance bricks: 20000x20000: more than 2\^28 pixels, expected fewer'
refused 'bricks of two cuts' 'bricks are missing: ' gridcut -s map.spec two-0.vtk quarter-2.vtk quarter-3.vtk
gridcut -n 3,1,1 -o other-%d.vtk layers.vtk
refused 'bricks of two grids' 'row-0.vtk and other-1.vtk are of two grids' gridcut -s map.spec row-0.vtk other-1.vtk row-2.vtk
refused 'a whole grid' 'wave.vtk: is no brick, expected' gridcut -s map.spec wave.vtk

# ---- balance bricks ----------------------------------------------------------------------------------------------
{ cat iso.spec; echo 'background .1 0 .3 # night'; } >night.spec
balance adaptive -j 1 -k 16 -o night.pam wave.vtk night.spec
gridcut -n 2,2,1 -o b-%d.vtk wave.vtk
ok 'balance bricks' balance bricks -j 2 -k 16 -o bricks.pam b-*.vtk night.spec
ok 'its picture, with a background, is that of the grid' imgcmp -t .0001 night.pam bricks.pam
printf '%s\n' 'broken via="false %c" tries=1' 'good via="sh -c %c" slots=2' >hosts
run balance bricks -S hosts -k 16 -o two.pam b-*.vtk night.spec
is 'a host that fails: the other one renders its brick' "$status $(cmp two.pam bricks.pam && echo same)" '0 same'
like 'a message names that host' "$err" '^balance bricks: broken: b-[0-9].vtk failed there'
mkdir broken,worse # a list of hosts may be the name of a directory
run balance bricks -S broken,worse -o no.png b-*.vtk night.spec
is 'all hosts fail: exit 1, no picture' "$status $(ls no.png 2>/dev/null)" '1 '
like 'a message names one of them' "$err" '^balance bricks: broken: b-[0-9].vtk failed there'
is 'no directory is read' "$(echo "$err" | grep -c directory)" 0
like 'a message counts the bricks' "$err" '^balance bricks: 4 of 4 bricks have no picture'
run balance bricks -j 1 -o no.png b-0.vtk b-1.vtk b-2.vtk night.spec
like 'bricks are missing: refused before the work' "$status $err" '^2 gridcut: bricks are missing'
(MARK=$mark exec "$root/bin/balance-bricks" -j 1 -s 4000x4000 -W '-m trapezoid:100000' -o long.png b-*.vtk night.spec) >said 2>&1 &
working_bricks() { [ -n "$(program vcworker)" ]; }
await 30 working_bricks
kill -9 $!
ok 'killed: no process stays' await 10 none_alive

# ---- cutting -----------------------------------------------------------------------------------------------------
gridcut -m .002 -o small-%d.vtk wave.vtk
is '-m: no brick has more values' "$(for f in small-*.vtk; do sed -n '/^POINT_DATA/{s/.* //p;q}' "$f"; done | sort -n | awk 'END { print $1 <= 524 }')" 1
refused '-m: too little' '-m 1e-05: more than 256 bricks' gridcut -m .00001 -o t-%d.vtk wave.vtk
refused '-m: less than a cell' '-m 1e-06: a brick of one cell takes [0-9.e-]+, expected that at least' gridcut -m .000001 -o t-%d.vtk thin.vtk
refused 'more bricks than cells' '-n: 7 bricks along z, expected 6 at most' gridcut -n 1,1,7 -o t-%d.vtk wave.vtk
refused 'too many bricks' '-n 7,7,7: expected' gridcut -n 7,7,7 -o t-%d.vtk wave.vtk
refused 'parts of bricks' '-n 1.5,1,1: expected' gridcut -n 1.5,1,1 -o t-%d.vtk wave.vtk
cp wave.vtk hour-01.vtk
refused 'a name that is the grid' 'hour-01.vtk: is also the grid' gridcut -n 1,1,2 -o hour-%02d.vtk hour-01.vtk
ok 'which stays as it is' cmp wave.vtk hour-01.vtk
refused 'no number in the name' '-o t.vtk: expected one %d' gridcut -n 1,1,2 -o t.vtk wave.vtk
cp hour-01.vtk piped-0.vtk
run gridcut -n 1,1,2 -o piped-%d.vtk - <piped-0.vtk
is 'standard input that would be a brick: refused, and it stays' "$status:$(cmp piped-0.vtk hour-01.vtk && echo same)" 2:same
run gridspec b-0.vtk
is 'a starter for a brick: refused' "$status:$err" '2:gridspec: b-0.vtk: is a brick, expected a whole grid'
refused 'a brick' 'b-0.vtk: is a brick, expected a whole grid' gridcut -n 1,1,2 -o t-%d.vtk b-0.vtk
refused 'no such grid' 'gone.vtk: No such file' gridcut -n 1,1,2 -o t-%d.vtk gone.vtk
refused 'a pipe' 'standard input: is a pipe or a device' sh -c 'cat wave.vtk | gridcut -n 1,1,2 -o t-%d.vtk -'
head -n 1000 wave.vtk >cut.vtk
refused 'a grid that is cut off' 'cut.vtk:.*(announced|ends before)' gridcut -n 1,1,2 -o t-%d.vtk cut.vtk
sed '$s/.*/x/' wave.vtk >bad.vtk
refused 'a grid that is bad at its end' "bad.vtk:[0-9]*: values is 'x'" gridcut -n 1,1,2 -o t-%d.vtk bad.vtk
is 'nothing half-written' "$(find . -name 't-*' -o -name '.t-*')" ''
run gridcut -n 1,1,2 -o no/such-%d.vtk wave.vtk
is 'a directory that does not exist: exit 3' "$status" 3

# Half of a file of 20 MiB is read when the second of two bricks begins.
{
	printf '# vtk DataFile Version 3.0\nx\nBINARY\nDATASET RECTILINEAR_GRID\nDIMENSIONS 512 256 160\n'
	for axis in X:512 Y:256 Z:160; do
		printf '%s_COORDINATES %s short\n' "${axis%:*}" "${axis#*:}"
		perl -e 'print pack("n*", 0 .. $ARGV[0] - 1), "\n"' "${axis#*:}"
	done
	printf 'POINT_DATA 20971520\nSCALARS v unsigned_char 1\nLOOKUP_TABLE default\n'
	head -c 20971520 /dev/zero
} >large.vtk
mkfifo half-0.vtk half-1.vtk
cat half-0.vtk >/dev/null &
exec 9<>half-1.vtk
gridcut -n 1,1,2 -o half-%d.vtk large.vtk &
cutting=$!
head -c 30000 <&9 >/dev/null
kb=$(awk '/^VmHWM/ { print $2 }' /proc/$cutting/status)
kill $cutting
exec 9>&-
wait
ok "gridcut needs little memory: $kb KiB" [ "$kb" -lt 9000 ]
finish
