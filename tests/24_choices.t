#!/bin/sh
# nc2vtk and grib2vtk: a member, their mean and spread; expressions; pressures in the sea; longitudes that cross 0 or 180,
# or begin elsewhere; and each command of cdo that a refusal names, run on such a file.
. "$(dirname "$0")/lib.sh"
needs nc2vtk grib2vtk ncgen ncdump grib_filter grib_set /usr/share/eccodes/samples
converter=nc2vtk
# shellcheck source=grids.sh
. "$root/tests/grids.sh"
samples=/usr/share/eccodes/samples
# make_nc NAME DIMENSIONS VARIABLES DATA: writes NAME.nc
make_nc() { printf 'netcdf a {\ndimensions: %s\nvariables: %s\ndata: %s\n}\n' "$2" "$3" "$4" >"$1.cdl" && ncgen -k nc4 -o "$1.nc" "$1.cdl"; }
rounded() { on_line values a.vtk | awk '{ for (i = 1; i <= NF; i++) printf "%.4g%s", $i, i < NF ? " " : "\n" }'; }

# ---- one of several, in NetCDF -----------------------------------------------------------------------------------
xyz='float x(x); x:axis = "X"; float y(y); y:axis = "Y"; float z(z); z:axis = "Z";' nodes='x = 1, 2; y = 3, 4; z = 5, 6;'
make_nc members 'member = 3; x = 2; y = 2; z = 2; n = 4;' "$xyz float member(member); float s(member, z, y, x); s:units = \"K\"; s:coordinates = \"kind\";
	char kind(member, n); float t(z, y, x); t:units = \"K\";" "$nodes member = 10, 20, 30.5; kind = \"low\", \"mid\", \"high\";
	s = 1, 2, 3, 4, 5, 6, 7, _, 2, 2, 3, 4, 5, 6, 7, _, 6, 2, 3, 4, 5, 6, 9, 8; t = 1, 1, 1, 1, 1, 1, 1, 1;"
refused members.nc s 'member has 3 elements and is none of x, y, z and time, expected -d member=INDEX from 0 to 2, mean or spread, or a value: low, mid, high$'
for choice in 1 20. 2e1 mid; do is "-d member=$choice" "$(got -d member=$choice members.nc s)" '2 2 3 4 5 6 7 nan'; done
is '-d member=30.5' "$(got -d member=30.5 members.nc s)" '6 2 3 4 5 6 9 8'
is '-d member=mean, of the members that have a value' "$(got -d member=mean members.nc s >/dev/null; rounded)" '3 2 3 4 5 6 7.667 8'
is '-d member=spread: the root of the mean square difference' "$(got -d member=spread members.nc s >/dev/null; rounded)" '2.16 0 0 0 0 0 0.9428 0'
is 'the mean is that of the expression' "$(got -d member=mean members.nc 'a=s*s' >/dev/null; rounded)" '13.67 4 9 16 25 36 59.67 64'
is 'a variable without the dimension' "$(got -d member=mean members.nc 'a=s-t' >/dev/null; rounded)" '2 1 2 3 4 5 6.667 7'
is '-d takes a level' "$(got -d member=0 -d z=6. members.nc s)" '5 6 7 nan'
sed 's/"low", "mid", "high"/"1", "2", "3"/' members.cdl | ncgen -k nc4 -o numbered.nc
is '-d member=1: a label of digits' "$(got -d member=1 numbered.nc s)" '1 2 3 4 5 6 7 nan'
like '-i -d lists what is chosen' "$(nc2vtk -i -d member=0 members.nc)" '^s +2x2x2 +K +1 to 7 '
for bad in 'member=3 there is no member=3, expected -d member=INDEX from 0 to 2' 'member=11. there is no member=11\.' 'member=x there is no member=x' 'run=1 member has 3 elements'; do
	run nc2vtk -d "${bad%% *}" members.nc s
	like "refused: -d ${bad%% *}" "$status:$out:$err" "^2::nc2vtk: members.nc: s: ${bad#* }"
done
run nc2vtk -d run=1 -d member=0 members.nc s
is 'refused: -d of another dimension' "$status:$out:$err" '2::nc2vtk: members.nc: s: -d run=1: no such dimension, expected one that -l lists'
for bad in member member= =1; do
	run nc2vtk -d "$bad" members.nc s
	like "refused: -d $bad" "$status:$out:$err" '^2::nc2vtk: -d .*: expected DIMENSION=INDEX, a value, mean or spread$'
done
make_nc several 'ensemble = 9; b = 2; x = 2; y = 2; z = 2;' "$xyz float s(ensemble, b, z, y, x); int ensemble(ensemble);" "$nodes ensemble = 1, 2, 3, 4, 5, 6, 7, 8, 9; s = $(seq -s, 144);"
run nc2vtk -d b=0 several.nc s
like 'of many values, some are listed' "$status:$err" '^2:.* 0 to 8, mean or spread, or a value: 1., 2., 3., 4., 5., 6., [.]{3}$'
run nc2vtk -d ensemble=0 several.nc s
like 'a dimension without coordinates beside x, y and z' "$status:$err" '^2:nc2vtk: several.nc: s: b has 2 elements .*, expected -d b=INDEX from 0 to 1, mean or spread$'
is 'two dimensions' "$(got -d ensemble=8 -d b=mean several.nc s)" '133 134 135 136 137 138 139 140'
make_nc none 'x = 2;' 'float x(x);' 'x = 1, 2;'
like '-i says that a file has no field' "$(nc2vtk -i none.nc)" '^# no variable has two dimensions or more'

# Each member has its own heights: 0 and 100 m, and 0 and 200 m.
if there /usr/include/udunits2.h; then
	make_nc columns 'member = 2; x = 2; y = 2; z = 2;' "$xyz z:units = \"hPa\"; float s(member, z, y, x); float gp(member, z, y, x); gp:standard_name = \"geopotential_height\"; gp:units = \"m\";" \
		"$nodes s = 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0; gp = 100, 100, 100, 100, 0, 0, 0, 0, 200, 200, 200, 200, 0, 0, 0, 0;"
	is '-z: each member has its own heights' "$(got -z -d member=mean columns.nc s)" '0 0 0 0 0.75 0.75 0.75 0.75'
	ncdump columns.nc | sed 's/^ *gp =/ gp = _, _, _, _, 0, 0, 0, 0, _, _, _, _, 0, 0, 0, 0;\n}\n&/' | sed '/^}/q' | ncgen -k nc4 -o missing.nc -
	run nc2vtk -z -d member=0 missing.nc s
	like '-z: the message names the variable, the level and -Z' "$status:$err" '^2:nc2vtk: missing.nc: s: -z: by gp: all heights of the level -5 are missing, expected some; -Z takes the standard atmosphere$'
	is '-Z: the standard atmosphere, whatever the file has' "$(got -Z -d member=0 missing.nc s):$(coordinates Z a.vtk | awk '{ printf "%.0f ", $1 }')" '0 0 0 0 1 1 1 1:34509 35777 '
fi

# ---- expressions -------------------------------------------------------------------------------------------------
if there /usr/include/udunits2.h; then
	make_nc fields 'x = 2; y = 2; z = 2;' "$xyz float u(z, y, x); u:units = \"m/s\"; float v(z, y, x); v:units = \"m s-1\"; float rho(z, y, x); rho:units = \"kg m-3\"; float T(z, y, x); T:units = \"K\";" \
		"$nodes u = 3, 3, 3, 3, 3, 3, 3, 3; v = 4, 4, 4, 4, 4, 4, 4, 0; rho = 2, 2, 2, 2, 2, 2, 2, _; T = 300, 300, 300, 300, 300, 300, 300, 300;"
	is 'sqrt and products' "$(got fields.nc 'speed=sqrt(u*u+v^2)')" '5 5 5 5 5 5 5 3'
	is 'a quotient by 0 is missing' "$(got fields.nc 'r=u/v')" '0.75 0.75 0.75 0.75 0.75 0.75 0.75 nan'
	is 'the title has the unit' "$(got -u W/m2 fields.nc 'e=.5*rho*u^3'):$(sed -n '2s/;.*//p' a.vtk)" '27 27 27 27 27 27 27 nan:e [W/m2]'
	is 'a constant' "$(got -u degC fields.nc 'warm=T+10' >/dev/null; rounded)" '36.85 36.85 36.85 36.85 36.85 36.85 36.85 36.85'
	refused fields.nc 'a=u+T' "a=u.T: the two are in 'm/s' and 'K', expected one unit"
	refused fields.nc 'a=sqrt(u)' "a=sqrt.u.: 'm/s' has no square root of a unit"
	refused fields.nc 'a=u+w' 'w: no such variable'
	refused fields.nc 'a=u v' "a=u v: 'v' stands where an operator is expected"
fi

# ---- pressures in the sea ----------------------------------------------------------------------------------------
# sea NAME UNIT ATTRIBUTES LEVELS FIELD_ATTRIBUTES: three levels at 50 and 51 degrees north
sea() {
	make_nc "$1" 'lev = 3; lat = 2; lon = 2;' "float lev(lev); lev:units = \"$2\"; $3 float lat(lat); lat:units = \"degrees_north\"; float lon(lon); lon:units = \"degrees_east\";
		float s(lev, lat, lon); ${5-}" "lev = $4; lat = 50, 51; lon = 5, 6; s = $(seq -s, 12);"
}
depths() { nc2vtk -z "$1" s >a.vtk && coordinates Z a.vtk | awk '{ printf "%.0f ", $1 }'; }
if there /usr/include/udunits2.h; then
	sea dbar dbar 'lev:standard_name = "sea_water_pressure"; lev:positive = "down";' '10, 500, 2000'
	is '-z: pressures in the sea become depths (TEOS-10: -1973.42, -495.12 and -9.91 m)' "$(depths dbar.nc)" '-1973 -495 -10 '
	sea bare dbar '' '10, 500, 2000'
	is '-z: dbar is a unit of the sea' "$(depths bare.nc)" '-1973 -495 -10 '
	sea pascals Pa '' '100000, 5000000, 20000000' 's:standard_name = "sea_water_temperature";'
	is '-z: so is a pressure of a field of the sea, in any unit' "$(depths pascals.nc)" '-1973 -495 -10 '
	sea air dbar 'lev:standard_name = "air_pressure";' '10, 8.5, 5'
	is '-z: dbar of air' "$(depths air.nc)" '111 1457 5574 '
	sea deep hPa '' '1000, 50000, 200000'
	sea trench dbar '' '10, 500, 20000'
	sea above dbar '' '-10, 10, 500'
	for name in deep trench above; do
		run nc2vtk -z $name.nc s
		like "refused: -z of $name.nc" "$status:$out:$err" "^2::nc2vtk: $name.nc: s: -z: lev has the level [-0-9e+]* [a-zA-Z]*, expected 1100 hPa at most in air, or in the sea, by the standard_name sea_water_pressure, 0 to 11500 dbar$"
	done
fi
sea unitless '' '' '1000, 850, 500'
run nc2vtk -o a.vtk unitless.nc s
like 'levels without a unit that look like hPa get a remark' "$status:$err" '^0:nc2vtk: unitless.nc: s: lev has no unit; its numbers look like pressures in hPa'
sea counted '' '' '1, 2, 3'
run nc2vtk -o a.vtk counted.nc s
is 'others do not' "$status:$err" 0:

# ---- longitudes --------------------------------------------------------------------------------------------------
# longitudes NAME LON ...: writes NAME.nc, with values that count up
longitudes() {
	name=$1
	shift
	make_nc "$name" "lon = $#; lat = 2;" 'float lon(lon); lon:units = "degrees_east"; float lat(lat); lat:units = "degrees_north"; float s(lat, lon);' \
		"lon = $(echo "$@" | sed 's/ /, /g'); lat = 1, 2; s = $(seq -s, $((2 * $#)));"
}
# along ARGUMENTS: the longitudes and the values of the first row
along() { nc2vtk "$@" >a.vtk && echo "$(on_line coordinates X a.vtk):$(values a.vtk | head -n "$(coordinates X a.vtk | wc -l)" | tr -s ' \n' ' ' | sed 's/^ //; s/ $//')"; }
for case in '350 355 0 5:350 355 360 365:1 2 3 4' '170 175 -180:170 175 180:1 2 3' '10 0 350:-10 0 10:3 2 1' '350 0:350 360:1 2' \
	'179.5 -179.5 -178.5:179.5 180.5 181.5:1 2 3' '90 180 -90 0:90 180 270 360:1 2 3 4' '180 270 0 90 180:180 270 360 450 540:1 2 3 4 5'; do
	# shellcheck disable=SC2086  # a word each
	longitudes a ${case%%:*}
	is "longitudes ${case%%:*}" "$(along a.nc s)" "${case#*:}"
done
for case in '10 30 20' '350 0 350 0' '0 90 80 -170'; do
	# shellcheck disable=SC2086  # a word each
	longitudes a $case
	refused a.nc s 's: lon is .*, expected all to ascend or all to descend'
done
longitudes globe 0 90 180 270
longitudes closed 0 90 180 270 360
longitudes part 350 0 10
is '-r -180' "$(along -r -180 globe.nc s)" '-180 -90 0 90:3 4 1 2'
is '-r between two columns' "$(along -r 20 globe.nc s)" '90 180 270 360:2 3 4 1'
is '-r with -c' "$(along -c -r -180 globe.nc s)" '-180 -90 0 90 180:3 4 1 2 3'
is '-r of a closed circle' "$(along -r -180 closed.nc s)" '-180 -90 0 90 180:3 4 1 2 3'
is '-r of a part of the globe moves it by whole circles' "$(along -r -180 part.nc s)" '-10 0 10:1 2 3'
run nc2vtk -r 0 -d member=0 members.nc s
is '-r of x without a unit takes it for longitude, as -c does' "$status:$err" 0:

# ---- GRIB --------------------------------------------------------------------------------------------------------
converter=grib2vtk
# messages NAME RULES: 3x2 nodes
messages() {
	cat >rules - <<END
set shortName="t"; set typeOfLevel="isobaricInhPa"; set Ni=3; set Nj=2; set latitudeOfFirstGridPointInDegrees=60; set latitudeOfLastGridPointInDegrees=58;
set longitudeOfFirstGridPointInDegrees=350; set longitudeOfLastGridPointInDegrees=10; set iDirectionIncrementInDegrees=10; set jDirectionIncrementInDegrees=2;
set packingType="grid_ieee"; $2
END
	grib_filter -o "$1.grib2" rules "$samples/regular_ll_pl_grib2.tmpl"
}
levels() { echo "set level=500; set values={$1,$1,$1,$1,$1,$1}; write; set level=850; set values={$2,$2,$2,$2,$2,$2}; write;"; }
two='set productDefinitionTemplateNumber=1;'
messages ensemble "$two set number=1; $(levels 1 2) set number=2; $(levels 3 6) set number=10; $(levels 8 7)"
refused ensemble.grib2 t 'several fields at level 500 of one time, expected one: -w number=1|2|10, or number=mean or spread$'
messages control "$(levels 9 9) $two set number=1; $(levels 1 2)"
refused control.grib2 t 'expected one: -w number=1 or count=1.3.2.4, or number=mean or spread$'
first() { grib2vtk "$@" >a.vtk && on_line values a.vtk | cut -d' ' -f 1,12; }
is '-w number=2' "$(first -w number=2 ensemble.grib2 t)" '6 3'
is '-w number=mean' "$(first -w number=mean ensemble.grib2 t)" '5 4'
is '-w number=spread' "$(got -w number=spread ensemble.grib2 t >/dev/null; rounded | cut -d' ' -f 1,12)" '2.16 2.944'
is '-w takes several keys' "$(first -w number=2/10,count=3/4 ensemble.grib2 t)" '6 3'
is '-w number=mean: expressions first' "$(first -w number=mean ensemble.grib2 't2=t^2-1')" '28.666666 23.666666'
like '-l -w lists what is chosen' "$(grib2vtk -l -w number=1 ensemble.grib2)" '^t +3x2x2 regular_ll isobaricInhPa +K +1 to 2 '
run grib2vtk -w number=5 ensemble.grib2 t
like 'refused: -w of what is not there' "$status:$out:$err" '^2::grib2vtk: ensemble.grib2: no message has what -w asks for, expected one or more of 6$'
for bad in number number= =1; do
	run grib2vtk -w $bad ensemble.grib2 t
	like "refused: -w $bad" "$status:$out:$err" '^2::grib2vtk: -w .*: expected KEY=VALUE, KEY=mean or KEY=spread$'
done
messages steps "set productDefinitionTemplateNumber=8; set stepType=\"avg\"; set stepRange=\"0-6\"; $(levels 1 2) set stepType=\"max\"; $(levels 3 4)"
refused steps.grib2 t 'expected one: -w stepType=avg.max'
is '-w stepType' "$(first -w stepType=max steps.grib2 t)" '4 3'
like 'the title has the interval' "$(sed -n 2p a.vtk)" 't validity 200703231200 to 200703231800 '
messages runs "set dataTime=0; set step=12; $(levels 1 2) set dataTime=600; set step=6; $(levels 3 4)"
refused runs.grib2 t 'one: -w stepRange=12.6 or dataTime=0000.0600'
is '-w dataTime' "$(first -w dataTime=600 runs.grib2 t)" '4 3'
messages lost "$two set number=1; $(levels 1 2) set number=2; set level=500; write;"
run grib2vtk -w number=mean lost.grib2 t
like 'refused: members with other levels' "$status:$out:$err" '^2::grib2vtk: .*: t: levels differ between times or members'
messages upper "set longitudeOfFirstGridPointInDegrees=350.333333; set longitudeOfLastGridPointInDegrees=10.333333; $(levels 1 2)"
grib_set -s edition=1,packingType=grid_simple upper.grib2 lower.grib1
grib_set -w level=500 -s edition=1,packingType=grid_simple -S upper.grib2 one.grib1
grib_copy -w level=850 upper.grib2 two.grib2
cat one.grib1 two.grib2 >both.grib
is 'the two editions may have one grid' "$(first both.grib t)" '2 1'
is '-r' "$(grib2vtk -r -180 upper.grib2 t >a.vtk; coordinates X a.vtk | awk '{ printf "%.2f ", $1 }')" '-9.67 0.33 10.33 '

# ---- files of another file -------------------------------------------------------------------------------------------
converter=nc2vtk
times='t = 2; x = 2; y = 2; z = 2;' of_times="$xyz double t(t); t:units = \"days since 2000-1-1\"; float s(t, z, y, x);"
make_nc first "$times" "$of_times" "$nodes t = 0, 1; s = $(seq -s, 16);"
make_nc second "$times" "$of_times" "$nodes t = 2, 3; s = $(seq -s, 16);"
run nc2vtk -t all -o w%d.vtk first.nc s
is '-t all' "$status:$err" 0:
run nc2vtk -t all -o w%d.vtk first.nc s
is '-t all again says nothing' "$status:$err" 0:
cp w1.vtk w2.vtk
run nc2vtk -t all -o w%d.vtk second.nc s
is '-t all of another file says that grids are replaced' "$status:$err" '0:nc2vtk: w0.vtk held another grid, which is replaced; another -o keeps both; w2.vtk stays'

# ---- commands that refusals name -------------------------------------------------------------------------------------
# advised GRID: the operators of the message in $err, with that for GRID
advised() { echo "$err" | sed -nE "s/.* as cdo ([a-z0-9]+,?[A-Za-z]*( -selname,[A-Za-z]*)?) IN OUT writes.*/\1/p" | sed "s/GRID/${1-}/"; }
if there cdo; then
	printf '%s\n' 'gridtype = lonlat' 'xsize = 3' 'ysize = 3' 'xfirst = 5' 'xinc = 1' 'yfirst = 51' 'yinc = 1' >grid
	make_nc wrf 'Time = UNLIMITED; bottom_top = 2; soil_layers_stag = 4; south_north = 3; west_east = 3;' 'float ZS(Time, soil_layers_stag); float XLAT(Time, south_north, west_east); XLAT:units = "degree_north";
		float XLONG(Time, south_north, west_east); XLONG:units = "degree_east"; float XTIME(Time); XTIME:units = "minutes since 2000-01-01 00:00:00";
		float T(Time, bottom_top, south_north, west_east); T:coordinates = "XLONG XLAT XTIME"; T:units = "K";' \
		'XTIME = 0; XLAT = 50, 50, 50, 52, 52, 52, 54, 54, 54; XLONG = 4, 6, 8, 4, 6, 8, 3.7, 6, 8.3; T = 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15, 16, 17, 18, 19;'
	run nc2vtk wrf.nc T
	like 'a curvilinear file of WRF without a plane is refused, with a command' "$status:$err" '^2:nc2vtk: wrf.nc: T: a curvilinear grid: .* as cdo remapbil,GRID -selname,T IN OUT writes; nc2vtk.1. has a GRID$'
	# shellcheck disable=SC2046  # a word each
	ok 'the command works, beside variables that cdo does not remap' cdo -s -O $(advised grid) wrf.nc out.nc
	is 'and its result is a grid, with the levels of the model' "$(got out.nc T | cut -d' ' -f 5,14):$(on_line coordinates Z a.vtk)" '5 15:1 2'
	sed 's/XLAT/YLAT/g; s/XLONG YLAT/XLONG XLAT/' wrf.cdl | ncgen -k nc4 -o half.nc
	run nc2vtk half.nc T
	like 'without its latitudes, no command helps' "$status:$err" '^2:nc2vtk: half.nc: T: .* expected them along each axis$'
	make_nc icon 'height = 2; ncells = 4;' 'double clon(ncells); clon:units = "radian"; clon:standard_name = "longitude"; double clat(ncells);
		clat:units = "radian"; clat:standard_name = "latitude"; double height(height); height:units = "m"; height:axis = "Z"; height:positive = "up";
		float temp(height, ncells); temp:coordinates = "clat clon";' \
		'clon = .08, .12, .08, .12; clat = .89, .89, .93, .93; height = 10, 100; temp = 1, 2, 3, 4, 5, 6, 7, 8;'
	run nc2vtk icon.nc temp
	like 'so is one of ICON' "$status:$err" '^2:nc2vtk: icon.nc: temp: an unstructured grid: .* as cdo remapnn,GRID -selname,temp IN OUT writes'
	# shellcheck disable=SC2046  # a word each
	ok 'its command works' cdo -s -O $(advised grid) icon.nc out.nc
	is 'and its result is a grid of both levels' "$(got out.nc temp | cut -d' ' -f 1,3,7,9,10)" '1 2 3 4 5'
	sed 's/height(height);/height(height, ncells);/; s/height = 10, 100/height = 1, 2, 3, 4, 5, 6, 7, 8/' icon.cdl | ncgen -k nc4 -o fvcom.nc
	run nc2vtk fvcom.nc temp
	like 'one that cdo skips has no command' "$status:$err" '^2:nc2vtk: fvcom.nc: temp: an unstructured grid: there are no coordinates along height, expected them along each axis$'
	sed 's/ncells = 4;/& t = 1;/; s/height, ncells)/height, t, ncells)/; s/double height/double t(t); t:units = "days since 2000-1-1"; &/' icon.cdl | ncgen -k nc4 -o late.nc
	run nc2vtk late.nc temp
	like 'nor has one whose time is not its first dimension' "$status:$err" '^2:nc2vtk: late.nc: temp: an unstructured grid: .* expected them along each axis$'
	sed 's/^data:/	:featureType = "timeSeries";\n&/' icon.cdl | ncgen -k nc4 -o stations.nc
	run nc2vtk stations.nc temp
	like 'stations are no grid' "$status:$err" '^2:nc2vtk: stations.nc: temp: places of their own, such as stations, and no grid: .* expected them along each axis$'
	for sample in reduced_gg_pl_32_grib2 reduced_gg_ml_grib1 sh_pl_grib2 sh_ml_grib1; do
		run grib2vtk $samples/$sample.tmpl t
		like "$sample is refused, with a command" "$status:$err" '^2:grib2vtk: .*, as cdo [a-z0-9]+,?[a-z]* IN OUT writes$'
		ok "its command works: $(advised)" cdo -s -O "$(advised)" $samples/$sample.tmpl out.grib
		like 'and its result is a grid' "$(grib2vtk out.grib t | sed -n 5p)" '^DIMENSIONS 128 64 1$'
	done
else
	skip 'commands of cdo' 'cdo is not there'
fi
finish
