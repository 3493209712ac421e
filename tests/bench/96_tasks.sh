#!/bin/sh
# 96_tasks: D_S on all cores with real workers, against the pixels in a task. It separates the overhead of tasks from
# the uneven end: time in tasks, time between tasks, and idle time at the end, after start-up. StormView's input has the
# size and the view of its paper; the pictures of make demo-volume have 18 times as many pixels.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=${ROUNDS:-5} sizes=${SIZES:-'63 125 250 500 1000 2000 4000 8000 16000'} slots=$("$root/tests/processors")
data=/usr/share/ncarg/data/cdf/nc4uvt.nc
nc2vtk -c -o wind.vtk $data 'speed=hypot(U,V)' || stop 'no grid'
# frame SPEC: prints its WxH
frame() { vcworker -i wind.vtk "$1" | awk '$1 == "frame" { print $2 "x" $3 }'; }
# once SPEC PIXELS DEPTH: prints slots, tasks, s on tasks, waiting, tail, s from first to last task
once() {
	rm -f log
	{ pack grid wind.vtk; pack spec "$1"; partition -u "run:$2" "$(frame "$1")"; } |
		deal -q "$3" fan -j "$slots" vcworker | gather -r log -o out.pfm || return
	fragstat -s log | awk '{ v[$1] = $2 } END { n = v["slots"]; s = v["busy_s"] + v["waiting_s"] + v["tail_s"]
		print n, v["tasks"], v["busy_s"], v["waiting_s"], v["tail_s"], s / n }'
}
for look in ${LOOKS:-stormview wind-smooth wind-surfaces}; do
	spec=$root/scenes/$look.spec
	round=0
	while [ $((round += 1)) -le "$rounds" ]; do
		for size in $sizes; do for depth in 0 1 auto; do
			once "$spec" "$size" $depth >>"$look.$size.$depth" || stop "$look $size $depth failed"
		done; done
	done
	echo "$look, $(frame "$spec"), $slots slots; medians of $rounds; from the first task to the last"
	echo "  pixels  depth   tasks  task_us  waiting_us_a_task  tail_ms  span_ms  busy_%"
	for depth in 0 1 auto; do for size in $sizes; do
		file=$look.$size.$depth
		echo "$size $depth $(for c in 1 2 3 4 5 6; do median $c <"$file"; done | tr '\n' ' ')" | awk '{
			printf "  %6d  %5s  %6d  %7.1f  %17.1f  %7.2f  %7.1f  %6.1f\n", $1, $2, $4, $5 / $4 * 1e6, $6 / $4 * 1e6,
				$7 / $3 * 1e3, $8 * 1e3, 100 * $5 / ($3 * $8) }'
	done; done
done
