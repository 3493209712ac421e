#!/bin/sh
# Large loads: a million tasks, a hundred thousand frames, a scene of 40 MB, many slots, a reader that sleeps. Memory of
# deal and fan is bounded, no slot is lost by mistake, and no time is quadratic.
. "$(dirname "$0")/../lib.sh"
spdgen -s 2 tetra >tetra.nff
# shellcheck source=../peaks.sh
. "$root/tests/peaks.sh"
# shellcheck source=../marked.sh
. "$root/tests/marked.sh"
# bounded NAME PROGRAM kib|open LIMIT
bounded() { ok "$1: $2 has at most $4 $3 ($(most "$2" "$3"))" [ "$(most "$2" "$3")" -le "$4" ]; }

for to in '' '-n 2'; do
	measured "{ pack scene tetra.nff; partition $to -u run:1 1000x1000; } |
		deal fan -j 2 sh -c 'sleep 2; exec rtworker -' | gather -o 'out$to.png'"
	# shellcheck disable=SC2154  # peaks.sh sets it
	is "a million tasks $to: exit" "$status" 0
	for p in deal fan; do bounded "a million tasks $to" $p kib 65536; done
	bounded "a million tasks $to" gather kib 32768
done
ok 'a million tasks: the same picture' cmp out.png 'out-n 2.png'
measured '{ pack scene tetra.nff; partition -u run:1 1000x1000; } | deal fan -j 200 rtworker - 2>said | gather -o many.png'
is 'a million tasks on 200 slots: exit, and not a word' "$status$(cat said)" 0
ok 'a million tasks on 200 slots: the same picture' cmp out.png many.png
for p in deal fan gather; do bounded 'a million tasks on 200 slots' $p kib 32768; done
bounded 'a million tasks on 200 slots' fan open 416

partition 8000x8000 | rtworker tetra.nff | gather -o good.png
measured '{ pack scene tetra.nff; partition 8000x8000; } | deal fan -j 2 rtworker - 2>said | { sleep 5; gather -o out.png; }'
is '8000x8000, and a reader that pauses for 5 s: exit, and not a word' "$status$(cat said)" 0
ok '8000x8000: the same picture' cmp out.png good.png
for p in deal fan; do bounded 8000x8000 $p kib 32768; done
bounded 8000x8000 gather kib $(((8000 * 8000 * 129 / 8 >> 10) + (16 << 10)))

start=$(date +%s)
awk 'BEGIN { for (i = 0; i < 100000; i++) print "frame", i, "4 4\ntask", i, "0 0 0 4 4 1 1" }' >frames.task
is 'a hundred thousand frames' "$({ pack scene tetra.nff; cat frames.task; } | deal fan -j 2 rtworker - |
	fragstat -s | sed -n 's/^tasks.//p')" 100000
ok 'a hundred thousand frames: within 30 s' [ $(($(date +%s) - start)) -le 30 ]

{
	printf 'v\nfrom 0 0 -50\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 64 64\nl 0 100 -100\nf 1 1 1 1 0 0 0 0\n'
	awk 'function u() { return rand() * 60 - 30 }
	BEGIN { srand(1); for (i = 0; i < 450000; i++) { x = u(); y = u(); z = u()
		printf "p 3\n%.6f %.6f %.6f\n%.6f %.6f %.6f\n%.6f %.6f %.6f\n", x, y, z, x + rand(), y, z, x, y + rand(), z } }'
} >big.nff
partition 64x64 | rtworker big.nff | gather -o big.pfm
measured '{ pack scene big.nff; partition 64x64; } | deal fan -t .6 -j 6 rtworker - 2>said | gather -o out.pfm'
ok '40 MB of scene, silence of 0.6 s allowed: the same picture' cmp out.pfm big.pfm
is '40 MB of scene: no slot is lost' "$(cat said)" ''
for p in deal fan; do bounded '40 MB of scene, three times' $p kib 131072; done
env MARK="$mark" sh -c '{ pack scene big.nff; partition 64x64; } | deal fan -j 4 rtworker - 2>said | gather -o out.pfm' &
sleep 1.5
kill -9 "$(program gather)"
wait $!
ok 'gather killed while scenes are loaded: no process after 1 s' await 1 none_alive

partition 512x512 | rtworker tetra.nff | gather -o good.pfm
{ pack scene tetra.nff; partition 512x512; } | deal fan -j 200 rtworker - 2>said | gather -o out.pfm
ok '200 slots: the same picture' cmp out.pfm good.pfm
is '200 slots: no slot is lost' "$(cat said)" ''
spdgen -s 2 gears >gears.nff
{ pack scene gears.nff; partition 256x256; } | deal fan -j 50 rtworker -a 64 - 2>said | gather -o out.pfm
is '50 slots at work: no slot is lost' "$?$(cat said)" 0
{ pack scene tetra.nff; partition 1024x1024; } | deal fan -j 2 rtworker - 2>said | { sleep 10; gather -o out.pfm; }
is 'a reader that sleeps for 10 s: no slot is lost' "$?$(cat said)" 0
finish
