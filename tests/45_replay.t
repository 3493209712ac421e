#!/bin/sh
# replay: the same bits for every cut, times that follow power and scale, use as any other worker, and refusals.
. "$(dirname "$0")/lib.sh"

spdgen -s 2 balls >balls.nff
partition 64x48 >rows.task
rtworker -d 3 balls.nff <rows.task >one.frags
gather -o one.pfm one.frags

# ---- the picture -------------------------------------------------------------------------------------------
# same NAME PARTITION-OPTIONS COMMAND ...: tasks through COMMAND give the same picture
same() {
	name=$1 cut=$2
	shift 2
	rm -f out.pfm
	# shellcheck disable=SC2086
	{ pack scene balls.nff; partition $cut 64x48; } | "$@" | gather -o out.pfm
	ok "$name" cmp out.pfm one.pfm
}
same 'rows as recorded' '' replay one.frags
same 'small fragments' '' replay -f 7 one.frags
same 'concentrated' '' replay -c one.frags
same 'options after the log' '' replay one.frags -c -f 9
same 'other cuts: tiles' '-u tile:9x5' replay one.frags
same 'other cuts: runs' '-u run:100' replay one.frags
same 'other cuts: scattered' '-u scatter -n 3' fan -j 3 replay one.frags
same 'through deal and fan' '' deal fan -j 3 replay -p 2 one.frags
same 'two levels deep' '' deal -q 2 fan -j 2 deal fan -j 2 replay one.frags
mkfifo pipe
(sleep .1; cat one.frags) >pipe &
same 'the log may come through a pipe' '' replay pipe
partition -u tile:16x16 64x48 | replay -x .5 one.frags >tiles.frags
gather -o out.pfm tiles.frags
ok 'a replay can be replayed' sh -c 'replay tiles.frags <rows.task | gather -o again.pfm && cmp again.pfm one.pfm'
like 'job and program of the hello are those of the log' "$(grep -a '^frame' tiles.frags)" "$(grep -a '^frame' one.frags | sed 's/ sum=.*//') kind=replayed sum="
cat one.frags tiles.frags >both.frags
run gather -P -o out.pfm both.frags
like 'replay returns the rendered pixels' "$status $err" '^0 .*3072 pixels came twice$'

# ---- times: those of the log, by power and scale ------------------------------------------------------------
# Each task takes 10 ms, long against the delays of a loaded machine.
LC_ALL=C sed 's/^\(.*\)done 0 \([0-9]*\) .*$/\1done 0 \2 cpu_us=10000 wall_us=10000/' one.frags | "$root/tests/seal" >slow.frags
sum() { grep -a -o 'done .*' "$1" | sed "s/.* $2=\([0-9]*\).*/\1/" | awk '{ s += $1 } END { print s }'; }
is 'the log with the times is complete' "$(gather -m slow.frags | wc -l) $(sum slow.frags cpu_us)" '0 480000'
head -n 9 rows.task >eight.task
# Between tasks a loaded machine may keep replay waiting, which it makes up for; so the whole run counts, and wall_us does not.
timed() {
	begin=$(date +%s%N)
	replay "$@" slow.frags <eight.task >timed.frags
	elapsed_us=$((($(date +%s%N) - begin) / 1000))
}
timed
is 'cpu_us is the log'"'"'s' "$(sum timed.frags cpu_us)" 80000
wall_1=$elapsed_us
timed -p .5
is 'half the power doubles the time' "$(sum timed.frags cpu_us)" 160000
wall_2=$elapsed_us
timed -x 3
is 'three times the scale makes three times the time' "$(sum timed.frags cpu_us)" 240000
wall_3=$elapsed_us
echo "$wall_1 $wall_2 $wall_3" | awk '{ exit !($1 >= 80000 && $2 >= 160000 && $3 >= 240000) }'
is 'the elapsed time is at least that time' $? 0
diag "8 tasks of 10 ms took $wall_1 us, at half the power $wall_2, at scale 3 $wall_3"
# A log that takes longer to read than the first task takes: that is part of no task.
{ cat slow.frags; yes beat | head -n 500000; } >long.frags
head -n 2 rows.task | replay long.frags >timed.frags
is 'reading the log does not shorten the first task' "$(sum timed.frags wall_us | awk '{ print ($1 > 5000) }')" 1
rm long.frags
begin=$(date +%s%N)
{ pack scene balls.nff; head -n 2 rows.task; } | replay -b .3 -p 3 slow.frags >timed.frags
is 'a state is built before its first task, in a time of its own' "$((($(date +%s%N) - begin) / 1000 >= 100000)) $(sum timed.frags cpu_us)" '1 3333'
REPLAY_POWER=4 replay slow.frags <eight.task >timed.frags
is 'REPLAY_POWER sets the power' "$(sum timed.frags cpu_us)" 20000
like 'hello has the power of REPLAY_POWER' "$(REPLAY_POWER=.1 replay slow.frags </dev/null)" '^hello .* power=0\.1 '
timed -l 2
loaded=$(sum timed.frags wall_us)
is 'load does not count as CPU time' "$(sum timed.frags cpu_us)" 80000
echo "$loaded" | awk '{ exit !($1 > 85000) }'
is 'load makes tasks take longer' $? 0
{ head -n 1 rows.task; echo 'task 0 0 0 0 32 1 1 1'; echo 'task 0 1 0 3 64 3 1 1'; } | replay -p 100 slow.frags >parts.frags
is 'other cuts take their share of the time' "$(grep -a -o 'done.*cpu_us=[0-9]*' parts.frags | tr '\n' ' ')" \
	'done 0 0 cpu_us=50 done 0 1 cpu_us=300 '

# ---- a worker like any other ---------------------------------------------------------------------------------
head -n 2 rows.task | replay -x 140 slow.frags >long.frags
like 'replay sends beats while it waits' "$(grep -a -c '^beat' long.frags)" '^[1-9][0-9]*$'
is 'replay ends at the end of its input' "$(tail -c 4 long.frags)" bye
mkfifo down up
replay -x 1000 slow.frags <down >up &
pid=$!
exec 8>down 9<up
head -n 2 rows.task >&8
head -n 2 <&9 >/dev/null
kill -0 $pid
is 'replay waits for the time of its task' $? 0
exec 9<&-
i=0
while kill -0 $pid 2>/dev/null && [ $i -lt 3000 ]; do sleep .02; i=$((i + 1)); done
wait $pid
is 'replay ends within a task when its reader is gone' "$?" 3
diag "after about $((i * 20)) ms"
exec 8>&-
rtworker -d 4 balls.nff <rows.task >other.frags
printf '%s\n' 'a power=1 via="sh -c %c"' 'b power=1 via="env LOG=other sh -c %c"' >hosts
# Without a policy each slot has its own tasks, so the run waits for both.
run sh -c 'fan -S hosts sh -c "exec replay \${LOG:-one}.frags" <rows.task >mixed.frags'
like 'slots that replay different jobs are noticed' "$err" 'arithmetic'

# ---- what it refuses -----------------------------------------------------------------------------------------
# refuses NAME WHY ARGUMENT ...
refuses() {
	name=$1 why=$2
	shift 2
	run sh -c '"$@" <rows.task' sh replay "$@"
	is "refused: $name" "$status $(printf '%s\n' "$err" | grep -c "^replay: .*$why.*expected")" '2 1'
}
: >empty.frags
refuses 'an empty log' 'empty.frags: no task' empty.frags
refuses 'a scene' 'balls.nff: no task' balls.nff
grep -a -o 'done .*' one.frags >times.frags
refuses 'a log without pixels' 'times.frags: no task' times.frags
head -c 20000 one.frags >half.frags
refuses 'a log of half the picture' 'half.frags: frame 0: pixel 0,[0-9]* is missing' half.frags
sed 's/^frame 0 64 48/frame 0 64 47/' one.frags | "$root/tests/seal" >size.frags
refuses 'a log of another size' 'size.frags: no frame 0 of 64x48' size.frags
LC_ALL=C sed 's/done 0 5 /dine 0 5 /' one.frags >undone.frags
refuses 'pixels of unknown cost' 'undone.frags: frame 0: pixel 0,5 has no CPU time' undone.frags
refuses 'a build before it began' '-b -1' -b -1 one.frags
refuses 'power 0' '-p 0' -p 0 one.frags
refuses 'scale -1' '-x -1' -x -1 one.frags
run replay nosuch.frags
like 'refused: no log' "$status $err" '^2 replay: nosuch.frags: No such file'
REPLAY_POWER=fast run replay one.frags
like 'refused: a power that is none' "$status $err" '^2 replay: REPLAY_POWER=fast: expected'
printf 'X' | dd of=one.frags bs=1 seek=5500 conv=notrunc 2>/dev/null
refuses 'damaged pixels' 'one.frags: frame 0: pixel [0-9,]* is damaged' one.frags
finish
