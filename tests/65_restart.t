#!/bin/sh
# Resuming from a log: tasks that are left out, logs that are refused and by which name, the cost of a torn end, a
# second run on the same log, a full disk, the message at Ctrl-C, and kill -9 at random moments.
. "$(dirname "$0")/lib.sh"

# shellcheck disable=SC2154  # lib.sh sets them
cleanup() {
	[ -z "${pid-}" ] || kill -9 "$pid" 2>/dev/null
	[ -z "${mounted-}" ] || umount "$mounted"
	rm -rf "$tmp"
}
trap cleanup EXIT
spdgen -s 2 gears >gears.nff
spdgen -s 2 tetra >tetra.nff
size=96x80
partition $size >all
rtworker gears.nff <all | gather -r whole -o good.pfm

# ---- partition -r ------------------------------------------------------------------------------------------
: >empty
for log in /dev/null missing empty; do
	partition -r $log $size >got
	ok "partition -r $log: everything" cmp got all
done
run partition -r . $size
is 'partition -r of a directory: exit 2' "$status" 2
is 'partition -r of a complete log: only the frame' "$(partition -r whole $size)" "frame 0 96 80"
is 'partition -r: another frame is not there' "$(partition -F 7 -r whole $size | wc -l)" 81
run partition -r whole 64x64
is 'partition -r of another size: exit 2' "$status" 2
like 'partition -r of another size: a message says so' "$err" 'whole: has another size: frame 0 of 96x80 pixels, expected 64x64'
{ head -n 31 all; tail -n 31 all; } | rtworker gears.nff >part
is 'partition -r: the rows that are missing' "$(partition -r part $size | cut -d ' ' -f 3 | tr '\n' ' ')" \
	"96 $(seq -s ' ' 30 48) "
is 'partition -r -n: shares of the missing rows' \
	"$(partition -r part -n 2 $size | head -n 4 | cut -d ' ' -f 3,10 | tr '\n' ' ')" '96 30 to=0 31 to=1 32 to=0 '
is 'partition -r: a tile begins at the first row that lacks something' \
	"$(partition -r part -u tile:90x40 $size | sed -n 2p)" 'task 0 0 0 30 90 10 1 1'
partition -u scatter -n 2 $size | rtworker -f 250 gears.nff | head -c 30000 >part
is 'partition -r: a scattered set begins at the first pixel that is missing' \
	"$(partition -r part -u scatter -n 2 $size | tail -n 2 | tr '\n' ';')" \
	'task 0 0 44 36 2090 1 2 1 to=0;task 0 1 1 0 3840 1 2 1 to=1;'

# ---- the same picture from any beginning of a log ---------------------------------------------------------------
partition 16x4 >tasks
rtworker tetra.nff <tasks | gather -r small -o small.pfm
end=$(wc -c <small) at=0 step=11 bad=''
[ -z "${NIGHT-}" ] || step=3
while [ "$at" -le "$end" ]; do
	rm -f out.pfm
	head -c "$at" small >"cut"
	# Within the first line it may be any text.
	if [ "$at" -gt 0 ] && [ "$at" -lt "$(head -n 1 small | wc -c)" ]; then
		partition -r cut 16x4 >none 2>said && bad="$bad $at:taken"
		rtworker tetra.nff <tasks 2>said | gather -r cut -o out.pfm 2>said && bad="$bad $at:gathered"
		[ "$(wc -c <"cut")" -eq "$at" ] && [ ! -e out.pfm ] || bad="$bad $at:changed"
		at=$((at + step))
		continue
	fi
	partition -r cut 16x4 | rtworker tetra.nff | gather -r cut -o out.pfm 2>said
	[ $? -eq 0 ] && cmp -s out.pfm small.pfm || bad="$bad $at"
	# The resumed log is a good log as well, and has each pixel once.
	gather -P -o again.pfm cut 2>&1 | grep -q 'came twice' && bad="$bad $at:twice"
	cmp -s again.pfm small.pfm || bad="$bad $at:log"
	at=$((at + step))
done
is "cut at every $step of $end bytes: the same picture, no pixel twice; within the first line it is no log" "$bad" ''

# ---- refused by name; the log is unchanged --------------------------------------------------------------------
head -c 60000 whole >log
cp log before
# refused NAME ERE [OPTIONS] SCENE
refused() {
	name=$1 said=$2
	shift 2
	run balance masterslave -j 2 -r log -o out.pfm "$@"
	is "another $name: exit 2" "$status" 2
	like "another $name: a message says so" "$err" "log: $said"
	ok "another $name: the log as it was" cmp log before
	is "another $name: no picture" "$(ls out.pfm* 2>/dev/null)" ''
}
rm -f out.pfm
refused scene 'is of another scene: frame 0 has job [0-9a-f]{32}, expected' -s $size tetra.nff
refused size 'has another size: frame 0 of 96x80 pixels, expected 64x64' -s 64x64 gears.nff
refused option 'was rendered with other options: .rtworker., expected .rtworker -a4 -d3.' -s $size -W '-a 4 -d 3' gears.nff
perl -pi -e 's/^(hello rtworker) \S+/$1 0.0/; s/(frame 0 96 80 job=)..../${1}0000/' log
"$root/tests/seal" <log >before
cp before log
refused version 'was rendered by another version: 0.0, expected' -s $size gears.nff
head -c 60000 whole | perl -pe 's/( selftest=)..../${1}0000/' | "$root/tests/seal" >log
cp log before
refused arithmetic 'was rendered by other arithmetic: self-test 0000' -s $size gears.nff
# A file that is not a log does not become one.
printf 'hello rtworker 1.0 is what a log begins with\n' | cat - whole >log && cp log before
refused 'kind of file, with a log in it' 'is not a log, expected a whole record first, or an empty file' -s $size gears.nff
cp gears.nff log && cp log before
refused 'kind of file' 'is not a log, expected a whole record first, or an empty file' -s $size gears.nff
run sh -c "partition $size | rtworker gears.nff | gather -r log -o out.pfm"
is 'another kind of file, by hand: exit 2' "$status" 2
ok 'another kind of file, by hand: as it was' cmp log before
# A complete log of another scene is refused as well, although there is nothing to render.
cp whole log && cp log before
refused 'scene than that of a whole log' 'is of another scene' -s $size tetra.nff
# Two scenes, made to have one XXH64: the bytes 32 to 39 undo in the hash what bytes 0 to 7 did.
# painted COLOUR BYTES
painted() {
	printf 'b %s 1\n# of an equal hash64: %s\nv\nfrom 3 4 5\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\nresolution 32 32\n' "$@"
	printf 'l 5 3 9\nf 1 1 1 1 0 0 0 0\ns 0 0 0 1\n'
}
painted '.1 .0' 'xR*##eu#' >blue.nff
painted '.9 .2' '##(1w##6' >violet.nff
partition 32x32 | rtworker blue.nff >log
cp log before
refused 'scene of an equal XXH64' 'is of another scene' violet.nff
cp whole log && cp log before
run gather -r log -o out.pfm tetra.nff
is 'no worker announced a frame: exit 1' "$status$(ls out.pfm* 2>/dev/null)" 1
like 'no worker announced a frame: a message says so' "$err" 'log: no worker announced a frame, expected a frame of this log'
ok 'no worker announced a frame: the log is unchanged' cmp log before
ln -s log log.pfm
run gather -r log -o log.pfm whole
is 'the log by another name as the picture: exit 2' "$status" 2
like 'the log by another name as the picture: a message says so' "$err" 'log.pfm: is also the log'
cp log log0.pfm
run gather -r log0.pfm -o log%d.pfm whole
is 'the log by the name of the first picture: exit 2, and the log stays' "$status:$(cmp log0.pfm log && echo same)" 2:same
cp whole in.pfm
run gather -o in.pfm in.pfm
is 'an input as the picture: exit 2, and the input stays' "$status:$(cmp in.pfm whole && echo same)" 2:same
run gather -o in.pfm <in.pfm
is 'standard input as the picture: exit 2, and it stays' "$status:$(cmp in.pfm whole && echo same)" 2:same
cp whole in.pfm
is 'standard input, named -, as the picture: exit 2, and it stays' "$(gather -o in.pfm - <in.pfm 2>/dev/null; echo $?):$(cmp in.pfm whole && echo same)" 2:same
printf 'P6 1 1 255\n123' >in.partial.ppm
cp in.partial.ppm in.partial.pfm
is 'a backdrop as the preview: exit 2, and it stays' "$(gather -b in.partial.pfm -w 1 -o in.pfm <whole 2>&1 | grep -c 'is also a backdrop'):$(cmp in.partial.pfm in.partial.ppm && echo same)" 1:same
is 'a backdrop as the picture: exit 2, and it stays' "$(gather -b in.partial.pfm -o in.partial.pfm <whole 2>/dev/null; echo $?):$(cmp in.partial.pfm in.partial.ppm && echo same)" 2:same
cp whole in.partial.pfm
run gather -w 1 -o in.pfm in.partial.pfm
is 'an input as the preview: exit 2, and the input stays' "$status:$(cmp in.partial.pfm whole && echo same)" 2:same
run balance masterslave -r log -o log -s $size gears.nff
is 'balance -r log -o log: exit 2' "$status" 2
run balance masterslave gears.nff -s $size -o out.pfm
is 'balance: options behind the scene' "$status $err" '2 job: -s: no such file; options are before the files'
run balance masterslave -r gears.nff -o out.pfm gears.nff
is 'balance -r with the scene: exit 2' "$status" 2
run balance masterslave -o nosuch/out.pfm -s $size gears.nff
like 'balance -o in no directory: named' "$status $err" '^3 gather: nosuch/out.pfm: No such file'
for empty in j k o r s S; do
	run balance masterslave "-$empty" '' -s $size -o out.pfm gears.nff
	like "balance -$empty with nothing: exit 2" "$status $err" "^2 balance: -$empty: is empty"
done
mkdir dashed
cp gears.nff dashed/-d.nff
run sh -c "cd dashed && balance masterslave -s 16x16 -r -d.frags -o -d.pfm -- -d.nff"
is 'balance: files whose names begin with a dash' "$status$(echo "$err" | grep -v 'never connected$')$(ls dashed | tr '\n' ' ')" '0-d.frags -d.nff -d.pfm '
ok 'the log as it was' cmp log before

# ---- accepted logs --------------------------------------------------------------------------------------------
balance interleaved -j 3 -r log -o out.pfm -s $size gears.nff
ok 'a whole log: the picture is written' cmp out.pfm good.pfm
is 'a whole log: nothing was rendered' "$(tail -c +$(($(wc -c <before) + 1)) log | grep -ac 'done 0 [0-9]* cpu_us=')" 0
{ cat before; printf 'frag 0 1 garbage\nup to the end'; } >log
rm -f out.pfm
balance ds -j 3 -r log -o out.pfm -s $size gears.nff 2>said
ok 'garbage at the end of the log: the picture' cmp out.pfm good.pfm
head -c 60000 whole | perl -pe 's/^(hello rtworker) \S+/$1 0.0/' | "$root/tests/seal" >log
balance masterslave -j 2 -r log -o out.pfm -s $size gears.nff 2>said
ok 'a log of an older version with the same pictures is resumed' cmp out.pfm good.pfm
head -c 60000 whole >log
cp log before
{ tail -c 10000 whole; cat whole; } | gather -r log -o out.pfm 2>said
ok 'fragments before the first frame: the same picture' cmp out.pfm good.pfm
count() { grep -a -o 'frag 0 [0-9]* 0 [0-9]* 96 1 1 1 job=' "$1" | wc -l; }
is 'fragments before the first frame: not in the log' "$(count log)" $(($(count before) + 80))
for f in 0 1 2; do partition -F $f $size; done | rtworker gears.nff | head -c 200000 >film
for f in 0 1 2; do partition -F $f -r film $size; done | rtworker gears.nff | gather -r film -o 'f%d.pfm' 2>said
ok 'three frames, cut off within the second' sh -c 'for f in 0 1 2; do cmp f$f.pfm good.pfm || exit; done'
for f in 0 1 2; do partition -F $f 64x64; done | rtworker gears.nff | gather -r film -o 'g%d.pfm' 2>said
is 'three frames of another size: exit 2' $? 2
is 'three frames of another size: no picture' "$(ls g[0-9].pfm 2>/dev/null)" ''

{ partition -F 0 $size | rtworker gears.nff; partition -F 1 $size | rtworker tetra.nff; } | head -c 200000 >film
cp film before
for f in 0 1; do partition -F $f -r film $size; done | rtworker gears.nff | gather -r film -o 'g%d.pfm' 2>said
is 'the second frame of another scene: exit 2' $? 2
like 'the second frame of another scene: a message says so' "$(cat said)" 'film: is of another scene: frame 1 has job'
ok 'the second frame of another scene: none of its records is in the log' [ "$(gather -m film | grep -c '^task 1')" = "$(gather -m before | grep -c '^task 1')" ]

# ---- in use -----------------------------------------------------------------------------------------------------
head -c 60000 whole >log
cp log before
mkfifo slow
gather -r log -o slow.pfm <slow 2>said &
pid=$!
exec 3>slow
head -n 3 whole >&3
tries=0
until [ "$(wc -c <log)" -gt 60000 ] || [ $((tries += 1)) -gt 4000 ]; do sleep .05; done
run balance masterslave -j 2 -r log -o out2.pfm -s $size gears.nff
is 'a log that is in use: exit 2' "$status" 2
like 'a log that is in use: a message says so' "$err" 'log: is in use by another run'
is 'a log that is in use: no picture' "$(ls out2.pfm* 2>/dev/null)" ''
exec 3>&-
wait "$pid"
is 'a log that is in use: the first run reports missing pixels' $? 1

# ---- full disk --------------------------------------------------------------------------------------------------
if [ "$(id -u)" -eq 0 ]; then
	mkdir disk && mount -t tmpfs -o size=64k tmpfs disk && mounted=$tmp/disk
	run balance masterslave -j 2 -r disk/log -o disk/out.pfm -s $size gears.nff
	is 'a full disk: exit 3' "$status" 3
	like 'a full disk: a message names the log' "$err" 'disk/log: No space left'
	like 'a full disk: a message names the picture' "$err" 'disk/out.pfm: No space left'
	is 'a full disk: no picture, and no part of one' "$(ls disk)" log
	mount -o remount,size=16m disk
	run balance masterslave -j 2 -r disk/log -o disk/out.pfm -s $size gears.nff
	is 'a full disk with room again: the same command exits 0' "$status" 0
	ok 'a full disk with room again: the same picture' cmp disk/out.pfm good.pfm
else
	run balance masterslave -j 2 -r /dev/full -o out3.pfm -s $size gears.nff
	is 'a full disk: exit 3' "$status" 3
fi

# ---- Ctrl-C -----------------------------------------------------------------------------------------------------
# An interactive shell gives children the default action, and a group of their own.
rm -f log out.pfm
# shellcheck disable=SC2016
setsid perl -e '$SIG{INT} = "DEFAULT"; exec @ARGV' \
	balance masterslave -j 2 -s 1024x1024 -W '-a 1024' -r log -o out.pfm gears.nff 2>said &
pid=$!
tries=0
until [ -s log ] || [ $((tries += 1)) -gt 4000 ]; do sleep .05; done
sleep .2
kill -INT "-$pid"
wait "$pid"
is 'Ctrl-C: ended by the signal' $? 130
is 'Ctrl-C: one line tells how to finish' "$(cat said)" \
	'gather: interrupted; log has the pixels so far: rerun the command to resume'
pid=''

# ---- kill -9 ----------------------------------------------------------------------------------------------------
seed=$(date +%s) moments=5
[ -z "${NIGHT-}" ] || moments=20
diag "kill points of tests/soak/restart.sh $moments $seed"
ok "kill -9 at $moments random moments: the same command finishes it" "$root/tests/soak/restart.sh" $moments "$seed"
diag "$(sed -n 's/^# //p' .said)"
finish
