#!/bin/sh
# 98_povray_ssh: a scene for POV-Ray on three test hosts (tests/README) of one slot, by `balance adaptive` and by GNU
# parallel, which copies the files there by rsync, runs POV-Ray on BANDS bands of equal height and fetches them (joining
# them is not counted). Medians of ROUNDS interleaved runs; then each once more with host3 at a quarter of a processor. The
# hosts share the cores of this machine, so the two are compared, and not the speed on more machines.
hosts=$(cd "$(dirname "$0")/.." && pwd)/hosts
why=$("$hosts" check 2>&1) || { echo "98_povray_ssh: no test hosts: $why"; exit 0; }
[ -n "${TEST_HOSTS-}" ] || exec "$hosts" with 3 "$0" "$@"
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
for program in povray parallel rsync; do command -v $program >/dev/null || stop "$program: not installed"; done
rounds=${ROUNDS:-3} size=${SIZE:-800x600} bands=${BANDS:-12}
scene=${SCENE:-/usr/share/doc/povray/examples/advanced/teapot/teapot.pov} words=${WORDS:-+A0.1 +AM2}
name=$(basename "$scene") width=${size%x*} height=${size#*x}
mkdir files
povworker -l "$scene" | xargs -d '\n' pack files | tail -n +2 | tar -C files -xf - 2>/dev/null || stop "$scene: cannot be unpacked"
# shellcheck disable=SC2086  # a word each
(cd files && povray "+I$name" -A +FN $words "+W$width" "+H$height" -D "+O$tmp/threads.png" 2>"$tmp/said") || stop 'povray failed'

balance() { "$root/bin/balance" adaptive -S "$TEST_HOSTS/hosts" -s "$size" -W "$words" -r log -o adaptive.png "$scene"; }
gnu() {
	seq 1 $((height / bands)) "$height" | parallel --will-cite -S 1/host1,1/host2,1/host3 --basefile files/ --return 'band{}.png' --cleanup \
		"cd files && povray +I$name -A +FN $words +W$width +H$height +SR{} +ER{= \$_ += $((height / bands - 1)) =} +WT1 -D +O../band{}.png"
}
# timed NAME: elapsed seconds
timed() {
	rm -f log adaptive.png band*.png
	begin=$(date +%s.%N)
	$1 >said 2>&1 || { tail -n 5 said >&2; stop "$1 failed"; }
	date +%s.%N | awk -v b="$begin" '{ printf "%.2f\n", $1 - b }'
}
for round in $(seq "$rounds"); do
	for way in balance gnu; do timed $way >>$way.s || stop "round $round"; done
done
echo "$name, $size, $words: three hosts of one slot, which share $("$root/tests/processors") processors; medians of $rounds"
for way in balance gnu; do echo "  $way $(median 1 <$way.s) s"; done
"$hosts" power host3 .25
for way in balance gnu; do echo "  $way, host3 at a quarter of a processor: $(timed $way) s"; done
timed balance >/dev/null
echo "  pixels of balance that differ from those of povray: $(imgcmp adaptive.png threads.png | awk '$1 == "differing" { print $2 }')"
