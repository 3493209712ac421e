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
