#!/bin/sh
# Every planted bug of a policy is found by the seeds of `make check`; the shipped policy passes them.
. "$(dirname "$0")/lib.sh"

# Only the policies differ; the rest is compiled once.
flags="-std=c11 -D_GNU_SOURCE -O1 -I$root/lib"
# shellcheck disable=SC2086
compile() { for c in "$@"; do cc $flags -c -o "$(basename "$(dirname "$c")")-$(basename "$c" .c).o" "$c" || return; done; }
# shellcheck disable=SC2086
build() { cc $flags "-DPLANTED_BUG=$1" -o "sim$1" "$root"/lib/sched/*.c ./*.o -lcmocka -lm; }
finds() { build "$1" && ! timeout 60 "./sim$1" >said 2>&1 && grep -q 'to repeat:' said; }

ok "the simulation compiles" compile "$root"/tests/unit/test_sim.c "$root"/lib/sim/*.c "$root"/lib/task/*.c "$root"/lib/base/*.c
build 0
ok "the shipped policy passes every seed" ./sim0
most=$(grep -ho 'BUG([0-9]*)' "$root"/lib/sched/deal*.c "$root"/lib/sched/ledger.c "$root"/lib/sched/pace.c | tr -dc '0-9\n' | sort -n | tail -1)
for k in $(seq "$most"); do
	ok "planted bug $k is found" finds "$k"
done
finish
