#!/bin/sh
# nc2vtk and grib2vtk: grids on planes of projection, with the plane in the title. Where PROJ and ecCodes have each node is
# compared with x and y of the grid.
. "$(dirname "$0")/lib.sh"
needs nc2vtk grib2vtk ncgen proj grib_filter grib_get_data /usr/share/eccodes/samples /usr/include/proj.h
converter=nc2vtk
# shellcheck source=grids.sh
. "$root/tests/grids.sh"
samples=/usr/share/eccodes/samples
make_nc() { printf 'netcdf a {\ndimensions: %s\nvariables: %s\ndata: %s\n}\n' "$2" "$3" "$4" >"$1.cdl" && ncgen -o "$1.nc" "$1.cdl"; }
plane() { sed -n '2s/.*; proj //p' a.vtk; }
# on_plane: the places of longitudes and latitudes, a line each. A rotated sphere has degrees.
on_plane() {
	case $(plane) in *o_proj*) turn='-m 57.29577951308232' ;; *) turn='' ;; esac
	# shellcheck disable=SC2046,SC2086  # a word each
	proj -f %.6f $turn $(plane)
}
# lies STEP [WANT]: lines of "LON LAT N" in the file places, or of "X Y N" in want: the node with value N is there, to 1e-4
# of a step
lies() {
	[ -n "${2-}" ] || on_plane <places >want # proj passes on what follows a place
	{ echo X; coordinates X a.vtk; echo Y; coordinates Y a.vtk; echo V; values a.vtk; } | awk -v step="$1" '
		FNR == NR { x[$3 + 0] = $1; y[$3 + 0] = $2; n++; next }
		/[XYV]/ { on = $1; next }
		on == "X" { X[nx++] = $1 }
		on == "Y" { Y[ny++] = $1 }
		on == "V" {
			i = at % nx; j = int(at / nx) % ny; at++; v = $1 + 0; seen++
			dx = X[i] - x[v]; dy = Y[j] - y[v]
			if (!(v in x) || dx * dx + dy * dy > (1e-4 * step) ^ 2) { print v ": " X[i] " " Y[j] ", expected " x[v] " " y[v]; exit bad = 1 }
		}
		END { exit bad || !n || seen != n }' want -
}

# ---- grid mappings of NetCDF ---------------------------------------------------------------------------------------
# mapped NAME UNIT ATTRIBUTES: writes NAME.nc, and prints its plane, units and x
mapped() {
	make_nc "$1" 'x = 2; y = 2; z = 2;' "double x(x); x:standard_name = \"projection_x_coordinate\"; x:units = \"$2\";
		double y(y); y:standard_name = \"projection_y_coordinate\"; y:units = \"$2\"; double z(z); z:units = \"m\"; z:axis = \"Z\";
		float s(z, y, x); s:grid_mapping = \"crs\"; int crs; $(echo "$3" | sed 's/[a-z_]* =/crs:&/g')" \
		'x = -3, 6; y = 2, 4; z = 5, 6; s = 1, 2, 3, 4, 5, 6, 7, 8;'
	nc2vtk "$1.nc" s >a.vtk && echo "$(plane) $(sed -n '2s/.*; x x \(.[a-z]*.\);.*/\1/p' a.vtk) $(on_line coordinates X a.vtk)"
}
sphere='earth_radius = 6371229.;' wgs='semi_major_axis = 6378137.; inverse_flattening = 298.257223563;'
is 'Lambert, two parallels, in km' "$(mapped lambert km "grid_mapping_name = \"lambert_conformal_conic\"; standard_parallel = 30., 60.5;
	latitude_of_projection_origin = 45.; longitude_of_central_meridian = -97.5; false_easting = 2.; false_northing = 0.; $sphere")" \
	'+proj=lcc +lat_1=30 +lat_2=60.5 +lat_0=45 +lon_0=-97.5 +x_0=2000 +R=6371229 [m] -3000 6000'
is 'Lambert, one parallel, on a spheroid' "$(mapped one m "grid_mapping_name = \"lambert_conformal_conic\"; standard_parallel = 50.;
	latitude_of_projection_origin = 50.; longitude_of_central_meridian = 10.; $wgs")" \
	'+proj=lcc +lat_1=50 +lat_2=50 +lat_0=50 +lon_0=10 +a=6378137 +rf=298.2572236 [m] -3 6'
is 'polar stereographic, by its parallel' "$(mapped polar meters "grid_mapping_name = \"polar_stereographic\"; standard_parallel = 60.;
	latitude_of_projection_origin = 90.; straight_vertical_longitude_from_pole = -45.; $sphere")" \
	'+proj=stere +lat_ts=60 +lat_0=90 +lon_0=-45 +R=6371229 [m] -3 6'
is 'polar stereographic, by its scale' "$(mapped scaled m "grid_mapping_name = \"polar_stereographic\"; scale_factor_at_projection_origin = .97;
	latitude_of_projection_origin = -90.; straight_vertical_longitude_from_pole = 0.;")" \
	'+proj=stere +lat_0=-90 +lon_0=0 +k_0=0.97 +R=6371229 [m] -3 6'
is 'Mercator' "$(mapped mercator m "grid_mapping_name = \"mercator\"; standard_parallel = 20.; longitude_of_projection_origin = 120.; $sphere")" \
	'+proj=merc +lat_ts=20 +lon_0=120 +R=6371229 [m] -3 6'
is 'Mercator, by its scale, with two half axes' "$(mapped scale m "grid_mapping_name = \"mercator\"; scale_factor_at_projection_origin = .9;
	longitude_of_projection_origin = 0.; semi_major_axis = 6378137.; semi_minor_axis = 6356752.;")" \
	'+proj=merc +lon_0=0 +k_0=0.9 +a=6378137 +b=6356752 [m] -3 6'
is 'oblique Mercator' "$(mapped oblique m "grid_mapping_name = \"oblique_mercator\"; azimuth_of_central_line = 40.; latitude_of_projection_origin = 45.;
	longitude_of_projection_origin = 8.; scale_factor_at_projection_origin = 1.; $sphere")" \
	'+proj=omerc +lat_0=45 +lonc=8 +alpha=40 +k_0=1 +R=6371229 [m] -3 6'
is 'Lambert, equal areas' "$(mapped area m "grid_mapping_name = \"lambert_azimuthal_equal_area\"; latitude_of_projection_origin = 52.;
	longitude_of_projection_origin = 10.; false_easting = 4321000.; $wgs")" \
	'+proj=laea +lat_0=52 +lon_0=10 +x_0=4321000 +a=6378137 +rf=298.2572236 [m] -3 6'
is 'Albers' "$(mapped albers m "grid_mapping_name = \"albers_conical_equal_area\"; standard_parallel = 29.5, 45.5;
	latitude_of_projection_origin = 23.; longitude_of_central_meridian = -96.; $sphere")" \
	'+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-96 +R=6371229 [m] -3 6'
is 'transverse Mercator' "$(mapped utm m "grid_mapping_name = \"transverse_mercator\"; scale_factor_at_central_meridian = .9996;
	latitude_of_projection_origin = 0.; longitude_of_central_meridian = 9.; false_easting = 500000.; $wgs")" \
	'+proj=tmerc +lat_0=0 +lon_0=9 +k_0=0.9996 +x_0=500000 +a=6378137 +rf=298.2572236 [m] -3 6'
is 'sinusoidal' "$(mapped sinusoidal m "grid_mapping_name = \"sinusoidal\"; longitude_of_projection_origin = 20.; earth_radius = 6371007.181;")" \
	'+proj=sinu +lon_0=20 +R=6371007.181 [m] -3 6'
is 'seen from a height' "$(mapped seen m "grid_mapping_name = \"vertical_perspective\"; latitude_of_projection_origin = 40.; longitude_of_projection_origin = 10.;
	perspective_point_height = 3000000.; $sphere")" '+proj=nsper +lat_0=40 +lon_0=10 +h=3000000 +R=6371229 [m] -3 6'
satellite='grid_mapping_name = "geostationary"; longitude_of_projection_origin = -75.; perspective_point_height = 35786023.;'
is 'what a satellite sees, in radians' "$(mapped radians rad "$satellite sweep_angle_axis = \"x\"; $wgs")" \
	'+proj=geos +lon_0=-75 +sweep=x +h=35786023 +a=6378137 +rf=298.2572236 [m] -107358069 214716138'
is 'and in metres' "$(mapped metres m "$satellite fixed_angle_axis = \"x\"; $sphere")" '+proj=geos +lon_0=-75 +h=35786023 +R=6371229 [m] -3 6'
sed 's/"crs"/"crs: x y other: z"/' utm.cdl | ncgen -o words.nc && nc2vtk words.nc s >a.vtk
like 'the attribute may name the coordinates, too' "$(plane)" '^.proj=tmerc '
is 'PROJ says nothing of its own, as without its database' "$(PROJ_LIB=/no PROJ_DATA=/no nc2vtk words.nc s 2>&1 >b.vtk; cmp a.vtk b.vtk 2>&1)" ''
is 'a field without a mapping has no plane' "$(sed 's/s:grid_mapping/s:note/' utm.cdl | ncgen -o bare.nc && nc2vtk bare.nc s >a.vtk; plane)" ''
is 'a meridian and an ellipsoid by name' "$(mapped paris m "grid_mapping_name = \"lambert_conformal_conic\"; standard_parallel = 46.8; latitude_of_projection_origin = 46.8;
	longitude_of_central_meridian = 0.; longitude_of_prime_meridian = 2.33722917; reference_ellipsoid_name = \"Bessel 1841\";")" \
	'+proj=lcc +lat_1=46.8 +lat_2=46.8 +lat_0=46.8 +lon_0=0 +pm=2.33722917 +a=6377397.155 +rf=299.1528128 [m] -3 6'
for bad in 'lambert_conformal_conic has no number standard_parallel' 'geostationary has no number perspective_point_height' healpix; do
	mapped bad m "grid_mapping_name = \"${bad%% *}\"; longitude_of_central_meridian = 9.;" >got 2>err
	like "a mapping that is not known: ${bad%% *}" "$(cat got):$(cat err)" "^ .m. -3 6:nc2vtk: bad.nc: s: its grid mapping (is )?$bad"
done
mapped bad m 'crs_wkt = "PROJCS[]";' >got 2>err
like 'a mapping without a name' "$(cat got):$(cat err)" '^ .m. -3 6:nc2vtk: bad.nc: s: its grid mapping has no grid_mapping_name, .* no coasts$'
mapped bad m "grid_mapping_name = \"lambert_conformal_conic\"; standard_parallel = 30., -30.; latitude_of_projection_origin = 0.;
	longitude_of_central_meridian = 9.;" >got 2>err
like 'a mapping that PROJ refuses' "$(cat got):$(cat err)" '^ .m. -3 6:nc2vtk: bad.nc: s: PROJ refuses .*, so that maps have no coasts$'
long=$(printf '%62s' '' | tr ' ' u)
nc2vtk utm.nc "$long=s" >a.vtk
like 'a long name and the plane' "$(plane)" '^.proj=tmerc .* [+]rf=298.2572236$'
sed "s/s:grid_mapping/s:units = \"$long$long\"; &/" utm.cdl | ncgen -o wide.nc && nc2vtk wide.nc "$long=s" >a.vtk 2>err
like 'a title without room for the plane' "$(plane):$(cat err)" '^:nc2vtk: .*: the title has no room for .*, so that maps have no coasts$'

make_nc rotated 'rlon = 2; rlat = 2; z = 2;' 'double rlon(rlon); rlon:standard_name = "grid_longitude"; rlon:units = "degrees"; double rlat(rlat);
	rlat:standard_name = "grid_latitude"; rlat:units = "degrees"; double z(z); z:units = "m"; z:axis = "Z"; float s(z, rlat, rlon);
	s:grid_mapping = "pole"; char pole; pole:grid_mapping_name = "rotated_latitude_longitude"; pole:grid_north_pole_latitude = 39.25;
	pole:grid_north_pole_longitude = -162.;' 'rlon = -5.1326448, 3; rlat = -.472428088, 0; z = 1, 2; s = 1, 2, 3, 4, 5, 6, 7, 8;'
nc2vtk rotated.nc s >a.vtk
is 'a rotated pole' "$(plane)" '+proj=ob_tran +o_proj=longlat +o_lat_p=39.25 +o_lon_p=0 +lon_0=18'
echo 10 50 >places
is 'and where it has a place' "$(on_plane <places | awk '{ printf "%.4f %.4f", $1, $2 }')" '-5.1326 -0.4724'

# ---- longitude and latitude of each node ------------------------------------------------------------------------------
# inverse PLANE STEP: 3x3 places around 0 on a plane: XLONG and XLAT, as text of CDL
inverse() {
	for y in -1 0 1; do for x in -1 0 1; do echo $((x * $2)) $((y * $2)); done; done | eval "proj -I -f %.7f $1" >lonlat
	echo "XLONG = $(cut -f 1 lonlat | paste -sd,); XLAT = $(cut -f 2 lonlat | paste -sd,);"
}
# each COUNT TEXT: repeats the text, for lists
each() { yes "$2" | head -n "$1" | paste -sd,; }
wrf_of() { # NAME ATTRIBUTES PLANE: writes NAME.nc
	make_nc "$1" 'Time = 2; DateStrLen = 19; west_east = 3; south_north = 3; bottom_top = 2; bottom_top_stag = 3; west_east_stag = 4; south_north_stag = 4;' \
		"char Times(Time, DateStrLen); float XLAT(Time, south_north, west_east); XLAT:units = \"degree_north\"; float XLONG(Time, south_north, west_east);
		XLONG:units = \"degree_east\"; float T(Time, bottom_top, south_north, west_east); T:units = \"K\"; T:coordinates = \"XLONG XLAT XTIME\";
		float U(Time, bottom_top, south_north, west_east_stag); U:coordinates = \"XLONG_U XLAT_U XTIME\"; float V(Time, bottom_top, south_north_stag, west_east);
		float W(Time, bottom_top_stag, south_north, west_east); float PH(Time, bottom_top_stag, south_north, west_east); PH:units = \"m2 s-2\";
		float PHB(Time, bottom_top_stag, south_north, west_east); PHB:units = \"m2 s-2\"; float HGT(Time, south_north, west_east); $2" \
		"$(inverse "$3" 9000) Times = \"2024-02-28_18:00:00\", \"2024-03-01_00:30:00\"; T = $(seq -s, 18); U = $(each 3 0,1,2,3), $(each 3 10,11,12,13);
		V = 0, 0, 0, 2, 2, 2, 4, 4, 4, 6, 6, 6, 10, 10, 10, 12, 12, 12, 14, 14, 14, 16, 16, 16; W = $(each 9 0), $(each 9 1), $(each 9 4);
		PH = $(each 9 0), $(each 9 981), $(each 9 1962); PHB = $(each 9 0), $(each 9 981), $(each 9 3924); HGT = $(seq -s, 9);"
}
about() { plane; for axis in X Y; do coordinates $axis a.vtk | awk '{ printf "%.0f ", $1 / 10 }'; done; }
lambert=':MAP_PROJ = 1; :TRUELAT1 = 30.f; :TRUELAT2 = 60.f; :STAND_LON = 10.f; :MOAD_CEN_LAT = 50.f; :CEN_LAT = 48.f; :CEN_LON = 11.f;'
wrf_of wrf "$lambert" '+proj=lcc +lat_1=30 +lat_2=60 +lat_0=50 +lon_0=10 +R=6370000'
is 'WRF: values' "$(got wrf.nc T)" "$(seq -s' ' 18)"
is 'WRF: a Lambert plane' "$(about)" '+proj=lcc +lat_1=30 +lat_2=60 +lat_0=50 +lon_0=10 +R=6370000
-900 0 900 -900 0 900 '
is 'WRF: U in the middle' "$(got wrf.nc U)" "$(each 3 '0.5 1.5 2.5' | tr , ' ') $(each 3 '10.5 11.5 12.5' | tr , ' ')"
is 'WRF: V in the middle' "$(got wrf.nc V)" '1 1 1 3 3 3 5 5 5 11 11 11 13 13 13 15 15 15'
is 'WRF: W in the middle' "$(got wrf.nc W)" "$(each 9 0.5 | tr , ' ') $(each 9 2.5 | tr , ' ')"
is 'WRF: an expression of them' "$(got wrf.nc 'a=U-V+W' | cut -d' ' -f 1,2,18)" '0 1 0'
is 'WRF: the ground' "$(got wrf.nc HGT)" '1 2 3 4 5 6 7 8 9'
is 'WRF: -z: heights of PH and PHB' "$(got -z wrf.nc 'theta=T+300' | cut -d' ' -f 1,18):$(on_line coordinates Z a.vtk)" '301 318:100 400'
is 'WRF: times of texts, over a leap day' "$(nc2vtk -t 1 wrf.nc T | sed -n '2s/.*; t //p' | sed 's/;.*//')" 'Time 30.5 [hours since 2024-02-28 18:00:00]'
sed 's/float HGT/double XTIME(Time); XTIME:units = "minutes since 2024-02-28 18:00:00"; &/; s/HGT = /XTIME = 0, 1830; &/' wrf.cdl | ncgen -o xtime.nc
is 'WRF: times of numbers' "$(nc2vtk -t 1 xtime.nc T | sed -n '2s/.*; t //p' | sed 's/;.*//')" 'Time 1830 [minutes since 2024-02-28 18:00:00]'
sed 's/bottom_top_stag = 3;/& soil_layers_stag = 4;/; s/float HGT/float TSLB(Time, soil_layers_stag, south_north, west_east); TSLB:coordinates = "XLONG XLAT"; &/' wrf.cdl |
	ncgen -o soil.nc
refused soil.nc TSLB 'soil_layers_stag has 4 elements and is none of x, y, z and time, expected -d soil_layers_stag=INDEX from 0 to 3'
sed "s/:MAP_PROJ = 1/:DX = 500.f; :DY = 250.f; &/; s/XLONG = [^;]*; XLAT = [^;]*/XLONG = $(each 9 0); XLAT = $(each 9 0)/" wrf.cdl | ncgen -o ideal.nc
is 'WRF: an ideal case, by its steps' "$(got ideal.nc T >/dev/null; about; sed -n '2s/.*; x \(.*\); z .*/\1/p' a.vtk)" '0 50 100 0 25 50 west_east [m]; y south_north [m]'
wrf_of polar ':MAP_PROJ = 2; :TRUELAT1 = -71.f; :TRUELAT2 = -91.f; :STAND_LON = 90.f;' '+proj=stere +lat_ts=-71 +lat_0=-90 +lon_0=90 +R=6370000'
is 'WRF: a polar plane' "$(got polar.nc T >/dev/null; about)" '+proj=stere +lat_0=-90 +lat_ts=-71 +lon_0=90 +R=6370000
-900 0 900 -900 0 900 '
wrf_of mercator ':MAP_PROJ = 3; :TRUELAT1 = 20.f; :STAND_LON = 0.f; :CEN_LON = 180.f;' '+proj=merc +lat_ts=20 +lon_0=180 +R=6370000'
is 'WRF: a Mercator plane that crosses 180' "$(got mercator.nc T >/dev/null; about)" '+proj=merc +lat_ts=20 +lon_0=180 +R=6370000
-900 0 900 -900 0 900 '
sed 's/:MAP_PROJ = 3/:MAP_PROJ = 6/; s/:STAND_LON/:POLE_LAT = 90.f; :POLE_LON = 0.f; &/' mercator.cdl | ncgen -o degrees.nc
is 'WRF: degrees that cross 180' "$(got degrees.nc T >/dev/null; plane; coordinates X a.vtk | awk '{ printf "%.3f ", $1 }')" '179.914 180.000 180.086 '
sed 's/:TRUELAT2 = 60.f/:TRUELAT2 = 50.f/' wrf.cdl | sed 's/XLONG = 9[0-9.]*/XLONG = 9.9/' | ncgen -o off.nc
sed "s/XLONG = [^;]*/&, $(each 9 11)/" wrf.cdl | ncgen -o nest.nc
refused nest.nc T 'a curvilinear grid: XLONG and XLAT change with time, expected coordinates along each axis, as cdo'
refused off.nc T 'a curvilinear grid: XLONG and XLAT leave a rectilinear grid on the plane of the file by [0-9.e+]* steps, expected coordinates along each axis, as cdo'

# ---- levels that follow the bottom of the sea ---------------------------------------------------------------------------
# a depth of 90 m, the surface 1 m higher than at rest; the values are their levels' numbers
make_nc roms 'ocean_time = 1; s_rho = 2; eta_rho = 2; xi_rho = 3;' 'double ocean_time(ocean_time); ocean_time:units = "seconds since 2026-01-01";
	double s_rho(s_rho); s_rho:standard_name = "ocean_s_coordinate_g2"; s_rho:formula_terms = "s: s_rho C: Cs_r eta: zeta depth: h depth_c: hc";
	double Cs_r(s_rho); double hc; hc:units = "meter"; double a; double b; double zlev(s_rho); int n; double h(eta_rho, xi_rho); h:units = "meter";
	double zeta(ocean_time, eta_rho, xi_rho); zeta:units = "cm"; double lon_rho(eta_rho, xi_rho); lon_rho:units = "degree_east";
	double lat_rho(eta_rho, xi_rho); lat_rho:units = "degree_north"; float temp(ocean_time, s_rho, eta_rho, xi_rho);
	temp:coordinates = "lon_rho lat_rho s_rho ocean_time";' 's_rho = -.5, -.1; Cs_r = -.3, -.05; hc = 10; a = 5; b = .4; zlev = -200, -300; n = 0;
	h = 90, 90, 90, 90, 90, 90; zeta = 100, 100, 100, 100, 100, 100; lon_rho = -71, -70, -68, -71, -70, -68; lat_rho = 40, 40, 40, 41, 41, 41;
	temp = 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2;'
levels() { got -z "$1" temp >/dev/null && coordinates Z a.vtk | awk '{ printf "%.4f ", $1 }'; }
of_form() { sed "s/coordinate_g2/coordinate$1/; s/\"s: s_rho C: Cs_r eta/\"$2 eta/" roms.cdl | ncgen -o form.nc && levels form.nc; }
if there /usr/include/udunits2.h; then
	is 'ocean s, second generic form' "$(levels roms.nc)" '-28.1200 -4.0050 '
	is 'ocean s, first generic form' "$(of_form _g1 's: s_rho C: Cs_r')" '-28.3222 -4.0556 '
	is 'ocean s' "$(of_form '' 's: s_rho a: a b: b')" '-24.4137 -0.8034 '
	is 'ocean sigma' "$(sed 's/ocean_s_/ocean_sigma_/' roms.cdl >o.cdl; sed 's/coordinate_g2/coordinate/; s/"s: s_rho C/"sigma: s_rho C/' o.cdl | ncgen -o form.nc; levels form.nc)" '-44.5000 -8.1000 '
	sed 's/ocean_s_coordinate_g2/ocean_sigma_z_coordinate/; s/"s: s_rho C: Cs_r/"sigma: s_rho zlev: zlev nsigma: n/; s/hc = 10/hc = 50/' roms.cdl >o.cdl
	is 'ocean sigma over z' "$(sed 's/n = 0/n = 2/' o.cdl | ncgen -o form.nc; levels form.nc)" '-24.5000 -4.1000 '
	is 'ocean sigma over z: z' "$(sed 's/zlev = -200, -300/zlev = -300, -200/' o.cdl | ncgen -o form.nc; levels form.nc)" '-300.0000 -200.0000 '
	is 'ocean sigma over z: z in km' "$(sed 's/zlev = -200, -300/zlev = -.3, -.2/; s/int n;/& zlev:units = "km";/' o.cdl | ncgen -o form.nc; levels form.nc)" '-300.0000 -200.0000 '
	# f = 40 - 20 tanh((90 - 100) / -20) = 30.7577 m; half of it, and half of what is below
	sed 's/ocean_s_coordinate_g2/ocean_double_sigma_coordinate/; s/"s: s_rho C: Cs_r.*hc"/"Sigma: s_rho depth: h z1: z1 z2: z2 a: a href: href k_c: n"/
		s/double b;/double z1, z2, href; z1:units = "cm"; a:units = "km";/; s/s_rho = -.5, -.1/s_rho = .5, 1.5/; s/a = 5; b = .4/a = .001; z1 = 2000; z2 = 60; href = 100/
		s/n = 0/n = 1/' roms.cdl >double.cdl
	ncgen -o form.nc double.cdl
	is 'ocean double sigma: depths, with other units' "$(levels form.nc):$(on_line values a.vtk)" '-60.3788 -15.3788 :2 2 2 2 2 2 1 1 1 1 1 1'
	is 'ocean double sigma: from 0 to -2, from the bottom' "$(sed 's/s_rho = .5, 1.5/s_rho = -1.5, -.5/' double.cdl | ncgen -o form.nc; levels form.nc)" '-60.3788 -15.3788 '
	is 'the surface is at rest, if it is not named' "$(sed 's/eta: zeta //' roms.cdl | ncgen -o form.nc; levels form.nc)" '-28.8000 -4.9500 '
	is 'a depth_c in km' "$(sed 's/hc:units = "meter"/hc:units = "km"/; s/hc = 10/hc = .01/' roms.cdl | ncgen -o form.nc; levels form.nc)" '-28.1200 -4.0050 '
	is 'values stay at their levels' "$(got -z roms.nc temp)" '1 1 1 1 1 1 2 2 2 2 2 2'
	# depths of 80 and 100 m in turns, so that all points between them have 90 m, and what has no depth has none
	make_nc between 's_rho = 2; eta_rho = 3; xi_rho = 3; eta_u = 3; xi_u = 2; eta_v = 2; xi_v = 3; eta_psi = 2; xi_psi = 2;' 'double s_rho(s_rho);
		s_rho:standard_name = "ocean_s_coordinate_g2"; s_rho:formula_terms = "s: s_rho C: Cs_r eta: zeta depth: h depth_c: hc"; double Cs_r(s_rho); double hc;
		double h(eta_rho, xi_rho); double zeta(eta_rho, xi_rho); double lon_u(eta_u, xi_u), lat_u(eta_u, xi_u); lon_u:units = "degree_east";
		lat_u:units = "degree_north"; double lon_v(eta_v, xi_v), lat_v(eta_v, xi_v); lon_v:units = "degree_east"; lat_v:units = "degree_north";
		float u(s_rho, eta_u, xi_u), v(s_rho, eta_v, xi_v); u:coordinates = "lon_u lat_u"; v:coordinates = "lon_v lat_v";
		float p(s_rho, eta_psi, xi_psi); double eta_psi(eta_psi), xi_psi(xi_psi); p:note = "";' 's_rho = -.5, -.1; Cs_r = -.3, -.05; hc = 10;
		h = 80, 100, 80, 100, 80, 100, 80, 100, 80; zeta = 1, 1, 1, 1, 1, 1, 1, 1, 1; lon_u = 1, 2, 1, 2, 1, 2; lat_u = 5, 5, 6, 6, 7, 7; lon_v = 1, 2, 3, 1, 2, 3;
		lat_v = 5, 5, 5, 6, 6, 6; u = 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12; v = 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12; eta_psi = 5, 6; xi_psi = 1, 2;
		p = 1, 2, 3, 4, 5, 6, 7, 8;'
	for point in u v p; do
		is "ROMS: levels of $point, between the points of the depth" "$(got -z between.nc $point | wc -w):$(coordinates Z a.vtk | awk '{ printf "%.4f ", $1 }')" \
			"$([ $point = p ] && echo 8 || echo 12):-28.1200 -4.0050 "
	done
	sed 's/h = 80, 100, 80/h = 80, 100, _/' between.cdl | ncgen -o between.nc
	is 'ROMS: where a depth is missing' "$(got -z between.nc u | cut -d' ' -f 1-3)" '1 nan 3'
	sed 's/h = 90, 90/h = 90, 900/' roms.cdl | ncgen -o steep.nc
	is 'values are moved in each column' "$(got -z steep.nc temp | cut -d' ' -f 1-3)" '1 2 1'
	sed 's/ depth_c: hc//' roms.cdl | ncgen -o less.nc
	run nc2vtk -z less.nc temp
	is 'refused: a term that is not there' "$status:$out:$err" '2::nc2vtk: less.nc: temp: -z: the formula_terms of s_rho lack depth_c'
	sed 's/zeta: *zeta/q: q/; s/double zeta/double q/; s/zeta:units/q:units/; s/zeta = /q = /' roms.cdl | sed 's/eta: q/eta: zeta/' | ncgen -o no.nc
	run nc2vtk -z no.nc temp
	is 'refused: a variable that is not there' "$status:$out:$err" '2::nc2vtk: no.nc: temp: -z: the levels need zeta, which is not there'
fi
sed 's/lon_rho/lon/g; s/lat_rho/lat/g; s/temp:coordinates/temp:note/' roms.cdl | ncgen -o named.nc
is 'longitudes and latitudes of usual names, which the variable does not name' "$(got named.nc temp >/dev/null; on_line coordinates X a.vtk)" '-71 -70 -68'
is 'ROMS: degrees' "$(got roms.nc temp >/dev/null; on_line coordinates X a.vtk; on_line coordinates Y a.vtk)" '-71 -70 -6840 41'
sed 's/lat_rho = 40, 40, 40/lat_rho = 40, 40.2, 40.4/' roms.cdl | ncgen -o bent.nc
refused bent.nc temp 'a curvilinear grid: lon_rho and lat_rho are rectilinear neither in degrees nor on a plane of the file, expected coordinates along each axis, as cdo remapbil,GRID -selname,temp'

# ---- grids of GRIB ---------------------------------------------------------------------------------------------------
converter=grib2vtk
# projected NAME STEP PLANE RULES: all nodes of a grid of 5x4 lie where ecCodes and PROJ have them
projected() {
	grib_filter -o p.grib - "$samples/${5:-GRIB2}.tmpl" <<-END
		$4 set packingType="grid_ieee"; set values={1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20}; write;
	END
	name=$(grib_get -p shortName p.grib)
	grib_get_data -L '%.9f %.9f' p.grib | awk '$3 + 0 == $3 { print $2, $1, $3 }' >places
	grib2vtk p.grib "$name" >a.vtk
	is "$1: the plane" "$(plane)" "$3"
	ok "$1: each node" lies "$2"
}
lambert='set gridType="lambert"; set Nx=5; set Ny=4; set latitudeOfFirstGridPointInDegrees=42; set longitudeOfFirstGridPointInDegrees=350;
	set LaDInDegrees=46; set LoVInDegrees=2; set Latin1InDegrees=46; set Latin2InDegrees=46; set DxInMetres=2500; set DyInMetres=2500;'
lcc='+proj=lcc +lat_1=46 +lat_2=46 +lat_0=46 +lon_0=2'
projected 'Lambert' 2500 "$lcc +R=6371200" "$lambert set shapeOfTheEarth=8; set jScansPositively=1;"
projected 'Lambert, two parallels, a sphere of its own' 2500 '+proj=lcc +lat_1=30 +lat_2=60 +lat_0=46 +lon_0=2 +R=6370000' "$lambert set Latin1InDegrees=30;
	set Latin2InDegrees=60; set jScansPositively=1; set shapeOfTheEarth=1; set scaleFactorOfRadiusOfSphericalEarth=0; set scaledValueOfRadiusOfSphericalEarth=6370000;"
projected 'Lambert, on WGS 84' 2500 "$lcc +a=6378137 +b=6356752.314" "$lambert set shapeOfTheEarth=5; set jScansPositively=1;"
# ecCodes 2.28 has the first point of these planes in the south-west, whatever the scanning mode; it is that of the first value.
for signs in '1 -1' '-1 1' '-1 -1'; do
	# shellcheck disable=SC2086  # two words
	set -- $signs
	grib_filter -o p.grib - "$samples/GRIB2.tmpl" <<-END
		$lambert set shapeOfTheEarth=6; set iScansNegatively=$(($1 < 0)); set jScansPositively=$(($2 > 0));
		set packingType="grid_ieee"; set values={1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20}; write;
	END
	grib2vtk p.grib "$(grib_get -p shortName p.grib)" >a.vtk
	echo 350 42 | on_plane | awk -v sx="$1" -v sy="$2" '{
		for (n = 0; n < 20; n++) printf "%.6f %.6f %d\n", $1 + sx * 2500 * (n % 5), $2 + sy * 2500 * int(n / 5), n + 1 }' >want
	ok "Lambert, scanned by $signs: each node" lies 2500 want
done
stereo='set gridType="polar_stereographic"; set Nx=5; set Ny=4; set latitudeOfFirstGridPointInDegrees=40; set longitudeOfFirstGridPointInDegrees=230;
	set LaDInDegrees=60; set orientationOfTheGridInDegrees=255; set DxInMetres=10000; set DyInMetres=10000; set jScansPositively=1; set shapeOfTheEarth=6;'
projected 'polar stereographic' 10000 '+proj=stere +lat_0=90 +lat_ts=60 +lon_0=255 +R=6371229' "$stereo"
projected 'polar stereographic, southern' 10000 '+proj=stere +lat_0=-90 +lat_ts=-60 +lon_0=255 +R=6371229' "$stereo
	set latitudeOfFirstGridPointInDegrees=-40; set LaDInDegrees=-60; set southPoleOnProjectionPlane=1;"
projected 'Mercator' 30000 '+proj=merc +lat_ts=20 +lon_0=111 +R=6371229' 'set gridType="mercator"; set Ni=5; set Nj=4; set latitudeOfFirstGridPointInDegrees=-5;
	set longitudeOfFirstGridPointInDegrees=110; set LaDInDegrees=20; set DiInMetres=30000; set DjInMetres=30000; set jScansPositively=1; set shapeOfTheEarth=6;'
rotated='set Ni=5; set Nj=4; set latitudeOfFirstGridPointInDegrees=-2; set latitudeOfLastGridPointInDegrees=1; set longitudeOfFirstGridPointInDegrees=356;
	set longitudeOfLastGridPointInDegrees=4; set iDirectionIncrementInDegrees=2; set jDirectionIncrementInDegrees=1; set jScansPositively=1;
	set latitudeOfSouthernPoleInDegrees=-40; set longitudeOfSouthernPoleInDegrees=10;'
grib_filter -o p.grib - "$samples/rotated_ll_sfc_grib2.tmpl" <<END
$rotated set angleOfRotationInDegrees=0; set packingType="grid_ieee"; set values={1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20}; write;
END
grib_get_data -L '%.9f %.9f' p.grib | awk '$3 + 0 == $3 { print $2, $1, $3 }' >places
grib2vtk -r -180 p.grib "$(grib_get -p shortName p.grib)" >a.vtk
is 'a rotated pole: the plane' "$(plane)" '+proj=ob_tran +o_proj=longlat +o_lat_p=40 +o_lon_p=0 +lon_0=10'
ok 'a rotated pole: each node' lies 1
grib_set -s angleOfRotation=20 p.grib t.grib
grib2vtk t.grib "$(grib_get -p shortName t.grib)" >a.vtk
is 'a rotated pole that is turned about itself: no plane is known' "$(plane)" ''
projected 'edition 1, Lambert' 32463 '+proj=lcc +lat_1=50 +lat_2=50 +lat_0=50 +lon_0=253 +R=6367470' 'set dataRepresentationType=3; set Nx=5; set Ny=4;
	set latitudeOfFirstGridPointInDegrees=1; set longitudeOfFirstGridPointInDegrees=214.5; set LoVInDegrees=253; set DxInMetres=32463; set DyInMetres=32463;
	set Latin1InDegrees=50; set Latin2InDegrees=50; set jScansPositively=1;' GRIB1
# ---- what a satellite sees: ecCodes 2.28 has all places as if the first were in the north-west --------------------------
space='set gridDefinitionTemplateNumber=90; set Nx=5; set Ny=4; set shapeOfTheEarth=7; set scaleFactorOfEarthMajorAxis=0; set scaledValueOfEarthMajorAxis=6378169;
	set scaleFactorOfEarthMinorAxis=0; set scaledValueOfEarthMinorAxis=6356584; set latitudeOfSubSatellitePoint=0; set longitudeOfSubSatellitePointInDegrees=9.5;
	set dx=362; set dy=361; set Xp=185500; set Yp=185500; set iScansNegatively=0; set jScansPositively=0; set orientationOfTheGridInDegrees=0; set Nr=6610700;
	set Xo=200; set Yo=60;'
disc='+proj=geos +lon_0=9.5 +h=35785992.81 +a=6378169 +b=6356584'
projected 'a satellite' 30000 "$disc" "$space"
# seen RULES: prints the place of each value, in angles of 10 microradians
seen() {
	grib_filter -o s.grib - p.grib <<-END
		$1 write;
	END
	got s.grib "$name" >/dev/null
	{ coordinates X a.vtk; coordinates Y a.vtk; values a.vtk; } | awk '{ v[NR] = $1 } END { for (i = 0; i < 20; i++)
		printf "%d %.0f %.0f\n", v[10 + i], v[i % 5 + 1] / 357.8599, v[int(i / 5) + 6] / 357.8599 }' | sort -n | sed -n '1p; 2p; 6p'
}
is 'a satellite: rows from the north-west' "$(seen '')" "$(printf '%s\n' '1 1217 10522' '2 1300 10522' '6 1217 10439')"
is 'a satellite: rows from the south-east' "$(seen 'set iScansNegatively=1; set jScansPositively=1; set Xo=50;')" \
	"$(printf '%s\n' '1 11368 -10522' '2 11284 -10522' '6 11368 -10439')"
is 'a satellite: the same of an image upside down' "$(seen 'set orientationOfTheGridInDegrees=180; set iScansNegatively=1; set jScansPositively=1;')" "$(seen '')"
seen 'set orientationOfTheGridInDegrees=20;' >/dev/null
is 'a satellite that is turned: no plane is known' "$(plane)" ''
for far in latitudeOfSubSatellitePoint=1000000 Nr=missing; do
	grib_set -s $far p.grib far.grib
	refused far.grib "$name" 'what a satellite sees from far away or not from over the equator, expected'
done
finish
