#!/bin/sh
# seeds.sh [SEEDS [FIRST]]: so many seeds of everything that can go wrong, for deal and for the ring; what fails says how
# to repeat it.
. "$(dirname "$0")/../lib.sh"
seeds=${1:-100000} first=${2:-0}
for method in deal ring; do
	# shellcheck disable=SC2154  # lib.sh sets them
	run simulate -n "$seeds" -s "$first" $method
	is "$method: $seeds seeds from $first on" "$status $err" '0 '
	diag "$out"
done
finish
