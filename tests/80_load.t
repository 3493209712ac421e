#!/bin/sh
# Invariant 6 under load: many slots, many tasks, a large picture, a reader that pauses. The picture is complete and the
# same, no slot is lost, and memory and descriptors stay within the limits of fan(1), deal(1) and gather(1).
# tests/soak/loads.sh has larger cases.
. "$(dirname "$0")/lib.sh"
# shellcheck source=peaks.sh
. "$root/tests/peaks.sh"
# bounded NAME PROGRAM kib|open LIMIT
bounded() { ok "$1: $2 has at most $4 $3 ($(most "$2" "$3"))" [ "$(most "$2" "$3")" -le "$4" ]; }

size=200x250 tasks=50000
[ -z "${NIGHT-}" ] || size=400x500 tasks=200000
spdgen -s 2 tetra >tetra.nff
# shellcheck disable=SC2154  # peaks.sh sets it
good() { partition "$1" | rtworker tetra.nff | gather -o good.pfm; }
same() { is "$1: exit 0, and no message" "$status$(cat said)" 0 && ok "$1: the same picture" cmp out.pfm good.pfm; }

good $size
measured "{ pack scene tetra.nff; partition -u run:1 $size; } |
	deal fan -t 600 -j 200 rtworker - 2>said | gather -o out.pfm"
same "200 slots, $tasks tasks"
bounded '200 slots' fan kib $((16 << 10))
bounded '200 slots' fan open $((2 * 200 + 16))
bounded '200 slots' deal kib $((20 << 10))
bounded '200 slots' deal open 16
bounded '200 slots' gather open 16

measured "{ pack scene tetra.nff; partition -u run:1 $size; } |
	deal -q auto -e fan -t 600 -j 2 rtworker - 2>said | gather -o out.pfm"
same "two slots with -q auto, $tasks tasks"
bounded 'two slots with -q auto' fan kib $((32 << 10))
bounded 'two slots with -q auto' deal kib $(((32 << 10) + (2 * 2500 * 450 >> 10)))

measured "{ pack scene tetra.nff; partition -n 100 -u run:1 $size; } |
	ringctl fan -t 600 -j 100 ringctl -n rtworker - 2>said | gather -o out.pfm"
same "a ring of 100, $tasks tasks"
bounded 'a ring of 100' ringctl kib $((64 << 10))
bounded 'a ring of 100' ringctl open 16
bounded 'a ring of 100' fan kib $((64 << 10))

good 2000x2000
measured "{ pack scene tetra.nff; partition 2000x2000; } | deal fan -t 600 -j 2 rtworker - 2>said | { sleep 5; gather -o out.pfm; }"
same 'a reader that pauses for 5 s'
bounded 'a reader that pauses' fan kib $((16 << 10))
bounded 'a reader that pauses' deal kib $((20 << 10))
bounded 'four million pixels' gather kib $(((2000 * 2000 * 129 / 8 >> 10) + (16 << 10)))
finish
