#!/bin/sh
# seeds.sh [SEEDS [FIRST]]: SEEDS seeds of all faults, for deal, for the ring and for the published ring.
# A failure is printed as a command.
. "$(dirname "$0")/../lib.sh"
seeds=${1:-$(soaked 100000)} first=${2:-${FIRST:-0}}
for method in deal ring; do
	# shellcheck disable=SC2154  # lib.sh sets them
	run simulate -n "$seeds" -s "$first" $method
	is "$method: $seeds seeds from $first on" "$status $err" '0 '
	diag "$out"
done
# The published ring must keep its rules, and lose no task without faults.
ok 'the seeds of the published ring compile' make -s -C "$root" build/unit/test_gdc
run env SEEDS="$seeds" FIRST="$first" "$root/build/unit/test_gdc"
is "ring -p: $seeds seeds" "$status" 0
diag "$(printf '%s\n' "$out" "$err" | grep '^#\|^to repeat')"
finish
