#!/bin/sh
# seeds.sh [SEEDS [FIRST]]: SEEDS seeds of all faults, for deal, for the ring and for the published ring.
# A failure is printed as a command.
. "$(dirname "$0")/../lib.sh"
seeds=${1:-$(soaked 100000)} first=${2:-${FIRST:-0}}
for test in sim ring gdc; do
	ok "the seeds of test_$test compile" make -s -C "$root" "build/unit/test_$test"
	run env SEEDS="$seeds" FIRST="$first" "$root/build/unit/test_$test"
	is "test_$test: $seeds seeds from $first on" "$status" 0
	diag "$(printf '%s\n' "$out" "$err" | grep '^#\|^to repeat')"
done
finish
