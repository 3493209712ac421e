#!/bin/sh
# backdrop, coastlines, blend: the map puts places where vcworker sees them; what covers what; refusals.
. "$(dirname "$0")/lib.sh"
needs gnuplot /usr/share/gmt-gshhg

# pixel R G B A: a PAM of one, MAXVAL 255, samples in octal
pixel() {
	printf 'P7\nWIDTH 1\nHEIGHT 1\nDEPTH 4\nMAXVAL 255\nTUPLTYPE RGB_ALPHA\nENDHDR\n'
	# shellcheck disable=SC2059  # they are escapes
	printf "\\$1\\$2\\$3\\$4"
}
samples() { tail -c 12 "$1" | od -An -t f4 --endian=little | awk '{ printf "%.4f %.4f %.4f", $1, $2, $3 }'; }

# ---- blend -------------------------------------------------------------------------------------------------
pixel 377 000 000 200 >red.pam # alpha 128/255
pixel 000 000 377 377 >blue.pam
pixel 000 377 000 000 >clear.pam
blend -o both.pfm red.pam blue.pam
is 'half of red over blue, in linear light' "$(samples both.pfm)" '0.5020 0.0000 0.4980'
blend -o three.pfm clear.pam red.pam blue.pam
ok 'a transparent picture changes nothing' imgcmp three.pfm both.pfm
blend -o under.pfm blue.pam red.pam
is 'an opaque picture hides the one under it' "$(samples under.pfm)" '0.0000 0.0000 1.0000'
blend -k 16 red.pam clear.pam >still.png
ok 'alpha is kept' imgcmp -t 1e-4 still.png red.pam
blend - blue.pam <red.pam >piped.png
blend -o file.png red.pam blue.pam
ok 'blend reads - and writes standard output' cmp piped.png file.png
blend -b 0,0,1 -o ground.pfm red.pam
is '-b: half of red over blue' "$(samples ground.pfm)" '0.5020 0.0000 0.4980'
printf 'P6 2 1 255\n123456' >wide.ppm
{ printf 'P6 3000 1000 255\n'; head -c 9000000 /dev/zero; } >large.ppm
ok 'blend: the memory does not grow with the number of pictures' prlimit --as=200000000 \
	blend -o large.pfm large.ppm large.ppm large.ppm large.ppm large.ppm large.ppm large.ppm large.ppm
# column FILE RED GREEN BLUE ALPHA (octal) HEIGHT: a picture one pixel wide
column() {
	printf 'P7\nWIDTH 1\nHEIGHT %d\nDEPTH 4\nMAXVAL 255\nTUPLTYPE RGB_ALPHA\nENDHDR\n' "$6" >"$1"
	for _ in $(seq "$6"); do printf "\\$2\\$3\\$4\\$5"; done >>"$1"
}
column nothing.pam 377 000 000 000 1
column low.pam 000 377 000 377 1
column high.pam 000 000 377 377 2
blend -o heights.pam nothing.pam low.pam high.pam
is 'blend: pictures of the height of the first are at the top with it' "$(tail -c 6 heights.pam | od -An -tu1)" '   0 255   0   0   0 255'
column clear2.pam 000 000 000 000 2
column all.pam 000 000 377 377 3
blend -o heights.pam nothing.pam clear2.pam low.pam all.pam
is 'and those behind one of another height are at the bottom' "$(tail -c 9 heights.pam | od -An -tu1)" \
	'   0   0 255   0   0 255   0 255   0'
run blend red.pam wide.ppm
is 'sizes that differ are refused' "$status:$err" '2:blend: wide.ppm has 2x1 pixels, expected a width of 1, as the picture with it'
for bad in '' '-b 1,2 red.pam' '-k 9 red.pam blue.pam' '-o x.gif red.pam blue.pam' '- -' 'red.pam none.png'; do
	# shellcheck disable=SC2086
	run blend $bad
	is "refused: blend $bad" "$status:$out" 2:
done
blend red.pam blue.pam >/dev/full 2>err
is 'a full disk is exit 3' "$?" 3

# ---- backdrop: places of the lowest plane ----------------------------------
cat >wall.vtk <<'END'
# vtk DataFile Version 3.0
x
ASCII
DATASET RECTILINEAR_GRID
DIMENSIONS 2 2 2
X_COORDINATES 2 float
0 20
Y_COORDINATES 2 float
40 50
Z_COORDINATES 2 float
-1000 -990
POINT_DATA 8
SCALARS x float 1
LOOKUP_TABLE default
0 20 0 20 0 20 0 20
END
cat >wall.spec <<'END'
from 7 20 -70
at 10 45 -100
up 0 0 1
angle 40
resolution 300 200
scale 1 1 .1
map -1 1 0 0 1e6
map 30 1 0 0 1e6
END
printf '# a meridian, around the globe\n372 41\n-348 45\n12 49\n> far away\n100 45\n' >line
backdrop -t "it's x" -z -hPa wall.vtk wall.spec line >wall.gp
# block NAME FILE: prints the points of a data block
block() { awk -v name="\$$1" '$1 == "EOD" { on = 0 } on && NF; $1 == name { on = 1 }' "$2"; }
is 'the line is on the map, where the grid is' "$(block lines wall.gp | wc -l)" 3
# The camera's view of the line by the rules of NFF: 100 pixels are half the height of the frame.
is 'the points of the line are where the camera sees them' "$(block lines wall.gp | tr '\n' ' ')" "$(awk 'BEGIN {
	pi = atan2(0, -1)
	fx = 3; fy = 25; fz = -30; f = sqrt(fx * fx + fy * fy + fz * fz); fx /= f; fy /= f; fz /= f
	r = sqrt(fx * fx + fy * fy); rx = fy / r; ry = -fx / r
	ux = ry * fz; uy = -rx * fz; uz = rx * fy - ry * fx
	half = sin(pi / 9) / cos(pi / 9)
	for (y = 41; y <= 49; y += 4) {
		dx = 12 - 7; dy = y - 20; dz = -100 + 70
		d = (dx * fx + dy * fy + dz * fz) * half
		printf "%.2f %.2f ", 150 + 100 * (dx * rx + dy * ry) / d, 100 + 100 * (dx * ux + dy * uy + dz * uz) / d
	}
}')"
# vcworker renders a flat, opaque grid; gnuplot draws its lowest plane in the same red.
sed 's/^-1000 -990$/-1000 -999.99/' wall.vtk >flat.vtk
partition 300x200 | vcworker flat.vtk wall.spec | gather -k 16 -o flat.png
printf 'P6 300 200 255\n' >black.ppm
head -c 180000 /dev/zero >>black.ppm
blend -o seen.png flat.png black.ppm
backdrop flat.vtk wall.spec | sed '/^set label/d; /^set object/d; s/#f6f6f6/black/; s/size 300,[0-9]*/size 300,200/; s/^set yrange.*/set yrange [.5:199.495]/
	s/^plot .*/plot $plane with filledcurves closed fs solid noborder fc rgb "red"/' | gnuplot >plane.png
ok 'gnuplot and vcworker fill the same pixels, except at the edge' imgcmp -t .75 -f .0005 seen.png plane.png
run imgcmp -t .75 -f .1 seen.png black.ppm
is 'gnuplot fills many pixels' "$status" 1

# ---- areas: they fill the pixels in which vcworker sees a grid of the same extent -------------------------------------------
# filled NAME X Y SPEC [PART]: what lines.txt has, against a flat grid between these longitudes and latitudes; so great
# a part of the pixels may differ, those at its edge
filled() {
	sed "s/^0 20\$/$2/; s/^40 50\$/$3/; s/^-1000 -990\$/-1000 -999.99/; s/^0 20 0.*/10 10 10 10 10 10 10 10/" wall.vtk >part.vtk
	partition 300x200 | vcworker part.vtk "$4" | gather -k 16 -o part.png
	blend -o seen.png part.png black.ppm
	backdrop flat.vtk "$4" lines.txt | sed '/^set label/d; /^set object/d; s/#f6f6f6/black/; s/size 300,[0-9]*/size 300,200/; s/^set yrange.*/set yrange [.5:199.495]/
		s/^plot .*/plot $area0 with filledcurves closed fs solid noborder fc rgb "red"/' | gnuplot >area.png
	ok "$1" imgcmp -t .75 -f "${5-.0005}" seen.png area.png
	run imgcmp -t .75 -f .01 seen.png black.ppm
	is "$1: many pixels are filled" "$status" 1
}
printf '> land\n365 42\n-348 42\n12 48\n5 48\n' >lines.txt
filled 'an area, which is where the grid is' '5 12' '42 48' wall.spec
printf '> land\n10 45\n30 45\n30 60\n10 60\n10 45\n' >lines.txt
filled 'is cut at the edges of the map' '10 20' '45 50' wall.spec
printf '>  land\n355 41\n5 41\n5 46\n355 46\n' >lines.txt
filled 'goes on beyond Greenwich' '0 5' '41 46' wall.spec
for ring in '15 105 195 285' '285 195 105 15'; do
	{ echo '> land'; for x in $ring; do echo "$x 46"; done; } >lines.txt
	filled "round the globe, $ring: to the nearer pole" '0 20' '46 50' wall.spec
done
# The eye is above the map, and looks along it: half of the map lies behind. gnuplot halves pixels at the picture's edge.
sed 's/^from.*/from 10 45.2 -99.4/; s/^at.*/at 10 50 -100.3/; s/^angle.*/angle 80/' wall.spec >within.spec
printf '> land\n3 41\n17 41\n17 49\n3 49\n' >lines.txt
filled 'what is behind the eye is cut off' '3 17' '41 49' within.spec .01
{
	printf '> land\n0 41\n20 41\n20 49\n0 49\n> water\n3 42\n17 42\n17 48\n3 48\n> land\n5 43\n7 43\n7 45\n5 45\n'
	printf '> land\n1 41.5\n1.01 41.5\n1.01 41.51\n'
} >lines.txt
backdrop wall.vtk wall.spec lines.txt >areas.gp
is 'lakes are drawn over land, islands over lakes' "$(tail -n 1 areas.gp | grep -o 'area[0-9] with filledcurves closed fs solid noborder fc rgb .#......' | sed 's/ .*#/ /' |
	tr '\n' ';' | sed "s/$(sed -n 's/.*define LAND 0x\(.*\)u/\1/p' "$root/lib/backdrop/drawing.h")/land/g")" \
	"$(sed -n 's/.*define SEA 0x\(.*\)u/area0 land;area1 \1;area2 land;/p' "$root/lib/backdrop/drawing.h")"
is 'areas smaller than a pixel are left out' "$(block area2 areas.gp | wc -l):$(block lines areas.gp | wc -l)" 5:15

# ---- labels ------------------------------------------------------------------------------------------
like 'quotes in a title are text' "$(cat wall.gp)" "^set label 'it''s x' at"
like 'negated heights are labelled with their own sign' "$(grep '^set label' wall.gp)" "^set label '1000 hPa' at"
like 'longitudes are labelled' "$(grep '^set label' wall.gp)" "^set label '12°E' at"
like 'latitudes are labelled' "$(grep '^set label' wall.gp)" "^set label '42°N' at"
# titled TITLE [OPTION ...]: prints the labels of a grid with that title, with commas between
titled() {
	sed "2s,.*,$1," wall.vtk >titled.vtk
	shift
	backdrop "$@" titled.vtk wall.spec line | sed -n "s/^set label '\(.*\)' at .*/\1/p" | tr '\n' ,
}
sed '2s/.*/T [K]; x x [m]; y y [m]; z z [m]/; s/^40 50$/0 .02/' wall.vtk >stretched.vtk
sed 's/^scale .*/scale 1 500 .1/; s/^from 7 20/from 7 -20/; s/^at 10 45/at 10 5/' wall.spec >stretched.spec
like 'where y is stretched, labels of both axes are beside the map' \
	"$(backdrop stretched.vtk stretched.spec | sed -n "s/^set label '\(.*\)' at .*/\1/p" | tr '\n' ,)" '^0 m,4 m,8 m,.*,16 m,0.005 m,.*,0.02 m,-1000 m,'
like "labels have the units of the grid's title" "$(titled 'speed [m/s]; x lon [degrees_east]; y lat [degrees_north]; z -lev [hPa]; t time 0 [d]')" \
	'^0°,4°E,.*,42°N,.*,1000 hPa,.*,time 0 d,speed, m/s,$'
{ grep -v '^map' wall.spec; printf '%s\n' 'map 1013250 1 0 0 1' 'map 1013256 0 1 0 1'; } >precise.spec
like 'values of the legend have all their digits' "$(backdrop wall.vtk precise.spec | sed -n "s/^set label '\(.*\)' at .*/\1/p" | tr '\n' ,)" \
	',1013250,1013252,1013254,1013256,'
{ grep -v '^map' wall.spec; printf 'map %s 1 0 0 1\n' 4 33.8 34.125 34.5 35 41 97; } >crowded.spec
like 'a legend with crowded values has intervals of one length' "$(backdrop wall.vtk crowded.spec | sed -n "s/^set label '\(.*\)' at .*/\1/p" | tr '\n' ,)" \
	',4,33.8,34.1,34.5,35,41,97,'
{ grep -v '^map' wall.spec; printf 'map %s 1 0 0 1\n' 44 100 130 1380 1410 1460 5640 5680 11170 11200 11230 11253; } >wide.spec
like 'long values have room between them' "$(backdrop -s 800x560 wall.vtk wide.spec | sed -n "s/^set label '\(.*\)' at .*/\1/p" | tr '\n' ,)" \
	',5680,11170,11230,'
{ grep -v '^map' wall.spec; printf 'profile 0 20\n'; printf 'map %s 1 0 0 1\n' 0 9; } >deviation.spec
like 'with a profile, the title is a deviation' "$(backdrop wall.vtk deviation.spec)" "^set label 'deviation of "
like 'labels of a grid on a plane are metres' "$(titled 'T [K]; x lambert_x [m]; y lambert_y [m]; z heightAboveGround [m]; t')" \
	'^0 m,4 m,.*,42 m,.*,-1000 m,.*,T, K,$'
for x in 'grid_longitude [degrees]; y grid_latitude [degrees]' 'rlon [degrees]; y rlat [degrees]'; do
	like "labels of a rotated sphere are plain degrees: $x" "$(titled "T [K]; x $x; z height [m]")" '^0°,2°,.*,42°,44°,.*,T, K,$'
done
like 'degrees west are not labelled as east' "$(titled "T [K]; x lon [degrees_west]; y lat [degrees_north]; z height [m]")" \
	'^0 degrees_west,'
like 'options override the title of the grid' "$(titled 'T [K]; x lon []; y lat []; z -depth [m]' -z Pa -t heat)" '^0°,.*,-1000 Pa,.*,heat,$'
backdrop -z -hectopascal_or_millibar wall.vtk wall.spec >long.gp
is 'where heights have no room for their unit, they are numbers, and the unit is there once' \
	"$(grep -c "^set label '[19][90][0-9]*' at" long.gp):$(grep -c hectopascal long.gp)" 2:1
sed '2s/.*/T [K]; z -ocean_sigma_coordinate [1]/' wall.vtk >sigma.vtk
is 'so are names of levels' "$(backdrop sigma.vtk wall.spec | grep -c ocean)" 1
like 'any title is accepted' "$(titled 'x [; z [[]; x [')" '^0°,4°E,.*,-1000 ,.*,x,$'
sed '2s,.*,T [K]; x a [km]; y b [km],' wall.vtk >titled.vtk
printf '372 41\n375 49\n\n2 41\n18 41\n' | backdrop titled.vtk wall.spec - >titled.gp
is 'on a plane lines do not go round the globe' "$(block lines titled.gp | wc -l)" 2
is 'nor on a rotated sphere' "$(sed '2s,.*,T [K]; x rlon [degrees]; y rlat [degrees],' wall.vtk >rotated.vtk
	printf '372 41\n375 49\n\n2 41\n18 41\n' | backdrop rotated.vtk wall.spec - >rotated.gp; block lines rotated.gp | wc -l)" 2
printf '> globe\n372 41\n12 49\n' >globe
backdrop wall.vtk wall.spec globe >globe.gp
is 'lines of the globe are on the map' "$(block lines globe.gp | wc -l)" 2
for grid in titled rotated; do
	run backdrop $grid.vtk wall.spec globe
	is "they are refused where x is no longitude: $grid" "$status:${#out}:$err" \
		'2:0:backdrop: globe:1: longitudes and latitudes, which x and y of the grid are not, expected lines in its coordinates, or none'
done
# The eye is above, and beyond the low end of y: one edge is between these two sides.
is 'the front edge is left out' "$(block edges wall.gp | wc -l)" $((11 * 65))
# C has no degree sign.
for locale in C C.UTF-8; do
	ok "gnuplot draws it, and says nothing: locale $locale" \
		sh -c 'LC_ALL=$0 gnuplot wall.gp >$0.png 2>said && [ ! -s said ]' "$locale"
done
ok 'the map is the same in every locale' cmp C.png C.UTF-8.png
mv C.png wall.png
like 'the map has the size of the specification, and a strip below' "$(imgcmp wall.png wall.png)" 'size	300x229'
backdrop -s 90x60 wall.vtk wall.spec | gnuplot >small.png
like '-s sets another size' "$(imgcmp small.png small.png)" 'size	90x89'

# A window paints it by itself.
sed '2s/.*/T [K]; z -p [hPa]; t time 1 [hours since 2026-11-23]/' wall.vtk >hour.vtk
sed 's/^resolution .*/resolution 900 600/' wall.spec >large.spec
if there "$root/build/unit/test_paint"; then
	backdrop hour.vtk large.spec lines.txt | gnuplot >drawn.png
	ok 'painted: a file' "$root/build/unit/test_paint" hour.vtk large.spec lines.txt painted.ppm
	ok 'what is painted is where gnuplot draws it' imgcmp -t .15 -f .004 painted.ppm drawn.png
	sed 's/^at .*/at 10.1 45 -100/' large.spec >moved.spec
	"$root/build/unit/test_paint" hour.vtk moved.spec lines.txt painted.ppm
	run imgcmp -t .15 -f .004 painted.ppm drawn.png
	is 'a view that is turned a little is another picture' "$status" 1
else
	skip 'painted backgrounds' 'test_paint is not built'
fi

printf '1 2\n\n3\n' >bad.line
mkfifo spec.pipe
run timeout 20 backdrop -o no.png wall.vtk spec.pipe
is 'a pipe with -o: refused' "$status:$err" '2:backdrop: spec.pipe: is a pipe or a device, expected a file'
printf '1 1\n2 2\n\000\nwords\n' >zero.line
run backdrop wall.vtk wall.spec zero.line
is 'a line file with a byte 0: refused' "$status:$err" '2:backdrop: zero.line: has a byte 0, expected text'
run backdrop wall.vtk wall.spec bad.line
is 'a line that is none is refused' "$status:$out:$err" \
	'2::backdrop: bad.line:3: expected longitude and latitude'
for bad in '' wall.vtk '-s 0x3 wall.vtk wall.spec' 'wall.spec wall.vtk' 'none.vtk wall.spec' \
	'wall.vtk wall.spec none'; do
	# shellcheck disable=SC2086
	run backdrop $bad
	is "refused: backdrop $bad" "$status:$out" 2:
done
backdrop wall.vtk wall.spec >/dev/full 2>err
is 'a full disk is exit 3, too' "$?" 3

# ---- a second field: its colours, name and unit ------------------------------------------------------------
for hour in 0 1 2; do sed "2s/.*/T [K]; z -p [hPa]; t time $hour [hours since 2026-11-23]/" wall.vtk >hour$hour.vtk; done
{ cat wall.spec; printf 'colour 5 0 0 1\ncolour 15 0 1 0\n'; } >second.spec
# bytes TITLE LEVELS: a grid with the corners 1 and 3, in bytes
bytes() {
	printf '# vtk DataFile Version 3.0\n%s\nBINARY\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 %s\n' "$1" "$2"
	printf 'X_COORDINATES 2 char\n\1\3\nY_COORDINATES 2 char\n\1\3\nZ_COORDINATES %s char\n\1' "$2"
	if [ "$2" = 2 ]; then printf '\3'; fi
	printf '\nPOINT_DATA %s\nSCALARS s%s char 1\nLOOKUP_TABLE default\n\1\3\2#' $((4 * $2)) "$2"
	if [ "$2" = 2 ]; then printf '\3\3\1\1'; fi
	echo
}
sed '2s,.*,wind [m/s]; z height [Pa],' wall.vtk | cat hour0.vtk - >text.vtk
{ bytes 'T [K]; z lev [m]' 2; bytes h 1; bytes 'wind [m/s]' 2; } >bytes.vtk
{ bytes 'T [K]; z lev [m]' 2; bytes '' 2; } >unnamed.vtk
for grid in text bytes unnamed; do
	name='wind, m/s'
	[ $grid != unnamed ] || name=s2
	backdrop $grid.vtk second.spec >second.gp
	is "$grid: the legend has the name and the values of the second field" \
		"$(sed -n "s/^set label '\([^°]*\)' at.*/\1/p" second.gp | grep -v 'm$\|hPa$\|UTC$' | tr '\n' ,)" "6,8,10,12,14,$name,"
	backdrop -o second.png $grid.vtk second.spec
	backdrop -o titled.png -t "$name" $grid.vtk second.spec
	ok "$grid: and in the picture" cmp second.png titled.png
done
like 'the first field has its name without colour lines' "$(backdrop bytes.vtk wall.spec)" "^set label 'T, K' at"
for hour in 1 2; do sed '2s,.*,wind [m/s],' wall.vtk | cat hour$hour.vtk - >two$hour.vtk; done
sed '2s,.*,cloud [1],' wall.vtk | cat hour1.vtk - >two3.vtk
backdrop -o two%d.png -c caption%d.png two1.vtk two2.vtk two3.vtk second.spec
is 'a second field of another name has another caption' "$(cmp -s two0.png two1.png; echo $?) $(cmp -s caption0.png caption2.png; echo $?)" '0 1'
sed '$d' text.vtk >torn.vtk
run backdrop -o torn.png torn.vtk second.spec
like 'a second field that is torn is refused' "$status:$out$err" '^2:backdrop: torn.vtk:[0-9]*: '
sed '1s/.*/# VTK DATAFILE VERSION 2.0/' hour0.vtk >capitals.vtk
ok 'a first line in capitals' backdrop -o capitals%d.png capitals.vtk capitals.vtk wall.spec
sed 's/^resolution .*/resolution 48 60/' wall.spec >high.spec
balance adaptive -j 2 -m none: -o both%d.png hour0.vtk wall.spec high.spec
for at in 0 1; do
	spec=$([ $at = 1 ] && echo high.spec || echo wall.spec)
	balance interleaved -j 1 -m none: -o alone.png hour0.vtk $spec
	ok "balance -m: of two sizes, each picture is that which it is alone: $spec" cmp both$at.png alone.png
done
ok 'balance -m: a second field' balance adaptive -j 2 -m none: -o second-m.png bytes.vtk second.spec

# ---- many maps: backdrop -o --------------------------------------------------------------------------------
like 'levels without a unit have their name' "$(titled 'T [K]; x lon [degrees_east]; y lat [degrees_north]; z -sigma [1]')" ',sigma 1000,'
for time in 'time 36.5 [hours since 2026-11-22 00:00:00]=2026-11-23 12:30 UTC' 'validity 202611231200 [YYYYMMDDhhmm]=2026-11-23 12:00 UTC' \
	'time 2 [months since 2026-01-01]=time 2 months since 2026-01-01'; do
	like "the time ${time%%=*}" "$(titled "T [K]; x lon []; y lat []; z lev [m]; t ${time%%=*}")" ",${time#*=},T, K,\$"
done
sed 's/^from.*/from 12 22 -70/' wall.spec >other.spec
ok 'backdrop -o: maps of three grids and two specifications' backdrop -o m%d.png -c c%d.png -m line hour?.vtk wall.spec other.spec
is 'grids with the same axes have the same map, each specification another one' \
	"$(for i in 1 2 3 4 5; do cmp -s m0.png m$i.png; printf '%s ' $?; done)" '1 0 1 0 1 '
is 'each time has its caption' "$(for i in 1 2 3 4 5; do cmp -s c0.png c$i.png; printf '%s ' $?; done)" '0 1 1 1 1 '
backdrop -o whole%d.png -m line hour?.vtk wall.spec
like 'a caption is low' "$(imgcmp c0.png c0.png)" 'size	300x11'
# The terminal is there, but it cannot draw.
mkdir broken none
printf '#!/bin/sh\necho >&2; echo "     ^" >&2; echo "line 7: no such terminal" >&2; exit 1\n' >broken/gnuplot
printf '#!/bin/sh\nhead -c 99 "$2"\n' >none/gnuplot
chmod +x broken/gnuplot none/gnuplot
run env PATH="$tmp/broken:$PATH" backdrop -o no%d.png hour?.vtk wall.spec
is 'gnuplot fails: one line says why' "$status:$(printf '%s\n' "$err" | grep -v '^gnuplot:\|^sh:')" '3:backdrop: gnuplot failed: line 7: no such terminal'
run env PATH="$tmp/none:$PATH" backdrop -o no%d.png hour?.vtk wall.spec
is 'gnuplot draws nothing' "$status:$err" '3:backdrop: gnuplot failed: picture 1 of 3: not a PNG, expected one'
mkdir path
for program in sh env grep sed; do ln -s "$(command -v $program)" path/$program; done
run env PATH="$BIN:$tmp/path" backdrop -o no%d.png hour?.vtk wall.spec
like 'gnuplot is missing' "$status:$err" '^3:backdrop: gnuplot is not there, expected .*gnuplot-nox$|backdrop: gnuplot is not there, expected .*gnuplot-nox$'
is 'no picture is left' "$(ls no?.png 2>/dev/null)" ''
for bad in '-o m.png hour0.vtk hour1.vtk wall.spec' '-o m%d.pam hour0.vtk wall.spec' '-o m%d.png hour0.vtk' '-c c.png hour0.vtk wall.spec' \
	'-o m.png -m none hour0.vtk wall.spec' '-o m.png -f m.png hour0.vtk wall.spec' '-o m.png -c n.png -f n.png hour0.vtk wall.spec'; do
	# shellcheck disable=SC2086
	run backdrop $bad
	is "refused: backdrop $bad" "$status:$out" 2:
done

# ---- planes of projection ----------------------------------------------------------------------------------
# plane NAME X0 X1 Y0 Y1 UNIT PROJ: a grid on a plane, seen from above, 200 pixels wide and high. Its middle is in the middle.
plane() {
	cat >"$1.vtk" <<-END
		# vtk DataFile Version 3.0
		T [K]; x x [$6]; y y [$6]; z height [m]; t time 0 [d]; proj $7
		ASCII
		DATASET RECTILINEAR_GRID
		DIMENSIONS 2 2 2
		X_COORDINATES 2 double
		$2 $3
		Y_COORDINATES 2 double
		$4 $5
		Z_COORDINATES 2 float
		0 1
		POINT_DATA 8
		SCALARS T float 1
		LOOKUP_TABLE default
		0 20 0 20 0 20 0 20
	END
	awk -v x0="$2" -v x1="$3" -v y0="$4" -v y1="$5" 'BEGIN {
		wide = x1 - x0; x = (x0 + x1) / 2 / wide; y = (y0 + y1) / 2 / wide
		printf "from %.12g %.12g 2\nat %.12g %.12g 0\nup 0 1 0\nangle 33\nresolution 200 200\n", x, y, x, y
		printf "scale %.12g %.12g .001\nmap 0 0 0 1 1\nmap 20 1 0 0 1\n", 1 / wide, 1 / wide
	}' >"$1.spec"
}
earth=+R=6371229
plane lambert -700 500 -500 500 km "+proj=lcc +lat_1=64 +lat_2=64 +lat_0=65 +lon_0=-19 $earth"
printf '> globe\n-18.1 64.3\n' >place
run backdrop lambert.vtk lambert.spec place
if case $err in *'built without libproj-dev') true ;; *) false ;; esac then
	skip 'maps on planes' 'backdrop is built without libproj-dev'
else
	plane america -4226106 3250826 -832698 4368646 m "+proj=lcc +lat_1=25 +lat_2=25 +lat_0=25 +lon_0=265 $earth"
	plane arctic -4000000 4000000 -4000000 4000000 m "+proj=stere +lat_0=90 +lat_ts=60 +lon_0=-45 $earth"
	plane antarctic -4000000 4000000 -4000000 4000000 m '+proj=stere +lat_0=-90 +lat_ts=-71 +lon_0=0 +ellps=WGS84 +units=m +no_defs +type=crs'
	plane mercator -20000000 20000000 -9000000 9000000 m "+proj=merc +lon_0=0 $earth"
	plane pacific 10000000 30000000 -9000000 9000000 m "+proj=merc +lon_0=0 $earth"
	plane albers -2500000 2300000 200000 3200000 m '+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-96 +datum=WGS84'
	plane europe 2500000 7500000 1300000 5500000 m '+proj=laea +lat_0=52 +lon_0=10 +x_0=4321000 +y_0=3210000 +ellps=GRS80'
	plane norway 200000 1200000 6500000 7900000 m '+proj=utm +zone=33 +ellps=WGS84'
	plane oblique -1500000 1500000 -1200000 1200000 m "+proj=omerc +lat_0=40 +lonc=-125 +alpha=30 +gamma=0 +k=1 $earth"
	plane disc -5400000 5400000 -5400000 5400000 m '+proj=geos +lon_0=-75 +sweep=x +h=35786023 +a=6378137 +rf=298.2572236'
	plane modis -2000000 3000000 3300000 7700000 m '+proj=sinu +lon_0=0 +R=6371007.181'
	plane seen -3000000 3000000 -3000000 3000000 m "+proj=nsper +lat_0=45 +lon_0=10 +h=3000000 $earth"
	plane far -6300000 6300000 -6300000 6300000 m "+proj=ortho +lat_0=45 +lon_0=10 $earth"
	plane cosmo -28 18 -23 21 degrees "+proj=ob_tran +o_proj=longlat +o_lon_p=0 +o_lat_p=39.25 +lon_0=18 $earth"
	# PROJ has a kilometre, and a degree of a rotated sphere is there in radians.
	for place in lambert:-18.1:64.3:.001 america:-133.459:12.5:1 arctic:100:75:1 antarctic:-150:-72:1 mercator:140:35:1 pacific:140:35:1 albers:-80:40:1 europe:24:60:1 norway:20:65:1 \
		oblique:-130:45:1 disc:-100:60:1 modis:20:60:1 seen:-5:30:1 far:-40:70:1 cosmo:2:48:57.29577951308232; do
		IFS=: read -r name lon lat unit <<-END
			$place
		END
		printf '> globe\n%s %s\n%s %s\n' "$lon" "$lat" "$lon" "$(awk "BEGIN { print $lat + 1 }")" >place
		is "a place is where PROJ puts it: $name" "$(backdrop "$name.vtk" "$name.spec" place >place.gp; block lines place.gp | head -n 1)" "$(
			sed -n "2s/.*; proj //p" "$name.vtk" | sed 's/+type=crs//' >words
			# shellcheck disable=SC2046  # words
			echo "$lon $lat" | proj -f %.9f $(cat words) | cat - "$name.spec" | awk -v unit="$unit" '
				NR == 1 { x = $1 * unit; y = $2 * unit }
				$1 == "at" { atx = $2; aty = $3 }
				$1 == "scale" { half = 2 * sin(16.5 * 3.14159265358979 / 180) / cos(16.5 * 3.14159265358979 / 180)
					printf "%.2f %.2f\n", 100 + 100 * (x * $2 - atx) / half, 100 + 100 * (y * $3 - aty) / half }')"
	done
	# same NAME TEXT: areas from the globe, behind "> globe", fill the same pixels as those before it, in coordinates of the plane
	same() {
		sed '/^> globe/,$d' "$1.lines" >flat.lines
		sed -n '/^> globe/,$p' "$1.lines" >globe.lines
		for lines in flat globe; do
			backdrop "$1.vtk" "$1.spec" $lines.lines | sed '/^set label/d; s/, \$graticule.*//' | gnuplot >$lines.png
		done
		ok "$2" imgcmp -t .2 -f .002 flat.png globe.png
	}
	ring() { awk -v y="$1" 'BEGIN { for (x = 0; x < 360; x += 5) print x, y }'; }
	circle() { awk -v r="$1" 'BEGIN { for (a = 0; a < 360; a += 5) { t = a * 3.14159265358979 / 180; printf "%.3f %.3f\n", r * cos(t), r * sin(t) } }'; }
	radius() { echo "0 $1" | proj -f %.3f "+proj=stere" "+lat_0=$2" "$3" "$4" "+lon_0=0" | awk '{ print sqrt($1 * $1 + $2 * $2) }'; }
	{ echo '> land'; circle "$(radius -70 -90 +lat_ts=-71 +ellps=WGS84)"; echo '> globe'; echo '> land'; ring -70; } >antarctic.lines
	same antarctic 'an area around the pole of a stereographic map'
	{ echo '> land'; circle "$(radius 60 90 +lat_ts=60 $earth)"; echo '> globe'; echo '> land'; ring 60; echo '> land'; ring -70; } >arctic.lines
	same arctic 'one around the other pole covers nothing'
	{
		for x in '19000000 20100000' '-20100000 -19500000'; do
			# shellcheck disable=SC2086  # two numbers
			printf '> land\n%s 2273033\n%s 2273033\n%s 5621525\n%s 5621525\n' ${x% *} ${x#* } ${x#* } ${x% *}
		done
		printf '> globe\n> land\n170.867 20\n184.63 20\n184.63 45\n170.867 45\n'
	} >mercator.lines
	printf '> globe\n-18 64\n-18 65\n' >globe
	printf '\n-100 200\n300 400\n' >flat
	{ cat globe; echo '> plane'; cat flat; } | backdrop lambert.vtk lambert.spec - >plane.gp
	is 'behind "> plane" lines are in its coordinates again' "$(block lines plane.gp)" "$(cat globe | backdrop lambert.vtk lambert.spec - >globe.gp
		block lines globe.gp; backdrop lambert.vtk lambert.spec flat >flat.gp; block lines flat.gp)"
	echo '> plane' >plane
	run backdrop wall.vtk wall.spec plane
	is 'coordinates of a plane are refused on the globe' "$status:$err" \
		'2:backdrop: plane:1: coordinates of a plane, expected longitudes and latitudes, as the grid has'
	same mercator 'an area across the edge of a Mercator map is at both edges'
	labels() { backdrop -s 600x600 "$@" | sed -n "s/^set label '\(.*\)' at .*/\1/p" | tr '\n' ,; }
	like 'meridians and parallels have labels at the edge of the map' "$(labels lambert.vtk lambert.spec)" '^35°W,.*,60°N,.*,68°N,0 m,'
	like 'meridians around a pole are at all sides' "$(labels arctic.vtk arctic.spec)" '180°,.*90°E,'
	is 'a coast that is cut at the edge has no line there' "$(printf '> globe\n> land\n170 20\n190 20\n190 45\n170 45\n' |
		backdrop mercator.vtk mercator.spec - >cut.gp; block lines cut.gp | awk '{ $0 = $1 < 1 || $1 > 199 ? "edge" : "" } NF' | uniq -c | awk '$1 > 2' | wc -l)" 0
	# The title is a stranger's.
	for words in '+init=epsg:3857' '+proj=merc +nadgrids=/etc/passwd' '+proj=pipeline +step +proj=merc' '+proj=merc +towgs84=1,2,3' '+proj=lcc +lat_1=x' \
		'+proj=lcc' '+proj=ob_tran +o_proj=merc +o_lat_p=40' '+proj=ob_tran +o_lat_p=40' '+lat_1=50' '+proj=merc +ellps=../x' '+proj=merc +R=-1' '%s%n' '+proj=lonely'; do
		plane bad 0 1000 0 1000 m "$words"
		run backdrop bad.vtk bad.spec place
		like "refused: $words" "$status:${#out}:$err" "^2:0:backdrop: place:1: longitudes and latitudes, but the plane in the grid's title cannot be used: "
	done
	like 'without lines the map is a plane' "$(labels bad.vtk bad.spec)" ',1000 m,'
	plane bad 0 10 0 10 degrees "+proj=merc $earth"
	sed '2s/x x/x rlon/' bad.vtk >odd.vtk
	run backdrop odd.vtk bad.spec place
	like 'degrees on a plane of metres are refused' "$status:$err" "^2:.*x has the unit 'degrees', expected m or km"
	printf '> globe\n1e18 42\n-1e18 95\n> land\n-1e18 -1e18\n1e18 91\n5 5\n> land\n0 90\n0 -90\n' >odd
	for name in arctic mercator cosmo oblique; do ok "odd lines: $name" sh -c 'backdrop "$0.vtk" "$0.spec" odd >odd.gp' $name; done
	if there "$root/build/unit/test_paint"; then
		backdrop arctic.vtk arctic.spec arctic.lines | gnuplot >drawn.png
		"$root/build/unit/test_paint" arctic.vtk arctic.spec arctic.lines painted.ppm
		ok 'a window paints the same map' imgcmp -t .2 -f .02 painted.ppm drawn.png
	fi
fi

# ---- gather -b ---------------------------------------------------------------------------------------------
partition 300x200 | vcworker hour0.vtk wall.spec >hour0.frags
gather -k 16 -o hour0.png hour0.frags
for format in png pam pfm; do
	gather -k 16 -o alone.$format hour0.frags
	gather -k 16 -b c%d.png -b m0.png -o over.$format hour0.frags
	blend -k 16 -o blend.$format hour0.png c0.png m0.png
	ok "gather -b writes what blend writes: $format" imgcmp -t 3e-5 over.$format blend.$format
done
blend -k 16 -o whole.png hour0.png whole0.png
ok 'without -c the map has the caption' imgcmp -t 3e-5 over.png whole.png
like 'the strip is below the picture' "$(imgcmp over.png over.png)" 'size	300x229'
head -c 100000 hour0.frags >part.frags
run gather -w 1 -b c%d.png -b m%d.png -o part.png part.frags
is 'a preview is over its backdrop too' "$status $(imgcmp part.partial.png part.partial.png | grep size)" '1 size	300x229'
run gather -b small.png -o no.png hour0.frags
is 'another width is refused' "$status:$err" '2:gather: small.png has 90x89 pixels, expected a width of 300, as the picture with it'
run gather -b gone%d.png -o no.png hour0.frags
like 'a missing backdrop is refused' "$status:$err" '^2:gather: gone0.png: No such file'
run gather -b m%x.png -o no.png hour0.frags
is 'a bad pattern is refused' "$status:$out" 2:
is 'no picture is written without its backdrop' "$(ls no.png 2>/dev/null)" ''

# ---- balance -m ---------------------------------------------------------------------------------------------
mkdir own
export TMPDIR="$tmp/own"
ok 'balance -m' balance adaptive -j 2 -m line -k 16 -o b%d.png hour?.vtk wall.spec other.spec
ok 'balance -m writes what gather -b writes' imgcmp -t 3e-5 b0.png over.png
is 'each time is another picture' "$(cmp -s b0.png b2.png; echo $?)" 1
ok 'balance -m none: has no lines' balance interleaved -j 2 -m none: -r b.frags -o bare.png hour0.vtk wall.spec
balance adaptive -j 2 -m line -k 16 -r b.frags -v 1 -o again.png hour0.vtk wall.spec 2>err
ok 'the log of a picture without lines is enough for one with lines' imgcmp -t 3e-5 again.png over.png
ok 'balance -m: a grid alone' balance adaptive -j 2 -s 120x80 -w 9 -m coasts: -o starter.png hour0.vtk
like 'the picture is transparent then, and over a map' "$(imgcmp starter.png starter.png)" 'size	120x'
await_empty() { n=0; while [ -n "$(ls -A own)" ] && [ $((n += 1)) -lt 200 ]; do sleep .05; done; ls -A own; }
is 'balance -m leaves no file behind' "$(await_empty)" ''
run env PATH="$tmp/broken:$PATH" balance adaptive -j 2 -m line -r no.frags -o no%d.png hour?.vtk wall.spec
like 'balance -m: gnuplot fails' "$status:$err" 'backdrop: gnuplot failed: line 7: no such terminal$'
is 'balance -m: status 3, and no picture' "$status:$(ls no?.png no.frags 2>/dev/null)" 3:
echo 'background 0 0 0' | cat wall.spec - >dark.spec
tr '\n' '\r' <dark.spec >return.spec
ok 'balance -m none: on a rotated sphere' balance adaptive -j 2 -m none: -o rotated.png rotated.vtk wall.spec
run balance adaptive -j 2 -m coasts: -o no.png rotated.vtk wall.spec
like 'it has no coasts' "$status:$err" '^2:backdrop: .*/coasts:1: longitudes and latitudes, which x and y of the grid are not, '
ok 'balance -m leaves a background out' balance adaptive -j 2 -m line -k 16 -o dark%d.png hour0.vtk dark.spec return.spec
ok 'as if it were not there' imgcmp -q dark0.png b0.png
ok 'also with another end of lines' imgcmp -q dark1.png b0.png
for bad in '-m coasts hour0.vtk wall.spec' "-m line $root/tests/ball.nff" "-m bad.line hour0.vtk wall.spec"; do
	# shellcheck disable=SC2086
	run balance adaptive -o no.png $bad
	is "refused: balance $bad" "$status:$out$(ls no.png 2>/dev/null)" 2:
done
is 'nothing is left then' "$(await_empty)" ''
unset TMPDIR

# ---- coastlines --------------------------------------------------------------------------------------------
coastlines >coasts
is 'there are coasts all over the globe' "$(awk '!/^>/ {
	if ($1 < 0 || $1 > 360 || $2 < -90 || $2 > 90) bad++
	s[int($1 / 90.001)]
} END { print length(s) + bad }' coasts)" 4
# Cape Agulhas, Cabo da Roca, Lindesnes: some point of coast is within a sixth of a degree.
for place in '20.00 -34.83' '350.50 38.78' '7.05 57.98'; do
	ok "a coast is at $place" awk -v at="$place" 'BEGIN { split(at, p, " ") }
		!/^>/ && ($1 - p[1]) ^ 2 + ($2 - p[2]) ^ 2 < 1 / 36 { found = 1; exit } END { exit !found }' coasts
done
# Areas by Green's theorem on the sphere. The coast of Antarctica goes round the globe and ends at the pole.
awk 'function step(x2, y2,    d) {
	d = x2 - x; d -= 360 * int(d / 360 + (d < 0 ? -.5 : .5))
	if ((y2 - y) ^ 2 > far) far = (y2 - y) ^ 2
	turn += d; area += d * rad * (sin(y * rad) + sin(y2 * rad)) / 2
	x = x2; y = y2
}
function ring() {
	if (!n) return
	if (x != x0 || y != y0) open++
	if (turn ^ 2 > 1) { round++; area += turn * rad }
	all += (area < 0 ? -area : area) * (kind == "water" ? -1 : 1)
	n = area = turn = 0
}
BEGIN { rad = atan2(0, -1) / 180 }
/^>/ { ring(); kind = $2; next }
n++ { step($1, $2); next }
{ x0 = x = $1; y0 = y = $2 }
END { ring(); printf "%d open, %d round the globe, steps of %.0f degrees, %.2f of the sphere\n", open, round, sqrt(far), all / 720 / rad }' coasts >land
is 'coastlines: all are closed, none jumps, and the area of land is right' "$(cat land)" \
	'0 open, 1 round the globe, steps of 2 degrees, 0.29 of the sphere'
run coastlines wall.vtk
is 'coastlines: refuses a file without coasts' "$status:$out" 2:
like 'coastlines: the message names the missing variable' "$err" '^coastlines: wall.vtk: no Bin_size_in_minutes, expected'
mkdir torn
printf '#!/bin/sh\nncdump=%s\n"$ncdump" "$@" | sed "\$d"\nexit 1\n' "$(command -v ncdump)" >torn/ncdump && chmod +x torn/ncdump
run env PATH="$tmp/torn:$PATH" coastlines
like 'coastlines: ncdump fails in the middle' "$status:$out:$err" '^2::coastlines: .*: ncdump cannot read all of it, expected'
run sh -c 'coastlines >/dev/full'
is 'coastlines: a full disk: exit 3, and a line' "$status:$err" '3:coastlines: standard output: cannot be written'
for bad in none.nc '-x' 'a b'; do
	# shellcheck disable=SC2086
	run coastlines $bad
	is "refused: coastlines $bad" "$status:$out" 2:
done

# ---- make demo-volume --------------------------------------------------------------------------------------
run "$root/tests/demo-volume"
is 'demo-volume: exit 0' "$status:$err" 0:
is 'demo-volume: fits on one screen of 24 lines and 120 columns' \
	"$(printf '%s\n' "$out" | awk 'NR > 24 || length > 120')" ''
for look in smooth surfaces; do
	like "demo-volume: $look" "$(imgcmp "$root/wind-$look.png" "$root/wind-$look.png")" 'size	1200x879'
done
run imgcmp -t .1 -f .01 "$root/wind-smooth.png" "$root/wind-surfaces.png"
is 'demo-volume: two looks' "$status" 1
finish
