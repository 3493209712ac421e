#!/bin/sh
# blendworker: frames, sizes, files and refusals. By day a small program takes the place of Blender, which is large: it
# draws a ramp. At night Blender itself draws: its picture is that of Blender alone.
. "$(dirname "$0")/lib.sh"
run pack files "$0"
case $err in *'without libarchive'*) echo "1..0 # SKIP pack was built without libarchive"; exit 0 ;; esac
blender=$(command -v blender)
same() { imgcmp "$1" "$2" 2>&1 | grep differing; }

# ---- with a program in its place ---------------------------------------------------------------------------------
# A scene of its kind is a line for the size, one for the frames, and names of files.
mkdir stand
cat >stand/blender <<'END'
#!/bin/sh
case " $* " in *' -b '*' --factory-startup -Y '*) ;; *) echo 'blendworker: settings or Python of the account' >&2; exit 2 ;; esac
while [ "$1" != -Y ]; do shift; done
scene=$2
until [ "$1" = -- ]; do shift; done
shift
! grep '^blendworker: ' "$scene" >&2 || exit 2
case "$(cat "$scene") $*" in *eevee*engine=CYCLES*) ;; *eevee*) exit 2 ;; esac
case $1 in
describe) sed 's/^remark /blendworker: /w /dev/stderr' "$scene" | grep -v ^blendworker >"$2"; echo >>"$DESCRIBED"; exit ;;
esac
grep -q texture tex/a.png || exit 2
echo "${10-} ${11-}" >&2
printf 'P6 %d %d 255\n' "$5" "$6" >"$9"
awk -v f="$2" -v x="$3" -v y="$4" -v w="$5" -v h="$6" 'BEGIN { for (j = y; j < y + h; j++)
	for (i = x; i < x + w; i++) printf "%c%c%c", 33 + i % 90, 33 + j % 90, 65 + f }' >>"$9"
END
chmod +x stand/blender
DESCRIBED=$tmp/described && export DESCRIBED
full=$PATH
PATH=$tmp/stand:$PATH
mkdir -p my/tex && echo texture >my/tex/a.png
printf '64 48\n1 9 3 4\ntex/a.png\n' >my/s.blend
(cd my && blender -b -noaudio --factory-startup -Y s.blend -- render 4 0 0 64 48 64 48 ../whole.ppm) 2>said || diag "$(cat said)"
is 'the files: the scene first, also of -i' "$(blendworker -i my/s.blend | sed -n 's/^input //p' | tr '\n' ' ')$(blendworker -l my/s.blend | tr '\n' ' ')" 'my/s.blend my/tex/a.png my/s.blend my/tex/a.png '
echo >my/more
is 'a further file' "$(blendworker -l my/s.blend my/more | tr '\n' ' ')" 'my/s.blend my/more my/tex/a.png '
is 'the size and frame of the scene' "$(blendworker -i my/s.blend | grep frame)" 'frame 64 48 4'
is 'all frames, with their step' "$(blendworker -i -s 8x8 frames=all my/s.blend | sed -n 's/^frame //p' | tr '\n' ' ')" '8 8 1 8 8 4 8 8 7 '
is 'chosen frames' "$(blendworker -i -s 8x8 frames=08-9 my/s.blend | sed -n 's/^frame //p' | tr '\n' ' ')" '8 8 8 8 8 9 '
rm described
run balance adaptive -j 2 -o got.png my/s.blend
is 'balance: the same picture as in one piece, and one search for files' \
	"$status:$(same got.png whole.ppm):$(wc -l <described | tr -d ' ')" '0:differing	0:1'
run balance auto -j 2 -s 32x24 -W 'frames=3-4 samples=8' -o film%d.png my/s.blend
is 'balance auto: a picture for each frame' "$status:$(echo film*.png)" '0:film3.png film4.png'
run balance adaptive -j 2 -s 32x24 -W frames=3-4 -o one.png my/s.blend
like 'an animation with one name is refused' "$status $err" '^2 .*2 pictures, expected -o with %d'
run balance adaptive -W x.py -o bad.png my/s.blend
like 'balance -W with a file' "$status $err" '^2 job: -W x.py: expected options of blendworker or NAME=VALUE'
printf '64 48\n1 9 3 4\ntex/a.png\nremark x.png is not there\n' >my/lacks.blend
run blendworker -i my/lacks.blend
is 'a remark' "$status:$err" '0:blendworker: x.png is not there'
echo 'blendworker: s.blend: has no camera, expected one' >bad.blend
run balance adaptive -j 2 -o bad.png bad.blend
is 'a scene that is refused: its reason, and no picture' "$status:$err$(ls bad.png 2>/dev/null)" '2:blendworker: s.blend: has no camera, expected one'
cp my/tex/a.png my/tex/eevee.png
printf '64 48\n1 9 4 4\ntex/eevee.png\ntex/a.png\n' >my/e.blend
run balance adaptive -j 2 -W engine=CYCLES -o engine.png my/e.blend
is 'engine=CYCLES holds for the files, too' "$status:$(same engine.png got.png)" '0:differing	0'
for word in frames=3-1 frames=a frames=-1 samples=x samples=9999999 threads=99999 engine=BLENDER_EEVEE other=1; do
	run blendworker -i $word my/s.blend
	like "$word is refused" "$status $err" "^2 blendworker: ($word|[a-z]+=[^ ]*): expected "
done
run blendworker -l none.blend
is 'a file that is not there' "$status:$err" '2:blendworker: none.blend: cannot be read, expected a file'
run blendworker -i my/s.blend "$root/tests/lib.sh"
like 'a file outside of the scene'"'"'s directory' "$status $err" '^2 .*expected a file below my/'
# Blender takes PWD for its directory, also for the name of the scene.
pack files my/s.blend | cropworker -i -s 1x1 awk 'BEGIN { print "PWD [" ENVIRON["PWD"] "]" >"/dev/stderr"; exit 1 }' '{i}' 2>said
like 'PWD does not name another directory' "$(cat said)" '^awk: PWD \[\]$'
# Blender is only on the host.
mkdir without
ln -s /usr/bin/* /bin/* without 2>/dev/null
rm -f without/blender
printf '#!/bin/sh\nPATH=$FULL exec sh -c "$1"\n' >with && chmod +x with
echo 'h slots=2 via="./with %c"' >hosts
run env FULL="$PATH" PATH="$root/bin:$tmp/without" balance adaptive -S hosts -s 64x48 -W frames=4 -o away.png my/s.blend my/tex/a.png
is 'Blender is only on the host: the same picture' "$status:$(same away.png whole.ppm)" '0:differing	0'
like 'and a message' "$err" '^blendworker: blender is not there; my/s.blend was not tried here'
run env PATH="$root/bin:$tmp/without" blendworker -i my/s.blend
is 'without Blender here, the size is needed' "$status $(echo "$err" | tail -n 1)" \
	'2 blendworker: -s: expected the size, because blender is not there'
PATH=$full

# ---- Blender -----------------------------------------------------------------------------------------------------
[ -n "${NIGHT-}" ] || { finish; exit; }
[ -n "$blender" ] || { skip 'pictures of Blender' 'blender is not there'; finish; exit; }
mkdir -p real/tex real/lib outside
# scene NAME PYTHON: saves Blender's first scene, by Cycles with 4 samples, after this Python
scene() {
	TMPDIR=$tmp blender -b -noaudio --factory-startup --python-exit-code 1 --python-expr "
import bpy, os
s = bpy.context.scene; r = s.render; c = s.cycles
r.engine, c.samples, r.resolution_x, r.resolution_y = 'CYCLES', 4, 48, 36
c.use_denoising = c.use_adaptive_sampling = False
def save(name): bpy.ops.wm.save_as_mainfile(filepath=os.path.join('$tmp', name), relative_remap=False)
$2
save('$1')" >said 2>&1 || diag "$(tail -n 5 said)"
}
# alone SCENE TO [FRAME]: Blender's own picture of 16 bits
alone() {
	(cd "$(dirname "$1")" && TMPDIR=$tmp blender -b -noaudio "$(basename "$1")" --python-expr "
import bpy
s = bpy.context.scene; i = s.render.image_settings
i.file_format, i.color_depth = 'PNG', '16'
s.render.use_single_layer = False # the operator alone heeds it
s.render.filepath = '$tmp/$2'; s.frame_set(${3:-s.frame_current}); s.render.dither_intensity = 0
bpy.ops.render.render(write_still=True)") >said 2>&1 || diag "$(tail -n 5 said)"
	# It does not state its curve: cropworker reads it as sRGB.
	partition "$(imgcmp "$2" "$2" 2>/dev/null | awk '$1 == "size" { print $2 }')" | cropworker -g srgb cat "$tmp/$2" | gather -k 16 -o "$2.pfm"
}
texture='
i = bpy.data.images.new("t", 8, 8); i.generated_type = "COLOR_GRID"; i.filepath_raw = "'$tmp'/real/tex/t.png"; i.file_format = "PNG"; i.save()
i.source = "FILE"; i.filepath = "//tex/t.png"
m = bpy.data.materials["Material"]; n = m.node_tree.nodes.new("ShaderNodeTexImage"); n.image = i
m.node_tree.links.new(n.outputs[0], m.node_tree.nodes["Principled BSDF"].inputs[0])'
scene real/lib/part.blend "bpy.data.objects['Cube'].name = 'Part'"
scene real/s.blend "$texture
with bpy.data.libraries.load('$tmp/real/lib/part.blend', link=True, relative=False) as (a, b): b.meshes = ['Cube']
o = bpy.data.objects.new('linked', b.meshes[0]); o.location = 2, 0, 0; s.collection.objects.link(o)
bpy.data.libraries[0].filepath = '//lib/part.blend'
o.keyframe_insert('location', frame=1); o.location = -2, 1, 0; o.keyframe_insert('location', frame=9); s.frame_set(3)"
if there mesh2nff; then
	run mesh2nff real/s.blend
	like 'its mesh for other renderers: refused in terms of the task' "$status:$out:$err" '^2::mesh2nff: .* expected glTF exported by Blender; balance renders the file as it is$'
else
	skip 'its mesh for other renderers' "$missing is not there"
fi
is 'the files of a scene: it, a linked library, and a texture' "$(blendworker -l real/s.blend | sort | tr '\n' ' ')" \
	'real/lib/part.blend real/s.blend real/tex/t.png '
alone real/s.blend alone.png
run balance adaptive -j 2 -k 16 -o got.pfm real/s.blend
is 'balance: the picture of Blender alone' "$status:$err$(same got.pfm alone.png.pfm)" '0:differing	0'
settings='s.camera.data.dof.use_dof = True
r.use_motion_blur = True
r.resolution_x, r.resolution_y, r.resolution_percentage = 100, 57, 29
r.image_settings.color_mode = "BW"
r.film_transparent = True; r.image_settings.color_mode = "RGB"
r.use_single_layer = True; l = s.view_layers.new("empty"); l.layer_collection.children[0].exclude = True; bpy.context.window.view_layer = l'
n=0
while IFS= read -r setting; do
	scene set$((n += 1)).blend "$setting" </dev/null
	alone set$n.blend set$n.png </dev/null
	run balance adaptive -j 2 -k 16 -o set$n.pfm set$n.blend </dev/null
	is "balance: the same picture with $setting" "$status:$(same set$n.pfm set$n.png.pfm)" '0:differing	0'
done <<END
$settings
END
scene eevee.blend 'r.engine = "BLENDER_EEVEE"'
run blendworker -i eevee.blend
like 'Eevee is refused' "$status $err" '^2 blendworker: eevee.blend: is for BLENDER_EEVEE, which needs a display'
run balance adaptive -j 2 -s 32x24 -W engine=CYCLES -o eevee.png eevee.blend
is 'engine=CYCLES renders it' "$status:$(same eevee.png eevee.png)" '0:differing	0'
scene parts.blend 'r.use_border = r.use_freestyle = True'
run blendworker -i parts.blend
like 'its own border and strokes of Freestyle are named' "$status $err" \
	'^0 blendworker: parts.blend: without its own border, whole strokes of Freestyle: rectangles are drawn alone$'
scene blind.blend 's.camera = None'
run blendworker -i blind.blend
is 'a scene without a camera is refused' "$status:$err" '2:blendworker: blind.blend: has no camera, expected one'
head -c 1000 real/s.blend >torn.blend
run blendworker -i torn.blend
like 'a torn file is refused' "$status $err" '^2 .*cannot be read by Blender'
finish
