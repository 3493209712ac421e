#!/bin/sh
# One seeded fault in one stream of a run, in either direction: the picture is the same, or the status is not 0 and a
# message gives the reason. FAULTS=5000 FIRST=SEED tests/57_damage.t is a campaign; a failure is printed as a command.
# PACKED=1: only in streams with packed records.
. "$(dirname "$0")/lib.sh"
compile damage
PATH=$tmp:$PATH
# Two frames of a scene and two of a grid, in directories named like their workers.
mkdir rtworker vcworker
for frame in 0 1; do
	spdgen -s 1 tetra | sed "s/^angle .*/angle 4$frame/" >scene$frame
	{ pack scene scene$frame; echo "frame $frame 8 6 $(rtworker -i -s 8x6 scene$frame | grep job=)"; } >>rtworker/states
done
awk 'BEGIN {
	print "# vtk DataFile Version 3.0\na\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 4 4 3"
	print "X_COORDINATES 4 float\n0 1 2 3\nY_COORDINATES 4 float\n0 1 2 3\nZ_COORDINATES 3 float\n0 1 2"
	print "POINT_DATA 48\nSCALARS a float 1\nLOOKUP_TABLE default"
	for (i = 0; i < 48; i++) print i * i % 37
}' >grid
pack grid grid >vcworker/states
for frame in 0 1; do
	printf '%s\n' "from 9 -8 ${frame}6" 'at 1.5 1.5 1' 'up 0 0 1' 'angle 35' 'resolution 8 6' \
		'map 5 .1 .4 .9 0' 'map 30 .9 .3 .1 .8' >spec$frame
	{ pack spec spec$frame; echo "frame $frame 8 6 $(vcworker -i grid spec$frame | grep job=)"; } >>vcworker/states
done
for worker in rtworker vcworker; do
	partition 8x6@$worker/states >$worker/tasks
	grep -a ^frame $worker/states >$worker/frames
	$worker <$worker/tasks | gather -e $worker/frames -o $worker/true%d.pfm ||
		{ echo "Bail out! no picture of $worker"; exit 3; }
done
# The first worker that starts has the fault.
cat >down <<'END'
mkdir once 2>/dev/null || exec "$@"
damage "$seed" | "$@"
END
cat >up <<'END'
mkdir once 2>/dev/null || exec "$@"
"$@" | damage "$seed"
END
# Slots of other machines, played by shells, with packed records.
for way in down up; do printf '%s\n' "a via=\"sh ./$way sh -c %c\"" "b via=\"sh ./$way sh -c %c\"" >$way.hosts; done
cat >places <<'END'
damage "$seed" <$worker/tasks | $worker
damage "$seed" <$worker/tasks | fan -t 2 -j 2 $worker
damage "$seed" <$worker/tasks | deal fan -t 2 -j 2 $worker
damage "$seed" <$worker/tasks | ringctl fan -t 2 -j 2 ringctl -n $worker
deal sh -c 'damage "$seed" | fan -t 2 -j 2 $worker' <$worker/tasks
ringctl sh -c 'damage "$seed" | fan -t 2 -j 2 ringctl -n $worker' <$worker/tasks
deal fan -t 2 -j 2 sh ./down $worker <$worker/tasks
ringctl fan -t 2 -j 2 sh ./down ringctl -n $worker <$worker/tasks
fan -t 2 -j 2 sh ./up $worker <$worker/tasks
deal fan -t 2 -j 2 sh ./up $worker <$worker/tasks
ringctl fan -t 2 -j 2 sh ./up ringctl -n $worker <$worker/tasks
ringctl fan -t 2 -j 2 ringctl -n sh ./up $worker <$worker/tasks
deal sh -c 'fan -t 2 -j 2 $worker | damage "$seed"' <$worker/tasks
ringctl sh -c 'fan -t 2 -j 2 ringctl -n $worker | damage "$seed"' <$worker/tasks
deal fan -t 2 -j 2 $worker <$worker/tasks | damage "$seed"
deal sh -c 'damage "$seed" | fan -t 2 -j 1 $worker' <$worker/tasks
deal sh -c 'fan -t 2 -j 1 $worker | damage "$seed"' <$worker/tasks
deal sh -c 'damage "$seed" | $worker' <$worker/tasks
deal sh -c '$worker | damage "$seed"' <$worker/tasks
END
cat >packed <<'END'
deal fan -z on -t 2 -S down.hosts $worker <$worker/tasks
ringctl fan -z on -t 2 -S down.hosts ringctl -n $worker <$worker/tasks
fan -z on -t 2 -S up.hosts $worker <$worker/tasks
deal fan -z on -t 2 -S up.hosts $worker <$worker/tasks
deal fan -1 -z on -t 2 -S up.hosts $worker <$worker/tasks
ringctl fan -z on -t 2 -S up.hosts ringctl -n $worker <$worker/tasks
deal fan -z auto -t 2 -S up.hosts $worker <$worker/tasks
END
if fan -l -z on >said 2>&1; then
	[ -z "${PACKED-}" ] || : >places
	cat packed >>places
elif [ -n "${PACKED-}" ]; then
	echo "1..0 # SKIP $(cat said)"
	exit 0
fi
n_places=$(wc -l <places)
seed=${FIRST:-1} end=$((${FIRST:-1} + ${FAULTS:-120})) good=0 refused=0 bad=''
export seed worker
while [ "$seed" -lt "$end" ]; do
	place=$(sed -n $((seed % n_places + 1))p places)
	worker=rtworker
	[ $((seed / n_places % 2)) -eq 0 ] || worker=vcworker
	rm -rf once damaged f?.pfm said
	timeout 1200 sh -c "{ $place; } 2>said | gather -e $worker/frames -o f%d.pfm 2>>said"
	status=$?
	why=''
	case $status in
	0) cmp -s f0.pfm $worker/true0.pfm && cmp -s f1.pfm $worker/true1.pfm || why='another picture with status 0' ;;
	124) why='it hangs' ;;
	[123]) [ -s said ] || why="status $status without a reason" ;;
	*) why="status $status" ;;
	esac
	! grep -q 'signal-\(4\|6\|7\|8\|11\)\|Sanitizer\|core dumped' said || why='a crash'
	for frame in 0 1; do [ ! -e f$frame.pfm ] || cmp -s f$frame.pfm $worker/true$frame.pfm || [ $status -ne 0 ] || why='another picture'; done
	if [ $status -eq 0 ]; then good=$((good + 1)); else refused=$((refused + 1)); fi
	if [ -n "$why" ]; then
		bad="$bad${bad:+, }$seed"
		diag "$why, to repeat: ${PACKED:+PACKED=1 }FAULTS=1 FIRST=$seed tests/57_damage.t: $place"
		diag "$(cat damaged 2>/dev/null; head -c 600 said)"
	fi
	seed=$((seed + 1))
done
is 'each fault: the same picture, or a status and a reason' "$bad" ''
[ "${FAULTS:-120}" -lt 100 ] || ok 'both results occur' [ $good -gt 9 -a $refused -gt 9 ]
diag "$good runs gave the picture, $refused said why not"
finish
