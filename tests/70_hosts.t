#!/bin/sh
# tests/hosts itself: test hosts are reached by ssh, see neither the clone nor the scene, take commands, and leave
# nothing behind.
want_hosts=0
. "$(dirname "$0")/hosts.sh"
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
hosts=$root/tests/hosts

# This system is the same before, during and after a run, except for the directories of other tests.
system() { ip -o link | sed 's/ state .*//'; ip route; grep -v ' /tmp/' /proc/mounts; }
system >before
echo scene >scene.nff

# within SCRIPT: prints its output among two hosts; each line is one answer
within() { "$hosts" with 2 sh -c "$1" hosts "$hosts" "$root" "$tmp" 2>&1; }
is 'ssh reaches every host' "$(within 'ssh host1 hostname; ssh host2 hostname; ssh host1 true </dev/null')" 'host1
host2'
is 'a host has the programs' "$(within 'ssh host2 /home/render/bin/fan -h' | head -1)" "$(fan -h | head -1)"
is 'a host has neither the clone nor the scene' "$(within 'ls "$2/bin/fan" "$3/scene.nff" >/dev/null && echo here
	for h in host1 host2; do ssh $h "ls -d $2/* $3" 2>/dev/null || echo none; done')" 'here
none
none'
is 'a host has none of the programs on its PATH' "$(within 'ssh host1 command -v fan rtworker || echo none')" none
is 'a host has no route out' "$(within 'ip route | grep -v ^198.18.0 && echo out
	ssh host1 ip route | grep -v ^198.18.0 || echo none')" none
is 'the status is the command'\''s' "$(within 'exit 7' >said; echo $?)" 7

# Upper bounds for a limited host, which load on this system cannot break.
if within '"$1" power host1 .5' >said; then
	is 'a host of power .2 gets no more' "$(within '"$1" power host1 .2
		"$1" run host1 bash -c "TIMEFORMAT=%U; time timeout 1 sh -c \"while :; do :; done\""' |
		awk '{ print $1 < .4 ? "so" : $1 }')" so
else
	skip 'a host of power .2 gets no more' "$(cat said)"
fi
is 'a link can be down, and up again' "$(within '"$1" link host1 down
	ssh -oConnectTimeout=1 host1 true 2>/dev/null || echo down
	ssh host2 true && echo other; "$1" link host1 up; ssh host1 true && echo up')" 'down
other
up'
is 'a slow link is slow, both ways' "$(within '"$1" link host1 4mbit
	for way in "cat >/dev/null" "head -c 200000 /dev/zero"; do
		start=$(date +%s%N); head -c 200000 /dev/zero | ssh host1 "$way" | wc -c
		[ $((($(date +%s%N) - start) / 1000000)) -ge 300 ] && echo slow; done')" '0
slow
200000
slow'
is 'no host answers at the address of nowhere' "$(within 'ssh -oConnectTimeout=1 nowhere true 2>&1 | tr -d "\r"')" \
	'ssh: connect to host 198.18.0.253 port 22: Connection timed out'
is 'sshd can be killed, and started again' "$(within 'kill -9 $("$1" pids host1 sshd)
	ssh host1 true 2>/dev/null || echo dead
	"$1" sshd host1; ssh host1 echo back')" 'dead
back'

# ---- nothing remains, however a run ends -----------------------------------------------------------------------------
left() { # RUN: what still tells of it
	grep -lz "^TEST_HOSTS=$1\$" /proc/[0-9]*/environ
	ls -d "$1"
	find /sys/fs/cgroup -name "${1##*/}"
} 2>/dev/null
none_left() { [ -z "$(left "$1")" ]; }
for signal in EXIT INT TERM HUP KILL; do
	rm -f ready
	script='echo $TEST_HOSTS >ready.new; ssh host1 "exec sleep 7200" & mv ready.new ready; sleep 7201'
	[ $signal = EXIT ] && script='echo $TEST_HOSTS >ready; ssh host1 "sleep 7200 >/dev/null 2>&1 &"'
	# A session of its own, and the default action for the signal, as a terminal gives.
	setsid perl -e '$SIG{INT} = $SIG{HUP} = "DEFAULT"; setpgrp; exec @ARGV' "$hosts" with 2 sh -c "$script" >said 2>&1 &
	pid=$!
	await 10 test -s ready
	run_of=$(cat ready)
	[ $signal = EXIT ] || kill "-$signal" "-$(ps -o pgid= -p "${run_of##*.}" | tr -d ' ')"
	wait "$pid" 2>/dev/null
	ok "no process and no file remains after $signal" await 3 none_left "$run_of"
done
rm -f ready
"$hosts" with 2 sh -c 'echo $TEST_HOSTS >ready; exec sleep 7200' &
await 10 test -s ready
run_of=$(cat ready)
# shellcheck disable=SC2046
kill -9 $(pgrep -f -- "-janitor ${run_of##*.} ") "${run_of##*.}"
wait "$!" 2>/dev/null
ok 'a killed janitor leaves files' [ -d "$run_of" ]
"$hosts" with 1 true
ok 'the next run removes the rest' await 3 none_left "$run_of"

"$hosts" with 3 sh -c 'ssh host3 "sleep 1; hostname"' >one &
"$hosts" with 2 sh -c 'ssh host2 "sleep 1; hostname"; ssh host3 true || echo no' >two 2>&1
wait
is 'two runs at once are separate' "$(cat one two | grep -v '^ssh:' | tr '\n' ' ')" 'host3 host2 no '
system >after
ok 'this system is unchanged' cmp before after
finish
