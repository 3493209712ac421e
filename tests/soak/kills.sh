#!/bin/sh
# kills.sh [RUNS [SEED]]: kill -9 at a random moment of a random process of a random chain, sometimes while another
# process is stopped. Both may end an inner fan, so there are three. No process remains. If only a worker dies under deal,
# the picture is the same and the exit status is 0.
. "$(dirname "$0")/../lib.sh"
runs=${1:-$(soaked 200)} seed=${2:-${FIRST:-$(date +%s)}}
# shellcheck source=../marked.sh
. "$root/tests/marked.sh"
name() { cat "/proc/$1/comm" 2>/dev/null; }
# pick N: a number below N, the next of the seed's
pick() { seed=$(((seed * 1103515245 + 12345) % 2147483648)) && picked=$((seed / 65536 % $1)); }

spdgen -s 2 gears >gears.nff
size=96x96
partition $size | rtworker -a 16 gears.nff | gather -o good.pfm
state="{ pack scene gears.nff; partition $size; } |"
first=$seed
diag "seed $seed"
run=0
while [ $((run += 1)) -le "$runs" ]; do
	mark=stormring-soak-$$-$run saved=true
	pick 7
	case $picked in
	0) chain="exec balance masterslave -j 3 -s $size -W '-a 16' -o out.pfm gears.nff" ;;
	1) chain="$state deal fan -j 2 deal fan -j 2 rtworker -a 16 - | gather -o out.pfm" ;;
	2) chain="$state deal -q 2 deal fan -j 3 rtworker -a 16 - | gather -o out.pfm" ;;
	3) chain="$state deal fan -j 3 fan -j 2 rtworker -a 16 - | gather -o out.pfm" ;;
	5) chain="exec balance gdc -j 3 -s $size -W '-a 16' -o out.pfm gears.nff" ;;
	6) chain="$state ringctl fan -j 2 ringctl -n ringctl fan -j 2 ringctl -n rtworker -a 16 - | gather -o out.pfm" ;;
	4) chain="exec balance interleaved -j 3 -s $size -W '-a 16' -o out.pfm gears.nff" saved=false ;;
	esac
	rm -f out.pfm
	env MARK="$mark" sh -c "$chain" 2>said &
	pid=$!
	pick 400
	sleep "$(printf '.%03d' $((picked + 5)))"
	# The shell that started the pipeline does not belong to it, so it is not killed.
	# shellcheck disable=SC2046  # a pid each
	set -- $(alive | grep -vx "$pid")
	[ $# -gt 0 ] || { wait "$pid"; continue; }
	pick $#
	shift "$picked"
	victim=$1 what=$(name "$1")
	pick 6
	[ "$picked" = 0 ] && for p in $(alive); do [ "$(name "$p")" = rtworker ] && kill -STOP "$p" && break; done
	kill -9 "$victim" 2>/dev/null || { wait "$pid"; continue; }
	# A stopped worker is noticed after 3 s; if the last stage is killed, no process waits for it.
	limit=20
	[ "$what" = gather ] && limit=2
	ok "run $run: $what of: $chain: no process remains" await $limit none_alive
	wait "$pid"
	status=$?
	if [ "$what" != rtworker ] || ! $saved; then continue; fi
	is "run $run: a worker of: $chain: exit 0" $status 0
	ok "run $run: a worker of: $chain: the same picture" cmp out.pfm good.pfm
done
[ "$tap_failed" = 0 ] || fail "to repeat: tests/soak/kills.sh $runs $first" ''
finish
