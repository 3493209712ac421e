#!/bin/sh
# 40_latency: time from command to picture for a scene with almost nothing to render; median of 9.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=9
command='balance masterslave -s 16x16 -o x.png tetra.nff'

spdgen tetra >tetra.nff || stop 'spdgen failed'
i=0
while [ $i -lt $rounds ]; do
	rm -f x.png
	wall_s "$command" >>taken || stop "failed: $command"
	[ -s x.png ] || stop 'no picture'
	i=$((i + 1))
done
echo 'smallest ms  median ms  largest ms'
sort -g taken | awk '{ v[NR] = 1000 * $1 } END { printf "%11.1f %10.1f %11.1f\n", v[1], v[int((NR + 1) / 2)], v[NR] }'
echo "$command"
report 'from command to picture' "$(median 1 <taken | awk '{ print 1000 * $1 }')" ' ms' 150
