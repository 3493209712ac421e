#!/bin/sh
# The nodes of a job, and the launchers of stormring-engines(7), with programs of this test in the place of ssh, kubectl
# and podman; 73_slurm.t has a cluster. GNU parallel is the real one.
. "$(dirname "$0")/lib.sh"
patient
needs parallel
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
spdgen -s 2 gears >gears.nff
partition 96x80 | rtworker gears.nff | gather -o good.pfm
hosts_in() { grep -ao '^up w=[0-9]* host=[^ ]*' "$1" | sort -u | sed 's/.*=//' | tr '\n' ' '; }
# render NAME METHOD HOSTS [-1]: exit 0 and the same picture
render() {
	set -- "$1" "$2" "$3" "${4-}"
	rm -f job.log out.pfm reached
	run balance "$2" $4 -S "$3" -s 96x80 -r job.log -o out.pfm gears.nff
	is "$1: exit 0" "$status" 0
	[ "$status" = 0 ] || diag "$err"
	ok "$1: the same picture" cmp out.pfm good.pfm
}

# Each notes the host, and runs the command as the real one does: ssh gives its words to a shell, the others do not. sshd
# sets SHELL, and without it GNU parallel's part there fails now and then.
mkdir stand-in
cat >stand-in/ssh <<'END'
#!/bin/sh
while :; do
	case $1 in
	-e | -l | -o | -p) shift 2 ;;
	-*) shift ;;
	*) break ;;
	esac
done
echo "$1" >>reached
shift
[ "$1" != -- ] || shift
exec env SHELL=/bin/sh sh -c "$*"
END
cat >stand-in/kubectl <<'END'
#!/bin/sh
[ "$1 $2 $4" = 'exec -i --' ] || exit 1
[ -e started ] || { : >started; echo 'error: container not found ("worker")' >&2; exit 1; }
echo "$3" >>reached
shift 4
exec "$@"
END
cat >stand-in/podman <<'END'
#!/bin/sh
[ "$1 $2" = 'exec -i' ] || exit 1
[ -e started ] || { : >started; echo 'Error: no such container' >&2; exit 125; }
echo "$3" >>reached
shift 3
exec "$@"
END
chmod +x stand-in/*
PATH=$tmp/stand-in:$PATH
export HOME="$tmp" # of parallel's semaphores

# ---- PBS -------------------------------------------------------------------------------------------------------------
printf '%s\n' node1 node2.site node1 node2.site node2.site >nodefile
export PBS_NODEFILE=nodefile
is 'pbs: the slots of the nodes' "$(fan -l -S pbs: | cut -f 2 | tr '\n' ' ')" 'node1 node1 node2.site node2.site node2.site '
render pbs interleaved pbs:
is 'pbs: every slot of both nodes' "$(hosts_in job.log)" 'node1 node1 node2.site node2.site node2.site '
is 'pbs: one connection for each node' "$(sort reached | tr '\n' ' ')" 'node1 node2.site '
render 'pbs, a ring' gdc pbs:

# ---- the lines of the page -------------------------------------------------------------------------------------------
sed -n 's/^[.]Dl \(via=.*\)/\1/p' "$root/man/stormring-engines.7" >lines
is 'the page has six lines' "$(cut -d ' ' -f 1 lines | tr '\n' ' ')" \
	'via="srun via="ssh via="kubectl via="podman via="mpirun via="parallel '
# On a loaded machine GNU parallel takes more than the 15 seconds that fan gives a host by default.
for program in ssh kubectl podman parallel; do
	sed -n "s/^via=\"$program /box slots=8 wait=800 &/p" lines >hosts
	rm -f started
	render "$program" interleaved hosts -1
	case $program in kubectl | podman)
		like "$program: a container that starts late is tried again" "$err" \
			'^fan: box: cannot be reached \(exit-[0-9]+\); trying again for up to 30 s$' ;;
	esac
	is "$program: every slot" "$(hosts_in job.log)" 'box box box box box box box box '
	is "$program: one connection, by the host's name" "$(sed 's,^8/,,' reached | sort -u)" box
done

# ---- files of hosts of other batch systems ---------------------------------------------------------------------------
awk '/^[.]Ss/ { here = /Batch systems with a file/ } here && /^[.]Bd/ { n++; shown = 1; next }
	/^[.]/ { shown = 0 } shown { print >("made." n) }' \
	"$root/man/stormring-engines.7"
printf '%s\n' node1 node2 node1 >one-a-slot
printf 'node1 2 all.q@node1 UNDEFINED\nnode2 1 all.q@node2 <NULL>\n' >grid
cat >stand-in/flux <<'END'
#!/bin/sh
case "$*" in 'hostlist -e local') echo node1 node2; exit ;; esac
[ "$1 $2 $3 $4 $5" = 'run -u -N1 -n1 -c8' ] || exit 1
echo "${6#--requires=host:}" >>reached
shift 6
exec "$@"
END
chmod +x stand-in/flux
cp stand-in/ssh stand-in/oarsh
made=0
for system in LSF 'LSF, the variable' SGE Flux OAR; do
	made=$((made + 1)) each='2 node1 1 node2'
	[ "$system" != Flux ] || each='8 node1 8 node2'
	rm -f hosts
	sed "s/\\\\(aq/'/g; s/\\\\e/\\\\/g" made.$made >line.sh
	LSB_DJOB_HOSTFILE=one-a-slot LSB_MCPU_HOSTS='node1 2 node2 1' PE_HOSTFILE=grid OAR_NODEFILE=one-a-slot sh ./line.sh
	is "$system: the slots of the nodes" "$(fan -l -S hosts | cut -f 2 | uniq -c | xargs)" "$each"
	render "$system" interleaved hosts -1
	is "$system: one connection for each node" "$(sort reached | paste -sd ' ')" 'node1 node2'
done

# ---- bad input: one line, status 2, and nothing is written; unit/test_hosts_job.c has every form -------------------------
# refuses NAME HOSTS ERE
refuses() {
	rm -f out.pfm reached
	run fan -S "$2" rtworker gears.nff
	is "$1, fan: exit 2" "$status" 2
	is "$1, fan: one line" "$(printf '%s\n' "$err" | grep -Ec "^fan: $3[,:] expected ") $(printf '%s\n' "$err" | wc -l)" '1 1'
	run balance adaptive -S "$2" -o out.pfm gears.nff
	is "$1, balance: exit 2" "$status" 2
	is "$1, balance: one line" "$(printf '%s\n' "$err" | grep -Ec ": $3[,:] expected ") $(printf '%s\n' "$err" | wc -l)" '1 1'
	is "$1: nothing is written, and no host is reached" "$(ls out.pfm reached 2>/dev/null)" ''
}
unset PBS_NODEFILE SLURM_JOB_NODELIST SLURM_JOB_CPUS_PER_NODE
refuses 'pbs: without a job' pbs: 'PBS_NODEFILE: not set'
refuses 'slurm: without a job' slurm: 'SLURM_JOB_NODELIST: not set'
printf 'node1\nnode 2\n' >badfile
export PBS_NODEFILE=badfile
refuses 'pbs: a bad line' pbs: "badfile:2: 'node[ ?]2'"
export SLURM_JOB_NODELIST='n[1-3]'
refuses 'slurm: no counts' slurm: 'SLURM_JOB_CPUS_PER_NODE: not set'
export SLURM_JOB_CPUS_PER_NODE='2(x2)'
refuses 'slurm: counts of fewer nodes' slurm: 'SLURM_JOB_CPUS_PER_NODE: fewer nodes'
export SLURM_JOB_NODELIST='n[3-1]'
refuses 'slurm: a bad range' slurm: "SLURM_JOB_NODELIST: '3-1'"
run balance calibrate -S slurm: gears.nff
like 'calibrate takes no job' "$status $err" '^2 balance calibrate: -S slurm:: .*, expected a hosts file'
finish
