#!/bin/sh
# The two rings as models (models/*.pml), checked by spin in every order in which their steps may come, for 3 nodes:
# safety, and that every run ends. The default ring with up to 2 crashes; the published one without, and with the faults
# that it is to fail, in the ways that ringctl(1) lists. What the models are worth is shown by planted bugs.
. "$(dirname "$0")/lib.sh"

if ! command -v spin >/dev/null; then
	skip 'the models' 'spin is not installed'
	finish
fi

# search KIND MODEL -DOPTION ...: all its states, in at most 1 GB; what was found is in `said`. KIND: assertions and
# states in which nothing can happen any more (SAFETY), or besides that states that come again (NP)
optimized=-O0
search() {
	kind=$1 name=$2 cycles=-n # says less
	shift 2
	[ "$kind" = SAFETY ] || cycles=-l
	rm -f said pan
	spin "$@" -a "$root/tests/models/$name.pml" >said 2>&1 &&
		cc "$optimized" -w "-D$kind" -DCOLLAPSE -DNOREDUCE -DMEMLIM=1000 -o pan pan.c >>said 2>&1 &&
		timeout 300 ./pan "$cycles" -m100000 >>said 2>&1
}
# holds KIND MODEL -DOPTION ...: of all states, to the last one, none is wrong
holds() {
	search "$@"
	grep 'errors: 0$' said && ! grep 'Search not completed\|^error' said
}
# finds WHAT KIND MODEL -DOPTION ...: something is wrong, and it is that
finds() {
	what=$1
	shift
	search "$@"
	grep 'errors: 1$' said && grep -E -e "^pan:[0-9]+: .*$what" said
}

optimized=-O1
ok 'by default, without a crash, nodes and rows coming at any time: it is safe, and every run ends' holds NP ring
ok 'by default, one crash, and one return: it is safe, and nothing is left over' holds SAFETY ring -DCRASHES=1
ok 'by default, two crashes: it is safe, and every run ends' holds NP ring -DCRASHES=2
ok 'published, without faults: every run ends' holds NP published

optimized=-O0
ok 'published, one crash: a run that does not end' finds 'assertion violated .*over' SAFETY published -DCRASHES=1
# hazard NUMBER WHAT NAME FAULTS
hazard() {
	number=$1 what=$2 name=$3
	shift 3
	ok "published: $what" finds "assertion violated .*$name" SAFETY published -DHAZARD="$number" "$@"
}
hazard 1 'a node that ended early takes no work that reappears' a_node_that_ended_early -DCRASHES=1
hazard 2 "a stolen row whose thief dies is in nobody's account" a_stolen_row_whose_thief_dies -DCRASHES=1
hazard 3 'a slow row looks like a crash' a_slow_row_looks_like_a_crash -DSLOW=1
hazard 4 'a lost answer leaves a row with no owner' a_lost_answer -DLOSES=1
hazard 5 'the heir may be dead itself' the_heir_may_be_dead -DCRASHES=2
hazard 6 'two detectors both take over' two_detectors_both_take_over -DCRASHES=1
hazard 7 'a node that returns before it is missed hides its loss' a_node_that_returns_hides_its_loss \
	-DCRASHES=1 -DRETURNS=1

# Numbers above 2 are those of the same bugs in lib/sched.
for k in 27 28 29 35 36 38 47 80; do
	ok "planted bug $k of the default ring is found" finds 'assertion violated' SAFETY ring -DCRASHES=1 -DBUG=$k
done
ok 'and a GIVE of what is computed that does not count' \
	finds 'assertion violated .*over' SAFETY ring -DCRASHES=1 -DBUG=1
ok 'and a last row that is passed round' finds 'non-progress cycle' NP ring -DBUG=2
for k in 57 59; do
	ok "planted bug $k of the published ring is found" finds 'assertion violated' SAFETY published -DBUG=$k
done
ok 'and 60, one that asks for ever' finds 'non-progress cycle' NP published -DBUG=60
finish
