#!/bin/sh
# 92_latency_frames: 100 frames of 64x48 on two hosts that are MS (25) ms away each way, by interleaved, by adaptive and
# by the methods in METHODS ("ds" and "masterslave": a round trip for each task). Seconds from the first byte to the
# last picture, in turns, ROUNDS times; the last line is the median of adaptive / interleaved. Frames of 2 ms (the link
# decides) and of 20 ms (the hosts decide).
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=${ROUNDS:-5} ms=${MS:-25} size=64x48

built delay
spdgen -s 1 balls >balls.nff
for n in $(seq 0 99); do sed "s/^from .*/from 2.$n 1.3 1.7/" balls.nff >"$n.nff"; done
printf 'a via="%s/delay %s sh -c %%c"\nb via="%s/delay %s sh -c %%c"\n' "$tmp" "$ms" "$tmp" "$ms" >hosts
for n in $(seq 0 99); do pack scene "$n.nff" && echo "frame $n ${size%x*} ${size#*x}"; done >states
seconds() { # METHOD OPTIONS: prints the seconds until its last picture is written
	rm -f x*.pfm
	begin=$(date +%s.%N)
	# shellcheck disable=SC2086  # words
	"balance-$1" $size@states 2 /dev/null fan -S hosts rtworker $2 - </dev/null | gather -o x%02d.pfm || return
	stat -c %.9Y x*.pfm | sort -n | awk -v begin="$begin" 'END { if (NR != 100) exit 1; printf "%.6f\n", $1 - begin }'
}
for options in '-a 1' '-a 16'; do
	i=0
	while [ $((i += 1)) -le "$rounds" ]; do
		for m in interleaved adaptive ${METHODS-}; do
			s=$(seconds "$m" "$options") || stop "$m failed"
			echo "$m $options $s"
		done
	done | tee all
	awk '$1 == "interleaved" { s = $4 } $1 == "adaptive" { print $4 / s }' all >ratios
	report "adaptive / interleaved, $options" "$(median 1 <ratios)" '' 1.3
done
