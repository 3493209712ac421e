#!/bin/sh
# Every planted bug of a policy is found by the seeds of `make check`; the shipped policies pass them.
. "$(dirname "$0")/lib.sh"
needs /usr/include/cmocka.h

# Only the file with the bug differs; the rest is compiled once.
flags="-std=c11 -D_GNU_SOURCE -O1"
# shellcheck disable=SC2086
compile() { for c in "$@"; do cc $flags "-I$root/lib" -c -o "$(basename "$(dirname "$c")")-$(basename "$c" .c).o" "$c" || return; done; }
# objects FILE: all that a test is linked with, but that of lib/sched/FILE.c
objects() { for o in base-*.o task-*.o stats-*.o sim-*.o sched-*.o; do [ "$o" = "sched-$1.o" ] || echo "$o"; done; }
# finds TEST BUG FILE
# shellcheck disable=SC2046,SC2086
finds() {
	cc $flags "-I$root/lib" "-DPLANTED_BUG=$2" -c -o "bug$2.o" "$root/lib/sched/$3.c" &&
		cc -o "bug$2" "bug$2.o" "unit-test_$1.o" $(objects "$3") -lcmocka -lm &&
		! timeout 60 "./bug$2" >said 2>&1 && grep -q 'to repeat:' said
}
# family TEST FILE ...: the bugs of these files
family() {
	test=$1
	shift
	ok "the seeds of test_$test compile" compile "$root/tests/unit/test_$test.c"
	cc -o "shipped-$test" "unit-test_$test.o" base-*.o task-*.o stats-*.o sim-*.o sched-*.o -lcmocka -lm
	ok "what is shipped passes those of test_$test" "./shipped-$test"
	for file in "$@"; do
		for k in $(grep -o 'BUG([0-9]*)' "$root/lib/sched/$file.c" | tr -dc '0-9\n' | sort -nu); do
			ok "planted bug $k of $file.c is found by test_$test" finds "$test" "$k" "$file"
		done
	done
}

ok "the simulation compiles" compile "$root"/lib/sim/*.c "$root"/lib/sched/*.c "$root"/lib/task/*.c "$root"/lib/stats/*.c "$root"/lib/base/*.c
family sim actions deal deal_pick deal_end ledger pace
family ring actions ring ring_ask ring_hung ring_node
family gdc gdc gdc_node
finish
