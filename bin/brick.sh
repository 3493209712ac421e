# shellcheck shell=sh disable=SC2154  # balance-bricks, whose slots run this, exports them
# brick.sh NUMBER: renders that brick by all slots of host $slot, and prints a pixel for the farm of
# balance-bricks.
here=$(dirname "$(readlink -f "$0")") && usage='' && . "$here/stormring.sh"
set -f # words of -W are split at blanks, and are no patterns
[ -d "$temporary" ] || exit 1 # the run was interrupted
exec 2>"$temporary/said"
brick=$(sed -n "$1p" "$temporary/order")
balance adaptive -S "$temporary/host.$slot" -k 16 -o "$temporary/$1.pam" ${size:+-s "$size"} \
	${worker:+-W "$worker"} ${pack:+-z "$pack"} -- "$brick" "$spec" && printf 'P5 1 1 255\n0' && exit
{ : >"$temporary/failed"; } 2>/dev/null || exit 1 # so that the words of the farm about it are not needed
name=$(sed -n "$slot{s/[[:blank:]].*//;p;}" "$temporary/lines")
say "balance bricks: $name: $brick failed there"
exit 1
