#!/bin/sh
# Hosts played by shells of this machine, which behave well or badly. fan retries hosts that it cannot reach, refuses
# hosts that it must not trust, waits for none in vain, and the picture is the same.
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"
# shellcheck disable=SC2154,SC2016,SC2089,SC2090  # lib.sh sets them; scripts for others; quotes in hosts files

spdgen -s 2 gears >gears.nff
partition 64x64 | rtworker gears.nff | gather -o good.pfm
job() { pack scene gears.nff; partition 64x64; }
job >job.task
# lines FILE: prints the records of a stream without their bodies; events: those on slots
lines() { perl -e 'while (<>) { print; read(ARGV, $_, $1 + 1) if / bytes=(\d+)/ }' "$1"; }
events() { lines "$1" | grep -E '^(hello|up|gone|bye)( |$)'; }
# same NAME [PICTURE]: out.pfm is the picture; removes it for the next assertion
same() {
	ok "$1: the same picture" cmp out.pfm "${2:-good.pfm}"
	rm -f out.pfm
}
script() { printf '#!/bin/sh\n%s\n' "$2" >"$1" && chmod +x "$1"; } # NAME TEXT

# ---- no host, and one of two hosts, cannot be reached: that takes 30 seconds, beside the rest -------------------
script none 'exit 255'
dead='dead slots=2 via="./none %c"'
echo "$dead" >dead
printf '%s\n: slots=1\n' "$dead" >half
(
	{ cat job.task; sleep 33; } 2>/dev/null | fan -S dead rtworker - >none.frags 2>none.said
	echo $? >none.status
) 8>&- &
none_pid=$!
start=$(date +%s)
(fan -S half rtworker - <job.task >half.frags 2>half.said; echo $? >half.status; date +%s >half.end) &
half_pid=$!

# With few descriptors only 8 connections are opened at a time. The silent hosts before it take 15 s each, so that the last one
# has its first try after 30 s.
{ seq -f 'silent%g via="sleep 100; : %%c"' 17; echo 'last via="sh -c %c"'; } >behind
# shellcheck disable=SC3045  # dash and bash both know -n
(ulimit -n 60; deal fan -S behind rtworker - <job.task >behind.frags 2>behind.said; echo $? >behind.status) &
behind_pid=$!

# A slow link, which holds the whole scene: for long only beats arrive.
cat >drip <<'END'
#!/bin/sh
mkfifo drip.$$
sh -c "$1" <drip.$$ &
exec >drip.$$
cat >dripped.$$
head -c 100000 dripped.$$
for i in $(seq 34); do sleep .5; tail -c +$((100001 + 5000 * (i - 1))) dripped.$$ | head -c 5000; done
tail -c +270001 dripped.$$
exec >&-
wait
END
chmod +x drip
echo 'drip via="./drip %c"' >drips
spdgen -s 3 gears >large.nff
{ pack scene large.nff; partition 16x16; } >large.task
(
	fan -z off -S drips deal fan -j 1 rtworker - <large.task >tree.frags 2>tree.said &
	fan -z off -S drips rtworker - <large.task >drip.frags 2>drip.said
	echo $? >drip.status
	wait
) &
drip_pid=$!

# ---- hosts files -----------------------------------------------------------------------------------------------
cat >hosts <<'END'
# three, played by shells
:     slots=1
two   slots=2 power=2.5 via="sh -c %c"
one   via="sh -c %c"
END
is 'fan -l -S FILE' "$(fan -l -S hosts | tr '\t\n' ' ;')" '0 : -;1 two 2.5;2 two 2.5;3 one -;'
is 'fan -l -S LIST' "$(fan -l -S :,2/a,me@b | tr '\t\n' ' ;')" '0 : -;1 a -;2 a -;3 me@b -;'
is 'fan -l -S FILE WORKER: powers are measured' "$(fan -l -S hosts rtworker - | sed 's/[0-9.]*$/P/' | tr '\t\n' ' ;')" \
	'0 : P;1 two P;2 two P;3 one P;'
is 'fan -l -S FILE WORKER: power= is kept' "$(fan -l -S hosts rtworker - | cut -f 3 | sed -n 2,3p | tr '\n' ' ')" '2.5 2.5 '
script asked 'echo asked >>asked.said; exec sh -c "$1"'
printf ': slots=1\nasked power=3 via="./asked %%c"\n' >asked.hosts
is 'fan -l: no worker is started on a host with power=' "$(fan -l -S asked.hosts rtworker - | cut -f 3 | tail -1; cat asked.said 2>/dev/null)" 3
script far '{ cat; sleep 2; } | sh -c "$1"'
printf ': slots=1\nfar power=3 via="./far %%c"\nnone via="false %%c"\n' >far.hosts
is 'fan -l -l: round trips, also of those whose power is stated' "$(fan -ll -t 60 -S far.hosts rtworker - 2>said |
	awk '{ print $2, ($3 == 3), ($4 >= 2000 ? "far" : $4 > 0 ? "near" : $4), ($5 > 0 ? $5 <= $3 : $5) }' | tr '\n' ';')" \
	': 0 near 1;far 1 far -;none 0 - -;'
script counted 'echo asked >>counted.said; exec rtworker -'
is 'fan -l -l: four slots of a host are asked, and all have its values' "$(fan -l -l -j 9 ./counted |
	cut -f 3-5 | grep -v -- - | uniq -c | awk '{ print $1 }') $(wc -l <counted.said)" '9 4'
script tardy 'sleep 11; exec rtworker -'
fan -l -t 60 -j 1 ./tardy >tardy.said 2>&1 &
tardy=$!
bad() { # NAME HOSTS ERE
	run fan -S "$2" rtworker - </dev/null
	is "$1: exit 2" "$status" 2
	like "$1: a message says so" "$err" "^fan: $3"
}
printf ': slots=1\na cores=2\n' >bad-key
bad 'an unknown key' bad-key "bad-key:2: 'cores': unknown, expected slots="
printf 'a slots = 2\n' >blanks
bad 'blanks around =' blanks 'blanks:1: slots without a value, expected slots=VALUE, without blanks around =$'
printf '[group]\na\n' >groups
bad 'a group' groups "groups:1: '\[group\]': no host name, expected a host in each line: a hosts file has no groups$"
printf '\033[1ma b\n' >escape
bad 'an escape byte' escape "escape:1: '[?]\[1ma': no host name, expected \`:\`, HOST or"
printf 'a "hot cold"\n' >blank
bad 'a blank in a word' blank "blank:1: 'hot cold': unknown, expected slots="
printf 'a slots=many\n' >bad-number
printf '\357\273\277a slots=2\n' >marked
is 'a byte order mark is skipped' "$(fan -l -S marked | cut -f 2 | tr '\n' ' ')" 'a a '
bad 'a bad number' bad-number "bad-number:1: slots='many': expected an integer from 1 to 4096"
: >empty
bad 'an empty file' empty 'empty: no host, expected'
bad 'an option for a host' -oProxyCommand=x "-S: '-oProxyCommand=x': no host name, expected"
bad 'a file that is not there, by its suffix' my.txt '-S: my\.txt: no such file, expected one, or 1/my\.txt for a host'
is 'a host with the name of a file' "$(fan -l -S 1/my.txt | cut -f 2)" my.txt
bad 'a file that is not there' no/hosts '-S: no/hosts: no such file.*expected'
run fan -S hosts -j 2 rtworker -
is '-S and -j: exit 2' "$status" 2
# No host is reached if a later line is bad, and no shell reads a name.
printf 'first via="echo >reached; : %%c"\na$(touch${IFS}reached) via="sh -c '"'echo %%h'"' %%c"\n' >evil
bad 'a name of other bytes' evil "evil:2: 'a\\$\\(touch\\$\\{IFS\\}reached\\)': no host name, expected"
is 'a bad hosts file: none of its commands runs' "$(ls reached 2>/dev/null)" ''
bad 'a file of something else' /etc/passwd "/etc/passwd:1: '[^ ]*': no host name, expected"
bad 'a device without end' /dev/zero '/dev/zero: no regular file, expected one'
bad 'a directory' "$tmp" "$tmp: no regular file, expected one"
mkfifo pipe
bad 'a pipe without a writer' "$tmp/pipe" "$tmp/pipe: no regular file, expected one"

# ---- the same picture -------------------------------------------------------------------------------------------
deal fan -S hosts rtworker - <job.task | gather -o out.pfm
same 'deal'
fan -S hosts rtworker - <job.task >out.frags
gather -o out.pfm out.frags
same 'interleaved'
is 'each slot is up, with its host and power' "$(events out.frags | grep ^up | sort | sed 's/power=[0-9.]* slots=1.*/power=P/' | tr '\n' ';')" \
	'up w=0 host=: power=P;up w=1 host=two power=P;up w=2 host=two power=P;up w=3 host=one power=P;'
deal -q 4 fan -S hosts deal fan -j 2 rtworker - <job.task | gather -o out.pfm
same 'a tree over hosts'

script odd '[ ! "${THERE-}" ] || printf "%s|" "$@" >odd.said; exec rtworker -'
fan -S one -j 1 true 2>/dev/null # exit 2, as above
echo 'one via="env THERE=1 sh -c %c"' >one
fan -S one ./odd 'a b' "it's" '$HOME `x` "\' '' '*' '-x' '#' '
' <job.task | gather -o out.pfm
same 'a command of odd words'
is 'a command of odd words: each word arrives unchanged' "$(cat odd.said)" "a b|it's|\$HOME \`x\` \"\\||*|-x|#|
|"
# The login shells of hosts. In the words is what each of them takes for something else.
for shell in sh csh tcsh fish; do
	there $shell || { skip "$shell: each word arrives unchanged" "$shell is not there"; continue; }
	echo "one via=\"env THERE=1 $shell -c %c\"" >one
	rm -f odd.said
	fan -S one ./odd 'wow!' '!!' '!$' "it's! \\n" '\' 'a\' '\\' "\\'" '$HOME `x`' '~' '{a,b}' '%self' 'two
lines!\
' ' ' <job.task >/dev/null
	is "$shell: each word arrives unchanged" "$(cat odd.said)" "wow!|!!|!\$|it's! \\n|\\|a\\|\\\\|\\'|\$HOME \`x\`|~|{a,b}|%self|two
lines!\\
| |"
done
mkdir there && cp "$(command -v rtworker)" there/only-there
echo "there via=\"sh -c %c\" bin=\"$tmp/there\"" >bin
run sh -c 'fan -S bin only-there - <job.task | gather -o out.pfm'
same 'bin='
like 'a worker that is not here: a message says so' "$err" 'only-there sends no hello here: the hello of the first slot sets the arithmetic'

# ---- other output of hosts ---------------------------------------------------------------------------------------
cat >talker <<'END'
#!/bin/sh
echo 'Welcome to talker, beat your own drum'
printf 'hello dear user\nbeat\ndone 0 0 cpu_us=1 wall_us=1\nframe 0 64 64 job=0\n'
seq 2000
printf 'no end of line'
printf 'first \033[31mred\r\n\377second' >&2
exec sh -c "$1"
END
chmod +x talker
echo 'talker via="./talker %c"' >talks
run sh -c 'deal fan -S talks rtworker - <job.task | gather -o out.pfm'
same 'start-up files that talk'
is 'standard error comes by lines, with the host, made harmless' "$err" 'talker: first \x1b[31mred
talker: \xffsecond'
echo 'mute via="echo Go away; echo now; exit 0; : %c"' >mute
run sh -c 'fan -S mute rtworker - <job.task'
is 'no hello from any host: exit 3' "$status" 3
like 'no hello from any host: its output is shown' "$err" '^fan: mute: cannot be used \(exit-0\), it says: Go away$'
echo 'mad via="yes %h; : %c"' >mad
run sh -c 'fan -S mad rtworker - <job.task'
is 'talk without end: exit 3' "$status" 3
like 'talk without end: a message says so' "$err" '^fan: mad: cannot be used \(no-hello\), it says: mad$'

# ---- hosts that are refused -----------------------------------------------------------------------------------------------
# spoken: the host was tried, and a message says so
spoken() { await 30 test -s liar.started && await 30 grep -q '^fan: liar:' .err && sleep .2; }
# refused NAME SCRIPT ERE: a host that runs SCRIPT beside a good one
refused() {
	script liar "echo >>liar.started; $2"
	rm -f liar.started
	printf 'liar slots=2 via="./liar %%c"\n: slots=1\n' >liars
	run eval '{ cat job.task; spoken; } | deal fan -S liars rtworker - | gather -o out.pfm'
	same "$1"
	like "$1: a message says so" "$err" "$3"
	is "$1: once" "$(printf '%s\n' "$err" | grep -c '^fan: liar:')" 1
}
hello=$(rtworker gears.nff </dev/null | head -1 | cut -d ' ' -f 1-4)
refused 'other arithmetic' "echo $hello selftest=77 power=99; exec cat >/dev/null" \
	'^fan: liar: refused: its arithmetic differs \(selftest=77, here [0-9a-f]{16}\)'
refused 'another version' 'echo hello rtworker 0.0 format=4 selftest=77; exec cat >/dev/null' \
	'^fan: liar: refused: it runs rtworker 0\.0, expected rtworker [0-9.]+ as here$'
refused 'another format' "echo ${hello% *} selftest=77; exec cat >/dev/null" \
	'^fan: liar: refused: its stream is of format 1, expected 4: use programs of one version, or begin a new log$'
refused 'lines of a terminal' 'sh -c "$1" | sed -u "s/\$/\r/"' \
	'^fan: liar: refused: its lines end in CR LF, as those of a terminal: expected LF'
refused 'a worker that is not there' 'exec no-such-worker' \
	'^fan: liar: no rtworker on its PATH; install it there, or say bin=DIRECTORY in a hosts file$'
refused 'a worker that cannot be run' 'exec /dev/null' '^fan: liar: rtworker cannot be run there; install one for that machine$'
script liar 'trap "echo told >>termed; exit" TERM; sh -c "$1" | { head -n 1; echo nonsense; sleep 9; } & wait'
run eval '{ cat job.task; await 60 test -s termed; } | MARK=$mark deal fan -S liars rtworker - | gather -o out.pfm'
same 'garbage'
like 'garbage: a message says what is wrong' "$err" '^fan: slot [0-9]+ on liar: its stream: unknown record, expected task, frame, frag, \.\.\.$'
like 'garbage: the worker gets SIGTERM before SIGKILL' "$(cat termed)" told
ok 'garbage: no process remains' await 2 none_alive

# ---- connections that fail ------------------------------------------------------------------------------------------
# flaky %h COMMAND: fails twice, then works
script flaky 'echo x >>"tries.$1"
[ "$(wc -l <"tries.$1")" -gt 2 ] || { echo "cannot reach $1" >&2; exit 255; }
exec sh -c "$2"'
printf ': slots=1\nflaky via="./flaky %%h %%c"\n' >flaky.hosts
fan -S flaky.hosts rtworker - <job.task >out.frags 2>said
is 'a host that comes late: exit 0' $? 0
gather -o out.pfm out.frags
same 'a host that comes late'
is 'a host that comes late is gone, then up, with the same number' "$(events out.frags | grep w=1 | sed 's/power.*//; s/ recv_us=.*//; s/ sum=.*//' | tr '\n' ';')" \
	'gone w=1 why=exit-255 lost=0;up w=1 host=flaky ;'
is 'the reason is shown once' "$(sed 's, for up to 30 s$,,' said)" 'flaky: cannot reach flaky
fan: flaky: cannot be reached (exit-255); trying again
fan: slot 1 on flaky: is up'

script crowd 'mkdir "crowd.$$"; n=$(ls -d crowd.*/ | wc -l); [ "$n" -eq 1 ] || [ "$n" -gt 8 ] || exit 255; exec sh -c "$1"'
echo 'crowd slots=8 via="./crowd %c"' >crowd.hosts
{ cat job.task; await 60 eval '[ "$(events crowd.frags | grep -c ^up)" -eq 8 ]'; } | fan -S crowd.hosts rtworker - >crowd.frags 2>said
gather -o out.pfm crowd.frags
same 'seven connections that fail at once'
is 'seven connections that fail at once: all slots come up' "$(events crowd.frags | grep -c ^up)" 8
is 'seven connections that fail at once: one message' "$(grep -c 'trying again' said)" 1

# long: a run on slots of other hosts, dealt one by one. All slots are up. Half of the tasks come when `proceed` is there.
partition 256x256 >rows
{ pack scene gears.nff; head -n 129 rows; } >long.task
tail -n +130 rows >rest.task
cat long.task rest.task | rtworker -a 16 - | gather -o long.pfm
printf 'a slots=2 via="sh -c %%c"\nb via="sh -c %%c"\n' >three
long() { # [SECONDS of silence]
	: >out.frags
	rm -f proceed
	env MARK=$mark limit="${1:-3}" sh -c '{ cat long.task; until [ -e proceed ]; do sleep .05; done; cat rest.task; } | deal sh -c "fan -t $limit -S three rtworker -a 16 - | tee out.frags" | gather -o out.pfm' 2>said &
	pid=$!
	await 5 ups 3
}
ups() { [ "$(events out.frags | grep -c '^up ')" -ge "$1" ]; }
long 600
# shellcheck disable=SC2046
kill -9 $(program rtworker | head -2)
await 20 ups 5
: >proceed
wait $pid
is 'two connections killed: exit 0' $? 0
same 'two connections killed' long.pfm
is 'two connections killed: both are made again' "$(events out.frags | grep -c '^up ')" 5
like 'two connections killed: messages say so' "$(cat said)" '^fan: slot [0-2] on [ab]: lost \(signal-9\) with [0-9]+ tasks, connecting again'
long
kill -STOP "$(program rtworker | head -1)"
: >proceed
wait $pid
is 'a silent one: exit 0' $? 0
same 'a silent one' long.pfm
like 'a silent connection: a message says so' "$(cat said)" '\(silent\) with [0-9]+ tasks, connecting again'
ok 'a silent one: no process remains' await 2 none_alive
long
kill -9 "$(program fan)"
: >proceed
ok 'kill -9 of fan: no process remains' await 2 none_alive
wait $pid

script killer 'sh -c "$1" | dd bs=1 count=200 2>/dev/null; echo x >>killed; exit 255'
printf 'killer via="./killer %%c"\n' >killer.hosts
run sh -c 'timeout 1200 deal fan -z off -S killer.hosts rtworker - <job.task >/dev/null'
is 'a worker that dies whenever it has work: the work is given up' "$status:$(wc -l <killed)" 1:4

script last 'trap "echo the last words >&2; exit 1" TERM; exec 3<&0; sh -c "$1" <&3 & wait'
echo 'last via="./last %c"' >last.hosts
{ cat job.task; await 10 eval '[ "$(events last.frags | grep -c ^up)" = 1 ]'; echo nonsense; } | fan -S last.hosts rtworker - >last.frags 2>said
is 'refused input: exit 2' $? 2
like 'the last words of a host are shown' "$(cat said)" '^last: the last words$'

# ---- hosts that never answer ---------------------------------------------------------------------------------------
# With tries=1000, fan would go on trying for hours, so a run that waits for such hosts does not end in time.
printf ': slots=1\nsleepy slots=20 tries=1000 via="sleep 7200; : %%c"\n' >sleepy
run timeout 1200 env MARK="$mark" sh -c 'deal fan -S sleepy rtworker - <job.task | gather -o out.pfm'
same 'hosts that never answer'
is 'hosts that never answer: the run does not wait for them' "$status" 0
ok 'hosts that never answer: no process remains' await 2 none_alive
printf ': slots=1\nlost slots=20 tries=1000 via="./none %%c"\n' >lost
{ pack scene gears.nff; partition -w "1$(printf ',1%.0s' $(seq 20))" 64x64; } >shares.task
run timeout 1200 sh -c 'deal fan -S lost rtworker - <shares.task | gather -o out.pfm'
same 'shares of slots that cannot be reached'
is 'shares of slots that cannot be reached: other slots get them before the last try' "$status" 0
script late 'until [ -e released ]; do sleep .1; done; exit 1'
printf ': slots=1\nlate tries=1 via="./late %%c"\n' >late.hosts
partition -u run:1 400x250 >many.task
fan -S late.hosts rtworker gears.nff <many.task >many.frags 2>said &
pid=$!
ok 'more tasks than fit into the queue of a late slot: the other slot has done its own' \
	await 30 eval '[ "$(grep -ac ^done many.frags)" -eq 50000 ]'
touch released
wait $pid
is 'more tasks than fit into the queue of a late slot, which never comes up: exit 1' $? 1
run fan -l -S late.hosts rtworker -
is 'fan -l with a dead host: exit 1' "$status" 1
is 'fan -l with a dead host: one line per slot' "$(printf '%s\n' "$out" | sed 's/:.*[0-9.]*$/: P/' | tr '\t\n' ' ;')" '0 : P;1 late -;'

# ---- many slots ----------------------------------------------------------------------------------------------------------
mkdir now
script slow 'mkdir now/$$; ls now | wc -l >>most; sleep .05; rmdir now/$$; exec sh -c "$1"'
echo 'many slots=100 via="./slow %c"' >many
{ cat job.task; await 120 eval '[ "$(events many.frags | grep -c ^up)" -ge 100 ]'; } | fan -S many rtworker - >many.frags
is '100 slots: all are up' "$(events many.frags | grep -c '^up')" 100
gather -o out.pfm many.frags
same '100 slots'
ok 'at most 8 connections to a host are opened at a time' [ "$(sort -n most | tail -1)" -le 8 ]

# ---- the runs that began first ------------------------------------------------------------------------------------------------
wait $half_pid
is 'one of two hosts is dead, interleaved: exit 1' "$(cat half.status)" 1
took_s=$(($(cat half.end) - start))
ok "one of two hosts is dead, interleaved: it ends after 30 s ($took_s)" [ $took_s -ge 29 ]
gather -m half.frags | rtworker gears.nff >>half.frags 2>/dev/null
gather -o out.pfm half.frags 2>/dev/null
same 'one of two hosts is dead, interleaved: gather -m and a worker finish it'
wait $drip_pid
is 'a scene that is on its way for 17 s: exit 0' "$(cat drip.status) $(unexpected drip.said)" '0 '
is 'a scene that is on its way to a tree for 17 s: not a word' "$(unexpected tree.said)" ''
rtworker - <large.task | gather -o large.pfm
for frags in drip tree; do
	gather -o out.pfm $frags.frags
	same "a scene that is on its way for 17 s: $frags" large.pfm
done
wait $none_pid
is 'no host can be reached: exit 3' "$(cat none.status)" 3
like 'no host can be reached: a message says so' "$(cat none.said)" 'no slot left: none could be reached for 30 s'
is 'no host can be reached: the stream ends with why=no-slot-left' "$(events none.frags | tail -1 | sed 's/ sum=.*//')" 'bye why=no-slot-left'
is 'no host can be reached: one message' "$(grep -c 'dead: cannot be reached' none.said)" 1
wait $behind_pid
is 'a host behind many silent ones: exit 0' "$(cat behind.status)" 0
gather -o out.pfm behind.frags
same 'a host behind many silent ones'
wait $tardy
like 'fan -l: a worker that says hello after 11 s is measured, with -t 60' "$(cat tardy.said)" '^0	:	[0-9.]+$'
finish
