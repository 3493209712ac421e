#!/bin/sh
# grid2pov: refusals, parts that it leaves out, and POV-Ray's picture of its output against vcworker's: within 2e-5 in
# every pixel if the map is smooth, 1e-4 if it is sharp. POV-Ray's rounding to 16 bits makes 7.6e-6 of that.
. "$(dirname "$0")/lib.sh"

# grid UNEVEN HOLE: 12x9x6 nodes, y descending
grid() {
	awk -v u="$1" -v hole="$2" 'BEGIN {
		print "# vtk DataFile Version 3.0\nwind\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 12 9 6"
		print "X_COORDINATES 12 double"; for (i = 0; i < 12; i++) print i * (1 + u * i)
		print "Y_COORDINATES 9 double"; for (i = 8; i >= 0; i--) print i * (1 + u * i)
		print "Z_COORDINATES 6 double"; for (i = 0; i < 6; i++) print i * (1 + 3 * u * i)
		print "POINT_DATA 648\nSCALARS wind float 1\nLOOKUP_TABLE default"
		for (k = 0; k < 6; k++) for (j = 0; j < 9; j++) for (i = 0; i < 12; i++)
			if (hole && i == 5 && j == 5 && k == 3) print "nan"
			else print 30 + 20 * sin(i / 3 + k / 2) * cos(j / 4)
	}'
}
# spec BACKGROUND [LINE ...]
spec() {
	printf '%s\n' 'up 0 0 1' 'angle 40' 'resolution 32 24' 'limit 1' "background $1"
	shift
	printf '%s\n' "$@"
}
smooth='map 10 .1 .2 .9 0
map 30 .2 .9 .3 .1
map 45 .9 .8 .1 .3
map 51 .9 .1 .1 .6'
sharp='map 31.75 .9 .3 .1 0
map 32 .9 .7 .2 20
map 32.25 .3 .3 .9 0'
outside='from 3 -9 9
at 6 4 2.5'
grid 0 0 >even.vtk
grid .02 0 >uneven.vtk
grid .02 1 >hole.vtk
spec '0 0 0' "$outside" "$smooth" >smooth.spec
spec '1 1 1' "$outside" "$smooth" >white.spec
spec '0 0 0' "$outside" "$smooth" 'attenuation .05' >far.spec
spec '0 0 0' 'from 5 4 2' 'at 9 2 3' "$smooth" >inside.spec
spec '0 0 0' 'from 4 -12 -9' 'at 6 -4 -1' 'scale 1 -1 -.5' "$smooth" >mirrored.spec
spec '0 0 0' "$outside" "$sharp" >sharp.spec
spec '1 1 1' "$outside" "$sharp" >sharp-white.spec
spec '1 1 1' "$outside" "$smooth" 'clip 1.3 -1 .4 9.75 6.6 4' >clipped.spec
spec '0 0 0' "$outside" "$smooth" 'light 1 2 3' 'iso 30 1 1 1 1' >lit.spec
spec '0 0 0' "$outside" 'iso 30 1 1 1 1' >iso.spec

run grid2pov -h
is '-h exits 0' "$status" 0
for bad in '-n 0 even.vtk smooth.spec s.df3' '-n 9999 even.vtk smooth.spec s.df3' '-y even.vtk smooth.spec s.df3' \
	'even.vtk smooth.spec' 'missing.vtk smooth.spec s.df3' 'even.vtk missing.spec s.df3' 'smooth.spec even.vtk s.df3' \
	'even.vtk iso.spec s.df3' 'even.vtk smooth.spec ./even.vtk' 'even.vtk smooth.spec smooth.spec' 'even.vtk smooth.spec \s.df3'; do
	# shellcheck disable=SC2086  # a word each
	run grid2pov $bad
	is "refused: grid2pov $bad" "$status:$out" 2:
	ok "refused: grid2pov $bad: it writes no file" [ ! -e s.df3 ]
done
gridcut -n 2,1,1 -o brick%d.vtk even.vtk
run grid2pov brick0.vtk smooth.spec s.df3
is 'refused: a brick' "$status:$out:$err" '2::grid2pov: brick0.vtk: is a brick, expected a whole grid'
run grid2pov even.vtk smooth.spec none/s.df3
is 'a file that cannot be written exits 3' "$status:$out" 3:
run grid2pov even.vtk lit.spec s.df3
is 'light and surfaces exit 1' "$status" 1
like 'light and surfaces: a message says that they are left out' "$err" '^grid2pov: lit.spec: light, iso-surfaces, slices, ground and a second field are left out'
like 'light and surfaces: the scene is still written' "$out" '^box '
is 'the field has three sizes and 4 bytes per node' "$(wc -c <s.df3)" $((6 + 4 * 12 * 9 * 6))
{ cat smooth.spec; i=52; while [ $i -le 300 ]; do echo "map $i 1 1 1 1"; i=$((i + 1)); done; } >many.spec
run grid2pov even.vtk many.spec s.df3
like 'more knots than a colour map has room for' "$status:$err" '^2:grid2pov: many.spec: 253 map lines, expected 2 to 250'

# pov GRID SPEC SAMPLES: writes POV-Ray's picture to s.ppm
pov() {
	grid2pov -n "$3" "$1.vtk" "$2.spec" s.df3 >s.pov || return
	pov_ray +Is.pov +Os.ppm +W32 +H24 File_Gamma=1 +FP16 -A -D +WT1 >povray.log 2>&1 || { tail -n 5 povray.log; return 1; }
}
# same GRID SPEC TOLERANCE METHOD: vcworker's picture is the same
same() {
	partition 32x24 | vcworker -m "$4" "$1.vtk" "$2.spec" | gather -o s.pfm || return
	imgcmp -t "$3" s.pfm s.ppm
}
differs() { same "$@"; [ $? = 1 ]; }
if command -v povray >/dev/null; then
	for grid in even uneven; do
		ok "POV-Ray renders $grid planes, smooth" pov $grid smooth 64
		for method in adaptive:1e-6 gauss:5 trapezoid:100 doubling:1e-6; do
			ok "$grid planes, smooth, $method: within 2e-5" same $grid smooth 0.00002 $method
		done
		sed 's/^map 45 .9 .8/map 45 .9 .8001/' smooth.spec >other.spec
		ok "$grid planes: a colour that is off by 1e-4 is not within 2e-5" differs $grid other 0.00002 gauss:5
		sed 's/ .3$/ .3001/' smooth.spec >other.spec
		ok "$grid planes: an extinction that is off by 1e-4 is not within 2e-5" differs $grid other 0.00002 gauss:5
		[ $grid = uneven ] || [ -n "${NIGHT-}" ] || continue # POV-Ray takes 760 samples
		sharp=sharp # on the uneven one before white, so that its alpha is seen
		[ $grid = even ] || sharp='sharp-white'
		ok "POV-Ray renders $grid planes, sharp" pov $grid $sharp 760
		for method in adaptive:1e-6 gauss:5; do
			ok "$grid planes, sharp, $method: within 1e-4" same $grid $sharp 0.0001 $method
		done
		ok "$grid planes, sharp, trapezoid:16: not within 1e-4" differs $grid $sharp 0.0001 trapezoid:16
	done
	for case in 'uneven white' 'uneven far' 'uneven inside' 'uneven mirrored' 'uneven clipped' 'hole smooth' 'hole white'; do
		# shellcheck disable=SC2086  # a word each
		ok "POV-Ray renders $case" pov $case 64
		# shellcheck disable=SC2086
		ok "$case: within 2e-5" same $case 0.00002 adaptive:1e-6
	done
else
	skip 'agreement with POV-Ray' 'povray is not installed'
fi
finish
