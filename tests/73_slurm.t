#!/bin/sh
# Four nodes of a Slurm cluster, with two processors each: pictures from salloc, and from sbatch by the command of
# stormring-engines(7). Steps, nodes and jobs end while their slots owe tasks: the picture is the same.
if [ -z "${TEST_SLURM-}" ]; then
	slurm=$(cd "$(dirname "$0")" && pwd)/slurm
	why=$("$slurm" check 2>&1) || { echo "1..0 # SKIP $why"; exit 0; }
	exec "$slurm" with 4 "$0"
fi
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"
patient
# shellcheck source=examples.sh
. "$root/tests/examples.sh"
# shellcheck disable=SC2154,SC2016  # lib.sh and marked.sh set them; scripts for others
spdgen -s 2 gears >gears.nff
partition 96x96 | rtworker gears.nff | gather -o good.pfm

# ---- jobs ------------------------------------------------------------------------------------------------------------
last_job() { squeue -h -t all -o %A | sort -n | tail -n 1; }
# steps JOB: the number of its steps on each node, without that of its script
steps() { for n in n1 n2 n3 n4; do grep -c "launch task StepId=$1\.[0-9]" "$TEST_SLURM/$n.log"; done | tr '\n' ' '; }
hosts_in() { grep -ao '^up w=[0-9]* host=[^ ]*' "$1" | sort -u | sed 's/.*=//' | tr '\n' ' '; }

run salloc -Q -N 4 --exclusive fan -l -S slurm:
is 'fan -l: the slots of the nodes of a job' "$(echo "$out" | cut -f 2 | tr '\n' ' ')" 'n1 n1 n2 n2 n3 n3 n4 n4 '
run salloc -Q -N 4 --exclusive balance interleaved -S slurm: -s 96x96 -r job.log -o out.pfm gears.nff
is 'salloc: exit 0' "$status" 0
[ "$status" = 0 ] || diag "$err"
ok 'salloc: the same picture' cmp out.pfm good.pfm
is 'salloc: two slots on each node' "$(hosts_in job.log)" 'n1 n1 n2 n2 n3 n3 n4 n4 '
is 'salloc: one step for each node' "$(steps "$(last_job)")" '1 1 1 1 '
run salloc -Q -N 2 --exclusive balance gdc -S slurm: -s 96x96 -o ring.pfm gears.nff
ok 'salloc, a ring: the same picture' cmp ring.pfm good.pfm

run salloc -Q -N 1 -w n1 --exclusive : -N 2 -w n2,n3 --exclusive balance interleaved -S slurm: -s 96x96 -r het.log -o het.pfm gears.nff
is 'a heterogeneous job: exit 0' "$status" 0
[ "$status" = 0 ] || diag "$err"
ok 'a heterogeneous job: the same picture' cmp het.pfm good.pfm
is 'a heterogeneous job: two slots on each node of all parts' "$(hosts_in het.log)" 'n1 n1 n2 n2 n3 n3 '
# Copies of tasks are left at the end; srun does not report that they are stopped.
is 'good runs: no word of srun' "$(for _ in 1 2 3 4; do
	salloc -Q -N 2 --exclusive balance adaptive -S slurm: -s 160x120 -W '-a 16' -o quiet.png gears.nff 2>&1
done | grep -v 'never connected')" ''

for n in n1 n2; do echo "$n slots=2 via=\"srun -Q -N 1 -n 1 -c 2 --overlap -w %h sh -c %c\""; done >lines
run salloc -Q -N 2 -w n1,n2 --exclusive balance interleaved -1 -S lines -s 96x96 -o lines.pfm gears.nff
ok 'srun without -u: the same picture' cmp lines.pfm good.pfm

examples "$root/man/stormring-engines.7" | sed -n 's/^#shows sbatch/sbatch/p' >script
is 'the page has one command of sbatch' "$(wc -l <script)" 1
ok 'sbatch, the command of the page: exit 0' sh script
partition 512x512 | rtworker gears.nff | gather -o whole.png
ok 'sbatch, the command of the page: the same picture' imgcmp -t 0 -f 0 gears.png whole.png
is 'sbatch, the command of the page: every node is used' "$(steps "$(last_job)")" '1 1 1 1 '

# ---- slots are lost while they owe tasks -----------------------------------------------------------------------------
# The worker, whose hello passes; all the rest waits until the file `go` is there. With -z off, fan asks it nothing before.
cat >stall <<'END'
#!/bin/sh
rtworker "$@" | tee -a "got.${SLURMD_NODENAME-here}" | {
	read -r hello && printf '%s\n' "$hello"
	until [ -e go ]; do sleep .1; done
	cat
}
END
cat >stalled <<'END'
#!/bin/sh
{ pack scene gears.nff; partition 96x96; } | deal -q auto fan -1 -t 1000 -z off -S "$1" ./stall - 2>"$2" | gather -o "$3"
END
chmod +x stall stalled
computed() { grep -aq "^done" "got.$1" 2>/dev/null; } # NODE: tasks, whose pixels wait
lost() { grep -q " on $1: lost (.*) with [1-9][0-9]* tasks, connecting again" said; } # NODE, with tasks
# back NODE: they are up again after that
back() { awk -v on=" on $1: " 'index($0, on "lost") { lost = 1; up = 0 } lost && index($0, on "are up") { up = 1 } END { exit !up }' said; }
neither() { ! back n3 && ! back n4; }
set_node() { scontrol update "nodename=$1" "state=$2" ${3+"reason=$3"}; }
step_on() { squeue -s -h -o '%i %N' | awk -v node="$1" '$2 == node { print $1 }' | grep '\.[0-9]'; }
job_on() { squeue -h -t R -o '%A %N' | awk -v node="$1" '$2 == node { print $1 }'; }
# loses WHAT NODE: its slots are lost with tasks
loses() { ok "$1: the slots of $2 are lost with their tasks" await 30 lost "$2"; }
# returns WHAT NODE: its slots come back
returns() { ok "$1: the slots of $2 come back" await 30 back "$2"; }
# begun WHAT NODE ...: waits until they have computed tasks
begun() {
	begun=$1
	shift
	for n; do
		await 30 computed "$n" || { fail "$begun: slots of $n compute tasks" "$(cat said)"; finish; }
	done
}
# ends WHAT: the run goes on to its end
ends() {
	: >go
	wait "$running"
	is "$1: exit 0" $? 0
	ok "$1: the same picture" cmp out.pfm good.pfm
	[ "$tap_failed" = 0 ] || diag "$(cat said)"
	rm -f go got.* said.before out.pfm
	mv said said.before
}

# In one allocation. A node that is set down leaves the allocation for good.
salloc -Q -N 4 --exclusive --no-kill ./stalled slurm: said out.pfm 2>revoked &
running=$!
begun 'salloc with faults' n1 n2 n3 n4
scancel "$(step_on n2)"
loses 'a cancelled step' n2
returns 'a cancelled step' n2
set_node n3 drain test
scancel "$(step_on n3)"
loses 'a drained node' n3
returns 'a drained node' n3
set_node n4 down test
loses 'a node set down' n4
ends 'salloc with faults'
set_node n3 resume
set_node n4 resume

# From the login node: each host is a job of its own. A batch job reaches its time limit at the same time; slurmctld looks
# every 30 seconds.
cat >half <<'END'
{ pack scene gears.nff; partition 96x96 | head -n 50; sleep infinity; } | deal fan -1 -S slurm: rtworker - | gather -r batch.log -o batch.pfm
END
via=$(sed -n 's/^[.]Dl \(via="srun .*\)/\1/p' "$root/man/stormring-engines.7")
is 'the page has one line for hosts files' "$(printf '%s\n' "$via" | grep -c ' -c 8 ')" 1
for n in n2 n3 n4; do echo "$n slots=2 $via" | sed 's/ -c 8 / -c 2 /'; done >hosts
some() { [ -e batch.log ] && [ "$(grep -ac "^frag " batch.log)" -ge 49 ]; }
over() { [ "$(squeue -h -t all -j "$limited" -o %T)" = TIMEOUT ]; }
limited=$(sbatch --parsable -N 1 -w n1 --exclusive --wrap 'sh half')
./stalled hosts said out.pfm &
running=$!
begun 'the login node with faults' n2 n3 n4
ok 'a time limit: a part of the picture is in the log' await 30 some
# Slurm refuses an end that is past when it looks: the second may have turned meanwhile.
for job in "$limited" "$(job_on n2)"; do await 30 scontrol -Q update "jobid=$job" endtime=now; done
set_node n3 drain test
scancel "$(job_on n3)"
loses 'a drained node, its job cancelled' n3
set_node n4 down test
loses 'a job of a node set down' n4
loses 'a job at its time limit' n2
returns 'a job at its time limit' n2
ok 'a node drained, and a node down: their slots wait' neither
set_node n3 resume
set_node n4 resume
returns 'a drained node that resumes' n3
returns 'a node that was down and resumes' n4
ends 'the login node with faults'
ok 'a time limit: the job ends' await 30 over
like 'a time limit: the log says how to go on' "$(cat "slurm-$limited.out")" 'batch.log has the pixels so far|to resume from batch.log, rerun'
ok 'a time limit: the next job exits with 0' sbatch -W -Q -N 2 --exclusive --wrap \
	'balance adaptive -S slurm: -s 96x96 -r batch.log -o batch.pfm gears.nff'
ok 'a time limit: the same picture' cmp batch.pfm good.pfm

# ---- a pool, by the commands of the page: hosts join when their jobs begin, and leave when they end
# The worker waits as above. Real pools are larger, and what they render takes longer.
all_in pool
rm pool/rtworker pool/fan
cp "$tmp/patient/fan" pool
cat >pool/rtworker <<END
#!/bin/sh
PATH=$root/bin:\$PATH
case \$* in *-i*) exec rtworker "\$@" ;; esac
exec "$tmp/stall" "\$@"
END
chmod +x pool/rtworker
sed -n '/^sbatch -J pool/,/^[.]Ed/p' "$root/man/stormring-engines.7" | sed "/^[.]Ed/d
	s/\\\\(aq/'/g; s/\\\\e/\\\\/g
	s/=1-20/=1-2/; s/-c 8/-c 2/g; s/slots=8/slots=2/; s/gears.png/out.pfm/; s/sleep 2/sleep .2/
	s/^balance adaptive/& -s 96x96 -z off/" >commands
is 'a pool: the page has its commands' "$(grep -c . commands)" 15
rm -f gears.log
PATH=$tmp/pool:$PATH sh commands >said 2>&1 &
running=$!
nodes() { squeue -h -r -t R -n pool -o %N; }
two() { [ "$(nodes | wc -l)" = 2 ]; }
ok 'a pool: its jobs run' await 30 two
# shellcheck disable=SC2046  # a word each
begun 'a pool' $(nodes)
pass 'a pool: both nodes join the run'
gone=$(nodes | head -n 1)
scancel "$(squeue -h -r -n pool -w "$gone" -o %i)"
# Its connections are lost, or its line goes first.
left() { grep -qE " on $gone: lost| slots join the run, [1-9][0-9]* leave it" said; }
ok 'a pool: a host leaves when its job ends' await 30 left
ends 'a pool'

none_running() { [ -z "$(squeue -h)" ]; }
ok 'no job and no step is left' await 30 none_running
is 'no worker is left' "$(pgrep -c rtworker)" 0

# ---- the cluster itself: nothing remains, however a run ends ---------------------------------------------------------
for signal in TERM INT KILL; do
	rm -f ready
	MARK=$mark perl -e '$SIG{INT} = "DEFAULT"; setpgrp; exec @ARGV' "$root/tests/slurm" with 1 sh -c ': >ready; sleep 7200' &
	await 30 test -e ready
	ok "daemons of another cluster run before $signal" [ -n "$(program slurmctld)" ]
	kill -$signal $!
	ok "no process is left after $signal" await 30 none_alive
done
finish
