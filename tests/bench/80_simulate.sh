#!/bin/sh
# 80_simulate: many hosts in virtual time. 1000 unequal hosts (powers 1/3 to 3) at links of .5 ms, where tasks must be
# shorter than rows: gears of 512x512 by runs of two pixels, at the GDC paper's 1091 s, medians of nine measured costs
# (ROUNDS). And the time to simulate 10,000 hosts with 1,000,000 tasks. For fewer hosts, and the cost of a steal, see
# protocol latency, scale and steals.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
# shellcheck source=../peaks.sh
. "$root/tests/peaks.sh"

of() { awk -F '\t' -v key="$1" '$1 == key { print $2 }' figures; }
spdgen -s 2 gears >gears.nff && partition 512x512 >rows.task && partition -u run:2 512x512 >runs.task || exit 3
for round in $(seq "${ROUNDS:-9}"); do
	# shellcheck disable=SC2154  # lib.sh sets pin
	$pin rtworker gears.nff <rows.task >gears.frags || stop 'rtworker failed'
	scale=$(fragstat -s gears.frags | awk '$1 == "cpu_s" { print 1091.14 / $2 }')
	for method in ring deal 'deal -q auto'; do
		# shellcheck disable=SC2086
		simulate -t gears.frags -x "$scale" -s "$round" -j 1000,3 -l .5 $method <runs.task >figures || stop "$method failed"
		of efficiency >>"$method.1000"
	done
done
for method in ring deal 'deal -q auto'; do echo "1000 hosts, $method: efficiency $(median 1 <"$method.1000")"; done
median 1 <ring.1000 | awk '{ printf "gdc on 1000 hosts: %.3f, target at least .9: %s\n", $1, ($1 >= .9 ? "met" : "MISSED") }'

partition -u run:1 1000x1000 >big.task
for method in deal ring; do
	measured "simulate -j 10000,3 -l .5 -m 100000,4 $method <big.task >figures; times >times"
	took=$(tail -n 1 times | awk '{ split($1, u, /[ms]/); split($2, s, /[ms]/); print 60 * (u[1] + s[1]) + u[2] + s[2] }')
	echo "$method, 10,000 hosts, $(of tasks) tasks: $(of events) events, $(most simulate kib) KiB, efficiency $(of efficiency)"
	report "$method: CPU" "$took" ' s' 60
done
