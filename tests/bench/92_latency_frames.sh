#!/bin/sh
# 92_latency_frames: 100 small frames on two hosts that are MS (25) away each way, by interleaved, by adaptive and by
# what else METHODS names ("ds" takes half a minute, "masterslave" two minutes: a round trip for each task). Seconds from
# the first byte to the last picture, in turns, ROUNDS times; the last line is the median of adaptive / interleaved.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=${ROUNDS:-5} ms=${MS:-25} size=64x48

built delay
spdgen -s 1 balls >balls.nff
for n in $(seq 0 99); do sed "s/^from .*/from 2.$n 1.3 1.7/" balls.nff >"$n.nff"; done
printf 'a via="%s/delay %s sh -c %%c"\nb via="%s/delay %s sh -c %%c"\n' "$tmp" "$ms" "$tmp" "$ms" >hosts
# stream [OPTIONS]: all frames, each with a scene of its own
stream() { for n in $(seq 0 99); do pack scene "$n.nff" && partition -F "$n" "$@" $size; done; }
stream >demand.task
stream -n 2 >turn.task
stream -u coarse:250 -n 2 -c 0 >runs.task
seconds() {
	case $1 in
	interleaved) wall_s 'fan -S hosts rtworker - <turn.task | gather -o x%d.pfm' ;;
	adaptive) wall_s 'deal -q auto -e fan -S hosts rtworker - <demand.task | gather -o x%d.pfm' ;;
	masterslave) wall_s 'deal fan -S hosts rtworker - <demand.task | gather -o x%d.pfm' ;;
	ds) wall_s 'deal fan -S hosts rtworker - <runs.task | gather -o x%d.pfm' ;;
	*) stop "$1: expected interleaved, adaptive, masterslave or ds" ;;
	esac
}
i=0
while [ $((i += 1)) -le "$rounds" ]; do
	for m in interleaved adaptive ${METHODS-}; do
		s=$(seconds "$m") || stop "$m failed"
		echo "$m $s"
	done
done | tee all
awk '$1 == "interleaved" { s = $2 } $1 == "adaptive" { print $2 / s }' all >ratios
report 'adaptive / interleaved' "$(median 1 <ratios)" '' 1.3
