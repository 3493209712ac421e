#!/bin/sh
# 14_build: reading a large scene and building its hierarchy, against Embree's builds at medium and at high quality of
# the same triangles, spheres and cones, on one core; the reader is the same. Columns: CPU time to read and to build,
# medians of RUNS (default 5) in turns; the largest resident set, and its bytes for each item. Then the build's time and
# the largest set by Embree's at medium quality.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
built build_bench -lembree3
runs=${RUNS:-5}
printf '%-10s %8s  %-6s %8s %8s %8s %8s\n' scene items kind 'read ms' 'build ms' MB 'B/item'
for scene in gears:9 tetra:9 balls:6 mount:9 lattice:30; do
	name=$(echo $scene | tr -d :)
	spdgen -s "${scene#*:}" "${scene%:*}" >scene.nff || stop "no $name"
	rm -f ours medium high
	for _ in $(seq "$runs"); do
		for kind in ours medium high; do
			# shellcheck disable=SC2154  # lib.sh sets pin
			$pin ./build_bench $kind scene.nff >>$kind || stop "failed: $kind $name"
		done
	done
	for kind in ours medium high; do
		printf '%-10s %8d  %-6s %8.1f %8.1f %8.0f %8.0f\n' "$name" "$(median 4 <$kind)" $kind "$(median 1 <$kind)" \
			"$(median 2 <$kind)" "$(median 3 <$kind)" "$(median 5 <$kind)"
	done
	for column in 1 2 3; do echo "$(median $column <ours) $(median $column <medium)"; done |
		awk -v s="$name" '{ a[NR] = $1; b[NR] = $2 } END { print s, a[2] / b[2], (a[1] + a[2]) / (b[1] + b[2]), a[3] / b[3] }' >>ratios
done
while read -r name build both memory; do
	report "$name, build by Embree's" "$build" '' 1
	report "$name, read and build by Embree's" "$both" '' 1
	report "$name, resident set by Embree's" "$memory" '' 1
done <ratios
