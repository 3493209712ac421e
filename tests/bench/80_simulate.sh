#!/bin/sh
# 80_simulate: many hosts in virtual time. Efficiency (lower bound / makespan) of the shipped methods on 14, 100 and 1000
# hosts, 512x512, .5 ms one way, 20 s of work for each host; 14 hosts are those of the GDC paper. Medians of three
# measured costs (ROUNDS). And the time to simulate 10,000 hosts with 1,000,000 tasks. For the cost of a steal, see protocol steals.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
# shellcheck source=../peaks.sh
. "$root/tests/peaks.sh"
here=$root/bin temporary=$tmp
# shellcheck source=../../bin/virtual.sh
. "$root/bin/virtual.sh"

of() { awk -F '\t' -v key="$1" '$1 == key { print $2 }' figures; }
scenes='gears mount rings lattice'
for _ in $(seq "${ROUNDS:-3}"); do
	for scene in $scenes; do
		spdgen "$scene" >scene.nff || stop "spdgen $scene failed"
		# shellcheck disable=SC2154  # lib.sh sets pin
		partition -u run:64 512x512 | $pin rtworker -a 4 scene.nff >frags || stop 'rtworker failed'
		for hosts in 14 100 1000; do
			power=$hosts slots="-j $hosts"
			[ $hosts != 14 ] || power=13.789 slots="-w $workstations"
			scale=$(fragstat -s frags | awk -v s="$power" '$1 == "cpu_s" { print 20 * s / $2 }')
			for method in adaptive gdc masterslave; do
				shipped "simulate -t frags -x $scale -l .5 $slots" $method 512x512 $hosts /dev/null \
					fan -j $hosts rtworker >figures || stop "$method failed"
				of efficiency >>"$method.$hosts.$scene"
			done
		done
	done
done
# shellcheck disable=SC2086  # words
printf '%-24s' 'method, hosts' && printf ' %8s' $scenes && echo
for method in adaptive gdc masterslave; do for hosts in 14 100 1000; do
	printf '%-12s %5d hosts' $method $hosts
	for scene in $scenes; do printf ' %8.3f' "$(median 1 <"$method.$hosts.$scene")"; done
	echo
done; done
for hosts in 100 1000; do
	for scene in $scenes; do median 1 <"adaptive.$hosts.$scene"; done | sort -g | awk -v n=$hosts '
		NR == 1 { printf "adaptive, %d hosts: at least %.3f, target .97: %s\n", n, $1, ($1 >= .97 ? "met" : "MISSED") }'
done

partition -u run:1 1000x1000 >big.task
for method in deal ring; do
	measured "simulate -j 10000,3 -l .5 -m 100000,4 $method <big.task >figures; times >times"
	took=$(tail -n 1 times | awk '{ split($1, u, /[ms]/); split($2, s, /[ms]/); print 60 * (u[1] + s[1]) + u[2] + s[2] }')
	echo "$method, 10,000 hosts, $(of tasks) tasks: $(of events) events, $(most simulate kib) KiB, efficiency $(of efficiency)"
	report "$method: CPU" "$took" ' s' 60
done
