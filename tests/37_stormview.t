#!/bin/sh
# stormview: recorded events, faults of the command and of files; then each control once in a window, under Xvfb.
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"
there "$root/bin/stormview" || { echo '1..0 # SKIP stormview is not built'; exit 0; }
unset DISPLAY WAYLAND_DISPLAY

# 24 x 20 x 6 nodes; grid NAME FACTOR NX
grid() {
	awk -v f="$2" -v nx="$3" 'BEGIN {
		print "# vtk DataFile Version 3.0\nspeed [m/s]; x lon [degrees_east]; y lat [degrees_north]; z height [m]\nASCII\nDATASET RECTILINEAR_GRID"
		printf "DIMENSIONS %d 20 6\nX_COORDINATES %d double\n", nx, nx
		for (i = 0; i < nx; i++) printf "%d ", i
		print "\nY_COORDINATES 20 double"
		for (i = 0; i < 20; i++) printf "%d ", i
		print "\nZ_COORDINATES 6 double"
		for (i = 0; i < 6; i++) printf "%d ", i * 1000
		printf "\nPOINT_DATA %d\nSCALARS speed float\nLOOKUP_TABLE default\n", nx * 120
		for (k = 0; k < 6; k++) for (j = 0; j < 20; j++) for (i = 0; i < nx; i++)
			print f * (10 + 8 * sin(i / 4) * cos(j / 5) + k)
	}' >"$1"
}
grid a.vtk 1 24 && grid b.vtk 1.2 24 && grid wide.vtk 1 40
cat >look.spec <<'END'
from -8 -30 25
at 12 10 2
up 0 0 1
angle 40
resolution 96 72
scale 1 1 .002
background .02 .02 .025
palette viridis
map 4 0 0
map 14 .5 .2
map 24 1 .6
iso 16 .9 .2 .1 .7
slice x 6 .5
END
command='deal -q auto -e fan -j 2 vcworker'
# look EVENTS WORD ...: runs stormview with these events, ; between lines, and words before the command
look() {
	printf '%s\n' "$1" | tr ';' '\n' >events
	shift
	# shellcheck disable=SC2086  # several words
	run patiently timeout 1200 stormview -e events -t times "$@" $command
	printf '%s\n' "$out" >said.spec
}
# value NAME: of the table of times
value() { awk -v name="$1" '$1 == name { print $2 }' times; }

# ---- what is shown at rest is what balance writes ------------------------------------------------------------
look '0 drag 20 5;0 move 3 -4;0 wheel 2;0 double 40 30;0 key left;0 key +;0 key 3;0 key tab;0 key .;0 key n;0 key [;0 key l;0 rest;0 png at.png' a.vtk look.spec
is 'recorded events: exit 0' "$status$err" 0
ok 'balance takes the specification that was printed' balance adaptive -j 1 -o of.png a.vtk said.spec
ok 'at rest, the picture is that of balance, bit for bit' cmp at.png of.png
like 'the iso has moved' "$out" '^iso 16[.]'
like 'the slice has moved' "$out" '^slice x 4[.]85 '
like 'there is light' "$out" '^light '
is 'each input is shown: coarsely, and at rest' "$(value inputs) $(value coarse) $(value whole)" '11 11 1'
is 'no pixel comes twice' "$(value again_pixels)" 0

look '0 drag 9 9;0 key 1;0 key home;0 rest' a.vtk look.spec
is 'Home is the first view' "$(head -n 1 said.spec)" 'from -8 -30 25'
look '0 size 61 33;0 rest;0 png small.png' a.vtk look.spec
balance adaptive -j 1 -o of.png a.vtk said.spec
ok 'another size, whose sides are no multiples of 4' cmp small.png of.png
look '0 key space;0 rest;0 png next.png;0 key pageup;0 rest;0 png before.png' a.vtk b.vtk look.spec
balance adaptive -j 1 -o grid%d.png a.vtk b.vtk said.spec
ok 'the next grid' cmp next.png grid1.png
ok 'the grid before' cmp before.png grid0.png
look '0 key space;0 key m;0 key a;0 rest;0 shot shot.png' a.vtk wide.vtk look.spec
is 'a grid of other axes' "$status$err" 0
is 'a map and axes have no background over them' "$(grep -c background said.spec)" 0
run imgcmp shot.png at.png
like 'the legend is below the picture' "$err" 'shot.png has 96x([89]|1..)'
if [ -n "$(command -v gnuplot)" ]; then
	{ grep -v '^iso\|^slice\|^background' look.spec && echo 'slice z 5000 .9'; } >slice.spec
	isolines -z 5000 -e 4 a.vtk >lines
	look '0 rest;0 shot shot.png' -s 480x360 -m lines a.vtk slice.spec
	balance adaptive -j 1 -s 480x360 -m lines -o over.png a.vtk slice.spec
	ok 'isolines of a slice are over it, where balance has them' imgcmp -t .2 -f .003 shot.png over.png
	balance adaptive -j 1 -s 480x360 -m none: -o under.png a.vtk slice.spec
	look '0 key a;0 rest;0 shot bare.png' -s 480x360 -m lines a.vtk slice.spec
	is 'they are there without axes, too' "$status$err" 0
	is 'without them the picture is another one' "$(imgcmp -t .2 -f .003 shot.png under.png >compared; echo $?)" 1
else skip 'isolines of a slice' 'there is no gnuplot'; fi
look '0 rest;0 key ?;0 rest;0 shot help.png;0 key ?;0 rest;0 shot none.png' -s 400x500 a.vtk look.spec
run imgcmp help.png none.png
is 'the help is over the picture' "$status" 1
look '0 key up;0 rest;0 png first.png' -s 96x72 a.vtk
balance adaptive -j 1 -o of.png a.vtk said.spec
ok 'a grid alone has a starter' cmp first.png of.png

spdgen -s 1 gears >gears.nff
command='deal -q auto -e fan -j 2 rtworker'
look '0 drag 9 9;0 wheel -1;0 rest;0 png scene.png' -s 64x64 gears.nff
is 'a scene: exit 0' "$status$err" 0
{ pack scene gears.nff; pack view said.spec; partition 64x64; } | fan -j 1 rtworker - | gather -o of.png
ok 'a scene from another view' cmp scene.png of.png
look '0 rest;0 png again.png' gears.nff said.spec
ok 'a scene and a view' cmp scene.png again.png
command='deal -q auto -e fan -j 2 vcworker'

# ---- files and words -----------------------------------------------------------------------------------------
# refused STATUS MESSAGE WORD ...
refused() {
	expected=$1 why=$2
	shift 2
	run timeout 1200 stormview "$@"
	is "refused: $*" "$status$out" "$expected"
	like "refused: $*: the reason" "$err" "$why"
}
echo '0 rest' >rest
echo 'from 1' >bad.spec
head -c 300 a.vtk >cut.vtk
refused 2 '^usage: stormview ' a.vtk
refused 2 '^usage: stormview ' deal fan vcworker
refused 2 'cut.vtk:' -e rest cut.vtk deal fan vcworker
refused 2 '^stormview: bad.spec:1: ' -e rest a.vtk bad.spec deal fan vcworker
refused 2 'look.spec: is a second view' -e rest a.vtk look.spec look.spec deal fan vcworker
refused 2 '^stormview: nothere: No such file.* expected' -e rest a.vtk nothere
for line in 'x rest' '0 jump' '0 drag 1' '0 drag 1 2 3' '0 key nokey' '0 png' '-1 rest'; do
	printf '%s\n' "$line" >events
	refused 2 '^stormview: events:1: .*expected' -e events a.vtk look.spec deal fan vcworker
done
refused 3 '^stormview: cannot open a display; use balance' a.vtk look.spec deal fan vcworker
run balance view a.vtk nothere.vtk
is 'balance view names a file that is not there' "$status$out" 2
like 'balance view names a file that is not there: the reason' "$err" '^balance: nothere.vtk: is no file'
ln -s nothere kept-1.spec
look '0 key s;0 rest' -o kept a.vtk look.spec
ok 'a name that a link to nothing has is not free' [ -s kept-2.spec ]
look '0 key s;0 rest' -o nothere/kept a.vtk look.spec
is 'a key saves where there is no directory: exit 3' "$status" 3
like 'a key saves where there is no directory: the reason' "$err" '^stormview: nothere/kept-1.spec: No such file'
run sh -c "stormview -e rest a.vtk look.spec $command >/dev/full"
is 'a full disk: exit 3' "$status" 3

# ---- faults of the command -----------------------------------------------------------------------------------
run timeout 1200 stormview -e rest a.vtk look.spec sh -c 'exit 7'
is 'a command that ends: exit 3, and the specification is kept' "$status $(printf '%s\n' "$out" | head -n 1)" '3 from -8 -30 25'
like 'a command that ends: the reason' "$err" '^stormview: sh ended \(exit-7\) before the user did'
run timeout 1200 stormview -e rest a.vtk look.spec sh -c 'echo frame 1 2; cat >/dev/null'
is 'a command that writes something else: exit 3' "$status" 3
like 'a command that writes something else: the reason' "$err" '^stormview: from the command: '
# A worker that ends within its first pixels, once.
printf '%s\n' '#!/bin/sh' 'if mkdir once 2>/dev/null; then vcworker | dd bs=1 count=4000 2>/dev/null; else exec vcworker; fi' >dies
chmod +x dies
run patiently timeout 1200 stormview -e rest -t times a.vtk look.spec deal -q auto -e fan -j 2 ./dies
is 'a worker that dies: the picture is whole' "$status $(value failed_pixels)" '0 0'
# A worker that ends whenever it is given a certain task.
printf '%s\n' '#!/bin/sh' 'while IFS= read -r line; do case $line in "task "?*" 3 "*) kill -9 $$ && exit ;; esac; printf "%s\n" "$line"; done | vcworker' >mortal
chmod +x mortal
printf '%s\n' '0 rest' '0 png lacks.png' >lacks
run patiently in_time stormview -e lacks -t times -s 32x24 a.vtk look.spec deal -q auto -e fan -j 2 ./mortal
ok 'a picture that lacks pixels is not saved' [ ! -e lacks.png ]
like 'a task that costs each worker: it is given up, and the others come' "$status $(value failed_pixels)" '^1 ([1-9][0-9]|[1-4][0-9]{2})$'

for bytes in 20 300 5000; do
	run timeout 1200 stormview -e rest a.vtk look.spec sh -c "deal fan -j 1 vcworker | dd bs=1 count=$bytes 2>/dev/null"
	is "a stream that is cut after $bytes bytes: exit 3" "$status" 3
done
# The page has the controls of the help.
sed -nE 's/^    [{]"([^"]+)", "([^":(]+)[":(].*/\1: \2/p' "$root/lib/viewer/controls.c" >controls
awk '/^[.]Ss Controls/ { on = 1 } on && /^[.]El/ { exit } on && /^[.]It/ { sub(/^[.]It /, ""); name = $0; getline; sub(/[:(].*/, ""); print name ": " $0 }' \
	"$root/man/stormview.1" >page
ok 'the page has the controls of the help' diff controls page
ok 'the controls were found' [ "$(grep -c . page)" -gt 20 ]

# ---- a window ------------------------------------------------------------------------------------------------
there Xvfb xdotool ffmpeg || { skip 'a window' "$missing is not there"; finish; }
Xvfb -noreset -displayfd 3 -screen 0 1000x800x24 -nolisten tcp 3>display 2>/dev/null &
xvfb=$!
trap 'kill $xvfb 2>/dev/null; rm -rf "$tmp"' EXIT
await 10 [ -s display ]
DISPLAY=:$(cat display) && export DISPLAY
# opened WORD ...: starts stormview and waits for its window, whose number is in $window
opened() {
	rm -f status
	# shellcheck disable=SC2086
	{ MARK=$mark patiently stormview "$@" $command >said.spec 2>err; echo $? >status; } &
	await 10 sh -c 'xdotool search --onlyvisible --name "vtk - stormview" >window 2>/dev/null'
	window=$(tail -n 1 window)
	xdotool windowfocus --sync "$window"
}
# on X Y: moves the pointer there
on() { xdotool mousemove --window "$window" "$1" "$2"; }
# keys KEY ...
keys() { xdotool key --delay 30 "$@"; }
saved=0
# saved_as ERE NAME: saves the specification, a line of which matches
saved_as() {
	saved=$((saved + 1))
	keys s
	await 10 [ -s stormview-$saved.spec ]
	like "a window: $2" "$(cat stormview-$saved.spec)" "$1"
}
# shot FILE: what the window shows
shot() {
	eval "$(xdotool getwindowgeometry --shell "$window")"
	ffmpeg -v error -y -f x11grab -draw_mouse 0 -video_size "${WIDTH}x$HEIGHT" -i "$DISPLAY+$X,$Y" -frames:v 1 "$1"
}
# shows PNG: the window shows this picture, when the status over it has gone
shows() { shot shot.png && imgcmp shot.png "$1" >compared; }

opened -s 320x240 a.vtk b.vtk look.spec
keys p
await 10 [ -s stormview-1.png ]
ok 'a window shows the picture that it saves' await 20 shows stormview-1.png
saved_as '^from -8 -30 25$' 'the first view'
on 160 120 && xdotool mousedown 1 && on 200 130 && xdotool mouseup 1
saved_as '^up -?[0-9.]+ -?[0-9.]+ 0[.]' 'drag turns'
keys Home
on 160 120 && xdotool mousedown 3 && on 200 130 && xdotool mouseup 3
saved_as '^at ([02-9]|1[013-9])[.]' 'right drag moves'
keys Home
kill -STOP "$(program stormview)" # it sees the drag when Shift is up again
xdotool keydown shift && on 160 120 && xdotool mousedown 1 && on 200 130 && xdotool mouseup 1 keyup shift
kill -CONT "$(program stormview)"
saved_as '^at ([02-9]|1[013-9])[.]' 'Shift drag moves'
keys Home
on 160 120 && xdotool click 4
saved_as '^from -6[.]' 'the wheel comes closer'
keys Home
on 80 120 && xdotool click --repeat 2 --delay 20 1
saved_as '^at -?([0-9]|1[01])[.]' 'a double click centres'
keys Home Right
saved_as '^up -?[0-9.]+ -?[0-9.]+ 0[.]' 'an arrow turns'
keys Home minus
saved_as '^from -10 -34 27[.]3' 'minus goes back'
keys Home plus
saved_as '^from -6[.]' 'plus comes closer'
keys Home 4
saved_as '^map 4 0 0[.]00604' 'a digit is a palette'
keys Tab
saved_as '^map 4 0[.]05' 'Tab is the next palette'
keys n bracketright
saved_as '^slice x 7[.]15 ' 'n selects a slice, and a bracket moves it'
keys comma
saved_as '^slice x 7[.]035 ' 'a comma moves it a little'
keys l
saved_as '^light ' 'l is light'
keys m
saved_as '^up ' 'm is the map'
is 'a map has no background over it' "$(grep -c background stormview-$saved.spec)" 0
keys a
# higher: the window is
higher() { xdotool getwindowgeometry --shell "$window" >geometry && [ "$(sed -n 's/HEIGHT=//p' geometry)" -gt 240 ]; }
ok 'a makes room for the legend' await 20 higher
keys a m
xdotool keydown v && sleep 1 && xdotool keyup v
await 10 [ -s stormview-1.key ]
is 'v saves a key view, and one as long as it is held' "$(ls stormview-*.key)" stormview-1.key
keys F1
# differs PNG: the window shows something else
differs() { shot shot.png && ! imgcmp shot.png "$1" >compared; }
ok 'F1 shows the help' await 20 differs stormview-1.png
keys F1 space
xdotool windowsize "$window" 300 200
# smaller: the specification is of the new size
smaller() { rm -f stormview-1.spec && keys s && sleep .1 && grep -q '^resolution 300 200$' stormview-1.spec; }
ok 'a window has another size' await 20 smaller
keys Escape
await 20 [ -s status ]
is 'Escape ends: exit 0' "$(cat status err)" 0
ok 'the chosen specification is printed' grep -q '^resolution 300 200$' said.spec

opened -o large -s 3000x2000 a.vtk look.spec
keys s
await 20 [ -s large-1.spec ]
ok 'the picture has the size of a window that has less room' grep -qx 'resolution 1000 800' large-1.spec
if there setxkbmap && setxkbmap ru 2>/dev/null; then
	keys 39 # the key s
	await 20 [ -s large-2.spec ]
	setxkbmap us
	pass 'a key of a Cyrillic keyboard is that of its place'
else skip 'a Cyrillic keyboard' 'there is no setxkbmap'; fi
keys Escape
await 20 [ -s status ]
printf '#!/bin/sh\ncat >/dev/null\n' >mute # its output stays open
chmod +x mute
command=./mute
opened -s 320x240 a.vtk look.spec
# quiet: the title says so
quiet() { xdotool getwindowname "$window" | grep -q 'no pixels for [0-9]* s$'; }
ok 'a command that has no slot: the title says that nothing comes' await 20 quiet
keys Escape
await 20 [ -s status ]
command='deal -q auto -e fan -j 2 vcworker'

opened -s 320x240 a.vtk look.spec
xdotool windowclose "$window"
await 20 [ -s status ]
is 'a window that is closed: no process is left' "$(alive)" ''
opened -s 320x240 a.vtk look.spec
kill "$(program deal)"
await 20 [ -s status ]
is 'a command that is killed: exit 3' "$(cat status)" 3
like 'a command that is killed: the reason' "$(cat err)" 'deal ended \(signal-15\) before the user did'
is 'a command that is killed: no process is left' "$(alive)" ''
opened -s 320x240 a.vtk look.spec
kill "$(program stormview)"
await 20 [ -s status ]
is 'a signal ends it: the specification is printed' "$(cat status):$(head -n 1 said.spec)" '143:from -8 -30 25'
opened -s 320x240 a.vtk look.spec
kill -9 $xvfb
await 20 [ -s status ]
is 'the display is lost: exit 3, and the specification is printed' "$(cat status):$(head -n 1 said.spec)" '3:from -8 -30 25'
is 'the display is lost: no process is left' "$(alive)" ''
finish
