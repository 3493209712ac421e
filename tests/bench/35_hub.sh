#!/bin/sh
# 35_hub: where one hub ends, a deal around a fan: CPU time and instructions for a record, and for a byte of pixels;
# memory and descriptors for a slot and for a task. Records are the task, its done and its pixels. SLOTS and TASKS are
# lists of counts; COUNT=1 counts instructions by valgrind, which does not depend on other load.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
# shellcheck source=../peaks.sh
. "$root/tests/peaks.sh"
spdgen tetra >tetra.nff || stop 'spdgen failed'
# through SLOTS WxH UNIT [COMMAND]: the tasks of one frame through the hub; COMMAND runs fan or deal
through() { echo "{ pack scene tetra.nff; partition -u $3 $2; } | ${5-} deal ${4-} fan -j $1 rtworker - >/dev/null"; }

echo 'slots   tasks  deal us  fan us  records/s    deal KiB   fan KiB  fan descriptors'
for slots in ${SLOTS:-2 64 1024}; do
	for tasks in ${TASKS:-20000 200000}; do
		measured "$(through "$slots" "$((tasks / 100))x100" run:1)"
		# shellcheck disable=SC2154  # peaks.sh sets it
		[ "$status" = 0 ] || stop "$slots slots failed"
		echo "$slots $tasks $(most deal ms) $(most fan ms) $(most deal kib) $(most fan kib) $(most fan open)"
	done
done >all
awk '{ d = $3 * 1e3 / $2 / 3; f = $4 * 1e3 / $2 / 3; m = (d > f ? d : f)
	printf "%5d %7d %8.2f %7.2f %10.0f %11d %9d %16d\n", $1, $2, d, f, (m > 0 ? 1e6 / m : 0), $5, $6, $7 }' all
# Pixels: one task of a row, of 16 bytes for each pixel.
measured "$(through 2 4096x4096 row)"
echo "$(most deal ms) $(most fan ms)" | awk '{ b = 4096 * 4096 * 16; m = ($1 > $2 ? $1 : $2)
	printf "pixels: deal %.2f ns, fan %.2f ns a byte: %.0f MB/s\n", $1 * 1e6 / b, $2 * 1e6 / b, b / m / 1e3 }'
[ "${COUNT-}" = 1 ] || exit 0

# counted SLOTS WxH UNIT: prints the instructions of deal, and of fan
counted() {
	sh -c "$(through "$1" "$2" "$3" '' "valgrind --tool=callgrind --callgrind-out-file=/dev/null --log-file=deal.log")" || return
	sh -c "$(through "$1" "$2" "$3" 'valgrind --tool=callgrind --callgrind-out-file=/dev/null --log-file=fan.log')" || return
	echo "$(sed -n 's/.*Collected : //p' deal.log) $(sed -n 's/.*Collected : //p' fan.log)"
}
# Differences of two runs are without start and end.
for slots in ${SLOTS:-2 64 1024}; do
	{ less=$(counted "$slots" 100x100 run:1) && more=$(counted "$slots" 300x100 run:1); } || stop 'valgrind failed'
	echo "$slots $less $more" | awk '{ n = 3 * 20000
		printf "%d slots: instructions of a record: deal %.0f, fan %.0f\n", $1, ($4 - $2) / n, ($5 - $3) / n }'
done
{ less=$(counted 2 64x100 row) && more=$(counted 2 4096x100 row); } || stop 'valgrind failed'
echo "$less $more" | awk '{ n = 4032 * 100 * 16
	printf "instructions of a byte of pixels: deal %.2f, fan %.2f\n", ($3 - $1) / n, ($4 - $2) / n }'
