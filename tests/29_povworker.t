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
mkdir -p quotes/in && cp my/scene.pov quotes/in/q.pov && echo >quotes/far && echo >quotes/in/near
printf '// "near"\n#declare s = "http://x"; // "near"\n#declare t = "../far";\n/* http://x */ #declare u = "seen";\n' >>quotes/in/q.pov
echo >quotes/in/seen
is 'names in comments, and outside of the directory, are not sent' "$(povworker -l quotes/in/q.pov 2>said) $(cat said)" \
	'quotes/in/q.pov
quotes/in/seen povworker: quotes/in/q.pov: "../far" is not sent, expected a name without ..'
cp my/scene.pov 'two
lines.pov'
run balance adaptive -s 8x8 -o bad.png 'two
lines.pov'
is 'a name with a line end is refused' "$status:$err" '2:povworker: two?lines.pov: a name with a line end, expected names without'
run balance adaptive -s 8x8 -W '-f 0' -o bad.png my/scene.pov
is 'balance -W with a bad option of the worker: status 2' "$status $err" '2 cropworker: -f 0: expected an integer from 1 to 65536'
run balance adaptive -s 8x8 -W scene.ini -o bad.png my/scene.pov
like 'balance -W with a file' "$status $err" '^2 job: -W scene.ini: expected options of povworker'
mkdir 'my odd' && cp -r my/tex my/inc my/heights.pgm 'my odd'
for odd in "a b" "a;b" "a=b" "a'b" "a[b]"; do
	cp my/scene.pov "my odd/$odd.pov"
	ok "a scene named $odd.pov" povworker -i -s 8x8 "my odd/$odd.pov"
done
for odd in 'a"b' 'a\b' 'aé'; do
	cp my/scene.pov "my odd/$odd.pov"
	run povworker -l "my odd/$odd.pov"
	like "a scene named $odd.pov, which POV-Ray cannot read" "$status $err" '^2 povworker: my odd/.*: POV-Ray reads no such name, expected ASCII'
done
is 'the scene comes first' "$(cd my && povworker -l scene.pov | head -n 1)" scene.pov
echo >my/more
is 'a further file' "$(povworker -l my/scene.pov my/more | grep -c more)" 1
run povworker -l my/scene.pov more
is 'a file that is not there' "$status:$out" 2:
run povworker -i -s 8x8 my/scene.pov "$root/tests/lib.sh"
like 'a file outside of the scene'"'"'s directory' "$status $err" '^2 .*expected a file below my/'

# POV-Ray sleeps at its start and its end, so what does not depend on each other runs at the same time.
# later NAME COMMAND ...: runs it in the background; result NAME: leaves its $status, $out and $err
later() {
	later=$1
	shift
	{
		"$@" >"$later.out" 2>"$later.err"
		echo $? >"$later.status"
	} &
}
result() { status=$(cat "$1.status") out=$(cat "$1.out") err=$(cat "$1.err"); }
# whole NAME SCENE WORD ...: POV-Ray alone, in NAME.png
whole() {
	name=$1 file=$2
	shift 2
	(cd "$(dirname "$file")" && pov_ray "+I$(basename "$file")" -A +FN -D +WT2 "$@" "+O$tmp/$name.png") >"$name.said" 2>&1 ||
		diag "$(tail -n 3 "$name.said")"
}
# tiles NAME SCENE WORD ...: four tiles by several processes, in NAME.tiles.png
size=48x36 tile=27x19 bits=''
tiles() {
	name=$1 file=$2
	shift 2
	{ povworker -l "$file" | xargs -d '\n' pack files; partition -u tile:$tile $size; } | deal -q 1 fan -1 -j 4 povworker "$@" - |
		gather $bits -o "$name.tiles.png"
}
# pair NAME SCENE WORD ...: both, in the background
pair() {
	whole "$@" "+W${size%x*}" "+H${size#*x}" &
	tiles "$@" &
}
equal() { is "$1: tiles make the same picture" "$(same "$2.tiles.png" "$2.png")" 'differing	0'; }
depends() { is "$1 depends on the cut, as the manual says" "$(same "$2.tiles.png" "$2.png" | grep -c '	0$')" 0; }

cp -r my other
echo '// another' >>other/inc/b.inc
whole alone my/scene.pov +W48 +H36 &
whole alone9 my/scene.pov +W48 +H9 &
later got balance adaptive -j 2 -s 48x36 -r my.log -o got.png my/scene.pov
later rows balance masterslave -1 -j 4 -s 48x9 -o rows.png my/scene.pov
later auto balance auto -j 2 -s 48x9 -o auto.png my/scene.pov
mkdir -p 'A=1' && cp -r my/. 'A=1'
later sign balance adaptive -j 2 -s 48x9 -o sign.png A=1/scene.pov
later job1 povworker -i -s 48x36 my/scene.pov
later job2 povworker -i -s 48x36 other/scene.pov
later job3 povworker -i -s 48x36 +A0.3 +AM2 other/scene.pov
wait
result got
is 'balance: exit 0 in silence' "$status:$out$(echo "$err" | grep -v 'never connected$')" 0:
is 'balance: the same picture as of POV-Ray alone' "$(same got.png alone.png)" 'differing	0'
result rows
is 'balance masterslave: rows' "$status:$(same rows.png alone9.png)" '0:differing	0'
result sign
is 'balance: a scene whose name has =' "$status:$(same sign.png alone9.png)" '0:differing	0'
result auto
is 'balance auto: the same picture' "$status:$(same auto.png alone9.png)" '0:differing	0'
is 'balance auto: adaptive, without a simulation' "$(echo "$err" | grep -v 'never connected$')" ''
ok 'no file remains' await 5 none_left
is 'the job depends on all files' "$(cat job[123].out | grep job= | sort -u | wc -l | tr -d ' ')" 3

# ---- resumes, animations, scenes that POV-Ray refuses ---------------------------------------------------------
head -c $(($(wc -c <my.log) / 2)) my.log >part.log
cp my.log whole.log
echo 'sphere { 0, ' >bad.pov
later again balance adaptive -j 2 -s 48x36 -r my.log -o again.png other/scene.pov
later resumed balance adaptive -j 2 -s 48x36 -r part.log -o resumed.png my/scene.pov
later complete balance adaptive -j 2 -s 48x36 -r whole.log -o complete.png my/scene.pov
later film balance adaptive -j 2 -s 32x24 -W '+KFI3 +KFF5' -o film%02d.png my/scene.pov
later one balance adaptive -j 2 -s 32x24 -W '+KFF5' -o one.png my/scene.pov
later third balance adaptive -j 2 -s 32x24 -W '+kfi3' -o third.png my/scene.pov
later ini balance adaptive -j 2 -s 32x24 -W 'Initial_Frame=3 final_frame=5' -o ini%02d.png my/scene.pov
printf 'Output_File_Type=P\nBits_Per_Color=16\nFile_Gamma=2.2\nInput_File_Name=inc/b.inc\n' >my/more.ini
later more balance adaptive -j 2 -s 48x36 -W Include_Ini=more.ini -o more.pfm my/scene.pov my/more.ini
later preview balance adaptive -j 2 -s 80x60 -W +SP8 -o preview.png my/scene.pov
later bad balance adaptive -j 2 -s 32x24 -o bad.png bad.pov
for frame in 3 4 5; do whole frame$frame- my/scene.pov +W32 +H24 +KFI3 +KFF5 +SF$frame +EF$frame & done
whole third- my/scene.pov +W32 +H24 +KFI3 &
whole preview- my/scene.pov +W80 +H60 +SP8 &
wait
result again
like 'a log of other files is refused' "$status $err" '^[23] .*(job|state|scene)'
result resumed
is 'a torn log: resumed' "$status:$(same resumed.png alone.png)" '0:differing	0'
result complete
is 'a complete log: nothing is rendered' "$status:$(same complete.png alone.png)" '0:differing	0'
result film
is 'an animation: a picture for each frame, with POV-Ray'"'"'s numbers' "$status:$(echo film*.png)" \
	'0:film03.png film04.png film05.png'
for frame in 3 4 5; do
	is "frame $frame: that of POV-Ray alone" "$(same film0$frame.png frame$frame-*.png)" 'differing	0'
done
result third
is '+KFI alone: one picture, that of POV-Ray alone' "$status:$(same third.png third-*.png)" '0:differing	0'
result preview
is 'a mosaic preview: the picture of POV-Ray alone' "$status:$(same preview.png preview-*.png)" '0:differing	0'
result ini
is 'frames in words with =' "$status:$(cmp ini03.png film03.png && cmp ini05.png film05.png && echo ini*.png)" '0:ini03.png ini04.png ini05.png'
for n in 1 4; do seq "$n" | sed 's/.*/frame & 64 48/' >list$n; done
mkdir cuts && printf '#!/bin/sh\nprintf "%%s " "$2" >>"$CUTS"\n' >cuts/partition && chmod +x cuts/partition
for frames in 64x48 64x48@list1 64x48@list4; do
	CUTS=$tmp/cuts/all PATH=$tmp/cuts:$PATH balance-adaptive "$frames" 3 /dev/null true povworker x </dev/null >/dev/null 2>&1
done
is 'two bands for each slot in all frames' "$(cat cuts/all)" 'tile:64x8:1 tile:64x8:1 tile:64x24 '
is 'the frames differ' "$(same film03.png film05.png | grep -c '	0$')" 0
result one
like 'an animation with one name is refused' "$status $err" '^2 .*5 pictures, expected -o with %d'
result bad
like 'a scene that POV-Ray refuses: status 2 before the run' "$status $err" '^2 .*'
like 'and its reason' "$err" 'Parse Error'
ok 'and no picture' [ ! -e bad.png ]
# POV-Ray is only on the host.
mkdir without
ln -s /usr/bin/* /bin/* without 2>/dev/null
rm without/povray
printf '#!/bin/sh\nPATH=$FULL exec sh -c "$1"\n' >with && chmod +x with
echo 'h slots=2 via="./with %c"' >hosts
run env FULL="$PATH" PATH="$BIN:$tmp/without" balance adaptive -S hosts -s 48x9 -o away.png my/scene.pov
is 'POV-Ray is only on the host: the same picture' "$status:$(same away.png alone9.png)" '0:differing	0'
like 'and a message' "$err" 'povray.*it was not tried here$'
run povworker -i +KFI5 +KFF3 my/scene.pov
is 'frames that end before they begin' "$status:$out" 2:
run povworker -i +SF2 +KFF3 my/scene.pov
like 'a share of the frames is refused' "$status $err" '^2 povworker: [+]SF2: expected [+]KFI and [+]KFF'
is 'numbers of frames are decimal' "$(povworker -i +KFI008 +KFF010 my/scene.pov | sed -n 's/^frame //p' | tr '\n' ' ')" \
	'640 480 8 640 480 9 640 480 10 '
run povworker -i -s 8x8 +KFF99999999 my/scene.pov
like 'too many frames are refused' "$status $err" '^2 povworker: .*expected at most 1048576 frames'
for step in Frame_Step=2 +stp2; do
	run povworker -i $step +KFF3 my/scene.pov
	like 'steps of frames are refused' "$status $err" "^2 povworker: [$step]+: expected [+]KFI and [+]KFF"
done
for word in +FP16 +fp +FT +F8 Output_File_Type=p; do
	run povworker -i $word my/scene.pov
	like "$word: only PNG states its curve" "$status $err" "^2 povworker: [$word]+: expected [+]FN, [+]FN8 or [+]FN16"
done
for word in +w80 +H60 Height=60 +SC0.5 +er9 +e9 End_Row=0.5 +oa.png Output_File_Name=a.png output_to_file=off +Iother.pov Input_File_Name=other.pov; do
	run povworker -i $word my/scene.pov
	like "$word is povworker's" "$status $err" "^2 povworker: [$word]+: expected "
done
run povworker -i +KFFx my/scene.pov
is 'a frame that is no number' "$status:$out" 2:

# ---- scenes of POV-Ray's own examples, and settings: those of which the manual says that the cut does not matter --------
scenes='advanced/teapot/teapot incdemo/woods/wood_7 advanced/sombrero'
settings='+A0.05_+AM2 +A0.05_+AM2_Jitter=off +Q5 Declare=light=0.5'
for scene in $scenes; do
	[ ! -e $examples/$scene.pov ] || pair "$(basename $scene)" $examples/$scene.pov
done
n=0
for words in $settings; do
	# shellcheck disable=SC2046  # a word each
	pair settings$((n += 1)) my/scene.pov $(echo "$words" | tr _ ' ')
done
wait
for scene in $scenes; do
	if [ -e $examples/$scene.pov ]; then equal "$scene" "$(basename $scene)"
	else skip "$scene" "povray-examples is not there"
	fi
done
n=0
for words in $settings; do equal "$(echo "$words" | tr _ ' ')" settings$((n += 1)); done
cat >my/light.pov <<'END'
#version 3.7;
global_settings { assumed_gamma 1 #if (what = 1) photons { count 2000 } #end }
camera { location <0, 2, -4> look_at 0 right x * image_width / image_height
	#if (what = 2) focal_point 0 aperture .3 blur_samples 9 #end }
light_source { <3, 5, -5> rgb 1 #if (what = 3) area_light x, y, 3, 3 #end }
sphere { 0, 1 pigment { rgbt 1 } interior { ior 1.5 } photons { target refraction on } }
plane { y, -1 pigment { checker rgb 1 rgb <.2, .3, .4> } }
END
# A sheet above the floor that the camera does not see; its height falls from .0016 to .0002 down the picture.
cat >my/near.pov <<'END'
#version 3.7;
global_settings { assumed_gamma 1 }
camera { orthographic location 10 * y look_at 0 sky z up y * .75 right x }
light_source { 1000 * y rgb 1 }
plane { y, 0 pigment { rgb 1 } }
plane { <0, 1, -.002>, .0009 pigment { rgb 1 } no_image }
END
for what in 1 2 3; do pair light$what my/light.pov Declare=what=$what; done
bits='-k 16'
pair bits my/scene.pov +FN16 File_Gamma=1
bits=''
pair am1 my/scene.pov +A0.05 +AM1
pair near my/near.pov +WT1
size=48x64 tile=48x32
pair bands my/scene.pov +A0.05 +AM1
wait
equal photons light1
equal 'focal blur' light2
equal 'an area light' light3
is '+FN16 File_Gamma=1: tiles make the same picture of 16 bits' "$(same bits.tiles.png bits.png)" 'differing	0'
result more
is 'an ini file of the words: its gamma and bits, but not its format and scene' \
	"$status:$(imgcmp -t 0.0001 more.pfm bits.png | grep '^over	')" '0:over	0'
depends +AM1 am1
is '+AM1: bands of 32 rows make the same picture' "$(same bands.tiles.png bands.png)" 'differing	0'
depends 'the shadow of a surface nearer than 0.001' near

# ---- what a scene may write --------------------------------------------------------------------------------------
compile landlock
mkdir safe && echo 0.25 >old && echo '#declare included = 1;' >old.inc
# pov NAME TEXT: a scene with this text
pov() { printf '#version 3.7; %s camera { location -4*z look_at 0 } sphere { 0, included }\n' "$2" >"safe/$1.pov"; }
pov reads "#fopen F \"$tmp/old\" read #read (F, x1) #fclose F #include \"$tmp/old.inc\""
pov own '#declare included = 1; #fopen F "mine" write #write (F, "1") #fclose F #fopen F "mine" append #write (F, "1") #fclose F
	#fopen F "mine" read #read (F, included) #fclose F'
pov makes "#declare included = 1; #fopen F \"$tmp/made\" write #write (F, 1) #fclose F"
pov appends "#declare included = 1; #fopen F \"$tmp/old\" append #write (F, 1) #fclose F"
pov plain '#declare included = 1;'
later without ./landlock balance adaptive -j 2 -s 8x8 -o without.png safe/reads.pov
for name in reads own makes appends; do later "$name" povworker -i -s 8x8 "safe/$name.pov"; done
later ini povworker -i -s 8x8 "Create_Ini=$tmp/made.ini" safe/plain.pov
wait
result reads
like 'a scene that reads and includes files of other directories' "$status $out" '^0 frame 8 8$'
result own
like 'a scene that writes a file of its own, and reads it' "$status $out" '^0 frame 8 8$'
result without
is 'without Landlock: one line here, one of the workers, and the picture' \
	"$status:$(imgcmp without.png without.png | grep size):$(printf '%s\n' "$err" | grep -v 'never connected$' | sed 's/^\(cropworker: no Landlock\).*/\1/')" \
	'0:size	8x8:cropworker: no Landlock
cropworker: no Landlock'
if [ "$(./landlock)" = 0 ]; then
	result makes
	like 'a scene that writes a file elsewhere' "$status $err" '^0 cropworker: no Landlock in this kernel'
else
	result makes
	like 'a scene that writes a file elsewhere is refused' "$status $err" '^2 '
	like 'and its reason' "$err" 'Cannot open user file'
	result appends
	is 'a scene that appends to a file elsewhere' "$status:$(cat old)" 2:0.25
	is 'Create_Ini elsewhere: no file, nor that of the scene' "$(cat ini.status):$(echo made*)" '2:made*'
fi
run balance adaptive -j 2 -s 8x8 -W -w -o free.png safe/makes.pov
is 'balance -W -w: a scene can write anywhere' "$status:$(cat made)" 0:1

# ---- faults ----------------------------------------------------------------------------------------------------
cat >slow.pov <<'END'
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location -3 * z look_at 0 }
light_source { <3, 5, -5> rgb 1 }
#declare i = 0;
#while (i < 3) sphere { <i - 1, 0, 0>, .4 pigment { rgb <i / 2, 1, .5> } finish { phong i } } #declare i = i + 1; #end
END
whole slow slow.pov +W48 +H36
# A picture of the frame that POV-Ray writes for its first row is black below.
mkdir first
printf '#!/bin/sh\n%s "$@" | tee %s/first.png\n' "$(command -v povray)" "$tmp" >first/povray
chmod +x first/povray
{ pack files slow.pov; printf 'frame 0 48 36\ntask 0 0 0 0 48 1 1 1\n'; } | PATH=$tmp/first:$PATH povworker -w - >first.frags
{ printf 'P5 48 36 255\n'; head -c 1728 /dev/zero; } >black.pgm
is 'the first row is drawn, and no other' "$(same first.png black.pgm)" 'differing	0'
# Renderers of rectangles wait for the file go, so that some are there to be killed.
mkdir held
cat >held/povray <<END
#!/bin/sh
case " \$*" in *' +SC'*) until [ -e '$tmp/go' ]; do sleep .05; done ;; esac
exec $(command -v povray) "\$@"
END
chmod +x held/povray
pack files slow.pov >slow.files
{ cat slow.files; partition -u tile:48x6 48x36; } |
	PATH=$tmp/held:$PATH MARK=$mark deal -q auto -e fan -1 -j 3 povworker - 2>killed.said | gather -o killed.png &
rendering() { [ "$(program povray | wc -l)" -ge 2 ]; }
await 20 rendering
kill -9 "$(program povray | head -n 1)"
await 20 grep -q signal killed.said
await 20 rendering
kill -9 "$(program cropworker | head -n 1)"
: >go
wait $!
is 'a renderer and a worker are killed: the same picture' "$?:$(same killed.png slow.png)" '0:differing	0'
is 'both losses are reported' "$(grep -c signal killed.said)" 2
ok 'no process remains' await 10 none_alive
ok 'no file remains after all' await 10 none_left

finish
