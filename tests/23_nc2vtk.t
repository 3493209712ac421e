#!/bin/sh
# nc2vtk: the numbers of real files and of files made here, compared with ncdump; refusals and their messages.
. "$(dirname "$0")/lib.sh"
needs nc2vtk ncdump ncgen /usr/share/ncarg/data /usr/share/ferret-vis/data
converter=nc2vtk
# shellcheck source=grids.sh
. "$root/tests/grids.sh"
ncarg=/usr/share/ncarg/data ferret=/usr/share/ferret-vis/data

# ---- readers: ncdump for NetCDF, grids.sh for the output --------------------------------------------------
# want FILE VARIABLE: prints its numbers, one per line, _ if missing; a variable of a group by its full name
want() {
	ncdump -p 9,17 -v "$2" "$1" | sed -n "/^ *data:/,\$p" | awk -v name="${2##*/}" '
		$1 == name && $2 == "=" && !done { on = 1; sub(/^[^=]*=/, "") }
		on { end = /;/; gsub(/[,;]/, " "); for (i = 1; i <= NF; i++) print $i; if (end) { on = 0; done = 1 } }'
}
# same WANT GOT TOLERANCE [NX NY NZ TURNED]: compares numbers, by relative tolerance; reverses the axes in TURNED (y, z)
same() {
	awk -v tolerance="$3" -v nx="${4:-1}" -v ny="${5:-1}" -v nz="${6:-1}" -v turned="${7-}" '
		NR == FNR { want[n++] = $1; next }
		{
			at = FNR - 1
			x = at % nx; y = int(at / nx) % ny; z = int(at / nx / ny)
			if (turned ~ /y/) y = ny - 1 - y
			if (turned ~ /z/) z = nz - 1 - z
			w = want[turned ? (z * ny + y) * nx + x : at]
			if (w == "_" ? $1 !~ /nan/ : $1 ~ /nan/ || ($1 - w) ^ 2 > (tolerance * w) ^ 2) {
				print "value " FNR ": " $1 ", expected " w
				exit bad = 1
			}
			seen++
		}
		END { if (!bad && (seen != n || !n)) { print seen " values, expected " n; bad = 1 } exit bad }' "$1" "$2"
}
single=1.2e-7 # what a float may lose as a decimal
# agrees FILE VARIABLE X Y Z [NX NY NZ TURNED]: compares the grid of a variable with ncdump; Z is negated
agrees() {
	nc2vtk "$1" "$2" >a.vtk || return
	for name in "X $3" "Y $4" "Z $5"; do
		want "$1" "${name#* }" | awk -v z="${name% *}" '{ printf "%.17g\n", z == "Z" ? -$1 : $1 }' | sort -g >w
		coordinates "${name% *}" a.vtk >g
		same w g $single || return
	done
	want "$1" "$2" >w
	values a.vtk >g
	same w g $single "${6-}" "${7-}" "${8-}" "${9-}"
}

# ---- files of Debian packages ---------------------------------------------------------------------------------
nc4=$ncarg/cdf/nc4uvt.nc
run nc2vtk -l "$nc4"
is '-l exits 0' "$status:$err" 0:
is '-l lists variables of groups, with axes and units' "$(printf '%s\n' "$out" | sed -n 5p)" \
	'/grp1/U	x=lon:128	y=lat:64	z=-lev:14	t=time:1	[m/s]	Zonal Wind'
run nc2vtk -i "$nc4"
is '-i exits 0' "$status:$err" 0:
like '-i prints a table' "$(printf '%s\n' "$out" | head -n 1)" '^name    shape      units  range +times +description$'
like '-i: a row has name, shape, unit, range, times and description' "$out" \
	'^grp1/U  128x64x14  m/s    -23.3702 to 81.639   1: 0 Month  Zonal Wind$'
for name in T ${NIGHT:+U V}; do ok "nc4uvt.nc: $name has the values that ncdump reads" agrees "$nc4" $name lon lat lev; done
# ncdump has no data of one group alone: its /grp1/U comes after the root's
ok 'nc4uvt.nc: a variable of a group' sh -c "nc2vtk '$nc4' grp1/U >b.vtk && nc2vtk '$nc4' U >a.vtk && cmp a.vtk b.vtk"
nc2vtk "$nc4" 'speed=hypot(U,/grp1/V)' >speed.vtk
want "$nc4" U >u
want "$nc4" V >v
paste u v | awk '{ print $1 == "_" || $2 == "_" ? "_" : sprintf("%.12g", sqrt($1 ^ 2 + $2 ^ 2)) }' >w
values speed.vtk >g
ok 'nc4uvt.nc: speed=hypot(U,V)' same w g 2e-7
is 'the title has the names and units of the file' "$(sed -n 2p speed.vtk)" \
	'speed [m/s]; x lon [degrees_east]; y lat [degrees_north]; z -lev [hPa]; t time 0 [Month]'
is 'the scalar has the name' "$(grep -a '^SCALARS' speed.vtk)" 'SCALARS speed float 1'
coordinates Z speed.vtk >g
is 'pressure is negated, so that the axis points up' "$(sed -n '1p;$p' g | tr -d ' \n')" '-1000-10'

echam=$ncarg/nug/rectilinear_grid_3D.nc
for name in t ${NIGHT:+rhumidity}; do ok "rectilinear_grid_3D.nc: $name" agrees "$echam" $name lon lat lev 192 96 17 y; done
coordinates Y a.vtk >g
ok 'latitudes that decrease are turned round' sort -gc g

levitus=$ferret/levitus_climatology.cdf
nc2vtk "$levitus" TEMP >a.vtk
values a.vtk >g
# ncdump takes long for a million values.
[ -z "${NIGHT-}" ] || ok 'levitus_climatology.cdf: depths, which are turned round' \
	agrees "$levitus" TEMP XAXLEVITR YAXLEVITR ZAXLEVITR 360 180 20 z
is 'levitus_climatology.cdf: 44 % of the values are missing' "$(awk '/nan/ { n++ } END { print int(100 * n / NR) }' g)" 44
coordinates X a.vtk >g
is 'longitudes continue beyond 360' "$(sed -n '1p;$p' g | tr -s ' \n' ' ')" ' 20.5 379.5 '
coordinates Z a.vtk >g
is 'the surface is on top' "$(sed -n '1p;$p' g | tr -s ' \n' ' ')" ' -5000 0 '

atlas=$ferret/ocean_atlas_subset.nc
ok 'ocean_atlas_subset.nc: -t all writes all months' nc2vtk -t all -o 'm%02d.vtk' "$atlas" TEMP
is 'ocean_atlas_subset.nc: 12 months make 12 files' "$(echo m*)" "$(echo $(seq -f 'm%02g.vtk' 0 11))"
if [ -n "${NIGHT-}" ]; then
	cells=$((180 * 90 * 19))
	want "$atlas" TEMP >all
	for month in 0 7 11; do
		tail -n +$((month * cells + 1)) all | head -n $cells >w
		values "$(printf 'm%02d.vtk' $month)" >g
		ok "month $month has the values that ncdump reads" same w g $single 180 90 19 z
	done
fi
ok '-t 7 writes the same as -t all for month 7' sh -c "nc2vtk -t 7 '$atlas' TEMP | cmp - m07.vtk"
ok 'the default is the first time' sh -c "nc2vtk '$atlas' TEMP | cmp - m00.vtk"
like 'the title has the time' "$(sed -n 2p m07.vtk)" '; t TIME [0-9.]+ \[hour since 0000-01-01 00:00:00\]$'

for file in "$nc4 U 128 -180 180" "$echam t 192 -180 180" "$levitus TEMP 360 20.5 380.5" "$atlas TEMP 180 20.5 380.5"; do
	# shellcheck disable=SC2086  # a word each
	set -- $file
	nc2vtk "$1" "$2" >open.vtk
	nc2vtk -c "$1" "$2" >closed.vtk
	ok "-c: the globe of $(basename "$1") is closed" closed open.vtk closed.vtk "$3"
	is '-c: the last longitude is the first one, 360 degrees on' "$(coordinates X closed.vtk | sed -n '1p;$p' | tr -s ' \n' ' ')" " $4 $5 "
	is '-c: the rest of the file is the same' "$(coordinates Y closed.vtk | cksum)$(sed -n '2p' closed.vtk)" \
		"$(coordinates Y open.vtk | cksum)$(sed -n '2p' open.vtk)"
done
nc2vtk -c -t all -o 'c%d.vtk' "$atlas" TEMP
for month in 0 1 11; do
	ok "-c, of month $month" closed "$(printf 'm%02d.vtk' $month)" c$month.vtk 180
done

# ---- files made here -----------------------------------------------------------------------------------------
# make_nc NAME DIMENSIONS VARIABLES DATA: writes NAME.nc
make_nc() { printf 'netcdf a {\ndimensions: %s\nvariables: %s\ndata: %s\n}\n' "$2" "$3" "$4" >"$1.cdl" && ncgen -o "$1.nc" "$1.cdl"; }
axes='double x(x); x:axis = "X"; double y(y); y:axis = "Y"; double z(z); z:axis = "Z";'
cube='x = 2; y = 2; z = 2;' nodes='x = 1, 2; y = 3, 4; z = 5, 6;'

make_nc packed "$cube" "$axes short s(z, y, x); s:scale_factor = 0.5; s:add_offset = 100.; s:_FillValue = -1s;
	s:missing_value = 7s, 8s; s:valid_range = 0s, 30s;" "$nodes s = 1, _, 7, 8, 0, 30, 31, -5;"
is 'packed: scale, offset, fill, missing values, valid range' "$(got packed.nc s)" '100.5 nan nan nan 100 115 nan nan'
make_nc valid "$cube" "$axes short s(z, y, x); s:scale_factor = 0.5; s:add_offset = 100.; s:valid_max = 104.;" \
	"$nodes s = 1, 2, 3, 7, 8, 9, 10, 11;"
is 'packed: a range of values, by its type' "$(got valid.nc s)" '100.5 101 101.5 103.5 104 nan nan nan'
make_nc wider "$cube" "$axes short s(z, y, x); s:scale_factor = .5f; s:add_offset = 100.; s:valid_range = 99., 104.;" \
	"$nodes s = 1, 2, -2, -3, 8, 9, 10, 11;"
is 'packed: values have the wider type of scale and offset' "$(got wider.nc s)" '100.5 101 99 nan 104 nan nan nan'
make_nc nan "$cube" "$axes float s(z, y, x); s:valid_range = NaNf, NaNf;" "$nodes s = 1, 2, 3, 4, 5, 6, 7, NaNf;"
is 'a valid range of NaN forbids nothing' "$(got nan.nc s)" '1 2 3 4 5 6 7 nan'
make_nc bytes "$cube" "$axes byte s(z, y, x); s:_Unsigned = \"true\"; s:_FillValue = -1b; s:valid_max = -2b;" "$nodes s = 0, 1, 127, -128, -2, -3, _, 5;"
is '_Unsigned bytes are read as unsigned' "$(got bytes.nc s)" '0 1 127 128 254 253 nan 5'
make_nc fill "$cube" "$axes float f(z, y, x); int i(z, y, x); double d(z, y, x); d:missing_value = 1e10f;" \
	"$nodes f = 1, _, 3, NaN, 5, 6, 7, 8; i = 1, 2, _, 4, 5, 6, 7, 8; d = 1, 1e10, 3, 4, 5, 6, 7, 8;"
is "NetCDF's default fill value and NaN are missing" "$(got fill.nc f)" '1 nan 3 nan 5 6 7 8'
is 'the default fill value of integers is missing' "$(got fill.nc i)" '1 2 nan 4 5 6 7 8'
is 'a missing value of another type is recognised' "$(got fill.nc d)" '1 nan 3 4 5 6 7 8'
make_nc rotated "$cube" "$axes short s(z, y, x); x:standard_name = \"grid_longitude\"; x:units = \"degrees\";" \
	"$nodes s = 1, 2, 3, 4, 5, 6, 7, 8;"
got rotated.nc s >/dev/null
like 'x of a rotated sphere is named so, whatever its name' "$(sed -n 2p a.vtk)" '; x grid_longitude \[degrees\]; y y '
make_nc rounded "$cube" "$axes float f(z, y, x); f:missing_value = -999.9;" "$nodes f = 1, -999.9, 3, 4, 5, 6, 7, 8;"
is 'a missing value that is more precise than the values is recognised' "$(got rounded.nc f)" '1 nan 3 4 5 6 7 8'

make_nc west "$cube" 'float x(x); x:units = "degrees_west"; float y(y); y:units = "degrees_south"; float z(z); float s(z, y, x);' \
	"$nodes s = 1, 2, 3, 4, 5, 6, 7, 8;"
is 'degrees to the west and to the south are turned' \
	"$(got west.nc s):$(on_line coordinates X a.vtk)|$(on_line coordinates Y a.vtk)|$(sed -n 2p a.vtk)" \
	'4 3 2 1 8 7 6 5:-2 -1|-4 -3|s []; x x [degrees_east]; y y [degrees_north]; z z []'

make_nc order 'lon = 4; lev = 2; t = 2; lat = 3;' 'float lon(lon); lon:units = "degrees_east"; float lat(lat); lat:units = "degrees_north";
	float lev(lev); lev:positive = "up"; double t(t); t:units = "days since 2000-1-1"; float s(lon, lev, t, lat);' \
	"lon = 1, 2, 3, 4; lat = 9, 8, 7; lev = 20, 10; t = 0, 1; s = $(seq -s, 0 47);"
sed 's/t = 2;/& nv = 2;/; s/double t(t);/float tb(t, nv); & t:bounds = "tb";/; s/t = 0, 1;/& tb = 0, 0.5, 1, 1;/' order.cdl | ncgen -o spans.nc
nc2vtk -t all -o 'span%d.vtk' spans.nc s
is 'an interval has its beginning and end in the title' "$(sed -n 's/.*; t //p;2q' span0.vtk) $(sed -n 's/.*; t //p;2q' span1.vtk)" \
	't 0 to 0.5 [days since 2000-1-1] t 1 [days since 2000-1-1]'
# s = 12 lon + 6 lev + 3 t + lat, latitudes and levels turned round
nc2vtk -t all -o 'o%d.vtk' order.nc s
is 'dimensions may come in any order; -t all writes each time as -t does' "$(got -t 1 order.nc s)$(cmp a.vtk o1.vtk)" \
	"$(for lev in 1 0; do for lat in 2 1 0; do for lon in 0 1 2 3; do echo $((12 * lon + 6 * lev + 3 + lat)); done; done; done | paste -sd' ')"
sed 's/lev:positive = "up"/lev:units = "hPa"; &/' order.cdl | ncgen -o upward.nc && got upward.nc s >/dev/null
is 'a pressure points down, whatever its attribute says' "$(on_line coordinates Z a.vtk)" '-20 -10'
sed 's/lev:positive = "up"/lev:standard_name = "depth"; lev:units = "m"/' order.cdl | ncgen -o deep.nc && got deep.nc s >/dev/null
is 'a depth points down without an attribute' "$(on_line coordinates Z a.vtk)" '-20 -10'
for edit in 's/lev:positive = "up"/lev:long_name = "Depth of water"/' 's/lev:positive = "up";//; s/\<lev\>/depth/g' \
	's/lev:positive = "up";//; s/\<lev\>/depth/g; s/depth = 20, 10;/depth = -10, -20;/'; do
	sed "$edit" order.cdl | ncgen -o deep.nc && got deep.nc s >/dev/null && echo "$(on_line coordinates Z a.vtk)"
done >depths
is 'so does one by its other names, unless it is negative already' "$(paste -sd: depths)" '-20 -10:-20 -10:-20 -10'
make_nc step 'time = 1; step = 2; z = 2; y = 2; x = 2;' "$axes double time(time); time:units = \"days since 2000-1-1\";
	double step(step); step:standard_name = \"forecast_period\"; step:units = \"hours\"; float s(time, step, z, y, x);" \
	"$nodes time = 0; step = 0, 6; s = $(seq -s, 1 16);"
is 'a time of one element, and steps' "$(got -t 1 step.nc s)" '9 10 11 12 13 14 15 16'
printf 'netcdf a {\ndimensions: n = 20000000; y = 2; x = 2;\nvariables: double n(n); n:_Storage = "chunked"; n:_ChunkSizes = 1000;\n\tfloat s(n, y, x); s:_Storage = "chunked"; s:_ChunkSizes = 1000, 2, 2;\n}\n' | ncgen -k nc4 -o long.nc -
run nc2vtk -l long.nc
like 'a coordinate that is too long is not read' "$out$err" 'n has 20000000 nodes, expected 16777216 at most'
for calendar in noleap standard; do
	sed "s/t:units = \"days since 2000-1-1\";/& t:calendar = \"$calendar\";/" order.cdl | ncgen -o calendar.nc && got -t 1 calendar.nc s >/dev/null
	sed -n 's/.*; t //p' a.vtk
done >calendars
is 'a calendar that is not the usual one is named with the time' "$(paste -sd: calendars)" 't 1 [days since 2000-1-1 (noleap)]:t 1 [days since 2000-1-1]'
# The proleptic Gregorian calendar is the usual one from 1582 on.
for since in 2000-1-1 0001-1-1; do
	sed "s/t:units = \"days since 2000-1-1\";/t:units = \"days since $since\"; t:calendar = \"proleptic_gregorian\";/; s/t = 0, 1;/t = 0, 738000.010416667;/" order.cdl |
		ncgen -o calendar.nc && got -t 1 calendar.nc s >/dev/null
	sed -n 's/.*; t t //p' a.vtk
done >calendars
is 'an earlier proleptic calendar is named, and a time has all its digits' "$(paste -sd: calendars)" \
	'738000.010416667 [days since 2000-1-1]:738000.010416667 [days since 0001-1-1 (proleptic_gregorian)]'
make_nc plain 'time = 2; a = 3; b = 2; c = 2;' 'float a(a); float b(b); float c(c); float s(time, a, b, c);' \
	"a = 1, 2, 4; b = 1, 2; c = 5, 4; s = $(seq -s, 0 23);"
is 'axes without attributes are told apart by their order' "$(got -t 1 plain.nc s)" '13 12 15 14 17 16 19 18 21 20 23 22'
is 'axes without attributes keep their names' "$(sed -n 2p a.vtk)" 's []; x c []; y b []; z a []'
ok 'the classic formats and NetCDF-4 give the same grid' sh -c 'for kind in 1 2 4 5; do ncgen -k $kind -o k.nc packed.cdl && nc2vtk k.nc s | cmp - "$1" || exit; done' - \
	"$(nc2vtk packed.nc s >p.vtk; echo p.vtk)"
make_nc ensemble "$cube member = 1; run = 1; t = 2;" \
	"$axes double t(t); t:axis = \"T\"; int member(member); float s(t, member, z, run, y, x); float u(t, z, y, x);" \
	"$nodes t = 0, 1; member = 7; s = $(seq -s, 16); u = $(seq -s, 16);"
is 'dimensions of one element are left out' "$(got -t 1 ensemble.nc s)" '9 10 11 12 13 14 15 16'
is 'axes are the same without dimensions of one element' "$(got -t 1 ensemble.nc 'd=hypot(s,u)' | cut -d' ' -f 4)" 16.970562
like '-l does not list dimensions of one element' "$(nc2vtk -l ensemble.nc)" '^/s	x=x:2	y=y:2	z=z:2	t=t:2	'
# The name of an axis decides last; an axis with an unknown name does not count as height.
for name in timestep time_step xtime date level_type ensemble number expver; do
	make_nc named "$name = 2; lat = 2; lon = 2;" "float $name($name); float lat(lat); float lon(lon); float s($name, lat, lon);" \
		"$name = 0, 1; lat = 1, 2; lon = 1, 2; s = 1, 2, 3, 4, 5, 6, 7, 8;"
	run nc2vtk -t 1 named.nc s
	case $name in
	*_type | ensemble | number | expver) is "an axis named $name is not taken for height" "$status:$(echo "$err" | grep -c 'is none of x, y, z and time')" 2:1 ;;
	*) is "an axis named $name is time, of a field without height" "$(got -t 1 named.nc s):$(on_line coordinates Z a.vtk)" '5 6 7 8:0' ;;
	esac
done
make_nc named 'm = 2; lat = 2; lon = 2;' 'float m(m); m:standard_name = "realization"; float lat(lat); float lon(lon); float s(m, lat, lon);' \
	'm = 0, 1; lat = 1, 2; lon = 1, 2; s = 1, 2, 3, 4, 5, 6, 7, 8;'
run nc2vtk named.nc s
like 'an axis of realizations is not taken for height' "$status:$err" '^2:.*: m has 2 elements and is none of x, y, z and time'
make_nc named 'bottom_top = 2; timestep = 2; lon = 2; lat = 2;' 'float bottom_top(bottom_top); float timestep(timestep);
	float lon(lon); float lat(lat); float s(bottom_top, timestep, lon, lat);' \
	"bottom_top = 1, 2; timestep = 0, 1; lon = 1, 2; lat = 1, 2; s = $(seq -s, 16);"
is 'axes without other marks are told apart by their names' "$(got -t 1 named.nc s)" '5 7 6 8 13 15 14 16'
make_nc named 'y = 2; step = 2; x = 2;' 'float y(y); float step(step); step:standard_name = "altitude"; float x(x); float s(y, step, x);' \
	'y = 1, 2; step = 1, 2; x = 1, 2; s = 1, 2, 3, 4, 5, 6, 7, 8;'
is 'a standard name decides before the names of axes' "$(got named.nc s)" '1 2 5 6 3 4 7 8'
cat >inner.cdl <<'END'
netcdf inner {
dimensions: x = 2; y = 2; z = 2;
variables: float x(x); float y(y); float z(z);
data: x = 1, 2; y = 1, 2; z = 1, 2;
group: a { group: b { variables: float s(z, y, x); data: s = 1, 2, 3, 4, 5, 6, 7, 8; } }
}
END
ncgen -k nc4 -o inner.nc inner.cdl
is 'coordinates are found in the groups around' "$(got inner.nc /a/b/s)" '1 2 3 4 5 6 7 8'
like '-l lists coordinates of the groups around' "$(nc2vtk -l inner.nc)" '^/a/b/s	x=x:2	y=y:2	z=z:2	-'
cat >curved.cdl <<'END'
netcdf curved {
dimensions: lev = 2; j = 2; i = 2;
variables: float lev(lev); lev:units = "hPa"; float lon(j, i); lon:units = "degrees_east"; float lat(j, i); lat:units = "degrees_north";
	float zg(lev, j, i); zg:standard_name = "geopotential_height"; zg:units = "m"; zg:coordinates = "lon lat";
data: lev = 850, 500; lon = 7, 9, 7, 9; lat = 50, 50, 51, 51; zg = 1500, 1500, 1500, 1500, 5600, 5600, 5600, 5600;
group: m { variables: float s(lev, j, i); s:coordinates = "lon lat"; data: s = 1, 2, 3, 4, 5, 6, 7, 8; }
}
END
ncgen -k nc4 -o curved.nc curved.cdl
sed 's/degrees_east/degrees_west/; s/degrees_north/degrees_south/' curved.cdl | ncgen -k nc4 -o away.nc
is 'those of each node are turned, too' "$(got -z away.nc m/s):$(on_line coordinates X a.vtk)|$(on_line coordinates Y a.vtk)" '4 3 2 1 8 7 6 5:-9 -7|-51 -50'
sed 's/degrees_east/radian/; s/degrees_north/radian/; s/lon = .*; zg/lon = .25, .5, .25, .5; lat = 1, 1, 1.25, 1.25; zg/' curved.cdl | ncgen -k nc4 -o radians.nc
is 'radians become degrees' "$(got -z radians.nc m/s):$(on_line coordinates X a.vtk)|$(on_line coordinates Y a.vtk)" \
	'1 2 3 4 5 6 7 8:14.32394487827058 28.64788975654116|57.29577951308233 71.61972439135292'
make_nc radians 'lon = 2; lat = 2; z = 2;' 'float lon(lon); lon:units = "radian"; float lat(lat); lat:units = "rad"; float z(z); float s(z, lat, lon);' \
	'lon = .25, .5; lat = 1, 1.25; z = 1, 2; s = 1, 2, 3, 4, 5, 6, 7, 8;'
is 'also of axes' "$(got radians.nc s):$(on_line coordinates X a.vtk)|$(sed -n 2p a.vtk)" \
	'1 2 3 4 5 6 7 8:14.32394487827058 28.64788975654116|s []; x lon [degrees_east]; y lat [degrees_north]; z z []'
is 'and so are longitudes, latitudes and geopotential heights of each node' \
	"$(got -z curved.nc m/s):$(on_line coordinates X a.vtk)|$(on_line coordinates Y a.vtk)|$(on_line coordinates Z a.vtk)" '1 2 3 4 5 6 7 8:7 9|50 51|1500 5600'

cat >paths.cdl <<'END'
netcdf paths {
dimensions: j = 2; i = 2;
group: geo { variables: float lon(j, i); lon:units = "degrees_east"; data: lon = 7, 9, 7, 9; }
group: m { variables: float s(j, i); s:coordinates = "/geo/lon at/lat"; data: s = 1, 2, 3, 4;
	group: at { variables: float lat(j, i); lat:units = "degrees_north"; data: lat = 50, 50, 51, 51; } }
}
END
ncgen -k nc4 -o paths.nc paths.cdl
is 'coordinates named by paths of groups' "$(got paths.nc m/s):$(on_line coordinates X a.vtk)|$(on_line coordinates Y a.vtk)" '1 2 3 4:7 9|50 51'

# longitudes NAME LON ...: writes NAME.nc, with values that count up
longitudes() {
	name=$1
	shift
	make_nc "$name" "lon = $#; lat = 2; z = 2;" \
		'float lon(lon); lon:units = "degrees_east"; float lat(lat); lat:units = "degrees_north"; float z(z); float s(z, lat, lon);' \
		"lon = $(echo "$@" | sed 's/ /, /g'); lat = 1, 2; z = 1, 2; s = $(seq -s, $((4 * $#)));"
}
longitudes round -180 -90 0 90
is '-c: the first column comes again at the end' "$(got -c round.nc s)" '1 2 3 4 1 5 6 7 8 5 9 10 11 12 9 13 14 15 16 13'
is '-c: the new column is 360 degrees further east' "$(on_line coordinates X a.vtk)" '-180 -90 0 90 180'
longitudes westwards 270 180 90 0
is '-c: longitudes may descend' "$(got -c westwards.nc s):$(on_line coordinates X a.vtk)" \
	'4 3 2 1 4 8 7 6 5 8 12 11 10 9 12 16 15 14 13 16:0 90 180 270 360'
longitudes stretched 0 100 180 270
is '-c: steps may differ' "$(got -c stretched.nc s >/dev/null; on_line coordinates X a.vtk)" '0 100 180 270 360'
longitudes rounded 0 51.43 102.86 154.29 205.71 257.14 308.57
is '-c: longitudes may be rounded' "$(got -c rounded.nc s >/dev/null; on_line coordinates X a.vtk | cut -d' ' -f 8)" 360
longitudes whole 0 90 180 270 360
ok '-c: a closed grid stays as it is' sh -c 'nc2vtk -c whole.nc s >a.vtk; nc2vtk whole.nc s | cmp - a.vtk'

# ---- units and heights -----------------------------------------------------------------------------------------
if there /usr/include/udunits2.h; then
	make_nc warm "$cube" "$axes z:units = \"hPa\"; float s(z, y, x); s:units = \"K\";" \
		'x = 1, 2; y = 3, 4; z = 1000, 500; s = 273.15, 274.15, 275.15, 276.15, 263.15, 264.15, 265.15, 266.15;'
	is '-u: values are converted' "$(nc2vtk -u degC warm.nc s >a.vtk; values a.vtk | awk '{ printf "%.3f ", $1 + 1e-4 }')" \
		'0.000 1.000 2.000 3.000 -10.000 -9.000 -8.000 -7.000 '
	sed 's/s:units = "K";/& s:units_metadata = "temperature: difference";/' warm.cdl | ncgen -o warmer.nc
	is '-u: a difference of temperatures stays one' "$(nc2vtk -u degC warmer.nc s >b.vtk; values b.vtk | awk '{ printf "%.2f ", $1 }')" \
		'273.15 274.15 275.15 276.15 263.15 264.15 265.15 266.15 '
	ncdump warm.nc | sed '/s:units/d' | ncgen -o bare.nc -
	run nc2vtk -u degC bare.nc s
	is '-u: values without a unit are refused' "$status:$out:$err" '2::nc2vtk: bare.nc: s: has no unit, expected one to convert from'
	like '-u: the title has the unit' "$(sed -n 2p a.vtk)" '^s \[degC\]; '
	sed 's/"K"/"kg m-2 s-1"/' warm.cdl | ncgen -o rain.nc && run nc2vtk -u mm/day rain.nc s
	like '-u: rain as a depth: a unit of the same numbers' "$status:$err" "2:.* does not convert to 'mm/day'; .* and kg m-2 day-1 those of mm/day$"
	run nc2vtk -u m warm.nc s
	is '-u: another quantity is refused' "$status:$out:$err" "2::nc2vtk: warm.nc: s: 'K' does not convert to 'm'"
	nc2vtk -z warm.nc s >a.vtk
	is '-z: pressures become heights of the standard atmosphere' "$(coordinates Z a.vtk | awk '{ printf "%.1f ", $1 }')" '110.9 5574.4 '
	like '-z: the title says so' "$(sed -n 2p a.vtk)" '; z height \[m\]$'
	# The geopotential of the lower level is 0 at three nodes, and half a layer higher at one.
	make_nc geo "$cube" "$axes z:units = \"hPa\"; float s(z, y, x); float gp(z, y, x); gp:standard_name = \"geopotential\"; gp:units = \"m2 s-2\";" \
		"x = 1, 2; y = 3, 4; z = 1000, 500; s = 1, 2, 3, 4, 11, 12, 13, 14; gp = 0, 0, 0, 9806.65, 19613.3, 19613.3, 39226.6, 49033.25;"
	is '-z: columns are moved to common heights' "$(got -z geo.nc s):$(coordinates Z a.vtk | awk '{ printf "%.2f ", $1 }')" '1 2 3 4 11 12 8 6.5:0.00 2000.00 '
	ncdump geo.nc | sed 's/^.*float gp(/float spread(z, y, x); spread:units = "m"; spread:long_name = "geopotential height spread";&/; s/^ gp =/ spread = 1, 1, 1, 1, 2, 2, 2, 2;&/' | ncgen -o spread.nc -
	ncdump spread.nc | sed 's/spread:long_name = .*/spread:standard_name = "geopotential_height"; spread:cell_methods = "time: standard_deviation";/' | ncgen -o deviation.nc -
	is '-z: nor is a deviation, whatever its standard name' "$(got -z deviation.nc s)" '1 2 3 4 11 12 8 6.5'
	is '-z: the spread of a height is no height' "$(got -z spread.nc s)" '1 2 3 4 11 12 8 6.5'
	ncdump spread.nc | sed 's/height spread"/height"/' | ncgen -o two.nc -
	is '-z: a standard name decides before a long name' "$(got -z two.nc s)" '1 2 3 4 11 12 8 6.5'
	# a * p0 + b * ps: 1013.25 and 226.3206 hPa at x 1, and half of the surface pressure at x 2
	hybrid='float z(z); z:axis = "Z"; z:positive = "down"; z:formula_terms = "a: ca b: cb p0: P0 ps: PS"; double ca(z), cb(z), P0;
		P0:units = "hPa"; float PS(x, y); PS:units = "hPa"; float x(x); float y(y); float s(z, y, x);'
	make_nc hybrid "$cube" "$hybrid" "z = 2, 1; x = 1, 2; y = 4, 3; ca = 0, .2263206; cb = 1, 0; P0 = 1000;
		PS = 1013.25, 1013.25, 506.625, 1013.25; s = 1, 2, 3, 4, 11, 12, 13, 14;"
	is '-z: hybrid levels, with the surface pressure; the ground has no value' "$(got -z hybrid.nc s)" '3 4 1 nan 13 14 11 12'
	is '-z: their planes' "$(coordinates Z a.vtk | awk '{ printf "%.0f ", $1 }')" '0 11000 '
	ncdump hybrid.nc | sed 's/double cb(z)/short cb(z)/; s/^.*P0:units/cb:scale_factor = .5;&/; s/ cb = 1, 0/ cb = 2, 0/' | ncgen -o stored.nc -
	is '-z: coefficients may be packed' "$(got -z stored.nc s)" '3 4 1 nan 13 14 11 12'
	ncdump hybrid.nc | sed 's/z = 2 ;/z = 2 ; nhym = 3 ;/; s/ca(z)/ca(nhym)/; s/cb(z)/cb(nhym)/; s/^ ca =.*/ ca = .2263206, 0, 9 ;/; s/^ cb =.*/ cb = 0, 1, 9 ;/' |
		ncgen -o some.nc -
	is '-z: coefficients of all levels, where the file has some of these' "$(got -z some.nc s)" '3 4 1 nan 13 14 11 12'
	ncdump hybrid.nc | awk '/ s\(z, y, x\)/ { v = $0; next } /^ s =/ { inside = 1 } inside && !/^}/ { d = d $0; next } /^}/ { print "group: g { variables: " v " data: " d " }" } 1' |
		ncgen -k nc4 -o deep.nc -
	is '-z: the surface pressure may be in a group around' "$(got -z deep.nc g/s)" '3 4 1 nan 13 14 11 12'
	# a + b * orog: 100 and 1000 m, above a ground of 0 to 800 m
	ncdump hybrid.nc | sed 's/"a: ca b: cb p0: P0 ps: PS"/"a: ca b: cb orog: PS"/; s/PS:units = "hPa"/PS:units = "m"/; s/^ ca =.*/ ca = 100, 1000 ;/; s/^ cb =.*/ cb = 1, 0 ;/;
		/^ PS =/,/;/c\ PS = 0, 0, 800, 0 ;' | ncgen -o orog.nc -
	is '-z: hybrid heights, with the height of the ground' "$(got -z orog.nc s):$(coordinates Z a.vtk | awk '{ printf "%.0f ", $1 }')" '3 4 1 nan 13 14 11 12:100 1000 '
	refused_z() { run nc2vtk -z "$1" s; like "refused: -z of $1" "$status:$out:$err" "^2::nc2vtk: $1: s: -z: $2"; }
	ncdump hybrid.nc | sed 's/float PS(/float Q(/; s/PS:units/Q:units/; s/^ PS =/ Q =/' | ncgen -o noground.nc -
	refused_z noground.nc 'the levels need PS of the surface, which is not there'
	ncdump hybrid.nc | sed 's/"a: ca /"a: cc /' | ncgen -o noterm.nc -
	ncdump hybrid.nc | sed 's/"a: ca b: cb p0: P0 ps: PS"/"s: ca eta: cb depth: PS"/' | ncgen -o ocean.nc -
	refused_z ocean.nc 'the formula_terms of z are none of those known: '
	# p0 exp(-lev): 1013.25 and 226.3206 hPa
	ncdump hybrid.nc | sed 's/"a: ca b: cb p0: P0 ps: PS"/"p0: P0 lev: ca"/; s/z:positive = .*/z:positive = "up";/; s/^ ca =.*/ ca = 1.485802701, -0.0131629866 ;/' | ncgen -o ln.nc -
	is '-z: the logarithm of pressures' "$(got -z ln.nc s):$(coordinates Z a.vtk | awk '{ printf "%.0f ", $1 + .1 }')" '13 14 11 12 3 4 1 2:0 11000 '
	ncdump hybrid.nc | sed 's/PS:units = .*/PS:long_name = "logarithm of surface pressure"; PS:units = "1";/; s/1013.25/11.526088451/g; s/506.625/10.832941271/' | ncgen -o lnps.nc -
	is '-z: hybrid levels, with the logarithm of the surface pressure' "$(got -z lnps.nc s):$(coordinates Z a.vtk | awk '{ printf "%.0f ", $1 + .1 }')" '3 4 1 nan 13 14 11 12:0 11000 '
	# a * 2 km + b1 * PS + b2 * Q: 200 and 1000 m where both are 0; 600 m more at x 2
	ncdump hybrid.nc | sed 's/"a: ca b: cb p0: P0 ps: PS"/"a: ca b1: cb b2: cc ztop: P0 zsurf1: PS zsurf2: Q"/; s/P0:units = .*/P0:units = "km"; double cc(z); float Q(x, y); Q:units = "m";/
		s/PS:units = "hPa"/PS:units = "m"/; s/^ P0 =.*/ P0 = 2; cc = .5, 0; Q = 0, 0, 800, 0;/; s/^ ca =.*/ ca = .1, .5 ;/; s/^ cb =.*/ cb = .25, 0 ;/
		/^ PS =/,/;/c\ PS = 0, 0, 800, 0 ;' | ncgen -o sleve.nc -
	is '-z: SLEVE coordinates' "$(got -z sleve.nc s):$(coordinates Z a.vtk | awk '{ printf "%.0f ", $1 }')" '3 4 1 nan 13 14 11 12:200 1000 '
	refused_z noterm.nc 'the levels name cc, which is not there'
	ncdump hybrid.nc | sed 's/PS(x, y)/PS(x, x)/' | ncgen -o square.nc -
	refused_z square.nc 'PS of the surface has x twice'
	ncdump hybrid.nc | sed 's/PS:units = "hPa"/PS:units = "K"/' | ncgen -o kelvin.nc -
	refused_z kelvin.nc "PS is in 'K', expected a unit of pressure"
	ncdump hybrid.nc | sed 's/P0:units = "hPa"/P0:units = "kPa"/; s/ P0 = 1000/ P0 = 100/' | ncgen -o kilo.nc -
	is '-z: pressures in any unit' "$(got -z kilo.nc s)" '3 4 1 nan 13 14 11 12'
	ncdump hybrid.nc | sed 's/p0: P0 //; s/^.*P0:units/ca:units = "hPa";&/; s/ 0.2263206/ 226.3206/' | ncgen -o pascals.nc -
	is '-z: a pressure called a, and not ap' "$(got -z pascals.nc s)" '3 4 1 nan 13 14 11 12'
	ncdump hybrid.nc | sed 's/z:positive = .*/z:standard_name = "atmosphere_hybrid_sigma_pressure_coordinate" ;/' | ncgen -o down.nc -
	is 'hybrid levels count downwards, if nothing else is said' "$(got -z down.nc s)" '3 4 1 nan 13 14 11 12'
	ncdump geo.nc | sed 's/gp:units = .*/gp:units = "km2 s-2" ;/; s/9806.65/0.00980665/; s/19613.3/0.0196133/g; s/39226.6/0.0392266/; s/49033.25/0.04903325/' |
		ncgen -o squares.nc -
	is '-z: a geopotential in any unit' "$(got -z squares.nc s)" '1 2 3 4 11 12 8 6.5'
	for unit in 'meter2 second-2' J/kg 'm**2 s**-2'; do
		ncdump geo.nc | sed "s,gp:units = .*,gp:units = \"$unit\" ;," | ncgen -o words.nc - && nc2vtk -z words.nc s >a.vtk && coordinates Z a.vtk
	done | awk '{ printf "%.2f ", $1 }' >g
	is '-z: a geopotential in any words' "$(cat g)" '0.00 2000.00 0.00 2000.00 0.00 2000.00 '
	ncdump geo.nc | sed 's/gp:units = .*/gp:units = "m2 s-1" ;/' | ncgen -o rate.nc -
	refused_z rate.nc "gp is in 'm2 s-1', expected a length or m2 s-2"
	for unit in decibars 'N/m2' 'hPa '; do
		ncdump geo.nc | sed "s,z:units = .*,z:units = \"$unit\" ;," | ncgen -o words.nc - && nc2vtk words.nc s >a.vtk && coordinates Z a.vtk
	done | awk '{ printf "%g ", $1 }' >g
	is 'a pressure in any unit points down' "$(cat g)" '-1000 -500 -1000 -500 -1000 -500 '
	ncdump hybrid.nc | sed "s/ps: PS/$(printf '%120s' '') ps: PS/" | ncgen -o blanks.nc -
	is '-z: terms may be far apart' "$(got -z blanks.nc s)" '3 4 1 nan 13 14 11 12'
	ncdump geo.nc | sed 's/gp:units = .*/gp:units = "K" ;/' | ncgen -o warmth.nc -
	refused_z warmth.nc "gp is in 'K', expected a length or m2 s-2"
	make_nc theta "$cube" "$axes z:units = \"K\"; float s(z, y, x);" "$nodes s = 1, 2, 3, 4, 5, 6, 7, 8;"
	refused_z theta.nc 'no heights, expected pressures'
	nc2vtk -z $ncarg/cdf/vinth2p.nc T >a.vtk
	is '-z: a climate model with hybrid levels' "$(coordinates Z a.vtk | awk 'NR == 1 || NR == 18 { printf "%.0f ", $1 }')" '55 36049 '
else
	skip 'units and heights' 'udunits2 is not there'
fi

# ---- refused, and why ------------------------------------------------------------------------------------------
data='s = 1, 2, 3, 4, 5, 6, 7, 8;' scalar='float s(z, y, x);'
make_nc twice "$cube" "$axes $scalar" "x = 1, 1; y = 3, 4; z = 5, 6; $data"
refused twice.nc s 's: x is 1 after 1, expected all to ascend or all to descend'
make_nc back 'x = 3; y = 2; z = 2;' "$axes $scalar" "x = 1, 3, 2; y = 3, 4; z = 5, 6; s = $(seq -s, 0 11);"
refused back.nc s 'x is 2 after 3'
make_nc one 'x = 2; y = 2; z = 1;' "$axes $scalar" "x = 1, 2; y = 3, 4; z = 5; s = 1, 2, 3, 4;"
is 'a height of one element gives a grid of one level, too' "$(got one.nc s):$(on_line coordinates Z a.vtk)" '1 2 3 4:5'
make_nc hole "$cube" "$axes $scalar" "x = 1, NaN; y = 3, 4; z = 5, 6; $data"
refused hole.nc s 'x is -?nan after 1'
make_nc curved "$cube" "float lon(y, x); float lat(y, x); double z(z); z:axis = \"Z\"; $scalar s:coordinates = \"lon lat\";" "$data"
refused curved.nc s 'a curvilinear grid: lon and lat are rectilinear neither in degrees nor on a plane of the file'
# As HYCOM, and ocean models of CMIP
counts="int x(x); x:axis = \"X\"; int y(y); y:axis = \"Y\"; y:units = \"1\"; double z(z); z:axis = \"Z\";
	float lon(y, x); lon:units = \"degrees_east\"; float lat(y, x); lat:units = \"degrees_north\"; $scalar s:coordinates = \"lon lat\";"
make_nc counted "$cube" "$counts" "x = 1, 2; y = 1, 2; z = 5, 6; lon = 15, 16, 15, 16; lat = 60, 60, 61, 61; $data"
is 'axes that count nodes have the places of two dimensions' "$(got counted.nc s):$(on_line coordinates X a.vtk):$(on_line coordinates Y a.vtk)" '1 2 3 4 5 6 7 8:15 16:60 61'
make_nc counted "$cube" "$counts" "x = 1, 2; y = 1, 2; z = 5, 6; lon = 15, 16, 15, 17; lat = 60, 60, 61, 62; $data"
refused counted.nc s 'a curvilinear grid: lon and lat are rectilinear neither in degrees nor on a plane of the file'
make_nc bare "$cube" "$scalar" "$data"
refused bare.nc s 'no rectilinear grid: there are no coordinates along z'
make_nc flat "$cube" "$axes float s(y, x);" "$nodes s = 1, 2, 3, 4;"
is 'a field of x and y has one level' "$(nc2vtk flat.nc s | grep -a '^DIMENSIONS')" 'DIMENSIONS 2 2 1'
make_nc double "$cube" 'float x(x); x:axis = "X"; float y(y); y:axis = "X"; float z(z); float s(z, y, x);' "$nodes $data"
refused double.nc s 'y and x both are x'
make_nc twice "run = 1; time = 2; height = 1; $cube" "$axes double run(run); run:units = \"days since 2000-1-1\"; double time(time);
	time:units = \"days since 2000-1-1\"; double height(height); height:positive = \"up\"; float s(run, time, height, z, y, x);" \
	"run = 0; time = 3, 4; height = 2; $nodes s = $(seq -s, 16);"
is 'beside an axis of its kind, one with one element is left out' "$(got -t 1 twice.nc s):$(sed -n 's/.*; //;2p' a.vtk)" \
	'9 10 11 12 13 14 15 16:t time 4 [days since 2000-1-1]'
make_nc five "$cube a = 2; b = 1; t = 1;" "$axes double t(t); t:axis = \"T\"; int a(a); float s(t, a, b, z, y, x);" \
	"$nodes t = 0; a = 1, 2; s = $(seq -s, 16);"
refused five.nc s 'a has 2 elements and is none of x, y, z and time, expected -d a=INDEX from 0 to 1, mean or spread, or a value: 1., 2.'
make_nc many 'a = 2; b = 2; c = 2; d = 2; e = 2;' 'float s(a, b, c, d, e);' "s = $(seq -s, 32);"
refused many.nc s 'no rectilinear grid: there are no coordinates along a'
make_nc huge "$cube" "$axes $scalar" "$nodes s = 1, 2, 3, 1e20, 5, 6, 7, 8;"
refused huge.nc s 'a value is as large as 1e\+20, expected at most 1e\+18, or missing_value'
make_nc text "$cube" "$axes char s(z, y, x);" "$nodes s = \"abcdefgh\";"
refused text.nc s 'its values are not numbers'
make_nc other 'x = 2; y = 2; z = 2; w = 2;' "$axes double w(w); w:axis = \"X\"; float s(z, y, x); float u(z, y, w);" "$nodes w = 1, 3; $data u = 1, 2, 3, 4, 5, 6, 7, 8;"
refused other.nc 'a=hypot(s,u)' 's and u have different axes'
refused other.nc nothing 'nothing: no such variable, expected one that -l lists'
refused "$ncarg/nug/tos_ocean_bipolar_grid.nc" tos 'a curvilinear grid'
run nc2vtk other.nc 's=hypot(s,u'
is 'a bad request is refused, and the message has the form of a good one' "$status:$err" \
	'2:nc2vtk: other.nc: s=hypot(s,u: the end stands where ) is expected'
refused missing.nc s 'No such file'
head -c 1000 "$nc4" >torn.nc
refused torn.nc U '.'
echo text >no.nc
refused no.nc s 'Unknown file format'
run nc2vtk -t 12 "$atlas" TEMP
is 'a time that is not there' "$status:$err" "2:nc2vtk: $atlas: TEMP: -t 12: expected an index below 12"
make_nc never "t = UNLIMITED; $cube" "$axes float s(t, z, y, x); double t(t); t:axis = \"T\";" "$nodes"
refused never.nc s 's: no times, expected one at least'
make_nc empty 'x = 2; y = 2; z = UNLIMITED;' "$axes float s(z, y, x);" 'x = 1, 2; y = 3, 4;'
refused empty.nc s 's: z has 0 nodes, expected 1 at least'
cp other.nc own-1.nc
for name in own-1.nc ./own-1.nc; do
	run nc2vtk -o $name own-1.nc s
	is "refused: $name for a grid of own-1.nc" "$status:$err" "2:nc2vtk: $name: is also an input, expected another file"
done
ok 'which stays as it is' cmp own-1.nc other.nc
longitudes half 0 90 180
longitudes gap 0 60 120 180 240
longitudes twice 0 120 240 360 480
for name in half gap twice; do
	run nc2vtk -c $name.nc s
	like "refused: -c of $name.nc" "$status:$out:$err" "^2::nc2vtk: $name.nc: s: -c: x goes from 0 to [0-9]*, expected a circle without its last step"
done
make_nc metres "$cube" "$axes x:units = \"km\"; $scalar" "$nodes $data"
run nc2vtk -c metres.nc s
is 'refused: -c of kilometres' "$status:$out:$err" '2::nc2vtk: metres.nc: s: -c: x is not a longitude in degrees'
like 'reasons are listed, too' "$(nc2vtk -l curved.nc)" '^# /s	a curvilinear grid'
make_nc bounded "$cube nv = 2;" "$axes x:bounds = \"x_bnds\"; float x_bnds(x, nv); float other(y, nv); $scalar" "$nodes $data"
is 'but no bounds' "$(nc2vtk -l bounded.nc | cut -f 1 | tr '\n' ' ')" '# /other /s '
like '-i: so are they in the table' "$(nc2vtk -i curved.nc)" '^# /s	a curvilinear grid'

make_nc winds "$cube" "$axes float u(z, y, x); u:units = \"m/s\"; float v(z, y, x); v:units = \"km/h\";" \
	"$nodes u = 3, 3, 3, 3, 3, 3, 3, 3; v = 4, 4, 4, 4, 4, 4, 4, 4;"
refused winds.nc 's=hypot(u,v)' "s=hypot.u,v.: the two are in 'm/s' and 'km/h', expected one unit"
make_nc text "$cube" "$axes short s(z, y, x); s:scale_factor = \"0.5\";" "$nodes s = 1, 2, 3, 4, 5, 6, 7, 8;"
refused text.nc s 's: scale_factor is not a number, expected one number'
make_nc words "$cube" "$axes float s(z, y, x); s:missing_value = \"-999\"; float r(z, y, x); r:valid_range = \"0 100\";" "$nodes"
refused words.nc s 's: missing_value is not a number, expected one number'
refused words.nc r 'r: valid_range is not a number, expected one number'
make_nc strong "$cube" "$axes float u(z, y, x); float v(z, y, x);" "$nodes u = 9e17, 3, 3, 3, 3, 3, 3, 3; v = 9e17, 4, 4, 4, 4, 4, 4, 4;"
refused strong.nc 's=hypot(u,v)' 's: a value is 1.27279e.18, expected 1e.18 at most'

# ---- files that are cut or damaged -----------------------------------------------------------------------------
cut_at() { head -c "$1" k.nc >cut.nc; run nc2vtk cut.nc s; [ "$status:$out" = 2: ] || echo "$kind: $1 bytes: $status"; }
damaged_at() { # another byte there: a grid, or a message
	{ head -c "$1" k.nc; printf '\377'; tail -c +$(($1 + 2)) k.nc; } >cut.nc
	run prlimit --as=1000000000 nc2vtk -o cut.vtk cut.nc s
	case $status in 0 | 2) ;; *) echo "$kind: byte $1: $status" ;; esac
}
make_nc records 't = UNLIMITED; y = 2; x = 2; z = 2;' "$axes double t(t); short s(t, z, y, x); byte b(t);" "$nodes t = 1, 2; s = $(seq -s, 16); b = 1, 2;"
turn=0 step=81 # the kinds take turns on the bytes
[ -z "${NIGHT-}" ] || step=27
for cdl in packed records; do
	for kind in 1 2 5; do
		turn=$(((turn + 1) % 3))
		ncgen -k $kind -o k.nc $cdl.cdl
		size=$(wc -c <k.nc)
		# A format may be padded by up to 3 bytes, which hold nothing.
		for at in 4 8 30 100 $((size / 2)) $((size - 12)) $((size - 4)); do cut_at "$at"; done
		for at in $(seq $((4 + 9 * turn)) "$step" $((size - 1))); do damaged_at "$at"; done
	done
done >bad
is 'classic files that are cut are refused, and damage ends no process' "$(cat bad)" ''
head -c 200 packed.nc >cut.nc
run nc2vtk cut.nc s
like 'a file that is cut: the message says so' "$status $err" '^2 nc2vtk: cut.nc: (ends after 200 bytes, expected [0-9]+|byte [0-9]+: damaged, expected the header of a NetCDF file)$'

# ---- Zarr ----------------------------------------------------------------------------------------------------
if ncgen -4 -o "file://$PWD/z.zarr#mode=nczarr,file" packed.cdl 2>/dev/null && [ -d z.zarr ]; then
	is 'a Zarr store by its path' "$(nc2vtk z.zarr s | od -c | tail -n 3)" "$(nc2vtk packed.nc s | od -c | tail -n 3)"
	find z.zarr -name .zarray -exec sed -i 's/"compressor": null/"compressor": {"id": "blosc"}/' {} +
	run nc2vtk z.zarr s
	like 'a packed one is refused' "$status:$err" '^2:nc2vtk: z.zarr: .* is packed, and libnetcdf does not unpack Zarr'
else skip 'a Zarr store' 'this libnetcdf writes none'
fi

# ---- usage, and a full disk ----------------------------------------------------------------------------------
at_the_end packed.nc s
nc2vtk -o p.vtk packed.nc s
nc2vtk packed.nc s >q.vtk
ok '-o writes the same' cmp p.vtk q.vtk
nc2vtk -o p.vtk huge.nc s 2>err
ok 'a failure leaves the old file' cmp p.vtk q.vtk
is 'a failure leaves no new file' "$(echo p.vtk*)" p.vtk
finish
