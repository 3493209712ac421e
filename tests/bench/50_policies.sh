#!/bin/sh
# 50_policies: when do the options of deal and partition that the papers do not have pay? Makespan / lower bound of each
# method in virtual time (the shipped policy, a model of slots and links), with costs measured per 16 pixels of the
# scenes of the papers at 512x512; medians of 5 such measurements. The lower bound is that of pixels; it ignores latency
# and the host that slows down.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds='1 2 3 4 5'

built policy_bench
for s in gears balls tetra; do
	spdgen -s 2 $s >$s.nff || stop "spdgen $s failed"
	# shellcheck disable=SC2154  # lib.sh sets pin
	for r in $rounds; do
		partition -u run:16 512x512 | $pin rtworker $s.nff >$s.$r.frags || stop "rendering $s failed"
		partition 64x64 | $pin rtworker $s.nff >$s.$r.small || stop "rendering $s failed"
	done
done

# The methods: options of partition, options of deal. N, POWERS and SCENE are filled in.
cat >methods <<'END'
-n N|
-w POWERS|
|
|-q 1
|-q 4
|-q auto
-u guided -n N|
-u factoring -n N|
-u factoring -w POWERS|
-o cost:SCENE.small|
-n N|-e
|-e
-u guided -n N|-e
-u factoring -w POWERS|-e
-o cost:SCENE.small|-e
|-e -q auto
END

# setting NAME POWERS "GEARS_S BALLS_S TETRA_S" [OPTIONS]: prints a table. The seconds are the cost of a picture at power 1.
setting() {
	printf '%s\n  %-24s %-12s   gears  balls  tetra\n' "$1" partition deal
	powers=$2 costs=$3
	shift 3
	slots=$(echo "$powers" | tr , '\n' | wc -l)
	while IFS='|' read -r cut give; do
		printf '  %-24s %-12s ' "$cut" "$give"
		i=0
		for s in gears balls tetra; do
			i=$((i + 1))
			t=$(echo "$costs" | cut -d' ' -f$i)
			for r in $rounds; do
				cut_s=$(echo "$cut" | sed "s/\\<N\\>/$slots/; s/POWERS/$powers/; s/SCENE/$s.$r/")
				# shellcheck disable=SC2086
				partition $cut_s 512x512 | ./policy_bench $give -t "$t" -w "$powers" "$@" $s.$r.frags ||
					stop "partition $cut, deal $give: failed"
			done >out
			awk '{ print $1 / $2 }' out | median 1 | awk '{ printf " %6.3f", $1 }'
		done
		echo
	done <methods
}

eight=1,1,1,1,1,1,1,1
paper=$workstations
seconds='1091 97.86 44.5' # the paper's, on its reference host
setting 'A. 8 equal hosts, no latency' $eight "$seconds" -c 100
setting "B. the paper's 14 hosts, 1 ms" $paper "$seconds" -c 100 -l 1000
setting 'C. 8 equal hosts, 20 ms one way, rows of 39 ms' $eight '20 20 20' -c 100 -l 20000
setting "D. as B; the first host falls to 5 % of its power half-way" $paper "$seconds" -c 100 -l 1000 -s
echo "100 us are added to each task's pixels; links vary by half of their mean"
