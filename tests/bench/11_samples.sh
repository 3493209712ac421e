#!/bin/sh
# 11_samples: the error of the samples of a pixel, and the time that an equal error takes, beside another version: OLD is the
# directory of its programs. Four scenes of SPD, and two fine patterns that seem to meet far away: stripes, and squares in rows.
# RMSE is from 1024 samples a pixel, by this version. The ratio is our CPU time for the error of the other version with 16
# samples / its time, from our times and errors with the numbers of samples next to it, by logarithms. SIZE=128x128 SCENES=...
#
#     OLD=DIRECTORY tests/bench/11_samples.sh
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
size=${SIZE:-128x128} scenes=${SCENES:-balls gears mount tree stripes squares}
old=${OLD:?"expected OLD=DIRECTORY with the programs of another version"}
[ -x "$old/rtworker" ] || stop "$old/rtworker: expected a program"
# pattern COLUMNS: white strips of width 1/8, a quarter apart, from z 0 to -64; with COLUMNS above 1 cut into pieces
pattern() {
	echo 'b 0 0 0 v from 0 1 2 at 0 .4 0 up 0 1 0 angle 50 hither .01 resolution 128 128 l 0 90 0 f 1 1 1 1 0 0 0 0'
	awk -v n="$1" 'BEGIN { for (x = -60; x < 60; x++) for (i = 0; i < n; i++) {
		d = 64 / n; z = -i * d; e = n > 1 ? z - d / 2 : z - d
		printf "p 4 %g 0 %g %g 0 %g %g 0 %g %g 0 %g\n", x / 4, z, x / 4 + .125, z, x / 4 + .125, e, x / 4, e } }'
}
# of PROGRAMS SAMPLES: CPU seconds and RMSE
of() {
	seconds=$(cpu_s 1 "$1/partition $size | $1/rtworker -a $2 scene.nff >frags") || stop "$1/rtworker failed"
	"$1/gather" -o picture.pfm <frags || stop "$1/gather failed"
	echo "$2 $seconds $(imgcmp finest.pfm picture.pfm | awk '$1 == "rmse" { print $2 }')"
}
printf '%-8s %8s %9s %10s %9s %10s\n' scene samples s RMSE 's, old' 'RMSE, old'
for scene in $scenes; do
	case $scene in
	stripes) pattern 1 ;;
	squares) pattern 64 ;;
	*) spdgen "$scene" ;;
	esac >scene.nff || stop "no scene $scene"
	partition "$size" | rtworker -a 1024 scene.nff | gather -o finest.pfm || stop 'rtworker failed'
	rm -f ours theirs
	for n in 4 9 16 25 36 64; do
		of "$root/bin" $n >>ours && of "$old" $n >>theirs || exit
	done
	paste -d ' ' ours theirs | awk -v s="$scene" '{ printf "%-8s %8d %9.3f %10.5f %9.3f %10.5f\n", s, $1, $2, $3, $5, $6 }'
	awk 'FNR == NR { if ($1 == 16) { t = $2; e = log($3) } next }
		{ x[FNR] = log($3); y[FNR] = log($2) }
		END {
			for (i = 2; i < FNR && x[i] > e; i++);
			printf "%.4f\n", exp(y[i - 1] + (y[i] - y[i - 1]) * (e - x[i - 1]) / (x[i] - x[i - 1])) / t
		}' theirs ours | tee -a ratios | sed "s/^/$scene: time for an equal error /"
done
report 'geometric mean' "$(awk '{ s += log($1) } END { print exp(s / NR) }' ratios)" '' .6
