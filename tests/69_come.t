#!/bin/sh
# Hosts come and go: the hosts file changes during a run. Events decide the order, never seconds: the second half of the
# tasks comes when the first half is done and the slots of the new file are there.
. "$(dirname "$0")/lib.sh"
# shellcheck source=tests/marked.sh
. "$root/tests/marked.sh"

# shellcheck disable=SC2154  # lib.sh sets them
spdgen -s 2 tetra >tetra.nff
size=64x64
partition $size >job.task
rtworker tetra.nff <job.task | gather -o good.pfm
# file NAME ...: replaces the hosts file, with a slot on each host
file() {
	for name; do echo "$name via=\"sh -c %c\""; done >hosts.new
	mv hosts.new hosts
}
# events ERE: how often the fan wrote such a record
events() { grep -a -c -E "^($1)( |$)" events; }
seen() { [ "$(events "$1")" -ge "$2" ]; }
gone_well() { [ "$(grep -a -c '^gone w=0 why=left lost=0' events)" -ge 1 ]; }
told() { grep -q "$1" said; }
# run_with POLICY ... -- FAN-OPTIONS: the first tasks on one host, the others on four
run_with() {
	policy=''
	while [ "$1" != -- ]; do policy="$policy${policy:+ }$1"; shift; done
	shift
	rm -f out.pfm events said
	: >events
	file first
	{
		pack scene tetra.nff
		sed -n 1,33p job.task
		await 60 seen 'done' 32
		file a b c d
		await 60 gone_well
		await 60 seen up 5
		sed -n '34,$p' job.task
	} | MARK=$mark sh -c "$policy sh -c 'fan $* | tee events'" 2>said | gather -o out.pfm 2>>said
}
for by in 'deal -q 0' 'deal -q 1' 'deal -q auto -e' ringctl 'ringctl -e'; do
	node=''
	[ "${by%% *}" = deal ] || node='ringctl -n'
	# shellcheck disable=SC2086
	run_with $by -- -S hosts $node rtworker -
	ok "$by: one host, then four others: the same picture" cmp out.pfm good.pfm
	is "$by: the first host drains and leaves, and no other" "$(events 'drain w=[0-9]+') $(grep -a '^drain' events | cut -d ' ' -f 2)" '1 w=0'
	is "$by: the others have the next numbers" "$(grep -a -o '^up w=[0-9]* host=[a-z]*' events | sort | tr '\n' ' ')" \
		'up w=0 host=first up w=1 host=a up w=2 host=b up w=3 host=c up w=4 host=d '
	is "$by: the first host did its half" "$(grep -a -c '^done .* w=0 ' events)" 32
	like "$by: a message counts the slots" "$(cat said)" '^fan: hosts: 4 slots join the run, 1 leave it$'
done
run_with deal -- -S hosts rtworker -c -
ok 'pixels that are held back: the same picture' cmp out.pfm good.pfm
is 'pixels that are held back: nothing is lost' "$(grep -a -c 'lost=[1-9]' events)" 0
run_with ringctl -- -S hosts ringctl -n rtworker -c -
ok 'pixels that nodes hold back: the same picture' cmp out.pfm good.pfm
is 'pixels that nodes hold back: nothing is lost' "$(grep -a -c 'lost=[1-9]' events)" 0

# ---- tasks of a node that leaves ------------------------------------------------------------------------------------
# The first worker does one task, once its node drains. The others of its queue must be handed over.
cat >gated <<'END'
#!/bin/sh
perl -e '$| = 1; while (<STDIN>) {
	if (/^task/ && !$n++) { $first = mkdir "gate" }
	if (/^task/ && $first && $n++ > 1) { sleep 1 while 1 }
	if (/^task/ && $first) { while (system "grep -aq \"^drain w=0\" events") { select undef, undef, undef, .1 } }
	print; if (/bytes=(\d+)/) { read STDIN, $b, $1 + 1; print $b }
}' | rtworker -
END
chmod +x gated
rm -f out.pfm
: >events
file first
{
	pack scene tetra.nff
	cat job.task
	await 60 seen up 1
	file a b c d
	await 60 gone_well
	await 60 seen up 5
} | MARK=$mark ringctl sh -c 'fan -t 1000 -S hosts ringctl -n ./gated | tee events' 2>said | gather -o out.pfm 2>>said
ok 'a node that leaves with tasks: the same picture' cmp out.pfm good.pfm
ok 'a node that leaves with tasks: it does not go on with its queue' [ "$(grep -a '^done' events | grep -c ' w=0 ')" -le 1 ]
is 'a node that leaves with tasks: others do the rest' "$(grep -a '^done' events | cut -d ' ' -f 3 | sort -u | wc -l)" 64

# ---- a task that crosses the news ------------------------------------------------------------------------------------
# A policy that has not read `drain` yet gives the slot another task: fan sends it. The policy is this script.
rm -f out.pfm
: >events
file first
{
	echo joins
	pack scene tetra.nff
	head -n 1 job.task
	await 60 seen up 1
	file other
	await 60 seen 'drain w=0' 1
	sed -n '2,33s/$/ to=0/p' job.task
	await 60 seen 'done' 32
	echo 'leave to=0'
	await 60 gone_well
	sed -n '34,$s/$/ to=1/p' job.task
} | fan -S hosts rtworker - 2>said >events
is 'a task for a slot that drains: nothing is lost, exit 0' "$? $(grep -a '^gone' events | cut -d ' ' -f 2-4)" '0 w=0 why=left lost=0'
gather -o out.pfm events 2>said
ok 'a task for a slot that drains: the same picture' cmp out.pfm good.pfm
ok 'all processes have ended' await 60 none_alive

# ---- a worker for each host: slots= and power= change -------------------------------------------------------------
# lines TEXT ...: replaces the hosts file
lines() {
	printf '%s via="sh -c %%c"\n' "$@" >hosts.new
	mv hosts.new hosts
}
for one in '' -1; do
	rm -f out.pfm events said
	: >events
	lines 'a slots=2' 'b slots=2'
	{
		pack scene tetra.nff
		sed -n 1,33p job.task
		await 60 seen 'done' 4
		lines 'a slots=3' 'b slots=1 power=7'
		await 60 seen up $((one ? 8 : 6))
		await 60 seen gone $((one ? 4 : 1))
		sed -n '34,$p' job.task
	} | MARK=$mark deal -q 1 sh -c "fan $one -S hosts rtworker - | tee events" 2>said | gather -o out.pfm 2>>said
	ok "slots= changes, fan $one: the same picture" cmp out.pfm good.pfm
	is "slots= changes, fan $one: the slots that leave" "$(grep -a '^gone' events | cut -d ' ' -f 2 | sort | tr '\n' ' ')" \
		"$(if [ "$one" ]; then echo 'w=0 w=1 w=2 w=3 '; else echo 'w=3 '; fi)"
	is "power= changes, fan $one: it is reported for the slot that stays" "$(grep -a '^up w=[0-9]* host=b ' events | grep -a ' power=7 ' | cut -d ' ' -f 2)" \
		"$(if [ "$one" ]; then echo w=7; else echo w=2; fi)"
	is "slots= changes, fan $one: all leave in good order" "$(grep -a '^gone' events | grep -v 'why=left lost=0')" ''
done

# ---- files that are wrong, and methods that cannot --------------------------------------------------------------
rm -f out.pfm events said
: >events
file first
{
	pack scene tetra.nff
	sed -n 1,33p job.task
	await 60 seen 'done' 4
	echo 'a slots=none' >>hosts
	await 60 told 'hosts stay'
	file first second
	await 60 seen up 2
	sed -n '34,$p' job.task
} | deal sh -c 'fan -S hosts rtworker - | tee events' 2>said | gather -o out.pfm
ok 'a bad version of the file: the same picture' cmp out.pfm good.pfm
is 'a bad version of the file: one message with the line, and the hosts stay' "$(grep -c '^fan: hosts:2: .*; the hosts stay as they were$' said)" 1
is 'a bad version of the file: no slot leaves' "$(events 'drain w=[0-9]+')" 0

rm -f out.pfm said
: >events
file first second
{
	pack scene tetra.nff
	sed -n 1,33p job.task
	await 60 seen 'done' 4
	file third
	await 60 told 'hosts stay'
	sed -n '34,$p' job.task
} | fan -S hosts rtworker - 2>said | tee events | gather -o out.pfm
ok 'tasks that were distributed in advance: the same picture' cmp out.pfm good.pfm
like 'tasks that were distributed in advance: a message says that the hosts stay' "$(cat said)" \
	'^fan: hosts has changed: the hosts stay as they were, because each task has its slot in advance; expected a method'

# The methods that cannot: all tasks have come when the first host has its first one.
cat >slow <<'END'
#!/bin/sh
exec perl -e '$| = 1; while (<STDIN>) {
	if (/^task/ && !$n++) {
		rename "later", "now"; # one of the two slots is the first
		for (1 .. 600) { last if !system "grep -q stay said"; select undef, undef, undef, .1 }
	}
	print; if (/bytes=(\d+)/) { read STDIN, $b, $1; print $b }
}' | sh -c "$1"
END
chmod +x slow
for method in interleaved ss sc gdc-published; do
	rm -f out.pfm
	echo 'a slots=2 via="./slow %c"' >now
	echo 'b via="sh -c %c"' >later
	patiently balance $method -S now -s $size -o out.pfm tetra.nff 2>said
	ok "$method: the same picture" cmp out.pfm good.pfm
	why='each task has its slot in advance'
	[ $method != gdc-published ] || why='the published ring has a fixed number of nodes'
	is "$method: one message, and no other host" "$(cat said)" \
		"fan: now has changed: the hosts stay as they were, because $why; expected a method whose slots may join and leave, such as adaptive"
done
finish
