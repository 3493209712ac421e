#!/bin/sh
# 72_slow_links [RATE [SIDE]]: SPD's gears, SIDE x SIDE pixels (default 1024), on three test hosts (tests/README), each
# behind a link of RATE (default 10mbit) with a queue of 200 ms, by every method, with plain records (-z off) and as fan
# decides (-z auto). Then the scene of `spdgen -s 9 gears` reaches the hosts, for a picture of 16x16 pixels. Prints the
# bytes on the links, in both directions, with those of ssh and TCP, and seconds: medians of ROUNDS (1) runs.
hosts=$(cd "$(dirname "$0")/.." && pwd)/hosts
why=$("$hosts" check 2>&1) || { echo "72_slow_links: no test hosts: $why"; exit 0; }
[ -n "${TEST_HOSTS-}" ] || exec "$hosts" with 3 "$0" "$@"
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rate=${1:-10mbit} side=${2:-1024} rounds=${ROUNDS:-1} here='host1 host2 host3'
methods=${METHODS:-$(balance -h | sed -n 's/^methods: *//p')}
for h in $here; do "$hosts" link "$h" "$rate" || stop "no link of $rate"; done
passed() { tr : ' ' </proc/net/dev | awk '$1 ~ /^host[1-3]$/ { n += $2 + $10 } END { print n }'; }
# sample NAME MODE METHOD SIDE SCENE: adds "bytes seconds" to the file NAME.MODE
sample() {
	rm -f out.pfm
	bytes=$(passed) begin=$(date +%s.%N)
	balance "$3" -z "$2" -S "$TEST_HOSTS/hosts" -s "$4x$4" -o out.pfm "$5" 2>said || { cat said >&2; stop "$1 failed"; }
	echo "$(($(passed) - bytes)) $begin $(date +%s.%N)" | awk '{ print $1, $3 - $2 }' >>"$1.$2"
	cmp out.pfm "good$4.pfm" || stop "$1: another picture"
}
# row NAME: prints medians as a line of the table; leaves the ratio of the seconds in $ratio
row() {
	set -- "$1" "$(median 1 <"$1.off")" "$(median 1 <"$1.auto")" "$(median 2 <"$1.off")" "$(median 2 <"$1.auto")"
	ratio=$(echo "$4 $5" | awk '{ print $2 / $1 }')
	echo "$@" | awk '{ printf "| %s | %.2f | %.2f | %.2f | %.1f | %.1f | %.2f |\n", $1, $2 / 1e6, $3 / 1e6, $3 / $2, $4, $5, $5 / $4 }'
}
{ spdgen gears >gears.nff && spdgen -s 9 gears >gears9.nff; } || stop 'spdgen failed'
partition "${side}x$side" | rtworker gears.nff | gather -o "good$side.pfm" || stop 'rtworker failed'
partition 16x16 | rtworker gears9.nff | gather -o good16.pfm || stop 'rtworker failed'
i=0
while [ $((i += 1)) -le "$rounds" ]; do
	for method in $methods; do
		for mode in off auto; do sample "$method" $mode "$method" "$side" gears.nff; done
	done
	for mode in off auto; do sample scene $mode masterslave 16 gears9.nff; done
done
echo "gears, ${side}x$side, three hosts behind links of $rate; plain, and packed as fan decides:"
echo
echo '| method | MB plain | MB packed | share | s plain | s packed | share |'
echo '| --- | ---: | ---: | ---: | ---: | ---: | ---: |'
most=0
for method in $methods; do
	row "$method"
	most=$(echo "$most $ratio" | awk '{ print ($1 > $2 ? $1 : $2) }')
done
row scene
echo
report "the time by the method that gains least" "$most" '' .45
report "the time until the scene of gears 9 is there" "$ratio" '' .35
