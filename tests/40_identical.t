#!/bin/sh
# Invariants 1 and 7: the same bytes for every method, number of slots, cut, order, vector width and nesting. The
# reference is the picture of one worker without a balancer.
. "$(dirname "$0")/lib.sh"
patient

spdgen -s 1 gears >gears.nff
spdgen -s 2 balls >balls.nff
size=96x80

# same NAME PICTURE: out.pfm is the same; removes it, so that no later assertion reads it
same() { ok "$1" cmp out.pfm "$2"; rm -f out.pfm; }
one() { partition $size | rtworker "$1.nff" | gather -o "$1.pfm"; }
for s in gears balls; do
	one "$s"
	# Another scene, on one number of slots: no method looks into a scene.
	numbers='1 2 3 7'
	[ $s = gears ] || [ -n "${NIGHT-}" ] || numbers=3
	for slots in $numbers; do
		for m in adaptive interleaved masterslave gdc; do
			balance $m -j "$slots" -s $size -o out.pfm $s.nff
			same "$s: $m on $slots slots" $s.pfm
		done
	done
done

for slots in 3 7; do
	for m in hybrid gdc-published ss sc ds dc; do
		balance $m -j "$slots" -s $size -o out.pfm gears.nff
		same "gears: $m on $slots slots" gears.pfm
	done
done

# cut CUT [PARTITION OPTIONS]
for cut in row tile:16x16 tile:7x5 run:250 run:1000 run:97; do
	{ pack scene gears.nff; partition -u $cut $size; } | deal fan -j 3 rtworker - | gather -o out.pfm
	same "cut by $cut, dealt" gears.pfm
	partition -u $cut -n 3 $size | fan -j 3 rtworker gears.nff | gather -o out.pfm
	same "cut by $cut, static" gears.pfm
done
for slots in 1 3 7; do
	partition -u scatter -n "$slots" $size | fan -j "$slots" rtworker gears.nff | gather -o out.pfm
	same "scattered over $slots" gears.pfm
done

# isa ISA: skipped if this machine does not have it
for isa in sse2 avx2 avx512; do
	if rtworker -x $isa -i gears.nff >/dev/null 2>&1; then
		partition $size | rtworker -x $isa gears.nff | gather -o out.pfm
		same "vectors of $isa" gears.pfm
	else
		skip "vectors of $isa" "this processor has none"
	fi
done

# Hierarchies: every scene of SPD, and those written by hand.
for s in $(spdgen -l -s 1 | awk '!/^#/ { print $1 }') "$root"/scenes/*.nff; do
	case $s in */*) cp "$s" scene.nff ;; *) spdgen -s 1 "$s" >scene.nff ;; esac
	partition 32x24 | rtworker scene.nff | gather -o bvh.pfm
	for b in slabs none; do
		partition 32x24 | rtworker -b $b scene.nff | gather -o out.pfm
		same "$(basename "$s" .nff): -b $b" bvh.pfm
	done
done

state() { pack scene gears.nff; partition $size; }
# On a loaded machine too, no worker starts its first task before all four have one.
cat >together <<'END'
#!/bin/sh
while IFS= read -r line; do
	case $line in 'task '*) : >has.$$; until [ "$(ls has.* | wc -l)" -ge 4 ]; do sleep .05; done ;; esac
	printf '%s\n' "$line"
done | rtworker -
END
chmod +x together
# four COMMAND: four slots have done tasks
four() {
	rm -f tried.frags has.*
	"$@" | gather -r tried.frags -o out.pfm
	fragstat tried.frags | awk 'NR > 1 && $2 > 0 { n++ } END { exit n != 4 }'
}
tree() { state | deal fan -t 300 -j 2 deal fan -t 300 -j 2 ./together; }
ok "all four workers of a tree get tasks" four tree
same "deal fan -j 2 deal fan -j 2" gears.pfm
state | deal -q 3 fan -j 2 deal -q 2 fan -j 2 deal fan -j 2 rtworker - | gather -o out.pfm
same "three levels, deeper queues" gears.pfm
{ pack scene gears.nff; partition -n 2 $size; } | fan -j 2 fan -j 2 rtworker - | gather -o out.pfm
same "fan -j 2 fan -j 2" gears.pfm
ring() { { pack scene gears.nff; partition -n 3 $size; } | "$@" | gather -r ring.frags -o out.pfm; }
ring ringctl fan -j 3 ringctl -n deal fan -j 2 rtworker -
same "a ring of nodes of two slots" gears.pfm
rm ring.frags
rings() { { pack scene gears.nff; partition -n 3 "$size"; } | deal -q 2 fan -t 300 -j 2 ringctl fan -t 300 -j 2 ringctl -n ./together; }
ok "all four nodes of two rings under one deal get tasks" four rings
same "rings dealt to" gears.pfm
ring ringctl fan -j 2 ringctl -n ringctl -p fan -j 2 ringctl -n rtworker -
same "rings in a ring" gears.pfm
rm ring.frags
ring ringctl ringctl -n rtworker -
same "a ring of one node and no fan" gears.pfm
rm ring.frags
ring ringctl -n rtworker -
same "a node and no ring" gears.pfm
rm ring.frags
{ pack scene gears.nff; partition $size; } | ringctl fan -j 3 ringctl -n rtworker -c -f 100 - | gather -o out.pfm
same "a ring, concentrated transfer" gears.pfm
state | deal fan -j 2 rtworker -f 17 - | gather -o out.pfm
same "fragments of 17 pixels" gears.pfm
state | deal -q 2 fan -j 3 rtworker -c - | gather -o out.pfm
same "concentrated transfer" gears.pfm
{ pack scene gears.nff; partition -w 1,2,1 -c 60 $size; } | deal -q 1 fan -j 3 rtworker - | gather -o out.pfm
same "weighted interleave, then on demand" gears.pfm
{ pack scene gears.nff; partition $size | awk '/^task/ { t[n++] = $0; next } 1
	END { for (i = n; i-- > 0;) print t[i] }'; } | deal fan -j 2 rtworker - | gather -o out.pfm
same "tasks in reverse order" gears.pfm

# Samples and depth change the picture, and stay the same over methods too.
partition $size | rtworker -a 4:.05 -d 3 gears.nff | gather -o fine.pfm
balance masterslave -j 3 -s $size -W '-a 4:.05 -d 3' -o out.pfm gears.nff
same "refined samples: the same" fine.pfm
run cmp -s fine.pfm gears.pfm
is "refined samples: not the picture of one sample" "$status" 1

# A second frame in the same stream.
{ pack scene gears.nff; partition -F 0 $size; partition -F 1 $size; } | deal fan -j 2 rtworker - | gather -o f%d.pfm
ok "frame 0 of two" cmp f0.pfm gears.pfm
ok "frame 1 of two" cmp f1.pfm gears.pfm
finish
