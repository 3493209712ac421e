#!/bin/sh
# Invariants 3, 4 and 6 on one machine. Processes are killed, stop, send garbage or leave: no task is lost that the
# method can save, missing pixels are listed, and no process remains.
. "$(dirname "$0")/lib.sh"
needs ps

# shellcheck disable=SC2154,SC2016,SC2094  # lib.sh sets them; scripts for others; a log that grows
. "$root/tests/marked.sh"
spdgen -s 2 gears >gears.nff

partition 256x256 | rtworker -a 16 gears.nff | gather -o good.pfm
# long METHOD [OPTIONS]: starts a run of some seconds on 3 slots, in the background; endless: a run of hours, to be killed
long() {
	method=$1
	shift
	# shellcheck disable=SC2086  # several words
	env MARK=$mark balance "$method" -j 3 ${work:--s 256x256 -W -a16} -o out.pfm "$@" gears.nff 2>said &
	pid=$!
}
endless() { work='-s 1024x1024 -W -a1024' long "$@"; }

# ---- kill -9 of each stage: no process and no half picture remains ----------------------------------------
for stage in gather deal fan partition; do
	rm -f out.pfm
	endless masterslave -r stage.log
	await 5 working 3
	victims=$(program $stage)
	# shellcheck disable=SC2086
	if ! kill -9 $victims 2>/dev/null; then
		is "only partition may be done before it can be killed" $stage partition
		kill -9 "$pid"
	fi
	ok "kill -9 of $stage: no process remains" await 2 none_alive
	wait "$pid" 2>/dev/null
	is "kill -9 of $stage: no picture" "$(ls out.pfm* 2>/dev/null)" ""
	rm -f stage.log
done
# A worker that reads neither its input nor notices its reader: it must end with its parent.
env MARK=$mark sh -c 'partition 8x8 | fan -j 2 sleep 7200 | cat' 2>said &
pid=$!
deaf() { [ "$(program sleep | wc -l)" -eq 2 ]; }
await 5 deaf
# shellcheck disable=SC2046
kill -9 $(program fan)
ok "kill -9 of fan, its workers deaf: no process remains" await 2 none_alive
wait "$pid" 2>/dev/null
endless interleaved
await 5 working 3
kill -9 "$pid"
ok "kill -9 of balance (interleaved): no process remains" await 2 none_alive
wait "$pid" 2>/dev/null
env MARK=$mark sh -c 'pack scene gears.nff | cat >/dev/null; { pack scene gears.nff; partition 1024x1024; } |
	deal fan -j 2 deal fan -j 2 rtworker -a 1024 - | gather -o out.pfm' 2>said &
pid=$!
await 5 working 4
# shellcheck disable=SC2046
kill -9 $(program gather)
ok "kill -9 of gather over a nest: no process remains" await 2 none_alive
wait "$pid" 2>/dev/null

# ---- Ctrl-C: a signal to the foreground group --------------------------------------------------------
# A session of its own, so that the test is not in the group; an interactive shell gives children the default action.
rm -f out.pfm
setsid env MARK=$mark perl -e '$SIG{INT} = "DEFAULT"; setpgrp; exec @ARGV' \
	balance masterslave -j 3 -s 1024x1024 -W '-a 1024' -o out.pfm gears.nff 2>said &
pid=$!
await 5 working 3
group=$(ps -o pgid= -p "$(program gather)" | tr -d ' ')
kill -INT "-$group"
ok "Ctrl-C: no process remains" await 2 none_alive
wait "$pid" 2>/dev/null
is "Ctrl-C: no picture" "$(ls out.pfm* 2>/dev/null)" ""

# mortal METHOD [OPTIONS]: long, but one of the three workers is killed by SIGKILL when it has done three tasks, or sent 9000
# bytes of a longer one. The others get their input after that, so whatever the load, the run is not over before.
wrap rtworker bin <<END
if mkdir '$tmp/first' 2>/dev/null; then
	'$root/bin/rtworker' "\$@" | {
		perl -e '\$| = 1; while (sysread STDIN, \$b, 4096) {
			print \$b; \$sent += length \$b; \$n += () = \$b =~ /^done /mg; last if \$n > 2 || \$sent > 9000 }'
		: >'$tmp/dead'
		kill -9 \$\$
	}
fi
{ until [ -e '$tmp/dead' ]; do sleep .05; done; exec cat; } | '$root/bin/rtworker' "\$@"
END
mortal() {
	rm -rf first dead
	PATH=$tmp/bin:$PATH patience=600 long "$@"
}

# ---- a worker dies -----------------------------------------------------------------------------------
for m in masterslave hybrid ds dc; do
	rm -f out.pfm
	mortal $m
	wait "$pid"
	is "$m, a worker killed: exit 0" $? 0
	ok "$m, a worker killed: the same picture" cmp out.pfm good.pfm
	like "$m, a worker killed: a message says so" "$(cat said)" 'fan: slot [0-2]: lost \(signal-9\)'
done
for m in interleaved ss sc; do
	rm -f out.pfm job.log
	mortal $m -r job.log
	wait "$pid"
	is "$m, a worker killed: exit 1" $? 1
	like "$m: the missing pixels are listed" "$(cat said)" '[0-9]+ of 65536 pixels missing'
	is "$m: no picture" "$(ls out.pfm* 2>/dev/null)" ""
	like "$m: a message says what to do" "$(cat said)" 'gather: to resume from job\.log, rerun the command'
	cp job.log cut.log
	patiently long $m -r cut.log
	wait "$pid"
	ok "$m: the same command again gives the same picture" cmp out.pfm good.pfm
done
mv cut.log job.log

# ---- a worker stops, and one stops for a while ----------------------------------------------------------
# begin METHOD: long with workers that are held back until the file go is there
hold_rtworker
begin() {
	rm -f go held.*
	PATH=$tmp/holding:$PATH patience=${limit:-8} long "$@"
	await 5 held 3
}
begin masterslave
kill -STOP "$(held_workers | head -1)"
: >go
wait "$pid"
is "masterslave, a worker stopped: exit 0" $? 0
ok "masterslave, a worker stopped: the same picture" cmp out.pfm good.pfm
like "masterslave, a worker stopped: a message says so" "$(cat said)" 'lost \(silent\)'
ok "masterslave, a worker stopped: no process remains" await 2 none_alive
limit=600
begin interleaved
p=$(held_workers | head -1)
kill -STOP "$p"
: >go
sleep 1
kill -CONT "$p"
wait "$pid"
is "interleaved, a worker stopped for 1 s: exit 0" $? 0
ok "interleaved, a worker stopped for 1 s: the same picture" cmp out.pfm good.pfm

limit=''

# ---- a loaded machine: fan is kept from running, and a worker for longer ---------------
begin masterslave
worker=$(held_workers | head -1) fan=$(program fan)
kill -STOP "$worker" "$fan"
: >go
sleep 9
kill -CONT "$fan"
sleep .5
kill -CONT "$worker"
wait "$pid"
is "masterslave, fan stopped as well: exit 0" $? 0
is "masterslave, fan stopped as well: no slot is lost" "$(cat said)" ''
ok "masterslave, fan stopped as well: the same picture" cmp out.pfm good.pfm

# A tree with another scene counts as one slot, whatever the number of its workers. The others begin when it has announced
# its job; the input ends when that is said.
spdgen -s 2 tetra >tetra.nff
# For a worker: waits until another slot has announced its job.
announced='until grep -aq "^frame 0 " up; do sleep .02; done'
# contradicted SLOTS COMMAND: a run, with the state that COMMAND prints, whose first slot has another job than the others
contradicted() {
	: >up
	: >said
	{ "$2"; partition 64x64; await 10 grep -q 'the run ends' said; } |
		timeout 800 env MARK=$mark deal sh -c 'fan -j "$1" ./old | tee up' fan "$1" 2>said | gather -o out.pfm 2>>said
}
printf '#!/bin/sh\nmkdir other 2>/dev/null || { %s; exec deal fan -j 2 rtworker gears.nff; }\nexec deal fan -j 3 rtworker tetra.nff\n' "$announced" >old
chmod +x old
contradicted 3 true
is "a tree with another scene: exit 3" $? 3
like "a tree with another scene: a message says so" "$(cat said)" 'frame 0: 1 with job [0-9a-f]{32}, 2 with another: the run ends'

# A tree reports the job of each picture for each of its workers, in any order. It counts as one slot.
cat >old <<'END'
#!/bin/sh
mkdir tree 2>/dev/null && exec deal fan -j 4 rtworker -a 16 gears.nff
until [ "$(grep -ac '^frame [01] ' up)" -ge 8 ] || [ $((tries += 1)) -gt 500 ]; do sleep .02; done
exec deal fan -j 1 rtworker tetra.nff
END
: >up
: >said
{ partition 64x64; partition -F 1 64x64; await 10 grep -q 'the run ends' said; } |
	timeout 800 env MARK=$mark deal sh -c 'fan -j 4 ./old | tee up' fan 2>said | gather -o 'old%d.pfm' 2>>said
is "a tree with another scene, of two pictures: exit 3" $? 3
like "a tree with another scene, of two pictures: a message says so" "$(cat said)" 'frame 0: 1 with job [0-9a-f]{32}, 2 with another: the run ends'
# Each of its 32 workers announces each of the 60 pictures.
for i in $(seq 0 59); do partition -F "$i" 8x8; done >many.tasks
timeout 800 deal fan -j 1 deal fan -j 32 rtworker tetra.nff <many.tasks 2>said | gather -o 'many%d.pfm'
is "a tree announces many pictures: exit 0, no slot is lost" "$?:$(cat said)" 0:
# A worker that holds back pixels is asked for them before it has any. It is not silent when it has computed some later.
{ pack scene tetra.nff; echo 'frame 0 8 8'; echo flush; sleep 1; echo 'task 0 0 0 0 8 8 1 1'; sleep 4; } | timeout 800 fan -t 2 -j 1 rtworker -c - 2>said | gather -o eight.pfm
is "a flush before the task: exit 0, no slot is lost" "$?:$(cat said)" 0:
# With fan -1, a worker here that dies before it has said hello is started again, and gets all of its state.
printf '#!/bin/sh\nmkdir died 2>/dev/null && { sleep 1; kill -9 $$; }\nexec rtworker "$@"\n' >dies && chmod +x dies
{ pack scene gears.nff; partition 64x64; } | timeout 800 deal fan -1 -j 2 ./dies - 2>said | gather -o died.pfm
is "fan -1, a worker dies before its hello: exit 0" $? 0
partition 64x64 | rtworker gears.nff | gather -o well.pfm
ok "fan -1, a worker dies before its hello: the same picture" cmp died.pfm well.pfm
# A hello may take longer than the end of a run that has nothing to do.
printf '#!/bin/sh\nsleep 2\nexec rtworker "$@"\n' >late && chmod +x late
run sh -c 'timeout 800 fan -j 1 ./late tetra.nff </dev/null'
is "nothing to do, and a late hello: exit 0" "$status:$err" 0:

# A worker that rarely gets the processor, with a task of hours.
{ pack scene gears.nff; partition -u tile:4096x4096 4096x4096; } | env MARK=$mark fan -j 1 rtworker -a 1024 - 2>said >frags &
pid=$!
await 5 working 1
worker=$(program rtworker)
beats() { grep -ac '^beat' frags; }
more_beats() { [ "$(beats)" -gt "$seen" ]; }
for _ in 1 2 3 4 5 6; do
	kill -STOP "$worker"
	seen=$(beats)
	sleep .7
	kill -CONT "$worker"
	await 5 more_beats
done
is "a worker that is mostly kept from running: not lost" "$(program rtworker) $(cat said)" "$worker "
end_all
wait "$pid" 2>/dev/null

# ---- every worker dies ---------------------------------------------------------------------------------
endless masterslave
await 5 working 3
# shellcheck disable=SC2046
while kill -0 "$pid" 2>/dev/null; do
	kill -9 $(program rtworker) 2>/dev/null
	sleep .05
done
wait "$pid"
# The frame is given up, or before that the last slot.
like "all workers killed, again and again: the run ends, and says why" "$?:$(grep -E 'given up|no slot left' said)" \
	'^(1:deal: frame 0: given up|3:fan: no slot left)'
ok "all workers killed: no process remains" await 2 none_alive

# ---- workers that cannot be trusted ---------------------------------------------------------------------
partition 64x64 | rtworker gears.nff | gather -o small.pfm
# liar SCRIPT [SLOTS [ERE [late]]]: one of two slots runs SCRIPT for its worker; the input ends when that has been said.
# late: until then the others do not begin, so that they cannot do all the work before the liar does any.
liar() {
	ere=${3-}
	printf '#!/bin/sh\nif mkdir taken 2>/dev/null; then\n%s\nfi\n%s\nexec rtworker -\n' "$1" \
		"${4:+until grep -Eq '$ere' said; do sleep .02; done}" >liar
	chmod +x liar
	rm -rf taken out.pfm
	: >up
	: >said
	{ pack scene gears.nff; partition 64x64; [ -z "$ere" ] || await 10 grep -Eq "$ere" said; } |
		env MARK=$mark deal sh -c 'fan -j "$1" ./liar | tee up' fan "${2:-2}" 2>>said | gather -o out.pfm 2>>said
	status=$?
}
# For a liar that comes second: waits until another slot is up.
second='until grep -aq "up w=" up; do sleep .02; done'
# through SCRIPT: passes on what a worker writes, line by line, each with what perl makes of it, and with the right sums
cat >through <<'END'
#!/usr/bin/perl
$| = 1;
open OUT, "|-", $ENV{SEAL} or die;
select OUT;
$| = 1;
while (<STDIN>) {
	read STDIN, $body, / bytes=(\d+)/ ? $1 : 0;
	eval "$ARGV[0]; 1" or die $@;
	print $_, $body;
}
END
chmod +x through
ln -s "$root/tests/seal" seal
export SEAL=./seal
liar 'rtworker - | { head -c 5000; cat /dev/urandom; }; exit'
is "garbage after a while: exit 0" "$status" 0
ok "garbage after a while: the same picture" cmp out.pfm small.pfm
liar 'rtworker - | ./through "s/frag 0 (\d+) 0 (\d+)/q(frag 0 ).\$1.q( 0 ).((\$2+1)%64)/e"; exit' \
	2 'lost .(wrong-pixels|garbage)' late
ok "pixels of another row: the same picture" cmp out.pfm small.pfm
like "pixels of another row: a message says so" "$(cat said)" 'lost \((wrong-pixels|garbage)\)'
liar 'sleep 7200; exit'
is "never a word: exit 0" "$status" 0
ok "never a word: the same picture" cmp out.pfm small.pfm
liar 'rtworker - | ./through "s/(done 0 .*\n)/\$1\$1/"; exit'
ok "says done twice: the same picture" cmp out.pfm small.pfm
liar 'rtworker - | ./through "s/^(frame 0 .*\n)/\$1 x 3000/e"; exit' 2 'lost .unasked' late
ok "announces the frame 3000 times: the same picture" cmp out.pfm small.pfm
like "announces the frame 3000 times: a message says so" "$(cat said)" 'lost \(unasked\)'
liar 'rtworker - | ./through "\$_ = (\$_ . \$body . chr 10) x 6000 . \$_ if /^frag /"; exit' 2 'lost .unasked' late
ok "sends the same pixels 6000 times: the same picture" cmp out.pfm small.pfm
like "sends the same pixels 6000 times: a message says so" "$(cat said)" 'lost \(unasked\)'
liar 'exit 0'
ok "ends at once: the same picture" cmp out.pfm small.pfm
# The first hello is the reference, so the liar sends the second one.
liar "$second; "'echo "hello $(rtworker --version) format=4 selftest=0 power=1000"; exec rtworker - >/dev/null' 2 'lost .other-arithmetic'
ok "other arithmetic: the same picture" cmp out.pfm small.pfm
like "other arithmetic: a message says so" "$(cat said)" 'lost \(other-arithmetic\)'
liar 'rtworker - | ./through "s/(frame 0 .*) sum=.*\n/\$1.q( x=).(q(y) x 939).qq(\n)/e"; exit' 2 'lost .long-line' late
ok "a line that a stamp makes too long: the same picture" cmp out.pfm small.pfm
like "a line that a stamp makes too long: a message says so" "$(cat said)" 'lost \(long-line\)'
# The name of the host is part of the stamp.
printf '%0255d via="env FAR=1 sh -c %%c"\n:\n' 0 >hosts
printf '#!/bin/sh\n[ -n "${FAR-}" ] || { { until grep -q long-line said; do sleep .02; done; cat; } | exec rtworker -; exit; }\n%s\n' \
	'rtworker - | ./through "s/(frame 0 .*) sum=.*\n/\$1.q( x=).(q(y) x 690).qq(\n)/e"' >liar
: >said
{ pack scene gears.nff; partition 64x64; await 10 grep -q long-line said; } | deal fan -z off -t 60 -S hosts ./liar 2>>said | gather -o out.pfm
is "a line that the name of the host makes too long: exit 0" $? 0
ok "a line that the name of the host makes too long: the same picture" cmp out.pfm small.pfm
liar "$announced; "'rtworker - | ./through "s/^(frame.*) job=\S+/\$1 job=0/"; exit' 3 'lost .other-job'
ok "another job: the same picture" cmp out.pfm small.pfm
like "another job: a message says so" "$(cat said)" 'lost \(other-job\)'
like "another job: the message names the slots" "$(cat said)" \
	'^fan: slot [0-2]: frame 0 has job 0 there, expected [0-9a-f]{32} as on slot [0-2], which sent it first$'
# The liar is the first slot; the others contradict it. It sends no pixels, so that the picture cannot be whole before.
scene() { pack scene gears.nff; }
for slots in 2 3; do
	printf '#!/bin/sh\nmkdir first 2>/dev/null || { %s; exec rtworker -; }\nrtworker - | sed -u "s/ job=[^ ]*/ job=0/" | $SEAL | { sed -u "/^frame /q"; while echo beat; do sleep .2; done; }\n' "$announced" >old
	rm -rf first out.pfm
	contradicted $slots scene
	is "the first of $slots slots has another job: exit 3" "$?$(ls out.pfm 2>/dev/null)" 3
	like "the first of $slots slots has another job: a message says so" "$(cat said)" "frame 0: 1 with job 0, $((slots - 1)) with another: the run ends"
	ok "the first of $slots slots has another job: no process remains" await 2 none_alive
done
liar 'rtworker - | perl -e "read STDIN, \$x, 2000; print \$x; read STDIN, \$y, 2e6; print \$y; print qq(done 0 7 x=1\n) while 1" | $SEAL; exit'
ok "answers to no question: the same picture" cmp out.pfm small.pfm
liar 'rtworker - | ./through "s/frame 0 64 64/frame 0 64 65/"; exit' 2 'lost .wrong-frame' late
ok "a frame of another size: the same picture" cmp out.pfm small.pfm
like "a frame of another size: a message says so" "$(cat said)" 'lost \(wrong-frame\)'
liar 'rtworker - | { head -c 3000; i=1; while echo "frame $i 1 1 job=0"; do i=$((i + 1)); done; } | $SEAL; exit'
ok "frames without a request: the same picture" cmp out.pfm small.pfm
liar 'rtworker - | { head -c 3000; echo "scene bytes=2147483647"; cat /dev/zero; }; exit'
ok "two gigabytes of state from a worker: the same picture" cmp out.pfm small.pfm
ok "liars leave no process" await 2 none_alive
run sh -c 'partition 8x8 | fan -j 2 no-such-program'
is "a worker that does not exist: exit 3" "$status" 3
like "a worker that does not exist: a message says so" "$err" 'no-such-program: No such file'

# ---- readers -------------------------------------------------------------------------------------------
run sh -c "partition 64x64 | env MARK=$mark deal fan -j 2 rtworker gears.nff | head -c 1000 >/dev/null"
ok "head -c 1000: no process remains" await 2 none_alive
is "| head -c 1000: not a word" "$err" ""
run sh -c "partition 64x64 | env MARK=$mark rtworker gears.nff | head -c 1000 >/dev/null"
ok "| head -c 1000 of a lone worker: no process remains" await 2 none_alive
partition 512x512 | env MARK=$mark deal fan -j 2 rtworker gears.nff | { sleep 4; gather -o out.pfm; }
partition 512x512 | rtworker gears.nff | gather -o big.pfm
ok "a reader that stops for 4 s: the whole picture" cmp out.pfm big.pfm
for p in 'partition 8x8' 'spdgen tetra' 'pack scene gears.nff' 'rtworker -i gears.nff' 'nff2pov gears.nff' \
	'fan -l' 'imgcmp small.pfm small.pfm' 'gather -m job.log' 'fragstat job.log'; do
	[ "$p" = 'gather -m job.log' ] && head -c 100000 job.log >torn && p='gather -m torn'
	run sh -c "$p >/dev/full"
	is "$p >/dev/full: exit 3" "$status" 3
	like "$p >/dev/full: a message says so" "$err" 'No space left'
done
for p in 'rtworker gears.nff' 'deal fan -j 2 rtworker gears.nff' 'fan -j 2 rtworker gears.nff'; do
	run sh -c "partition 64x64 | env MARK=$mark $p >/dev/full"
	is "$p >/dev/full: exit 3" "$status" 3
	ok "$p >/dev/full: no process remains" await 2 none_alive
done

# ---- deaf or stopped processes end with the process that started them ------------------------------------------------
deaf='trap "" TERM INT HUP; sleep 7200 & sleep 7200'
# deafly SIGNAL PROGRAM COMMAND ...: one that ignores signals is at work below PROGRAM, which gets the signal
deafly() {
	signal=$1 target=$2
	shift 2
	# Under nohup(1) a program ignores SIGHUP, and rightly.
	env --default-signal=HUP MARK=$mark "$@" sh -c "$deaf" <&8 >/dev/null 2>&1 8>&- &
	await 2 eval '[ "$(program sleep | wc -l)" -ge 4 ]'
	# shellcheck disable=SC2046
	kill "-$signal" $(program "$target")
	ok "kill -$signal $target over deaf workers: no process remains" await 2 none_alive
}
mkfifo idle
exec 8<>idle # an input that stays open and says nothing
deafly TERM fan fan -j 2
deafly HUP deal deal fan -j 2
deafly TERM deal deal fan -j 2
exec 8>&-
endless masterslave
await 5 working 3
# shellcheck disable=SC2046
kill -STOP $(program rtworker)
kill -9 "$(program fan)"
ok "kill -9 of fan over stopped workers: no process remains" await 2 none_alive
wait "$pid" 2>/dev/null
# refused NAME RECORDS COMMAND ...: exit 2, and no process remains
refused() {
	# shellcheck disable=SC2059  # records, with \n
	printf "$2" >bad.task
	name="${3%% *} refuses $1"
	run sh -c "env MARK=$mark $3 sleep 7200 <bad.task"
	is "$name: exit 2" "$status" 2
	ok "$name: no process remains" await 2 none_alive
}
for p in 'fan -j 2' 'deal fan -j 2'; do
	refused 'nonsense' 'nonsense\n' "$p"
	refused 'records of workers' 'done 0 0 cpu_us=1 wall_us=1\n' "$p"
	refused 'a task without a frame' 'task 0 0 0 0 1 1 1 1\n' "$p"
	refused 'pixels outside of the frame' 'frame 0 8 8\ntask 0 0 8 0 1 1 1 1\n' "$p"
done
refused 'one number for two tasks' 'frame 0 8 8\ntask 0 0 0 0 1 1 1 1\ntask 0 0 0 1 1 1 1 1\n' 'fan -j 2'

# What a command says that is no worker: deal ends.
hello='hello x 0.2 format=4 selftest=0123456789abcdef'
# said WHAT RECORDS ERE
said() {
	printf '%s\n' "$2" | "$root/tests/seal" >said.rec
	run sh -c "partition 8x8 | timeout 60 deal sh -c 'cat said.rec; exec sleep 50'"
	like "deal: $1: exit 3, and says so" "$status $err" "^3 deal: from the command: record $3\$"
}
said 'a command that echoes its input' 'frame 0 8 8' '`frame`, expected `hello` first'
said 'tasks from a command' "$hello
task 0 0 0 0 1 1 1 1" '`task`, expected one that workers send'
said 'flush from a command' "$hello
flush" '`flush`, expected one that workers send'

# ---- closed standard streams ----------------------------------------------------------------
for p in 'fan -j 2' 'deal fan -j 2'; do
	run sh -c "timeout 1200 $p rtworker gears.nff <."
	is "$p: standard input is a directory: exit 3" "$status" 3
	run sh -c "timeout 1200 $p rtworker gears.nff <&-"
	is "$p <&-: exit 3" "$status" 3
	run sh -c "partition 8x8 | timeout 1200 $p rtworker gears.nff >&-"
	is "$p >&-: exit 3" "$status" 3
	rm -f out.pfm
	run sh -c "{ pack scene gears.nff; partition 64x64; } | timeout 1200 $p rtworker - 2>&- | gather -o out.pfm"
	ok "$p 2>&-: the same picture" cmp out.pfm small.pfm
done
run sh -c 'partition 8x8 | rtworker gears.nff | gather -r closed.log >&-'
is "gather -r LOG >&-: exit 3, and no picture in the log" "$status$(head -c 5 closed.log)" 3hello

# ---- silence without a fault, and commands other than fan ------------------------------------------------
rm -f out.pfm # of the tests before
{ pack scene gears.nff; partition 64x64; sleep 4; } | fan -t 2 -j 2 rtworker -c - 2>said | gather -o out.pfm
ok "-c, and an input that pauses: the same picture" cmp out.pfm small.pfm
is "-c, and an input that pauses: no slot is lost" "$(cat said)" ""
rm -f out.pfm
for p in 'deal rtworker' 'deal deal fan -j 2 rtworker' 'deal -q 2 deal deal fan -j 2 fan -j 2 rtworker'; do
	{ pack scene gears.nff; partition 64x64; } | timeout 1200 $p - 2>said | gather -o out.pfm
	ok "$p: the same picture" cmp out.pfm small.pfm
	rm -f out.pfm
done
# shellcheck disable=SC3045  # dash and bash both know -n
{ pack scene gears.nff; partition 64x64; } | (ulimit -n 40 && exec deal fan -j 30 rtworker -) 2>said | gather -o out.pfm
ok "more slots than descriptors: the same picture" cmp out.pfm small.pfm
rm -f out.pfm
printf '#!/bin/sh\nmkdir stays 2>/dev/null && exec rtworker -\nexec >&-\nexec sleep 7200\n' >mute && chmod +x mute
{ pack scene gears.nff; partition 64x64; } | env MARK=$mark timeout 1200 deal fan -j 20 ./mute 2>said | gather -o out.pfm
ok "19 of 20 workers close their output and stay: the same picture, without waiting for them" cmp out.pfm small.pfm
{ pack scene gears.nff; partition 64x64; } | env MARK=$mark deal fan -j 2 rtworker - | gather -o out.pfm
ok "no process remains" await 4 none_alive
finish
