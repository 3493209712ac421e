#!/bin/sh
# 93_maps: twelve pictures of twelve months against the same over maps (balance -m), in turns: with coasts in a file, and with
# those of coastlines. Wall time, and CPU time of all processes. SIZES="1200x800" measures other sizes, WHAT=wind the small grid
# of make demo-volume, twelve times.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
what=${WHAT:-ocean}
if [ "$what" = ocean ]; then
	nc2vtk -z -t all -o g%02d.vtk /usr/share/ferret-vis/data/ocean_atlas_subset.nc TEMP || stop 'nc2vtk failed'
	gridspec g00.vtk | grep -v '^background' >look.spec
else
	nc2vtk -c -o wind /usr/share/ncarg/data/cdf/nc4uvt.nc 'speed=hypot(U,V)' || stop 'nc2vtk failed'
	for i in 00 01 02 03 04 05 06 07 08 09 10 11; do sed "2s/; t .*/; t time $i [hours since 2026-11-23]/" wind >g$i.vtk; done
	cp "$root/scenes/wind-smooth.spec" look.spec
fi
coastlines >coasts || stop 'coastlines failed'
built cpu
pin='' # on all cores
# both NAME COMMAND: appends wall seconds and CPU seconds to NAME
both() {
	begin=$(date +%s.%N)
	./cpu "$2" >.cpu || stop "$2 failed"
	end=$(date +%s.%N)
	echo "$begin $end $(cat .cpu)" | awk '{ print $2 - $1, $3 }' >>"$1"
}
echo 'size	pictures_s	maps_s	ratio	coastlines_ratio	pictures_cpu_s	maps_cpu_s	cpu_ratio	coastlines_cpu_ratio'
for size in ${SIZES:-600x400 1200x800}; do
	rm -f plain maps coastlines
	round=0
	while [ $((round += 1)) -le "${ROUNDS:-5}" ]; do
		both plain "balance adaptive -s $size -o p%02d.png g??.vtk look.spec"
		both maps "balance adaptive -s $size -m coasts -o p%02d.png g??.vtk look.spec"
		both coastlines "balance adaptive -s $size -m coasts: -o p%02d.png g??.vtk look.spec"
	done
	paste plain maps coastlines | awk '{ print $0, $3 / $1, $5 / $1, $4 / $2, $6 / $2 }' >all
	for column in 1 3 7 8 2 4 9 10; do median $column <all; done | paste -s - | awk -v size="$size" '{
		printf "%s", size; for (i = 1; i <= NF; i++) printf "\t%.2f", $i; print "" }'
done
