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
# run_with DEAL ... -- FAN-OPTIONS: the first tasks on one host, the others on four
run_with() {
	deal=''
	while [ "$1" != -- ]; do deal="$deal${deal:+ }$1"; shift; done
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
	} | MARK=$mark sh -c "deal $deal sh -c 'fan $* | tee events'" 2>said | gather -o out.pfm 2>>said
}
for deal in '-q 0' '-q 1' '-q auto -e'; do
	# shellcheck disable=SC2086
	run_with $deal -- -S hosts rtworker -
	ok "deal $deal: one host, then four others: the same picture" cmp out.pfm good.pfm
	is "deal $deal: the first host drains and leaves, and no other" "$(events 'drain w=[0-9]+') $(grep -a '^drain' events | cut -d ' ' -f 2)" '1 w=0'
	is "deal $deal: the others have the next numbers" "$(grep -a -o '^up w=[0-9]* host=[a-z]*' events | sort | tr '\n' ' ')" \
		'up w=0 host=first up w=1 host=a up w=2 host=b up w=3 host=c up w=4 host=d '
	is "deal $deal: the first host did its half" "$(grep -a -c '^done .* w=0 ' events)" 32
	like "deal $deal: a message counts the slots" "$(cat said)" '^fan: hosts: 4 slots join the run, 1 leave it$'
done
run_with -q 0 -- -S hosts rtworker -c -
ok 'pixels that are held back: the same picture' cmp out.pfm good.pfm
is 'pixels that are held back: nothing is lost' "$(grep -a -c 'lost=[1-9]' events)" 0
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
		await 60 seen up $((one ? 8 : 5))
		await 60 seen gone $((one ? 4 : 1))
		sed -n '34,$p' job.task
	} | MARK=$mark deal -q 1 sh -c "fan $one -S hosts rtworker - | tee events" 2>said | gather -o out.pfm 2>>said
	ok "slots= changes, fan $one: the same picture" cmp out.pfm good.pfm
	is "slots= changes, fan $one: the slots that leave" "$(grep -a '^gone' events | cut -d ' ' -f 2 | sort | tr '\n' ' ')" \
		"$(if [ "$one" ]; then echo 'w=0 w=1 w=2 w=3 '; else echo 'w=3 '; fi)"
	is "power= changes, fan $one: it is reported for slots that come up later" "$(grep -a '^up w=[0-9]* host=b ' events | grep -a -c ' power=7 ')" \
		"$(if [ "$one" ]; then echo 1; else echo 0; fi)"
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
	'^fan: hosts has changed: the hosts stay as they were, because the tasks or nodes were set in advance'

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
for method in interleaved ss sc gdc; do
	rm -f out.pfm
	echo 'a slots=2 via="./slow %c"' >now
	echo 'b via="sh -c %c"' >later
	balance $method -S now -s $size -o out.pfm tetra.nff 2>said
	ok "$method: the same picture" cmp out.pfm good.pfm
	is "$method: one message, and no other host" "$(sed 's/, because.*such as/ .../' said)" \
		'fan: now has changed: the hosts stay as they were ... adaptive'
done
finish
