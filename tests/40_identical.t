#!/bin/sh
# Invariants 1 and 7: the same bytes, whatever the method, the number of slots, the cut, the order, the width of the
# vectors and the nesting. The picture of one worker and no balancer is the measure.
. "$(dirname "$0")/lib.sh"

spdgen -s 1 gears >gears.nff
spdgen -s 2 balls >balls.nff
size=96x80

# render NAME COMMAND ...: the picture of the stream that COMMAND makes of state and tasks
one() { partition $size | rtworker "$1.nff" | gather -o "$1.pfm"; }
for s in gears balls; do
	one "$s"
	for slots in 1 2 3 7; do
		for m in interleaved masterslave; do
			balance $m -j "$slots" -s $size -o out.pfm $s.nff
			ok "$s: $m on $slots slots" cmp out.pfm $s.pfm
		done
	done
done

for slots in 3 7; do
	for m in hybrid ss sc ds dc; do
		balance $m -j "$slots" -s $size -o out.pfm gears.nff
		ok "gears: $m on $slots slots" cmp out.pfm gears.pfm
	done
done

# cut CUT [PARTITION OPTIONS]
for cut in row tile:16x16 tile:7x5 run:250 run:1000 run:97; do
	{ pack scene gears.nff; partition -u $cut $size; } | deal fan -j 3 rtworker - | gather -o out.pfm
	ok "cut by $cut, dealt" cmp out.pfm gears.pfm
	partition -u $cut -n 3 $size | fan -j 3 rtworker gears.nff | gather -o out.pfm
	ok "cut by $cut, static" cmp out.pfm gears.pfm
done
for slots in 1 3 7; do
	partition -u scatter -n "$slots" $size | fan -j "$slots" rtworker gears.nff | gather -o out.pfm
	ok "scattered over $slots" cmp out.pfm gears.pfm
done

# isa ISA: what this machine cannot run cannot be compared
for isa in sse2 avx2; do
	if rtworker -x $isa -i gears.nff >/dev/null 2>&1; then
		partition $size | rtworker -x $isa gears.nff | gather -o out.pfm
		ok "vectors of $isa" cmp out.pfm gears.pfm
	else
		skip "vectors of $isa" "this processor has none"
	fi
done

state() { pack scene gears.nff; partition $size; }
state | deal fan -j 2 deal fan -j 2 rtworker - | gather -r tree.frags -o out.pfm
ok "deal fan -j 2 deal fan -j 2" cmp out.pfm gears.pfm
is "all four of its workers are given work" "$(fragstat tree.frags | awk 'NR > 1 && $2 > 0' | wc -l)" 4
state | deal -q 3 fan -j 2 deal -q 2 fan -j 2 deal fan -j 2 rtworker - | gather -o out.pfm
ok "three levels, deeper queues" cmp out.pfm gears.pfm
{ pack scene gears.nff; partition -n 2 $size; } | fan -j 2 fan -j 2 rtworker - | gather -o out.pfm
ok "fan -j 2 fan -j 2" cmp out.pfm gears.pfm
state | deal fan -j 2 rtworker -f 17 - | gather -o out.pfm
ok "fragments of 17 pixels" cmp out.pfm gears.pfm
state | deal -q 2 fan -j 3 rtworker -c - | gather -o out.pfm
ok "concentrated transfer" cmp out.pfm gears.pfm
{ pack scene gears.nff; partition -w 1,2,1 -c 60 $size; } | deal -q 1 fan -j 3 rtworker - | gather -o out.pfm
ok "weighted interleave, then on demand" cmp out.pfm gears.pfm
{ pack scene gears.nff; partition $size | awk '/^task/ { t[n++] = $0; next } 1
	END { for (i = n; i-- > 0;) print t[i] }'; } | deal fan -j 2 rtworker - | gather -o out.pfm
ok "tasks in reverse order" cmp out.pfm gears.pfm

# Samples and depth change the picture, and stay the same over methods too.
partition $size | rtworker -a 4:.05 -d 3 gears.nff | gather -o fine.pfm
balance masterslave -j 3 -s $size -W '-a 4:.05 -d 3' -o out.pfm gears.nff
ok "refined samples: the same" cmp out.pfm fine.pfm
run cmp -s fine.pfm gears.pfm
is "and not the picture of one sample" "$status" 1

# A second frame in the same stream.
{ pack scene gears.nff; partition -F 0 $size; partition -F 1 $size; } | deal fan -j 2 rtworker - | gather -o f%d.pfm
ok "frame 0 of two" cmp f0.pfm gears.pfm
ok "frame 1 of two" cmp f1.pfm gears.pfm
finish
