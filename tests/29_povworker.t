#!/bin/sh
# povworker: POV-Ray's pictures come out as POV-Ray draws them alone, however the work is spread; files that a scene names,
# animations, resumes, dead workers, and scenes that POV-Ray refuses.
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"
needs povray
run pack files "$0"
case $err in *'without libarchive'*) echo "1..0 # SKIP pack was built without libarchive"; exit 0 ;; esac
TMPDIR=$tmp/scratch && export TMPDIR && mkdir scratch || exit 3
examples=/usr/share/doc/povray/examples

# same A B: "differing 0" if two pictures have the same pixels
same() { imgcmp "$1" "$2" 2>&1 | grep differing; }
none_left() { [ -z "$(ls scratch)" ]; }

# ---- a scene with all kinds of files -------------------------------------------------------------------------
mkdir my my/tex my/inc
printf 'P6\n2 2\n255\n\377\001\002\003\377\004\005\006\377\377\377\001' >my/tex/a.ppm
printf 'P5\n4 4\n255\n\020\060\020\060\060\020\060\020\020\060\020\060\060\020\060\020' >my/heights.pgm
cat >my/inc/b.inc <<'END'
#declare paint = pigment { image_map { ppm "tex/a.ppm" } scale 2 };
END
cat >my/scene.pov <<'END'
#version 3.7;
#include "colors.inc"
#include "inc/b.inc"
#ifndef (light) #declare light = 1; #end
global_settings { assumed_gamma 1 }
camera { location <0, 2, -4> look_at <0, 0, 0> right x * image_width / image_height }
light_source { <3, 5, -5> White * light }
sphere { <0, 0, 0>, 1 pigment { paint } rotate 90 * clock * y }
height_field { pgm "heights.pgm" translate <-.5, -1.2, -.5> scale <6, 1, 6> pigment { rgb <.3, .8, .4> } }
END
is 'the files of a scene: it, what it includes, and textures' "$(povworker -l my/scene.pov | sort | tr '\n' ' ')" \
	'my/heights.pgm my/inc/b.inc my/scene.pov my/tex/a.ppm '
is 'the scene comes first' "$(cd my && povworker -l scene.pov | head -n 1)" scene.pov
echo >my/more
is 'a further file' "$(povworker -l my/scene.pov my/more | grep -c more)" 1
run povworker -p my/scene.pov more
is 'a file that is not there' "$status:$out" 2:
run povworker -p my/scene.pov "$root/tests/lib.sh"
like 'a file outside of the scene'"'"'s directory' "$status $err" '^2 .*expected a file below my/'

# whole NAME SCENE WORD ...: POV-Ray alone, in NAME.png
whole() {
	name=$1 file=$2
	shift 2
	(cd "$(dirname "$file")" && povray "+I$(basename "$file")" -A +FN "$@" -D +WT2 "+O$tmp/$name.png") >"$name.said" 2>&1 ||
		diag "$(tail -n 3 "$name.said")"
}
whole alone my/scene.pov +W48 +H36
run balance adaptive -j 2 -s 48x36 -r my.log -o got.png my/scene.pov
is 'balance: exit 0 in silence' "$status:$out$err" 0:
is 'balance: the same picture as of POV-Ray alone' "$(same got.png alone.png)" 'differing	0'
run balance masterslave -1 -j 4 -s 48x9 -o rows.png my/scene.pov
whole alone9 my/scene.pov +W48 +H9
is 'balance masterslave: rows' "$status:$(same rows.png alone9.png)" '0:differing	0'
ok 'no file remains' await 5 none_left
is 'the job depends on all files' "$({
	povworker -i -s 48x36 my/scene.pov
	echo '// another' >>my/inc/b.inc
	povworker -i -s 48x36 my/scene.pov
	povworker -i -s 48x36 +A0.3 +AM2 my/scene.pov
} | grep job= | sort -u | wc -l | tr -d ' ')" 3
run balance adaptive -j 2 -s 48x36 -r my.log -o again.png my/scene.pov
like 'a log of other files is refused' "$status $err" '^[23] .*(job|state|scene)'

# ---- resume ----------------------------------------------------------------------------------------------------
sed -i '$d' my/inc/b.inc
head -c $(($(wc -c <my.log) / 2)) my.log >part.log
run balance adaptive -j 2 -s 48x36 -r part.log -o resumed.png my/scene.pov
is 'a torn log: resumed' "$status:$(same resumed.png alone.png)" '0:differing	0'
run balance adaptive -j 2 -s 48x36 -r part.log -o resumed.png my/scene.pov
is 'a complete log: nothing is rendered' "$status:$(same resumed.png alone.png)" '0:differing	0'

# ---- scenes of POV-Ray's own examples, cut into tiles ----------------------------------------------------------
bits=''
# tiles NAME WORD ...: a picture of NAME.files in tiles by several processes
tiles() {
	name=$1
	shift
	{ cat "$name.files"; partition -u tile:23x17 48x36; } | deal -q 1 fan -1 -j 4 povworker "$@" - |
		gather $bits -o "$name.tiles.png"
}
for scene in advanced/teapot/teapot incdemo/woods/wood_7 advanced/sombrero; do
	name=$(basename $scene)
	[ -e $examples/$scene.pov ] || { skip "$scene" "povray-examples is not there"; continue; }
	whole "$name" $examples/$scene.pov +W48 +H36
	povworker -p $examples/$scene.pov >"$name.files"
	tiles "$name"
	is "$scene: tiles make the same picture" "$(same "$name.tiles.png" "$name.png")" 'differing	0'
done

# ---- settings: those of which the manual says that the picture does not depend on the cut ----------------------
povworker -p my/scene.pov >settings.files
bits='-k 16'
whole settings my/scene.pov +W48 +H36 +FN16 File_Gamma=1
tiles settings +FN16 File_Gamma=1
is '+FN16 File_Gamma=1: tiles make the same picture of 16 bits' "$(same settings.tiles.png settings.png)" 'differing	0'
bits=''
for words in '+A0.05 +AM2' '+A0.05 +AM2 Jitter=off' '+Q5' 'Declare=light=0.5'; do
	# shellcheck disable=SC2086  # a word each
	{ whole settings my/scene.pov +W48 +H36 $words; tiles settings $words; }
	is "$words: tiles make the same picture" "$(same settings.tiles.png settings.png)" 'differing	0'
done
cat >my/light.pov <<'END'
#version 3.7;
global_settings { assumed_gamma 1 #if (what = 1) photons { count 2000 } #end }
camera { location <0, 2, -4> look_at 0 right x * image_width / image_height
	#if (what = 2) focal_point 0 aperture .3 blur_samples 9 #end }
light_source { <3, 5, -5> rgb 1 #if (what = 3) area_light x, y, 3, 3 #end }
sphere { 0, 1 pigment { rgbt 1 } interior { ior 1.5 } photons { target refraction on } }
plane { y, -1 pigment { checker rgb 1 rgb <.2, .3, .4> } }
END
povworker -p my/light.pov >settings.files
for what in '1 photons' '2 focal blur' '3 an area light'; do
	whole settings my/light.pov +W48 +H36 "Declare=what=${what%% *}"
	tiles settings "Declare=what=${what%% *}"
	is "${what#* }: tiles make the same picture" "$(same settings.tiles.png settings.png)" 'differing	0'
done
povworker -p my/scene.pov >settings.files
whole settings my/scene.pov +W48 +H36 +A0.05 +AM1
tiles settings +A0.05 +AM1
is '+AM1 depends on the cut, as the manual says' "$(same settings.tiles.png settings.png | grep -c '	0$')" 0

# ---- animations ------------------------------------------------------------------------------------------------
run balance adaptive -j 2 -s 32x24 -W '+KFI3 +KFF5' -o film%02d.png my/scene.pov
is 'an animation: a picture for each frame, with POV-Ray'"'"'s numbers' "$status:$(echo film*)" '0:film03.png film04.png film05.png'
for frame in 03 04 05; do
	whole frame my/scene.pov +W32 +H24 +KFI3 +KFF5 +SF${frame#0} +EF${frame#0}
	is "frame $frame: that of POV-Ray alone" "$(same film$frame.png frame*.png)" 'differing	0'
	rm -f frame*.png
done
is 'the frames differ' "$(same film03.png film05.png | grep -c '	0$')" 0
run balance adaptive -j 2 -s 32x24 -W '+KFF5' -o film.png my/scene.pov
like 'an animation with one name is refused' "$status $err" '^2 .*5 pictures, expected -o with %d'
run povworker -i +KFI5 +KFF3 my/scene.pov
is 'frames that end before they begin' "$status:$out" 2:
run povworker -i +KFFx my/scene.pov
is 'a frame that is no number' "$status:$out" 2:

# ---- faults ----------------------------------------------------------------------------------------------------
echo 'sphere { 0, ' >bad.pov
run balance adaptive -j 2 -s 32x24 -o bad.png bad.pov
like 'a scene that POV-Ray refuses: status 2 before the run' "$status $err" '^2 .*'
like 'and its reason' "$err" 'Parse Error'
ok 'and no picture' [ ! -e bad.png ]
cat >slow.pov <<'END'
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location -3 * z look_at 0 }
light_source { <3, 5, -5> rgb 1 }
#declare i = 0;
#while (i < 3) sphere { <i - 1, 0, 0>, .4 pigment { rgb <i / 2, 1, .5> } finish { phong i } } #declare i = i + 1; #end
END
whole slow slow.pov +W48 +H36
# Renderers of rectangles wait for the file go, so that some are there to be killed.
mkdir held
cat >held/povray <<END
#!/bin/sh
case " \$*" in *' +SC'*) until [ -e '$tmp/go' ]; do sleep .05; done ;; esac
exec $(command -v povray) "\$@"
END
chmod +x held/povray
povworker -p slow.pov >slow.files
{ cat slow.files; partition 48x36; } |
	PATH=$tmp/held:$PATH MARK=$mark deal -q auto -e fan -1 -j 3 povworker - 2>killed.said | gather -o killed.png &
rendering() { [ "$(program povray | wc -l)" -ge 2 ]; }
await 20 rendering
kill -9 "$(program povray | head -n 1)"
await 20 rendering
kill -9 "$(program cropworker | head -n 1)"
: >go
wait $!
is 'a renderer and a worker are killed: the same picture' "$?:$(same killed.png slow.png)" '0:differing	0'
is 'both losses are reported' "$(grep -c signal killed.said)" 2
ok 'no process remains' await 10 none_alive
ok 'no file remains after all' await 10 none_left

finish
