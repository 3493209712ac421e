#!/bin/sh
# fragstat: the parts of the time of a run, from logs made by hand and real ones; and the lower bound.
. "$(dirname "$0")/lib.sh"

value() { fragstat -s "$@" | awk -v key="$key" '$1 == key { print $2 }'; }
# gives KEY VALUE ARGUMENT ...: of the summary
gives() {
	key=$1 want=$2
	shift 2
	is "$key of $*" "$(value "$@")" "$want"
}
# column NUMBER LOG: prints a column of the table without its name
column() { fragstat "$2" | tail -n +2 | cut -f "$1" | tr '\n' ' '; }

# ---- a log made by hand: times in ms; slot 2 never gets a task, task 2 is done twice ---------------------------
"$root/tests/seal" >hand.frags <<'END'
hello deal 0.1 selftest=0 slots=3
done 0 0 cpu_us=90000 wall_us=100000 w=0 sent_us=0 recv_us=120000
done 0 1 cpu_us=200000 wall_us=200000 w=1 sent_us=0 recv_us=230000
done 0 2 cpu_us=100000 wall_us=100000 w=0 sent_us=0 recv_us=240000
done 0 2 cpu_us=50000 wall_us=50000 w=1 sent_us=0 recv_us=300000 try=2
END
is 'the column tasks' "$(column 2 hand.frags)" '2 2 0 '
is 'the column busy_s' "$(column 4 hand.frags)" '0.200000 0.200000 0.000000 '
is 'the column startup_s' "$(column 5 hand.frags)" '0.020000 0.030000 0.300000 '
is 'the column waiting_s' "$(column 6 hand.frags)" '0.020000 0.020000 0.000000 '
is 'the column tail_s' "$(column 7 hand.frags)" '0.060000 0.000000 0.000000 '
is 'the column wasted_s' "$(column 8 hand.frags)" '0.000000 0.050000 0.000000 '
is 'the columns duplicates and retries' "$(column 9 hand.frags)$(column 10 hand.frags)" '0 1 0 0 1 0 '
is 'busy, start-up, waiting, tail and wasted time add up to the makespan' "$(fragstat hand.frags | awk 'NR > 1 { printf "%.6f ", $4 + $5 + $6 + $7 + $8 }')" '0.300000 0.300000 0.300000 '
sed 's/w=1/& from=0/' hand.frags | "$root/tests/seal" >stolen.frags
is 'the column steals' "$(column 12 stolen.frags)" '0 2 0 '
gives steals 2 stolen.frags
gives steals 0 hand.frags
gives tasks 3 hand.frags
gives slots 3 hand.frags
gives makespan_s 0.300000 hand.frags
gives bound_s 0.200000 hand.frags # the dearest task on one slot
gives efficiency 0.6667 hand.frags
# With powers: costs are multiplied by the power of their slot, and the fastest slot may do the longest task.
gives bound_s 0.200000 -w 1,2,1.5 hand.frags # 400 ms of work at power 2
gives bound_s 0.116000 -w 1,.5,1 hand.frags  # (90 + 100 + 100) / 2.5
printf '%s\n' ': slots=2 power=1' 'far power=.5' >hosts
gives bound_s 0.200000 -S hosts hand.frags # (90 + 200 + 100) / 2.5 is less than 200 / 1
is 'the table has the powers' "$(fragstat -S hosts hand.frags | cut -f 11 | tr '\n' ' ')" 'power 1 1 0.5 '

# A second run resumes the first; its repeated tasks are wasted.
{ cat hand.frags; echo 'hello fan 0.1 selftest=0 slots=3'; echo 'done 0 0 cpu_us=1000 wall_us=1000 w=2 recv_us=100000'
	echo 'done 0 3 cpu_us=1000 wall_us=1000 w=2 recv_us=102000'; } | "$root/tests/seal" >again.frags
gives runs 2 again.frags
gives makespan_s 0.402000 again.frags
gives tasks 4 again.frags
gives duplicates 2 again.frags
is 'two runs in one file or in two files give the same table' "$(tail -n 3 again.frags >second.frags; fragstat hand.frags second.frags)" "$(fragstat again.frags)"
is 'the times of two runs add up to the sum of the makespans' "$(fragstat again.frags | awk 'NR > 1 { printf "%.6f ", $4 + $5 + $6 + $7 + $8 }')" '0.402000 0.402000 0.402000 '

# The CPU time of a single worker includes reading and writing, so its makespan is at least that.
printf '%s\n' 'hello rtworker 0.1 selftest=0 slots=1' 'done 0 0 cpu_us=3000 wall_us=1000' 'done 0 1 cpu_us=1000 wall_us=2000' | "$root/tests/seal" >lone.frags
gives makespan_s 0.005000 lone.frags
gives efficiency 0.8000 lone.frags
is 'a log of one worker: its slot has no name' "$(column 1 lone.frags)" '- '

printf ': slots=2 power=1\n' >two

# ---- logs of runs --------------------------------------------------------------------------------------------
spdgen -s 2 gears >gears.nff
partition 64x64 | rtworker gears.nff >one.frags
{ pack scene gears.nff; partition 64x64; } >job.task
deal fan -j 3 rtworker - <job.task >three.frags
partition -n 2 -u scatter 64x64 | fan -j 2 rtworker gears.nff >scatter.frags
within() { echo "$1" | awk -v lo="$2" -v hi="$3" '{ exit !($1 > lo && $1 <= hi) }'; }
key=efficiency
ok 'the efficiency of one worker is at most 1' within "$(value one.frags)" 0 1
ok 'the efficiency of three workers is at most 1' within "$(value three.frags)" 0 1
gives tasks 64 three.frags
gives duplicates 0 three.frags
# adds_up LOG: the five times of each slot add up to the makespan
adds_up() {
	fragstat "$1" | awk -v all="$(key=makespan_s; value "$1")" 'NR > 1 { d = $4 + $5 + $6 + $7 + $8 - all; if (d > 1e-5 || d < -1e-5) bad = 1 }
		END { exit bad || NR < 2 }'
}
ok 'the times of each slot add up to the makespan' adds_up three.frags
key=bound_s
sum=$(key=cpu_s; value one.frags)
share() { within "$1" "$(echo "$sum $2" | awk '{ printf "%.7f", $1 / $2 - 2e-6 }')" "$(echo "$sum $2" | awk '{ printf "%.7f", $1 / $2 + 2e-6 }')"; }
ok '-c: the bound by costs of another run, for rows' share "$(value -c one.frags three.frags)" 3
ok '-c: the bound by costs of another run, for scattered pixels' share "$(value -c one.frags scatter.frags)" 2
partition -u tile:64x32 64x64 | fan -j 2 rtworker gears.nff >halves.frags
ok '-c: a coarse cut does not raise the bound' share "$(value -c one.frags halves.frags)" 2
# A slot ends while it holds three tasks: these are given again, and the times add up.
scale=$(echo "$sum" | awk '{ print 1500 / $1 / 1000 }') # a run of 1.5 s CPU
# shellcheck disable=SC2016
deal -q 2 fan -j 2 sh -c 'mkdir first 2>/dev/null || exec replay -x "$1" one.frags
	replay -x "$1" one.frags | dd bs=1 count=4000' sh "$scale" <job.task >lost.frags 2>/dev/null
gives tasks 64 lost.frags
like 'retries of lost.frags' "$(key=retries; value lost.frags)" '^[1-9]'
ok 'with a lost slot the times add up as well' adds_up lost.frags
cat one.frags one.frags >twice.frags
gives duplicates 64 twice.frags
gives runs 2 twice.frags
{ head -c 8500 one.frags; cat one.frags; } >torn.frags # within the pixels of a row
run fragstat -s torn.frags
like 'a damaged log: a message says so' "$status $err" '^0 fragstat: torn.frags: 1 damaged place skipped'
like 'a damaged log: -s counts the lost records' "$out" '^lost_records	1$'

# ---- as intervals --------------------------------------------------------------------------------------------
fragstat -g again.frags >gantt.tsv
cp again.frags '#again.frags'
is '-g: a name does not begin a comment' "$(fragstat -g '#again.frags' | sed 's/^?again/again/' | cmp - gantt.tsv)" ''
is '-g: one line per done record' "$(grep -vc '^#' gantt.tsv)" 7
is '-g: the line has begin and end of the task' "$(awk -F '\t' '/^again/ { print $3, $4, $6, $10; exit }' gantt.tsv)" 'task 0.020000 0 0.120000'
is '-g: a second run follows the first' "$(awk -F '\t' '/^again/ { line = $10 } END { print line }' gantt.tsv)" 0.402000
is '-g: the line says whether the task was wasted' "$(awk -F '\t' '/^again/ { print $3 }' gantt.tsv | sort | uniq -c | tr -s ' \n' ' ')" ' 4 task 2 wasted '
sed 's/done 0 1 /done 0 1 try=3 /' hand.frags | "$root/tests/seal" | fragstat -g >tries.tsv
like '-g: a task that was given again has its own kind' "$(cut -f 3 tries.tsv)" '^task given again$'
like '-g: the kind is real' "$(cut -f 2 gantt.tsv)" '^real$'
partition 64x64 | replay one.frags | fragstat -g >replayed.tsv
like '-g: the kind is replayed' "$(cut -f 2 replayed.tsv)" '^replayed$'
like '-g: lanes have the names of slots' "$(cat gantt.tsv)" '^# lanes: 0 1 2$'

# ---- what it refuses -----------------------------------------------------------------------------------------
: >empty.frags
run fragstat empty.frags
like 'no task: exit 1' "$status $err" '^1 fragstat: no task was done in this log, expected'
run fragstat nosuch.frags
like 'no file: exit 2' "$status $err" '^2 fragstat: nosuch.frags: No such file'
run fragstat .
like 'a directory: exit 2' "$status $err" '^2 fragstat: \.: Is a directory'
run fragstat -g -s empty.frags
like '-g with -s: exit 2' "$status $err" '^2 fragstat: -g, -H, -s and -t: expected one of them'
# refuses WHY ARGUMENT ...
refuses() {
	why=$1
	shift
	run fragstat "$@"
	like "refused: $*" "$status $err" "^2 fragstat: .*$why.*expected"
}
spdgen -s 1 balls >balls.nff
partition 64x64 | rtworker balls.nff >balls.frags
partition 64x64 | head -n 9 | rtworker gears.nff >part.frags
refuses 'balls.frags: frame 0: job' -c balls.frags three.frags
refuses 'part.frags: frame 0: 512 pixels' -c part.frags three.frags
refuses 'hand.frags: no pixels' -c hand.frags three.frags
refuses '2 powers' -w 1,2 three.frags
refuses '`x`' -w 1,x,2 three.frags
refuses 'host : has no power' -S 2/:,far three.frags
refuses '2 slots' -S two three.frags
refuses '-S and -w' -S hosts -w 1,1,1 three.frags
partition 8x8 >eight.task
spdgen -s 1 tetra >one.nff
deal fan -j 1 rtworker -j 2 one.nff <eight.task >inner.frags
gives slots 2 inner.frags
rtworker one.nff <eight.task >one.frags
for half in 1 2; do { head -n 1 eight.task; sed 1d eight.task | awk -v half=$half 'int((NR - 1) / 4) + 1 == half'; } | rtworker one.nff >half$half.frags; done
run fragstat -s -c half1.frags half2.frags
like '-c: a log of other pixels is refused' "$status:$out$err" '^2:.*other pixels, expected those of the other log'
partition -F 1 8x8 | rtworker one.nff >next.frags
cat one.frags next.frags >two.frags
run fragstat -s -c two.frags one.frags
like '-c: a log of more pictures is refused' "$status:$out$err" '^2:.*frames, expected 1 as in the other log'
ok '-c: the log itself' fragstat -s -c one.frags one.frags

finish
