#!/bin/sh
# One seeded fault in one of the streams of a run, either way: the same picture, or a status other than 0 with a reason.
# FAULTS=5000 FIRST=SEED tests/57_damage.t is a campaign; what failed is printed as a command.
. "$(dirname "$0")/lib.sh"
cc -std=c11 -D_GNU_SOURCE -O -I"$root/lib" -o damage "$root/tests/damage.c" "$root/build/libstormring.a" -lpng -lz -lm ||
	{ echo 'Bail out! tests/damage.c does not compile'; exit 3; }
PATH=$tmp:$PATH
for frame in 0 1; do
	spdgen -s 1 tetra | sed "s/^angle .*/angle 4$frame/" >scene$frame
	pack scene scene$frame
	echo "frame $frame 8 6 $(rtworker -i -s 8x6 scene$frame | grep job=)"
done >states
partition 8x6@states >tasks
grep -a ^frame states >frames
rtworker - <tasks | gather -e frames -o true%d.pfm
# The first worker that starts has the fault.
cat >down <<'END'
mkdir once 2>/dev/null || exec "$@"
damage "$seed" | "$@"
END
cat >up <<'END'
mkdir once 2>/dev/null || exec "$@"
"$@" | damage "$seed"
END
cat >places <<'END'
damage "$seed" <tasks | rtworker -
damage "$seed" <tasks | fan -t 2 -j 2 rtworker -
damage "$seed" <tasks | deal fan -t 2 -j 2 rtworker -
damage "$seed" <tasks | ringctl fan -t 2 -j 2 ringctl -n rtworker -
deal sh -c 'damage "$seed" | fan -t 2 -j 2 rtworker -' <tasks
ringctl sh -c 'damage "$seed" | fan -t 2 -j 2 ringctl -n rtworker -' <tasks
deal fan -t 2 -j 2 sh ./down rtworker - <tasks
ringctl fan -t 2 -j 2 sh ./down ringctl -n rtworker - <tasks
fan -t 2 -j 2 sh ./up rtworker - <tasks
deal fan -t 2 -j 2 sh ./up rtworker - <tasks
ringctl fan -t 2 -j 2 sh ./up ringctl -n rtworker - <tasks
ringctl fan -t 2 -j 2 ringctl -n sh ./up rtworker - <tasks
deal sh -c 'fan -t 2 -j 2 rtworker - | damage "$seed"' <tasks
ringctl sh -c 'fan -t 2 -j 2 ringctl -n rtworker - | damage "$seed"' <tasks
deal fan -t 2 -j 2 rtworker - <tasks | damage "$seed"
END
n_places=$(wc -l <places)
seed=${FIRST:-1} end=$((${FIRST:-1} + ${FAULTS:-120})) good=0 refused=0 bad=''
export seed
while [ "$seed" -lt "$end" ]; do
	place=$(sed -n $((seed % n_places + 1))p places)
	rm -rf once damaged f?.pfm said
	timeout 60 sh -c "{ $place; } 2>said | gather -e frames -o f%d.pfm 2>>said"
	status=$?
	why=''
	case $status in
	0) cmp -s f0.pfm true0.pfm && cmp -s f1.pfm true1.pfm || why='another picture with status 0' ;;
	124) why='it hangs' ;;
	[123]) [ -s said ] || why="status $status without a reason" ;;
	*) why="status $status" ;;
	esac
	! grep -q 'signal-\(4\|6\|7\|8\|11\)\|Sanitizer\|core dumped' said || why='a crash'
	for frame in 0 1; do [ ! -e f$frame.pfm ] || cmp -s f$frame.pfm true$frame.pfm || [ $status -ne 0 ] || why='another picture'; done
	if [ $status -eq 0 ]; then good=$((good + 1)); else refused=$((refused + 1)); fi
	if [ -n "$why" ]; then
		bad="$bad $seed"
		diag "$why: FAULTS=1 FIRST=$seed tests/57_damage.t: $place"
		diag "$(cat damaged 2>/dev/null; head -c 600 said)"
	fi
	seed=$((seed + 1))
done
is 'the same picture, or a status and a reason' "$bad" ''
[ "${FAULTS:-120}" -lt 100 ] || ok 'of either some' [ $good -gt 9 -a $refused -gt 9 ]
diag "$good runs gave the picture, $refused said why not"
finish
