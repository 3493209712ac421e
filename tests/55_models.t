#!/bin/sh
# spin checks models of the two rings (models/*.pml) for 3 nodes, in every order of their steps: they are safe, and every
# run ends. The default ring holds with up to 2 crashes. The published ring holds without faults; with faults it fails in
# the ways that ringctl(1) lists. spin must also find each mutant of the models.
. "$(dirname "$0")/lib.sh"
needs spin

# verifier MODEL: ./MODEL
verifier() {
	spin -a "$root/tests/models/$1.pml" && cc -O1 -w -DNOREDUCE -DNOFAIR -DMEMLIM=1000 -o "$1" pan.c
}
# search MODEL VARIABLE=VALUE ... -OPTION ...: tries all states, in at most 1 GB and 300 s of CPU time; `said` has the result
search() {
	model=$1 given=
	shift
	while [ "${1#-}" = "$1" ]; do
		given="$given $1"
		shift
	done
	# shellcheck disable=SC2086
	env $given prlimit --cpu=300 "./$model" -m100000 "$@" >said 2>&1
}
# holds MODEL ...: the search is complete; no state is wrong, and none comes twice
holds() {
	search "$@" -a
	grep 'errors: 0$' said && ! grep 'Search not completed\|^error' said
}
# finds WHAT MODEL ...: the search ends with this error; -n: it does not look for cycles
finds() {
	what=$1
	shift
	search "$@" -w20
	grep 'errors: 1$' said && grep -E -e "^pan:[0-9]+: .*$what" said
}

ok 'the model of the default ring compiles' verifier ring
ok 'default ring, nodes and rows that come at any time, a late answer: safe, and every run ends' holds ring LATE=1
ok 'default ring, one crash, one return: safe, and every run ends' holds ring CRASHES=1
ok 'default ring, two crashes, a late answer: safe, and every run ends' holds ring CRASHES=2 LATE=1
ok 'the model of the published ring compiles' verifier published
ok 'published ring, without faults: every run ends' holds published

ok 'published ring, one crash: some run does not end' finds 'assertion violated .*over' published CRASHES=1 -n
# hazard NUMBER WHAT NAME FAULT=TIMES ...
hazard() {
	number=$1 what=$2 name=$3
	shift 3
	ok "published ring, hazard $number: $what" finds "assertion violated .*$name" published HAZARD="$number" "$@" -n
}
hazard 1 'a node that ended early takes no work that reappears' a_node_that_ended_early CRASHES=1
hazard 2 'a stolen row whose thief dies is lost' a_stolen_row_whose_thief_dies CRASHES=1
hazard 3 'a slow row looks like a crash' a_slow_row_looks_like_a_crash SLOW=1
hazard 4 'a lost answer leaves a row with no owner' a_lost_answer LOSES=1
hazard 5 'the heir may be dead itself' the_heir_may_be_dead CRASHES=2
hazard 6 'two detectors both take over' two_detectors_both_take_over CRASHES=1
hazard 7 'a node that returns before it is missed hides its loss' a_node_that_returns_hides_its_loss \
	CRASHES=1 RETURNS=1

# mutant WHAT MODEL NAME ...: spin finds this mutant, by WHAT
mutant() {
	what=$1 model=$2 name=$3
	shift 3
	ok "spin finds: $model, $(echo "$name" | tr _ -)" finds "$what" "$model" MUTANT="$name" "$@"
}
for name in forgets_computed_tasks_of_a_lost_node forgets_held_tasks_of_a_lost_node \
	counts_a_gift_from_a_node_that_does_not_own_the_task hub_ends_when_all_is_computed \
	does_not_send_a_node_the_tasks_that_waited_for_it does_not_ask_a_node_again_for_pixels_of_later_tasks \
	ignores_a_computed_task_that_comes_again takes_a_void_gift_for_no_answer; do
	mutant 'assertion violated' ring $name CRASHES=1 -n
done
mutant 'assertion violated .*over' ring ignores_a_gift_of_a_computed_row CRASHES=1 -n
mutant 'assertion violated .*over' ring ignores_a_gift_that_comes_late LATE=1 -n
mutant 'acceptance cycle' ring asks_while_its_worker_computes -a
for name in master_ends_when_all_is_computed does_not_ask_node_0_for_pixels; do
	mutant 'assertion violated' published $name -n
done
mutant 'acceptance cycle' published asks_the_same_node_again_after_none -a
finish
