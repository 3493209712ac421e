#!/bin/sh
# gridspec: its specification shows the whole grid, states what it does, and keeps odd grids visible; balance with a grid
# alone; refusals.
# shellcheck disable=SC2154  # lib.sh sets them
. "$(dirname "$0")/lib.sh"

# grid NAME X Y Z AWK [TITLE]: 9 x 9 x 9 nodes from 0 to X, Y and Z; AWK sets s at i, j, k
grid() {
	awk -v lengths="$2 $3 $4" -v title="${6:-none}" '
	BEGIN {
		n = 9
		split(lengths, l, " ")
		printf "# vtk DataFile Version 3.0\n%s\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS %d %d %d\n", title, n, n, n
		for (a = 1; a <= 3; a++) {
			printf "%s_COORDINATES %d double\n", substr("XYZ", a, 1), n
			for (i = 0; i < n; i++) printf "%.17g ", l[a] * i / (n - 1)
			print ""
		}
		printf "POINT_DATA %d\nSCALARS s float\nLOOKUP_TABLE default\n", n * n * n
		for (k = 0; k < n; k++) for (j = 0; j < n; j++) for (i = 0; i < n; i++) { '"$5"'; print s }
	}' >"$1.vtk"
}
# painted FILE.pam W H: prints the left, right, top and bottom edge of the pixels that are not as the first, in percent
painted() {
	depth=$(sed -n 's/^DEPTH //p;/^ENDHDR/q' "$1") || return
	tail -c $((depth * $2 * $3)) "$1" | od -An -v -tu1 -w"$depth" |
		awk -v w="$2" -v h="$3" '
		NR == 1 { ground = $0 }
		$0 != ground { x = (NR - 1) % w; y = int((NR - 1) / w); if (!n++ || x < l) l = x; if (x > r) r = x; if (n == 1) t = y; b = y }
		END { if (n) printf "%d %d %d %d\n", 100 * l / w, 100 * r / w, 100 * t / h, 100 * b / h; else print "nothing" }'
}
# fits NAME: the picture of NAME.vtk fills the frame in one direction, and leaves an edge free
fits() {
	gridspec -s 90x60 "$1.vtk" >"$1.spec" && partition 90x60 | vcworker "$1.vtk" "$1.spec" | gather -o "$1.pam" || return
	painted "$1.pam" 90 60 | awk '{ print } NF == 4 && $1 >= 2 && $2 <= 97 && $3 >= 2 && $4 <= 97 && ($2 - $1 > 75 || $4 - $3 > 75) { ok = 1 } END { exit !ok }'
}
grid plain 1 1 1 's = i + j + k'
grid thin 7e6 5e6 16000 's = i * j + k * k' 's [K]; x x [m]; y y [m]; z z [m]'
grid globe 360 180 1000 's = i + j' 'speed [m/s]; x lon [degrees_east]; y lat [degrees_north]; z -lev [hPa]'
grid tall 1 1 1e4 's = k + i'
grid strip 1000 1 30 's = k + i'
grid huge 1 1 1 's = exp(log(10) * (2 * i * (k + 1) / 4 - 20))'
grid outlier 1 1 1 's = i == 4 && j == 4 && k == 4 ? 1e9 : i + k'
grid flat 1 1 1 's = 5'
grid zero 1 1 1 's = 0'
grid most 1 1 1 's = 1e18'
grid half 1 1 1 's = i < 4 ? "nan" : k'
grid negative 1 1 1 's = -i - j * k'
for name in plain thin globe tall strip huge outlier flat zero most negative; do ok "the picture of $name fits" fits $name; done
# Far from the origin, with a scale of many digits.
grid far 70 1.1 20 's = i + j + k' 's [K]; x x [m]; y y [m]; z z [m]'
awk '/^[XYZ]_COORD/ { print; getline; for (i = 1; i <= NF; i++) printf "%.17g ", $i + 5.4e6; print ""; next } { print }' far.vtk >x && mv x far.vtk
ok 'the picture of far fits' fits far
gridspec -s 10x8000 far.vtk >far.spec && partition 10x8000 | vcworker far.vtk far.spec | gather -o far.pam
like 'and in a narrow picture' "$(painted far.pam 10 8000)" '^1?0 [89]0 49 50$'
fits half >half.at
is 'a grid with missing values is visible' "$(grep -c nothing half.at)" 0

is 'z keeps its proportion if it can' "$(grep -E '^(scale|# vert)' plain.spec | tr '\n' ';')" '# vertical exaggeration: 1;scale 1 1 1;'
is 'a thin grid becomes a quarter as high as wide' "$(grep -E '^(scale|# vert)' thin.spec | tr '\n' ';')" \
	'# vertical exaggeration: 109;scale 1 1 109.375;'
is 'pressures beside degrees: it says how many hPa' "$(grep -E '^(scale|# as)' globe.spec | tr '\n' ';')" \
	'# as high as 1 degrees_east is wide: 11.1 hPa;scale 1 1 0.09;'
is 'names, units and ranges are stated' "$(sed -n '1p;4p' globe.spec)" '# speed: 0 to 16 m/s at 9 x 9 x 9 nodes
# z: 0 to -1000 hPa, negated in the grid'
# As floats, .439 is above its decimal and -.1 below: the knots enclose both.
grid capped 1 1 1 's = i < 4 ? -.1 : i == 4 ? .2 : .439' 's [\302\260C]; x x [m]; y y [m]; z z [m]'
gridspec capped.vtk >capped.spec
is 'the greatest and the least value are within the knots' "$(awk '$1 == "map" { print $2 }' capped.spec | sed -n '1p;$p' | tr '\n' ' ')" \
	'-0.10000000149011612 0.4390000104904175 '
like 'units may be beyond ASCII' "$(head -n 1 capped.spec)" "^# s: -0.1 to 0.439 $(printf '\302\260')C at"
like 'missing values are counted' "$(cat half.spec)" '^# s: 0 to 8 .*, 44.4 % missing$'

# 729 values from 0 to 728: each tenth has 73 of them.
grid ramp 1 1 1 's = i + 9 * (j + 9 * k)'
gridspec -k fog ramp.vtk >ramp.spec
is 'knots are at the quantiles' "$(awk '$1 == "map" { printf "%s ", $2 }' ramp.spec)" \
	'0 72 72 145 145 218 218 291 291 364 364 436 436 509 509 582 582 655 655 706 706 728 '
is 'extinction ascends with the value' "$(awk '$1 == "map" { if ($4 < k) bad = NR; k = $4 } END { print bad + 0 }' ramp.spec)" 0
grid rain 1 1 1 's = i > 5 && j > 5 ? i * j - 30 + k : 0'
gridspec rain.vtk >rain.spec
is 'the value of most nodes is transparent' "$(awk '$1 == "map" { print $2, $4; exit }' rain.spec)" '0 0'
is 'quantiles are those of the others' "$(awk '$1 == "map" { n++ } END { print (n > 10) }' rain.spec)" 1
gridspec -k fog -p batlow - <ramp.vtk | diff ramp.spec - >batlow.diff
is '-p names the palette, and standard input is a grid' "$(grep '^[<>]' batlow.diff | tr '\n' ' ')" '< palette viridis > palette batlow '
is 'the least values come first' "$(gridspec negative.vtk | awk '$1 == "map" { print $2; exit }')" -72

# ---- kinds -------------------------------------------------------------------------------------------------------
# A field that falls with height is drawn as its deviation from the mean of each level.
grid falls 1 1 1 's = 300 - 9 * k + i - 4' 'T [K]; x x [m]; y y [m]; z z [m]'
gridspec -s 90x60 falls.vtk >falls.spec
is 'a field that falls with height: its levels are subtracted' "$(awk '$1 == "profile" { printf "%s %s,", $2, $3 }' falls.spec | cut -d , -f 1-3)" \
	'0 300,0.125 291,0.25 282'
is 'and the map is blue below, red above' "$(awk '$1 == "palette" { print $2 } $1 == "map" { print $2, ($3 > .5) }' falls.spec | sed -n '1p;2p;$p' | tr '\n' ,)" \
	'vik,-4 0,4 1,'
fits falls >falls.at
like 'it is visible' "$(cat falls.at)" '^[0-9]+ [0-9]+ [0-9]+ [0-9]+$'
awk '/^LOOKUP/ { on = 1; print; next } on { $0 = $0 - 300 + 9 * int(n / 81); n++ } { print }' falls.vtk >less.vtk
partition 90x60 | vcworker falls.vtk falls.spec | gather -o falls.pam
grep -v ^profile falls.spec >less.spec
partition 90x60 | vcworker less.vtk less.spec | gather -o less.pam
ok 'a profile gives the picture of the field less it' cmp falls.pam less.pam
grid signed 1 1 1 's = (i - 4) * (k + 1)'
is 'a field of both signs: from 0' "$(gridspec signed.vtk | grep -cE '^(profile|palette vik)')" 1
is '-k slices' "$(gridspec -k slices plain.vtk | awk '$1 == "slice" { printf "%s%s ", $2, $3 } $1 == "map" && $4 != 0')" 'x0.5 y0.6 z0.125 '
is '-k surfaces' "$(gridspec -k surfaces plain.vtk | awk '$1 == "iso" || $1 == "map" { printf "%s ", $1 }')" 'iso iso iso '
for kind in fog slices surfaces anomaly; do
	for name in rain half outlier flat; do gridspec -k $kind $name.vtk >kind.spec && vcworker -i $name.vtk kind.spec || echo "$kind $name"; done
done >inspected 2>&1
is 'each kind of odd grids is a specification' "$(grep -cv '^frame\|^job=' inspected)" 0

# ---- balance -----------------------------------------------------------------------------------------------------
run balance adaptive -j 2 -s 90x60 -o first.pam plain.vtk
is 'balance: a grid alone is enough' "$status$err" 0
ok 'balance: the specification is that of gridspec' cmp first.pam plain.pam
run balance masterslave -j 2 -s 90x60 -r plain.frags -o again.pam plain.vtk
run balance adaptive -j 1 -s 90x60 -r plain.frags -o again.pam plain.vtk
is 'balance: -r resumes such a picture' "$status $(cmp again.pam plain.pam && echo same)" '0 same'
run balance auto -j 2 -s 90x60 -o auto.pam plain.vtk
is 'balance auto: a grid alone is enough' "$status $(cmp auto.pam plain.pam && echo same)" '0 same'

# ---- computed tomography -----------------------------------------------------------------------------------------
grid scan 1 1 1 's = i < 3 ? -1000 : i < 6 ? 40 : 700' 'scan [HU]; x x [mm]; y y [mm]; z z [mm]'
gridspec -s 90x60 scan.vtk >scan.spec
is 'Hounsfield units: no air, tissue, and bone as a surface' "$(awk '$1 == "iso" { print } $1 == "map" { print $1, $2, ($6 > 0) }' scan.spec)" \
	"$(printf '%s\n' 'iso 300 1 0.95 0.85 1' 'map -300 0' 'map -50 1' 'map 100 1' 'map 300 1' 'map 3000 1')"
ok 'vcworker takes it' vcworker -i scan.vtk scan.spec

# ---- refusals ----------------------------------------------------------------------------------------------------
refused() { name=$1 ere=$2; shift 2; run "$@"; like "$name" "$status $err" "^2 $ere"; }
grid gone 1 1 1 's = "nan"'
refused 'nothing there' 'gridspec: gone.vtk: all values are missing, expected' gridspec gone.vtk
refused 'balance: nothing there' 'job: gone.vtk: all values are missing, expected' balance adaptive -o no.png gone.vtk
is 'balance: no picture is left' "$(ls no.png 2>/dev/null)" ''
grid lone 1 1 1 's = i == 4 && j == 4 ? 1 : "nan"'
refused 'no cell' 'gridspec: lone.vtk: each cell has a missing corner, expected' gridspec lone.vtk
grid vast 2e9 2e9 1.5e9 's = i' 's [K]; x x [m]; y y [m]; z t [s]'
run sh -c 'gridspec vast.vtk >vast.spec && vcworker -n vast.vtk vast.spec'
is 'the scale of a vast grid is one that a specification may have' "$status$err" 0
grid sheet 1e17 1e17 1 's = i'
refused 'lengths that no scale brings together' 'gridspec: sheet.vtk: an axis is 1e9 times' gridspec sheet.vtk
sed 's/^SCALARS.*/VECTORS wind float/' plain.vtk >vectors.vtk
refused 'vectors' 'gridspec: vectors.vtk:[0-9]*: VECTORS, expected SCALARS; vol2vtk' gridspec vectors.vtk
refused 'another palette' 'gridspec: -p jet: expected batlow, ' gridspec -p jet plain.vtk
refused 'another kind' 'gridspec: -k mist: expected fog, ' gridspec -k mist plain.vtk
refused 'a bad size' 'gridspec: -s 9: expected' gridspec -s 9 plain.vtk
refused 'two grids' 'usage: gridspec' gridspec plain.vtk thin.vtk
gridspec plain.vtk >/dev/full 2>err
is 'a full disk: exit 3' "$?" 3
printf '# vtk DataFile Version 3.0\na\rfrom 1 2 3 [m]; x lon [\001]\n' >evil.vtk
sed 1,2d plain.vtk >>evil.vtk
ok 'a title stays within comments' sh -c 'gridspec evil.vtk >evil.spec && vcworker -i evil.vtk evil.spec'

# ---- one level -------------------------------------------------------------------------------------------------
# flat NAME AWK [TITLE]: 9 x 9 nodes from 0 to 80 and 40 degrees; AWK sets s at i, j
flat() {
	grid "$1" 80 40 8 "if (k) continue; $2" "${3:-s [mm]; x lon [degrees_east]; y lat [degrees_north]}"
	awk '/^DIMENSIONS/ { $4 = 1 } /^Z_/ { $2 = 1; print; getline; $0 = 5 } /^POINT_DATA/ { $2 = 81 } { print }' "$1.vtk" >one.vtk
	mv one.vtk "$1.vtk"
}
flat rain 's = i < 3 ? 0 : i + j'
gridspec -s 120x80 rain.vtk >rain.spec
is 'one level is seen from above, as a slice' "$(grep -E '^(up|slice)' rain.spec | paste -sd ' ' -)" 'up 0 1 0 slice z 5 0.65'
is 'its comments have no height' "$(sed -n '1,/^from/p' rain.spec | paste -sd '|' -)" \
	"# s: 0 to 16 mm at 9 x 9 x 1 nodes|# x: 0 to 80 degrees_east|# y: 0 to 40 degrees_north|$(grep ^from rain.spec)"
ok 'balance: one level alone' balance adaptive -j 1 -s 120x80 -o rain.pam rain.vtk
vcworker -i rain.vtk rain.spec >/dev/null && partition 120x80 | vcworker -t rain.vtk rain.spec | gather -o rain.pam
like 'its picture fills the frame; the least value has no colour' "$(painted rain.pam 120 80)" '^2[6-9] 9[3-6] [0-9]+ [0-9]+$'
sed 's/^5$/-0.49402499198913574/' rain.vtk >deep.vtk
gridspec -s 90x60 deep.vtk >deep.spec
partition 90x60 | vcworker -t deep.vtk deep.spec | gather -o deep.pam
is 'also at a height of many digits' "$(painted deep.pam 90 60 | wc -w)" 4
{ grep -v '^slice' deep.spec; echo 'slice z -0.494025 1'; } >six.spec
partition 90x60 | vcworker -t deep.vtk six.spec | gather -o six.pam
is 'a slice in six digits of the end of the grid is in the grid' "$(painted six.pam 90 60 | wc -w)" 4
flat both 's = i - 4'
gridspec both.vtk >both.spec
like 'both signs: around 0' "$(paste -sd ' ' both.spec)" 'palette vik .* slice z 5 0.65$'
is 'no profile' "$(grep -c ^profile both.spec)" 0
is '-k anomaly: from the mean' "$(gridspec -k anomaly rain.vtk | grep -c ^profile)" 1
flat even 's = 3'
ok 'one value' sh -c 'gridspec even.vtk >even.spec && vcworker -i even.vtk even.spec'
run gridcut -m 1 -o brick-%d.vtk rain.vtk
like 'gridcut: one level' "$status $err" '^2 gridcut: rain.vtk: has one level, expected several'
grid air 80 40 9000 's = i + k' 's [m/s]; x lon [degrees_east]; y lat [degrees_north]; z height [m]'
flat hills 's = 100 * i' 'h [m]; x lon [degrees_east]; y lat [degrees_north]'
cat air.vtk rain.vtk >wet.vtk; cat air.vtk hills.vtk >land.vtk
gridspec wet.vtk >wet.spec
like 'a flat field below a grid' "$(grep -E '^(flat|ground)' wet.spec | sed -n '1p;2p' | paste -sd ' ' -)" '^flat 0 0.65 ground 0[.]0'
gridspec land.vtk >land.spec
is 'heights are a terrain' "$(grep -c ^flat land.spec) $(grep -c ^ground land.spec)" '0 9'
is 'a ground of the grid is not cut' "$(grep -c ^clip land.spec)" 0
sed '/^X_/{n;s/ /\n/g;}' hills.vtk | awk '/^X_/ { x = 1 } /^Y_/ { x = 0 } x && /^[0-9]/ { $1 = 1.5 * $1 - 10 } { print }' >wide.vtk
cat air.vtk wide.vtk >outside.vtk
gridspec outside.vtk >outside.spec
like 'what is outside of the grid is cut off, at all heights' "$(grep ^clip outside.spec)" '^clip 0 0 -9000 80 40 18000$'
ok 'both can be rendered' sh -c 'vcworker -i wet.vtk wet.spec && vcworker -i land.vtk land.spec'
backdrop wet.vtk wet.spec >wet.gp
like 'the legend names both' "$(cat wet.gp)" "'s, m/s .left.; s, mm .right.'"
cat rain.vtk air.vtk >wrong.vtk
refused 'one level first' 'gridspec: wrong.vtk:[0-9]*: a grid of several levels after one of one, expected it before' gridspec wrong.vtk
finish
