#!/bin/sh
# 36_tree: what deals within deals reach in virtual time, on up to 100,000 hosts: efficiency, records and bytes that pass
# the first hub, its tasks, and the slots of a hub. A hub takes US (5) microseconds for a record (35_hub.sh). HOSTS is a
# list of counts, TASK_S one of mean seconds of a task; each host has 20 tasks, unequal by up to 16 times.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
echo '  hosts  task s  hubs  slots of one  efficiency  records/s     MB/s   tasks of the first'
for hosts in ${HOSTS:-1000 10000 100000}; do
	side=$((hosts > 10000 ? 10000 : hosts))
	partition -u run:1 "${side}x$((20 * hosts / side))" >tasks || stop 'partition failed'
	for task in ${TASK_S:-.1 1 10}; do
		groups_of=$(echo "$hosts" | awk '{ print int(sqrt($1)) }')
		for groups in '' "-g $groups_of"; do
			# shellcheck disable=SC2086
			simulate -u "${US:-5}" $groups -j "$hosts,3" -l .5 -m "$(echo "$task" | awk '{ print $1 * 1e6 }'),4" deal <tasks >figures ||
				stop "simulate failed: $hosts hosts, $groups"
			awk -F '\t' -v hosts="$hosts" -v task="$task" '{ v[$1] = $2 }
				END { printf "%7d %7s %5d %13d %11.3f %10.0f %8.2f %20d\n", hosts, task, v["hubs"], v["hub_slots"], v["efficiency"],
					v["hub_records_per_s"], v["hub_bytes_per_s"] / 1e6, v["hub_tasks"] }' figures
		done
	done
done

# Real fans: REAL hosts played by processes of this machine, whose workers replay a log: flat, in
# racks, and once more when the hosts have kept the state of MB megabytes. Each prints the time until
# the last host, or rack, is up, the bytes that its fan has written, and its memory.
real=${REAL-200}
[ "$real" -gt 0 ] || exit 0
export XDG_CACHE_HOME="$tmp/cache"
mkdir cache
spdgen -s 1 tetra >tetra.nff && partition 8x8 | rtworker tetra.nff >frags || stop 'no log'
for k in $(seq "$real"); do
	mkdir "cache/$k" && echo "h$k via=\"env XDG_CACHE_HOME=$tmp/cache/$k sh -c %c\""
done >hosts
state=$((${MB:-4} << 20))
head -c "$state" /dev/urandom >state
kept() { cat cache/*/stormring/state/[0-9a-f]* 2>/dev/null | wc -c; }
# reached NAME ROWS OPTION ...: one run
reached() {
	name=$1 rows=$2
	shift 2
	mkfifo in out
	begin=$(date +%s.%N)
	fan -S hosts "$@" replay frags <in >out 2>said &
	pid=$!
	exec 8>in 9<out
	rm in out
	pack scene state >&8
	grep -a -m "$rows" '^up w=' <&9 >ups
	end=$(date +%s.%N)
	cat <&9 >/dev/null 8>&- &
	reader=$!
	until [ "$(kept)" -ge $((real * state)) ]; do sleep .2; done
	sleep 1
	kib=$(sed -n 's/^VmHWM:[[:space:]]*\([0-9]*\) kB/\1/p' "/proc/$pid/status")
	bytes=$(awk '$1 == "wchar:" { print $2 }' "/proc/$pid/io")
	exec 8>&- 9<&-
	wait "$pid" "$reader"
	echo "$begin $end" | awk -v name="$name" -v hosts="$real" -v bytes="$bytes" -v kib="$kib" '{
		printf "%s: %d hosts: last up after %.2f s, %.1f MB, %d KiB\n", name, hosts, $2 - $1, bytes / 1e6, kib }'
}
rack=$(awk -v n="$real" 'BEGIN { for (k = int(sqrt(n)); k * k < n; k++); print k }')
racks=$(fan -l -T "$rack" -S hosts | wc -l)
reached 'one fan' "$real"
reached 'one fan, kept' "$real"
rm -rf cache/*/*
reached "racks of $rack" "$racks" -T "$rack"
reached "racks of $rack, kept" "$racks" -T "$rack"
