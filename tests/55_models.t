#!/bin/sh
# The two rings as models (models/*.pml), checked by spin in every order in which their steps may come, for 3 nodes:
# safety, and that every run ends. The default ring with up to 2 crashes; the published one without, and with the faults
# that it is to fail, in the ways that ringctl(1) lists. What the models are worth is shown by planted bugs.
. "$(dirname "$0")/lib.sh"
needs spin

# verifier MODEL: ./MODEL
verifier() {
	spin -a "$root/tests/models/$1.pml" && cc -O1 -w -DNOREDUCE -DNOFAIR -DMEMLIM=1000 -o "$1" pan.c
}
# search MODEL VARIABLE=VALUE ... -OPTION ...: all its states, in at most 1 GB; what was found is in `said`
search() {
	model=$1 given=
	shift
	while [ "${1#-}" = "$1" ]; do
		given="$given $1"
		shift
	done
	# shellcheck disable=SC2086
	env $given timeout 300 "./$model" -m100000 "$@" >said 2>&1
}
# holds MODEL ...: of all states, to the last one, none is wrong, and none comes again
holds() {
	search "$@" -a
	grep 'errors: 0$' said && ! grep 'Search not completed\|^error' said
}
# finds WHAT MODEL ...: something is wrong, and it is that; -n: states that come again are not looked for
finds() {
	what=$1
	shift
	search "$@" -w20
	grep 'errors: 1$' said && grep -E -e "^pan:[0-9]+: .*$what" said
}

ok 'the default ring has a verifier' verifier ring
ok 'by default, nodes and rows coming at any time, a late answer: it is safe, and every run ends' holds ring LATE=1
ok 'by default, one crash, and one return: it is safe, and every run ends' holds ring CRASHES=1
ok 'by default, two crashes, a late answer: it is safe, and every run ends' holds ring CRASHES=2 LATE=1
ok 'the published ring has a verifier' verifier published
ok 'published, without faults: every run ends' holds published

ok 'published, one crash: a run that does not end' finds 'assertion violated .*over' published CRASHES=1 -n
# hazard NUMBER WHAT NAME FAULT=TIMES ...
hazard() {
	number=$1 what=$2 name=$3
	shift 3
	ok "published: $what" finds "assertion violated .*$name" published HAZARD="$number" "$@" -n
}
hazard 1 'a node that ended early takes no work that reappears' a_node_that_ended_early CRASHES=1
hazard 2 "a stolen row whose thief dies is in nobody's account" a_stolen_row_whose_thief_dies CRASHES=1
hazard 3 'a slow row looks like a crash' a_slow_row_looks_like_a_crash SLOW=1
hazard 4 'a lost answer leaves a row with no owner' a_lost_answer LOSES=1
hazard 5 'the heir may be dead itself' the_heir_may_be_dead CRASHES=2
hazard 6 'two detectors both take over' two_detectors_both_take_over CRASHES=1
hazard 7 'a node that returns before it is missed hides its loss' a_node_that_returns_hides_its_loss \
	CRASHES=1 RETURNS=1

# Numbers above 2 are those of the same bugs in lib/sched.
for k in 27 28 29 35 36 38 47 80; do
	ok "planted bug $k of the default ring is found" finds 'assertion violated' ring CRASHES=1 BUG=$k -n
done
ok 'and a GIVE of what is computed that does not count' finds 'assertion violated .*over' ring CRASHES=1 BUG=1 -n
ok 'and a GIVE that comes late and does not count' finds 'assertion violated .*over' ring LATE=1 BUG=3 -n
ok 'and a last row that is passed round' finds 'acceptance cycle' ring BUG=2 -a
for k in 57 59; do
	ok "planted bug $k of the published ring is found" finds 'assertion violated' published BUG=$k -n
done
ok 'and 60, one that asks for ever' finds 'acceptance cycle' published BUG=60 -a
finish
