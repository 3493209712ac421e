# shellcheck shell=sh disable=SC2154  # protocol sets here, experiment, work and scenes
# Functions for experiments. protocol reads this file.

# of KEY <FIGURES: prints the value of KEY in the output of simulate or fragstat -s
of() { awk -F '\t' -v key="$1" '$1 == key { print $2 }'; }
# planned EXPERIMENT METHOD X SAMPLE: prints a line of the plan. Random numbers of a simulated sample depend on the seed and
# on SAMPLE. If X is measured too, it is - here, and sample prints X and Y, with a blank between.
planned() {
	drawn=0
	[ $kind != simulated ] || drawn=$((seed * 1000 + $4))
	printf '%s\t%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "$4" $drawn || exit 3
}
# For awk programs: uniform(N) is the N-th draw in [0, 1) of the seed, independent of other draws. Rounds of cubing in a
# prime field scatter similar inputs (M. Albrecht et al., "MiMC", ASIACRYPT 2016). It is not cryptographic: it has 26 bits,
# because awk's numbers are exact up to 53.
# shellcheck disable=SC2016,SC2034  # $ of awk; used by experiments
uniform='function uniform(n,  x, i) {
	x = seed
	for (i = 0; i < 12; i++) {
		x = (x + (i == 6) * n + 2718281 * i + 314159) % 67108859
		x = x * x % 67108859 * x % 67108859
	}
	return x / 67108859
}'
# workstations N: prints the powers of the first N of the GDC paper's 14 workstations, as a comma list
workstations() { echo 1,1,1,1,1,1,1,1,1,1,1,1,.442,1.347 | cut -d, -f "1-$1"; }
# loaded SEED POWERS [MEAN]: prints powers reduced by the load of other users. A run takes 1 + e times the shortest one,
# with e exponential of this mean. Without MEAN the load is that of the GDC paper's Table 1. There runs of the HP took 96 to
# 101 s, 97.86 in the mean, which gives .019. One of 50 runs of the Sparc 20 must have taken 96 s, while the others took
# about 72 s: so with a probability of 1/50 a run takes a third more.
loaded() {
	often=.02
	[ $# -lt 3 ] || often=0
	echo "$2" | awk -F, -v OFS=, -v seed="$1" -v mean="${3-.019}" -v often=$often "$uniform"'{
		for (i = 1; i <= NF; i++)
			$i = sprintf("%.6f", $i / (1 - mean * log(1 - uniform(2 * i))) / (uniform(2 * i + 1) < often ? 4 / 3 : 1))
		print
	}'
}
# shares KIND SEED SLOTS SECONDS LOAD: prints loads for simulate -L, for runs of about these seconds. Others take LOAD of the
# power in the mean, at most .495. A constant load is drawn for each slot from 0 to 2 LOAD; a drift goes between these two in
# a sine; in steps and bursts, each slot is free or has 2 LOAD less, for exponential times with means of 1/4 and 1/20.
shares() {
	awk -v kind="$1" -v seed="$2" -v slots="$3" -v s="$4" -v load="$5" "$uniform"'
		function put(share) { printf "%.6f %d %.6f\n", t, k, share < .01 ? .01 : share }
		BEGIN {
			mean = s / (kind == "steps" ? 4 : 20)
			for (k = 0; k < slots; k++) {
				t = 0; phase = uniform(++n); on = phase < .5
				if (kind == "constant") put(1 - 2 * load * phase)
				else if (kind == "drift") for (; t < 8 * s; t += s / 50) put(1 - load - load * sin(6.28319 * (t / s + phase)))
				else for (; t < 8 * s; t -= mean * log(1 - uniform(++n))) { put(on ? 1 - 2 * load : 1); on = !on }
			}
		}'
}
# once NAME COMMAND: writes the file NAME by a line of shell, unless it exists; it is kept until the table is complete
once() {
	[ -e "$1" ] || { sh -c "$2" >"$1.new.$$" </dev/null && mv "$1.new.$$" "$1"; } || fail 3 "failed: $2"
}
# costs COMMAND NAME ...: writes NAME.frags, the log of one worker, by a line of shell that uses $name. It is the shortest
# of five runs, because other load on the machine can only add time. The names take turns, because such load may last.
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
# paper_s SCENE: prints the seconds of its balanced view on the GDC paper's reference host (Tables 1 and 2)
paper_s() {
	case $1 in
	gears) echo 1091.14 ;;
	balls) echo 97.86 ;;
	tetra) echo 44.53 ;;
	esac
}
# pictured SCENE-VIEW [SECONDS]: writes SCENE-VIEW.frags, the costs of its rows on one worker, and SCENE-VIEW.scale, a
# factor by which their sum becomes SECONDS. Without SECONDS the scale is that of the balanced view.
# shellcheck disable=SC2016  # costs expands $name
pictured() {
	scene=${1%-*}
	for view in balanced imbalanced; do once "$scene-$view.nff" "spdgen -s 2 -V $view $scene"; done
	costs 'partition 512x512 | rtworker $name.nff' "$scene-balanced" "$scene-imbalanced"
	[ -z "${2-}" ] || once "$1.scale" "fragstat -s $1.frags | awk -v s=$2 '\$1 == \"cpu_s\" { print s / \$2 }'"
	[ -n "${2-}" ] || cp "$scene-balanced.scale" "$1.scale"
}
# The wind for repeating the StormView paper's measurements: wind.frags has the costs of runs of 29 rays, and wind.scale
# is the factor by which a ray costs .052072 s in the mean, as in its Table 1. vcworker skips transparent cells; StormView
# integrated all cells, so a faint haze is added everywhere. The tolerance gives the distribution of costs of that table:
# the mean of 29 rays is 1.15 times their median (there the mean of a ray is 1.145 times).
winded() {
	once wind.vtk "nc2vtk /usr/share/ncarg/data/cdf/nc4uvt.nc 'speed=hypot(U,V)'"
	once wind.spec "awk '/^map 39.75/ { print \"map 0 1 .3 .1 1e-6\" } /^map/ && \$6 == 0 { \$6 = \"1e-6\" } { print }
		/^map 40.25/ { print \"map 200 1 .3 .1 1e-6\" }' '$scenes/stormview.spec'"
	# shellcheck disable=SC2016
	costs 'partition -u run:29 261x209 | vcworker -m doubling:.003 $name.vtk $name.spec' wind
	once wind.scale "fragstat -s wind.frags | awk '\$1 == \"cpu_s\" { print 54549 * .052072 / \$2 }'"
}
# can_build NAME: checks that tests/bench/NAME.c can be built, for a plan whose samples need it
can_build() {
	[ -r "$here/../tests/bench/$1.c" ] && [ -r "$here/../build/libstormring.a" ] ||
		fail 3 "$experiment: needs a built clone of the source, expected tests/bench/$1.c and build/libstormring.a"
}
# built NAME: builds that program in this directory
built() {
	# shellcheck disable=SC2046  # a word each
	[ -x "$1" ] || { cc -std=c11 -D_GNU_SOURCE -O2 -I"$here/../lib" -o "$1.new" "$here/../tests/bench/$1.c" "$here/../build/libstormring.a" \
		$(cat "$here/../build/libs") && mv "$1.new" "$1"; } >&2 || fail 3 'failed: cc'
}
# delayed MS: prints the words that put a command behind a link of MS milliseconds, one way, over real pipes
delayed() { built delay && echo "$PWD/delay $1"; }
# Links of 10 Mbit/s in all. A pixel has 3 bytes (GDC) or 5 (StormView) there, but 16 in simulate.
# shellcheck disable=SC2034  # for experiments
ethernet_gdc='-l 1 -b 6.67e6,6.67e6' ethernet_stormview='-l 1 -b 4e6,4e6'
# tabled POWERS: writes what `fan -l` says to a method in virtual time
tabled() { echo "$1" | tr , '\n' | awk -v OFS='\t' '{ print NR - 1, "host", $1 }' >"$work/table"; }
# simulated METHOD POWERS OPTION ...: writes $work/figures for balance METHOD in virtual time, on $frame. Its cut and its rules
# are those of the shipped script; $unit, if it is set, replaces its unit. Or for published rivals, which no script runs;
# or for the best known schedule, of rows.
simulated() {
	method=$1 powers=$2 slots=$(echo "$2" | tr , '\n' | wc -l)
	shift 2
	case $method in
	guided) cut="-n $slots -u guided" run=deal ;;
	factoring) cut="-n $slots -u factoring" run=deal ;;
	weighted) cut="-w $powers -u factoring" run=deal ;;
	best) cut="-u ${unit:-row}" run=best ;;
	gdc-rows) (unit=row && simulated gdc "$powers" "$@"); return ;;
	*)
		tabled "$powers"
		quietly shipped "simulate -w $powers $*" "$method" "$frame" "$slots" /dev/null fan -j "$slots" rtworker
		return
		;;
	esac
	# shellcheck disable=SC2086
	partition $cut "$frame" | quietly simulate -w "$powers" "$@" $run
}
# scattered N: S_S. A worker sends its pixels 250 at a time, as if these were tasks that it has from the start.
scattered() {
	partition -u scatter -n "$1" "$frame" | awk -v w="${frame%x*}" '$1 != "task" { print; next }
		{ for (from = 0; from < $6; from += 250) {
			p = $4 + from * $8
			print "task 0", id++, p % w, int(p / w), ($6 - from < 250 ? $6 - from : 250), 1, $8, 1, $10 } }'
}
# stormview METHOD POWERS OPTION ...: the same as simulated, for a method by its name in the StormView paper
stormview() {
	way=$1
	shift
	case $way in
	D_S) simulated ds "$@" ;;
	D_C) simulated dc "$@" ;;
	S_C) simulated sc "$@" ;;
	S_S) scattered "$(echo "$1" | tr , '\n' | wc -l)" | quietly simulate -w "$@" fan ;;
	*) simulated "$way" "$@" ;;
	esac
}
# speed [SECONDS]: prints SECONDS (1) divided by the makespan of that run; 0 if the picture was never complete
speed() {
	awk -F '\t' -v s="${1-1}" '{ v[$1] = $2 } END { printf "%.9g\n", (v["uncommitted"] > 0 ? 0 : s / v["makespan_s"]) }' "$work/figures"
}
# quietly SIMULATE ...: writes $work/figures for any run; an incomplete picture is a result, not a failure
quietly() {
	"$@" >"$work/figures" 2>"$work/said" && return
	[ $? -eq 1 ] || { cat "$work/said" >&2; false; }
}

# processor: prints the number of the last processor that this process may use
processor() { taskset -cp $$ | sed 's/.*[-, ]//'; }
# hosts ARGUMENT ...: makes test hosts on this machine; needs root and a clone of the source
hosts() {
	[ -x "$here/../tests/hosts" ] || fail 3 "$experiment: needs a clone of the source, expected tests/hosts"
	"$here/../tests/hosts" "$@"
}
# among SECONDS N PROGRAM ARGUMENT ...: runs a shell program among N test hosts, for at most SECONDS. It ends with this
# script: a program in the foreground would delay a Ctrl-C.
among() {
	limit=$1 number=$2 code=$3
	shift 3
	timeout "$limit" "$here/../tests/hosts" with "$number" sh -c "$code" "$experiment" "$@" &
	running=$!
	trap 'kill $running' HUP INT TERM
	wait $running
}
