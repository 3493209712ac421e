#!/bin/sh
# 60_replay: the GDC paper's 14 hosts on this machine, through the real deal, fan, pipes and gather: 12 of power 1, one
# of .442 and one of 1.347, rows of 512x512 at 1/20 of the paper's times (97.86 s for balls on the reference host, 11.15
# times that for gears, .455 times for tetra). Efficiency is lower bound / makespan with default settings; all slots
# start at 0. 14 start-ups share two cores here, and messages do not shrink with the costs: at 1/20 of the time both
# weigh 20 times as much (SHRINK=2 sets 1/2; METHODS names the methods). It needs two idle
# cores and some minutes. `protocol agreement` measures how exact a replay is.
#
# Then the makespan of real runs beside the simulated one, on 14, 50 and 200 slots (SLOTS) with builds of 0, .4 and 1 s in
# the mean (BUILDS), which differ between slots: simulate -p draws and states them, and replay -b takes them. All slots are up
# before the first task; the makespan is from the first task that is sent to the last one that is done. SCENES= leaves the
# first table out.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
here=$root/bin temporary=$tmp
# shellcheck source=../../bin/virtual.sh
. "$root/bin/virtual.sh"
scenes=${SCENES-gears balls tetra} slots=${SLOTS-14 50 200} builds=${BUILDS-0 .4 1}
rounds=${ROUNDS:-5} shrink=${SHRINK:-20} methods=${METHODS:-interleaved masterslave hybrid ss sc ds dc adaptive}

workstation_hosts >hosts
for scene in balls gears tetra; do
	spdgen -s 2 $scene >$scene.nff && partition 512x512 | rtworker $scene.nff >$scene.frags || stop 'rtworker failed'
	case $scene in balls) paper_s=97.86 ;; gears) paper_s=1091.14 ;; tetra) paper_s=44.53 ;; esac
	fragstat -s $scene.frags | awk -v s="$paper_s" -v n="$shrink" '$1 == "cpu_s" { print s / n / $2 }' >$scene.scale
done
once() { # SCENE METHOD: adds a line to SCENE.METHOD: efficiency, and efficiency without start-up
	rm -f "$1.$2.frags" run.pfm
	pack scene "$1.nff" |
		"balance-$2" 512x512 14 /dev/null fan -S hosts replay -x "$(cat "$1.scale")" "$1.frags" |
		gather -r "$1.$2.frags" -o run.pfm || stop "failed: $2 of $1"
	fragstat -s -S hosts "$1.$2.frags" | awk -F '\t' '{ v[$1] = $2 } END {
		print v["efficiency"], v["efficiency"] / (1 - v["startup_s"] / (v["slots"] * v["makespan_s"])) }' >>"$1.$2"
}
for _ in $(seq "$rounds"); do
	for scene in $scenes; do for method in $methods; do once "$scene" "$method"; done; done
done
[ -z "$scenes" ] || echo "scene  method         efficiency  but for start-up, medians of $rounds, times 1/$shrink of the paper's"
for scene in $scenes; do for method in $methods; do
	printf '%-6s %-13s %10.3f %17.3f\n' "$scene" "$method" "$(median 1 <"$scene.$method")" "$(median 2 <"$scene.$method")"
done; done
for scene in $scenes; do
	[ ! -e "$scene.masterslave" ] || report "$scene, master-slave: lost" "$(median 1 <"$scene.masterslave" | awk '{ print 1 - $1 }')" '' 0.03
done

# agree SLOTS BUILD METHOD: prints the ratio of a real run's makespan to the simulated one, of 5 s without builds; of more on
# many slots, because gdc has 150 tasks for each, and two cores pass some thousand a second. masterslave has 40
# for each here: with two or three rows, chance decides which slot has the last one, and tasks of 20 ms feel each round trip.
agree() {
	powers=$(awk -v n="$1" 'BEGIN { for (k = 0; k < n; k++) printf "%s%.3f", (k ? "," : ""), (n > 14 ? .5 + (k * 7 % n) / n : k < 12 ? 1 : k < 13 ? .442 : 1.347) }')
	scale=$(fragstat -s gears.frags | awk -v p="$powers" '$1 == "cpu_s" { n = split(p, v, ","); for (k = 1; k <= n; k++) sum += v[k]; print (n > 50 ? n / 10 : 5) * sum / $2 }')
	[ "$3" = masterslave ] && unit=run:$((262144 / (40 * $1))) || unit=''
	shipped "simulate -v -t gears.frags -x $scale -w $powers -l .1 -p 0,0,$2,2" "$3" 512x512 "$1" /dev/null fan rtworker >simulated || stop simulate
	awk -v build="$2" -v p="$powers" 'BEGIN { n = split(p, power, ",") }
		/ has its state$/ { at[$3 + 0] = $2 }
		/ is prepared$/ { took[$3 + 0] = 1e-6 * ($2 - at[$3 + 0]) * power[$3 + 1] }
		END { for (k = 0; k < n; k++) printf "h%d power=%s via=\"env REPLAY_POWER=%s BUILD=%s sh -c %%c\"\n", k, power[k + 1], power[k + 1], took[k] + 0 }' simulated >hosts
	rm -f agree.frags
	mkdir -p cut && ln -sf "$tmp/bin/partition" cut/partition || exit 3 # the real run has the same unit
	# shellcheck disable=SC2016  # BUILD is the host's
	{ pack scene gears.nff; sleep $((2 + $1 / 25)); } |
		programs=$here unit=$unit PATH=$tmp/cut:$PATH "$here/balance-$3" 512x512 "$1" /dev/null \
		fan -S hosts sh -c 'exec replay -b ${BUILD:-0} -x '"$scale gears.frags" |
		gather -r agree.frags -o agree.pfm || stop "failed: $3 on $1 slots"
	grep -a -o 'done .*' agree.frags | sed -n 's/.* sent_us=\([0-9]*\) recv_us=\([0-9]*\).*/\1 \2/p' |
		awk -v s="$(awk '$1 == "makespan_s" { print $2 }' simulated)" '{ if (NR == 1 || $1 < from) from = $1; if ($2 > to) to = $2 }
			END { printf "%.4f\n", 1e-6 * (to - from) / s }'
}
echo "makespan of real runs beside simulated ones, medians of $rounds; load of the machine before: $(cut -d ' ' -f 1 /proc/loadavg)"
for n in $slots; do for build in $builds; do for method in masterslave gdc adaptive; do
	for _ in $(seq "$rounds"); do agree "$n" "$build" $method; done | median 1 >ratio
	report "$n slots, builds of $build s, $method: real / simulated $(cat ratio), apart" \
		"$(awk '{ d = 100 * ($1 - 1); print (d < 0 ? -d : d) }' ratio)" ' %' 3
done; done; done
[ -n "$scenes" ] || exit 0

# The last runs of three of them as bars; the titles have their efficiency.
mkdir -p "$root/build/bench" || exit 3
{
	printf '# %s\n' 'x: time' 'y: power of the host' 'lanes: 1 1 1 1 1 1 1 1 1 1 1 1 0.442 1.347' 'seed: 0' 'command: tests/bench/60_replay.sh' \
		"commit: $(cd "$root" && git describe --always --dirty 2>/dev/null || echo none)" \
		"machine: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $("$root/tests/processors") cores" \
		"note: times are 1/$shrink of the paper's"
	for method in interleaved masterslave adaptive; do
		[ -s gears.$method.frags ] || continue
		efficiency=$(tail -n 1 gears.$method | awk '{ printf "%.2f", $1 }')
		fragstat -g -S hosts gears.$method.frags | sed "/^#/d; s/^gears[^	]*/$method: efficiency $efficiency/"
	done | awk '!/^experiment/ || !n++'
} >"$root/build/bench/hosts.tsv" || exit 3
chart -t 'gears, 512x512, on the 14 hosts of the GDC paper' -o "$root/build/bench/hosts.svg" \
	"$root/build/bench/hosts.tsv" || exit 3
echo 'made build/bench/hosts.svg of build/bench/hosts.tsv'
