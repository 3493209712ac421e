#!/bin/sh
# 28_first: efficiencies of adaptive, gdc and a schedule that knows all costs, in virtual time, where the first share of a
# slot matters: six scenes of 512x512, hosts x latency (one way) x work for each host. Cuts and rules are those of the
# shipped scripts. SCENES, HOSTS, LATENCIES_MS and WORK_S choose fewer. Then the means over the scenes.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
here=$root/bin temporary=$tmp
# shellcheck source=../../bin/virtual.sh
. "$root/bin/virtual.sh"

# powers HOSTS: 14 workstations of the paper, 37 equal ones, or one of power 20 among 13 of 1
powers() {
	case $1 in
	14) echo "$workstations" ;;
	20) echo 20,1,1,1,1,1,1,1,1,1,1,1,1,1 ;;
	*) seq "$1" | sed 's/.*/1/' | paste -sd , ;;
	esac
}
# efficiency METHOD
efficiency() {
	# shellcheck disable=SC2086
	if [ "$1" = best ]; then partition 512x512 | $simulated best
	else shipped "$simulated" "$1" 512x512 "$slots" /dev/null fan -j "$slots" rtworker
	fi | awk '$1 == "efficiency" { print $2 }'
}
printf 'scene\thosts\tms\ts\tadaptive\tgdc\tbest\n'
for scene in ${SCENES:-gears balls tetra shells mount rings}; do
	spdgen -s 2 "$scene" >scene.nff || stop "spdgen $scene failed"
	partition -u run:64 512x512 | rtworker -a 4 scene.nff >frags || stop 'rtworker failed'
	cpu=$(fragstat -s frags | awk '$1 == "cpu_s" { print $2 }')
	for hosts in ${HOSTS:-14 37 20}; do
		power=$(powers "$hosts") && slots=$(echo "$power" | tr , '\n' | wc -l)
		for ms in ${LATENCIES_MS:-.5 5 50 150}; do
			for s in ${WORK_S:-2 20}; do
				x=$(echo "$power" | tr , '\n' | awk -v s="$s" -v cpu="$cpu" '{ sum += $1 } END { print sum * s / cpu }')
				simulated="simulate -t frags -x $x -w $power -l $ms"
				printf '%s\t%s\t%s\t%s' "$scene" "$hosts" "$ms" "$s"
				for method in adaptive gdc best; do printf '\t%s' "$(efficiency $method)"; done
				echo
			done
		done
	done
done | tee table
awk '{ k = $2 "\t" $3 "\t" $4; if (!n[k]++) order[++m] = k; for (c = 5; c <= 7; c++) sum[k, c] += $c }
	END { for (i = 1; i <= m; i++) { k = order[i]
		printf "mean\t%s\t%.3f\t%.3f\t%.3f\n", k, sum[k, 5] / n[k], sum[k, 6] / n[k], sum[k, 7] / n[k] } }' table
