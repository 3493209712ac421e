#!/bin/sh
# 30000x30000 pixels with gather below 1 GB: rows in order without a log; tiles in random order with one, cut and resumed.
# Needs 50 GB of disk space in TMPDIR, and 10 minutes of an idle machine.
. "$(dirname "$0")/../lib.sh"
free=$(df -Pk . | awk 'END { print int($4 / 1e6) }')
[ "$free" -ge 50 ] || { echo "1..0 # SKIP $free GB are free in $tmp, expected 50"; exit 0; }
export TMPDIR="$tmp"
cp "$root/tests/ball.nff" .
# shellcheck source=../peaks.sh
. "$root/tests/peaks.sh"
size=30000x30000
# made NAME LINE: the line of shell, whose gather has 1 GB of address space, succeeds
made() {
	measured "$2"
	# shellcheck disable=SC2154  # peaks.sh sets it
	is "$1: exit 0; gather needs $(most gather kib) KiB" "$status" 0
}
made "$size, rows" "partition $size | rtworker -a 1 ball.nff | prlimit --as=1000000000 gather -o rows.png"
# in random order
partition -u tile:512x512 $size | awk '{ print (NR > 1) rand() "\t" $0 }' | sort | cut -f 2- >tiles.task
head -n 1500 tiles.task | rtworker -a 1 ball.nff | prlimit --as=1000000000 gather -o tiles.png -r log 2>said
ok "$size, tiles: a run that ends early has no picture" test ! -e tiles.png
like "$size, tiles: it says what is missing" "$(cat said)" 'frame 0: [0-9]+ of 900000000 pixels missing'
made "$size, tiles, a log continued" "partition -u tile:512x512 -r log $size | rtworker -a 1 ball.nff |
	prlimit --as=1000000000 gather -r log -o tiles.png"
ok "$size, tiles: the same bytes" cmp rows.png tiles.png
made "$size, from the log, as PFM" 'prlimit --as=1000000000 gather -o all.pfm log'
is "$size: the PFM has all pixels" "$(wc -c <all.pfm)" $((30000 * 30000 * 12 + 20))
finish
