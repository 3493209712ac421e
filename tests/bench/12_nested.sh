#!/bin/sh
# 12_nested: nested glass of equal index with Ks > 0: every shell adds a reflected ray to every ray. 40 shells, 32x32
# pixels, two transmittances. rtworker with every ray (-w 0), with its default error budget and with larger ones, against
# POV-Ray with its default adc_bailout (1/255: each ray below that share ends). CPU seconds of the whole run; beside them the
# RMSE from the picture with every ray.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
size=32x32
for t in .7 .9; do
	{
		echo 'b .2 .3 .5 v from 0 0 5 at 0 0 0 up 0 1 0 angle 30 hither .01 resolution 32 32 l 3 4 5'
		echo "f 1 .9 .8 .05 .1 20 $t 1.5"
		seq 40 | awk '{ print "s 0 0 0", $1 / 40 }'
		echo 'f .5 .5 .5 1 0 0 0 0 p 4 -9 -9 -2 9 -9 -2 9 9 -2 -9 9 -2'
	} >shells.nff
	nff2pov shells.nff | sed 's/adc_bailout 0//' >shells.pov || stop 'nff2pov failed'
	partition $size | rtworker -w 0 shells.nff | gather -o every.pfm || stop 'rtworker failed'
	for w in 0 2^-17 .001 .03 .3; do
		bound=$(awk "BEGIN { printf \"%.17g\", $w }")
		ours="partition $size | rtworker -w $bound shells.nff"
		seconds=$(cpu_s 1 "$ours >frags") || stop "failed: $ours"
		gather -o ours.pfm <frags || stop 'gather failed'
		printf 'T %s  rtworker -w %-6s %8.3f s  RMSE %s\n' $t $w "$seconds" \
			"$(imgcmp every.pfm ours.pfm | awk '$1 == "rmse" { print $2 }')"
	done
	pov="povray -V +WT1 +Ishells.pov +Opov.ppm +W32 +H32 +FP16 File_Gamma=1 -A -D"
	seconds=$(cpu_s 1 "$pov 2>&1") || stop "failed: $pov"
	printf 'T %s  POV-Ray            %8.3f s  RMSE %s\n' $t "$seconds" "$(imgcmp every.pfm pov.ppm | awk '$1 == "rmse" { print $2 }')"
done
