#!/bin/sh
# Launchers that are not ssh, in the place of via=: one that forwards whole lines, one that queues, and some that end with
# a status of their own. 73_slurm.t has Slurm itself.
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"
patient
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others

script() { cat >"$1" && chmod +x "$1"; }
spdgen -s 2 gears >gears.nff
size=64x64
partition $size | rtworker gears.nff | gather -o good.pfm
{ pack scene gears.nff; partition $size; } >job.task
events() { grep -aE '^(up|gone|bye)( |$)' "$1"; }

# ---- limits that take seconds, beside the rest -----------------------------------------------------------------------------
script none <<'END'
#!/bin/sh
echo try >>"$1.tries"
exit 255
END
# Eight tries take 35 s, and 30 s without a slot end a run if nothing is stated.
echo 'none tries=8 via="./none %h %c"' >none.hosts
(in_time fan -S none.hosts rtworker - <job.task >none.frags 2>none.said; echo $? >none.status) &
none_pid=$!
# A queue that lasts longer than the 15 s that a connection may take.
script queue <<'END'
#!/bin/sh
echo try >>"$1.tries"
until [ -e "$1.released" ]; do sleep .1; done
exec sh -c "$2"
END
printf ': slots=1\nlong slots=2 wait=3600 via="./queue %%h %%c"\n' >long.hosts
(in_time fan -S long.hosts rtworker - <job.task >long.frags 2>long.said; echo $? >long.status) &
long_pid=$!
(await 20 grep -q 'queued by' long.said; sleep 15; touch long.released) &

# ---- whole lines --------------------------------------------------------------------------------------------------------
# It writes a line when its newline has come, and never a part of one.
script lines <<'END'
#!/usr/bin/perl
$| = 1;
while (<STDIN>) { print if /\n\z/ }
END
script relay <<'END'
#!/bin/sh
./lines | sh -c "$1" | ./lines
END
printf 'a slots=2 via="./relay %%c"\nb slots=2 via="./relay %%c"\n' >relays
printf '{ head -c 1000; echo; } </dev/zero | tr "\\0" x; printf "no newline"' >said.sh
is 'the relay forwards whole lines, and nothing else' "$(sh said.sh | ./lines | wc -lc | tr -s ' ')" ' 1 1001'
for method in adaptive dc ds gdc gdc-published hybrid interleaved masterslave sc ss; do
	run in_time balance $method -S relays -s $size -o out.pfm gears.nff
	is "whole lines, $method: exit 0" "$status$(printf %s "$err" | grep -v 'never connected$')" 0
	ok "whole lines, $method: the same picture" cmp out.pfm good.pfm
	rm -f out.pfm
done
run in_time sh -c 'deal -q 4 fan -1 -S relays rtworker - <job.task | gather -o out.pfm'
ok 'whole lines, fan -1: the same picture' cmp out.pfm good.pfm
rm -f out.pfm
run in_time sh -c 'deal -q 4 fan -S relays deal fan -j 2 rtworker - <job.task | gather -o out.pfm'
ok 'whole lines, a tree: the same picture' cmp out.pfm good.pfm

# The last pixels of a slot wait for no later record.
rm -f out.pfm
ok 'whole lines: the picture is there before the input ends' eval '{ cat job.task; await 20 test -s out.pfm; echo $? >before; } |
	fan -S relays rtworker - | gather -o out.pfm && cmp out.pfm good.pfm && [ "$(cat before)" = 0 ]'

# ---- a launcher that ends ----------------------------------------------------------------------------------------------------
# ends STATUS: after the first `done` its connection ends with this status; the next one ends at once, then it works
script ends <<'END'
#!/bin/sh
echo try >>tries
case $(wc -l <tries) in
1) sh -c "$1" | sed -u '/^done/q'; exit "$(cat status)" ;;
2) echo 'no node is there' >&2; exit 1 ;;
esac
exec sh -c "$1"
END
echo 'ends via="./ends %c"' >ends.hosts
for code in 0 1 2 9 143; do
	rm -f tries out.pfm
	echo $code >status
	run in_time sh -c 'deal fan -S ends.hosts rtworker - <job.task | gather -o out.pfm'
	ok "a launcher that ends with $code: the same picture" cmp out.pfm good.pfm
	is "a launcher that ends with $code: three tries" "$(wc -l <tries)" 3
	is "a launcher that ends with $code: messages say so" "$(printf '%s\n' "$err" | sed 's/with [0-9]* tasks/with N tasks/')" \
		"fan: slot 0 on ends: lost (exit-$code) with N tasks, connecting again
ends: no node is there
fan: ends: cannot be reached (exit-1); trying again for up to 10 minutes
fan: slot 0 on ends: is up"
done
for code in 126 127; do
	rm -f tries
	echo $code >status
	run in_time sh -c 'deal fan -S ends.hosts rtworker - <job.task >ends.frags'
	is "a launcher that ends with $code: exit 3, and one try" "$status$(cat tries)" 3try
done

# ---- the end of a run --------------------------------------------------------------------------------------------------------
# A task of hours, and `bye`. A worker is told so before its launcher is stopped; then it ends by itself, with success.
{ pack scene gears.nff; partition -u run:4000000 2000x2000 | head -n 2; } >endless.task
printf '#!/bin/sh\ntrap "" TERM\ntee got | sh -c "$1"\n' >polite && chmod +x polite
for chain in 'rtworker -a 1024 -' 'rtworker -a 1024 -j 2 -' 'fan -j 2 rtworker -a 1024 -' 'deal fan -j 2 rtworker -a 1024 -' \
	'ringctl -n rtworker -a 1024 -'; do
	run in_time sh -c "{ cat endless.task; sleep .3; echo bye; } | $chain >ended.frags"
	is "$chain: \`bye\` ends it, with 0 and without a word" "$status$err" 0
done
mkfifo open
for one in '' -1; do
	rm -f got
	echo "polite slots=${one:+2} via=\"./polite %c\"" | sed 's/slots= //' >polite.hosts
	MARK=$mark fan $one -S polite.hosts rtworker -a 1024 - <open >polite.frags 2>polite.said &
	pid=$!
	exec 7>open
	cat endless.task >&7
	await 20 grep -aq '^up ' polite.frags
	kill -TERM $pid
	wait $pid
	exec 7>&-
	like "fan ${one:-without -1}: workers are told that the run is over" "$(tail -n 1 got | tr -d '\0')" '^bye( |$)'
	ok "fan ${one:-without -1}: no process remains" await 10 none_alive
done

# ---- tries= ------------------------------------------------------------------------------------------------------------------
script killer <<'END'
#!/bin/sh
echo try >>killer.tries
sh -c "$1" | dd bs=1 count=200 2>/dev/null
exit 255
END
echo 'killer tries=2 via="./killer %c"' >killer.hosts
run in_time sh -c 'deal fan -S killer.hosts rtworker - <job.task >killer.frags'
is 'tries=2, tasks that kill: given up after two' "$status$(wc -l <killer.tries)" 32
printf 'less slots=3 tries=2 via="./none %%h %%c"\n: slots=1\n' >less.hosts
given_up() { grep -q 'no try is left' .err; }
run eval '{ cat job.task; await 20 given_up; } | in_time deal fan -S less.hosts rtworker - | gather -o out.pfm'
is 'tries=2, a host that is not reached: two tries, and messages' "$(wc -l <less.tries)$err" \
	"2fan: less: cannot be reached (exit-255); trying again, 2 times in all
fan: less: cannot be used (exit-255); no try is left (tries=2)
fan: 3 of 4 slots never connected"

# ---- wait= -------------------------------------------------------------------------------------------------------------------
printf 'far slots=2 wait=3600 via="./queue %%h %%c"\n: slots=1\n' >far.hosts
{ pack scene gears.nff; partition -w 1,1,1 $size; } >shares.task
rm -f out.pfm
run in_time sh -c 'deal sh -c "fan -S far.hosts rtworker - | tee far.frags" <shares.task | gather -o out.pfm'
ok 'a queued host with a share: others do that share' cmp out.pfm good.pfm
is 'a queued host with a share: a message names it, and one counts its slots' "$(printf '%s\n' "$err" | sed 's/; [12] queued/; N queued/')" \
	'fan: far: queued by its launcher; waiting for up to 3600 s
fan: 2 of 3 slots never connected; N queued'
is 'a queued host with a share: its slots are gone, for policies' "$(events far.frags | grep 'w=[01]' | sed 's/ recv_us=.*//' | sort | tr '\n' ';')" \
	'gone w=0 why=queued lost=0;gone w=1 why=queued lost=0;'
run in_time fan -l -S far.hosts rtworker -
is 'fan -l does not wait for a queue' "$status $(printf '%s\n' "$out" | cut -f 1-2 | tr '\t\n' ' ;')$err" \
	'1 0 far;1 far;2 :;fan: far: cannot be used (queued)'
rm -f out.pfm
ok 'hybrid with a queued host: exit 0' in_time balance hybrid -S far.hosts -s $size -o out.pfm gears.nff
ok 'hybrid with a queued host: the same picture' cmp out.pfm good.pfm
echo 'brief wait=6 tries=1 via="./queue %h %c"' >brief.hosts
run in_time sh -c 'fan -S brief.hosts rtworker - <job.task >brief.frags'
is 'wait= is over: a failed connection' "$status$(wc -l <brief.tries)$err" '31fan: brief: queued by its launcher; waiting for up to 6 s
fan: brief: cannot be used (no-hello); no try is left (tries=1)
fan: no slot left'

# ---- the runs that began first -------------------------------------------------------------------------------------------------
wait $long_pid
is 'a host that was queued for long: exit 0' "$(cat long.status)" 0
gather -o out.pfm long.frags
ok 'a host that was queued for long: the same picture' cmp out.pfm good.pfm
is 'a host that was queued for long: one try for each slot' "$(wc -l <long.tries)" 2
is 'a host that was queued for long: gone, then up' "$(events long.frags | grep w=1 | sed 's/ power.*//; s/ recv_us=.*//; s/ sum=.*//' | tr '\n' ';')" \
	'gone w=1 why=queued lost=0;up w=1 host=long;'
like 'a host that was queued for long: a message says that it is up' "$(cat long.said)" '^fan: slot 1 on long: is up$'
wait $none_pid
is 'tries=8: exit 3, after eight tries' "$(cat none.status)$(wc -l <none.tries)" 38
is 'tries=8: messages' "$(cat none.said)" 'fan: none: cannot be reached (exit-255); trying again, 8 times in all
fan: none: cannot be used (exit-255); no try is left (tries=8)
fan: no slot left'
finish
