#!/bin/sh
# 30_overhead: the cost of a task besides its pixels: CPU time of all processes for 10,000 tasks of one pixel through
# deal and fan, less the time of the same picture by rows; medians of 7 differences.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=7 size=100x100 tasks=10000

spdgen tetra >tetra.nff || stop 'spdgen failed'
by() { echo "{ pack scene tetra.nff; partition -u $1 $size; } | deal fan -j 2 rtworker - | gather -o $2.png"; }
measure() { # FILE: a line of "all, pixels, rows" each round
	i=0
	while [ $i -lt $rounds ]; do
		pixels_s=$(cpu_s 2 "$(by run:1 pixels)") || stop 'the pipeline failed'
		rows_s=$(cpu_s 10 "$(by row rows)") || stop 'the pipeline failed'
		cmp pixels.png rows.png || stop 'the two pictures differ'
		echo "$pixels_s $rows_s" | awk -v n=$tasks '{ printf "%.2f %.6f %.6f\n", ($1 - $2) / n * 1e6, $1, $2 }' >>"$1"
		i=$((i + 1))
	done
}
measure pinned
# shellcheck disable=SC2034  # cpu_s takes it
pin=''
measure free

echo '                 by pixels s  by rows s  us a task'
for where in free pinned; do
	case $where in free) name='on all cores' ;; pinned) name='on one core' ;; esac
	printf '%-16s %11.3f %10.3f %10.1f\n' "$name" "$(median 2 <$where)" "$(median 3 <$where)" "$(median 1 <$where)"
done
by run:1 pixels
by row rows
report 'CPU time of a task' "$(median 1 <free)" ' us' 40
