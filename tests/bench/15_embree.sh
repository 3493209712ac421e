#!/bin/sh
# 15_embree: our ray tracing kernels against those of Embree (Debian's 3), on one core. The same shading code asks both
# for the same rays, depth 5, one sample a pixel, 512x512. Embree has single rays, packets of 8 and 16, streams, packets
# and streams marked as coherent, each over a hierarchy of medium and of high quality, with FTZ and DAZ on. Every way
# traces each scene once; the two fastest then take turns with ours. NFF's cones are Embree's open cones.
#
#     15_embree.sh [-l] [-e EMBREE_ISA] [-n PAIRS] [-x ISA] [SCENE ...]
#
# A SCENE is a name of spdgen, with a size (balls6) or its own by default, or a file *.nff. By default all of spdgen; -l
# adds the six large ones, which take a minute more and some GB. -e avx2 keeps Embree from AVX-512. Columns: CPU ms to read the
# scene, and to build and to trace for ours and for the fastest way of Embree; our trace time / Embree's; our build time
# / Embree's; the peak of memory of a process that builds and traces with the one or the other, in MiB; RMSE of the
# pictures and the number of pixels that differ by more than 1/255, because Embree computes in float while we decide hits
# in double; and the way that was fastest.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
large='balls6 gears9 lattice30 mount9 tetra9 tetra11'
more='' options=''
while getopts e:ln:x: o; do
	case $o in
	l) more=$large ;;
	e | n | x) options="$options -$o $OPTARG" ;;
	*) stop 'expected [-l] [-e EMBREE_ISA] [-n PAIRS] [-x ISA] [SCENE ...]' ;;
	esac
done
shift $((OPTIND - 1))
built embree_bench -lembree3
# shellcheck disable=SC2046,SC2086  # words
[ $# -gt 0 ] || set -- $(spdgen -l | awk '!/^#/ { print $1 }') $more
for s; do
	case $s in
	/*.nff) name=$(basename "$s" .nff) && cp "$s" "$name.nff" || exit 3 ;;
	*.nff) name=$(basename "$s" .nff) && cp "$OLDPWD/$s" "$name.nff" || exit 3 ;;
	*[0-9]) name=$s && spdgen -s "${s##*[a-z]}" "${s%%[0-9]*}" >"$s.nff" || stop "no $s" ;;
	*) name=$s && spdgen "$s" >"$s.nff" || stop "no $s" ;;
	esac
	# shellcheck disable=SC2154,SC2086  # lib.sh sets pin; words
	$pin ./embree_bench $options "$name.nff" >ways.tsv || stop "failed: $name"
	# shellcheck disable=SC2086
	$pin ./embree_bench $options -m ours "$name.nff" >ours.tsv || stop "failed: $name"
	# shellcheck disable=SC2086
	$pin ./embree_bench $options -m embree "$name.nff" >embree.tsv || stop "failed: $name"
	[ -s table ] || printf '%-9s %8s %8s %8s %8s %8s %6s %6s %7s %7s %8s %6s  %s\n' scene read build trace E.build \
		E.trace ratio r.build MiB E.MiB RMSE far 'fastest way of Embree' | tee table
	cat ways.tsv ours.tsv embree.tsv | awk -F '\t' -v s="$name" '
		$1 == "read" { read = $2; next }
		$1 == "ours" { build = $4; trace = $5; next }
		NF == 3 { mib[++n] = $3; next }
		$3 > 1 && (!least || $5 < least) { least = $5; way = $1 ", " $2; b = $4; ratio = $6; rmse = $7; far = $8 }
		END {
			printf "%-9s %8.2f %8.2f %8.2f %8.2f %8.2f %6.3f %6.2f %7.1f %7.1f %8s %6d  %s\n", s, read, build, trace, b,
				least, ratio, build / (b > .01 ? b : .01), mib[1], mib[2], rmse, far, way
		}' | tee -a table
	[ ! "${ALL:-}" ] || cat ways.tsv # ALL=1: every way
	rm -f "$name.nff"
done
awk 'NR > 1 { sum += log($7); if ($7 > most) most = $7; n++ } END { printf "%.4g %.4g\n", exp(sum / n), most }' table >mean
report 'trace time by that of the fastest way of Embree, geometric mean' "$(cut -d ' ' -f 1 mean)" '' 0.6
report 'the same, worst scene' "$(cut -d ' ' -f 2 mean)" '' 0.85
