#!/bin/sh
# 37_price: what fault tolerance costs the real programs: gears on the 14 workstations of the GDC
# paper at 1/SHRINK (20) of its times, by fan, deal and gather as they are; replay waits in the
# place of workers (60_replay). Rows as the shipped adaptive cuts them. Without a fault, and with a
# workstation of power 1 that is killed half way and does not come back. Medians of ROUNDS (1).
#
# s: from the start of fan to the last pixel, without the mean start-up of a slot; for -v with the
# check. master: CPU ms of the first deal and fan and of gather, without their workers, and of the
# check. records, but beats, and MB: both ways between the first fan and the workers; of the tree
# between all fans and below them. again: pixels given more than once, in percent of the picture.
# protocol price has the same in virtual time.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
here=$root/bin temporary=$tmp unit=''
# shellcheck source=../../bin/virtual.sh
. "$root/bin/virtual.sh"
rounds=${ROUNDS:-1} slots=14

# own FILE COMMAND ...: runs it, and adds its CPU milliseconds, without those of its children
cat >own <<'END'
#!/usr/bin/perl
use strict;
my $file = shift;
$SIG{$_} = "IGNORE" for qw(TERM INT HUP);
my $pid = fork // die "fork: $!";
if (!$pid) {
	$SIG{$_} = "DEFAULT" for qw(TERM INT HUP);
	exec @ARGV or die "$ARGV[0]: $!";
}
close STDIN;
close STDOUT;
my ($ns, $state) = (0, "");
while ($state ne "Z") {
	select undef, undef, undef, .01;
	open my $stat, "<", "/proc/$pid/stat" or last;
	($state) = <$stat> =~ /^.*\) (.)/;
	open my $spent, "<", "/proc/$pid/schedstat" or last;
	($ns) = split " ", <$spent>;
}
waitpid $pid, 0;
my $status = $? & 127 ? 128 + ($? & 127) : $? >> 8;
open my $out, ">>", $file;
printf $out "%.3f\n", $ns / 1e6;
close $out;
exit $status;
END
# counted NAME COMMAND ...: a link whose bytes are kept; after `: >dead.NAME` it cannot be made
cat >counted <<'END'
[ ! -e dead.$1 ] || exit 1
read -r _ _ _ _ group _ </proc/$$/stat
echo "$group" >group.$1
name=$1
shift
tee -a "down.$name" | "$@" | tee -a "up.$name"
END
chmod +x own
# The hosts: h0 to h13; g0 to g3 are hubs below the first, with every fourth of them.
echo "$workstations" | tr , '\n' | awk -v tmp="$tmp" '{ k = NR - 1
	line = sprintf("h%d power=%s via=\"sh counted h%d env REPLAY_POWER=%s sh -c %%c\"", k, $1, k, $1)
	print line >"hosts"
	print line >("hosts." k % 4) }
	END { for (g = 0; g < 4; g++)
		printf "g%d via=\"sh counted g%d env HUB=%d sh -c %%c\"\n", g, g, g >"hubs"
		print ": slots=1" >"hosts.alone" }' # what says hello on this machine
spdgen -s 2 gears >gears.nff || stop 'spdgen failed'
partition 512x512 | rtworker gears.nff >gears.frags || stop 'rtworker failed'
scale=$(fragstat -s gears.frags |
	awk -v n="${SHRINK:-20}" '$1 == "cpu_s" { print 1091.14 / n / $2 }')
adaptive() { shipped "$1" adaptive 512x512 $slots /dev/null fan -j $slots rtworker; }
{ adaptive 'sh -c cat' >tasks && rules=$(adaptive echo); } || stop 'adaptive failed'
# shellcheck disable=SC2016  # of the hub
echo "exec deal -q auto fan -z off -S hosts.\${HUB:-alone} replay -x $scale gears.frags" >inner

# below METHOD: hands out the tasks, and writes fragments
below() {
	replay="replay -x $scale gears.frags"
	# shellcheck disable=SC2086  # words
	case $1 in
	'fan alone') ./own cpu fan -z off -S hosts $replay ;;
	tree) ./own cpu deal -q auto ./own cpu fan -z off -S hubs sh inner ;;
	adaptive*-z) ./own cpu $rules ./own cpu fan -z on -S hosts $replay ;;
	adaptive*) ./own cpu $rules ./own cpu fan -z off -S hosts $replay ;;
	*) ./own cpu $1 ./own cpu fan -z off -S hosts $replay ;;
	esac <tasks
}
# kill_one: when half of the tasks are done, one host is no more
kill_one() {
	tries=0
	until [ "$(grep -ac '^done ' run.frags)" -ge 256 ]; do
		[ $((tries += 1)) -lt 2000 ] || return
		sleep .05
	done
	: >dead.h5
	kill -9 -"$(cat group.h5)"
}
# checked: computes all pieces again, and adds to the CPU time; prints seconds
checked() {
	begin=$(date +%s.%N)
	set --
	for round in 1 2; do # the second one has pieces of a host that was lost meanwhile
		./own cpu verify -s 417 -S hosts 1 run.frags "$@" </dev/null >again.task || stop 'verify'
		grep -q '^task' again.task || break
		./own cpu fan -z off -S hosts replay -x "$scale" gears.frags <again.task |
			./own cpu verify -t 20 run.frags >check.$round
		set -- "$@" check.$round
	done
	./own cpu verify -r -s 417 -S hosts 1 run.frags "$@" 2>said || { cat said >&2; stop 'a check'; }
	echo "$begin $(date +%s.%N)" | awk '{ print $2 - $1 }'
}
# sample METHOD FAULT: adds a line to a file: s, CPU ms, records, MB, percent
sample() {
	rm -f cpu out.pfm up.* down.* dead.* group.*
	: >run.frags
	[ "$2" = none ] || { kill_one & killer=$!; }
	case $1 in
	*-r) below "$1" | ./own cpu gather -r run.frags -o out.pfm ;;
	*) below "$1" | tee run.frags | ./own cpu gather -o out.pfm ;;
	esac 2>said
	complete=$?
	[ "$2" = none ] || wait "$killer"
	more=0
	case $1 in *-v) more=$(checked) || exit ;; esac
	fragstat -s run.frags >figures || stop "no log: $(cat said)"
	again=$(cat down.h* | grep -a '^task ' |
		awk '{ px += $6 * $7 } END { print 100 * (px / 512 / 512 - 1) }')
	records=$(cat up.* down.* | grep -acE '^(task|flush|frame|frag|done|hello|bye|code|up|gone) ')
	awk -F '\t' -v more="$more" -v whole=$complete -v again="$again" -v records="$records" \
		-v cpu="$(awk '{ sum += $1 } END { print sum }' cpu)" -v bytes="$(cat up.* down.* | wc -c)" '
		{ v[$1] = $2 } END {
			s = v["makespan_s"] - v["startup_s"] / v["slots"] + more
			print (whole ? -1 : s), cpu, records, bytes / 1e6, again }' figures >>"$1, $2"
}
methods=${METHODS:-"fan alone|deal|deal -e|deal -q auto|adaptive|adaptive -r|adaptive -v"\
"|adaptive -z|tree"}
for _ in $(seq "$rounds"); do
	for fault in none killed; do
		echo "$methods" | tr '|' '\n' >list
		while IFS= read -r method; do sample "$method" $fault </dev/null; done <list
	done
done
echo "| | s | master, ms | records | MB | again, % | a host is killed: s | master, ms | again, % |"
echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
while IFS= read -r method; do
	printf '| %s' "$method"
	for fault in none killed; do
		for c in 1 2 3 4 5; do median $c <"$method, $fault"; done | paste -s -d ' '
	done | paste -s -d ' ' | awk '{ printf " | %.2f | %.0f | %d | %.2f | %.1f | %s | %.0f | %.1f |\n",
		$1, $2, $3, $4, $5, ($6 < 0 ? "no picture" : sprintf("%.2f", $6)), $7, $10 }'
done <list
