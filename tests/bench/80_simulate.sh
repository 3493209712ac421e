#!/bin/sh
# 80_simulate: all methods in virtual time, by the policies' own code. Costs are measured: rows of 512x512 by one
# worker, scaled to the GDC paper's times: 97.86 s for balls on the reference host, 11.15 times that for gears and .455
# times for tetra. Which host has the last long row is a matter of chance: so they are measured nine times (ROUNDS), and
# figures are medians; replays, which take longer, are of three of these. What it shows:
#
#   - efficiency (lower bound / makespan) on the paper's 14 hosts: 12 of power 1, one of .442, one of 1.347, with links
#     of 0, 0.5 and 20 ms one way; beside the best that any schedule could have there
#   - 1000 unequal hosts (from 1/3 to 3), where tasks have to be shorter than rows; messages of the ring per steal,
#     against the number of hosts; and 10,000 hosts with 1,000,000 tasks: how long that takes to simulate
#   - two dozen of the cells through real processes and pipes; for that it wants two idle cores
#
# PARTS names what is wanted of these: paper, many, big, replay. VIEWS names the views besides the normal one (spdgen
# -V). build/bench/simulate.tsv has the efficiencies, steals.tsv the messages.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
# shellcheck source=../peaks.sh
. "$root/tests/peaks.sh"
scenes=${SCENES:-gears balls tetra} views=${VIEWS-imbalanced} latencies='0 0.5 20'
parts=${PARTS:-paper many big replay} rounds=$(seq "${ROUNDS:-9}")
powers=1,1,1,1,1,1,1,1,1,1,1,1,0.442,1.347
mkdir -p "$root/build/bench" || exit 3

# head_of X Y NOTE: of a table
head_of() {
	printf '# %s\n' "x: $1" "y: $2" "note: $3" 'seed: 0' 'command: tests/bench/80_simulate.sh' \
		"commit: $(cd "$root" && git describe --always --dirty 2>/dev/null || echo none)" \
		"machine: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores"
	printf 'experiment\tkind\tmethod\tx\tx_unit\ty\ty_unit\tsample\tseed\n'
}
# of KEY: from the figures of the latest run
of() { awk -F '\t' -v key="$1" '$1 == key { print $2 }' figures; }
# at_least WHAT TARGET <LINES: their median?
at_least() {
	sort -g | awk -v w="$1" -v t="$2" '{ v[NR] = $1 }
		END { m = (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2
			printf "%s: %.4f (%.4f to %.4f), target at least %g: %s\n", w, m, v[1], v[NR], t, (m >= t ? "met" : "MISSED") }'
}

# ---- the methods: what partition is given, and simulate --------------------------------------------------------
# gdc has the tasks of balance gdc, about a quarter of a row here; gdc-rows has rows. The bound is that of pixels.
cat >methods <<END
interleaved|-n 14|fan
masterslave||deal
hybrid|-w $powers -c 400|deal -q 1
ss|-u scatter -n 14|fan
sc|-u scatter -n 14|fan
ds|-u run:250|deal
dc|-u run:250|-c deal
gdc-published|-n 14|ring -p
gdc-rows|-n 14|ring
gdc|-n 14 -u run:124|ring
best||best
END
# simulated METHOD SCENE LATENCY: efficiencies, a line a round; figures of the last, figures.ROUND of each
simulated() {
	IFS='|' read -r row cut run <<-END
		$(grep "^$1|" methods)
	END
	# shellcheck disable=SC2086
	partition $cut 512x512 >job.task
	for r in $rounds; do
		# shellcheck disable=SC2086
		simulate -t "$2.$r.frags" -x "$(cat "$2.$r.scale")" -w $powers -l "$3" $run <job.task >figures ||
			echo "$row of $2 at $3 ms: not complete" >&2
		cp figures "figures.$r"
		of efficiency
	done >efficiencies
}

# ---- costs -----------------------------------------------------------------------------------------------------
# Names are SCENE-VIEW; the paper's time is that of the normal view, and the other one costs what it costs.
partition 512x512 >rows.task
: >names
# measure NAME SECONDS: NAME.nff, in rounds; SECONDS, or those of SCENE-normal, is what it takes
measure() {
	echo "$1" >>names
	for r in $rounds; do
		# shellcheck disable=SC2154  # lib.sh sets pin
		$pin rtworker "$1.nff" <rows.task >"$1.$r.frags" && fragstat -s "$1.$r.frags" >one || stop "measuring $1 failed"
		[ -z "$2" ] || awk -v s="$2" '$1 == "cpu_s" { print s / $2 }' one >"$1.$r.scale"
		[ -n "$2" ] || cp "${1%-*}-normal.$r.scale" "$1.$r.scale"
	done
}
for scene in $scenes; do
	case $scene in balls) paper_s=97.86 ;; gears) paper_s=1091.14 ;; tetra) paper_s=44.53 ;; esac
	spdgen -s 2 $scene >$scene-normal.nff && measure $scene-normal $paper_s
	for view in $views; do
		spdgen -s 2 -V "$view" $scene >$scene-$view.nff 2>/dev/null && measure $scene-$view '' ||
			echo "$scene: spdgen has no view $view"
	done
done

# ---- the paper's hosts ---------------------------------------------------------------------------------------
paper() {
	tsv=$root/build/bench/simulate.tsv
	head_of 'one-way latency' efficiency \
		'the 14 hosts of the GDC paper, rows of 512x512 at its times; lower bound / makespan' >"$tsv"
	methods=$(cut -d'|' -f1 methods)
	printf '%-18s %6s ' scene ms
	# shellcheck disable=SC2086
	printf ' %13s' $methods
	echo '  any schedule'
	while read -r name; do for ms in $latencies; do
		printf '%-18s %6s ' "$name" "$ms"
		for method in $methods; do
			simulated "$method" "$name" "$ms"
			printf ' %13.4f' "$(median 1 <efficiencies)"
			awk -v e="$name" -v m="$method" -v x="$ms" <efficiencies >>"$tsv" \
				'{ printf "%s\tsimulated\t%s\t%s\tms\t%s\t1\t%d\t0\n", e, m, x, $1, NR }'
			cp efficiencies "$name.$ms.$method"
		done
		printf '  %12.4f\n' "$(echo "$(of bound_s) $(of least_s)" | awk '{ print $1 / $2 }')"
	done; done <names
	while read -r name; do
		for method in gdc gdc-rows; do
			at_least "$name, $method at 0.5 ms" .97 <"$name.0.5.$method"
			paste "$name.20.$method" "$name.20.best" | awk '{ print $1 / $2 }' |
				at_least "$name, $method at 20 ms, of the best" .95
		done
	done <names
	# What differs by its transfer alone is the same here.
	awk -F '\t' '$3 != "best" && $3 != "gdc-rows" && $3 != "sc" && $3 != "dc"' "$tsv" |
		chart -t 'The methods on the 14 hosts of the GDC paper' -o "$root/build/bench/methods.svg" || exit 3
	echo 'made build/bench/methods.svg of build/bench/simulate.tsv'
}

# ---- many hosts ----------------------------------------------------------------------------------------------
many() {
	echo '1000 hosts, 0.5 ms, gears by runs of 2 pixels:'
	partition -u run:2 512x512 >runs.task
	grep -qx gears-normal names || { spdgen -s 2 gears >gears-normal.nff && measure gears-normal 1091.14; }
	for method in ring deal 'deal -q auto'; do
		for r in $rounds; do
			# shellcheck disable=SC2086
			simulate -t gears-normal.$r.frags -x "$(cat gears-normal.$r.scale)" -s $r -j 1000,3 -l .5 $method \
				<runs.task >figures
			of efficiency
		done >efficiencies
		echo "  $method: efficiency $(median 1 <efficiencies), $(of makespan_s) s"
		[ "$method" != ring ] || cp efficiencies ring.1000
	done
	at_least 'gdc on 1000 hosts' .90 <ring.1000
	echo
	echo 'messages per steal, 20 tasks of 100 ms on average a host, powers from 1/3 to 3, 0.5 ms:'
	tsv=$root/build/bench/steals.tsv
	head_of hosts 'messages per steal' \
		'20 tasks a host, of unequal costs, hosts of unequal powers, links of 0.5 ms' >"$tsv"
	printf '%7s %12s %12s %14s %12s\n' hosts gdc efficiency gdc-published efficiency
	for hosts in 10 30 100 300 1000 3000; do
		partition -u run:1 "${hosts}x20" >many.task
		printf '%7d' $hosts
		for method in ring 'ring -p'; do
			# shellcheck disable=SC2086
			simulate -j $hosts,3 -l .5 -m 100000,4 $method <many.task >figures || echo "$method: not complete" >&2
			printf ' %12.2f %12.4f' "$(of messages_per_steal)" "$(of efficiency)"
			name=gdc
			[ "$method" = ring ] || name='gdc as published'
			printf 'ring\tsimulated\t%s\t%s\t1\t%s\t1\t1\t0\n' "$name" $hosts "$(of messages_per_steal)" >>"$tsv"
		done
		echo
	done
}

# ---- the most hosts ------------------------------------------------------------------------------------------
# simulated_big METHOD WxH: 10,000 hosts, and tasks of a pixel
simulated_big() {
	partition -u run:1 "$2" >big.task
	measured "simulate -j 10000,3 -l .5 -m 100000,4 $1 <big.task >figures; times >times"
	tail -n 1 times | awk '{ split($1, u, /[ms]/); split($2, s, /[ms]/); print 60 * (u[1] + s[1]) + u[2] + s[2] }' >took
	echo "$1, 10,000 hosts, $(of tasks) tasks: $(cat took) s of CPU, $(of events) events, $(most simulate kib) KiB," \
		"efficiency $(of efficiency)"
}
big() {
	simulated_big deal 1000x1000
	simulated_big ring 1000x1000
	report '10,000 hosts, 1,000,000 tasks' "$(cat took)" ' s' 60
}

# ---- through real processes ----------------------------------------------------------------------------------
# Each run shall take some seconds; links are as much shorter.
shrink_of() { case $1 in gears*) echo 20 ;; balls*) echo 2 ;; *) echo 1 ;; esac }
# Efficiency, but for start-up, of figures on standard input
but_start() {
	awk -F '\t' '{ v[$1] = $2 } END { print v["efficiency"] / (1 - v["startup_s"] / (v["slots"] * v["makespan_s"])) }'
}
# hosts_at MS: the paper's, behind links of so many milliseconds
hosts_at() {
	link=''
	[ "$1" = 0 ] || link="$tmp/delay $1 "
	cat <<-END
		plain slots=12 power=1 via="${link}sh -c %c"
		slow  power=0.442 via="${link}env REPLAY_POWER=0.442 sh -c %c"
		fast  power=1.347 via="${link}env REPLAY_POWER=1.347 sh -c %c"
	END
}
# replayed METHOD SCENE ROUND
replayed() {
	rm -f run.frags run.png
	x=$(awk -v s="$(shrink_of "$2")" '{ print $1 / s }' "$2.$3.scale")
	pack scene "$2.nff" | "balance-$1" 512x512 14 /dev/null fan -S hosts replay -x "$x" "$2.$3.frags" |
		gather -r run.frags -o run.png || stop "failed: $1 of $2"
	fragstat -s -S hosts run.frags | but_start
}
# compare METHOD SCENE MS: a line
compare() {
	shrink=$(shrink_of "$2")
	hosts_at "$(echo "$3 $shrink" | awk '{ print $1 / $2 }')" >hosts
	for r in $rounds; do replayed "$1" "$2" "$r" || exit 3; done >replays
	simulated "$1" "$2" "$(echo "$3 $shrink" | awk '{ print $1 + .1 * $2 }')"
	for r in $rounds; do but_start <"figures.$r"; done >simulations
	printf '%-16s %-12s %5s %10.4f %9.4f ' "$2" "$1" "$3" "$(median 1 <simulations)" "$(median 1 <replays)"
	echo "$(median 1 <simulations) $(median 1 <replays)" |
		awk '{ d = 100 * ($2 / $1 - 1); printf "%6.1f %%%s\n", d, (d * d <= 25 ? "" : " MISSED") }'
}
replay_cells() {
	rounds=$(echo "$rounds" | head -n 3)
	cc -std=c11 -D_GNU_SOURCE -O2 -I"$root/lib" -o delay "$root/tests/bench/delay.c" "$root/build/libstormring.a" ||
		stop 'delay does not compile'
	echo 'by replay, at 1/20 (gears), 1/2 (balls) of the times and latencies, but for start-up; a link is simulated as'
	echo '0.1 ms longer than it is made'
	printf '%-16s %-12s %5s %10s %9s %8s\n' scene method ms simulated replayed apart
	for ms in 0 20; do for method in interleaved masterslave hybrid gdc; do
		while read -r name; do compare $method "$name" $ms </dev/null; done <names
	done; done
}

for part in $parts; do
	case $part in
	paper) paper ;;
	many) many ;;
	big) big ;;
	replay) replay_cells ;;
	*) stop "$part: expected paper, many, big or replay" ;;
	esac
	echo
done
