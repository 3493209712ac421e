#!/bin/sh
# 60_replay: the GDC paper's 14 hosts on this machine, through the real deal, fan, pipes and gather: 12 of power 1, one
# of .442 and one of 1.347, rows of 512x512 at 1/20 of the paper's times (97.86 s for balls on the reference host, 11.15
# times that for gears, .455 times for tetra). Efficiency is lower bound / makespan with default settings; all slots
# start at 0. 14 start-ups share two cores here, and messages do not shrink with the costs: at 1/20 of the time both
# weigh 20 times as much (SHRINK=2 sets 1/2; METHODS names the methods). It needs two idle
# cores and some minutes. `protocol agreement` measures how exact a replay is.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=${ROUNDS:-5} shrink=${SHRINK:-20} methods=${METHODS:-interleaved masterslave hybrid ss sc ds dc adaptive}

cat >hosts <<'END'
:     slots=12 power=1
slow  power=0.442 via="env REPLAY_POWER=0.442 sh -c %c"
fast  power=1.347 via="env REPLAY_POWER=1.347 sh -c %c"
END
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
	for scene in balls gears tetra; do for method in $methods; do once $scene "$method"; done; done
done
echo "scene  method         efficiency  but for start-up, medians of $rounds, times 1/$shrink of the paper's"
for scene in balls gears tetra; do for method in $methods; do
	printf '%-6s %-13s %10.3f %17.3f\n' $scene "$method" "$(median 1 <"$scene.$method")" "$(median 2 <"$scene.$method")"
done; done
for scene in balls gears tetra; do
	[ ! -e $scene.masterslave ] || report "$scene, master-slave: lost" "$(median 1 <$scene.masterslave | awk '{ print 1 - $1 }')" '' 0.03
done

# The last runs of three of them as bars; the titles have their efficiency.
mkdir -p "$root/build/bench" || exit 3
{
	printf '# %s\n' 'x: time' 'y: power of the host' 'lanes: 1 1 1 1 1 1 1 1 1 1 1 1 0.442 1.347' 'seed: 0' 'command: tests/bench/60_replay.sh' \
		"commit: $(cd "$root" && git describe --always --dirty 2>/dev/null || echo none)" \
		"machine: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores" \
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
