# Functions for measurements. Begin with `. "$(dirname "$0")/lib.sh"`: it changes to a temporary directory $tmp, which
# every exit removes, and puts the programs of this clone first on PATH. A timing is a line of numbers; statistics are
# of columns of lines. Interleave the alternatives: A B A B, so that both meet the same noise.
# shellcheck shell=sh disable=SC2034
LC_ALL=C && export LC_ALL # numbers have a point, in any language
set -u
root=$(cd "$(dirname "$0")/../.." && pwd) && tmp=$(mktemp -d) || exit 3
trap 'rm -rf "$tmp"' EXIT
trap 'exit 130' HUP INT TERM
PATH=$root/bin:$PATH
cd "$tmp" || exit 3
# Pins to the last core, if taskset exists and is allowed.
core=$(($(nproc) - 1))
pin="taskset -c $core"
$pin true 2>/dev/null || pin=''

# The GDC paper's workstations: 14 powers, and a hosts file of them on this machine, for replay
workstations=1,1,1,1,1,1,1,1,1,1,1,1,.442,1.347
workstation_hosts() {
	cat <<-'END'
		:     slots=12 power=1
		slow  power=0.442 via="env REPLAY_POWER=0.442 sh -c %c"
		fast  power=1.347 via="env REPLAY_POWER=1.347 sh -c %c"
	END
}
stop() { echo "${0##*/}: $*" >&2; exit 3; }
# built NAME [-lLIBRARY ...]: compiles tests/bench/NAME.c to a program in this directory
built() {
	[ ! -x "$1" ] || return 0
	name=$1
	shift
	# shellcheck disable=SC2046  # a word each
	cc -std=c11 -D_GNU_SOURCE -O2 -ffp-contract=off -I"$root/lib" -o "$name" "$root/tests/bench/$name.c" \
		"$root/build/libstormring.a" "$@" $(cat "$root/build/libs") || stop "$name does not compile"
}
# cpu_s TIMES COMMAND: prints the CPU seconds of one COMMAND, a line of shell, with all processes that it waits for
cpu_s() {
	built cpu
	# shellcheck disable=SC2016  # the inner shell counts
	$pin ./cpu "n=$1; "'while [ $n -gt 0 ]; do '"{ $2; }"' || exit; n=$((n - 1)); done >/dev/null' </dev/null >.cpu ||
		return
	awk -v n="$1" '{ printf "%.6f\n", $1 / n }' .cpu
}
# wall_s COMMAND: prints its elapsed seconds
wall_s() {
	begin=$(date +%s.%N)
	sh -c "$1" >/dev/null || return
	end=$(date +%s.%N)
	echo "$begin $end" | awk '{ printf "%.6f\n", $2 - $1 }'
}
# times_for SECONDS COMMAND: prints the number of runs of COMMAND that take SECONDS of CPU time
times_for() { cpu_s 1 "$2" | awk -v t="$1" '{ print int(t / $1) + 1 }'; }
# median COLUMN <LINES: prints the median of a column
median() { awk -v c="$1" '{ print $c }' | sort -g | awk '{ v[NR] = $1 } END { printf "%.6g\n", (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2 }'; }
# report WHAT GOT UNIT TARGET: prints a line with the verdict: GOT is at most TARGET, or not
report() { awk -v w="$1" -v g="$2" -v u="$3" -v t="$4" 'BEGIN { printf "%s: %.3g%s, target at most %g%s: %s\n", w, g, u, t, u, g <= t ? "met" : "MISSED" }'; }
