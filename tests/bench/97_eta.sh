#!/bin/sh
# The estimate of the time left: gears, RUNS=5 times by balance adaptive on SLOTS=2 slots. Prints what gather -P said after
# 10, 25 and 50 % of each run, and what was left then. The last column is the error in percent of the time left.
. "$(dirname "$0")/lib.sh"
spdgen gears >gears.nff
echo 'run	share	left_s	eta_s	error_percent'
run=0
while [ $((run += 1)) -le "${RUNS:-5}" ]; do
	# Each update of the line with the time at which it came.
	balance adaptive -P -j "${SLOTS:-2}" -s "${SIZE:-2048x2048}" -W "${OPTIONS:--a 25}" -o gears.png gears.nff 2>&1 |
		perl -MTime::HiRes=time -e '$| = 1; $/ = "\r"; $begin = time;
			while (<STDIN>) { printf "%.3f %s\n", time - $begin, $1 eq "?" ? "?" : eval { $s = 0; $s = 60 * $s + $_ for split /:/, $1; $s } if /ETA ([0-9:?]+)/ }
			printf "%.3f end\n", time - $begin' >said
	awk -v run=$run '
	$2 == "end" { end = $1 }
	{ t[NR] = $1; eta[NR] = $2 }
	END {
		n = split(".1 .25 .5", share, " ")
		for (k = 1; k <= n; k++) {
			for (i = 1; i < NR && t[i] < share[k] * end; i++);
			left = end - t[i]
			printf "%d\t%g\t%.1f\t%s\t%s\n", run, share[k], left, eta[i], eta[i] == "?" ? "?" : sprintf("%.0f", 100 * (eta[i] / left - 1))
		}
	}' said
done
