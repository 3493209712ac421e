#!/bin/sh
# The ring on this machine. Processes are killed, stop, send garbage or leave: no task is lost and no process remains.
# Also: how fan handles the records between nodes and hub.
# shellcheck disable=SC2154,SC2016,SC2046,SC2094  # lib.sh sets them; scripts for others; a pid each; a log that grows
. "$(dirname "$0")/lib.sh"
needs ps

. "$root/tests/marked.sh"
spdgen -s 2 gears >gears.nff
partition 256x256 | rtworker -a 16 gears.nff | gather -o good.pfm
# long [OPTIONS]: starts a run of some seconds on 3 slots, in the background; endless: a run of hours, to be killed
long() {
	rm -f out.pfm
	# shellcheck disable=SC2086  # several words
	env MARK=$mark balance gdc ${slots:--j 3} ${work:--s 256x256 -W -a16} -o out.pfm "$@" gears.nff 2>said &
	pid=$!
}
# begin [OPTIONS]: the same with workers that are held back until whole
hold_rtworker
begin() {
	rm -f go held.*
	PATH=$tmp/holding:$PATH patience=600 long "$@"
	await 5 held 3
}
endless() {
	work='-s 1024x1024 -W -a1024' long
	await 5 working 3
}
# whole NAME: the run has ended well
whole() {
	: >go
	wait "$pid"
	is "$1: exit 0" $? 0
	ok "$1: the same picture" cmp out.pfm good.pfm
	ok "$1: no process remains" await 2 none_alive
}
nodes() { program ringctl 'ringctl -n '; }
hub() { program ringctl 'ringctl -e fan '; }

# ---- kill -9 of each stage -------------------------------------------------------------------------------------------
for stage in gather hub fan; do
	endless
	case $stage in hub) victim=$(hub) ;; *) victim=$(program $stage) ;; esac
	kill -9 "$victim"
	ok "kill -9 of $stage: no process remains" await 2 none_alive
	wait "$pid" 2>/dev/null
	is "kill -9 of $stage: no picture" "$(ls out.pfm* 2>/dev/null)" ''
done
env MARK=$mark sh -c '{ pack scene gears.nff; partition 1024x1024; } | ringctl fan -j 2 ringctl -n deal -q 1 fan -j 2 \
	ringctl fan -j 2 ringctl -n rtworker -a 1024 - | gather -o out.pfm' 2>said &
pid=$!
await 5 working 8
kill -9 "$(program gather)"
ok 'kill -9 of gather over rings in a ring: no process remains' await 2 none_alive
wait "$pid" 2>/dev/null
rm -f out.pfm
setsid env MARK=$mark perl -e '$SIG{INT} = "DEFAULT"; setpgrp; exec @ARGV' \
	balance gdc -j 3 -s 1024x1024 -W '-a 1024' -o out.pfm gears.nff 2>said &
pid=$!
await 5 working 3
kill -INT "-$(ps -o pgid= -p "$(program gather)" | tr -d ' ')"
ok 'Ctrl-C: no process remains' await 2 none_alive
wait "$pid" 2>/dev/null
is 'Ctrl-C: no picture' "$(ls out.pfm* 2>/dev/null)" ''

# ---- all tasks start at one node ------------------------------------------------------------------------------------------
# On a loaded machine too, no node begins before the others are up, and none goes on before all have done something.
cat >together <<'END'
#!/bin/sh
all() { : >"$1.$$"; until [ "$(find . -name "$1.*" | wc -l)" -ge 3 ]; do sleep .01; done; }
all up
rtworker -a 16 - | { dd bs=1 count=1500 2>dd.said; all did; cat; }
END
chmod +x together
{ pack scene gears.nff; partition -n 1 256x256; } |
	ringctl fan -t 600 -j 3 ringctl -n ./together 2>said | gather -r first.frags -o first.pfm
is 'all tasks start at one node: no message' "$(cat said)" ''
is 'all tasks start at one node: the others did only stolen tasks' "$(fragstat first.frags |
	awk '$1 == 1 || $1 == 2 { did += $2; had += $12; at += $2 > 0 } END { print at, did - had }')" '2 0'
ok 'all tasks start at one node: the same picture' cmp first.pfm good.pfm

# ---- nodes and workers that die, or stop -----------------------------------------------------------------------------
begin
kill -9 "$(held_workers | head -n 1)"
whole 'a worker killed'
like 'a worker killed: a message says so' "$(cat said)" 'fan: slot [0-2]: lost \(exit-3\)'
begin
kill -9 "$(nodes | head -n 1)"
whole 'a node killed'
like 'a node killed: a message says so' "$(cat said)" 'fan: slot [0-2]: lost \(signal-9\)'
begin
kill -9 $(nodes | head -n 2)
whole 'two of three nodes killed'
begin -W '-a 16 -c'
kill -9 "$(nodes | head -n 1)"
whole 'a node killed, concentrated transfer'
begin
kill -STOP "$(nodes | tail -n 1)"
# The others take its last task over, whether or not its silence is noticed before.
whole 'a node stopped'
begin
kill -STOP "$(held_workers | tail -n 1)"
whole 'a worker stopped'
begin
p=$(nodes | head -n 1)
kill -STOP "$p"
: >go
sleep 1
kill -CONT "$p"
whole 'a node stopped for 1 s'
is 'a node stopped for 1 s: no message' "$(unexpected said)" ''
echo ': slots=3 tries=2' >hosts
slots='-S hosts' begin
while kill -0 "$pid" 2>/dev/null; do
	rm -f held.*
	kill -9 $(nodes) 2>/dev/null
	until held 1 || ! kill -0 "$pid" 2>/dev/null; do sleep .05; done
done
: >go
wait "$pid"
# The frame is given up, or before that the last slot.
like 'all nodes killed, again and again: the run ends, and says why' "$?:$(grep -E 'given up|no slot left' said)" \
	'^(1:ringctl: frame 0: given up|3:fan: no slot left)'
ok 'all nodes killed: no process remains' await 2 none_alive
begin -r job.log
kill -9 "$(hub)"
: >go
wait "$pid" 2>/dev/null
ok 'the hub killed, with a log: no process remains' await 2 none_alive
long -r job.log
whole 'the hub killed, with a log: the same command finishes the picture'

# ---- nodes that cannot be trusted ------------------------------------------------------------------------------------
partition 128x128 | rtworker -a 16 gears.nff | gather -o small.pfm
{ pack scene gears.nff; partition -n 2 128x128; } >job.task
# liar NAME node|worker SCRIPT [WHY [absent]]: SCRIPT is one of two nodes, or its worker. The other node comes when this one
# is lost for this reason (an ERE), or else when it is up; absent: it never is.
liar() {
	rm -rf taken out.pfm
	: >up
	: >said
	limit=3
	case ${5-},${4-} in
	absent,*) after=true limit=30 ;; # the end waits for a worker of this machine as long, but the run must not
	,) after='grep -aq "^up " up' ;;
	*) after="grep -Eq 'lost .($4).' said" ;;
	esac
	case $2 in
	node) good='ringctl -n rtworker -a 16 -' command=./liar ;;
	worker) good='rtworker -a 16 -' command='ringctl -n ./liar' ;;
	esac
	printf '#!/bin/sh\nif mkdir taken 2>/dev/null; then\n%s\nfi\nuntil %s; do sleep .02; done\nexec %s\n' "$3" "$after" "$good" >liar
	chmod +x liar
	# shellcheck disable=SC2086  # words
	timeout 1200 env MARK=$mark ringctl sh -c 'fan -t "$@" | tee up' fan $limit -j 2 $command <job.task 2>said | gather -o out.pfm 2>>said
	is "$1: exit 0" $? 0
	ok "$1: the same picture" cmp out.pfm small.pfm
	[ -z "${4-}" ] || said "$1" "$4"
}
first() { echo "dd bs=1 count=$1 2>/dev/null"; } # a filter: the first COUNT bytes, as they come
# A filter: passes the stream on, and adds these records after each done.
cat >also <<'END'
$| = 1;
(my $say = shift) =~ s/;/\n/g;
while (defined(my $line = <STDIN>)) {
	print $line;
	if ($line =~ / bytes=(\d+)/) { read STDIN, my $body, $1; print $body }
	print $say if $line =~ /^done/;
}
END
said() { like "$1: a message says so" "$(cat said)" "lost \\(($2)\\)"; }
liar 'a worker that babbles after a while' worker "rtworker -a 16 - | { $(first 5000); cat /dev/urandom; }; exit" exit-3
liar 'a node that babbles after a while' node "ringctl -n rtworker -a 16 - | { $(first 5000); cat /dev/urandom; }; exit" garbage
liar 'a node that ends early' node "ringctl -n rtworker -a 16 - | $(first 5000); exit"
liar 'a node that ends at once' node 'exit 0' '' absent
liar 'a node that never says a word' node 'sleep 7200; exit' '' absent
ok 'a node that never sends a record: the run does not wait until it is lost' never_waits lost up
liar 'a worker that ends early, with 0' worker "rtworker -a 16 - | $(first 5000); exit"
# sealed RECORDS: prints them with their sums
sealed() { printf %s "$1" | tr ';' '\n' | "$root/tests/seal" | tr '\n' ';'; }
liar 'a worker that speaks to the hub' worker "rtworker -a 16 - | perl also '$(sealed 'ask;give 0 7 peer=1;')'; exit"
is 'a worker that sends records to the hub: no message' "$(unexpected said)" ''
# forger NAME RECORDS [WHY]: a node that also sends these records, with ; for newlines
forger() {
	liar "$1" node "ringctl -n rtworker -a 16 - | perl also '$(sealed "$2")'; exit" "${3-}"
}
forger 'tasks given away that are its own, and done all the same' 'give 0 120 peer=0;give 0 121 peer=1;give 0 60 peer=1;give 0 61 peer=0;'
forger 'tasks given away that there are not' 'give 0 128 peer=0;give 7 1 peer=1;'
forger 'tasks given to a node that does not exist' 'give 0 1 peer=2;' wrong-peer
forger 'none for a node that does not exist' 'none peer=0 next=4096;' wrong-peer
forger 'answers without a request, and crash reports on living nodes' 'none peer=0 idle=1;none peer=1;crashed peer=0;crashed peer=1;ask peer=0;ask peer=1;'
forger 'what only the hub says' 'heir peer=0;' wrong-record
forger 'asks without end' "$(printf 'ask;%.0s' $(seq 3000))" unasked
ok 'liars leave no process' await 2 none_alive

# ---- readers and disks -----------------------------------------------------------------------------------------------
run sh -c "env MARK=$mark ringctl fan -j 2 ringctl -n rtworker - <job.task | head -c 1000 >/dev/null"
ok '| head -c 1000: no process remains' await 2 none_alive
is '| head -c 1000: not a word' "$err" ''
for p in 'ringctl fan -j 2 ringctl -n rtworker -' 'ringctl -n rtworker -'; do
	run sh -c "env MARK=$mark $p <job.task >/dev/full"
	is "$p >/dev/full: exit 3" "$status" 3
	ok "$p >/dev/full: no process remains" await 2 none_alive
	run sh -c "timeout 1200 $p <&-"
	is "$p <&-: exit 3" "$status" 3
	run sh -c "timeout 1200 $p <job.task >&-"
	is "$p >&-: exit 3" "$status" 3
done
{ pack scene gears.nff; partition -n 2 512x512; } | env MARK=$mark ringctl fan -j 2 ringctl -n rtworker - |
	{ sleep 4; gather -o out.pfm; }
partition 512x512 | rtworker gears.nff | gather -o big.pfm
ok 'a reader that stops for 4 s: the whole picture' cmp out.pfm big.pfm

# ---- refusals -------------------------------------------------------------------------------------------------
refused() { # NAME RECORDS COMMAND ...
	name=$1
	# shellcheck disable=SC2059  # records, with \n
	printf "$2" >bad.task
	shift 2
	run env MARK=$mark timeout 1200 "$@" <bad.task
	is "$name: exit 2" "$status" 2
	ok "$name: no process remains" await 2 none_alive
}
refused 'fan, an ask without a slot' 'ask peer=0\n' fan -j 2 rtworker -
refused 'fan, a question to a slot that is not there' 'ask peer=0 to=2\n' fan -j 2 rtworker -
refused 'fan, what a node says' 'give 0 0 peer=0 to=1\n' fan -j 2 rtworker -
refused 'a hub that hears another' 'ring me=0 n=1 rules=default\n' ringctl fan -j 2 ringctl -n rtworker -
refused 'deal, a record of the ring' 'ask\n' deal fan -j 2 rtworker -
refused 'a node, what another node says' 'crashed peer=0\n' ringctl -n rtworker -
for bad in '' '-n' '-k one fan' '-x' '-n -p rtworker'; do
	# shellcheck disable=SC2086
	run ringctl $bad </dev/null
	is "ringctl $bad: exit 2" "$status" 2
done
run sh -c "timeout 1200 env MARK=$mark ringctl fan -j 2 rtworker - <job.task >/dev/null"
like 'a ring of workers that are no nodes: a message says so' "$err" 'rtworker: .*record .ring.'
ok 'a ring of workers that are no nodes: no process remains' await 2 none_alive

# ---- how fan handles records of nodes -------------------------------------------------------------------------------
cat >mute <<'END'
echo hello x 1 format=4 selftest=0
cat >said.$(date +%N)
END
printf '%s\n' 'ring me=0 n=2 rules=default to=0' 'none peer=1 idle=1 next=0 to=1' 'ask to=0' >few
wrote() { [ "$(grep -ac "^$1 " out)" -ge "$2" ]; } # RECORD TIMES: fan did
{ await 10 wrote up 2; cat few; } | fan -j 2 sh mute >out
is 'fan: each record goes to its slot, without to=' "$(sed 's/ sum=.*//' said.* | sort | tr '\n' ';')" \
	'ask;none peer=1 idle=1 next=0;ring me=0 n=2 rules=default;'
printf '#!/bin/sh\necho hello x 1 format=4 selftest=0; sleep .2; echo ask; cat >/dev/null\n' >asks && chmod +x asks
{ echo 'frame 0 1 1'; await 10 wrote gone 1; } | fan -j 1 ./asks 2>said >out
said 'fan: a node without a place' 'wrong-record'
printf '#!/bin/sh\nexit 0\n' >ends && chmod +x ends
{ pack scene gears.nff; await 10 wrote gone 1; } | fan -j 1 ./ends >out 2>/dev/null
like 'fan: a worker that ends at once is gone, even while it is fed' "$(grep -a '^gone' out)" 'w=0 why=exit-0'

# ---- the paper's Table 3: 3 hosts of power .77, 2 of 1, 4 of 1.96, of which two are removed after 300 of 512 rows -----
# In 4 s instead of 14; a removed host cannot be reached any more.
partition 32x512 | rtworker gears.nff | gather -r one.frags -o table.pfm
scale=$(fragstat -s one.frags | awk '$1 == "cpu_s" { print 12.15 * 4 / $2 }')
cat >via <<'END'
[ ! -e removed ] || exit 255
export REPLAY_POWER="$1"
echo $$ >"pid.$2"
exec sh -c "$3"
END
for power in .77 .77 .77 1 1 1.96 1.96 1.96 1.96; do
	hosts=$((${hosts-0} + 1))
	echo "host$hosts power=$power via=\"sh via $power $hosts %c\""
done >table.hosts
# Each worker holds what it has done back until all hosts are up, and from its 34th row on until the removal: then about 300
# rows have come, and no node has stolen one, whatever the load.
cat >gated <<'END'
$| = 1;
sub hold { select undef, undef, undef, .02 until $_[0]->() }
while (defined(my $line = <STDIN>)) {
	my $body = '';
	read STDIN, $body, $1 + 1 if $line =~ / bytes=(\d+)/;
	if ($line =~ /^done/) {
		hold(sub { @{[glob 'pid.*']} == 9 });
		open my $file, '>>', 'rows' or die;
		syswrite $file, 'r';
		$rows++;
		hold(sub { $rows < 34 || -e 'removed' });
	}
	print $line, $body;
}
END
printf '#!/bin/sh\nreplay -x %s one.frags | perl gated\n' "$scale" >gate && chmod +x gate
after() { [ "$(wc -c <rows)" -ge 306 ]; }
# table [OPTIONS]
table() {
	rm -f removed table.frags out.pfm pid.*
	: >rows
	partition -n 9 32x512 | env MARK=$mark timeout 1200 ringctl "$@" fan -t 600 -S table.hosts ringctl -n ./gate 2>said |
		gather -r table.frags -o out.pfm &
	await 20 after
	[ "$remove" = none ] || kill -9 $(cat pid.6 pid.8)
	: >removed
	wait $!
	status=$?
}
# finished NAME
finished() {
	is "Table 3, $1: exit 0" $status 0
	ok "Table 3, $1: the same picture" cmp out.pfm table.pfm
	diag "Table 3, $1: $(fragstat -s -S table.hosts table.frags | grep -E 'makespan|bound|steals' | tr '\n\t' '; ')"
}
# The published rules have hazards, and load causes some of them: one of three runs must be complete.
published() {
	for try in 1 2 3; do
		table -p
		[ $status != 0 ] || break
		diag "as published, try $try: exit $status, $(cat said)"
	done
}
remove=none
published
finished 'no host removed'
remove=two
published
finished 'as published'
is 'Table 3: two hosts were removed' "$(grep -c 'lost (signal-9)' said)" 2
table
finished 'by default'
ok 'Table 3: no process remains' await 2 none_alive
finish
