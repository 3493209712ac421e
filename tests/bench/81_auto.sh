#!/bin/sh
# 81_auto: what the choice of balance auto costs. It sees a coarse picture, the powers and the trips that it measures
# over links with a delay; then the methods are simulated with the costs of the whole picture, and the regret is the
# time of the chosen one over the best one's, less 1. Costs are scaled to the GDC paper's times: see 80_simulate.
# 3 scenes x 2 views x 4 sets of hosts x 3 latencies. Who has the last long row is a matter of chance: costs are measured
# five times (ROUNDS), and the mean of times counts. It takes two minutes, and wants a quiet machine.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
cc -std=c11 -D_GNU_SOURCE -O2 -I"$root/lib" -o delay "$root/tests/bench/delay.c" "$root/build/libstormring.a" -lpng -lz -lm || stop "no delay"
size=512x512
partition $size >rows.task
printf '2 1,1\n4 1,1,1,1\n8 1,1,1,1,.442,1.347,1,2\n14 1,1,1,1,1,1,1,1,1,1,1,1,.442,1.347\n' >sets
# As in balance-auto: partition's options, and simulate's method.
methods() { # SLOTS POWERS
	run=$(awk -v slots="$1" 'BEGIN { run = int(512 * 512 / (150 * slots)); print (run < 512 ? run : 512) }')
	long=$(awk -v slots="$1" 'BEGIN { run = int(512 * 512 / (150 * slots)); print (run < 250 ? 250 : run) }')
	printf '%s\n' "interleaved|-n $1|fan" 'masterslave||deal' "ds|-u run:$long|deal" "hybrid|-w $2 -c 400/512|deal -q 1" \
		"gdc|-u run:$run -n $1|ring"
}
: >regrets
for scene in gears balls tetra; do
	case $scene in balls) paper_s=97.86 ;; gears) paper_s=1091.14 ;; tetra) paper_s=44.53 ;; esac
	scale=''
	for view in normal imbalanced; do
		# shellcheck disable=SC2046  # a word, or none
		spdgen -s 2 $([ $view = normal ] || echo -V $view) $scene >scene.nff || stop "no $scene"
		# shellcheck disable=SC2154  # lib.sh sets pin
		for r in $(seq "${ROUNDS:-5}"); do
			$pin rtworker scene.nff <rows.task >"whole.$r" || stop "measuring $scene failed"
		done
		[ -n "$scale" ] || scale=$(fragstat -s whole.1 | awk -v s="$paper_s" '$1 == "cpu_s" { print s / $2 }')
		here=$(fan -l -j 1 rtworker | cut -f 3)
		while read -r slots powers; do
			methods "$slots" "$powers" >table
			for ms in 0 .5 20; do
				# A host for each slot, so slow that coarse costs come out at the paper's times.
				echo "$powers" | tr , '\n' | awk -v ms=$ms -v f="$here" -v s="$scale" -v delay="$PWD/delay" \
					'{ printf "host%d power=%.9g via=\"%ssh -c %%c\"\n", NR, $1 * f / s, (ms > 0 ? delay " " ms " " : "") }' >hosts
				pack scene scene.nff | balance-auto $size "$slots" /dev/null fan -S hosts rtworker >chosen 2>why || stop "$(cat why)"
				while IFS='|' read -r method cut run; do
					# shellcheck disable=SC2086
					partition $cut $size >cut.task
					for whole in whole.*; do
						simulate -t "$whole" -x "$scale" -w "$powers" -l $ms $run <cut.task
					done | awk -v m="$method" '$1 == "makespan_s" { n++; s += $2 } END { print m, s / n }'
				done <table | awk -v chosen="$(cat chosen)" -v what="$scene-$view $slots $ms" '
					{ if (NR == 1 || $2 < least) { least = $2; best = $1 } if ($1 == chosen) at = $2 }
					END { printf "%.4f %s %s %s\n", at / least - 1, what, chosen, best }' >>regrets
			done
		done <sets
	done
done
echo 'regret, scene-view, slots, latency in ms, chosen, best:'
sort -g regrets
median 1 <regrets >middle
sort -g regrets | awk -v median="$(cat middle)" '{ worst = $1 } END {
	printf "regret: median %.2f %%, target at most 2 %%: %s\n", 100 * median, median <= .02 ? "met" : "MISSED"
	printf "regret: worst %.2f %%, target at most 5 %%: %s\n", 100 * worst, worst <= .05 ? "met" : "MISSED" }'
