#!/bin/sh
# 74_dead: 200 hosts that do not answer (DEAD) and four test hosts (tests/README) with sshd, in a shuffled order: seconds from
# the command to the first pixels, and to the picture, by `balance adaptive -S`, beside the run without the dead ones. Medians
# of ROUNDS (3). Dead hosts are addresses of the same network without a machine. Target: 3 s more at most.
hosts=$(cd "$(dirname "$0")/.." && pwd)/hosts
why=$("$hosts" check 2>&1) || { echo "74_dead: no test hosts: $why"; exit 0; }
[ -n "${TEST_HOSTS-}" ] || exec "$hosts" with 4 "$0" "$@"
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
dead=${DEAD:-200}
spdgen tetra >tetra.nff || stop 'spdgen failed'
grep -v '^#' "$TEST_HOSTS/hosts" >living
{ cat living && seq -f '198.18.0.%g' 50 $((49 + dead)); } |
	awk 'BEGIN { srand(1) } { print rand() "\t" $0 }' | sort | cut -f 2- >room
# once HOSTS: adds "first whole" to the file of that name
once() {
	rm -f log
	begin=$(date +%s.%N)
	balance adaptive -S "$1" -s 256x256 -r log -o "$1.pfm" tetra.nff 2>"$1.said" &
	until grep -aqs '^done ' log || ! kill -0 $!; do sleep .01; done 2>/dev/null
	first=$(date +%s.%N)
	wait $! || { tail -n 3 "$1.said"; stop "$1 failed"; }
	echo "$begin $first $(date +%s.%N)" | awk '{ print $2 - $1, $3 - $1 }' >>"$1.times"
}
for _ in $(seq "${ROUNDS:-3}"); do once living && once room; done
cmp living.pfm room.pfm || stop 'the pictures differ'
for n in 1 2; do for which in living room; do median $n <"$which.times"; done; done | paste -sd ' ' |
	awk -v n="$dead" '{ printf "4 hosts: first pixels %.2f s, picture %.2f s; with %d dead ones: %.2f and %.2f s\n", $1, $3, n, $2, $4 }'
report 'first pixels later by' "$(cat living.times room.times | awk '{ if (NR <= n) a += $1; else b += $1 } END { print (b - a) / n }' n="$(wc -l <living.times)")" ' s' 3
