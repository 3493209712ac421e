#!/bin/sh
# No output replaces a file that the run reads: by its own name, a link, a number in a pattern, or as a preview. The run is
# refused before it renders anything. An output that is an open descriptor is written there.
. "$(dirname "$0")/lib.sh"
needs gnuplot
# shellcheck disable=SC2154  # lib.sh sets them

cat >g.vtk <<'END'
# vtk DataFile Version 3.0
w [m/s]; x lon [degrees_east]; y lat [degrees_north]
ASCII
DATASET RECTILINEAR_GRID
DIMENSIONS 2 2 3
X_COORDINATES 2 float
0 1
Y_COORDINATES 2 float
0 1
Z_COORDINATES 3 float
0 1 2
POINT_DATA 12
SCALARS w float 1
LOOKUP_TABLE default
0 1 2 3 4 5 6 7 8 9 10 11
END
gridspec g.vtk | sed "/^background/d" >s.spec
spdgen -s 1 tetra >t.nff
partition 8x8 | rtworker t.nff >t.frags
gather -o back.png t.frags
printf '%s\n' 'experiment	kind	method	x	x_unit	y	y_unit	sample	seed' 'a	real	m	1	1	2	s	1	0' >t.tsv
echo : >hosts
echo '0 0' >lines
echo t.nff >names
printf 'frame %s 8 8 job=1\n' 0 1 >frames
# Each file also by a name that an output of the programs can have.
for name in g.vtk:g1.png s.spec:s1.png t.nff:t1.png t.frags:f.png back.png:back1.png t.tsv:t.svg hosts:h1.png lines:l1.png g.vtk:b-0.vtk; do
	ln -s "${name%:*}" "${name#*:}"
done
ln t.nff t.partial.png
ls -l >.before

cp t.nff "$(printf 'x\ny.png')" && run balance adaptive -j 1 -s 8x8 -o "$(printf 'x\ny.png')" "$(printf 'x\ny.png')"
like 'a name with a line end is refused' "$status $err" '^2 job: x.*y.png: has a line end in its name, expected none'
ok 'which is kept' cmp t.nff "$(printf 'x\ny.png')"
rm "$(printf 'x\ny.png')"
# A line for each: the command, and the file that it would replace.
while IFS='|' read -r command file; do
	run sh -c "$command"
	like "refused: $command" "$status:$err" "^2:[a-z0-9-]*: (-. )?$file: is also (an input|the log|the grid|a backdrop), expected another file\$"
done <<'END'
balance adaptive -j 1 -s 8x8 -o t1.png t.nff|t1.png
balance adaptive -j 1 -s 8x8 -o ./t.partial.png t.nff|./t.partial.png
balance adaptive -j 1 -s 8x8 -w 1 -o t.png t.nff|t.partial.png
balance adaptive -j 1 -s 8x8 -r t1.png -o a.png t.nff|-r t1.png
balance adaptive -j 1 -s 8x8 -o s%d.png g.vtk s.spec s.spec|s1.png
balance adaptive -j 1 -s 8x8 -o g%d.png g.vtk s.spec s.spec|g1.png
balance adaptive -S hosts -s 8x8 -o h1.png t.nff|h1.png
balance adaptive -j 1 -m lines -s 40x40 -o l1.png g.vtk s.spec|l1.png
balance adaptive -j 1 -m lines -s 40x40 -o l%d.png g.vtk s.spec s.spec|l1.png
balance adaptive -v .5 -j 2 -s 8x8 -o t1.png t.nff|t1.png
balance bricks -j 1 -s 8x8 -o g1.png g.vtk s.spec|-o g1.png
balance calibrate -n 1 -s 8x8 -o t1.png t.nff|-o t1.png
backdrop -s 40x40 -o l1.png -m lines g.vtk s.spec|l1.png
backdrop -s 40x40 -o a%d.png -c s%d.png g.vtk s.spec s.spec|s1.png
backdrop -s 40x40 -o g1.png g.vtk s.spec|g1.png
gather -o f.png t.frags|f.png
gather -o f.png <t.frags|f.png
gather -o a.png -r f.png t.frags|t.frags
gather -b back.png -e frames -o back%d.png t.frags|back1.png
gather -b back%d.png -o back1.png t.frags|back1.png
gather -i names -e frames -o t%d.png t.frags|t1.png
gather -i names -w 1 -o t.png t.frags|t.partial.png
balance adaptive -j 1 -s 8x8 -o t1.png - <t.nff|t1.png
blend -o back1.png back.png|back1.png
grid2pov g.vtk s.spec g1.png|g1.png
gridcut -n 1,1,2 -o b-%d.vtk g.vtk|b-0.vtk
fragstat -H -o f.png t.frags|f.png
chart -o t.svg t.tsv|-o t.svg
END
# The data itself, where a grid, a scene or a specification is expected.
printf 'CDF\001' >.data.nc
for files in .data.nc 'g.vtk .data.nc'; do
	# shellcheck disable=SC2086  # a word each
	run balance adaptive -j 1 -o a.png $files
	is "refused, with the program that reads it: $files" "$status:$err" \
		'2:job: .data.nc: is a NetCDF file, expected a scene, a grid or a specification: nc2vtk makes a grid of a variable'
done
run sh -c 'balance adaptive -j 1 -o a.png - <.data.nc'
like 'the same from standard input' "$status:$err" '^2:job: standard input: is a NetCDF file'
ls -l | diff .before - >.said 2>&1
is 'no file was changed, and none is new' "$(cat .said)" ''

# ---- a preview replaces only previews
cp back.png o.partial.png
gather -w 60 -o o.png t.frags
is 'a preview of an earlier run goes' "$(ls o.*)" o.png
blend -o o.partial.png back.png && cp o.partial.png own.png
gather -w 60 -o o.png t.frags
ok 'a picture without a job is no preview: it stays' cmp o.partial.png own.png
partition 8x8 | sed '$d' | rtworker t.nff >part.frags
run gather -w 60 -o o.png part.frags
is 'and a preview is not written over it: status 3' "$status:$(cmp o.partial.png own.png && printf %s "$err" | grep -c '^gather: o.partial.png: File exists$')" 3:1
blend -o p.partial.pfm back.png && blend -o q.pfm p.partial.pfm q.pfm 2>said
printf 'PF\n1 1\n-1.0\n%012d' 0 >q.partial.pfm && cp q.partial.pfm own.pfm
for name in p q; do gather -w 60 -o $name.pfm t.frags; done
is 'of a PFM, the width tells' "$(ls ./*.partial.pfm):$(cmp q.partial.pfm own.pfm && echo same)" ./q.partial.pfm:same

printf 'P6 8 12 255\n' >high.ppm && head -c 288 /dev/zero >>high.ppm
for _ in 1 2; do run gather -w 60 -b high.ppm -o r.pam part.frags; done
is 'the preview of an earlier run, under a caption, is replaced' "$status:$(ls r.*)" 1:r.partial.pam
for at in 0 1; do cp back.png c${at}0.png; done
gather -b 'c%d0.png' -e frames -o c10.png t.frags 2>said
is 'a backdrop of a later frame, with a digit behind the number' "$?:$(cut -d : -f 2- said)" '2: c10.png: is also a backdrop, expected another file'

# ---- outputs that are open descriptors
# both COMMAND: its output lands between two lines
both() { { echo before; sh -c "$1"; echo after; } >all; printf '%s %s %s' "$(head -n 1 all)" "$(tail -n 1 all | grep -ac 'after$')" "$(wc -c <all)"; }
ln -s /dev/stdout o1.png && ln -s /proc/self/fd/1 o2.png && ln -s o2.png o3.png && ln -s /dev/fd/1 o.svg
gather t.frags >want.png
bytes=$(($(wc -c <want.png) + 13))
for out in o1 o2 o3; do is "gather -o, a link to standard output: $out" "$(both "gather -o $out.png t.frags")" "before 1 $bytes"; done
is 'balance -o: the same' "$(both 'balance masterslave -j 1 -s 8x8 -o o3.png t.nff')" "before 1 $bytes"
chart -o want.svg t.tsv
cp want.svg own.svg && echo more >>own.svg
is 'chart -o: a file that is open for reading is replaced' "$(chart -o own.svg t.tsv 3<own.svg 2>&1)$(cmp own.svg want.svg && echo same)" same
is 'chart -o: the same' "$(both 'chart -o o.svg t.tsv')" "before 1 $(($(wc -c <want.svg) + 13))"
grid2pov g.vtk s.spec want.df3 >/dev/null
is 'grid2pov, /dev/fd/3' "$(both 'grid2pov g.vtk s.spec /dev/fd/3 3>&1 >/dev/null')" "before 1 $(($(wc -c <want.df3) + 13))"
finish
