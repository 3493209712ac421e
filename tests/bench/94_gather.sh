#!/bin/sh
# 94_gather: CPU seconds and memory of gather, from fragments to a PNG: frames in memory, and posters in a file. OLD=PROGRAM
# compares with another gather. SIZES="3840x2160 30000x30000" measures other sizes; a pixel takes 18 bytes of disk space.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=${ROUNDS:-5} sizes=${SIZES:-3840x2160 8000x8000} old=${OLD:-}
# shellcheck source=../peaks.sh
. "$root/tests/peaks.sh"
cp "$root/tests/ball.nff" .
for size in $sizes; do
	rm -f ./*.s
	partition "$size" | rtworker -a 1 ball.nff >frags || stop 'no fragments'
	round=0
	while [ $((round += 1)) -le "$rounds" ]; do
		cpu_s 1 'gather -o a.png frags' >>new.s
		[ ! "$old" ] || cpu_s 1 "$old -o b.png frags" >>old.s
	done
	measured 'gather -o a.png frags'
	echo "$size: $(median 1 <new.s) CPU s, median of $rounds; peak $(most gather kib) KiB${old:+; the other: $(median 1 <old.s) CPU s}"
done
