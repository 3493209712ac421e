#!/bin/sh
# 90_volume: pictures of a wind field of 121x97x18 nodes, 500x500, at the default tolerance, against VTK's
# vtkFixedPointVolumeRayCastMapper with one thread on the field resampled to 121x97x64 (it takes no uneven grid), at
# several distances between samples. CPU time, pinned, ours and VTK's in turns; errors are RMS against the converged
# picture of the field that each was given. Ours includes preparing the grid for the map.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=3 vtk=/usr/bin/python3
# Beyond the last of these VTK's error falls no more, or its time is beyond use.
distances() { case $1 in smooth) echo 1 0.5 ;; *) echo 0.25 0.05 0.02 ;; esac; }
# The one that ours is held against: the fastest near VTK's least error.
against() { case $1 in smooth) echo 1 ;; *) echo 0.05 ;; esac; }

cc -std=c11 -D_GNU_SOURCE -O2 -I"$root/lib" -o volume_bench "$root/tests/bench/volume_bench.c" \
	"$root/build/libstormring.a" -lpng -lz -lm || stop 'volume_bench does not compile'
size=$(./volume_bench field field.raw) || stop 'no field'
for map in smooth contour; do
	./volume_bench map $map >$map.map
	i=0
	while [ $i -lt $rounds ]; do
		# shellcheck disable=SC2154  # lib.sh sets pin
		$pin ./volume_bench time $map >>$map.ours || stop 'volume_bench failed'
		for distance in $(distances $map); do
			us=$($pin $vtk "$root/tests/bench/volume_vtk.py" field.raw "$size" $map.map $distance out.raw) || stop 'VTK failed'
			echo "$us $(./volume_bench error $map out.raw)" >>"$map.$distance"
		done
		i=$((i + 1))
	done
	awk -v m=$map -v t="$(median 1 <$map.ours)" 'NR == 1 { printf "%s: ours %.0f ms, RMS error %s; %.0f ns a ray, %.0f a cell, %.0f a sample; grid, picture and all %d KiB\n", m, t / 1e3, $2, t * 1e3 / $3, t * 1e3 / $5, t * 1e3 / $6, $7 }' $map.ours
	for distance in $(distances $map); do
		us=$(median 1 <"$map.$distance") e=$(median 2 <"$map.$distance")
		echo "$us $e $(median 1 <$map.ours) $(median 2 <$map.ours)" | awk -v d=$distance '{ printf "    VTK, samples every %s: %.0f ms, RMS error %s; ours takes %.2f of its time at %.2g of its error\n", d, $1 / 1e3, $2, $3 / $1, $4 / $2 }'
	done
done
for map in smooth contour; do
	distance=$(against $map)
	report "$map, time by VTK's" "$(echo "$(median 1 <$map.ours) $(median 1 <"$map.$distance")" | awk '{ print $1 / $2 }')" '' 1
	report "$map, error by VTK's" "$(echo "$(median 2 <$map.ours) $(median 2 <"$map.$distance")" | awk '{ print $1 / $2 }')" '' 0.1
done
