#!/bin/sh
# cropworker: words, pictures and values that come out, the tasks of any cut, failures, and that no process and no file
# remains, however it ends.
# shellcheck disable=SC2016  # the commands expand those themselves
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"
needs perl
TMPDIR=$tmp/scratch && export TMPDIR && mkdir scratch || exit 3

# left: prints the directories that were not removed
left() { ls scratch; }
none_left() { [ -z "$(left)" ]; }

# ---- options -------------------------------------------------------------------------------------------------
run cropworker </dev/null
is 'without a command: refused' "$status:$out" 2:
run cropworker -i true
is '-i without -s: refused' "$status:$out" 2:
run cropworker -i -s 0x5 true
is 'a size of 0: refused' "$status:$out" 2:
run cropworker -F 3 true
is '-F without -i: refused' "$status:$out" 2:
printf 'P5 1 1 255\n\100' >one.pgm
echo 'cat "$(dirname "$0")/one.pgm"; echo "$*" >>"$0.said"' >draw
# job WxH WORD ...
job() { size=$1; shift; cropworker -w -i -s "$size" sh "$tmp/draw" "$@" | tail -n 1; }
run cropworker -F 3 -i -w -s 40x30 sh "$tmp/draw" '{x},{y} {w}x{h} {F}'
like '-i: the frame' "$out" '^frame 40 30$'
like '-i: the job' "$out" '^job=[0-9a-f]{32}$'
is '-i: the pixel in the middle was drawn' "$(cat draw.said)" '20,15 1x1 3'
is 'the job depends on the words' "$({ job 40x30 '{x}' && job 40x30 '{y}' && job 40x30 '{x}{x}' && job 40x30 '{x}' '{x}'; } | sort -u | wc -l)" 4
is 'and on the size' "$({ job 40x30 '{x}' && job 30x40 '{x}'; } | sort -u | wc -l)" 2
run cropworker -i -s 40x30 sh -c 'echo broken >&2; exit 1'
is '-i: a command that fails: status 2, and its words' "$status:$out:$(printf '%s' "$err" | grep -c '^sh: broken$')" 2::1
run cropworker -i -s 40x30 ./no-such
is '-i: a command that is not here may be on the hosts' "$status:$(printf '%s' "$err" | grep -c 'it was not tried here')" 0:1

# ---- words ---------------------------------------------------------------------------------------------------
# grey W H: a picture of one colour
grey() { printf 'P5 %d %d 255\n' "$1" "$2"; head -c $(($1 * $2)) /dev/zero; }
cat >say <<'END'
echo "$*" >>"$SAID"
printf 'P5 %d %d 255\n' "$1" "$2"
head -c $(($1 * $2)) /dev/zero
END
SAID=$tmp/said && export SAID
printf 'frame 7 40 30\ntask 7 0 8 4 5 6 1 1\n' >tile.task
run cropworker -w sh say '{w}' '{h}' '{x},{y}' '{x1},{y1}-{x2},{y2}' '{W}x{H}' 'f{F}.' '{z} {x }{' "a b'\$" <tile.task
is 'words: numbers replaced, the rest left' "$status:$(cat said)" "0:5 6 8,4 9,5-13,10 40x30 f7. {z} {x }{ a b'\$"
cp .out seven.frags
run gather -o f.png seven.frags
like 'the pixels of the task, and no others' "$err" '1170 of 1200 pixels missing'

# ---- pictures --------------------------------------------------------------------------------------------------
# A ramp with all values of a byte, and another with all of 16 bits; drawn by any rectangle, as PGM or PPM.
cat >draw.pl <<'END'
my ($max, $frame_w, $x, $y, $w, $h) = @ARGV;
binmode STDOUT;
print "P6 $w $h $max\n";
for my $j ($y .. $y + $h - 1) {
	for my $i ($x .. $x + $w - 1) {
		my $p = ($j * $frame_w + $i) % ($max + 1);
		print pack $max > 255 ? "n3" : "C3", $p, $p * 7 % ($max + 1), $max - $p;
	}
}
END
perl draw.pl 255 32 0 0 32 24 >whole8.ppm
perl draw.pl 65535 256 0 0 256 256 >whole16.ppm
# png: the PPM at standard input as a PNG
cat >png.pl <<'END'
use Compress::Zlib;
binmode $_ for *STDIN, *STDOUT;
my (undef, $w, $h, $max) = split ' ', <>;
local $/;
my $rest = <>;
my $row = length($rest) / $h;
sub chunk { my $body = join '', @_; pack('N', length($body) - 4) . $body . pack 'N', crc32($body) }
print "\211PNG\r\n\032\n", chunk('IHDR', pack 'NNC5', $w, $h, $max > 255 ? 16 : 8, 2, 0, 0, 0),
	chunk('IDAT', compress(join '', map { "\0" . substr $rest, $_ * $row, $row } 0 .. $h - 1)), chunk('IEND');
END
perl png.pl <whole8.ppm >whole8.png
same() { imgcmp "$1" "$2" 2>&1 | grep differing; }
for cut in row tile:16x7 run:50 scatter guided; do
	partition -u "$cut" -n 3 32x24 | fan -j 3 cropworker perl draw.pl 255 32 '{x}' '{y}' '{w}' '{h}' | gather -o got.png
	is "8 bits, $cut: all 256 values come out as they went in" "$(same got.png whole8.png)" 'differing	0'
done
partition -u tile:256x64 256x256 | fan -j 2 cropworker -g linear perl draw.pl 65535 256 '{x}' '{y}' '{w}' '{h}' | gather -k 16 -o got.pam
{ printf 'P7\nWIDTH 256\nHEIGHT 256\nDEPTH 3\nMAXVAL 65535\nTUPLTYPE RGB\nENDHDR\n'; tail -c $((256 * 256 * 6)) whole16.ppm; } >whole16.pam
ok '16 bits: all 65536 values come out as they went in' cmp got.pam whole16.pam
for picture in whole8.png whole8.ppm; do
	partition -u tile:9x9 32x24 | fan -j 2 cropworker cat "$tmp/$picture" | gather -o got.png
	is "$picture: a picture of the whole frame" "$(same got.png whole8.png)" 'differing	0'
done
perl png.pl <whole16.ppm >sixteen.png
partition -u tile:100x100 256x256 | fan -j 2 cropworker -g linear cp "$tmp/sixteen.png" '{o}' | gather -k 16 -o got.png
is '{o}: a PNG of 16 bits' "$(same got.png whole16.ppm)" 'differing	0'
# 32768 of 65535 is 128 of 255 in sRGB, and 188 if it is linear.
printf 'P5 4 3 65535\n' >deep.pgm
printf '\200\0\200\0\200\0\200\0\200\0\200\0\200\0\200\0\200\0\200\0\200\0\200\0' >>deep.pgm
for curve in srgb:128 linear:188; do
	partition 4x3 | cropworker -g ${curve%:*} cat "$tmp/deep.pgm" | gather -o got.pam
	is "-g ${curve%:*}: what 16 bits hold" "$(tail -c 3 got.pam | od -An -tu1 | tr -d ' ')" "${curve#*:}${curve#*:}${curve#*:}"
done
is 'the job depends on -g' "$({ cropworker -g srgb -i -s 4x3 cat deep.pgm && cropworker -g linear -i -s 4x3 cat deep.pgm; } |
	grep job= | sort -u | wc -l)" 2
run cropworker -g gamma cat deep.pgm
is '-g: two curves, and no other' "$status $err" '2 cropworker: -g gamma: expected srgb or linear'
is '{o}: standard output is dropped' "$(partition 32x24 | cropworker sh -c 'echo noise; cp "$0" "$1"' "$tmp/whole8.png" '{o}' |
	gather -o got.png && same got.png whole8.png)" 'differing	0'
printf 'frame 0 512 300\ntask 0 0 0 0 512 300 1 1\n' >one.task
cat >count.pl <<'END'
open my $f, '>>', 'counted'; print $f "x\n"; close $f;
exec 'perl', 'draw.pl', @ARGV;
END
cropworker -w -f 1000 perl count.pl 255 512 '{x}' '{y}' '{w}' '{h}' <one.task | gather -o got.png
perl draw.pl 255 512 0 0 512 300 >whole.ppm
is 'a task of several fragments is drawn once' "$(wc -l <counted | tr -d ' '):$(imgcmp got.png whole.ppm | grep differing)" \
	'1:differing	0'

# ---- Ghostscript: text, a curve, a line of one pixel, an image, drawn by any rectangle ---------------------------
cat >page.ps <<'END'
%!PS
/Times-Roman findfont 20 scalefont setfont
.2 .4 .8 setrgbcolor 10 10 moveto (Stormring) show
0 .6 .3 setrgbcolor 15.1 50.3 moveto 95 30.1 75.4 70.2 5.2 72.7 curveto fill
0 0 0 setrgbcolor 0 setlinewidth 0 0 moveto 100 75 lineto stroke
gsave 60.3 5.2 translate 33 21 scale 8 4 8 [8 0 0 4 0 0] {<00ff40c0107fe02000ff40c0107fe020>} image grestore
showpage
END
cat >page <<'END'
exec gs -q -sDEVICE=ppmraw -r144 "-g$3x$4" -o - -c "<</PageOffset [$1 neg 2 div $5 $2 sub $4 sub 2 div]>> setpagedevice" -f page.ps
END
if there gs; then
	sh page 0 0 200 150 150 >whole.ppm
	ok 'Ghostscript: the page is not empty' test "$(tail -c 90000 whole.ppm | od -An -v -tx1 -w3 | sort -u | wc -l)" -gt 8
	# A row is a run of Ghostscript.
	for cut in tile:200x7 tile:67x59 scatter ${NIGHT:+row}; do
		partition -u $cut -n 3 200x150 | deal fan -j 2 cropworker sh page '{x}' '{y}' '{w}' '{h}' '{H}' | gather -o got.png
		is "Ghostscript, $cut: the same pixels" "$(same got.png whole.ppm)" 'differing	0'
	done
else skip 'Ghostscript' 'gs is not there'
fi

# ---- files -----------------------------------------------------------------------------------------------------
run cropworker true <<END
files bytes=0

END
is 'files without {i}: refused' "$status:$(printf '%s' "$err" | grep -c 'no state records')" 2:1
run cropworker true '{i}' <one.task
is '{i} without files: refused' "$status:$(printf '%s' "$err" | grep -c 'expected a .files. record')" 2:1
if cropworker -i -s 4x4 true '{i}' </dev/null 2>&1 | grep -q 'without libarchive' || pack files draw.pl 2>&1 | grep -aq 'without libarchive'; then
	skip 'packed files' 'built without libarchive'
else
	mkdir packed packed/sub
	cp draw.pl packed/main.pl
	cp whole8.png packed/sub/whole.png
	pack files packed/main.pl packed/sub/whole.png >packed.task
	{ cat packed.task; partition -u tile:16x16 32x24; } >files.task
	deal fan -1 -j 2 cropworker perl '{i}' 255 32 '{x}' '{y}' '{w}' '{h}' <files.task | gather -o got.png
	is '{i}: the first file' "$(same got.png whole8.png)" 'differing	0'
	deal fan -j 2 cropworker sh -c 'cp sub/whole.png "$0" && cat "$1" >/dev/null' '{o}' '{i}' <files.task | gather -o got.png
	is 'the command runs among the files' "$(same got.png whole8.png)" 'differing	0'
	is 'the job depends on the files' "$({
		cropworker -i -s 9x9 perl '{i}' 255 9 '{x}' '{y}' '{w}' '{h}' <packed.task
		echo '#' >>packed/main.pl
		pack files packed/main.pl packed/sub/whole.png | cropworker -i -s 9x9 perl '{i}' 255 9 '{x}' '{y}' '{w}' '{h}'
	} | grep job= | sort -u | wc -l)" 2
	# Two states, and tasks of both, again in the end: each with its own files.
	{ cat packed.task; printf 'frame 0 8 8\ntask 0 0 0 0 8 8 1 1\n'; pack files packed/sub/whole.png one.pgm 2>/dev/null || pack files one.pgm
		printf 'frame 1 1 1\ntask 1 0 0 0 1 1 1 1\ntask 0 1 0 0 8 8 1 1\n'; } >two.task
	run cropworker sh -c 'case $1 in *.pl) shift; perl main.pl "$@" ;; *) cat "$1" ;; esac' sh '{i}' 255 8 '{x}' '{y}' '{w}' '{h}' <two.task
	is 'two states: each task has the files of its own' "$status:$(grep -ac '^frag' .out)" 0:3
	{ printf 'files bytes=1024\n'; head -c 1024 /dev/zero; echo; cat one.task; } >hostile.task
	run cropworker true '{i}' <hostile.task
	like 'an archive without files is refused' "$status $err" '^2 .*has no file'
fi

# ---- what a command may write ------------------------------------------------------------------------------------
# The command says what was possible. In a kernel without Landlock all is, as with -w, and a line says so.
compile landlock
cat >tries <<'END'
try() { if (eval "$2") >/dev/null 2>&1; then did="$did $1"; fi; }
cd "$1" || exit
did=''
try read 'cat old'
try own ': >"$OUT"'
try temporary 'rm "$(mktemp -p "$TMPDIR")"'
try null ': >/dev/null'
try make ': >new'
try append 'echo >>old'
try link 'ln old "$OUT.hard" && echo >>"$OUT.hard"'
try symlink 'ln -s "$PWD/old" "$OUT.soft" && echo >>"$OUT.soft"'
try rename 'mv old older && mv older old'
try remove 'rm old'
try mkdir 'mkdir dir'
echo "$did" >&2
exit 1
END
printf 'P5 8 8 255\n%064d' 0 >eight.pgm
partition -u tile:4x4 8x8 >eight.task
# tries COMMAND ...: what a command of this worker can do in a directory that is not its own
tries() {
	rm -rf outside && mkdir outside && echo old >outside/old
	run "$@" sh -c 'OUT=$1 sh "$0" "$2"' "$tmp/tries" '{o}' "$tmp/outside" <eight.task
	possible=$(printf '%s\n' "$err" | sed -n 's/^sh:  *//p' | head -n 1)
}
all='read own temporary null make append link symlink rename remove mkdir'
said='^cropworker: no Landlock in this kernel: the command can write all files of this account$'
tries ./landlock cropworker
is 'a kernel without Landlock: the command can write anywhere' "$possible" "$all"
is 'without Landlock: one line says so' "$(printf '%s\n' "$err" | grep -c "$said")" 1
./landlock deal fan -1 -j 3 cropworker cat "$tmp/eight.pgm" <eight.task 2>err | gather -o got.png
is 'without Landlock: the same picture, and one line of all slots and tasks' "$(same got.png eight.pgm) $(grep -c . err) $(grep -c "$said" err)" \
	'differing	0 1 1'
tries ./landlock cropworker -w
is '-w: without that line' "$possible:$(printf '%s\n' "$err" | grep -c Landlock)" "$all:0"
tries cropworker -w
is '-w: the command can write anywhere' "$possible" "$all"
tries cropworker
if [ "$(./landlock)" = 0 ]; then
	is 'a command cannot write outside of its directories' "$possible:$(printf '%s\n' "$err" | grep -c "$said")" "$all:1"
else
	is 'a command cannot write outside of its directories' "$possible:$(cat outside/old):$(ls outside)" 'read own temporary null:old:old'
	deal fan -1 -j 3 cropworker sh -c 'cat "$0" >/dev/stdout' "$tmp/eight.pgm" <eight.task 2>err | gather -o got.png
	is 'and its standard output is open, without a message' "$(same got.png eight.pgm) $(cat err)" 'differing	0 '
	run cropworker sh -c 'echo "${TMPDIR##*/}" >&2; exit 1' <eight.task
	like 'its TMPDIR is a directory of the task' "$err" '^sh: task-[0-9A-Za-z]+$'
fi

# ---- failures --------------------------------------------------------------------------------------------------
printf 'frame 0 8 8\ntask 0 0 2 1 4 3 1 1\n' >small.task
# fails NAME ERE COMMAND ...: the task fails with this message
fails() {
	name=$1 why=$2
	shift 2
	run cropworker "$@" <small.task
	like "$name: status 1, and the reason" "$status $(printf '%s' "$err" | tr '\n' '|')" "^1 .*cropworker: frame 0, rectangle 2,1 4x3: .*$why"
	is "$name: no pixels" "$(grep -c '^frag' "$tmp/.out")" 0
}
fails 'a command that is not there' 'no-such: exit status 127' ./no-such
fails 'a command that fails' 'sh: exit status 5, expected 0' sh -c 'echo last words >&2; exit 5'
like 'the last words of its standard error' "$err" '^sh: last words$'
fails 'a command that fails as perl does' 'sh: exit status 255, expected 0' sh -c 'exit 255'
fails 'a command that is killed' 'sh: ended by signal 9' sh -c 'kill -9 $$'
fails 'no picture' 'the command.s standard output: empty, expected' true
fails 'no picture in {o}' 'the file .o.: No such file' true '{o}'
fails 'no picture but text' '.*unknown picture format' echo hello
for deep in deep.pgm sixteen.png; do
	fails "16 bits that do not state their curve: $deep" "16 bits that do not state their curve, expected option -g" cat "$tmp/$deep"
done
fails 'a picture that is cut off' '.*standard output' sh -c 'head -c 900 "$0"' "$tmp/whole8.ppm"
printf 'Pf\n4 3\n-1\n%032d\0\0\300\177%012d' 0 0 >nan.pfm
fails 'a picture with a pixel that is no number' "the command's standard output: pixel 0,0 is NaN, expected numbers" cat "$tmp/nan.pfm"
fails 'a picture of another size' 'a picture of 32x24, expected 4x3 or the whole frame, 8x8' cat "$tmp/whole8.png"
fails 'output without end' 'more than [0-9]* bytes' yes
run cropworker sh -c 'i=0; while [ $((i += 1)) -le 2000 ]; do printf "line %d of text\033[2J\r\n" $i; done >&2; exit 1' <small.task
is 'of much standard error: the last lines, without control characters' "$(printf '%s\n' "$err" | sed -n '1p;8p')" \
	"$(printf 'sh: line 1993 of text\\x1b[2J\nsh: line 2000 of text\\x1b[2J')"
is 'and no others' "$(printf '%s\n' "$err" | wc -l | tr -d ' ')" 9
cat >once <<'END'
mkdir "$SAID.$3" 2>/dev/null && { echo not yet >&2; exit 1; }
printf 'P6 %d %d 255\n' "$1" "$2"
head -c $(($1 * $2 * 3)) /dev/zero
END
partition -u tile:16x16 32x24 >tiles.task
deal -q 0 fan -1 -j 2 cropworker -w sh once '{w}' '{h}' '{x},{y}' <tiles.task 2>said | gather -o got.png
is 'commands that fail once: tried again' "$(grep -c 'not yet' said):$(imgcmp got.png got.png | grep size)" '4:size	32x24'
run deal -e fan -1 -j 2 cropworker sh -c 'echo no >&2; exit 1' <tiles.task
is 'commands that always fail: all is given up' "$status:$(printf '%s\n' "$err" | grep -cE '^deal: frame 0: given up, because .*, as over [0-9x]+[+][0-9+]+: ')" 1:1
like 'and with the reason' "$err" 'rectangle 0,0 16x16: sh: exit status 1'

# ---- ends ------------------------------------------------------------------------------------------------------
ok 'all directories are removed' await 5 none_left
cat >sleeper <<'END'
sleep 10000 &
echo >>"$SAID"
sleep 10001
END
sleeping() { [ "$(program sleep | wc -l)" -ge "$1" ] && [ -n "$(left)" ]; }
# ends NAME SIGNAL COMMAND ...: the command has workers with two sleeping commands; the signal ends all processes
ends() {
	name=$1 signal=$2
	shift 2
	MARK=$mark "$@" <tiles.task >/dev/null 2>&1 &
	ok "$name: at work" await 10 sleeping 4
	kill -"$signal" $!
	wait $! 2>/dev/null
	ok "$name: no process remains" await 10 none_alive
	ok "$name: no file remains" await 10 none_left
}
for signal in TERM KILL; do
	ends "SIG$signal to a worker of two slots" "$signal" cropworker -w -j 2 sh sleeper
	ends "SIG$signal to fan" "$signal" fan -j 2 cropworker -w sh sleeper
done
# A kill of all processes that have its name.
MARK=$mark cropworker -w -j 2 sh sleeper <tiles.task >/dev/null 2>&1 &
ok 'two slots at work' await 10 sleeping 4
is 'keepers and the janitor have names of their own, also in the command line' \
	"$(program cropworker | wc -l) $(program cropkeeper cropkeeper | wc -l) $(program cropclean cropclean | wc -l)" '3 2 1'
# shellcheck disable=SC2046  # a word each
kill -9 $(program cropworker)
ok 'kill -9 by name: no process remains' await 10 none_alive
ok 'kill -9 by name: no file remains' await 10 none_left
# The command ends, and what it has started has its standard output.
grey 32 24 >whole.pgm
run env MARK=$mark timeout 800 cropworker sh -c "cat '$tmp/whole.pgm'; sleep 10000 &" <tiles.task
is 'a command that leaves a process: status' "$status" 0
ok 'and nothing remains' await 10 none_alive
run sh -c "timeout 800 cropworker sh -c 'cat $tmp/whole.pgm; sleep 10000 &' <tiles.task 2>said | gather -o left.png && cat said"
is 'and the picture is whole' "$status:$out:$err" 0::
# Not a picture, or more than one.
blend -o one.png whole.pgm && cat one.png one.png >two.png
for bad in 'mkfifo {o}:is no regular file' 'ln -s /dev/zero {o}:is no regular file' 'truncate -s 9999999 {o}:is too long' \
	'cat two.png:[0-9]+ bytes behind the PNG, expected one picture'; do
	run timeout 800 cropworker sh -c "cd '$tmp' && ${bad%:*}" <tiles.task
	like "${bad%:*}: refused" "$status $err" "^1 .*${bad##*:}"
done
# Names of files are bytes.
name=$(printf '\303\274\377.txt')
echo inside >"$name"
run pack files - </dev/null
is 'standard input is no file that is packed' "$status $err" '2 pack: -: No such file or directory'
ok 'a name that is no UTF-8 is packed' sh -c 'LC_ALL=C pack files "$1" >named.files' sh "$name"
cat named.files tiles.task | cropworker sh -c 'grep -q inside {i} && [ "$(echo *)" = "$0" ] && cat "$1"' "$name" "$tmp/whole.pgm" 2>said | gather -o named.png
is 'and unpacked' "$(cat said)$(imgcmp -q named.png left.png || echo differ)" ''
# Two commands at a time, each of which waits for the other one, and writes a file.
cat >apart <<'END'
pwd >>"$1"
echo "$2" >mine
n=0
until [ "$(wc -l <"$1")" -ge 2 ] || [ $((n += 1)) -gt 500 ]; do sleep .02; done
[ "$(cat mine)" = "$2" ] && exec cat "$3"
END
printf 'P5 8 8 255\n%064d' 0 >zeros.pgm
{ pack files zeros.pgm; partition -u tile:8x4 8x8; } | cropworker -w -j 2 sh "$tmp/apart" "$tmp/dirs" '{y}' '{i}' 2>said | gather -o apart.png
is '-j: each slot has a directory of its own' "$(cat said)$(sort -u dirs | wc -l) $(imgcmp apart.png zeros.pgm | grep differing)" '2 differing	0'
ok '-j: no file remains' await 10 none_left
# 200 records of files, of which a worker keeps some. A record for each directory that is there at the end.
for n in $(seq 200); do printf 'P5 8 8 255\n%064d' "$n" >"n.pgm"; pack files n.pgm; partition -F "$n" -u tile:8x4 8x8; done >states.task
{ cat states.task; until [ -e counted ]; do sleep .05; done; } | cropworker -j 2 cat '{i}' 2>said | gather -o 'state%d.pam' &
ok 'many records of files: the last picture comes' await 60 test -e state200.pam
ok 'and the copies of most are removed' sh -c '[ "$(ls scratch/*/ | grep -c -)" -lt 300 ]'
: >counted
wait $!
is 'without a message' "$(cat said)" ''
rm state*.pam
printf 'P7\nWIDTH 1\nHEIGHT 1\nDEPTH 4\nMAXVAL 255\nTUPLTYPE CMYK\nENDHDR\nabcd' >cmyk.pam
run imgcmp cmyk.pam cmyk.pam
like 'a PAM of four inks is no RGBA' "$status $err" '^2 .*no CMYK'
MARK=$mark cropworker -w -j 2 sh sleeper <tiles.task | until [ -e leave ]; do sleep .05; done &
ok 'a reader that leaves: at work' await 10 sleeping 4
touch leave
ok 'a reader that leaves: no process remains' await 10 none_alive
ok 'a reader that leaves: no file remains' await 10 none_left
run env TMPDIR="$tmp/nowhere" cropworker true <small.task
like 'a TMPDIR that is not there' "$status $err" '^3 cropworker: .*/nowhere: cannot make a directory'

finish
