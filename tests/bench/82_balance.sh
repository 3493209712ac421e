#!/bin/sh
# 82_balance: how close to the lower bound are the shipped adaptive and gdc? In virtual time: gears
# at the GDC paper's 1091 s, and other scenes, on hosts of unequal power, with long links, faults and a row that has
# 30 % of the work. Medians over SEEDS draws of powers and faults, of makespan and of efficiency (lower bound /
# makespan), and of the least time of any schedule that knows all costs / makespan. Where hosts fall silent or become slow
# at a known time, that is the time in which the others were never idle; where faults are drawn, it is not known. With
# OLD=PROGRAM, another simulate, its makespan, efficiency, and the ratio of the makespans. CASES=ERE picks cases.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
here=$root/bin temporary=$tmp
# shellcheck source=../../bin/virtual.sh
. "$root/bin/virtual.sh"
seeds=${SEEDS:-5}

# costs SCENE: SCENE.frags, the cost of each row on one worker
costs() {
	[ -s "$1.frags" ] && return
	spdgen -s 2 "$1" >"$1.nff" || stop "spdgen $1 failed"
	# shellcheck disable=SC2154  # lib.sh sets pin
	partition 512x512 | $pin rtworker "$1.nff" >"$1.frags" || stop "rendering $1 failed"
}
# one_row: hot.frags, gears with 30 % of its cost in row 256
one_row() {
	perl -e 'use strict; binmode STDIN; binmode STDOUT; my (@all, $sum);
		while (my $line = <STDIN>) { my $body = "";
			read STDIN, $body, $1 + 1 if $line =~ / bytes=(\d+)/;
			$sum += $1 if $line =~ /^done 0 (?!256 ).*cpu_us=(\d+)/;
			push @all, $line, $body }
		for (@all) { s/cpu_us=\d+/"cpu_us=" . int($sum * 3 \/ 7)/e if /^done 0 256 /; print }' <gears.frags |
		"$root/tests/seal" >hot.frags
}
for scene in gears balls rings; do costs $scene; done
one_row

# value SIMULATE: prints makespan, efficiency and least time / makespan of a run of the method, 0 if it fails
value() {
	if ! shipped "$1 -t $costs.frags -x $scale -s $seed $hosts $options" "$method" 512x512 "$slots" /dev/null \
		fan -j "$slots" rtworker >figures; then
		echo '0 0 0'
		return
	fi
	awk -F '\t' '$1 == "makespan_s" { m = $2 } $1 == "efficiency" { e = $2 } $1 == "least_s" { l = $2 }
		END { print m, e, l / m }' figures
}
built draw_powers
# possible "MAKESPAN EFFICIENCY ...": prints the part of the efficiency that this draw allows, if no host that is left is
# ever idle
possible() {
	case $hosts in
	-w*) powers=${hosts#-w } ;;
	*) powers=$(./draw_powers "$seed" "$(echo "${hosts#-j }" | tr , ' ')") ;;
	esac
	echo "$powers" | awk -F , -v efficiency="$(echo "$1" | cut -d ' ' -f 2)" -v bound="$(echo "$1" | awk '{ print $1 * $2 }')" -v faults="${options##* -f }" '{
		for (i = 1; i <= NF; i++) all += $i
		n = split(faults, fault, ",")
		for (i = 1; i <= n; i++) {
			split(fault[i], at, "[@:]") # what, when, host, new part of its power
			lost += $(at[3] + 1) * (1 - at[4])
		}
		print efficiency / bound * (at[2] + (bound - at[2]) / (1 - lost / all))
	}'
}
# The ninth host is the fastest.
known=1,1,1,2,2,2,3,3,4,1,1,1,2,2,2,3,3,1,1,1,2,2,1,1,1,1,2,2,1,1,1,1,1,1,1,1,1
silent=silence@8s:3,silence@8s:9,silence@8s:17,silence@8s:25,silence@8s:30
printf '%-44s %-8s %s\n' case method 'makespan_s efficiency of_possible'"${OLD:+ old_makespan_s old_efficiency ratio}"
# A case: name | costs | seconds at power 1 | hosts | options of simulate
while IFS='|' read -r name costs seconds hosts options; do
	echo "$name" | grep -Eq -- "${CASES:-.}" || continue
	scale=$(fragstat -s "$costs.frags" | awk -v s="$seconds" '$1 == "cpu_s" { print s / $2 }')
	case $hosts in
	-j*) slots=${hosts#-j } && slots=${slots%,*} ;;
	*) slots=$(echo "$hosts" | tr , '\n' | wc -l) ;;
	esac
	for method in adaptive gdc; do
		: >new && : >old && : >best
		for seed in $(seq 0 $((seeds - 1))); do
			value simulate >>new
			case $options in
			*@*) possible "$(tail -n 1 new)" ;;
			*=*) echo - ;;
			*) tail -n 1 new | cut -d ' ' -f 3 ;;
			esac >>best
			[ -z "${OLD-}" ] || value "$OLD" >>old
		done
		printf '%-44s %-8s %s' "$name" $method "$(median 1 <new) $(median 2 <new) $(if grep -q - best; then echo -; else median 1 <best; fi)"
		[ -z "${OLD-}" ] ||
			echo "$(median 1 <old) $(median 2 <old) $(median 1 <new)" | awk '{ printf " %s %s %.3f", $1, $2, $3 / $1 }'
		echo
	done
done <<-END
	gears, 37 hosts, 5 ms|gears|1091.14|-j 37,3.1623|-l 5
	gears, 37 hosts, 50 ms|gears|1091.14|-j 37,3.1623|-l 50
	gears, 37 hosts, 150 ms|gears|1091.14|-j 37,3.1623|-l 150
	the fastest falls to 1/20, 5 ms|gears|1091.14|-w $known|-l 5 -f slow@8s:8:.05
	five hosts fall silent, 5 ms|gears|1091.14|-j 37,3.1623|-l 5 -f $silent
	five hosts fall silent, 50 ms|gears|1091.14|-j 37,3.1623|-l 50 -f $silent
	a row with 30 % of the work, 5 ms|hot|1091.14|-j 37,3.1623|-l 5
	a row with 30 % of the work, 50 ms|hot|1091.14|-j 37,3.1623|-l 50
	5000 hosts, .5 ms|gears|1091.14|-j 5000,3|-l .5
	unseen: balls, 37 hosts, 20 ms|balls|97.86|-j 37,3.1623|-l 20
	unseen: rings, 37 hosts, 100 ms|rings|400|-j 37,3.1623|-l 100
	unseen: gears, 14 hosts, 20 ms|gears|1091.14|-w $workstations|-l 20
	unseen: balls, 14 hosts, .5 ms|balls|97.86|-w $workstations|-l .5
	unseen: gears, 100 hosts, 20 ms|gears|1091.14|-j 100,3|-l 20
	unseen: gears, 37 hosts of powers 1 to 100|gears|1091.14|-j 37,10|-l 20
	unseen: crashes and pauses, 0 ms|gears|1091.14|-j 37,3.1623|-l 0 -f crash=.3,pause=.5
	unseen: crashes and pauses, 50 ms|gears|1091.14|-j 37,3.1623|-l 50 -f crash=.3,pause=.5
	unseen: every fault, 5 ms|gears|1091.14|-j 37,3.1623|-l 5 -f crash=.2,silence=.2,pause=.3,slow=.3,return=.5,jitter=.5
END
