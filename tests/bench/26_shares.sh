#!/bin/sh
# 26_shares: the CPU time of each program in a run of gears 9 by balance adaptive with one slot, by samples of perf(1) over
# RUNS runs (default 3), in percent of all; and the least ratio of the time on two slots to that on one, on two cores.
# With one slot the other programs already run on the second core beside rtworker. So if two slots kept both cores busy all
# the time, the ratio would be half of all CPU time by that of rtworker and half of rtworker -i, which reads in threads.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
command -v perf >/dev/null || stop 'perf is not there, expected the Debian package linux-perf'
spdgen -s "${SIZE:-9}" gears >gears.nff || stop 'spdgen failed'
i=0
while [ $((i += 1)) -le "${RUNS:-3}" ]; do
	perf record -q -e task-clock -F 2000 -o samples balance adaptive -j 1 -o a.png gears.nff || stop 'perf or balance failed'
	perf script -i samples -F comm,pid | awk -v run=$i 'NF { print run "-" $2, $1 }' >>sampled
done
# Of the two processes named rtworker, the one with less time is rtworker -i.
awk '{ n[$1 " " $2]++ } END { for (p in n) print n[p], p }' sampled | sort -g |
	awk '{ split($2, id, "-") } $3 == "rtworker" && !seen[id[1]]++ { $3 = "rtworker-i" } { print $3, $1 }' |
	awk '{ n[$1] += $2; all += $2 } END {
		for (p in n) if (n[p] >= all / 100) printf "%-12s %5.1f\n", p, 100 * n[p] / all
		printf "least ratio, two slots / one: %.2f\n", all / 2 / (n["rtworker"] + n["rtworker-i"] / 2)
	}' | sort -k 2,2gr
