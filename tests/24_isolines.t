#!/bin/sh
# isolines: circles of a cone, saddles by their centre, missing values, levels between levels; backdrop: texts along lines,
# named places; names that are no text; wind; sections; refusals.
. "$(dirname "$0")/lib.sh"

# grid NAME TITLE NX NY AWK: two levels, at 0 and 10; x = i, y = j + $y0; AWK sets s at i, j and level k
grid() {
	awk -v nx="$3" -v ny="$4" -v title="$2" -v y0="${y0-0}" 'BEGIN {
		printf "# vtk DataFile Version 3.0\n%s\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS %d %d 2\n", title, nx, ny
		print "X_COORDINATES " nx " float"; for (i = 0; i < nx; i++) print i
		print "Y_COORDINATES " ny " float"; for (j = 0; j < ny; j++) print j + y0
		print "Z_COORDINATES 2 float\n0 10\nPOINT_DATA " nx * ny * 2 "\nSCALARS s float 1\nLOOKUP_TABLE default"
		for (k = 0; k < 2; k++) for (j = 0; j < ny; j++) for (i = 0; i < nx; i++) { '"$5"'; print s }
	}' >"$1.vtk"
}

# ---- the lines ---------------------------------------------------------------------------------------------
grid cone 'h [m]; x east [km]; y north [km]; z up [m]' 41 41 's = sqrt((i - 20) ^ 2 + (j - 20) ^ 2) + k'
isolines -v 5.5,12.25 cone.vtk >lines
# A chord of a cell is inside of the circle by 1/8 of its length squared over the radius; linear interpolation adds as much.
is 'isolines of a cone are circles, closed, and once round the middle' "$(awk '
	function ring() { if (n) printf "%s %s %.2f ", name, x == x0 && y == y0 ? "closed" : "open", turn / 8 / atan2(1, 1) }
	/^>/ { ring(); name = $3; n = turn = 0; next }
	{ r = sqrt(($1 - 20) ^ 2 + ($2 - 20) ^ 2); if ((r - name) ^ 2 > .03 ^ 2) printf "(%s at %s) ", r, name
	  if (n++) { c = (x - 20) * ($2 - 20) - (y - 20) * ($1 - 20); c /= r * sqrt((x - 20) ^ 2 + (y - 20) ^ 2); turn += c < 0 ? -c : c }
	  else { x0 = $1; y0 = $2 }
	  x = $1; y = $2 }
	END { ring() }' lines)" '5.5 closed 1.00 12.25 closed 1.00 '
is '-z: between two levels the field is linear' "$(isolines -mz 5 -v 6 cone.vtk | sed 's/^> line 6/> line 5.5/')" "$(isolines -v 5.5 cone.vtk)"
is 'they are at that height; with -m, on the map' "$(isolines -z 7.25 cone.vtk | head -n 1; isolines -mz 7.25 cone.vtk | head -n 1)" "$(printf '> height 7.25\n> line 5')"
is 'without options: the lowest level, and round values' "$(isolines cone.vtk | sed -n 's/^> line //p' | uniq | tr '\n' ,)" '5,10,15,20,25,'
is '-e' "$(isolines -e 7.5 cone.vtk | sed -n 's/^> line //p' | uniq | tr '\n' ,)" '7.5,15,22.5,'
# saddle A B C D VALUE: the lines of one cell, with corners counterclockwise
saddle() {
	grid saddle x 2 2 's = j ? (i ? '"$3 : $4"') : (i ? '"$2 : $1"')'
	isolines -v "$5" saddle.vtk | grep -v '>' | paste -d' ' - - | awk '{ print $1 < $3 || ($1 == $3 && $2 < $4) ? $0 : $3 " " $4 " " $1 " " $2 }' | LC_ALL=C sort -u | tr '\n' ,
}
is 'a saddle whose centre is above: round the low corners' "$(saddle 0 4 0 4 1)" '0 0.25 0.25 0,0.75 1 1 0.75,'
is 'a saddle whose centre is below: round the high corners' "$(saddle 0 4 0 4 3)" '0 0.75 0.25 1,0.75 0 1 0.25,'
is 'the other saddle, above' "$(saddle 4 0 4 0 1)" '0 0.75 0.25 1,0.75 0 1 0.25,'
is 'the other saddle, below' "$(saddle 4 0 4 0 3)" '0 0.25 0.25 0,0.75 1 1 0.75,'
grid holed x 6 3 's = i == 3 && j == 2 ? "nan" : j'
is 'a missing value breaks lines' "$(isolines -v 1.5,.5 holed.vtk | tr '\n' ,)" \
	'> line 1.5,0 1.5,1 1.5,2 1.5,> line 1.5,4 1.5,5 1.5,> line 0.5,0 0.5,1 0.5,2 0.5,3 0.5,4 0.5,5 0.5,'
grid flat x 3 3 's = 7'
is 'of a plane without heights there are none' "$(isolines flat.vtk; isolines -v 7 flat.vtk)" ''
# Each point is on one line, and no two lines share an edge: noise has all cases. As many points as edges that are crossed.
grid noise x 30 30 's = int(rand() * 5)'
is 'noise: a point for each edge that is crossed, and one more for each closed line' "$(isolines -v 1.5 noise.vtk | awk '
	/^>/ { if (n && x == x0 && y == y0) closed++; n = 0; next }
	{ all++; if (!n++) { x0 = $1; y0 = $2 } x = $1; y = $2 } END { if (x == x0 && y == y0) closed++; print all - closed }')" \
	"$(sed '1,/^LOOKUP/d' noise.vtk | awk 'NR <= 900 { v[NR - 1] = $1 > 1.5 } END {
		for (j = 0; j < 30; j++) for (i = 0; i < 30; i++) { k = 30 * j + i; n += (i < 29 && v[k] != v[k + 1]) + (j < 29 && v[k] != v[k + 30]) } print n }')"
grid globe 'p [hPa]; x lon [degrees_east]; y lat [degrees_north]; z up [m]' 21 11 's = 1000 + i'
is 'on the globe, that is the first line' "$(isolines globe.vtk | head -n 1)" '> globe'
sed '2s/.*/p [hPa]; x x [m]; y y [m]; z up [m]; proj +proj=merc +R=6371229/' globe.vtk >plane.vtk
is 'on a plane whose projection is known, that is said' "$(isolines plane.vtk | head -n 1)" '> plane'
is 'and after the lines places are in degrees again' "$(isolines plane.vtk | tail -n 1; isolines cone.vtk | grep -c '> globe')" "$(printf '> globe\n0')"
like 'on another one the first line is that of an isoline' "$(isolines cone.vtk | head -n 1)" '^> line '
sed 's/^0 10$/-0.99500000476837158 -0.10000000149011612/' cone.vtk >digits.vtk
is 'a height in the digits of the message is one of the grid' "$(for z in -.995 -0.1; do isolines -z $z -v 5 digits.vtk >lines && sed -n 1p lines; done)" \
	"$(printf '> height -0.995\n> height -0.1')"
awk '/^X_/ { x = 1 } x == 2 && /^[0-9]/ { $0 = sprintf("%.1f", 1.7e9 + $1 / 10) } /^X_/ { x = 2 } /^Y_/ { x = 0 } { print }' cone.vtk | sed 's/^X_COORDINATES 41 float/X_COORDINATES 41 double/' >seconds.vtk
is 'coordinates have their digits' "$(isolines -v 5.5 seconds.vtk | sed -n 's/^1\(7000000[0-9.]*\) 20$/\1/p' | sort -u | tr '\n' ,)" 700000001.45,700000002.55,
for bad in '' '-z 11 cone.vtk' '-e 0 cone.vtk' '-e 1 -v 1 cone.vtk' '-e 1e-9 cone.vtk' '-v x cone.vtk' 'none.vtk' '-z -1 cone.vtk' 'cone.vtk cone.vtk'; do
	# shellcheck disable=SC2086
	run isolines $bad
	is "refused: isolines $bad" "$status:$out" 2:
done
isolines cone.vtk >/dev/full 2>err
is 'a full disk is exit 3' "$?" 3

# ---- on the map --------------------------------------------------------------------------------------------
printf '%s\n' 'from 20 20 90' 'at 20 20 0' 'up 0 1 0' 'angle 40' 'resolution 600 600' 'map -1 1 0 0 1' 'map 99 1 0 0 1' >above.spec
# points NAME FILE: the points of a data block
points() { awk -v name="\$$1" '$1 == "EOD" { on = 0 } on; $1 == name { on = 1 }' "$2"; }
printf '> line 1000\n2 5\n38 5\n> line\n2 9\n38 9\n> line up\n2 12\n10 38\n' >lines
printf "> mark  O'Hare \`id\` \$(id) @x \"\\\\\n20 30\n> mark Ås\n99 99\n>mark not\n30 30\n" >>lines
backdrop cone.vtk above.spec lines >texts.gp
is 'a text is in a gap of its line' "$(points numbered texts.gp | awk '!NF { n++ } END { print n }')" 5
is 'level lines have level texts' "$(grep -c "^set label '1000' at [0-9.]*,[0-9.]* center front noenhanced\$" texts.gp)" 1
like 'a text is turned as its line is' "$(cat texts.gp)" "^set label 'up' at .* center front noenhanced rotate by 72.9"
is 'the gap is around the text' "$(points numbered texts.gp | awk -v at="$(sed -n "s/^set label '1000' at \([0-9.]*\),.*/\1/p" texts.gp)" '
	NF && n < 4 { x[++n] = $1 } END { print (at - x[2] > 15 && x[3] - at > 15 && x[3] - x[2] < 60) }')" 1
is 'a place has a dot, and its name as it is, which runs nothing' "$(points dots texts.gp | grep -c .) $(grep -c "^set label 'O''Hare \`id\` \$(id) @x \"\\\\' at" texts.gp)" '1 1'
printf '> line %s\n2 5\n38 5\n' 'back down' >down
sed 's/^up .*/up 0 -1 0/' above.spec >turned.spec
like 'no text is upside down' "$(backdrop cone.vtk turned.spec down)" "^set label 'back down' at [0-9.,]* center front noenhanced\$"
for _ in $(seq 40); do printf '> mark Somewhere\n20 20\n'; done >crowd
is 'names that would cover others are left out' "$(backdrop cone.vtk above.spec crowd | grep -c "^set label 'Somewhere'")" 2
for name in '' "$(printf 'a\033[2Jb')" "$(printf 'a\302\205')" "$(printf '\377')" "$(printf '%0101d' 0)"; do
	printf '1 2\n> mark %s\n3 4\n' "$name" >bad
	run backdrop cone.vtk above.spec bad
	is 'a name that is none is refused' "$status:$out:$err" \
		'2::backdrop: bad:2: expected a name of 1 to 100 bytes without control characters, in UTF-8'
done
printf '1 2\n> line a\ab\n3 4\n' >bad
run backdrop cone.vtk above.spec bad
like 'so is a text' "$status:$err" '^2:backdrop: bad:2: '
for _ in $(seq 100); do printf W; done >wide
{ printf '> line %s\n' "$(cat wide)"; for i in $(seq 60); do echo "$((2 + i % 2 * 36)) $i"; done; } >long
for file in long wide; do
	[ $file = long ] || { printf '> line x\n99 99\n98 98\n> mark nowhere\n-1 2\n'; } >$file
	backdrop cone.vtk above.spec $file >$file.gp
	is "texts too long, lines and places outside: no block is left without points: $file" \
		"$(sed -n 's/^plot //p' $file.gp | tr ',' '\n' | grep -c 'dots\|numbered') $(grep -c 'label.*\(WW\|nowhere\|x.\) at' $file.gp)" "$([ $file = long ] && echo 1 0 || echo 0 0)"
done
# From 80 above, 600 pixels show 2 * 80 * tan 20 of a plane: 10.303 pixels for 1. From 90 above, 9.158.
printf '> height 10\n5 5\n35 5\n> mark A\n20 20\n> line 7\n0 30\n40 30\n> height 0\n5 35\n35 35\n> plane\n5 2\n35 2\n' >raised
backdrop cone.vtk above.spec raised >raised.gp
is 'lines at heights' "$(points lines raised.gp | head -n 2; points lines1 raised.gp | head -n 2; points lines2 raised.gp | head -n 2; points numbered raised.gp | sed -n '1p;5p')" \
	"$(printf '%s\n' '162.63 135.15' '437.37 135.15' '145.45 145.45' '454.55 145.45' '162.63 437.37' '437.37 437.37' '93.94 403.03' '506.06 403.03')"
printf '> height 11\n' >bad
run backdrop cone.vtk above.spec bad
is 'a height outside of the grid is refused' "$status:$err" '2:backdrop: bad:1: expected a height of the grid, from 0 to 10'
seq 0 .01 10 | sed 's/^/> height /' >bad
run backdrop cone.vtk above.spec bad
is 'so are too many' "$status:$err" '2:backdrop: bad:101: expected at most 100 heights'
if [ -n "$(command -v gnuplot)" ]; then
	printf '%s\n' 'from 20 20 90' 'at 20 20 0' 'up 0 1 0' 'angle 40' 'resolution 120 90' 'map 0 1 0 0 1' 'map 99 1 0 0 1' 'slice z 10 .8' >slice.spec
	partition 120x90 | vcworker cone.vtk slice.spec >slice.frags
	gather -k 16 -o slice.png slice.frags
	backdrop -o map.png -f front.png -m raised cone.vtk slice.spec
	blend -k 16 -o under.png slice.png map.png
	blend -k 16 -o whole.png front.png under.png
	gather -k 16 -f front.png -b map.png -o over.png slice.frags
	ok 'gather -f: over the picture, as blend has it' imgcmp -t 3e-5 over.png whole.png
	ok 'balance draws them over it' balance ds -j 1 -k 16 -m raised -o balance.png cone.vtk slice.spec
	ok 'and all is the same picture' imgcmp -t 3e-5 balance.png whole.png
	ok 'the slice does not cover lines on it' [ "$(imgcmp -t .2 whole.png under.png | awk '$1 == "differing" { print $2 }')" -gt 100 ]
	printf '%s\n' 'from 8 -60 70' 'at 20 18 0' 'up 0 0 1' 'angle 36' 'resolution 900 600' 'map -1 1 0 0 1' 'map 99 1 0 0 1' >oblique.spec
	backdrop cone.vtk oblique.spec lines >texts.gp
	ok 'gnuplot draws them, and says nothing' sh -c 'gnuplot texts.gp >texts.png 2>said && [ ! -s said ]'
	if there "$root/build/unit/test_paint"; then
		backdrop cone.vtk oblique.spec raised | gnuplot >high.png
		"$root/build/unit/test_paint" cone.vtk oblique.spec raised painted.ppm
		ok 'a window paints lines at heights there, too' imgcmp -t .15 -f .004 painted.ppm high.png
		"$root/build/unit/test_paint" cone.vtk oblique.spec lines painted.ppm
		ok 'a window paints them in the same places' imgcmp -t .15 -f .004 painted.ppm texts.png
	fi
else skip 'lines with texts as pictures' 'there is no gnuplot'; fi

# ---- barbs -------------------------------------------------------------------------------------------------
# barb EAST NORTH UNIT AXES [OPTION ...]: one barb on a square from 0 to 10
barb() {
	east=$1 north=$2 unit=$3 axes=$4
	shift 4
	grid u "U [$unit]$axes" 2 2 "s = $east"
	grid v "V [$unit]$axes" 2 2 "s = $north"
	barbs -n 1 "$@" u.vtk v.vtk | awk '/^[^>]/ { $0 = sprintf("%.3f %.3f", $1 + 1e-9, $2 + 1e-9) } { printf "%s,", $0 }'
}
if ldd "$BIN/barbs" | grep -q udunits; then
	is 'barbs: 65 knots from the west: a pennant, a feather and a half' "$(barb 65 0 knots '')" \
		'> line,0.500 0.500,-0.300 0.500,-0.300 0.500,-0.360 0.836,-0.180 0.500,-0.060 0.500,-0.180 0.836,-0.060 0.500,0.060 0.500,0.000 0.668,0.060 0.500,'
	is 'units are converted, and 5 knots alone are not at the end' "$(barb 0 2.572 'm s-1' '')" '> line,0.500 0.500,0.500 -0.300,0.500 -0.180,0.332 -0.240,0.500 -0.180,'
	is 'below 2.5 knots: a circle' "$(barb 1 1 knots '' | tr , '\n' | awk 'NR > 1 && NF { printf "%.3f\n", sqrt(($1 - .5) ^ 2 + ($2 - .5) ^ 2) }' | uniq)" 0.096
	grid u 'U [knots]' 11 3 's = 10'
	cp u.vtk v.vtk
	is 'a narrow grid has a row of barbs in its middle' "$(barbs -n 2 u.vtk v.vtk | sed -n '/^>/{n;p;}' | tr '\n' ,)" '2.5 1,7.5 1,'
	globe='; x lon [degrees_east]; y lat [degrees_north]; z up [m]'
	is 'south of the equator feathers are on the other side; a degree of longitude is shorter' "$(for y in 59.5 -60.5; do
		for part in u v; do y0=$y grid $part "$part [knots]$globe" 2 2 's = 10'; done
		barbs -n 1 u.vtk v.vtk | awk 'NR == 3 { x = $1; y = $2 } NR == 4 { dx = x - $1; dy = y - $2 } NR == 6 { fx = $1 - x; fy = $2 - y }
			END { printf "%.3f %s ", dx / dy, (dx * fy - dy * fx > 0) ? "left" : "right" }'
	done)" '2.000 left 2.000 right '
	for part in u v; do grid $part "$part [knots]; x x [m]; y y [m]; z up [m]; proj +proj=merc +R=6371229" 2 2 's = 10'; done
	is 'after barbs on a plane places are in degrees again' "$(barbs u.vtk v.vtk | sed -n '1p;$p')" "$(printf '> plane\n> globe')"
	for bad in 'u.vtk' 'u.vtk cone.vtk' 'u.vtk flat.vtk' '-z 11 u.vtk v.vtk' '-n 0 u.vtk v.vtk'; do
		# shellcheck disable=SC2086
		run barbs $bad
		is "refused: barbs $bad" "$status:$out" 2:
	done
else skip 'barbs' 'it was built without libudunits2'; fi

# ---- section -----------------------------------------------------------------------------------------------
grid slope 'T [K]; x east [km]; y north [km]; z -p [hPa]; t time 1 [hours]' 21 11 's = i + 100 * j + 1000 * k'
section -l 2,1,14,6 -n 3 slope.vtk >section.vtk
is 'section: its title' "$(sed -n 2p section.vtk)" 'T [K]; x distance [km]; y across [km]; z -p [hPa]; t time 1 [hours]'
is 'linear values of each level, twice' "$(tail -c 49 section.vtk | od -An -tf4 --endian=big -w24 -N 48 | tr -s ' \n' ' ')" \
	' 102 358 614 102 358 614 1102 1358 1614 1102 1358 1614 '
like 'the distance along the line' "$(gridspec section.vtk)" '^# x: 0 to 13 km$'
# From 0 E 60 N to 90 E 60 N the great circle is 4604.5 km, and half-way at 67.79 N.
grid round 'T [K]; x lon [degrees_east]; y lat [degrees_north]; z up [m]' 91 91 's = j'
section -l 360,60,-270,60 -n 3 round.vtk >section.vtk
is 'section: the great circle, and whole circles' "$(tail -c 49 section.vtk | od -An -tf4 --endian=big -w12 -N 12 | awk '{ printf "%.2f %.2f %.2f", $1, $2, $3 }')" '60.00 67.79 60.00'
like 'its length' "$(gridspec section.vtk)" '^# x: 0 to 4604[.]5[0-9]* km'
like 'gridspec: from the side, as a slice' "$(gridspec section.vtk | grep '^slice' | tr '\n' ,)" '^slice y [0-9.]* 1,$'
section -l 0,1,5,1 -n 6 holed.vtk >section.vtk
is 'a neighbour that does not count may be missing' "$(tail -c 97 section.vtk | od -An -tf4 --endian=big -w24 -N 24 | tr -s ' ')" ' 1 1 1 1 1 1'
# Half a great circle from 0 E 60 N to 90 E 60 N, on a plane whose y is R ln tan (45 + lat / 2): 67.79 N is y = 10361 km.
sed '2s/.*/T [K]; x x [km]; y y [km]; z up [m]; proj +proj=merc +R=6371000/' round.vtk |
	awk '/^[XY]_/ { a = $1 } a && /^[0-9]/ { $0 = a ~ /X/ ? $1 * 120 : $1 * 120 + 5000 } /^Z_/ { a = "" } { print }' >plane.vtk
if ldd "$BIN/section" | grep -q libproj; then
	section -l 0,60,90,60 -n 3 plane.vtk >section.vtk
	is 'on a plane whose projection is known places are in degrees, too, on the great circle' "$(tail -c 49 section.vtk | od -An -tf4 --endian=big -w12 -N 12 |
		awk '{ for (i = 1; i <= 3; i++) printf "%.1f ", 2 * atan2(exp(($i * 120 + 5000) / 6371), 1) * 57.29578 - 90 }')" '60.0 67.8 60.0 '
	is 'and the section has no projection' "$(sed -n 2p section.vtk)" 'T [K]; x distance [km]; y across [km]; z up [m]'
	run section -l 0,60,90,10 plane.vtk
	like 'a place outside is refused' "$status:$out:$err" '^2::section: -l: 90,10 is outside of the grid, expected longitude and latitude in it$'
fi
sed 's/^40$/39.9949989/' cone.vtk >edge.vtk
section -l 1,1,39.995,1 -n 2 edge.vtk >section.vtk
like 'a place in six digits of the edge is in the grid' "$(gridspec section.vtk)" '^# x: 0 to 38[.]995'
for bad in 'cone.vtk' '-l 1,2,3 cone.vtk' '-l 1,2,1,2 cone.vtk' '-l 1,2,3,99 cone.vtk' '-l 1,2,3,4 -n 1 cone.vtk' '-l 1,2,3,4 none.vtk'; do
	# shellcheck disable=SC2086
	run section $bad
	is "refused: section $bad" "$status:$out" 2:
done
finish
