#!/bin/sh
# mesh2nff: the NFF lines of small files of each kind, and transforms, cameras, lights, losses and refusals; and that
# rtworker's and POV-Ray's pictures of real meshes are the same.
. "$(dirname "$0")/lib.sh"
needs mesh2nff perl

# faces: the lines of materials and faces that the last run wrote
faces() { printf '%s\n' "$out" | grep -E '^(f|p|pp) '; }
# after WORD: what stands behind the first such word of a line
after() { printf '%s\n' "$out" | sed -n "s/^$1 //p" | head -n 1; }
# packed TEMPLATE NUMBER ...: their bytes
packed() { perl -e 'print pack shift, @ARGV' "$@"; }

run mesh2nff -h
is '-h exits 0' "$status" 0
for bad in '' '-s 0x1 a.obj' '-s 70000x1 a.obj' '-y a.obj' 'a.obj b.obj'; do
	# shellcheck disable=SC2086  # a word each
	run mesh2nff $bad
	is "refused: mesh2nff $bad" "$status:$out" 2:
done

# ---- OBJ: normals, polygons, materials -----------------------------------------------------------------------
cat >a.mtl <<'END'
newmtl paint
Kd 0.8 0.1 0.25
Ks 0.2 0.3 0.4
Ns 20
newmtl glass
Kd 1 1 1
d 0.25
Ni 1.5
newmtl matt
Kd 0.3 0.3 0.3
Ks 0.5 0.5 0.5
END
cat >a.obj <<'END'
mtllib a.mtl
v 0 0 0
v 2 0 0
v 2 2 0
v 1 0.5 0
v 0 2 0
v 0.1 0.333333343 -1.5e-7
vn 0 0 1
vn 0 3 4
usemtl paint
f 1//1 2//1 3//2
f 1//1 2//1 3//1
usemtl glass
f 1 2 3 4 5
usemtl matt
f 1//1 2//1 3//1 5//2
f 1//1 2//1 3//1 4//1 5//2
f 1//1 2//1 4//1 5//2
f -6//2 2//1 6//1
END
run mesh2nff a.obj
is 'OBJ: exit 0 in silence' "$status:$err" 0:
is 'OBJ: patches, polygons and materials' "$(faces)" "$(cat <<'END'
f 0.8 0.1 0.25 1 0.3 20 0 1
pp 3 0 0 0 0 0 1 2 0 0 0 0 1 2 2 0 0 0.6 0.8
p 3 0 0 0 2 0 0 2 2 0
f 1 1 1 0.25 0 0 0.75 1.5
p 5 0 0 0 2 0 0 2 2 0 1 0.5 0 0 2 0
f 0.3 0.3 0.3 1 0 0 0 1
pp 4 0 0 0 0 0 1 2 0 0 0 0 1 2 2 0 0 0 1 0 2 0 0 0.6 0.8
pp 3 2 0 0 0 0 1 2 2 0 0 0 1 1 0.5 0 0 0 1
pp 3 1 0.5 0 0 0 1 0 2 0 0 0.6 0.8 0 0 0 0 0 1
pp 3 0 0 0 0 0 1 2 0 0 0 0 1 1 0.5 0 0 0 1
pp 3 0 0 0 0 0 1 2 0 0 0 0 1 1 0.5 0 0 0 1
pp 3 1 0.5 0 0 0 1 0 2 0 0 0.6 0.8 0 0 0 0 0 1
pp 3 0 0 0 0 0.6 0.8 2 0 0 0 0 1 0.1 0.33333334 -1.5e-7 0 0 1
END
)"
printf '%s\n' "$out" >a.nff
ok 'rtworker reads it' rtworker -i a.nff
ok 'nff2pov reads it' nff2pov a.nff
ok 'standard input, with the material library of this directory' sh -c 'cat a.obj | mesh2nff - >b && cmp a.nff b'
mkfifo pipe
cat a.obj >pipe &
ok 'a named pipe' sh -c 'mesh2nff pipe >b && cmp a.nff b'
wait
mkdir other
cp a.obj other
is 'without the library: the grey of libassimp' "$(mesh2nff other/a.obj | grep '^f ' | sort -u)" 'f 0.6 0.6 0.6 1 0 0 0 1'
grep -v '^usemtl' other/a.obj >other/none.obj
is 'without materials: white' "$(mesh2nff other/none.obj 2>err | grep '^f ' | sort -u)" 'f 1 1 1 1 0 0 0 1'
printf 'newmtl %s\nKd 0.6 0.6 %s\n' DefaultMaterial 0.5 >other/default.mtl
{ echo 'mtllib default.mtl'; sed 's/^usemtl .*/usemtl DefaultMaterial/; /^mtllib/d' a.obj; } >other/default.obj
is "a file's own colour of that name" "$(mesh2nff other/default.obj | grep '^f ' | sort -u)" 'f 0.6 0.6 0.5 1 0 0 0 1'

# ---- PLY and STL, as text and as bytes -----------------------------------------------------------------------
header() {
	printf '%s\n' ply "format $1 1.0" 'element vertex 4' 'property float x' 'property float y' 'property float z' \
		'property float nx' 'property float ny' 'property float nz' 'element face 2' \
		'property list uchar int vertex_indices' end_header
}
corners='0 0 0 0 0 1  1 0 0 0 0.6 0.8  1 1 0 0 0 1  0 1 0.1 0 0 1'
expected='f 1 1 1 1 0 0 0 1
pp 4 0 0 0 0 0 1 1 0 0 0 0.6 0.8 1 1 0 0 0 1 0 1 0.1 0 0 1
pp 3 0 0 0 0 0 1 1 0 0 0 0.6 0.8 1 1 0 0 0 1'
# shellcheck disable=SC2086  # a number each
{
	{ header ascii; printf '%s %s %s %s %s %s\n' $corners; echo '4 0 1 2 3'; echo '3 0 1 2'; } >text.ply
	{ header binary_little_endian; packed 'f<*' $corners; packed 'Cl<*' 4 0 1 2 3; packed 'Cl<*' 3 0 1 2; } >bytes.ply
}
for file in text.ply bytes.ply; do
	run mesh2nff $file
	is "$file" "$status:$err:$(faces)" "0::$expected"
done
cat >text.stl <<'END'
solid two
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1.5 0
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 0 -1e-3
endloop
endfacet
endsolid two
END
{ packed 'A80 L<' bytes 2; packed 'f<12 S<' 0 0 1 0 0 0 1 0 0 0 1.5 0 0; packed 'f<12 S<' 0 0 0 0 0 0 1 0 0 0 0 -1e-3 0; } >bytes.stl
for file in text.stl bytes.stl; do
	run mesh2nff $file
	is "$file: facets are flat" "$status:$err:$(faces | grep '^p')" '0::p 3 0 0 0 1 0 0 0 1.5 0
p 3 0 0 0 1 0 0 0 0 -0.001'
done
{ packed 'x80 L<' 1; packed 'f<12 S<' 0 0 1 0 0 0 1 0 0 0 1.5 0 0; } >zeros.stl
run mesh2nff - <zeros.stl
is 'standard input: STL with a header of zeros' "$status:$err:$(faces | grep '^p')" '0::p 3 0 0 0 1 0 0 0 1.5 0'

# ---- OFF, whose first word says what its corners have --------------------------------------------------------
# off WORD MORE [DIMENSION]: a triangle
# shellcheck disable=SC2086  # none, or a word
off() { printf '%s\n' "$1" ${3-} '3 1 0' "0 0 0$2" "1 0 0$2" "0 1 0$2" '3 0 1 2'; }
off OFF '' >OFF.off
off COFF ' 1 0 0 1' >COFF.off
off STOFF ' 0.5 0.5' >STOFF.off
off NOFF ' 0 0 1' >NOFF.off
off 4nOFF ' 1' 3 >4nOFF.off
for file in *OFF.off; do
	run mesh2nff - <"$file"
	is "standard input: $file" "$status:$(faces | grep '^p')" '0:p 3 0 0 0 1 0 0 0 1 0'
done

cat >shine.x3d <<'END'
<X3D><Scene><Shape><Appearance><Material diffuseColor="1 1 1" specularColor="1 1 1" shininess="0.5"/></Appearance>
<IndexedFaceSet coordIndex="0 1 2 -1"><Coordinate point="0 0 0 1 0 0 0 1 0"/></IndexedFaceSet></Shape></Scene></X3D>
END
is 'the shininess of X3D is a share of 128' "$(mesh2nff shine.x3d 2>&1 | grep '^f ')" 'f 1 1 1 1 1 64 0 1'

printf 'newmtl z\nKd 1 1 1\nd 0.5\nNi 0\n' >zero.mtl
printf 'mtllib zero.mtl\nusemtl z\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >zero.obj
is 'an index of refraction of 0 bends no light' "$(mesh2nff zero.obj | grep '^f ')" 'f 1 1 1 0.5 0 0 0.5 1'

# ---- glTF ----------------------------------------------------------------------------------------------------
# triangle: its positions, its normals, and three indices
triangle() { packed 'f<18 S<3 x2' 0 0 0  1 0 0  0 1 0  0.6 0.8 0  0 0 1  0 0 1  0 1 2; }
# gltf NODES MORE [BUFFER]: a scene of four nodes at most, all children of the first
gltf() {
	cat <<-END
		{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [$1],
		"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}]}],
		"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0,0,0], "max": [1,1,0]},
			{"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
			{"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"}],
		"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36},
			{"buffer": 0, "byteOffset": 36, "byteLength": 36}, {"buffer": 0, "byteOffset": 72, "byteLength": 6}],
		$2,
		"buffers": [{"byteLength": 80 ${3-, \"uri\": \"data:application/octet-stream;base64,$(triangle | base64 -w 0)\"}}]}
	END
}
paint='"materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 0.5], "metallicFactor": 0}}]'
gltf '{"mesh": 0}' "$paint" >a.gltf
run mesh2nff a.gltf
plain='pp 3 0 0 0 0.6 0.8 0 1 0 0 0 0 1 0 1 0 0 0 1'
is 'glTF: alpha counts only where its mode says so' "$status:$err:$(faces)" "0::f 0.5 0.25 0.125 1 0 0 0 1
$plain"
gltf '{"mesh": 0}' "$(echo "$paint" | sed 's/}}/}, "alphaMode": "BLEND"}/')" >blend.gltf
run mesh2nff blend.gltf
is 'glTF: here it does' "$(faces | head -n 1)" 'f 0.5 0.25 0.125 0.5 0 0 0.5 1'
gltf '{"mesh": 0}' "\"extensionsUsed\": [\"KHR_materials_ior\", \"KHR_materials_transmission\"], $(echo "$paint" | sed 's/}}/}, "extensions": {"KHR_materials_ior": {"ior": 1.25}, "KHR_materials_transmission": {"transmissionFactor": 0.75}}}/')" >glass.gltf
run mesh2nff glass.gltf
is 'glTF: transmission, and index of refraction' "$(faces | head -n 1)" 'f 0.5 0.25 0.125 0.25 0 0 0.75 1.25'
gltf '{"mesh": 0}' "$paint" '' >json
while [ $(($(wc -c <json) % 4)) -ne 0 ]; do printf ' ' >>json; done
size=$(wc -c <json)
{ packed 'A4 L<2' glTF 2 $((size + 108)); packed 'L< A4' "$size" JSON; cat json; packed 'L< a4' 80 BIN; triangle; } >a.glb
run mesh2nff a.glb
is 'GLB' "$status:$err:$(faces | tail -n 1)" "0::$plain"
ok 'through a pipe' sh -c 'mesh2nff a.glb >a && cat a.glb | mesh2nff - >b && cmp a b'

# A matrix that turns by a quarter and doubles x, in a node that moves: normals are turned by the inverse transpose.
gltf '{"translation": [10, 20, 30], "children": [1, 2]}, {"mesh": 0, "matrix": [0,2,0,0, -1,0,0,0, 0,0,1,0, 1,2,3,1]}, {"mesh": 0}' \
	"$paint" >nodes.gltf
run mesh2nff nodes.gltf
is 'transforms of nodes, and two instances' "$(faces | grep '^pp')" \
	'pp 3 11 22 33 -0.9363292 0.35112345 0 11 24 33 0 0 1 10 22 33 0 0 1
pp 3 10 20 30 0.6 0.8 0 11 20 30 0 0 1 10 21 30 0 0 1'

# The order of the corners is turned with the normals: both show the same side.
gltf '{"mesh": 0, "scale": [-2, 1, 1]}' "$paint" >mirror.gltf
run mesh2nff mirror.gltf
is 'a mirrored patch: normals on the mirrored side, corners in their order' "$(faces | grep '^pp')" \
	'pp 3 0 0 0 -0.35112345 0.9363292 0 0 1 0 0 0 1 -2 0 0 0 0 1'

# ---- axes and units ------------------------------------------------------------------------------------------
# A triangle of 1 to the right and 2 upwards, where z is up.
# fbx FRONT SIGN: that axis is the front
fbx() {
	printf '; FBX 7.4.0 project file\nFBXHeaderExtension: {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\nGlobalSettings: {\nProperties70: {\n'
	printf 'P: "%s", "int", "Integer", "",%d\n' UpAxis 2 UpAxisSign 1 FrontAxis "$1" FrontAxisSign "$2" CoordAxis 0 CoordAxisSign 1
	cat <<-END
		P: "UnitScaleFactor", "double", "Number", "",100
		}
		}
		Definitions: {
		Count: 2
		}
		Objects: {
		Geometry: 1001, "Geometry::t", "Mesh" {
		Vertices: *9 {
		a: 0,0,0,1,0,0,0,0,2
		}
		PolygonVertexIndex: *3 {
		a: 0,1,-3
		}
		GeometryVersion: 124
		}
		Model: 1002, "Model::t", "Mesh" {
		Version: 232
		}
		}
		Connections: {
		C: "OO",1002,0
		C: "OO",1001,1002
		}
	END
}
fbx 1 -1 >z.fbx
run mesh2nff z.fbx
is 'FBX is turned and scaled' "$status:$(faces | grep '^p'):$(after up)" '0:p 3 0 0 0 1 0 0 0 2 0:0 1 0'
is 'and that is told' "$err" 'mesh2nff: z.fbx: z is up in the file, y in the scene'
sed 's/"",100/"",2.54/' z.fbx >inch.fbx
run mesh2nff inch.fbx
is 'FBX in inches' "$err:$(faces | grep '^p')" \
	'mesh2nff: inch.fbx: z is up in the file, y in the scene; units of 0.0254 m in the file, metres in the scene:p 3 0 0 0 0.0254 0 0 0 0.0508 0'
fbx 1 1 >left.fbx
is 'left-handed axes of FBX are ignored' "$(mesh2nff left.fbx 2>err | grep '^p'; cat err)" 'p 3 0 0 0 1 0 0 0 0 2'

# ---- cameras and lights --------------------------------------------------------------------------------------
lens='"cameras": [{"type": "perspective", "perspective": {"aspectRatio": 1.5, "yfov": 0.5, "znear": 0.1}}, {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]'
gltf '{"mesh": 0, "children": [1, 2]}, {"camera": 0, "matrix": [0,0,-1,0, 0,1,0,0, 1,0,0,0, 5,0.5,0,1]}, {"camera": 1, "translation": [0, 0, 4]}' "$paint, $lens" >camera.gltf
run mesh2nff camera.gltf
is 'a camera is where its node is' "$(after from)" '5 0.5 0'
is 'and looks where its node turns it' "$(after at):$(after up)" '0.5 0.5 0:0 1 0'
is 'with its angle and aspect' "$(after angle):$(after resolution):$(after hither)" '28.64789:768 512:0'
like 'another camera is named' "$err" '^mesh2nff: camera.gltf: cameras beyond the first: 1, left out$'
run mesh2nff -s 30x20 camera.gltf
is '-s: another size, the same angle' "$(after angle):$(after resolution)" '28.64789:30 20'
sed 's/"type": "perspective", "perspective": {"aspectRatio": 1.5, "yfov": 0.5,/"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9,/' \
	camera.gltf >both.gltf
run mesh2nff both.gltf
like 'an orthographic camera is named' "$err" 'cameras that are orthographic, of glTF 1 or X3D, or define no view: 1, left out'
is 'and the next one is taken' "$(after from):$(after angle)" '0 0 4:57.29578'
# libassimp turns cameras of glTF 1 backwards.
cat >old.gltf <<'END'
{"asset": {"version": "1.0"}, "scene": "s", "scenes": {"s": {"nodes": ["n", "c"]}},
"nodes": {"n": {"meshes": ["m"]}, "c": {"camera": "cam", "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]}},
"cameras": {"cam": {"type": "perspective", "perspective": {"yfov": 0.6, "aspectRatio": 1.5, "znear": 0.1, "zfar": 100}}},
"meshes": {"m": {"primitives": [{"attributes": {"POSITION": "a"}, "indices": "i", "mode": 4}]}},
"buffers": {"b": {"uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA",
"byteLength": 42, "type": "arraybuffer"}},
"bufferViews": {"v": {"buffer": "b", "byteOffset": 0, "byteLength": 36, "target": 34962},
"w": {"buffer": "b", "byteOffset": 36, "byteLength": 6, "target": 34963}},
"accessors": {"a": {"bufferView": "v", "byteOffset": 0, "byteStride": 12, "componentType": 5126, "count": 3, "type": "VEC3"},
"i": {"bufferView": "w", "byteOffset": 0, "byteStride": 0, "componentType": 5123, "count": 3, "type": "SCALAR"}}}
END
run mesh2nff old.gltf
like 'glTF 1: the camera is left out' "$status:$err" '^0:mesh2nff: old.gltf: cameras .*: 1, left out$'
is 'and the view fits' "$(after angle)" 40

# Only names tie cameras and lights to nodes in libassimp.
gltf '{"children": [1, 2]}, {"name": "Cam", "camera": 0, "translation": [0, 0, 9]}, {"name": "Cam", "mesh": 0}' "$paint, $lens" >names.gltf
run mesh2nff names.gltf
is 'a later mesh with the name of a camera does not move it' "$(after from)" '0 0 9'
is 'and nothing is in doubt' "$err" ''
gltf '{"children": [1, 2, 3]}, {"name": "Cam", "mesh": 0}, {"name": "Cam", "camera": 0, "translation": [0, 0, 9]}, {"name": "Cam", "camera": 0}' \
	"$paint, $lens" >twice.gltf
run mesh2nff twice.gltf
is 'a camera at two nodes with one name is at the first' "$(after from)" '0 0 9'
like 'and named' "$err" "^mesh2nff: twice.gltf: cameras or lights whose node's name is not unique: 1, taken to be at the first one$"
# collada LENS: a triangle, and a camera
collada() {
	cat <<-END
		<?xml version="1.0"?>
		<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset>
		<library_cameras><camera id="c" name="c"><optics><technique_common><perspective>$1<znear>0.1</znear><zfar>99</zfar>
		</perspective></technique_common></optics></camera></library_cameras>
		<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array>
		<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
		<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>
		</vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
		</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><translate>0 0 9</translate>
		<instance_camera url="#c"/></node><node id="o"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
		<scene><instance_visual_scene url="#s"/></scene></COLLADA>
	END
}
collada '<yfov>40</yfov>' >y.dae
run mesh2nff y.dae
is "a Collada camera's yfov alone is lost, and a view fitted" "$(after angle):$err" \
	'40:mesh2nff: y.dae: cameras that are orthographic, of glTF 1 or X3D, or define no view: 1, left out'
collada '<yfov>40</yfov><aspect_ratio>1.5</aspect_ratio>' >ya.dae
run mesh2nff ya.dae
is 'its yfov and aspect ratio are taken' "$(printf '%.3f' "$(after angle)"):$(after resolution):$(after from):$err" '40.000:768 512:0 0 9:'
collada '<xfov>60</xfov><yfov>40</yfov>' >xy.dae
run mesh2nff xy.dae
is 'so is a camera with xfov and yfov' "$(after from):$err" '0 0 9:'

lamps='"extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights": [
	{"type": "point", "intensity": 50, "color": [1, 0.5, 0.25]}, {"type": "directional", "intensity": 1.5},
	{"type": "spot", "intensity": 25, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}}]}}'
lamp() { printf '"extensions": {"KHR_lights_punctual": {"light": %d}}' "$1"; }
gltf "{\"mesh\": 0, \"children\": [1, 2, 3]}, {$(lamp 0), \"translation\": [0.5, 0.5, 10]},
	{$(lamp 1), \"matrix\": [1,0,0,0, 0,0,-1,0, 0,1,0,0, 0,0,0,1]}, {$(lamp 2), \"translation\": [0.5, 0.5, -5]}" "$paint, $lamps" >lamps.gltf
run mesh2nff lamps.gltf
# At the centre they are 50/100, 1.5 and 25/25; their sum becomes 1.
is 'lights: a point, a far one in the direction that a directional one comes from, and a spot' \
	"$(printf '%s\n' "$out" | grep '^l')" 'l 0.5 0.5 10 0.16666667 0.083333336 0.041666668
l 0.5 14142.636 0 0.5 0.5 0.5
l 0.5 0.5 -5 0.33333334 0.33333334 0.33333334'
like 'and the spot is named' "$err" '^mesh2nff: lamps.gltf: spot lights: 1, written as point lights$'
run mesh2nff a.gltf
is 'without lights: a bright one, and one at the eye' "$(printf '%s\n' "$out" | sed -n 's/^l //p' | sed -n '1s/.* 0.8 0.8 0.8$/bright/p;2p')" \
	"bright
$(after from) 0.3 0.3 0.3"
gltf "{\"children\": [1, 2]}, {\"name\": \"Lamp\", $(lamp 0), \"translation\": [0.5, 0.5, 10]}, {\"name\": \"Lamp\", \"mesh\": 0}" \
	"$paint, $(echo "$lamps" | sed 's/{"type": "directional.*/]}}/;/"spot"/d' | sed 's/, ]/]/')" >lamp.gltf
run mesh2nff lamp.gltf
is 'nor does a later mesh with its name move a light' "$(after l)" '0.5 0.5 10 1 0.5 0.25'

# Centimetres: light fades by distances in the file's unit.
# shining COLOUR: the light of such a Collada file
shining() {
	sed "s|<library_cameras>|<library_lights><light id='w'><technique_common><point><color>$1</color><constant_attenuation>0\
		</constant_attenuation><linear_attenuation>0</linear_attenuation><quadratic_attenuation>0.01</quadratic_attenuation>\
		</point></technique_common></light></library_lights>&|; s|<instance_camera url=\"#c\"/>|<instance_light url=\"#w\"/>|
		s|<up_axis>|<unit meter='0.01'/>&|" y.dae >shines.dae
	mesh2nff shines.dae 2>/dev/null | sed -n 's/^l //p' | cut -d' ' -f4-
}
is 'a light of Collada fades by centimetres' "$(shining '0.5 0.25 0')" '0.61349696 0.30674848 0'
is 'a stronger one is in units of a program' "$(shining '500 250 0')" '1 0.5 0'

# Blender's lamps are in watts, its suns in watts per square metre: here 1 of both at the centre, which is sqrt(81.5) m away.
sed "s|<up_axis>|<contributor><authoring_tool>Blender 3.4.1</authoring_tool></contributor>&|
	s|<library_cameras>|<library_lights><light id='w'><technique_common><point><color>1024.16 1024.16 1024.16</color></point></technique_common></light>\
	<light id='u'><technique_common><directional><color>1 1 1</color></directional></technique_common></light></library_lights>&|
	s|<instance_camera url=\"#c\"/>|<instance_light url=\"#w\"/><instance_light url=\"#u\"/>|" y.dae >blender.dae
is 'a lamp of Blender beside a sun' "$(mesh2nff blender.dae 2>/dev/null | sed -n 's/^l //p' | cut -d' ' -f4 | xargs printf '%.4f ')" '0.5000 0.5000 '

# ---- the view that fits --------------------------------------------------------------------------------------
# extent NFF: how near the corners come to the edges of the picture, across and along: 1 is the edge
extent() {
	awk '
	function dot(a, b) { return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] }
	function cross(a, b, c) { c[1] = a[2] * b[3] - a[3] * b[2]; c[2] = a[3] * b[1] - a[1] * b[3]; c[3] = a[1] * b[2] - a[2] * b[1] }
	function unit(a, i, l) { l = sqrt(dot(a, a)); for (i = 1; i <= 3; i++) a[i] /= l }
	$1 == "from" { for (i = 1; i <= 3; i++) from[i] = $(i + 1) }
	$1 == "at" { for (i = 1; i <= 3; i++) f[i] = $(i + 1) - from[i]; unit(f) }
	$1 == "up" { for (i = 1; i <= 3; i++) u[i] = $(i + 1); cross(f, u, r); unit(r); cross(r, f, u) }
	$1 == "angle" { t = $2 * atan2(0, -1) / 360; t = sin(t) / cos(t) }
	$1 == "resolution" { aspect = $2 / $3 }
	/^pp? / {
		width = $1 == "p" ? 3 : 6
		for (k = 3; k < NF; k += width) {
			for (i = 1; i <= 3; i++) q[i] = $(k + i - 1) - from[i]
			z = dot(q, f); x = dot(q, r) / z / t / aspect; y = dot(q, u) / z / t
			if (z <= 0) behind++
			if (x * x > X * X) X = x
			if (y * y > Y * Y) Y = y
		}
	}
	END { printf "%.2f %.2f%s\n", X < 0 ? -X : X, Y < 0 ? -Y : Y, behind ? " behind" : "" }' "$1"
}
awk 'BEGIN { for (i = 0; i < 60; i++) print "v", 100 + sin(i), 3 * cos(2.3 * i) - 50, 0.2 * sin(1.7 * i)
	for (i = 1; i < 59; i++) print "f", i, i + 1, i + 2 }' >ribbon.obj
for options in '' -z '-s 300x100' '-z -s 100x300'; do
	# shellcheck disable=SC2086  # a word each
	mesh2nff $options ribbon.obj >ribbon.nff
	like "all is seen, and fills the picture: mesh2nff $options" "$(extent ribbon.nff)" '^0.95 0.[0-9]*$|^0.[0-9]* 0.95$'
done
run mesh2nff -z text.stl
is '-z: z is up' "$(after up)" '0 0 1'
run mesh2nff text.stl
is 'by default y is' "$(after up)" '0 1 0'

# ---- what NFF cannot hold, and what is unusable --------------------------------------------------------------
cat >losses.obj <<'END'
mtllib losses.mtl
v nan 0 0
v 1 0 0
v 0 1 0
v 0 0 1
v 1e13 0 0
v inf 0 0
usemtl lamp
f 1 2 3
f 2 3 4
f 2 2 3
f 5 2 3
f 6 2 3
p 2 3
l 2 3
END
printf '%s\n' 'newmtl lamp' 'Kd 1 1 1' 'Ke 1 0 0' 'map_Kd wood.png' >losses.mtl
run mesh2nff losses.obj
is 'losses: exit 0, and one line each with a count' "$status:$(printf '%s\n' "$err" | sort)" \
	"0:mesh2nff: losses.obj: faces with coordinates that are not finite or beyond 1e12, with corners that are not there, or with over 1000000: 3, left out
mesh2nff: losses.obj: faces without area: 1, left out
mesh2nff: losses.obj: lines: 1, left out
mesh2nff: losses.obj: materials that emit light: 1, written without it
mesh2nff: losses.obj: materials with textures: 1, written without them
mesh2nff: losses.obj: points: 2, left out"
is 'and the rest is written' "$(faces)" 'f 1 1 1 1 0 0 0 1
p 3 1 0 0 0 1 0 0 0 1'
sed '/^mtllib/s/ .*/ none.mtl/; /^f [156]/d; /^f 2 2/d; /^[pl] /d' losses.obj >library.obj
run mesh2nff library.obj
is 'a file of materials that is not there: exit 0, and one line' "$status:$err" \
	'0:mesh2nff: library.obj: files of materials that are not there: 1, their materials are grey'
sed 's/"metallicFactor": 0/"metallicFactor": 1/' a.gltf >metal.gltf
like 'metal is named' "$(mesh2nff metal.gltf 2>&1 >a)" '^mesh2nff: metal.gltf: materials of metal: 1, written as if they were none$'
gltf '{"mesh": 0}' "$(echo "$paint" | sed 's/}}/}, "alphaMode": "MASK"}/')" >holes.gltf
like 'holes are named' "$(mesh2nff holes.gltf 2>&1 >a)" '^mesh2nff: holes.gltf: materials whose alpha cuts holes: 1, written without holes$'
gltf '{"mesh": 0}' "$paint"', "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
	"samplers": [{"input": 3, "output": 0}]}]' | sed 's/"type": "SCALAR"}/&, {"bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR"}/' >moves.gltf
like 'animations are named' "$(mesh2nff moves.gltf 2>&1 >a)" '^mesh2nff: moves.gltf: animations: 1, left out$'
# third N: N / 31 as it is written
third() { case $1 in 21) echo 0.67741936 ;; 10) echo 0.32258064 ;; esac; }
sed 's/^property float nx/property uchar red/; s/^property float ny/property uchar green/; s/^property float nz/property uchar blue/' \
	text.ply >colours.ply
like 'colours of vertices are named' "$(mesh2nff colours.ply 2>&1 >a)" 'meshes with colours at their vertices: 1, each face has their mean$'
sed '/^property uchar blue/a property uchar alpha
/^[0-9.-]* [0-9.-]* [0-9.-]* [0-9.-]* [0-9.-]* [0-9.-]*$/s/$/ 128/' colours.ply >clear.ply
like 'their alpha is named' "$(mesh2nff clear.ply 2>&1 >a)" 'meshes whose colours at vertices have an alpha: 1, written as opaque$'
sed 's/^property list.*/&\nproperty uchar red/; s/^\([34] .*\)/\1 9/' text.ply >painted.ply
like 'colours of faces are named' "$(mesh2nff painted.ply 2>&1 >a)" "^mesh2nff: painted.ply: colours of a PLY's or OFF's faces, .*: 1, left out$"
printf '%s\n' 'v 0 0 0 1 0 0' 'v 1 0 0 1 0 0' 'v 0 1 0 0 0 1' 'v 1 1 0 0 1 0' 'f 1 2 3' 'f 2 4 3' 'f 2 3 4' 'f 1 2 1' >coloured.obj
run mesh2nff coloured.obj
is 'each face has the mean of its corners, in steps of 1/31, and a line f where it changes' "$(faces)" \
	"f $(third 21) 0 $(third 10) 1 0 0 0 1
p 3 0 0 0 1 0 0 0 1 0
f $(third 10) $(third 10) $(third 10) 1 0 0 0 1
p 3 1 0 0 1 1 0 0 1 0
p 3 1 0 0 0 1 0 1 1 0"
# ---- textures ------------------------------------------------------------------------------------------------
# Red, green; blue, white.
{ printf 'P6 2 2 255\n'; packed 'C*' 255 0 0 0 255 0 0 0 255 255 255 255; } >quarters.ppm
blend -k 8 -o quarters.png quarters.ppm
{ printf 'newmtl quarters\nKd 1 1 0.5\nmap_Kd quarters.png\n'; printf 'newmtl grey\nmap_Kd C:\\pictures\\Quarters.PNG\n'; } >textured.mtl
cat >textured.obj <<'END'
mtllib textured.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0.25 0.75
vt 0.75 0.75
vt 0.25 0.25
vt 3.75 -0.75
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl quarters
f 1/1 2/1 3/1
f 1/2 2/2 3/2
f 1/3 2/3 3/3
f 1/4 2/4 3/4
f 1/5 2/6 3/7 4/8
usemtl grey
f 1/4 2/4 3/4
END
run mesh2nff -t textured.obj
is '-t: each face has the mean of its texture, times the colour of the material' "$status:$(faces | grep '^f')" '0:f 1 0 0 1 0 0 0 1
f 0 1 0 1 0 0 0 1
f 0 0 0.5 1 0 0 0 1
f 1 1 0.5 1 0 0 0 1
f 0.5149177 0.5149177 0.25745884 1 0 0 0 1
f 1 1 1 1 0 0 0 1'
is '-t: the count of colours is told' "$err" 'mesh2nff: textured.obj: colours of textures: 5, at most 2.5/255 of sRGB off'
# The first face in the white quarter, the second in the blue one.
sed 's/^map_Kd q/map_Kd -blendu on -s 1 0.5 1 -o 0.375 -0.125 q/' textured.mtl >moved.mtl
sed 's/textured/moved/' textured.obj >moved.obj
is '-t: the scale and offset of an MTL' "$(mesh2nff -t moved.obj 2>err | grep '^f ' | sed -n 1,2p | tr '\n' ';')" 'f 1 1 0.5 1 0 0 0 1;f 0 0 0.5 1 0 0 0 1;'
# A grey of 188 in 8 bits is .5029 of the light; the nearest step is 190.
{ printf 'P6 1500 3 255\n'; packed 'C*' 188 188 188 | perl -e '$_ = <>; print $_ x 4500'; } >wide.ppm
sed 's/quarters.png/wide.ppm/I' textured.mtl >wide.mtl
sed 's/textured/wide/' textured.obj >wide.obj
is '-t: a large picture, in steps' "$(mesh2nff -t wide.obj 2>err | grep '^f ' | sort -u | tr '\n' ';')" \
	'f 0.5149177 0.5149177 0.25745884 1 0 0 0 1;f 0.5149177 0.5149177 0.5149177 1 0 0 0 1;'
jpeg=/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAMCAgMCAgMDAwMEAwMEBQgFBQQEBQoHBwYIDAoMDAsKCwsNDhIQDQ4RDgsLEBYQERMUFRUVDA8XGBYUGBIUFRT/2wBDAQMEBAUEBQkFBQkUDQsNFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBT/wAARCAAIAAgDAREAAhEBAxEB/8QAFAABAAAAAAAAAAAAAAAAAAAABP/EABQQAQAAAAAAAAAAAAAAAAAAAAD/xAAVAQEBAAAAAAAAAAAAAAAAAAAHCP/EABQRAQAAAAAAAAAAAAAAAAAAAAD/2gAMAwEAAhEDEQA/ACA9SD//2Q==
# The same in glTF, within the file, whose pictures begin at the top; scaled and moved to the white quarter.
cat >textured.gltf <<END
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"extensionsUsed": ["KHR_texture_transform"],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0},
	{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 1}, {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 2}]}],
"materials": [{"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [1, 1, 0.5, 1], "baseColorTexture": {"index": 0}},
		"normalTexture": {"index": 0}},
	{"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0, "extensions":
		{"KHR_texture_transform": {"offset": [0.5, 0.5], "scale": [0.5, 0.5]}}}}},
	{"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 1}}}],
"textures": [{"source": 0}, {"source": 1}], "images": [{"uri": "data:image/png;base64,$(base64 -w 0 quarters.png)"},
	{"uri": "data:image/jpeg;base64,$jpeg"}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
	{"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
"buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64,$(
	packed 'f<*' 0 0 0 1 0 0 0 1 0 0.6 0.1 0.9 0.1 0.9 0.4 | base64 -w 0)"}]}
END
run mesh2nff -t textured.gltf
if printf '%s\n' "$err" | grep -q 'which this build cannot read'; then
	skip 'a texture in JPEG' 'libjpeg-dev is not there'
else
	is '-t: glTF, its pictures within it, one moved, one in JPEG' "$status:$(faces | grep '^f')" '0:f 0 1 0 1 0 0 0 1
f 1 1 1 1 0 0 0 1
f 0.57758045 0.12743768 0.031896032 1 0 0 0 1'
fi
like '-t: other textures are named' "$err" "^mesh2nff: textured.gltf: materials with textures besides the base colour's: 1, written without them"
sed 's/"TEXCOORD_0": 1/"TEXCOORD_0": 0, "TEXCOORD_1": 1/g; s/{"offset"/{"texCoord": 1, "offset"/' textured.gltf >chosen.gltf
is '-t: texture coordinates that KHR_texture_transform chooses' "$(mesh2nff -t chosen.gltf 2>err | grep '^f ' | sed -n 2p)" 'f 1 1 1 1 0 0 0 1'
# Coordinates of bytes, which libassimp does not divide by 255.
sed 's/\(5126\)\(, "count": 3, "type": "VEC2"\)/5121\2, "normalized": true/' textured.gltf >integers.gltf
like '-t: integers as texture coordinates are told' "$(mesh2nff -t integers.gltf 2>&1 >a)" 'not placed by coordinates of floating point: 3, written without them'
sed 's/quarters.png/none.png/I' textured.mtl >wide.mtl
like '-t: a picture that is not there' "$(mesh2nff -t wide.obj 2>&1 >a)" \
	"pictures of textures that cannot be read [(]none.png: No such file or directory[)]: 2, their faces have the material's colour"
head -c 60 quarters.png >torn.png
is '-t: a device that is no file' "$(sed 's/quarters.png/\/dev\/zero/I' textured.mtl >wide.mtl; mesh2nff -t wide.obj 2>&1 >a | grep -c '/dev/zero: is no file')" 1
sed 's/quarters.png/torn.png/I' textured.mtl >wide.mtl
like '-t: a damaged one' "$(mesh2nff -t wide.obj 2>&1 >a)" 'torn.png: .*PNG'

sed 's/ 0 0.6 0.8$/ 0 nan 0.8/' text.ply >normals.ply
run mesh2nff normals.ply
like 'normals that are no numbers are named' "$err" 'faces with normals that are no direction: 2, written without them$'
is 'and the faces are polygons' "$(faces | cut -d' ' -f1 | tr '\n' ' ')" 'f p p '

# ---- oddities of files in the wild: each line is a name, then a triangle, or the reason of a refusal -------------
packed 'C3' 239 187 191 >mark
triangle_of='v 0 0 0\nv 1 0 0\nv 0 1 0\n'
# shellcheck disable=SC2059  # formats
{
	printf "$triangle_of"'f 1 2 3\n' | sed 's/$/\r/' >crlf.obj
	{ cat mark; printf "$triangle_of"'f 1 2 3\n'; } >marked.obj
	printf 'v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2 3\n' >continued.obj
	{ cat mark; printf 'newmtl my paint\nKd 0.5 0.25 0.125\n'; } >'my lib.mtl'
	{ cat mark; printf 'mtllib my lib.mtl\n'"$triangle_of"'usemtl my paint\nf 1 2 3\n'; } >blanks.obj
	printf "$triangle_of"'f -3 -2 -1\n' >negative.obj
	printf ' v 0 0 0 # first\r\n\tv 1 .0 0\r\nv 0 1 0\r\n f 1 2 3 # all\r\n' >comments.obj
	printf 'mtllib my lib.mtl \t\n'"$triangle_of"'  usemtl my paint \nf 1 2 3#\n' >behind.obj
	printf 'newmtl other\nKd 1 0 0\n' >other.MTL
	printf 'mtllib "other.MTL" "my lib.mtl"\n'"$triangle_of"'usemtl my paint\nf 1 2 3\n' >quoted.obj
	printf 'mtllib my lib.mtl other.MTL\n'"$triangle_of"'usemtl other\nf 1 2 3\n' >two.obj
	printf 'mtllib Other.mtl\n'"$triangle_of"'usemtl other\nf 1 2 3\n' >cased.obj
	printf 'NEWMTL my paint\nKD 0.5 0.25 0.125\nD -halo 0.5\n' >capitals.mtl
	printf 'mtllib capitals.mtl\n'"$triangle_of"'usemtl my paint\nf 1 2 3\n' >capitals.obj
	printf 'newmtl my paint\nd -halo 0.5\n' >halo.mtl
	printf 'mtllib halo.mtl\n'"$triangle_of"'usemtl my paint\nf 1 2 3\n' >halo.obj
	printf 'v 0 0 0 1 0 0 0.5\nv 1 0 0 1 0 0 1\nv 0 1 0 1 0 0 1\nf 1 2 3\n' >alpha.obj
	printf "$triangle_of"'vt 0 0\nf 1/1/ 2/1/ 3/1/\n' >slashes.obj
	printf "$triangle_of"'f 1 2 3' >unended.obj
	printf 'g a b c\n'"$triangle_of"'s off\nf 1 2 3\n' >groups.obj
	printf 'v 0 0 0\nv 1.e0 0 0\nv 0 +1 0\nf 1 2 3\n' >signs.obj
	mkdir -p Parts
	printf '  newmtl first\nKd 1 0 0\n' >Parts/first.mtl
	printf 'mtllib .\\parts\\First.mtl\n'"$triangle_of"'usemtl first\nf 1 2 3\n' >folder.obj
	printf 'mtllib Parts/first.mtl\n'"$triangle_of"'usemtl second\nf 1 2 3\n' >named.obj
	printf "$triangle_of"'f 1 2 3\nv 5 0 0 1 0 0\nv 6 0 0 1 0 0\nv 5 1 0 1 0 0 # red\nf 4 5 6\n' >partly.obj
	printf 'COFF # a comment\n# more\n3 1 0\n\n0 0 0 255 0 0 255 # red\n1 0 0 255 0 0 255\n0 1 0 255 0 0 255\n# faces\n3 0 1 2\n' >comments.off
	printf 'OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n' >painted.off
	printf "$triangle_of"'f 1 2 4\n' >beyond.obj
	printf "$triangle_of"'f 0 1 2\n' >zeroth.obj
	printf "$triangle_of"'v 1 1 0\nv 2 0.5 0\nf 1 2 5 4 3\n' >ngon.obj
	printf "$triangle_of"'v 0.25 0.25 0\nf 1 2 4 3\n' >concave.obj
	printf "$triangle_of"'v 2 0 0\nf 1 2 4\nf 1 2 3\nf 3 3 1\n' >flat.obj
	printf 'o an object\ng a group\n'"$triangle_of"'f 1 2 3\n' >'an object.obj'
	printf 'v 1000000 1000000 0\nv 1000001 1000000 0\nv 1000000 1000001 0\nf 1 2 3\n' >far.obj
}
{ printf '%s\n' ply 'format binary_big_endian 1.0' 'obj_info made by hand' 'element vertex 3' 'property float x' 'property float y' \
	'property float z' 'element face 1' 'property list uchar int vertex_index' end_header
packed 'f>9' 0 0 0 1 0 0 0 1 0; packed 'Cl>3' 3 0 1 2; } >big.ply
{ sed 's/binary_big_endian/ascii/; s/^property float z/&\nproperty int red\nproperty int green\nproperty int blue/; /^end_header/q' big.ply
printf '%s 255 0 0\n' '0 0 0' '1 0 0' '0 1 0'; echo '3 0 1 2'; } >wide.ply
# The first number begins with a byte 10.
{ sed 's/big/little/; /^end_header/q' big.ply; packed 'C4' 10 0 0 63; packed 'f<8' 0 0 1 0 0 0 1 0; packed 'Cl<3' 3 0 1 2; } >ten.ply
{ packed 'A80 L<' 'solid made by a program' 1; packed 'f<12 S<' 0 0 1 0 0 0 1 0 0 0 1 0 0; } >solid.stl
{ cat solid.stl; echo more; } >more.stl
sed '/^facet normal 0 0 0/,/^endfacet/d; s/1\.5/1/' text.stl | tr '[:lower:]' '[:upper:]' >upper.stl
# shellcheck disable=SC2059  # formats
{
	printf 'newmtl a\nKd 1 0 0\nPm 1\naniso 0\nanisor 0\n' >blender.mtl
	printf 'mtllib blender.mtl\n'"$triangle_of"'usemtl a\nf 1 2 3\n' >blender.obj
	printf 'newmtl a\nillum 1\nKs 1 1 1\nNs 9\nnewmtl b\nKs 1 1 1\nNs 9\nillum 7\n' >matt.mtl
	printf 'mtllib matt.mtl\n'"$triangle_of"'usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n' >matt.obj
	printf "$triangle_of"'usemtl first\nmtllib Parts/first.mtl\nf 1 2 3\n' >late.obj
	printf 'v 0 0 0 0 255 51\nv 1 0 0 0 255 51\nv 0 1 0 0 255 51\nv 5 0 0\nf 1 2 3\n' >eight.obj
	printf 'v 0 0 0 0 1.5 0\nv 1 0 0 0 1.5 0\nv 0 1 0 0 1.5 0\nf 1 2 3\n' >bright.obj
	printf "$triangle_of"'v 1 1 0\ncstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nend\n' >free.obj
	{ cat free.obj; echo f 1 2 3; } >surface.obj
	printf '\377\376v\0 \0000\0' >utf16.obj
	printf 'PK\003\004' >zip.amf
}
printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' 'element edge 2' \
	'property int vertex1' 'property int vertex2' 'element face 1' 'property list uchar int vertex_index' end_header '0 0 0' '1 0 0' '0 1 0' \
	'0 1' '1 2' '3 0 1 2' >edges.ply
sed 's/^element edge 2/element camera 2/; s/vertex[12]$/view/' edges.ply >view.ply
sed '/^vertex 0 1.5 0/s/.*/vertex 0 1 0\n&/; /^facet normal 0 0 0/,/^endfacet/d' text.stl >four.stl
cat >bare.amf <<'END'
<?xml version="1.0"?><amf unit="inch"><object id="0"><mesh><vertices><vertex><coordinates><x>0</x><y>0</y><z>0</z></coordinates></vertex>
<vertex><coordinates><x>1</x><y>0</y><z>0</z></coordinates></vertex><vertex><coordinates><x>0</x><y>1</y><z>0</z></coordinates></vertex></vertices>
<volume><triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume></mesh></object></amf>
END
printf '%s\n' 0 SECTION 2 ENTITIES 0 3DFACE 8 0 62 1 10 0 20 0 30 0 11 1 21 0 31 0 12 0 22 1 32 0 13 0 23 1 33 0 0 ENDSEC 0 EOF >turned.dxf
# magics HEADER COLOUR: a facet
magics() { packed 'a80 L<' "$1" 1; packed 'f<12 S<' 0 0 1 0 0 0 1 0 0 0 1 0 "$2"; }
{ packed 'A80 L<' viscam 2; packed 'f<12 S<' 0 0 1 0 0 0 1 0 0 0 1 0 64512; packed 'f<12 S<' 0 0 1 5 0 0 6 0 0 5 1 0 0; } >viscam.stl
magics "COLOR=$(printf '\001\377\001\377')" 31 >own.stl
magics "COLOR=$(printf '\001\377\001\377')" 32799 >whole.stl
magics "COLOR=$(printf '\001\377\001\377,MATERIAL=\377\001\001\377')" 0 >material.stl
{ sed '/^element face/,$d' big.ply; printf '%s\n' 'element face 1' 'property list uchar int vertex_index' end_header; } | sed '
	s/binary_big_endian/ascii/; s/^element vertex 3/element list 1\nproperty list uchar int of\n&/' >lists.ply
printf '%s\n' '1 5' '0 0 0' '1 0 0' '0 1 0' '3 0 1 2' >>lists.ply
printf '%s%s%s' '<X3D version="3.0"><Scene><Viewpoint position="0 0 5"/><Shape><Appearance><Material diffuseColor="1 0 0"/></Appearance>' \
	'<IndexedFaceSet coordIndex="0 1 2 -1"><Coordinate point="0 0 0 1 0 0 0 1 0"/></IndexedFaceSet></Shape>' '</Scene></X3D>' >view.x3d
values=$({ packed 'f<9 S<3 x2' 0 0 0 1 0 0 0 9 0 0 1 2; packed 'S< x2 f<3' 2 0 1 0; } | base64 -w 0)
cat >sparse.gltf <<END
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
"materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0], "sparse":
{"count": 1, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 3}}},
{"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6},
{"buffer": 0, "byteOffset": 44, "byteLength": 2}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
"buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64,$values"}]}
END
sed 's/"asset"/"extensionsRequired": ["KHR_draco_mesh_compression"], "extensionsUsed": ["KHR_draco_mesh_compression"], &/
	s/"indices": 1,/&"extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}},/' sparse.gltf >draco.gltf
sed 's/"asset"/"extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"], &/' sparse.gltf >quantized.gltf
sed 's/"asset"/"extensionsUsed": ["KHR_mesh_quantization"], &/' sparse.gltf >used.gltf
sed 's/"pbrM.*0}/"alphaMode": "BLEND", "extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [1, 0, 0, 0.5]}}/
	s/"asset"/"extensionsUsed": ["KHR_materials_pbrSpecularGlossiness"], &/' sparse.gltf >glossy.gltf
sed 's/"asset"/"extensionsUsed": ["EXT_one"], "extensionsRequired": ["KHR_materials_unlit", "EXT_one"], &/' sparse.gltf >required.gltf
sed 's/"asset"/"extensionsUsed": ["KHR_materials_unlit", "EXT_mesh_gpu_instancing"], &/' sparse.gltf >instanced.gltf
printf '%s' "$values" | base64 -d >'my numbers.bin'
sed 's/"uri": "[^"]*"/"uri": "my%20numbers.bin"/' sparse.gltf >uri.gltf
sed 's/"POSITION": 0}/"POSITION": 0, "COLOR_0": 0}/' sparse.gltf >three.gltf
sed 's/{"mesh": 0}/{"mesh": 0, "skin": 0}, {"name": "joint"}/; s/"asset"/"skins": [{"joints": [1]}], &/
	s/"POSITION": 0}/"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3}/
	s/"type": "SCALAR"}/&, {"componentType": 5121, "count": 3, "type": "VEC4"}, {"componentType": 5126, "count": 3, "type": "VEC4"}/' \
	sparse.gltf >skin.gltf
sed 's/"asset"/"extensionsUsed": ["KHR_materials_volume"], &/; s/"pbrM/"extensions": {"KHR_materials_volume": \
	{"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.5]}}, &/' sparse.gltf >volume.gltf
sed 's/"scenes": \[/&{"nodes": []}, /; s/"scene": 0/"scene": 1/' sparse.gltf >scenes.gltf
while IFS='|' read -r name wanted; do
	run mesh2nff "$name"
	is "$name" "$status:$err$(faces | tr '\n' ';')" "$wanted"
done <<'END'
blender.obj|0:mesh2nff: blender.obj: materials of metal: 1, written as if they were nonef 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
matt.obj|0:f 0.6 0.6 0.6 1 0 9 0 1;p 3 0 0 0 1 0 0 0 1 0;f 0.6 0.6 0.6 1 1 9 0 1;p 3 0 0 0 1 0 0 0 1 0;
late.obj|0:f 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
eight.obj|0:mesh2nff: eight.obj: meshes with colours at their vertices: 1, each face has their meanf 0 1 0.19354838 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
free.obj|2:mesh2nff: free.obj: has free-form curves and surfaces but no face with an area, expected one: export them as polygons
surface.obj|0:mesh2nff: surface.obj: free-form curves and surfaces of an OBJ, and files that it calls: 1, left outf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
utf16.obj|2:mesh2nff: utf16.obj: is text in UTF-16, expected UTF-8
zip.amf|2:mesh2nff: zip.amf: is a ZIP archive that libassimp does not read, expected the file in it
edges.ply|0:mesh2nff: edges.ply: lines: 2, left outf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
view.ply|2:mesh2nff: view.ply: PLY with an element before its faces that is neither vertex, edge nor material, expected it behind them
four.stl|0:mesh2nff: four.stl: corners of facets of an STL behind the third: 1, left outf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
used.gltf|2:mesh2nff: used.gltf: requires 'KHR_mesh_quantization', which libassimp does not read, expected a glTF without
glossy.gltf|0:f 1 0 0 0.5 1 1000 0.5 1;p 3 0 0 0 1 0 0 0 1 0;
bare.amf|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
quantized.gltf|2:mesh2nff: quantized.gltf: requires 'KHR_mesh_quantization', which libassimp does not read, expected a glTF without
required.gltf|2:mesh2nff: required.gltf: requires 'EXT_one', which libassimp does not read, expected a glTF without
instanced.gltf|0:mesh2nff: instanced.gltf: extensions of glTF that hide nodes or repeat meshes: 1, left outf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
scenes.gltf|0:mesh2nff: scenes.gltf: scenes of glTF besides the one that it shows: 1, left outf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
view.x3d|0:mesh2nff: view.x3d: cameras that are orthographic, of glTF 1 or X3D, or define no view: 1, left outf 1 0 0 1 0 25.6 0 1;p 3 0 0 0 1 0 0 0 1 0;
uri.gltf|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
skin.gltf|0:mesh2nff: skin.gltf: meshes with bones: 1, written as they restf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
volume.gltf|0:mesh2nff: volume.gltf: materials whose inside absorbs light: 1, written as if it did notf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
three.gltf|0:mesh2nff: three.gltf: meshes with colours at their vertices: 1, each face has their meanf 0.32258064 0.32258064 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
folder.obj|0:f 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
named.obj|0:mesh2nff: named.obj: names of materials that are in no file: 1, their faces are greyf 0.6 0.6 0.6 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
partly.obj|0:mesh2nff: partly.obj: meshes with colours at their vertices: 1, each face has their meanf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;f 1 0 0 1 0 0 0 1;p 3 5 0 0 6 0 0 5 1 0;
comments.off|0:mesh2nff: comments.off: meshes with colours at their vertices: 1, each face has their meanf 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
painted.off|0:mesh2nff: painted.off: colours of a PLY's or OFF's faces, or in a PLY of other names than red, green and blue or other types than uchar, ushort and float: 1, left outf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
wide.ply|0:mesh2nff: wide.ply: colours of a PLY's or OFF's faces, or in a PLY of other names than red, green and blue or other types than uchar, ushort and float: 1, left outf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
ten.ply|0:f 1 1 1 1 0 0 0 1;p 3 0.5000006 0 0 1 0 0 0 1 0;
crlf.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
marked.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
continued.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
blanks.obj|0:f 0.5 0.25 0.125 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
comments.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
behind.obj|0:f 0.5 0.25 0.125 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
quoted.obj|0:f 0.5 0.25 0.125 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
capitals.obj|0:f 0.5 0.25 0.125 0.5 0 0 0.5 1;p 3 0 0 0 1 0 0 0 1 0;
halo.obj|0:f 0.6 0.6 0.6 0.5 0 0 0.5 1;p 3 0 0 0 1 0 0 0 1 0;
alpha.obj|0:mesh2nff: alpha.obj: meshes with colours at their vertices: 1, each face has their meanf 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
two.obj|0:f 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
cased.obj|0:f 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
negative.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
slashes.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
unended.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
groups.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
signs.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
ngon.obj|0:f 1 1 1 1 0 0 0 1;p 5 0 0 0 1 0 0 2 0.5 0 1 1 0 0 1 0;
concave.obj|0:f 1 1 1 1 0 0 0 1;p 4 0 0 0 1 0 0 0.25 0.25 0 0 1 0;
flat.obj|0:mesh2nff: flat.obj: faces without area: 2, left outf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
an object.obj|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
far.obj|0:mesh2nff: far.obj: meshes so far from their origin that libassimp's single precision may move corners by 1/20000 of the extent or more: 1, written as they are readf 1 1 1 1 0 0 0 1;p 3 1000000 1000000 0 1000001 1000000 0 1000000 1000001 0;
big.ply|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
solid.stl|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
more.stl|0:mesh2nff: more.stl: bytes behind the facets of an STL: 5, left outf 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
upper.stl|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
viscam.stl|0:mesh2nff: viscam.stl: meshes with colours at their vertices: 1, each face has their meanf 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;f 1 1 1 1 0 0 0 1;p 3 5 0 0 6 0 0 5 1 0;
own.stl|0:mesh2nff: own.stl: meshes with colours at their vertices: 1, each face has their meanf 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
whole.stl|0:mesh2nff: whole.stl: meshes with colours at their vertices: 1, each face has their meanf 0 1 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
material.stl|0:mesh2nff: material.stl: meshes with colours at their vertices: 1, each face has their meanf 1 0 0 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
lists.ply|2:mesh2nff: lists.ply: PLY with an element before its faces that is neither vertex, edge nor material, expected it behind them
sparse.gltf|0:f 1 1 1 1 0 0 0 1;p 3 0 0 0 1 0 0 0 1 0;
beyond.obj|2:mesh2nff: beyond.obj: libassimp: OBJ: vertex index out of range, expected a mesh in one of its formats
zeroth.obj|2:mesh2nff: zeroth.obj: libassimp: OBJ: Invalid face index, expected a mesh in one of its formats
END
like 'colours above 1' "$(mesh2nff bright.obj 2>&1 | grep '^f \|above' | tr '\n' ';')" 'colours above 1 at their vertices: 1, written as 1;f 0 1 0 '
is 'libassimp turns a DXF, and that is told' "$(mesh2nff turned.dxf 2>&1 | grep '^p\|up in')" 'mesh2nff: turned.dxf: z is up in the file, y in the scene
p 3 0 0 0 1 0 0 0 0 -1'
run mesh2nff draco.gltf
like 'draco.gltf' "$status:$out:$err" '^2::mesh2nff: draco.gltf: libassimp: .*Draco'
run sh -c 'mesh2nff - <ten.ply'
is 'a byte 10 on standard input' "$status:$(faces | tail -n 1)" '0:p 3 0.5000006 0 0 1 0 0 0 1 0'
for file in capitals folder quoted; do
	ok "its libraries are read by the same rules on standard input: $file" sh -c "mesh2nff $file.obj >a && mesh2nff - <$file.obj >b && cmp a b"
done
run sh -c 'mesh2nff - <marked.obj'
is 'a mark on standard input' "$status:$err$(faces | tail -n 1)" '0:p 3 0 0 0 1 0 0 0 1 0'

# ---- far scenes ----------------------------------------------------------------------------------------------
# picture MESH: in single precision, with the view and lights that mesh2nff chooses
picture() { mesh2nff -s 60x60 "$1" >p.nff && partition 60x60 | rtworker p.nff | gather -o "$2"; }
triangles='0 0 0 1 0 0 0 1 0.5 1 1 1'
for d in 0 1000 1000000; do
	# shellcheck disable=SC2086  # a number each
	printf '%s %s %s\n' $triangles | awk -v d=$d '{ printf "v %.9g %.9g %.9g\n", $1 + d, $2 - d, $3 + 2 * d } END { print "f 1 2 3\nf 2 4 3" }' >away$d.obj
	gltf "{\"mesh\": 0, \"translation\": [$d.5, -$d, $d]}" "$paint" >away$d.gltf
	picture away$d.obj o$d.pfm 2>err
	picture away$d.gltf g$d.pfm 2>>err
done
for d in 1000 1000000; do
	ok "a scene $d away is rendered as one at the origin" imgcmp -r 1e-6 -t 1e-4 o0.pfm o$d.pfm
	ok "a node $d away likewise" imgcmp -r 1e-6 -t 1e-4 g0.pfm g$d.pfm
done

# ---- refused -------------------------------------------------------------------------------------------------
# refused FILE WHY: exit 2 with one line, nothing on standard output
refused() {
	run mesh2nff "$1"
	like "refused: $1" "$status:$out:$err" "^2::mesh2nff: $2"
}
refused missing.obj 'missing.obj: No such file or directory$'
refused . '[.]: Is a directory$'
printf '%s\n' OFF '3 2 0' '0 0 0' '1 0 0' '0 1 0' '3 0 1 2' '3 0 1 9' >corner.off
refused corner.off 'corner[.]off: a face has a corner that is not there, expected all corners$'
printf '%s\n' OFF '3 9 0' '0 0 0' '1 0 0' '0 1 0' '3 0 1 2' >cut.off
refused cut.off 'cut[.]off: ends too early, expected a whole file$'
printf '%s\n' 'solid a' 'facet normal 0 0 1' 'outer loop' 'vertex 0 0 0' 'vertex 1 0 0' 'vertex 0 1 0' endloop endfacet >cut.stl
refused cut.stl 'cut[.]stl: ends too early, expected a whole file$'
printf '%s\n' 'solid a' 'facet normal 0 0 1' 'outer loop' 'vertex 0 0 0' 'vertex 1 0 0' 'vertex 0 1' >number.stl
refused number.stl 'number[.]stl: ends too early, or lacks a number, expected a whole file$'
echo words >words.txt
refused words.txt 'words.txt: libassimp: .*, expected a mesh in one of its formats$'
head -c 300 a.glb >torn.glb
refused torn.glb 'torn.glb: libassimp: .*, expected a mesh in one of its formats$'
: >empty
refused empty 'empty: .*, expected a mesh'
run mesh2nff - <empty
is 'refused: an empty standard input' "$status:$out:$err" '2::mesh2nff: stdin: is empty, expected a mesh'
printf '%s\n' ply 'format ascii 1.0' 'element vertex 4' 'property float x' 'property float y' 'property float z' \
	'element tristrips 1' 'property list int int vertex_indices' end_header '0 0 0' '1 0 0' '0 1 0' '1 1 0' '4 0 1 2 3' >strips.ply
refused strips.ply 'strips.ply: PLY with element tristrips, expected element face$'
tr '\n' '\r' <strips.ply >returns.ply
refused returns.ply 'returns.ply: PLY with element tristrips, expected element face$'
run mesh2nff - <strips.ply
is 'refused: triangle strips from standard input' "$status:$out:$err" '2::mesh2nff: stdin: PLY with element tristrips, expected element face'
sed 's/^format.*/&\ncomment element tristrips 1/; s/^element tristrips/element face/; s/^end_header/element tristrips 0\nproperty list int int vertex_indices\n&/; s/^4 .*/3 0 1 2/' \
	strips.ply >faces.ply
run mesh2nff faces.ply
is 'but not the words in a comment, nor no strips' "$status:$err:$(faces | tail -n 1)" '0::p 3 0 0 0 1 0 0 0 1 0'
printf 'v %s\n' '0 0 0' '1 1 1' '2 2 2' >line.obj
echo 'f 1 2 3' >>line.obj
refused line.obj 'line.obj: has no usable face with an area, expected one at least$'
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\np 1\n' >points.obj
printf '%s\n' ply 'format ascii 1.0' 'element vertex 2' 'property float x' 'property float y' 'property float z' end_header '0 0 0' '1 0 0' >cloud.ply
printf 'v 0 0 0\nv .5 0 0\nv 1 0 -.5\nv 0 1 0\nv\t7 7\t.25\nvn .6 .0 .8\nf 2 5 3\n' >bare.obj
for file in bare.obj -; do
	run mesh2nff "$file" <bare.obj
	is "numbers of an OBJ such as .5: $file" "$status:$(faces | grep '^p')" '0:p 3 0.5 0 0 7 7 0.25 1 0 -0.5'
done
refused cloud.ply 'cloud.ply: has 2 points and 0 lines but no face'
head -c 120 bytes.stl >torn.stl
refused torn.stl 'torn.stl: neither STL in text nor an STL whose length is that of its facets$'
refused points.obj 'points.obj: has 1 points and 1 lines but no face with an area, expected one: points and lines are not rendered$'
echo '# nothing' >comment.obj
refused comment.obj 'comment.obj: an OBJ without faces, expected one at least$'
printf 'v %s\n' '0 0 0' '1e-13 0 0' '0 1e-13 0' >tiny.obj
echo 'f 1 2 3' >>tiny.obj
refused tiny.obj 'tiny.obj: extends over 1.41421e-13, expected at least 1e-12$'
# libassimp descends into nodes by recursion, and has no limit.
awk 'BEGIN { for (i = 0; i < 200000; i++) printf "{\"children\": [%d]}, ", i + 1; print "{\"mesh\": 0}" }' >chain
gltf "$(cat chain)" "$paint" >deep.gltf
refused deep.gltf 'deep.gltf: libassimp failed, expected a file without damage$'
# libassimp 5.2 looks for the end of this header forever; a later one may refuse it.
sed 's/^end_header/end_headr/' text.ply >endless.ply
run mesh2nff endless.ply
like 'refused: a file that libassimp does not end with' "$status:$out:$err" '^2::mesh2nff: endless.ply: libassimp.*, expected'
run sh -c 'mesh2nff a.obj >/dev/full'
like 'a full disk exits 3' "$status $err" '^3 mesh2nff: standard output: '

# ---- real meshes ---------------------------------------------------------------------------------------------
# same FILE: rtworker's picture is POV-Ray's
same() {
	mesh2nff "$1" >s.nff && nff2pov -x 100 s.nff >s.pov || return
	pov_ray +Is.pov +Os.ppm +W100 +H100 File_Gamma=1 +FP16 -A -D +WT1 >povray.log 2>&1 || { tail -n 5 povray.log; return 1; }
	partition 100x100 | rtworker s.nff | gather -o s.pfm || return
	imgcmp -d 0.001 -r 0.00001 s.pfm s.ppm && imgcmp -q -t 0.003922 -f 0.0005 s.pfm s.ppm
}
models=/usr/share/glmark2/models
if there povray $models/bunny.obj $models/horse.3ds; then
	for model in bunny.obj horse.3ds; do
		ok "POV-Ray agrees on $model" same $models/$model
		like "and all of $model is seen" "$(extent s.nff)" '^0.95 0.[0-9]*$|^0.[0-9]* 0.95$'
	done
	is 'all triangles of bunny.obj' "$(mesh2nff $models/bunny.obj | grep -c '^p 3')" "$(grep -c '^f' $models/bunny.obj)"
else
	skip 'agreement with POV-Ray on real meshes' "$missing is not there"
fi
# A pane before a bent sheet.
cat >pane.obj <<'END'
mtllib a.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0.2
v -0.5 -0.5 1
v 0.7 -0.5 1
v 0.7 0.5 1
v -0.5 0.5 1
vn 0.3 0 1
vn -0.3 0.1 1
usemtl paint
f 1//1 2//2 3//2 4//1
usemtl glass
f 5 6 7 8
END
if there povray; then ok 'POV-Ray agrees on patches, glass and paint' same pane.obj; else skip 'patches and glass' 'povray is not there'; fi
finish
