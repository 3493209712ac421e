#!/bin/sh
# 71_peers_ssh [SIDE]: the same picture of SPD's gears, SIDE x SIDE pixels (default 1536), on three test hosts
# (tests/README) that have only the programs, by `balance -S` and by GNU parallel, which copies the scene there by
# rsync. Medians of 3 interleaved runs; then a worker is killed half way; then a host's cable is out from half way on.
# The hosts share the cores of this machine, so the methods are compared and not the speed on more machines.
hosts=$(cd "$(dirname "$0")/.." && pwd)/hosts
why=$("$hosts" check 2>&1) || { echo "71_peers_ssh: no test hosts: $why"; exit 0; }
[ -n "${TEST_HOSTS-}" ] || exec "$hosts" with 3 "$0" "$@"
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=3 side=${1:-1536} most_s=60

cat >balance.sh <<'END'
balance masterslave -S $TEST_HOSTS/hosts -s ${S}x$S -o out.pfm gears.nff
END
cat >parallel.sh <<'END'
partition -u tile:${S}x$((S / 12)) ${S}x$S |
	parallel -S 1/host1,1/host2,1/host3 --basefile gears.nff --pipe -N 1 --header '^frame.*\n' \
		--retries 3 /home/render/bin/rtworker gears.nff | gather -o out.pfm
END
peers=balance
if command -v parallel >/dev/null && command -v rsync >/dev/null; then peers="$peers parallel"
else echo 'parallel: not installed, or no rsync'
fi
spdgen gears >gears.nff || stop 'spdgen failed'
partition "${side}x$side" | rtworker gears.nff | gather -o good.pfm || stop 'rtworker failed'

run() { S=$side PARALLEL=--will-cite timeout "$2" sh "$1.sh" >said 2>&1; } # NAME SECONDS: at most
kill_worker() {
	# shellcheck disable=SC2046  # a process each
	kill -9 $("$hosts" pids host2 rtworker)
}
cable_out() { "$hosts" link host2 down; }
# struck NAME BLOW: "EXIT PICTURE SECONDS" of a run that meets BLOW half way
struck() {
	rm -f out.pfm
	begin=$(date +%s.%N)
	run "$1" $most_s &
	pid=$!
	sleep "$(median 1 <"$1.s" | awk '{ print $1 / 2 }')"
	$2 2>/dev/null
	wait $pid
	status=$?
	[ $status != 124 ] || status="none in $most_s s"
	if cmp -s out.pfm good.pfm; then picture=same; else picture=none; fi
	echo "$status | $picture | $(echo "$begin $(date +%s.%N)" | awk '{ printf "%.1f", $2 - $1 }')"
	"$hosts" link host2 up
}

i=0
while [ $i -lt $rounds ]; do
	for p in $peers; do
		rm -f out.pfm
		begin=$(date +%s.%N)
		run "$p" 300 || { tail -n 5 said >&2; stop "$p failed"; }
		echo "$begin $(date +%s.%N)" | awk '{ print $2 - $1 }' >>"$p.s"
		cmp out.pfm good.pfm || stop "$p: another picture"
	done
	i=$((i + 1))
done
echo "gears, ${side}x$side, medians of $rounds runs on three hosts of one slot, which share $("$root/tests/processors") cores:"
echo
echo '| by | lines | s | a worker killed: exit | picture | s | a cable out: exit | picture | s |'
echo '| --- | ---: | ---: | --- | --- | ---: | --- | --- | ---: |'
for p in $peers; do
	printf '| %s | %d | %.2f | %s | %s |\n' "$p" "$(wc -l <"$p.sh")" "$(median 1 <"$p.s")" \
		"$(struck "$p" kill_worker)" "$(struck "$p" cable_out)"
done
echo
for p in $peers; do
	echo "$p:"
	sed 's/^/    /' "$p.sh"
done
