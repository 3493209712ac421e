#!/bin/sh
# A worker with several slots (-j): it loads and builds once, and forks a child for each slot. The picture is the same as
# that of one process, whatever the number of slots, the state changes and the deaths of children.
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"
patient

spdgen -s 2 balls >0.nff
spdgen -s 2 tetra >1.nff
cp "$root/scenes/boat.nff" 2.nff
for f in 0 1 2; do
	partition 60x44 | rtworker $f.nff | gather -o good$f.pfm
	pack scene $f.nff && partition -F $f 60x44
done >film

# renders NAME PARTITION COMMAND ...: one scene
renders() {
	name=$1 cut=$2
	shift 2
	# shellcheck disable=SC2086
	{ pack scene 0.nff; partition $cut 60x44; } >tasks
	run timeout 300 "$@" - <tasks
	is "$name" "$status $(unexpected .err) $(gather -o a.pfm .out 2>&1; echo $?) $(cmp a.pfm good0.pfm 2>&1)" '0  0 '
}
renders 'one slot' '' rtworker -j 1
renders 'two slots' '' rtworker -j 2
renders 'more slots than tasks' '-u tile:60x22' rtworker -j 5
renders 'scattered pixels' '-u scatter -n 7' rtworker -j 3
renders 'tasks for slots, and for slots that do not exist' '-n 5' rtworker -j 3
renders 'pieces' '-u tile:30x11' rtworker -j 3 -f 7
renders 'pixels at the end' '' rtworker -c -j 3
renders 'a policy' '' deal rtworker -j 3
renders 'a policy, pixels at a flush' '' deal -q auto -e rtworker -j 3 -c
renders 'a tree' '' deal fan -j 2 rtworker -j 2
renders 'a tree without a policy' '' fan -j 2 rtworker -j 2
run sh -c '{ partition 60x44; } | rtworker -j 3 0.nff | gather -o a.pfm'
is 'a scene from a file' "$status $(unexpected .err) $(cmp a.pfm good0.pfm 2>&1)" '0  '

# ---- what it says ----------------------------------------------------------------------------------------------
{ pack scene 0.nff; partition 60x44; } >tasks
rtworker -j 3 - <tasks >three
word() { grep -ao "^hello .*" "$1" | tr ' ' '\n' | sed -n "s/^$2=//p"; }
rtworker - <tasks >one
is 'its hello says the number of slots' "$(word three slots)" 3
is 'the self-test is that of one process' "$(word three selftest)" "$(word one selftest)"
lines() { grep -aoE '(done [0-9]+ [0-9]+ |frame 0 60 44 |bye$).*' "$1"; }
is 'it says each done once' "$(lines three | awk '/^done/ { print $3 }' | sort -n | tr '\n' ' ')" "$(seq 0 43 | tr '\n' ' ')"
is 'it announces the frame once, and says bye once' "$(lines three | grep -c '^frame') $(lines three | grep -c '^bye')" '1 1'
is 'it names the slot of each done' "$(lines three | sed -nE 's/^done.* w=([0-9]+) .*/\1/p' | sort -u | tr '\n' ' ')" '0 1 2 '
is 'the job is that of one process' "$(lines three | grep -o 'job=[0-9a-f]*' | head -n 1)" "$(lines one | grep -o 'job=[0-9a-f]*' | head -n 1)"
{ partition -n 3 60x44; } | rtworker -j 3 0.nff >three
is 'a task with to=K is for slot K' "$(lines three | awk '/^done/ { for (i = 4; i <= NF; i++) if ($i ~ /^w=/) print $3 % 3 - substr($i, 3) }' | sort | uniq -c | tr -d ' \n')" 440

# ---- state that changes ----------------------------------------------------------------------------------------
changes() {
	name=$1
	shift
	rm -f f?.pfm
	run timeout 300 sh -c '"$@" - <film | gather -o f%d.pfm' sh "$@"
	is "$name: complete" "$status $(unexpected .err)" '0 '
	for f in 0 1 2; do ok "$name: picture $f" cmp f$f.pfm good$f.pfm; done
}
changes 'three scenes' rtworker -j 3
changes 'three scenes, pixels at the end' rtworker -j 3 -c
changes 'three scenes, a policy' deal -q auto -e rtworker -j 2
changes 'three scenes, a tree' deal fan -j 2 rtworker -c -j 2
{
	pack scene 0.nff && partition 60x44 && partition 20x10
	pack scene 1.nff && partition 60x44 && pack scene 2.nff && pack scene 0.nff && partition 60x44
} >same
run sh -c 'rtworker -j 2 - <same >same.frags'
is 'one number for frames of other sizes and scenes' "$status $(unexpected .err)" '0 '
is 'each is announced' "$(lines same.frags | grep -c '^frame 0 60 44 ')" 3
is 'each task is done' "$(lines same.frags | grep -c '^done')" $((3 * 44 + 10))
run sh -c 'rtworker -c -j 2 - <same >same.frags'
is 'the same, pixels at the end' "$status $(unexpected .err) $(lines same.frags | grep -c '^done')" "0  $((3 * 44 + 10))"
cat >hill.vtk <<'END'
# vtk DataFile Version 3.0
hill
ASCII
DATASET RECTILINEAR_GRID
DIMENSIONS 2 2 2
X_COORDINATES 2 float
0 1
Y_COORDINATES 2 float
0 1
Z_COORDINATES 2 float
0 1
POINT_DATA 8
SCALARS s float 1
LOOKUP_TABLE default
3 2 2 1 1 0 0 0
END
printf '%s\n' 'at .5 .5 .5' 'up 0 0 1' 'angle 40' 'resolution 60 44' 'map 1 1 0 0 0' 'map 3 1 1 0 4' >look
{ cat look; echo from 3 -1 2; } >0.spec
{ cat look; echo from -1 -3 2; } >1.spec
{
	pack grid hill.vtk
	for f in 0 1; do pack spec $f.spec && partition -F $f 60x44; done
} >views
for f in 0 1; do partition 60x44 | vcworker hill.vtk $f.spec | gather -o view$f.pfm; done
rm -f f?.pfm
run sh -c 'vcworker -j 3 - - <views | gather -o f%d.pfm'
is 'a grid and two specifications' "$status $(unexpected .err) $(cmp f0.pfm view0.pfm 2>&1) $(cmp f1.pfm view1.pfm 2>&1)" '0  '' '

# ---- what is refused -------------------------------------------------------------------------------------------
refused() { is "$1: refused" "$status $(printf '%s\n' "$err" | grep -c "$2")" '2 1'; }
run rtworker -j 0 0.nff </dev/null
refused 'no slots' '^rtworker: -j 0: '
{ pack scene 0.nff; echo 'task 0 0 0 0 1 1 1 1'; } >bad
run rtworker -j 2 - <bad
refused 'a task before its frame' 'no such frame'
printf '%s\n' 'frame 0 9 9' 'task 0 0 0 0 1 1 1 1' >bad
run rtworker -j 2 - <bad
refused 'a task without a scene' 'expected a `scene` record before the first task'
echo nonsense >nonsense.nff && { pack scene nonsense.nff; partition 9x9; } >bad
run rtworker -j 2 - <bad
refused 'a bad scene' '^rtworker: scene:1'
{ pack scene 0.nff; echo 'frame 0 60 44 job=0123456789abcdef'; } >bad
run rtworker -j 2 - <bad
refused 'another job' 'expected 0123456789abcdef'
is 'another job is announced before' "$(lines .out | grep -c '^frame 0 60 44 job=')" 1
run rtworker -j 2 - <three
refused 'records of a worker' 'record `hello`'

# ---- ends ------------------------------------------------------------------------------------------------------
# begun SLOTS [OPTION ...]: starts a worker whose input stays open; $worker is its process, and it has done two tasks
begun() {
	slots=$1
	shift
	rm -f in out
	mkfifo in
	MARK=$mark rtworker -j "$slots" "$@" - <in >out 2>said &
	worker=$!
	exec 9>in
	cat tasks >&9
	await 60 computes
}
computes() { [ "$(grep -aoE '^done|done [0-9]+ [0-9]+ cpu' out | wc -l)" -ge 2 ]; }
children() { ps -o pid= --ppid "$worker"; }
# ended: closes the input and waits for the worker
ended() {
	exec 9>&-
	status=0
	wait "$worker" 2>/dev/null || status=$?
}
{ pack scene 2.nff; partition -u tile:10x10 100x80; } >tasks
partition 100x80 | rtworker -a 400 2.nff | gather -o good.pfm
# same: the picture of the last run, and its exit status
same() { echo "$status $(gather -o a.pfm out 2>&1) $(cmp a.pfm good.pfm 2>&1)"; }
over() { ! kill -0 "$worker" 2>&7; }
begun 3 -a 400
# shellcheck disable=SC2046
kill -KILL $(children | head -n 1)
ended
is 'a killed child: the picture' "$(same)" '0  '
is 'a killed child: no other task was lost' "$(grep -cE '^rtworker: slot [0-2]: lost \(signal-9\) with [1-4] tasks, forked again; killed [(]signal 9[)], as the kernel does when memory is short$' said) $(unexpected said | wc -l)" '1 1'
# done_by_number: the number of tasks that are done once, twice, ...
done_by_number() { grep -aoE 'done 0 [0-9]+ ' out | sort | uniq -c | awk '{ n[$1]++ } END { for (i in n) print i, n[i] }'; }
is 'a killed child: each done once' "$(done_by_number)" '1 80'
begun 3 -a 400 -c
# shellcheck disable=SC2046
kill -KILL $(children | tail -n 1)
ended
is 'a killed child that held pixels back' "$(same)" '0  '
is 'a killed child that held pixels back: each done once' "$(done_by_number)" '1 80'
begun 2 -a 400
# shellcheck disable=SC2046
kill -STOP $(children | head -n 1)
ended
is 'a stopped child: the picture' "$(same)" '0  '
like 'a stopped child: a message names it' "$(cat said)" '^rtworker: slot [01]: lost \(silent\) with [1-4] tasks, forked again$'
# An idle child is asked to end; one that holds pixels back must send them.
partition 100x80 | rtworker 2.nff | gather -o plain.pfm
computed() { [ "$(done_by_number)" = '1 80' ]; }
for options in '' -c; do
	# shellcheck disable=SC2086
	begun 2 $options
	await 60 computed
	# shellcheck disable=SC2046
	kill -STOP $(children | head -n 1)
	exec 9>&-
	await 2 over
	kill -0 "$worker" 2>&7 && kill -KILL "$worker"
	ended
	is "a stopped child without work $options: the picture" "$status $(gather -o a.pfm out 2>&1) $(cmp a.pfm plain.pfm 2>&1)" '0  '
done 7>/dev/null
like 'a stopped child that held pixels back: a message names it' "$(cat said)" '^rtworker: slot [01]: lost \(silent\) with [0-9]+ tasks, forked again$'
begun 2 -a 1024 -d 20
failing() {
	for child in $(children); do kill -KILL "$child" 2>&7; done
	[ "$(grep -ac '^fail 0 ' out)" -ge 2 ]
}
ok 'children that die without end: their tasks fail' await 20 failing 7>/dev/null
kill -KILL "$worker"
ended
ok 'children that die without end: no process remains' await 10 none_alive
begun 3 -a 1024
kill -KILL "$worker"
ended
ok 'a killed parent takes its children along' await 10 none_alive
begun 3 -a 1024
kill -TERM "$worker"
ended
is 'a signal ends it' "$status" 143
ok 'a signal ends its children' await 10 none_alive
run sh -c 'MARK=$1 rtworker -j 3 -a 64 - <tasks | head -c 3000 >part' sh "$mark"
ok 'without a reader it ends, and its children' await 10 none_alive

# ---- one copy of the scene -------------------------------------------------------------------------------------
spdgen -s 5 gears >gears.nff
{ pack scene gears.nff; partition 60x44; } >tasks
# pss SLOTS: the memory in KB of the worker and its children, when all tasks are done
pss() {
	begun "$1"
	await 60 all_done
	for process in $worker $(children); do awk '/^Pss:/ { print $2 }' /proc/"$process"/smaps_rollup; done | awk '{ sum += $1 } END { print sum }'
	ended
}
all_done() { [ "$(grep -aoE 'done 0 [0-9]+ ' out | wc -l)" -eq 44 ]; }
one=$(pss 1) eight=$(pss 8)
ok "eight slots need little more memory than one ($one and $eight KB)" test "$eight" -lt $((one * 3 / 2))

# ---- beats -----------------------------------------------------------------------------------------------------
mkfifo slow
rtworker -j 2 - <slow >out &
worker=$!
exec 9>slow
beats() { grep -aq '^beat' out; }
head -c 100000 tasks >&9
ok 'it sends beats while a scene arrives' await 60 beats
tail -c +100001 tasks >&9
ended
is 'and renders it then' "$status $(gather -o a.pfm out 2>&1)" '0 '
finish
