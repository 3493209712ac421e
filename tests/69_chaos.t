#!/bin/sh
# Hosts join, leave, die and are cut off in an order that a seed sets, while tasks come: each picture is whole and the same,
# and no process remains. RUNS=100 FIRST=SEED tests/69_chaos.t is a campaign; a failure names its seed.
#
# The workers only wait (replay), so that a run costs little time of processors. A change comes after each chunk of tasks.
. "$(dirname "$0")/lib.sh"
# shellcheck source=tests/marked.sh
. "$root/tests/marked.sh"

# shellcheck disable=SC2154  # lib.sh sets them
spdgen -s 2 tetra >tetra.nff
partition 64x64 >job.task
rtworker tetra.nff <job.task >true.frags
gather -o good.pfm true.frags
scale=$(grep -a '^done' true.frags | sed 's/.*wall_us=\([0-9]*\).*/\1/' | awk '{ s += $1 } END { printf "%.0f", 150e3 * NR / (s + 1) }')

# relay HOST COMMAND: links/ has the relays to all hosts
cat >relay <<END
#!/bin/sh
[ ! -e "cut.\$1" ] || exit 255
exec '$root/tests/relay' "links/\$1.\$\$" "\$2"
END
chmod +x relay
# pick N: a number below N, the next of the seed's
pick() { random=$(((random * 1103515245 + 12345) % 2147483648)) && picked=$((random / 65536 % $1)); }
# write NAME=SLOTS ...: replaces the hosts file; the host `safe` is always there
write() {
	echo 'safe via="./relay safe %c"' >hosts.new
	for host; do echo "${host%=*} slots=${host#*=} via=\"./relay ${host%=*} %c\"" >>hosts.new; done
	mv hosts.new hosts
}
# signal NAME HOST: sends it to all cat of the host's links
signal() { cat links/"$2".*/pids 2>/dev/null | while read -r p; do kill -"$1" "$p"; done 2>/dev/null; }
# change: what happens next; $hosts are the lines of the file
change() {
	before=$hosts
	pick 8
	what=$picked
	pick 4
	set -- a b c d
	shift "$picked"
	case $what in
	0 | 1 | 2) # a host joins, or has another number of slots
		pick 3
		hosts="$(for h in $hosts; do [ "${h%=*}" = "$1" ] || printf '%s ' "$h"; done)$1=$((picked + 1))"
		;;
	3 | 4) # a host leaves
		hosts=$(for h in $hosts; do [ "${h%=*}" = "$1" ] || printf '%s ' "$h"; done)
		;;
	5) # its cable is out
		: >"cut.$1"
		signal STOP "$1"
		;;
	6) # all cables are in again
		rm -f cut.*
		for h in a b c d; do signal CONT $h; done
		;;
	7) # a worker is killed
		for p in $(program replay | head -1); do kill -9 "$p"; done ;;
	esac
	echo "# change $what of $1: $hosts" >>changes
	hosts=$(for h in $hosts; do echo "$h"; done | sort | tr '\n' ' ')
	[ "$hosts" != "$before" ] || return 0
	# shellcheck disable=SC2086
	write $hosts
	written=$((written + 1))
	await 30 taken $written || echo "the file is not taken" >>status
}
# The new versions of the file so far that fan has taken.
taken() { [ "$(grep -c 'slots join the run' said)" -ge "$1" ]; }
# The tasks so far that were done, however often.
all_done() { [ "$(grep -a '^done ' events | cut -d ' ' -f 3 | sort -un | wc -l)" -ge "$1" ]; }
# run_seed SEED: one run in a directory of its own
run_seed() {
	mkdir "run$1" && cd "run$1" || exit 3
	random=$1 mark=$mark-$1 hosts='' written=0
	cp ../relay . && mkdir links && : >events && write
	pick 5
	deal=$(echo '-q 0,-q 1,-q 3,-q auto,-q auto -e' | cut -d , -f $((picked + 1)))
	pick 3
	fan=$(echo ',-1,' | cut -d , -f $((picked + 1)))
	pick 3
	worker="replay -x $scale $([ "$picked" -gt 0 ] || echo -c) ../true.frags"
	: >status
	{
		sed -n 1p ../job.task
		await 30 test -s events # fan has read the first hosts file
		at=2
		while [ $at -le 65 ]; do
			sed -n "$at,$((at + 7))p" ../job.task
			change
			at=$((at + 8))
			[ $at -gt 65 ] || await 30 all_done $((at - 6)) || echo "stuck at $at" >>status
		done
	} | MARK=$mark sh -c "deal $deal sh -c 'fan -t 1 $fan -S hosts $worker | tee events' 2>said; echo \$? >>status" | gather -o out.pfm 2>>said
	for h in a b c d; do signal CONT $h; done
	await 30 none_alive || echo 'processes remain' >>status
	end_all
	[ "$(cat status)" = 0 ] && cmp out.pfm ../good.pfm && return
	sed 's/^/# /' status said changes
	echo "# deal $deal, fan $fan, $worker"
	return 1
}
first=${FIRST:-1} runs=${RUNS:-6}
# Some at a time: they mostly wait.
seed=$first
while [ "$seed" -lt $((first + runs)) ]; do
	n=0
	while [ $((n += 1)) -le 6 ] && [ "$seed" -lt $((first + runs)) ]; do
		{ (run_seed "$seed") >"$seed.out" 2>&1; echo $? >"$seed.status"; } &
		seed=$((seed + 1))
	done
	wait
done
seed=$first
while [ "$seed" -lt $((first + runs)) ]; do
	if [ "$(cat "$seed.status")" = 0 ]; then pass "seed $seed: the same picture, and no process remains"
	else fail "seed $seed: the same picture, and no process remains" "$(cat "$seed.out") to repeat: RUNS=1 FIRST=$seed tests/69_chaos.t"
	fi
	seed=$((seed + 1))
done
is 'slots joined, left and were lost' "$(cat run*/events | grep -a -o '^drain \|why=left\|^gone .*why=[es]' | sed 's/ .*//' | sort -u | tr '\n' ' ')" 'drain gone why=left '
finish
