#!/bin/sh
# 15_embree: our ray tracing kernels against those of Embree (Debian's 3), on one core. The same shading code asks both
# for the same rays, depth 5, one sample a pixel. Columns: time to trace a picture and to build the hierarchy, medians
# of 9 in turns; for Embree the fastest of single rays, packets of 16, and packets of 16 marked as coherent; and the
# difference of the pictures, because Embree computes in float while we decide hits in double. Embree has no cones, so
# scenes with cones are left out.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
built embree_bench -lembree3
for scene in balls gears tetra; do spdgen $scene >$scene.nff || stop "no $scene"; done
cp "$root/scenes/marbles.nff" "$root/scenes/polygons.nff" . || exit 3
printf '%-9s %-26s %9s %9s %9s %8s\n' scene kernels 'build ms' 'trace ms' RMSE 'far off'
for scene in balls gears tetra marbles polygons; do
	# shellcheck disable=SC2154  # lib.sh sets pin
	$pin ./embree_bench 9 512x512 $scene.nff >$scene.times || stop "failed: $scene"
	awk -F '\t' -v s=$scene '{ printf "%-9s %-26s %9.2f %9.2f %9s %8d\n", s, $1, $2, $3, $4, $5 }' $scene.times
done
for scene in balls gears tetra marbles polygons; do
	awk -F '\t' 'NR == 1 { ours = $3; next } !least || $3 < least { least = $3 } END { print ours / least }' $scene.times >ratio
	report "$scene, time by that of Embree's fastest" "$(cat ratio)" '' 1
done
