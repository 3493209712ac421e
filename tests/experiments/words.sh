# shellcheck shell=sh disable=SC2154  # protocol sets here, experiment, work and scenes
# The commands that experiments are written with. protocol reads this file.

# of KEY <FIGURES: as simulate and fragstat -s print them
of() { awk -F '\t' -v key="$1" '$1 == key { print $2 }'; }
# planned EXPERIMENT METHOD X SAMPLE: a line of the plan; what is random about it goes by the seed and the sample. X is -
# where it is measured as well: sample then says X and Y, with a blank between.
planned() {
	drawn=0
	[ $kind != simulated ] || drawn=$((seed * 1000 + $4))
	printf '%s\t%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "$4" $drawn || exit 3
}
# For programs of awk: uniform(N), the N-th draw in [0, 1) of the seed, which depends on no other draw. Rounds of cubing in a
# prime field, which scatter what differs little (M. Albrecht et al., "MiMC", ASIACRYPT 2016); not for adversaries: 26 bits,
# as numbers of awk are exact up to 53.
# shellcheck shell=sh disable=SC2016,SC2034  # of awk, for experiments
uniform='function uniform(n,  x, i) {
	x = seed
	for (i = 0; i < 12; i++) {
		x = (x + (i == 6) * n + 2718281 * i + 314159) % 67108859
		x = x * x % 67108859 * x % 67108859
	}
	return x / 67108859
}'
# workstations N: the powers of the first N of the 14 workstations of the GDC paper, with commas between
workstations() { echo 1,1,1,1,1,1,1,1,1,1,1,1,.442,1.347 | cut -d, -f "1-$1"; }
# loaded SEED POWERS [MEAN]: powers as other users leave them: a run takes 1 + e of the shortest, e exponential with that
# mean. Without one all goes by the GDC paper's own Table 1: runs of the HP took 96 to 101 s, 97.86 in the mean, which makes
# .019; and one of 50 runs of the Sparc 20 must have taken 96 s where the others took some 72: so with a chance of 1/50 it
# takes a third more.
loaded() {
	often=.02
	[ $# -lt 3 ] || often=0
	echo "$2" | awk -F, -v OFS=, -v seed="$1" -v mean="${3-.019}" -v often=$often "$uniform"'{
		for (i = 1; i <= NF; i++)
			$i = sprintf("%.6f", $i / (1 - mean * log(1 - uniform(2 * i))) / (uniform(2 * i + 1) < often ? 4 / 3 : 1))
		print
	}'
}
# once NAME COMMAND: runs the line of shell unless the file NAME is there, which it writes; kept until the table is whole
once() {
	[ -e "$1" ] || { sh -c "$2" >"$1.new.$$" </dev/null && mv "$1.new.$$" "$1"; } || fail 3 "failed: $2"
}
# costs COMMAND NAME ...: NAME.frags, which the line of shell writes of each $name, the log of one worker: of five runs the one
# that took least, as what else a machine does only adds to it. They take turns, as that may last.
costs() {
	command=$1
	shift
	for name; do
		shift
		[ -e "$name.frags" ] || set -- "$@" "$name"
	done
	for attempt in 1 2 3 4 5; do for name; do once "$name.$attempt" "name=$name; $command"; done; done
	for name; do
		for attempt in 1 2 3 4 5; do echo "$(fragstat -s "$name.$attempt" | of cpu_s) $name.$attempt"; done >"$work/costs"
		mv "$(sort -g "$work/costs" | sed -n '1s/.* //p')" "$name.frags" || fail 3 "$name.frags: cannot be written"
		rm -f "$name".[1-5]
	done
}
# paper_s SCENE: the seconds that its balanced view takes on the GDC paper's reference host (Tables 1 and 2)
paper_s() {
	case $1 in
	gears) echo 1091.14 ;;
	balls) echo 97.86 ;;
	tetra) echo 44.53 ;;
	esac
}
# pictured SCENE-VIEW SECONDS: SCENE-VIEW.frags, the costs of its rows by one worker, whose sum makes SECONDS when they are
# multiplied by what SCENE-VIEW.scale says; without SECONDS the scale is that of the balanced view
# shellcheck shell=sh disable=SC2016  # $name is costs' affair
pictured() {
	scene=${1%-*}
	for view in balanced imbalanced; do once "$scene-$view.nff" "spdgen -s 2 -V $view $scene"; done
	costs 'partition 512x512 | rtworker $name.nff' "$scene-balanced" "$scene-imbalanced"
	[ -z "${2-}" ] || once "$1.scale" "fragstat -s $1.frags | awk -v s=$2 '\$1 == \"cpu_s\" { print s / \$2 }'"
	[ -n "${2-}" ] || cp "$scene-balanced.scale" "$1.scale"
}
# The wind that the StormView paper's measurements are repeated with: wind.frags, the costs of 29 rays at a time, and
# wind.scale, by which a ray costs .052072 s in the mean, as in its Table 1. Here cells in which nothing is seen are
# skipped; there all were integrated, so a faint haze lies everywhere. The tolerance gives costs that are distributed as
# in that table: 29 rays cost 1.15 times their median in the mean (a ray there 1.145 times).
winded() {
	once wind.vtk "nc2vtk /usr/share/ncarg/data/cdf/nc4uvt.nc 'speed=hypot(U,V)'"
	once wind.spec "awk '/^map 39.75/ { print \"map 0 1 .3 .1 1e-6\" } /^map/ && \$6 == 0 { \$6 = \"1e-6\" } { print }
		/^map 40.25/ { print \"map 200 1 .3 .1 1e-6\" }' '$scenes/stormview.spec'"
	# shellcheck disable=SC2016
	costs 'partition -u run:29 261x209 | vcworker -m doubling:.003 $name.vtk $name.spec' wind
	once wind.scale "fragstat -s wind.frags | awk '\$1 == \"cpu_s\" { print 54549 * .052072 / \$2 }'"
}
# can_build NAME: for a plan of which samples need tests/bench/NAME.c
can_build() {
	[ -r "$here/../tests/bench/$1.c" ] && [ -r "$here/../build/libstormring.a" ] ||
		fail 3 "$experiment: is for a clone of the source that is built, where there are tests/bench/$1.c and build/libstormring.a"
}
# built NAME: makes that program, here
built() {
	[ -x "$1" ] || { cc -std=c11 -D_GNU_SOURCE -O2 -I"$here/../lib" -o "$1.new" "$here/../tests/bench/$1.c" "$here/../build/libstormring.a" \
		-lpng -lz -lm && mv "$1.new" "$1"; } >&2 || fail 3 'failed: cc'
}
# delayed MS: the words that make a command one behind a link of so many ms, one way, over real pipes
delayed() { built delay && echo "$PWD/delay $1"; }
# Links at 10 Mbit/s in all, in which a pixel is 3 bytes (GDC) or 5 (StormView), and 16 in simulate.
# shellcheck shell=sh disable=SC2034  # for experiments
ethernet_gdc='-l 1 -b 6.67e6,6.67e6' ethernet_stormview='-l 1 -b 4e6,4e6'
# simulated METHOD POWERS OPTION ...: leaves $work/figures of balance METHOD in virtual time, or of the best schedule
# that is known, of $frame cut into $unit or as that method does
simulated() {
	method=$1 powers=$2 slots=$(echo "$2" | tr , '\n' | wc -l)
	shift 2
	case $method in
	interleaved) cut="-n $slots -u ${unit:-row}" run=fan ;;
	masterslave) cut="-u ${unit:-row}" run=deal ;;
	adaptive) cut="-u ${unit:-row}" run='deal -q auto -e' ;;
	ds) cut="-n $slots -c 0 -u ${unit:-coarse:250}" run=deal ;;
	hybrid) cut="-w $powers -c 400/512 -u ${unit:-row}" run='deal -q 1' ;;
	gdc) cut="-n $slots -u ${unit:-fine}" run=ring ;;
	gdc-rows) cut="-n $slots -u ${unit:-row}" run=ring ;;
	gdc-published) cut="-n $slots -u ${unit:-row}" run='ring -p' ;;
	best) cut="-u ${unit:-row}" run=best ;;
	esac
	# shellcheck disable=SC2086
	partition $cut "$frame" | quietly simulate -w "$powers" "$@" $run
}
# speed [SECONDS]: of that run: so many, or one, by the makespan; 0 for a picture that is never complete
speed() {
	awk -F '\t' -v s="${1-1}" '{ v[$1] = $2 } END { printf "%.9g\n", (v["uncommitted"] > 0 ? 0 : s / v["makespan_s"]) }' "$work/figures"
}
# quietly SIMULATE ...: the same of any run; one in which not every pixel comes is a result
quietly() {
	"$@" >"$work/figures" 2>"$work/said" && return
	[ $? -eq 1 ] || { cat "$work/said" >&2; false; }
}

# processor: the last one that this may use
processor() { taskset -cp $$ | sed 's/.*[-, ]//'; }
# hosts ARGUMENT ...: test hosts of this machine, which are for root, in a clone
hosts() {
	[ -x "$here/../tests/hosts" ] || fail 3 "$experiment: is for a clone of the source, where there are tests/hosts"
	"$here/../tests/hosts" "$@"
}
# among SECONDS N PROGRAM ARGUMENT ...: runs a program of the shell among N test hosts, for so long at most, and no longer than
# this: a program that is waited for in the foreground would hold back a Ctrl-C
among() {
	limit=$1 number=$2 code=$3
	shift 3
	timeout "$limit" "$here/../tests/hosts" with "$number" sh -c "$code" "$experiment" "$@" &
	running=$!
	trap 'kill $running' HUP INT TERM
	wait $running
}
