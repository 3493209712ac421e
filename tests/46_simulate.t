#!/bin/sh
# simulate: the times of tiny runs, computed by hand; the same seed gives the same bytes; refusals.
# shellcheck disable=SC2154  # lib.sh sets them
. "$(dirname "$0")/lib.sh"

# of KEY: from the last run's figures
of() { printf '%s\n' "$out" | awk -F '\t' -v key="$1" '$1 == key { print $2 }'; }

# ---- by hand -----------------------------------------------------------------------------------------------
# Four tasks of 1 s on hosts of power 1 and 2; a message takes .1 s. deal knows at .1 that both are up; they get tasks at .2.
# On demand: the first does task 0 until 1.2, the second task 1 until .7 and, after a round trip, task 2 from .9 to 1.4; the
# first gets task 3 at 1.4 and is done at 2.4, which deal knows at 2.5.
partition 1x4 >four.task
two() { run simulate -m 1e6 -w 1,2 -l 100 "$@" <four.task; }
# takes NAME SECONDS OPTIONS ...
takes() {
	name=$1 s=$2
	shift 2
	two "$@"
	is "$name" "$status $(of makespan_s)" "0 $s"
}
takes 'deal: by hand' 2.500000 deal
is 'deal: the time in tasks' "$(of busy_s)" 3.000000
is 'deal: the time until the first task, of both slots' "$(of startup_s)" 0.400000
is 'deal: the time between tasks' "$(of waiting_s)" 0.400000
is 'deal: the time after the last task' "$(of tail_s)" 1.200000
is 'no schedule is faster than sum of costs / sum of powers' "$(of bound_s)" 1.333333
is 'no simulated run is faster than that and three messages' "$(of least_s)" 1.633333
is 'efficiency is bound / makespan' "$(of efficiency)" 0.5333
# A hello takes 104 bytes, a task 34, a pixel 117, done 53, or 51 where times have a digit less, and a flush 6.
is 'records and bytes on all links' "$(of records) $(of bytes)" "16 $((2 * (104 + 53 + 51 + 6) + 4 * (34 + 117))).000000"
is 'the work of a run that repeats none' "$(of work_s)" 4.000000
takes 'deal -q 1: two tasks each, at once' 2.300000 deal -q 1
takes 'adaptive: two tasks each, at once, and a copy of the second one of the first' 2.000000 adaptive
is 'the work of an unfinished copy counts: .6 s' "$(of work_s)" 4.600000
takes 'adaptive: the first becomes a thousand times slower, the other one does all' 2.700000 -f slow@.1s:0:.001 adaptive
takes 'fan: the same' 2.300000 fan
takes 'best: one task to the first, three to the second' 1.800000 best
partition -n 1 1x4 >first.task
run simulate -m 1e6 -w 1,2 -l 100 fan <first.task
is 'fan: all tasks preassigned to one slot' "$(of makespan_s)" 4.300000
takes 'costs twice as high' 4.500000 -x 2 deal
takes 'no latency' 2.000000 -l 0 deal
takes 'a crash, which the first hears of; and does all' 4.900000 -f crash@.5s:1 deal
is 'one crash, and all tasks are committed' "$(of crashes) $(of uncommitted)" '1 0'
is 'lost work counts: .3 s of power 2' "$(of work_s)" 4.600000
takes 'a crash when two tasks are there' 3.700000 -f crash@2:1 deal
takes 'silence: what it had is given to the first 3 s later' 5.800000 -f silence@.5s:1 deal -q 1
run simulate -v -m 1e6 -f pause@.5s:0 fan <four.task
is 'a pause: the task goes on where it was, and ends later by the pause' "$(of makespan_s)" \
	"$(printf '%s\n' "$out" | awk '/ resumes$/ { printf "%.6f", 3.5 + $2 / 1e6 }')"
takes 'a fifth as fast from .9 s on, in the middle of a task' 2.500000 -f slow@.9s:0:.2 deal
# Both connect at .5 s; a scene of 500 bytes comes with the first task at .7, and takes a second of power 1 to be built. The
# first does task 0 from 1.7 to 2.7. The second does task 1 from 1.2 to 1.7, and after round trips tasks 2 and 3, to 3.1.
takes 'hosts connect, get their state and build it' 3.200000 -p .5,500,1 deal
is 'no run is faster than the power that is left then: T - 1.8 + 2 (T - 1.3) = 4' "$(of bound_s) $(of least_s)" '1.333333 2.800000'
# The first has .5 s of task 0 at 1.2, and 1.25 of .4 a second later; the second joins at 1 s and does three tasks by 3.1.
printf '0 0 .5\n1.2 0 .4\n0 1 0\n1 1 1\n' >shares
takes 'shares of power that change in a task, and a host that joins' 3.200000 -L shares deal
is 'no run is faster than the shares that are left' "$(of least_s | awk '{ print ($1 < 3) }')" 1
two -f crash@.5s:1 fan
is 'a static method does not recover' "$status $(of uncommitted) $(of efficiency)" '1 2 0.0000'
like 'a static method: the message has the command to repeat the run' "$err" "to repeat, with the same tasks: simulate -m 1e6 -w 1,2 -l 100 -f crash@.5s:1 fan$"
# At 1000 bytes a second a hello takes .104 s, a task .034, done .053, and a pixel with its record .117 s. So the hub knows at
# .204 that the first is up; task 0 runs from .338 to 1.338, task 2 to 2.338; its pixel is at the hub at 2.608.
takes 'a link takes the bytes of records and pixels' 2.608000 -b 1000 fan
# Of 117 bytes a second, each pixel takes 1 s of the hub: from .8 on the first, then the next ones.
takes 'the pixels of all pass the hub one after the other' 4.800000 -b 0,117 fan
head -n 2 four.task >first.row
two -b 0,8 fan
is 'the bound counts pixels without their records in the link of the hub' "$(of bound_s)" 8.000000
run simulate -m 1e6 -b 0,8 fan <first.row
is 'the bound counts no pixels without a task' "$(of bound_s)" 2.000000
# hosts of other links: the second is .3 s away, at 1000 bytes a second
printf 'a power=1\nb power=2 latency_ms=300 bytes_per_s=1000\n' >links
run simulate -v -m 1e6 -S links -l 100 fan <four.task
like 'a host with its own latency and bandwidth' "$out" '^# 738000 1 from hub: task 1$'
like 'a host with those of -l' "$out" '^# 200000 0 from hub: task 0$'
# The first has 4 - 3 x .1 s of its power 1, the second 4 - 3 x .3 of 2 at the least, if 4 s are over after T: T - .3 + 2 (T - .9) = 4.
is 'no run is faster than what slots can do between three of their latencies' "$(of least_s)" 2.033333
# Its two slots share a link: the hello of the second waits for that of the first. fan gives a slot its tasks when it is up.
printf 'a slots=2 power=1 bytes_per_s=1000\n' >links
run simulate -v -m 1e6 -S links fan <four.task
like 'slots of one host share its link: up' "$out" '^# 208000 1 to hub: up$'
like 'slots of one host share its link: a task that need not wait' "$out" '^# 242000 1 from hub: task 1$'

# A pixel takes .4 us, or .004; a record .4 us of a hub, and those of a pixel about .1 us of a link, or of the hub.
partition -u run:1 10x10 >px.task
for short in '-m .4 fan:40' '-m .4 -u 0 deal:40' '-m .004 -u .4 deal:120' '-m .004 -b 1e9 fan:16' '-m .004 -b 0,1e9 fan:11' \
	'-m .004 -u 0 -b 0,1e9 deal:11'; do
	# shellcheck disable=SC2086
	run simulate ${short%:*} <px.task
	is "times below a microsecond add up: $short" "$(of makespan_s)" "$(echo "${short#*:}" | awk '{ printf "%.6f", $1 / 1e6 }')"
done

# ---- trees, by hand --------------------------------------------------------------------------------------------
# test_tree.c has the times. Three records for each task, up, and a flush.
takes 'a tree of one hub is the same as no tree' 2.500000 -u 0 deal
takes 'a hub within a hub adds two latencies to each task' 2.900000 -g 1 deal
is 'a tree: hubs, records of the first one, and its tasks' "$(of hubs) $(of hub_slots) $(of hub_records) $(of hub_tasks)" '2 2 14 4'
takes 'a hub that needs .01 s for a record' 2.580000 -u 10000 deal
takes 'two hosts, a hub for each' 2.900000 -g 2 deal
is 'a tree: 3 records for a task on each of two links, 4 hellos and 2 flushes; and the work' "$(of records) $(of work_s)" '30 4.000000'

two -f kill@2 deal
is 'the hub is killed: the next run does the rest' "$status $(of kills) $(of uncommitted)" '0 1 0'

# Eight tasks in turn, powers 1 and 4, published rules: the second has done its four at 1.2 and asks. The ask arrives at 1.4,
# while the first does its second until 2.2; then it starts its third and gives its last, which arrives at 2.4 and takes .25 s.
partition -n 2 1x8 >eight.task
run simulate -m 1e6 -w 1,4 -l 100 ring -p <eight.task
is 'ring -p: makespan and steals are those computed by hand' "$status $(of makespan_s) $(of steals) $(of passed)" '0 3.300000 1 1'
run simulate -m 1e6 -w 1,4 -l 100 -f crash@2.5s:1 ring -p <eight.task
is 'ring -p: a row is lost with the thief that dies' "$status $(of uncommitted) $(of reports)" '1 1 1'
run simulate -m 1e6 -w 1,4 -l 100 -f lose=1 ring -p <eight.task
is 'ring -p: a node without answers takes the other one for dead' "$(of uncommitted) $(of steals) $(of lost | awk '{ print ($1 > 4) }')" '0 0 1'

two -v -f crash@.5s:1 deal
like '-v: a task arrives' "$out" '^# 200000 1 from hub: task 1$'
like '-v: an event of a lost slot is marked as lost' "$out" '^# 700000 1: computed \(lost\)$'
like '-v: the hub learns of the lost slot' "$out" '^# 600000 1 to hub: gone$'

# ---- a ring, by hand -------------------------------------------------------------------------------------------
# The first node has all four. The second gets its place at .2, and asks; the ask is at the hub at .3 and at the first node
# at .4; the gift is at the hub at .5 and at the second node at .6. In one hop from node to node each way takes half of that.
stolen() { run simulate -v -m 1e6 -w 1,1 -l 100 "$@" <first.task; }
stolen ring
like 'the ring: a steal takes two hops, through the hub' "$out" '^# 600000 1 from hub: task 1 from=0$'
is 'the ring: all tasks are done, by both nodes' "$status $(of uncommitted) $(of steals | sed 's/[1-9]/some/')" '0 0 some'
stolen -H 1 ring
like 'the ring -H 1: a steal takes one hop' "$out" '^# 400000 1 from hub: task 1 from=0$'
stolen ring -p
is 'the published ring: all tasks are done' "$status $(of uncommitted) $(of steals | sed 's/[1-9]/some/')" '0 0 some'
stolen -f crash@1:0 ring
is 'the ring: a node that had all tasks is lost, and the other one does them' "$status $(of uncommitted) $(of crashes)" '0 0 1'

# ---- one seed, one run -------------------------------------------------------------------------------------
partition -n 9 64x200 >many.task
faults=crash=.3,silence=.2,pause=.3,slow=.3,return=.5,kill=.5,twice=.1,garbage=.05,jitter=.5
for method in deal 'deal -e -q auto' ring; do
	again() { # SEED FILE
		# shellcheck disable=SC2086
		simulate -s "$1" -j 9,3 -l 2 -m 100,5 -f $faults $method <many.task >"$2"
	}
	again 1 one && again 1 two && again 2 three
	ok "$method: the same seed gives the same bytes" cmp one two
	ok "$method: another seed gives another run" sh -c '! cmp -s one three'
done
for method in deal ring; do
	run simulate -n 50 -s 100 $method
	is "$method: every seed holds" "$status $(of seeds)" '0 50'
	first=$(of trace)
	run simulate -n 50 -s 100 $method
	is "$method: the same seeds give the same trace" "$(of trace)" "$first"
done

# More slots than the checks of deal can hold; pieces are committed once as well.
partition 10x80 >eighty.task
run simulate -j 70,3 -l 1 -m 1000,2 deal <eighty.task
whole_s=$(of makespan_s)
run simulate -j 70,3 -l 1 -m 1000,2 deal -e <eighty.task
is '80 rows on 70 slots, the last ones in pieces' "$status $(of uncommitted) $(of makespan_s | awk -v s="$whole_s" '{ print $1 < s }')" '0 0 1'

# ---- costs of a log --------------------------------------------------------------------------------------
spdgen -s 2 tetra >tetra.nff
partition 24x16 >rows.task
rtworker tetra.nff <rows.task | LC_ALL=C sed 's/^\(.*\)done 0 \([0-9]*\) .*$/\1done 0 \2 cpu_us=1\20000 wall_us=1/' | "$root/tests/seal" >log
sum=$(seq 0 15 | awk '{ s += 1 $1 "0000" } END { printf "%.6f", s / 1e6 }')
run simulate -t log fan <rows.task
is '-t: all rows on one slot take the sum of the costs in the log' "$(of makespan_s)" "$sum"
partition -u tile:5x3 24x16 >tiles.task
run simulate -t log fan <tiles.task
is '-t: another cut takes the same time, except for rounding' "$(of makespan_s | awk -v sum="$sum" '{ d = $1 - sum; print d * d < 1e-8 }')" 1
# Rows of 3, 3, 2, 2 and 2 s on two hosts: the longest first would take 7 s.
partition 24x5 >five.task
rtworker tetra.nff <five.task | LC_ALL=C sed 's/^\(.*\)done 0 \([01]\) .*$/\1done 0 \2 cpu_us=3000000 wall_us=1/
	s/^\(.*\)done 0 \([234]\) .*$/\1done 0 \2 cpu_us=2000000 wall_us=1/' | "$root/tests/seal" >five.log
run simulate -t five.log -j 2 best <five.task
is 'best: it swaps tasks if that is better' "$(of makespan_s)" 6.000000
cat >hosts <<'END'
a slots=2 power=1
b power=.5
END
run simulate -S hosts deal <rows.task
is '-S reads a hosts file' "$(of slots) $status" '3 0'

# ---- what it refuses -----------------------------------------------------------------------------------------
# refuses NAME PATTERN COMMAND ...: with four.task
refuses() {
	name=$1 pattern=$2
	shift 2
	run "$@" <four.task
	is "refused: $name" "$status" 2
	like "refused: $name: a message says so" "$err" "$pattern"
}
refuses 'no method' usage simulate
refuses 'another method' 'none: expected fan, best, adaptive, deal or ring' simulate none
refuses 'an option of another method' usage simulate fan -q 1
refuses 'seeds and a latency' 'the seed sets the rest' simulate -n 1 -l 5 deal
refuses 'seeds and an option of the method' 'the seed sets the rest' simulate -n 1 deal -e
refuses 'hosts twice' 'expected one of' simulate -j 2 -w 1,2 deal
refuses 'costs twice' 'expected one of' simulate -m 1 -t log deal
refuses 'a log of nothing' 'expected the log of a picture' simulate -t /dev/null deal
refuses 'costs that no clock counts' 'expected at most' simulate -m 1e9 -x 1e9 deal
refuses 'less than a byte per second' 'expected 0, or' simulate -b 0,.5 deal
refuses 'no log' 'nothing: ' simulate -t nothing deal
refuses 'hosts without power' 'expected power=P' simulate -S one,two deal
for fault in crash crash= crash=2 crash@ crash@5 crash@0:1 crash@5:1:2 kill@5:1 return@5:1 slow@5:1:2 slow@s:1 =1 '' x=1; do
	refuses "-f '$fault'" "expected ${fault:+KIND=CHANCE}" simulate -f "$fault" deal
done
refuses 'a fault of a slot that does not exist' 'slot 2 of 2' simulate -j 2 -f crash@1:2 deal
refuses '-j with half a slot' 'expected SLOTS' simulate -j 1.5 deal
refuses 'lost messages without ring -p' 'expected ring -p' simulate -f lose=.1 deal
refuses 'a tree of rings' 'expected deal or adaptive, without' simulate -g 2 ring
refuses 'a tree with faults' 'expected deal or adaptive, without' simulate -g 2 -f crash=1 deal
refuses 'the published ring with an endgame' 'expected no -e' simulate ring -e -p
refuses 'loads of a tree' 'without -c, -f, -L, -p' simulate -g 2 -L /dev/null deal
refuses 'a start of a tree' 'without -c, -f, -L, -p' simulate -g 2 -p 1 deal
refuses 'no loads' '^simulate: -L nothing: ' simulate -L nothing deal
printf '1 0 .5\n1 2 .5\n' >two.loads
refuses 'loads of a slot that does not exist' 'slot 2 of 2' simulate -j 2 -L two.loads deal
for start in 1,2,3,4,5 1,2,3,.5 1e6 1,2,1e6 -1; do refuses "-p $start" '-p.*expected' simulate -p "$start" deal; done
refuses 'half a hub' 'expected whole numbers' simulate -g 1.5 deal
refuses 'no hub' 'expected' simulate -g 0 deal
refuses '-c with fan' 'expected deal or ring' simulate -c fan
bad() { # NAME INPUT-LINE ...
	name=$1
	shift
	[ $# = 0 ] || printf '%s\n' "$@" >bad.task
	run simulate deal <bad.task
	is "refused: $name" "$status" 2
	like "refused: $name: a message says so" "$err" 'standard input: .*expected'
}
: >bad.task
bad 'no input'
bad 'no task' 'frame 0 4 4'
bad 'tasks not numbered from 0' 'frame 0 4 4' 'task 0 1 0 0 4 1 1 1'
bad 'a number twice' 'frame 0 4 4' 'task 0 0 0 0 4 1 1 1' 'task 0 0 0 1 4 1 1 1'
bad 'a task without a frame' 'task 0 0 0 0 1 1 1 1'
bad 'a task beyond its frame' 'frame 0 4 4' 'task 0 0 0 0 17 1 1 1'
bad 'two frames' 'frame 0 4 4' 'frame 1 4 4'
bad 'no record' nonsense
run simulate -n 1 fan
is 'refused: seeds of fan, which loses tasks' "$status" 2
is 'a host that is slowed twice: the run is simulated to its end' "$(partition -u run:4 8x8 |
	simulate -m 1000 -j 1 -f slow@.001s:0:.001,slow@.002s:0:.001 deal | awk '$1 == "uncommitted" { print $2 }')" 0
is 'a host that is slowed three times keeps a thousandth of its power' "$(partition -u run:4 8x8 |
	simulate -m 1000 -j 1 -f slow@.001s:0:.001,slow@.002s:0:.001,slow@.003s:0:.001 fan | awk '$1 == "uncommitted" { print $2 }')" 0
is 'a host that is slow from the start' "$(partition -u run:4 8x8 | simulate -m 1000 -j 2 -f slow@0s:1:.1 deal | awk '$1 == "slows" { print $2 }')" 1
is 'jitter: no run is faster than the bound and three of the least latencies' "$(partition -u run:64 8x8 |
	simulate -l 100 -m 10 -s 4 -f jitter=1 deal | awk '{ v[$1] = $2 } END { print (v["least_s"] <= v["makespan_s"]) }')" 1
# What ships is what is simulated.
here=$root/bin temporary=$tmp
# shellcheck source=../bin/virtual.sh
. "$root/bin/virtual.sh"
# ships COMMAND METHOD SLOTS [WORKER]: gives the tasks of a method to COMMAND
ships() { shipped "$1" "$2" 64x64 "$3" /dev/null fan -j "$3" "${4-rtworker}"; }
counted() { ships 'sh -c cat' "$@" | awk '/^task/ { n++ } END { print n }'; }
# shellcheck disable=SC2046  # words
is 'simulate adaptive has the rules of balance-adaptive' \
	"$(partition 64x64 | simulate -l 9 adaptive | grep trace)" \
	"$(partition 64x64 | simulate -l 9 $(ships echo adaptive 2) | grep trace)"
is 'balance-gdc: rules' "$(ships echo gdc 2)" 'ring -e'
# began: how many tasks begin at each slot, in parts of the first slot's
began() {
	sed -n 's/^task .* to=//p' |
		awk '{ n[$1]++ } END { for (k = 0; k in n; k++) printf "%.1f ", n[k] / n[0] }'
}
is 'balance-gdc: a slot begins with a share by its power' \
	"$(ships 'sh -c cat sh -w 5,1,2' gdc 3 | began)" '1.0 0.2 0.4 '
# Powers far above 1 count as well. A slot without a stated one has 1: no worker is asked.
mkdir only && printf '#!/bin/sh\nexec cat\n' >only/ringctl && chmod +x only/ringctl
printf ': power=5000\n: power=1000 slots=2\n' >large
printf ': slots=2\nfar power=.5 via="false %%c"\n' >some
for list in 'large 1.0 0.2 0.2 ' 'some 1.0 1.0 0.5 '; do
	is "balance-gdc: the powers of a hosts file, ${list%% *}" "$(PATH=$PWD/only:$PATH balance-gdc \
		64x64 3 /dev/null fan -S "${list%% *}" false </dev/null | began)" "${list#* }"
done
# One host of power 20 among 13 of 1. With equal shares it has an efficiency of .52.
ok 'balance-gdc: one strong host, far away' awk "BEGIN { exit !($(ships \
	"simulate -w 20$(printf ',1%.0s' $(seq 13)) -l 50 -m 8000" gdc 14 | awk '$1 == "efficiency" { print $2 }') > .8) }"
# A function that is called after a test that fails does not fail by that.
is 'a method is simulated in the other branch of a test' \
	"$(if false; then :; else ships 'echo' gdc 2; fi)" 'ring -e'
is 'balance-gdc-published: equal shares' \
	"$(ships 'sh -c cat sh -w 5,1' gdc-published 2 | began)" '1.0 1.0 '
printf '%s\thost\t%s\t1\t%s\n' 0 5 3 1 1 - >table
is 'a power that was measured counts for hybrid, and not for gdc' \
	"$(ships 'sh -c cat' hybrid 2 | began)$(ships 'sh -c cat' gdc 2 | began)" '1.0 0.2 1.0 1.0 '
rm table
is 'adaptive: rows, while each slot has 30' "$(counted adaptive 2)" 64
is 'adaptive: parts of rows for more slots' "$(counted adaptive 3; counted adaptive 64)" "$(printf '92\n2048')"
is 'adaptive: smaller tiles for more slots' "$(counted adaptive 1 vcworker; counted adaptive 9 vcworker)" "$(printf '32\n512')"
is 'adaptive: a band for each slot, at least' "$(counted adaptive 9 povworker; counted adaptive 100 povworker; counted adaptive 9 blendworker)" "$(printf '16\n128\n16')"
is 'a method runs after a command that failed' "$(if false; then :; else counted gdc 2; fi)" "$(counted gdc 2)"
is 'another unit' "$(unit=run:2048 && counted adaptive 3)" 2
# Most of 100 hosts have no row of 64.
ok 'adaptive on more hosts than rows' awk "BEGIN { exit !($(ships 'simulate -j 100 -m 10000' adaptive 100 | awk '$1 == "efficiency" { print $2 }') > .9) }"

# Tasks that do not arrive by number.
partition 16x16 | rtworker tetra.nff >rows.log
for order in sample "cost:$PWD/rows.log"; do
	for rules in deal 'deal -q auto' '-f crash=.5,kill=1 deal'; do
		# shellcheck disable=SC2086  # options and method
		is "tasks go in order of arrival: partition -o ${order%%:*}, simulate $rules" "$(partition -o "$order" 16x16 |
			simulate -j 4 -l 5 $rules 2>&1 | awk '$1 == "uncommitted" || /order/')" 'uncommitted	0'
	done
done
# Task 0 has two pixels, and task 9 these and two others.
{ partition -u run:2 4x1 | head -n 2; partition -u run:4 4x1 | awk '/^task/ { $3 = 9; print }'; } | rtworker tetra.nff |
	LC_ALL=C sed 's/^\(.*\)done 0 0 .*$/\1done 0 0 cpu_us=1000 wall_us=1/; s/^\(.*\)done 0 9 .*$/\1done 0 9 cpu_us=8000 wall_us=1/' | "$root/tests/seal" >over.log
is 'each pixel costs an equal share of its task, also where tasks overlap' "$(partition -n 1 4x1 | simulate -t over.log -j 1 fan | grep bound_s)" "bound_s	0.005000"

finish
