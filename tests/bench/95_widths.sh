#!/bin/sh
# 95_widths: where each integrator of volumes breaks. The contour of the tests' wind, of one optical depth for each value of
# the field, is made narrower and narrower; a method holds while its RMS error, of all channels of the picture, stays
# under 1/255. Errors are against marching in long double (accuracy_bench.c).
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
widths=${WIDTHS:-'20 10 5 2 1 0.5 0.2 0.1 0.05 0.02 0.01'}
methods='trapezoid:1 trapezoid:4 trapezoid:16 trapezoid:64 trapezoid:256 doubling:0.001 doubling:0.00001 gauss:1 gauss:2
	gauss:3 gauss:5 adaptive adaptive:0.00001'
cc -std=c11 -D_GNU_SOURCE -O2 -I"$root/lib" -o accuracy_bench "$root/tests/bench/accuracy_bench.c" \
	"$root/build/libstormring.a" -lpng -lz -lm || stop 'accuracy_bench does not compile'
for width in $widths; do
	# shellcheck disable=SC2086  # a word each
	./accuracy_bench error "$width" $methods >errors || stop "failed: $width m/s"
	sed "s/^/$width /" errors >>all
done
# table COLUMN NAME
table() {
	echo "$2 error, by the contour's width in m/s"
	awk -v column="$1" '
		!($1 in width) { width[$1] = 1; order[++n] = $1 }
		!($2 in method) { method[$2] = 1; name[++m] = $2 }
		{ e[$2, $1] = $column; if (!($2 in broken)) { if ($3 <= 1 / 255) until[$2] = $1; else broken[$2] = 1 } }
		END {
			printf "  %-16s", "method"
			for (i = 1; i <= n; i++) printf " %8s", order[i]
			print "   holds until"
			for (j = 1; j <= m; j++) {
				printf "  %-16s", name[j]
				for (i = 1; i <= n; i++) printf " %8.1e", e[name[j], order[i]]
				print "   " (name[j] in until ? until[name[j]] (name[j] in broken ? "" : " and less") : "-")
			}
		}' all
}
table 3 RMS
table 4 greatest
