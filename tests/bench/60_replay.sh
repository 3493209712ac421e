#!/bin/sh
# 60_replay: how true a replay is, and the GDC paper's 14 hosts by it. It wants two idle cores, and takes some minutes.
#
# First the same frame by master-slave on two slots, rendered and replayed in turns: the makespans should agree. Who waits
# does not compete with deal, fan and gather for two cores, as who renders does: so the replay takes the log's costs
# times what elapsed in its tasks over the CPU time in them. Then 14
# hosts on this machine, through the real deal, fan, pipes and gather: 12 of power 1, one of .442 and one of 1.347, rows of
# 512x512 at 1/20 of the paper's times, 97.86 s for balls on the reference host, 11.15 times that for gears and .455 times
# for tetra. Efficiency is the lower bound / the makespan, by default settings; start is at 0. All 14 start-ups share
# two cores here, and messages do not shrink with the costs: in 1/20 of the time both weigh 20 times as much (SHRINK=2
# has 1/2 of it; METHODS names the methods). Costs are those of one worker by rows, so that pixels of a row count as
# equal. masterslave+ is with deal's -q auto -e.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=${ROUNDS:-5} shrink=${SHRINK:-20} methods=${METHODS:-interleaved masterslave hybrid ss sc ds dc masterslave+}

# of FILE KEY: from a summary
of() { awk -F '\t' -v key="$2" '$1 == key { print $2 }' "$1"; }

# ---- rendered and replayed -------------------------------------------------------------------------------------
spdgen gears >frame.nff && partition 1280x1280 >frame.task || stop 'spdgen or partition failed'
{ pack scene frame.nff && cat frame.task; } >frame.job || stop 'pack failed'
both() { # OUT COMMAND ...: its makespan
	out=$1
	shift
	deal fan -j 2 "$@" <frame.job | gather -r "$out" -o "$out.png" || stop "failed: $*"
	fragstat -s "$out" >.both || stop "fragstat failed"
	of .both makespan_s
}
: >pairs
both first.frags rtworker -a 9 - >/dev/null
elapsed=$(awk -F '\t' '{ v[$1] = $2 } END { print v["busy_s"] / v["cpu_s"] }' .both)
i=0
while [ $((i += 1)) -le $rounds ]; do
	rm -f real.frags replayed.frags
	real_s=$(both real.frags rtworker -a 9 -) && replayed_s=$(both replayed.frags replay -x "$elapsed" first.frags) || exit 3
	cmp real.frags.png replayed.frags.png || stop 'the two pictures differ'
	echo "$real_s $replayed_s" | awk '{ print $1, $2, ($2 / $1 > 1 ? $2 / $1 - 1 : 1 - $2 / $1) }' >>pairs
done
echo 'rendered s  replayed s, gears 1280x1280, -a 9, by master-slave on two slots; replayed is the log of another such run, times '"$elapsed"
awk '{ printf "%10.3f  %10.3f\n", $1, $2 }' pairs
echo "$(median 1 <pairs) $(median 2 <pairs)" | awk '{ d = $2 / $1 - 1; print d < 0 ? -100 * d : 100 * d }' >apart
report 'medians apart' "$(cat apart)" ' %' 5

# ---- the paper's hosts -----------------------------------------------------------------------------------------
cat >hosts <<'END'
:     slots=12 power=1
slow  power=0.442 via="env REPLAY_POWER=0.442 sh -c %c"
fast  power=1.347 via="env REPLAY_POWER=1.347 sh -c %c"
END
slots=$(fan -l -S hosts | wc -l)
partition 512x512 >rows.task
for scene in balls gears tetra; do
	spdgen -s 2 $scene >$scene.nff && rtworker $scene.nff <rows.task >$scene.frags || stop 'rtworker failed'
	gather -o $scene.png $scene.frags || stop 'gather failed'
	case $scene in balls) paper_s=97.86 ;; gears) paper_s=1091.14 ;; tetra) paper_s=44.53 ;; esac
	fragstat -s $scene.frags >.one
	echo "$paper_s $shrink $(of .one cpu_s)" | awk '{ print $1 / $2 / $3 }' >$scene.scale
done
once() { # SCENE METHOD
	rm -f run.frags run.png
	more=''
	[ "${2%+}" = "$2" ] || more='-q auto -e'
	# shellcheck disable=SC2086
	pack scene "$1.nff" |
		"balance-${2%+}" 512x512 "$slots" /dev/null $more fan -S hosts replay -x "$(cat "$1.scale")" "$1.frags" |
		gather -r run.frags -o run.png || stop "failed: $2 of $1"
	cmp run.png "$1.png" || stop "the picture of $2 of $1 is another one"
	fragstat -s -S hosts run.frags >.run || stop 'fragstat failed'
	awk -F '\t' '{ v[$1] = $2 } END { all = v["slots"] * v["makespan_s"]
		print v["efficiency"], v["makespan_s"], v["bound_s"], 100 * v["startup_s"] / all, 100 * v["waiting_s"] / all,
			100 * v["tail_s"] / all, 100 * v["wasted_s"] / all }' .run >>"$1.$2"
	mv run.frags "$1.$2.last"
}
i=0
while [ $((i += 1)) -le $rounds ]; do
	for scene in balls gears tetra; do for method in $methods; do once $scene "$method"; done; done
done
echo
printf '%s  ' 'scene  method        efficiency ' "(of $rounds)    " 'but for start-up' 'makespan s' 'bound s'
echo 'idle: start-up %  waiting %  tail %  wasted %'
for scene in balls gears tetra; do for method in $methods; do
	sort -g $scene."$method" | awk -v s=$scene -v m="$method" '{ line[NR] = $0; e[NR] = $1 }
		END { split(line[int((NR + 1) / 2)], v, " ")
			printf "%-6s %-13s %10.3f  %.3f-%.3f  %16.3f  %10.3f  %7.3f  %16.1f  %9.1f  %6.1f  %8.1f\n", s, m, v[1],
				e[1], e[NR], v[1] / (1 - v[4] / 100), v[2], v[3], v[4], v[5], v[6], v[7] }'
done; done
echo "pack scene SCENE.nff | balance-METHOD 512x512 $slots /dev/null fan -S hosts replay -x SCALE SCENE.frags | gather -o OUT"
for scene in balls gears tetra; do
	report "$scene, master-slave: lost" "$(median 1 <$scene.masterslave | awk '{ print 1 - $1 }')" '' 0.03
done

# The last runs of two of them as bars, for the README.
mkdir -p "$root/build/bench" || exit 3
{
	printf '# %s\n' 'x: time' 'y: host' 'lanes: 1 1 1 1 1 1 1 1 1 1 1 1 0.442 1.347' 'seed: 0' 'command: tests/bench/60_replay.sh' \
		"commit: $(cd "$root" && git describe --always --dirty 2>/dev/null || echo none)" \
		"machine: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores" \
		"note: lanes are hosts, named by their power; times are 1/$shrink of the paper's"
	for method in interleaved masterslave; do
		[ -s gears.$method.last ] || continue
		fragstat -g -S hosts gears.$method.last | sed "/^#/d; s/^gears.$method.last/$method/"
	done | awk '!/^experiment/ || !n++'
} >"$root/build/bench/hosts.tsv" || exit 3
chart -t 'gears, 512x512, on the 14 hosts of the GDC paper' -o "$root/build/bench/hosts.png" \
	"$root/build/bench/hosts.tsv" || exit 3
echo 'made build/bench/hosts.png of build/bench/hosts.tsv'
