#!/bin/sh
# 16_profile: what the ray tracer's time is spent on, by samples of perf(1), on one core, 512x512, depth 5, one sample a
# pixel. Each sampled address counts for the innermost inlined function whose file has a row below.
#
#     16_profile.sh [-n RUNS] [-t TABLE] [SCENE ...]
#
# A SCENE is a name of spdgen, with a size (balls6) or its own by default; by default all of spdgen. Columns, in percent of
# the time to read, build and trace: traversal of the hierarchy, tests of primitives, shading (hit points, light, new
# rays), bookkeeping (samples, waves of rays, pending rays), build, read, system and C library.
#
# -t: TABLE is the output of 15_embree.sh. It adds, from the trace alone: ratio, our time / Embree's; kernels, the same
# without shading and bookkeeping, which both programs share; free, the ratio if our kernels took no time; faster, how many
# times as fast our kernels must be for a ratio of .85, or 1 for scenes with a size; - if no kernel is fast enough.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
runs=3 table=/dev/null
while getopts n:t: o; do
	case $o in
	n) runs=$OPTARG ;;
	t) table=$(cd "$OLDPWD" && readlink -e -- "$OPTARG") || stop "-t $OPTARG: no such file" ;;
	*) stop 'expected [-n RUNS] [-t TABLE] [SCENE ...]' ;;
	esac
done
shift $((OPTIND - 1))
command -v perf >/dev/null || stop 'perf is not there, expected the Debian package linux-perf'
# shellcheck disable=SC2046  # a word each
cc -std=c11 -D_GNU_SOURCE -O2 -g -no-pie -ffp-contract=off -I"$root/lib" -o trace_bench "$root/tests/bench/trace_bench.c" \
	"$root/build/libstormring.a" $(cat "$root/build/libs") || stop 'trace_bench does not compile'
# Files of lib/, or a module for the rest of its files.
cat >rows <<'END'
traversal trace/kernel.h trace/packet.h trace/trace_sse2.c trace/trace_avx2.c trace/trace_avx512.c
tests trace/*.h
shading trace/light.c trace/shade_impl.h trace/math.c trace/onward.c trace/bound.c
bookkeeping trace/wave.c trace/pending.c trace/pending.h trace/pixel.c trace/tracer.c trace/around.c
build trace/bins.h trace/*.c
read scene/*.c scene/*.h base/number.c
END
# shellcheck disable=SC2046  # words
[ $# -gt 0 ] || set -- $(spdgen -l | awk '!/^#/ { print $1 }')
for s; do
	case $s in
	*[0-9]) spdgen -s "${s##*[a-z]}" "${s%%[0-9]*}" >scene.nff || stop "no $s" ;;
	*) spdgen "$s" >scene.nff || stop "no $s" ;;
	esac
	# shellcheck disable=SC2154,SC2086  # lib.sh sets pin; words
	$pin perf record -q -e task-clock -F 4000 -o samples ./trace_bench -s 512x512 -n "$runs" scene.nff >/dev/null 2>said ||
		stop "perf: $(tail -n 1 said)"
	perf script -i samples -F ip,sym 2>said | awk 'NF { print $1 }' >addresses
	sort -u addresses | addr2line -a -f -i -e trace_bench >places
	[ -s head ] || printf '%-9s %9s %6s %8s %12s %6s %6s %7s %8s %7s %6s %6s\n' scene traversal tests shading bookkeeping \
		build read system ratio kernels free faster | tee head
	awk -v scene="$s" '
		FILENAME == "rows" { for (i = 2; i <= NF; i++) row[$i] = $1; next }
		FILENAME == "places" && /^0x/ { at = $1; sub(/^0x0*/, "", at); named = 0; next }
		FILENAME == "places" && !named { fn = $1; named = 1; next }
		FILENAME == "places" {
			named = 0
			sub(/:.*/, ""); sub(/.*\/lib\//, "")
			rest = $1
			sub(/\/.*\./, "/*.", rest)
			if (!(at in of) && fn == "normal") of[at] = "shading"
			if (!(at in of) && $1 in row) of[at] = row[$1]
			if (!(at in of) && rest in row) of[at] = row[rest]
			next
		}
		FILENAME == "addresses" { sub(/^0*/, ""); n[($1 in of) ? of[$1] : "system"]++; all++; next }
		$1 == scene { ratio = $7 }
		END {
			printf "%-9s %9.1f %6.1f %8.1f %12.1f %6.1f %6.1f %7.1f", scene, 100 * n["traversal"] / all, 100 * n["tests"] / all,
				100 * n["shading"] / all, 100 * n["bookkeeping"] / all, 100 * n["build"] / all, 100 * n["read"] / all,
				100 * n["system"] / all
			ours = n["traversal"] + n["tests"]
			other = n["shading"] + n["bookkeeping"]
			if (!ratio || !ours) { print ""; exit }
			rest = other / (ours + other) # of our trace, and of Embree the same time
			left = (scene ~ /[0-9]$/ ? 1 : .85) / ratio - rest
			printf " %8.2f %7.2f %6.2f %6s\n", ratio, (1 - rest) / (1 / ratio - rest), rest * ratio,
				(left > 0 ? sprintf("%.2f", (1 - rest) / left) : "-")
		}' rows places addresses "$table"
done
