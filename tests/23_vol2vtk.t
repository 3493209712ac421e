#!/bin/sh
# vol2vtk: the numbers of small files of each format, made here by hand: types, byte orders, packings, places in space,
# arrays; and refusals.
. "$(dirname "$0")/lib.sh"
needs vol2vtk perl
converter=vol2vtk
# shellcheck source=grids.sh
. "$root/tests/grids.sh"

# 3 x 2 x 2 numbers, x fastest
numbers='3 2 5 7 11 13 17 19 23 29 31 37'
# bytes TYPE ORDER [NUMBER ...]: as they are in a file; TYPE is i1 u1 i2 ... f8, ORDER is < or >
bytes() {
	perl -e 'my ($t, $o) = splice @ARGV, 0, 2; my %c = qw(i1 c u1 C i2 s u2 S i4 l u4 L i8 q u8 Q f4 f f8 d);
		print pack $c{$t} . ($t =~ /1/ ? "" : $o) . "*", @ARGV' "$@"
}
# of_types FORMAT COMMAND: files of each type and byte order have the same numbers, the first one negative if the type has
# such. The input has types and the format's names of them. The command prints a header for < or > and a name.
of_types() {
	while read -r type name; do
		sign=- && case $type in u*) sign='' ;; esac
		for order in '<' '>'; do
			# shellcheck disable=SC2086  # a number each
			{ "$2" "$order" "$name" && bytes "$type" "$order" $sign$numbers; } >typed
			vol2vtk typed | tail -c 49 | head -c 48
			echo "$sign$numbers" >&3
		done
	done 3>want | od -An -v -t f4 -w48 --endian=big | tr -s ' ' | sed 's/^ //' >got
	is "$1: types and byte orders" "$(wc -l <got):$(diff want got)" 20:
}
zlib() { perl -MCompress::Zlib -e 'local $/; print compress(<STDIN>)'; }
# axes: x, y and z of the last grid
axes() { echo "$(on_line coordinates X a.vtk):$(on_line coordinates Y a.vtk):$(on_line coordinates Z a.vtk)"; }
title() { sed -n 2p a.vtk; }
# says FILE MESSAGE: refused with status 2 and this message
says() {
	run vol2vtk "$1"
	like "refused: $1: $2" "$status:$out:$err" "^2::vol2vtk: $1(:[0-9]+)?: .*($2)"
}

# ---- NRRD ----------------------------------------------------------------------------------------------------
# nrrd TYPE ENDIAN ENCODING [LINE ...]: a header; other lines come last
nrrd() {
	echo NRRD0004; echo '# by hand'; echo "type: $1"; echo 'dimension: 3'; echo 'sizes: 3 2 2'; echo "endian: $2"; echo "encoding: $3"
	shift 3
	[ $# -eq 0 ] || printf '%s\n' "$@"
}
space='space directions: (2,0,0) (0,1,0) (0,0,0.5)'
of_nrrd() { nrrd "$2" "$(if [ "$1" = '<' ]; then echo little; else echo big; fi)" raw ''; }
of_types NRRD of_nrrd <<-END_
	i1 signed char
	u1 uint8_t
	i2 signed short int
	u2 unsigned short
	i4 int
	u4 uint32
	i8 long long int
	u8 ulonglong
	f4 float
	f8 double
END_
# shellcheck disable=SC2086  # a number each
bytes i2 '<' $numbers >short.raw
# shellcheck disable=SC2086
text=$(echo $numbers | sed 's/ /, /g')
{ nrrd short little ascii 'spacings: 2 1 0.5' 'centers: node node node' 'axis mins: 10 20 30' ''; echo "$text"; } >a.nrrd
is 'NRRD: text, nodes' "$(got a.nrrd):$(axes)" "$numbers:10 12 14:20 21:30 30.5"
{ nrrd short little ascii 'axismins: 0 0 0' 'axis maxs: 3 2 4' ''; echo "$text"; } >a.nrrd
is 'NRRD: cells' "$(got a.nrrd):$(axes)" "$numbers:0.5 1.5 2.5:0.5 1.5:1 3"
{ nrrd short little gzip 'byteskip: 2' ''; { printf 'ab'; cat short.raw; } | gzip; } >a.nrrd
is 'NRRD: gzip, and bytes passed over in it' "$(got a.nrrd):$(axes)" "$numbers:0 1 2:0 1:0 1"
nrrd short little raw 'data file: sub/s.raw' 'line skip: 1' 'byte skip: -1' 'content: pressure' 'sample units: Pa' \
	'space: left-posterior-superior' 'space units: "mm" "mm" "mm"' "$space" >a.nhdr
mkdir sub && { echo a line; echo more; cat short.raw; } >sub/s.raw
is 'NRRD: detached' "$(got a.nhdr):$(title)" "$numbers:pressure [Pa]; x left [mm]; y posterior [mm]; z superior [mm]"
{ nrrd short little raw 'content: CT; y far [mm]' ''; cat short.raw; } >a.nrrd
got -u HU a.nrrd >/dev/null
is 'NRRD: a name that looks like parts of a title' "$(title)" 'CT, y far [mm] [HU]; x x []; y y []; z z []'
# The axes of the file are z, -x and y.
{ nrrd short little raw 'space directions: (0,0,2) (-1,0,0) (0,0.5,0)' 'space origin: (10,20,30)' ''; cat short.raw; } >a.nrrd
is 'NRRD: axes permuted and reversed' "$(got a.nrrd):$(axes)" '7 3 29 17 11 2 31 19 13 5 37 23:9 10:20 20.5:30 32 34'
{ printf '%s\n' NRRD0005 'type: short' 'dimension: 4' 'sizes: 2 2 2 2' 'kinds: vector domain domain domain' 'endian: little' \
	'encoding: raw' ''; bytes i2 '<' 3 4 5 12 8 15 7 24 20 21 9 40 12 35 0 1; } >v.nrrd
is 'NRRD: a component' "$(got -k 1 v.nrrd)" '4 12 15 24 21 40 35 1'
is 'NRRD: the length of a vector' "$(got -k length v.nrrd)" '5 13 17 25 29 41 37 1'
sed 's/kinds: .*/kinds: domain domain domain time/' v.nrrd >t.nrrd
is 'NRRD: a time' "$(got -k 1 t.nrrd)" '20 21 9 40 12 35 0 1'
{ printf '%s\n' NRRD0004 'type: short' 'dimension: 5' 'sizes: 3 2 1 2 1' 'spacings: 2 1 9 0.5 1' 'endian: little' 'encoding: raw' ''
	cat short.raw; } >one.nrrd
is 'NRRD: channels and times of one' "$(got one.nrrd):$(axes)" "$numbers:0 2 4:0 1:0 0.5"
says v.nrrd '2 components, expected -k'
{ nrrd short little hex ''; perl -ne 'print join "\n", unpack "(H16)*"' short.raw; } >a.nrrd
is 'NRRD: hex' "$(got a.nrrd)" "$numbers"
{ nrrd short little raw 'dimension: 2' 'sizes: 3 4' ''; cat short.raw; } >flat.nrrd
is 'NRRD: a picture' "$(got flat.nrrd):$(axes)" "$numbers:0 1 2:0 1 2 3:0"
{ nrrd short little raw 'dimension: 2' 'sizes: 3 4' 'space: left-posterior-superior' 'space directions: (2,0,0) (0,-1,0)' 'space origin: (1,2,3)' ''
	cat short.raw; } >flat.nrrd
is 'NRRD: a picture in space' "$(got flat.nrrd):$(axes)" "29 31 37 17 19 23 7 11 13 3 2 5:1 3 5:-1 0 1 2:3"
{ nrrd short little raw 'dimension: 4' 'sizes: 3 1 2 2' 'space: RAST' 'space directions: (1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,5)' \
	'space origin: (7,8,9,0)' ''; cat short.raw; } | sed 's/sizes: 3 1 2 2/sizes: 3 2 1 2/' >4d.nrrd
is 'NRRD: a space with the time' "$(got -k 1 4d.nrrd):$(axes)" "17 19 23 29 31 37:7 8 9:8 9:9"
{ nrrd short little bzip2 ''; cat short.raw; } >bz.nrrd
says bz.nrrd 'encoding: bzip2, expected .*unu save'
{ nrrd short little ascii ''; echo "$numbers"; echo 41; } >bad.nrrd
run vol2vtk bad.nrrd
is 'NRRD: text with a number more' "$status:$out:$err" '2::vol2vtk: bad.nrrd:10: more numbers, expected 12'

{ nrrd short little raw 'space directions: (1,0.02,0) (0,1,0) (0,0,1)' ''; cat short.raw; } >oblique.nrrd
says oblique.nrrd 'axis 1 is turned by 1.15 degrees from x, expected .*-a takes'
is '-a: the axes of the file' "$(got -a oblique.nrrd >/dev/null; axes | cut -c 1-8)" '0 1.0001'
{ nrrd short little raw 'space directions: (1,0.001,0) (0,1,0) (0,0,1)' ''; cat short.raw; } >rounded.nrrd
is 'a direction that was rounded' "$(got rounded.nrrd)" "$numbers"
for case in 'sizes: 3 2 99999999|sizes: 1e\+08' 'sizes: 3 2 16777216|bytes of values, expected' 'sizes: 3 2|sizes' 'type: block|type' \
	'dimension: 17|dimension' 'encoding: zip|encoding' 'endian: middle|endian' 'byte skip: 99|bytes of values' 'line skip: 5|line skip' \
	'data file: ../s.raw|below it' 'data file: /etc/passwd|below it' 'data file: none.raw|no file that can be read' \
	'data file: LIST|several files' 'data file: s%03d.raw 1 2 1|several files' 'space directions: (1,0,0) (0,1,0)|space directions: axis 3' \
	'space directions: (1,0,0) (2,0,0) (0,0,1)|axis 2 is turned' 'space directions: (1,0,0) (0,0,0) (0,0,1)|a step of 0'; do
	{ nrrd short little raw "${case%|*}" ''; cat short.raw; } >bad.nrrd
	says bad.nrrd "${case#*|}"
done

# ---- MetaImage -----------------------------------------------------------------------------------------------
# meta TYPE MSB PACKED FILE [LINE ...]
meta() {
	printf '%s\n' 'ObjectType = Image' 'NDims = 3' 'BinaryData = True' "BinaryDataByteOrderMSB = $2" "CompressedData = $3" 'Offset = 10 20 30' \
		'ElementSpacing = 2 1 0.5' 'DimSize = 3 2 2' "ElementType = $1"
	file=$4
	shift 4
	[ $# -eq 0 ] || printf '%s\n' "$@"
	echo "ElementDataFile = $file"
}
of_meta() { meta "$2" "$(if [ "$1" = '<' ]; then echo False; else echo True; fi)" False LOCAL; }
of_types MetaImage of_meta <<-END_
	i1 MET_CHAR
	u1 MET_UCHAR
	i2 MET_SHORT
	u2 MET_USHORT
	i4 MET_LONG
	u4 MET_UINT
	i8 MET_LONG_LONG
	u8 MET_ULONG_LONG
	f4 MET_FLOAT
	f8 MET_DOUBLE
END_
zlib <short.raw >short.zraw
meta MET_SHORT False True short.zraw 'Modality = MET_MOD_CT' 'TransformMatrix = 1 0 0 0 -1 0 0 0 1' >a.mhd
is 'MetaImage: packed, detached, y reversed, CT' "$(got a.mhd):$(axes):$(title)" \
	'7 11 13 3 2 5 29 31 37 17 19 23:10 12 14:19 20:30 30.5:values [HU]; x x []; y y []; z z []'
meta MET_SHORT_ARRAY False False short.raw 'DimSize = 2 2 1' 'ElementNumberOfChannels = 3' >a.mhd
is 'MetaImage: an array of channels' "$(got -k 1 a.mhd)" '2 11 19 31'
cp short.raw 'short of.raw'
meta MET_SHORT False False 'short of.raw' >a.mhd
is 'MetaImage: a name with a blank' "$(got a.mhd)" "$numbers"
{ echo head; cat short.raw; } >short.head
meta MET_SHORT False False short.head 'HeaderSize = -1' >a.mhd
is 'MetaImage: the end of a file' "$(got a.mhd)" "$numbers"
{ meta MET_SHORT False False LOCAL | sed 's/BinaryData = True/BinaryData = False/'; echo "$numbers"; } >a.mha
is 'MetaImage: text' "$(got a.mha)" "$numbers"
{ meta MET_SHORT False False LOCAL 'NDims = 4' 'DimSize = 3 2 2 2' 'Offset = 10 20 30 0' 'ElementSpacing = 2 1 0.5 9' \
	'TransformMatrix = 1 0 0 0 0 -1 0 0 0 0 1 0 0 0 0 1'
	cat short.raw; bytes i2 '<' 1 2 3 4 5 6 7 8 9 10 11 12; } >t.mha
is 'MetaImage: the second time' "$(got -k 1 t.mha):$(axes)" '4 5 6 1 2 3 10 11 12 7 8 9:10 12 14:19 20:30 30.5'
says t.mha '2 components, expected -k'
meta MET_SHORT False False short.raw | grep -v ^BinaryData >a.mhd
is 'MetaImage: bytes without BinaryData' "$(got a.mhd)" "$numbers"
{ meta MET_UCHAR False False LOCAL | grep -v ^BinaryData; echo "$numbers"; } >a.mha
is 'MetaImage: text without BinaryData' "$(got a.mha)" "$numbers"
{ meta MET_SHORT False False LOCAL 'NDims = 2' 'DimSize = 3 4' 'Offset = 5 6' 'ElementSpacing = 2 1' 'TransformMatrix = 1 0 0 1'; cat short.raw; } >flat.mha
is 'MetaImage: a picture' "$(got flat.mha):$(axes)" "$numbers:5 7 9:6 7 8 9:0"
for case in 'NDims = 5|NDims: 5' 'NDims = 4|DimSize' 'DimSize = 3 2 0|0 nodes on axis 3' 'DimSize = 3 2 3|24 bytes of values, expected 36' 'ElementType = MET_STRING|ElementType' \
	'CompressedData = True|could be unpacked' 'HeaderSize = 99|HeaderSize' 'ElementNumberOfChannels = 0|ElementNumberOfChannels' \
	'ElementSpacing = 1 0 1|a step of 0' 'Offset = 1 2|Offset'; do
	{ meta MET_SHORT False False LOCAL "${case%|*}"; cat short.raw; } >bad.mha
	says bad.mha "${case#*|}"
done
meta MET_SHORT False False 'LIST' >bad.mha
says bad.mha 'several files, expected one; cat joins raw ones'

# ---- NIfTI-1 -------------------------------------------------------------------------------------------------
# nifti ORDER CODE BITS [PLACE CODE VALUE ...]: a header; values at other places replace its own
nifti() {
	perl -e '($o, $type, $bits, @more) = @ARGV; $h = "\0" x 352; sub put { my ($at, $c, @v) = @_; my $b = pack "($c)$o" . @v, @v; substr($h, $at, length $b) = $b }
		put(0, "l", 348); put(40, "s", 3, 3, 2, 2, 1, 1, 1, 1); put(70, "s", $type, $bits); put(76, "f", 1, 2, 1, .5);
		put(108, "f", 352); substr($h, 123, 1) = "\2"; substr($h, 344, 4) = "n+1\0";
		while (@more) { my ($at, $c, $v) = splice @more, 0, 3; $c eq "A" ? substr($h, $at, length $v) = $v : put($at, $c, split /,/, $v) } print $h' "$@"
}
of_nifti() { nifti "$1" "$2" 0; }
of_types NIfTI of_nifti <<-END_
	u1 2
	i2 4
	i4 8
	f4 16
	f8 64
	i1 256
	u2 512
	u4 768
	i8 1024
	u8 1280
END_
{ nifti '<' 4 16 112 f 0.5,-10; cat short.raw; } | gzip >a.nii.gz
is 'NIfTI: packed, with slope and intercept' "$(got a.nii.gz)" '-8.5 -9 -7.5 -6.5 -4.5 -3.5 -1.5 -0.5 1.5 4.5 5.5 8.5'
# Turned by half a circle around z, and mirrored in z by qfac.
# shellcheck disable=SC2086  # a number each
{ nifti '>' 4 16 252 s 1 256 f 0,0,1,10,20,30 76 f -1; bytes i2 '>' $numbers; } >a.nii
is 'NIfTI: a rotation' "$(got a.nii):$(axes):$(title)" \
	'37 31 29 23 19 17 13 11 7 5 2 3:6 8 10:19 20:29.5 30:values []; x right [mm]; y anterior [mm]; z superior [mm]'
{ nifti '<' 4 16 254 s 1 280 f 0,0,4,1,-2,0,0,2,0,3,0,3; cat short.raw; } >a.nii
is 'NIfTI: a matrix' "$(got a.nii):$(axes)" '5 23 2 19 3 17 13 37 11 31 7 29:1 5:-2 0 2:3 6'
{ nifti '<' 4 16 344 A ni1 108 f 0; } >p.hdr
cp short.raw p.img
is 'NIfTI: a pair' "$(got p.hdr)" "$numbers"
gzip p.img
is 'NIfTI: a pair, half of it packed' "$(got p.hdr)" "$numbers"
{ nifti '<' 4 16 40 s 4,3,2,2,2; cat short.raw; bytes i2 '<' 1 2 3 4 5 6 7 8 9 10 11 12; } >t.nii
is 'NIfTI: the second time' "$(got -k 1 t.nii)" '1 2 3 4 5 6 7 8 9 10 11 12'
says t.nii '2 components, expected -k'
{ nifti '<' 128 24 40 s 3,2,2,2; bytes u1 '<' 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24; } >rgb.nii
is 'NIfTI: green' "$(got -k 1 rgb.nii)" '2 5 8 11 14 17 20 23'
{ nifti '<' 4 16 40 s 2,3,4 76 f 1,2,1,0 252 s 1; cat short.raw; } >flat.nii
is 'NIfTI: a picture' "$(got flat.nii):$(axes)" "$numbers:0 2 4:0 1 2 3:0"
for case in '40 s 1|1 dimensions' '40 s 3,3,-2|-2 nodes' '40 s 3,32767,32767,32767|more than 2.40 numbers' '40 s 3,9999,9999,9999|bytes of values, expected' '70 s 1536|datatype 1536' \
	'108 f 1e30|vox_offset' '108 f 353|bytes of values' '344 A abcd|magic word' '254 s 1|a step of 0' '344 A ni1|expected NAME.hdr beside' \
	'112 f 1,nan|scl_inter'; do
	# shellcheck disable=SC2086  # words
	{ nifti '<' 4 16 ${case%|*}; cat short.raw; } >bad.nii
	says bad.nii "${case#*|}"
done
head -c 200 t.nii >short.nii
says short.nii '200 bytes, expected a header'
gzip -c short.raw >short.gz
says short.gz 'packed by gzip, expected NIfTI-1'
head -c 60 a.nii.gz >cut.nii.gz
says cut.nii.gz 'packed by gzip, expected NIfTI-1|could be unpacked'

# ---- VTK's XML files -----------------------------------------------------------------------------------------
# head BYTES NUMBER ...: little-endian integers of 4 or 8 bytes
head_of() { size=$1; shift; bytes "u$size" '<' "$@"; }
block() { # RAW|PACKED: 24 bytes of short.raw with their head
	if [ "$1" = raw ]; then head_of 4 24; cat short.raw
	else
		head -c 16 short.raw | zlib >b1; tail -c 8 short.raw | zlib >b2
		head_of 4 2 16 8 "$(wc -c <b1)" "$(wc -c <b2)" >heads
		cat heads b1 b2
	fi
}
# vti COMPRESSOR FORMAT EXTRA CONTENT [ATTRIBUTES]: up to the end of the arrays
vti() {
	cat <<-END_
		<?xml version="1.0"?>
		<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt32"$1>
		<ImageData WholeExtent="1 3 0 1 0 1" Origin="8 20 30" Spacing="2 1 0.5"${5-}>
		<Piece Extent="1 3 0 1 0 1"><PointData>
		<DataArray type="Int16" Name="a b" NumberOfComponents="1" format="$2"$3>$4
		</DataArray></PointData><CellData></CellData></Piece></ImageData>
	END_
}
by=' compressor="vtkZLibDataCompressor"' placed=':10 12 14:20 21:30 30.5'
{ vti '' ascii '' "$numbers"; echo '</VTKFile>'; } >a.vti
is 'VTK XML: text' "$(got a.vti):$(axes)" "$numbers$placed"
{ vti '' binary '' "$(block raw | base64 -w 0)"; echo '</VTKFile>'; } >a.vti
is 'VTK XML: base64' "$(got a.vti):$(axes)" "$numbers$placed"
{ vti "$by" binary '' "$(block packed >/dev/null; base64 -w 0 heads; cat b1 b2 | base64 -w 0)"; echo '</VTKFile>'; } >a.vti
is 'VTK XML: packed' "$(got a.vti):$(axes)" "$numbers$placed"
{ vti '' appended ' offset="3"' ''; printf '<AppendedData encoding="raw">\n _abc'; block raw; printf '</AppendedData></VTKFile>'; } >a.vti
is 'VTK XML: appended bytes' "$(got a.vti):$(axes)" "$numbers$placed"
{ vti "$by" appended ' offset="0"' ''; printf '<AppendedData encoding="raw">\n _'; block packed; } >a.vti
is 'VTK XML: appended bytes, packed' "$(got a.vti):$(axes)" "$numbers$placed"
{ vti '' appended ' offset="4"' ''; printf '<AppendedData encoding="base64">\n _AAAA'; block raw | base64 -w 0; printf '</AppendedData></VTKFile>'; } >a.vti
is 'VTK XML: appended base64' "$(got a.vti):$(axes)" "$numbers$placed"
{ vti '' ascii '' "$numbers" ' Direction="0 0 1 1 0 0 0 1 0"'; echo '</VTKFile>'; } >a.vti
is 'VTK XML: directions' "$(got a.vti):$(axes)" '3 17 2 19 5 23 7 29 11 31 13 37:8 8.5:22 24 26:30 31'
{ vti '' ascii '' "$numbers 41"; echo '</VTKFile>'; } >bad.vti
run vol2vtk bad.vti
is 'VTK XML: text with a number more' "$status:$out:$err" '2::vol2vtk: bad.vti:5: more numbers, expected 12'
{ vti '' binary '' "$({ head_of 4 26; cat short.raw; echo; echo; } | base64 -w 0)"; echo '</VTKFile>'; } >bad.vti
says bad.vti 'an array of 26 bytes, expected 24'
ghosts() { # NUMBERS: of nodes
	vti '' ascii '' "$numbers" |
		sed "s|</PointData>|<DataArray type='UInt8' Name='vtkGhostType' format='ascii'>$1</DataArray></PointData>|"
	echo '</VTKFile>'
}
ghosts '0 1 2 0 0 0 3 0 0 0 0 4' >ghost.vti
is 'vtkGhostType: hidden nodes are missing, others are not' "$(got ghost.vti):$(vol2vtk -l ghost.vti | wc -l)" '3 2 nan 7 11 13 nan 19 23 29 31 37:1'
ghosts '0 0 0' >bad.vti
says bad.vti '3 numbers, expected 12'
# Pieces of nodes 0 to 1 and 1 to 3 on x, and their cells; the middle nodes are in both
pieces() { # ATTRIBUTE ...: of each piece
	echo "<VTKFile type='${3-}ImageData'><${3-}ImageData WholeExtent='0 3 0 1 0 1' Origin='5 0 0'>"
	echo "<Piece Extent='0 1 0 1 0 1' $1>"
	[ -n "${3-}" ] || echo "<PointData><DataArray type='Int16' Name='p' format='ascii'>0 1 4 5 8 9 12 13</DataArray></PointData>
		<CellData><DataArray type='Int16' Name='c' NumberOfComponents='2' format='ascii'>7 8</DataArray></CellData>"
	echo "</Piece><Piece Extent='1 3 0 1 0 1' $2>"
	[ -n "${3-}" ] || echo "<PointData><DataArray type='Float32' Name='q' format='ascii'>0 0 0 0 0 0 0 0 0 0 0 0</DataArray>
		<DataArray type='Int16' Name='p' format='ascii'>1 2 3 5 6 7 9 10 11 13 14 15</DataArray></PointData>
		<CellData><DataArray type='Int16' Name='c' NumberOfComponents='2' format='ascii'>9 10 11 12</DataArray></CellData>"
	echo "</Piece></${3-}ImageData></VTKFile>"
}
pieces '' '' >pieces.vti
is 'VTK XML: pieces' "$(got pieces.vti p):$(axes)" '0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15:5 6 7 8:0 1:0 1'
is 'cells of pieces' "$(vol2vtk -k 1 pieces.vti c 2>&1):$(vol2vtk -l pieces.vti | cut -f 1,3 | tr '\n\t' '; ')" \
	"vol2vtk: pieces.vti: 1 cells along y, expected 2 at least:p 4x2x2;c 3x1x1;q 4x2x2;"
run vol2vtk pieces.vti q
is 'an array of one piece' "$status:$err" "2:vol2vtk: pieces.vti: 'q' has no values of a part of the grid, expected Pieces that cover it"
sed '/0 1 4 5/,/<\/CellData/d; s/0 1 0 1 0 1/0 -1 0 -1 0 -1/; s/0 3 0 1/1 3 0 1/' pieces.vti >one.vti
is 'VTK XML: an empty piece' "$(got one.vti p):$(axes)" '1 2 3 5 6 7 9 10 11 13 14 15:6 7 8:0 1:0 1'
sed "s/'1 3 0/'1 4 0/" pieces.vti >bad.vti
says bad.vti 'a Piece from 1 to 4 on axis 1, expected it in 0 to 3'
sed "s/'Int16' Name='p' format='ascii'>1/'Int8' Name='p' format='ascii'>1/" pieces.vti >bad.vti
says bad.vti "'p' has other numbers in another Piece"
mkdir parts
{ head -n 4 pieces.vti; echo '</Piece></ImageData></VTKFile>'; } >parts/0.vti
sed '2,4d; s|^</Piece><Piece|<Piece|' pieces.vti >parts/1.vti
pieces "Source='parts/0.vti'" "Source='parts/1.vti'" P >list.pvti
is 'VTK XML: files of pieces' "$(got list.pvti p):$(axes)" '0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15:5 6 7 8:0 1:0 1'
sed 's/9 12 13/9 12/' parts/0.vti >parts/2.vti
sed 's/0.vti/2.vti/' list.pvti >bad.pvti
run vol2vtk bad.pvti p
like 'a message names the file of a piece' "$status:$err" '^2:vol2vtk: parts/2.vti:[0-9]: 7 numbers, expected 8$'
sed 's/0.vti/9.vti/' list.pvti >bad.pvti
says bad.pvti "the values are in 'parts/9.vti', which is no file"
cat >a.vtr <<'END_'
<VTKFile type="RectilinearGrid" version="0.1" byte_order="BigEndian"><RectilinearGrid WholeExtent="0 2 0 2 0 2"><Piece Extent="0 2 0 2 0 2">
<PointData><DataArray type="Float32" Name="p" format="ascii">1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 nan</DataArray></PointData>
<CellData><DataArray type="UInt8" Name="c" format="ascii">1 2 3 4 5 6 7 8</DataArray>
<DataArray type="UInt8" Name="v" NumberOfComponents="2" format="ascii">1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16</DataArray></CellData>
<Coordinates><DataArray type="Float64" format="ascii">0 1 3</DataArray><DataArray type="Float64" format="ascii">5 4 2</DataArray>
<DataArray type="Float64" format="ascii">0 .5 1</DataArray></Coordinates></Piece></RectilinearGrid></VTKFile>
END_
is 'VTK XML: rectilinear, y reversed' "$(got a.vtr p):$(axes)" '7 8 9 4 5 6 1 2 3 16 17 18 13 14 15 10 11 12 25 26 nan 22 23 24 19 20 21:0 1 3:2 4 5:0 0.5 1'
is 'VTK XML: cells' "$(got a.vtr c):$(axes)" '3 4 1 2 7 8 5 6:0.5 2:3 4.5:0.25 0.75'
is '-l' "$(vol2vtk -l a.vtr)" "$(printf 'p\tnodes\t3x3x3\tfloat32\t1\nc\tcells\t2x2x2\tuint8\t1\nv\tcells\t2x2x2\tuint8\t2')"
says a.vtr '3 arrays, expected the name of one: p, c, v$'
flat() { # EXTENT
	echo "<VTKFile type='ImageData'><ImageData WholeExtent='$1' Spacing='2 1 1'><Piece Extent='$1'>
		<PointData><DataArray type='Int16' Name='p' format='ascii'>1 2 3 4 5 6 7 8 9</DataArray></PointData>
		<CellData><DataArray type='Int16' Name='c' format='ascii'>1 2 3 4</DataArray></CellData></Piece></ImageData></VTKFile>"
}
flat '0 2 0 2 4 4' >flat.vti
is 'VTK XML: a flat image' "$(got flat.vti p):$(axes)" '1 2 3 4 5 6 7 8 9:0 2 4:0 1 2:4'
is 'its cells' "$(got flat.vti c):$(axes)" '1 2 3 4:1 3:0.5 1.5:4'
flat '4 4 0 2 0 2' >upright.vti
run vol2vtk upright.vti p
like 'flat along x' "$status:$err" '^2:vol2vtk: upright.vti: 1 nodes along x, expected 2 at least; only z may have 1$'
run vol2vtk a.vtr q
like 'no such array' "$status:$err" '^2:vol2vtk: a.vtr: q: no such array, expected one of: p, c, v$'
run vol2vtk -k 2 a.vtr v
like 'no such component' "$status:$err" "^2:vol2vtk: a.vtr: component 2 of 'v', expected one below 2$"
is 'standard input, and -o' "$(vol2vtk -o b.vtk a.vtr c; vol2vtk - c <a.vtr | cmp - b.vtk)" ''
while IFS='|' read -r from to message; do
	sed "s|$from|$to|" a.vtr >bad.vtr
	says bad.vtr "$message"
done <<'END_'
RectilinearGrid"|UnstructuredGrid"|UnstructuredGrid., expected ImageData [(].vti[)] or RectilinearGrid [(].vtr[)]
WholeExtent="0 2 0|WholeExtent="0 3 0|axis 1 has no coordinate of node 4, expected numbers, and Pieces that cover the grid
<Piece|<Part|mismatched tag
NumberOfComponents="2"|NumberOfComponents="-2"|NumberOfComponents
<VTKFile|<!DOCTYPE a [<!ENTITY b "c">]><VTKFile|DOCTYPE., expected no declarations
version="0.1"|compressor="vtkLZ4DataCompressor"|vtkLZ4DataCompressor
format="ascii">0 1 3|format="appended" offset="9">0 1 3|begin after the end
>0 1 3|>0 1|2 numbers, expected 3
>0 1 3|>0 1 z|value 3 is 'z'
END_
sed 's|>0 1 3|>0 1 1|' a.vtr >bad.vtr
run vol2vtk bad.vtr p
like 'refused: coordinates that do not ascend' "$status:$err" '^2:vol2vtk: bad.vtr: x of node 3 is 1 after 1'
{ vti "$by" binary '' "$(head_of 4 1 4000000000 0 9 | base64 -w 0)AAAA"; echo '</VTKFile>'; } >bad.vti
says bad.vti '1 blocks of 4000000000 bytes, expected 24 bytes'
{ vti "$by" binary '' "$(head_of 4 4000000000 1 1 9 | base64 -w 0)AAAA"; echo '</VTKFile>'; } >bad.vti
says bad.vti '4000000000 blocks'
{ vti "$by" binary '' "$(head_of 4 2 16 8 9 4000000000 | base64 -w 0)AAAA"; echo '</VTKFile>'; } >bad.vti
says bad.vti 'end before their time'
{ vti '' binary '' "$(head_of 4 23 | base64 -w 0)AAAA"; echo '</VTKFile>'; } >bad.vti
says bad.vti 'an array of 23 bytes, expected 24'

# ---- VTK's legacy files --------------------------------------------------------------------------------------
cat >a.legacy <<'END_'
# vtk DataFile Version 3.0
by hand
ASCII
DATASET STRUCTURED_POINTS
DIMENSIONS 3 3 3
SPACING 2 1 .5
ORIGIN 10 20 30
CELL_DATA 8
SCALARS heat%20flux short
LOOKUP_TABLE default
1 2 3 4 5 6 7 8
VECTORS wind float
1 2 2 2 3 6 4 4 7 1 4 8 0 0 1 0 0 2 0 0 3 0 0 4
FIELD more 1
two 2 8 int
1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16
END_
is 'VTK legacy: an image, cells' "$(got a.legacy 'heat flux'):$(axes)" '1 2 3 4 5 6 7 8:11 13:20.5 21.5:30.25 30.75'
sed 's/^DIMENSIONS.*/DIMENSIONS 3 5 1/' a.legacy >flat.legacy
is 'VTK legacy: a flat image, cells' "$(got flat.legacy 'heat flux'):$(axes)" '1 2 3 4 5 6 7 8:11 13:20.5 21.5 22.5 23.5:30'
sed 's/^DIMENSIONS.*/EXTENT 5 7 -1 1 0 2/' a.legacy >extent.legacy
is 'VTK legacy: an extent' "$(got extent.legacy 'heat flux'):$(axes)" '1 2 3 4 5 6 7 8:21 23:19.5 20.5:30.25 30.75'
is 'VTK legacy: the length of vectors' "$(got -k length a.legacy wind)" '3 7 9 9 1 2 3 4'
is 'VTK legacy: a field' "$(got -k 1 a.legacy two)" '2 4 6 8 10 12 14 16'
{ sed -n '1,2p' a.legacy; printf 'BINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 12\nSCALARS s short 1\nLOOKUP_TABLE default\n'
	# shellcheck disable=SC2086  # a number each
	bytes i2 '>' $numbers; printf '\nMETADATA\nINFORMATION 0\n\nVECTORS v char\n'; printf '%036d' 0; } >b.legacy
is 'VTK legacy: bytes' "$(got b.legacy s):$(vol2vtk -l b.legacy | wc -l)" "$numbers:2"
{ sed -n '1,3p' a.legacy; printf '%s\n' 'DATASET STRUCTURED_POINTS' 'FIELD f 2' 'words 1 2 string' 'two%20words' '' 'TIME 1 1 int' 7; sed '1,4d' a.legacy; } >c.legacy
is 'VTK legacy: strings are passed over' "$(got -k 1 c.legacy two)" '2 4 6 8 10 12 14 16'
{ sed -n '1,2p' a.legacy; printf 'BINARY\nDATASET STRUCTURED_POINTS\nFIELD f 1\nw 1 2 string\n\303abc\200\100'; printf '%064d' 0
	tail -c +$(($(grep -abo DIMENSIONS b.legacy | cut -d: -f 1) + 1)) b.legacy; } >c.legacy
is 'also as bytes' "$(got c.legacy s)" "$numbers"
head -c 110 c.legacy >bad.legacy
says bad.legacy 'ends within strings'
while IFS='|' read -r from to message; do
	sed "s|$from|$to|" a.legacy >bad.legacy
	says bad.legacy "$message"
done <<'END_'
STRUCTURED_POINTS|UNSTRUCTURED_GRID|expected STRUCTURED_POINTS or RECTILINEAR_GRID
CELL_DATA 8|CELL_DATA 9|expected the number of cells
DIMENSIONS 3 3 3|DIMENSIONS 3 3 0|0 nodes on axis 3
DIMENSIONS 3 3 3|DIMENSIONS 3 3 x|expected a number of nodes
two 2 8 int|two 2 800000 int|numbers, expected
SPACING 2|SPACING two|expected a number
END_

# ---- the rest ------------------------------------------------------------------------------------------------
got -u K a.legacy 'heat flux' >/dev/null
is '-u names the unit' "$(title)" 'heat flux [K]; x x []; y y []; z z []'
got a.vtr c >/dev/null
ok 'vcworker reads what it writes' sh -c 'gridspec a.vtk >a.spec && vcworker -i a.vtk a.spec'
echo text >none
says none 'no volume, expected'
says nothing 'No such file'
for bad in '' '-k -1 a' '-k x a' '-q a' 'a b c' '-l a b' '-o a'; do
	# shellcheck disable=SC2086  # a word each
	run vol2vtk $bad
	is "refused: vol2vtk $bad" "$status:$out" 2:
done
vol2vtk a.mha >/dev/full 2>err
is 'a full disk' "$?:$(grep -c '^vol2vtk: standard output: No space left' err)" 3:1
run vol2vtk -o no/such.vtk a.mha
is 'a directory that does not exist' "$status" 3
finish
