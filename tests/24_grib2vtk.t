#!/bin/sh
# grib2vtk: the numbers of a real file and of files made here, compared with grib_get_data; refusals and their messages.
. "$(dirname "$0")/lib.sh"
needs grib2vtk grib_filter /usr/share/ncarg/data /usr/share/eccodes/samples
converter=grib2vtk
# shellcheck source=grids.sh
. "$root/tests/grids.sh"
grb=/usr/share/ncarg/data/grb samples=/usr/share/eccodes/samples

# ---- a file of a Debian package: a Lambert grid, 19 pressure levels ------------------------------------------------
file=$grb/fh.0012_tl.press_gr.awp211.grb2
run grib2vtk -l "$file"
is '-l exits 0' "$status:$err" 0:
like '-l prints a table of names, shapes, units, ranges and times' "$out" \
	'^u +93x65x19 lambert isobaricInhPa +m s\*\*-1 +-30.2222 to 100.591 +1: 2007-01-24 12:00 +U component of wind$'
is '-l aligns the columns' "$(printf '%s\n' "$out" | awk '
	NR == 1 { at = index($0, "units") }
	!/^#/ && substr($0, at - 1, 2) !~ /^ [^ ]/')" ''
like '-l lists fields of one level' "$out" '^prmsl +93x65x1 lambert meanSea +Pa '
like '-l lists refused variables with the reason' "$(grib2vtk -l $samples/reduced_ll_sfc_grib2.tmpl)" \
	"^# .*a grid of type 'reduced_ll', expected a rectilinear one$"

grib2vtk "$file" 'speed=hypot(u,v)' >speed.vtk
grib_copy -B 'level:i desc' -w shortName=u/v,typeOfLevel=isobaricInhPa "$file" uv.grb
levels=$(grib_get -w shortName=u -p level uv.grb)
for name in u v; do
	grib_get_data -w "shortName=$name" uv.grb | awk '$3 + 0 == $3 { print $3 }' >$name
done
paste u v | awk '{ printf "%.12g\n", sqrt($1 ^ 2 + $2 ^ 2) }' >w
values speed.vtk >g
ok 'speed=hypot(u,v) has the values that grib_get_data reads' awk '
	NR == FNR { w[n++] = $1; next }
	{ d = $1 - w[FNR - 1]; if (d * d > (3e-7 * w[FNR - 1]) ^ 2) { print FNR ": " $1 ", expected " w[FNR - 1]; exit bad = 1 } seen++ }
	END { exit bad || n != 93 * 65 * 19 || seen != n }' w g
is 'x is metres on the plane of projection' "$(on_line coordinates X speed.vtk | awk '{ printf "%.0f %.0f", $1, $2 - $1 }')" '-4226107 81271'
is 'y is metres on the plane of projection' "$(on_line coordinates Y speed.vtk | awk '{ printf "%.0f %.0f", $1, $2 - $1 }')" '-832698 81271'
# shellcheck disable=SC2086  # a word each
is 'pressure is negated, so that the axis points up' "$(on_line coordinates Z speed.vtk)" "$(printf -- '-%s ' $levels | sed 's/ $//')"
is 'the title has names, units and time' "$(sed -n 2p speed.vtk)" \
	'speed [m s**-1]; x lambert_x [m]; y lambert_y [m]; z -isobaricInhPa [hPa]; t validity 200701241200 [YYYYMMDDhhmm]; proj +proj=lcc +lat_1=25 +lat_2=25 +lat_0=25 +lon_0=265 +R=6371229'
grib2vtk -L pressureFromGroundLayer "$file" t >layer.vtk
is '-L: layers are at their middle, in Pa from the ground' "$(on_line coordinates Z layer.vtk)" '1500 4500 7500 10500 13500'

# ---- files made here -------------------------------------------------------------------------------------------
# make_grib NAME RULES: writes NAME.grib2, 3x2 nodes around Greenwich, by rules of grib_filter
make_grib() {
	cat >rules - <<END
set shortName="t"; set typeOfLevel="isobaricInhPa";
set Ni=3; set Nj=2; set latitudeOfFirstGridPointInDegrees=60; set latitudeOfLastGridPointInDegrees=58;
set longitudeOfFirstGridPointInDegrees=350; set longitudeOfLastGridPointInDegrees=10;
set iDirectionIncrementInDegrees=10; set jDirectionIncrementInDegrees=2; set packingType="grid_ieee";
$2
END
	grib_filter -o "$1.grib2" rules "$samples/${3:-regular_ll_pl_grib2}.tmpl"
}
one='set level=500; set values={1,2,3,4,5,6}; write;' two='set level=850; set values={11,12,13,14,15,16}; write;'
make_grib plain "$one $two set level=1000; set missingValue=9999; set bitmapPresent=1; set values={21,9999,23,24,25,26}; write;"
is 'values go up from the bottom and from the south; a bit map marks missing ones' "$(got plain.grib2 t)" '24 25 26 21 nan 23 14 15 16 11 12 13 4 5 6 1 2 3'
make_grib nameless "set discipline=0; set parameterCategory=1; set parameterNumber=200; $one $two set parameterNumber=201; $one $two"
is 'parameters without a name are told apart' "$(grib2vtk -l nameless.grib2 | awk 'NR > 1 { print $1, $2 }')" "$(printf 'unknown.0.1.%d 3x2x2\n' 200 201)"
make_grib old 'set table2Version=250; set indicatorOfParameter=7; set level=500; set values={1,2,3,4,5,6}; write;' regular_ll_pl_grib1
is 'parameters without a name, edition 1' "$(got old.grib2 unknown.250.7)" '4 5 6 1 2 3'
make_grib native 'set typeOfLevel="hybrid"; set level=1; set values={1,2,3,4,5,6}; write; set level=2; set values={11,12,13,14,15,16}; write;'
is 'hybrid levels without coefficients count upwards, as those of NCEP' "$(got native.grib2 t):$(on_line coordinates Z a.vtk)" '4 5 6 1 2 3 14 15 16 11 12 13:1 2'
make_grib mixed 'set typeOfLevel="hybrid"; set PVPresent=1; set pv={0.0, 20000.0, 0.0, 0.0, 0.0, 1.0}; set level=1; set values={1,2,3,4,5,6}; write;
	set level=2; set values={11,12,13,14,15,16}; write; set PVPresent=0; set dataDate=20300101; set level=1; set values={1,2,3,4,5,6}; write;
	set level=2; set values={11,12,13,14,15,16}; write;'
for time in 0 1; do
	is "a file whose first time has coefficients, time $time: levels count downwards" \
		"$(got -t $time mixed.grib2 t):$(on_line coordinates Z a.vtk)" '14 15 16 11 12 13 4 5 6 1 2 3:-2 -1'
done
make_grib thin "$one set typeOfFirstFixedSurface=100; set scaleFactorOfFirstFixedSurface=0; set scaledValueOfFirstFixedSurface=40; set values={31,32,33,34,35,36}; write;"
is 'levels below 1 hPa are among the others' "$(got thin.grib2 t):$(on_line coordinates Z a.vtk)" '4 5 6 1 2 3 34 35 36 31 32 33:-500 -0.4'
is 'longitudes continue beyond 360' "$(on_line coordinates X a.vtk)" '350 360 370'
is 'latitudes ascend' "$(on_line coordinates Y a.vtk)" '58 60'
like 'the title has the names of the axes' "$(sed -n 2p a.vtk)" '^t \[K\]; x longitude \[degrees_east\]; y latitude \[degrees_north\]; z -isobaricInhPa \[hPa\]; t '
grib_set -s edition=1,packingType=grid_simple plain.grib2 plain.grib1
is 'GRIB 1 gives the same values' "$(got plain.grib1 t)" '24 25 26 21 nan 23 14 15 16 11 12 13 4 5 6 1 2 3'
# units_of_edition_1 TYPE SET1 SET2: z of such levels
units_of_edition_1() {
	grib_filter -o levels.grib1 - "$samples/GRIB1.tmpl" <<-END
		set Ni=3; set Nj=2; set values={1,2,3,4,5,6}; set indicatorOfTypeOfLevel=$1; $2; write; $3; write;
	END
	grib2vtk levels.grib1 z >a.vtk && echo "$(on_line coordinates Z a.vtk)$(sed -n '2s/.*; z\([^;]*\);.*/\1/p' a.vtk)"
}
is 'GRIB 1: depths in the ground are in cm' "$(units_of_edition_1 112 'set topLevel=0; set bottomLevel=10' \
	'set topLevel=10; set bottomLevel=40')" '-0.25 -0.05 -depthBelowLandLayer [m]'
is 'GRIB 1: layers of heights are in hm' "$(units_of_edition_1 106 'set topLevel=20; set bottomLevel=10' \
	'set topLevel=30; set bottomLevel=20')" '1500 2500 heightAboveGroundLayer [m]'
is 'GRIB 1: pressures from the ground are in hPa' "$(units_of_edition_1 116 'set topLevel=30; set bottomLevel=0' \
	'set topLevel=60; set bottomLevel=30')" '1500 4500 pressureFromGroundLayer [Pa]'
is 'GRIB 1: layers of pressures are in kPa' "$(units_of_edition_1 101 'set topLevel=30; set bottomLevel=50' \
	'set topLevel=50; set bottomLevel=100')" '-750 -400 -isobaricLayer [hPa]'
is 'GRIB 1: sigma is in 1/10000' "$(units_of_edition_1 107 'set level=9950' 'set level=8000')" '-0.995 -0.8 -sigma [1]'
is 'GRIB 1: precise layers count from 1100 hPa' "$(units_of_edition_1 121 'set topLevel=30; set bottomLevel=10' \
	'set topLevel=60; set bottomLevel=40')" '-1080 -1050 -isobaricLayerHighPrecision [hPa]'
make_grib pascals "set scaledValueOfFirstFixedSurface=101320; set values={1,2,3,4,5,6}; write; set scaledValueOfFirstFixedSurface=150; write;
	set scaledValueOfFirstFixedSurface=100; write;"
is 'pressures have all their digits' "$(got pascals.grib2 t >/dev/null; on_line coordinates Z a.vtk)" '-1013.2 -1.5 -1'
make_grib layers 'set typeOfFirstFixedSurface=100; set typeOfSecondFixedSurface=100; set scaleFactorOfFirstFixedSurface=-1;
	set scaleFactorOfSecondFixedSurface=-1; set scaledValueOfFirstFixedSurface=2505; set scaledValueOfSecondFixedSurface=3015;
	set values={1,2,3,4,5,6}; write; set scaledValueOfFirstFixedSurface=5000; set scaledValueOfSecondFixedSurface=6000; write;'
is 'layers of pressures lie between both, with all their digits' "$(got layers.grib2 t >/dev/null; on_line coordinates Z a.vtk)" '-550 -276'
make_grib soil 'set typeOfFirstFixedSurface=151; set typeOfSecondFixedSurface=151; set scaleFactorOfFirstFixedSurface=0;
	set scaleFactorOfSecondFixedSurface=0; set scaledValueOfFirstFixedSurface=0; set scaledValueOfSecondFixedSurface=1;
	set values={1,2,3,4,5,6}; write; set scaledValueOfFirstFixedSurface=1; set scaledValueOfSecondFixedSurface=2; write;'
is 'layers of the soil count downwards' "$(got soil.grib2 t >/dev/null; on_line coordinates Z a.vtk)" '-1.5 -0.5'
make_grib north "set jScansPositively=1; set latitudeOfFirstGridPointInDegrees=58; set latitudeOfLastGridPointInDegrees=60; $one $two"
is 'rows may start in the south' "$(got north.grib2 t)" '11 12 13 14 15 16 1 2 3 4 5 6'
make_grib west "set iScansNegatively=1; set longitudeOfFirstGridPointInDegrees=10; set longitudeOfLastGridPointInDegrees=350; $one $two"
is 'rows may start in the east' "$(got west.grib2 t):$(on_line coordinates X a.vtk)" '16 15 14 13 12 11 6 5 4 3 2 1:350 360 370'
make_grib columns "set jPointsAreConsecutive=1; $one $two"
is 'columns may come instead of rows' "$(got columns.grib2 t)" '12 14 16 11 13 15 2 4 6 1 3 5'
make_grib turns "set alternativeRowScanning=1; $one $two"
is 'rows may alternate in direction' "$(got turns.grib2 t)" '16 15 14 11 12 13 6 5 4 1 2 3'
make_grib rotated "$one $two" rotated_ll_pl_grib2
got rotated.grib2 t >values
printf '%s\n' 'from 360 30 1000' 'at 360 59 0' 'up 0 1 0' 'angle 30' 'resolution 300 200' 'iso 5 1 1 1 1' >above.spec
echo '> globe' >globe
LC_ALL=C sed '2s/; proj .*//' a.vtk >unknown.vtk
run backdrop unknown.vtk above.spec globe
like 'degrees of a rotated sphere are no longitudes, if its pole is not known' "$status:$(sed -n 2p a.vtk):$err" \
	'^2:t \[K\]; x grid_longitude \[degrees\]; y grid_latitude \[degrees\]; z .*; proj [+]proj=ob_tran .*:backdrop: globe:1: longitudes and latitudes, which'
make_grib gauss "$one $two"
grib_filter -o gauss.grib2 - "$samples/regular_gg_pl_grib2.tmpl" <<'END'
set shortName="t"; set typeOfLevel="isobaricInhPa"; set level=500; write; set level=850; write;
END
grib2vtk gauss.grib2 t >a.vtk
like 'a Gaussian grid has its latitudes' "$(on_line coordinates Y a.vtk)" '^-87\.86379[0-9]* -85\.09652[0-9]* .* 87\.86379[0-9]*$'
make_grib times "set dataDate=20260102; set dataTime=600; $one $two set dataDate=20260101; set dataTime=1800; $one
	set level=850; set values={31,32,33,34,35,36}; write;"
is 'times are sorted' "$(got -t 0 times.grib2 t)" '34 35 36 31 32 33 4 5 6 1 2 3'
is '-t counts from 0' "$(got -t 1 times.grib2 t)" '14 15 16 11 12 13 4 5 6 1 2 3'
like 'the title has the time' "$(sed -n 2p a.vtk)" '; t validity 202601020600 \[YYYYMMDDhhmm\]$'
ok '-t all writes one file per time' sh -c 'grib2vtk -t all -o t%d.vtk times.grib2 t && cmp t1.vtk a.vtk && [ "$(echo t?.vtk)" = "t0.vtk t1.vtk" ]'

make_grib round "set Ni=4; set longitudeOfFirstGridPointInDegrees=90; set longitudeOfLastGridPointInDegrees=0;
set iDirectionIncrementInDegrees=90; set level=500; set values={1,2,3,4,5,6,7,8}; write; set level=850; write;"
is '-c: the first column comes again at the end' "$(got -c round.grib2 t)" '5 6 7 8 5 1 2 3 4 1 5 6 7 8 5 1 2 3 4 1'
is '-c: the new column is 360 degrees further east' "$(on_line coordinates X a.vtk)" '90 180 270 360 450'
make_grib whole "set longitudeOfFirstGridPointInDegrees=180; set longitudeOfLastGridPointInDegrees=180; set iDirectionIncrementInDegrees=180; $one $two"
is 'a circle may end where it began' "$(got whole.grib2 t >/dev/null; on_line coordinates X a.vtk)" '180 360 540'
grib2vtk gauss.grib2 t >open.vtk
grib2vtk -c gauss.grib2 t >a.vtk
ok '-c: a Gaussian grid is closed' closed open.vtk a.vtk "$(coordinates X open.vtk | wc -l)"
is '-c: the longitudes go from 0 to 360' "$(coordinates X a.vtk | sed -n '1p;$p' | tr -s ' \n' ' ')" ' 0 360 '

# ---- units and heights -----------------------------------------------------------------------------------------
if there /usr/include/udunits2.h; then
	is '-u: values are converted' "$(got -u degC plain.grib2 t | cut -d' ' -f1-3)" '-249.15 -248.15 -247.15'
	grib2vtk -z plain.grib2 t >a.vtk
	is '-z: pressures become heights of the standard atmosphere' \
		"$(coordinates Z a.vtk | awk '{ printf "%.0f ", $1 }')" '111 1457 5574 '
	grib2vtk -z -L isobaricInhPa "$file" gh >a.vtk
	is '-z: the geopotential height of the file' "$(coordinates Z a.vtk | awk 'NR == 1 || NR == 19 { printf "%.0f ", $1 }')" '115 16051 '
	layer() { values a.vtk | awk -v k="$1" -v n=$((93 * 65)) '!/nan/ && int((NR - 1) / n) == k { printf "%.0f\n", $1 }' | sort -un | tr '\n' ' '; }
	is '-z: at a plane, it is the height of the plane' "$(layer 9)" "$(coordinates Z a.vtk | awk 'NR == 10 { printf "%.0f ", $1 }')"
	make_grib geo "$one $two set shortName=\"gh\"; set level=500; set values={5000,5000,5000,5000,5000,5000}; write;
		set level=850; set values={1000,1000,1000,1000,1000,3000}; write;"
	is '-z: columns are moved' "$(got -z geo.grib2 t | cut -d' ' -f1-6):$(on_line coordinates Z a.vtk)" '14 15 nan 11 12 13:1000 5000'
	# Half levels at 0, 200 hPa and the surface: the levels are at 100 and 606.6 hPa; at one node, at 100 and 300.7 hPa.
	make_grib hybrid 'set typeOfLevel="hybrid"; set PVPresent=1; set pv={0.0, 20000.0, 0.0, 0.0, 0.0, 1.0}; set level=1; set values={1,2,3,4,5,6}; write;
		set level=2; set values={11,12,13,14,15,16}; write; set shortName="lnsp"; set typeOfLevel="hybrid"; set level=1;
		set values={11.526088,11.526088,11.526088,11.526088,11.526088,10.6}; write;'
	is '-z: hybrid levels, with pv and the surface pressure' \
		"$(got -z hybrid.grib2 t | cut -d' ' -f1-6):$(coordinates Z a.vtk | awk '{ printf "%.0f ", $1 }')" \
		'14 15 nan 11 12 13:4123 16180 '
	make_grib no_pv 'set typeOfLevel="hybrid"; set level=1; set values={1,2,3,4,5,6}; write; set level=2; write;
		set shortName="sp"; set typeOfLevel="surface"; set values={100000,100000,100000,100000,100000,100000}; write;'
	run grib2vtk -z no_pv.grib2 t
	like 'refused: -z of hybrid levels without pv' "$status:$out:$err" '^2::grib2vtk: no_pv.grib2: t: -z: the levels have no coefficients'
	make_grib theta "set typeOfLevel=\"theta\"; $one $two"
	run grib2vtk -z theta.grib2 t
	like 'refused: -z of other levels' "$status:$out:$err" '^2::grib2vtk: theta.grib2: t: -z: no heights, expected pressures'
else
	skip 'units and heights' 'udunits2 is not there'
fi

# ---- refused, and why --------------------------------------------------------------------------------------------
is 'one level' "$(grib2vtk "$file" prmsl | grep -a ^DIMENSIONS)" 'DIMENSIONS 93 65 1'
grib_copy -w shortName=u/absv "$file" few.grb2 # so that each search is short
refused few.grb2 nothing 'no nothing, expected one that -l lists'
refused few.grb2 'a=hypot(u,absv)' 'u and absv have different axes'
refused "$grb/wafsgfs_L_t06z_intdsk60.grib2" gh "a grid of type 'reduced_ll', expected a rectilinear one$"
refused "$grb/ced1.lf00.t00z.eta.grb" t "a grid of type 'unknown', expected a rectilinear one$"
cat plain.grib2 plain.grib2 >twice.grib2
refused twice.grib2 t 'several fields at level 500 of one time, expected one: -w count=1|4|2|5|3|6'
make_grib uneven "set dataDate=20260101; $one $two set dataDate=20260102; $one"
refused uneven.grib2 t 'levels differ between times'
make_grib mixed "$one set longitudeOfFirstGridPointInDegrees=340; $two"
refused mixed.grib2 t 'grids differ between levels'
make_grib huge "set level=500; set values={1,2,3,4,5,100000000000000000000.0}; write; $two"
refused huge.grib2 t 'a value is 1e\+20, expected 1e\+18 at most'
head -c 1000 few.grb2 >torn.grib2
refused torn.grib2 u 'message 1: '
echo text >no.grib2
refused no.grib2 t 'no GRIB message, expected one or more'
refused missing.grib2 t 'No such file'
run grib2vtk -c few.grb2 u
like 'refused: -c of a plane' "$status:$err" '^2:grib2vtk: .*: u: -c: x is not a longitude in degrees'
run grib2vtk -c plain.grib2 t
like 'refused: -c of a part of the globe' "$status:$err" '^2:grib2vtk: .*: t: -c: x goes from 350 to 370, expected'
run grib2vtk -L surface few.grb2 u
like 'levels that are not there' "$status:$err" '^2:grib2vtk: .*: no u at levels of type surface'
run grib2vtk -t 1 few.grb2 u
like 'a time that is not there' "$status:$err" '^2:grib2vtk: .*: -t 1: expected an index below 1'
cp plain.grib2 own-0.grib2
run grib2vtk -t all -o own-%d.grib2 own-0.grib2 t
is 'refused: a grid under the name of its file' "$status:$err" \
	'2:grib2vtk: own-0.grib2: is also an input, expected another file'
ok 'which stays as it is' cmp own-0.grib2 plain.grib2

# ---- usage, and a full disk --------------------------------------------------------------------------------------
at_the_end plain.grib2 t 'plain.grib2 =hypot(t,t)'
finish
