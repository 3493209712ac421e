/*
 * The ring as it was published, for spin: the master (lib/sched/gdc_master.c), the nodes (gdc_node.c) and the links
 * between them. Functions of C have their names here. tests/55_models.t runs it.
 *
 *     spin -a published.pml && cc -O1 -DNOREDUCE -DNOFAIR -o pan pan.c && ./pan -a
 *
 * Without faults all runs end: when no step is possible any more, all rows are complete (watch), and no state comes
 * twice (watch accepts all states, and -a finds every cycle). With CRASHES=1 ./pan, and with the other faults, some
 * runs do not end. With HAZARD=k, only hazard k of HAZARDS in ringctl(1) is a failure, and the assertion that fails has
 * its name.
 *
 * At most CRASHES nodes die, RETURNS of them come up again, LOSES messages between nodes are lost, and SLOW reports of
 * a crash are wrong. Otherwise timeouts are right: a request is repeated if it or its answer was lost, and a crash is
 * reported if a node died. Links are as in ring.pml, except that a node that dies loses all messages under way to it.
 * Left out: the number of requests, and the order of answers to nodes that wait.
 */
/* One verifier for all cases: the environment says which faults to try, and MUTANT which mutant of the rules. */
c_decl {
	\#include <stdlib.h>
	\#include <string.h>
	static long given_as(const char *name) { return getenv(name) ? strtol(getenv(name), NULL, 10) : 0; }
	static int is_mutant(const char *name) { return getenv("MUTANT") && strcmp(getenv("MUTANT"), name) == 0; }
}
hidden byte hazard;
#define HAZARD(k) (hazard == k) /* the number in HAZARDS of ringctl(1) */
/* Mutants: bugs that the verifier must find. They have the same names in tests/mutants/gdc. */
#define MUTANT(name) name = is_mutant(#name)
hidden byte asks_the_same_node_again_after_none, does_not_ask_node_0_for_pixels, master_ends_when_all_is_computed;
#define N 3 /* nodes */
#define ROWS 5
#define home(r) ((r) < N -> (r) : 0) /* row r is node r's, the last rows are node 0's, so that it has rows to give */
#define KEPT 1 /* the first rows, whose pixels are held back */
#define LINK 24 /* messages on a link: 8, and 8 for each fault */

#define NONE_OF N /* -1 in C */
#define bit(i) (1 << (i))
#define has(set, i) (((set) >> (i)) & 1)
#define with(set, i) ((set) | bit(i))
#define without(set, i) ((set) & (255 - bit(i)))
#define EVERY (bit(ROWS) - 1)
#define after(k) (((k) + 1) % N)

mtype = { TASK, FLUSH, PLACE, ASK, NONE, HEIR };

chan down[N] = [LINK] of { mtype, byte, byte }; /* TASK row of peer; ASK of peer; NONE, HEIR of peer, next */
byte crashes, returns, loses, slow; /* that may still happen */
bool began;
bool over; /* the master has sent END */

/* The master: rows of the global scanline table that are computed, complete, were sent. */
byte computed, complete, sent;
byte is_up, met; /* nodes */
bool asked_all;  /* for a flush */
byte waits;      /* nodes that wait for an answer */
byte askers[N];  /* of each node: the nodes that wait for its answer */

/* For watch: nodes that ever died; nodes that were reported; the node that each row went to last; rows given away. */
byte died, reported, at[ROWS] = NONE_OF, given;

hidden byte a_node_that_ended_early, a_stolen_row_whose_thief_dies, a_slow_row_looks_like_a_crash, a_lost_answer,
	the_heir_may_be_dead, two_detectors_both_take_over, a_node_that_returns_hides_its_loss;
hidden byte a, b, c, d;

/* ---- the master --------------------------------------------------------------------------------- */

/* Messages to a dead node are lost. */
inline act(k, w, x, y)
{
	if
	:: has(is_up, k) -> assert(nfull(down[k])); down[k]!w, x, y
	:: else
	fi
}

inline send_row(k, r, from)
{
	act(k, TASK, r, from);
	at[r] = k
}

inline take_up(k)
{
	is_up = with(is_up, k); met = with(met, k);
	act(k, PLACE, 0, 0);
	a = 0;
	do
	:: a < ROWS ->
		if
		:: home(a) == k && !has(sent, a) -> sent = with(sent, a); send_row(k, a, NONE_OF)
		:: else
		fi;
		a++
	:: else -> break
	od
}

/* When all rows are computed, the master asks for the pixels that are missing. */
inline ends()
{
	if
	:: !asked_all && (computed | complete) == EVERY && complete != EVERY ->
		asked_all = true;
		a = does_not_ask_node_0_for_pixels;
		do
		:: a < N -> act(a, FLUSH, 0, 0); a++
		:: else -> break
		od
	:: else
	fi;
	over = (complete | computed * master_ends_when_all_is_computed) == EVERY;
	assert(!over || complete == EVERY);
	a = 0; b = 0; c = 0; d = 0
}

inline take_done(r)
{
	if
	:: !has(complete, r) -> asked_all = false; computed = with(computed, r)
	:: else
	fi
}

inline take_pixels(r)
{
	computed = without(computed, r); complete = with(complete, r)
}

inline take_give(k, r, peer)
{
	if
	:: !has(complete, r) -> send_row(peer, r, k); given = with(given, r)
	:: else
	fi
}

/* The rows of the table that phase 1 assigned to dead. */
inline take_crashed(heir, dead)
{
	reported = with(reported, dead);
	act(heir, HEIR, dead, after(dead));
	a = 0;
	do
	:: a < ROWS ->
		if
		:: home(a) == dead && !has(complete, a) ->
			a_slow_row_looks_like_a_crash = HAZARD(3) && has(is_up, dead) && at[a] == dead;
			assert(!a_slow_row_looks_like_a_crash);
			two_detectors_both_take_over = HAZARD(6) && has(is_up, at[a]) && at[a] != heir && !has(given, a);
			assert(!two_detectors_both_take_over);
			asked_all = false; computed = without(computed, a); sent = with(sent, a);
			send_row(heir, a, dead)
		:: else
		fi;
		a++
	:: else -> break
	od
}

/* ---- a node ------------------------------------------------------------------------------------- */

#define me (_pid)

/* How far up the ring from this node */
#define distance(k) (((k) + N - me) % N)

inline search_on(k)
{
	next = k; found = false; waits = without(waits, me); early = false
}

/* row = the first of the set */
inline first(set)
{
	row = 0;
	do
	:: has(set, row) -> break
	:: else -> row++
	od
}

/* A node answers when its worker computes no row, or has just done one. */
inline answer_all(done)
{
	a = 0;
	do
	:: a < N ->
		if
		:: has(askers[me], a) && (done || !fed) ->
			askers[me] = without(askers[me], a);
			if
			:: queue ->
				d = ROWS - 1;
				do
				:: has(queue, d) -> break
				:: else -> d--
				od;
				queue = without(queue, d); kept = without(kept, d);
				take_give(me, d, a)
			:: !queue && !fed && found -> act(a, NONE, me, next)
			:: else -> act(a, NONE, me, NONE_OF)
			fi
		:: else
		fi;
		a++
	:: else -> break
	od
}

/* Ends every step of a node. */
inline goes_on(done)
{
	if
	:: !fed && queue -> first(queue); queue = without(queue, row); fed = with(fed, row)
	:: else
	fi;
	answer_all(done);
	if
	:: placed && !fed && !queue && !has(waits, me) && !early && next != me ->
		waits = with(waits, me);
		act(next, ASK, me, 0)
	:: else
	fi;
	if
	:: flush && !queue && !fed -> out = out | kept; kept = 0; flush = false
	:: else
	fi;
	row = 0; peer = 0; ends()
}

active [N] proctype node()
{
	byte queue, fed, kept, out;       /* kept: computed, pixels held back; out: pixels under way */
	bool placed, early, flush, found; /* early: no row of phase 1 has come yet */
	byte next, row, peer;
	mtype what;

end_opening:
	if
	:: d_step { began && !over -> take_up(me); ends() }
	:: d_step { began && !over && crashes > 0 -> crashes--; died = with(died, me) } goto end_closed
	fi;
end_open:
	do
	:: d_step { !over && nempty(down[me]) ->
		down[me]?what, row, peer;
		if
		:: what == TASK ->
			if
			:: has(queue | fed, row)
			:: else -> queue = with(queue, row)
			fi;
			if
			:: peer == NONE_OF -> search_on(after(me))
			:: else
			fi;
			found = found || (has(waits, me) && peer == next);
			waits = without(waits, me); early = false
		:: what == ASK -> askers[me] = with(askers[me], row)
		:: what == NONE && has(waits, me) && row == next ->
			if
			:: peer != NONE_OF && distance(peer) > distance(next) -> search_on(peer)
			:: else -> next = (asks_the_same_node_again_after_none -> next : after(next)); search_on(next)
			fi
		:: what == NONE && (!has(waits, me) || row != next)
		:: what == HEIR && has(waits, me) && row == next -> search_on(peer)
		:: what == HEIR && (!has(waits, me) || row != next)
		:: what == FLUSH -> flush = true
		:: what == PLACE && !placed -> placed = true; search_on(after(me)); early = true
		:: what == PLACE && placed
		fi;
		what = 0;
		goes_on(false) }
	:: d_step { !over && fed ->
		first(fed); fed = 0;
		take_done(row);
		if
		:: row >= KEPT -> take_pixels(row)
		:: else -> kept = with(kept, row)
		fi;
		goes_on(true) }
	:: d_step { !over && out ->
		first(out); out = without(out, row); queue = without(queue, row);
		take_pixels(row);
		goes_on(false) }
	:: d_step { !over && early -> early = false; goes_on(false) }
	:: d_step { !over && has(waits, me) && has(died, next) && !has(is_up, next) && empty(down[me]) ->
		take_crashed(me, next); ends() }
	:: d_step { !over && has(waits, me) && slow > 0 -> slow--; take_crashed(me, next); ends() }
	:: d_step { !over && has(waits, me) && has(is_up, next) && empty(down[me]) && !has(askers[next], me) &&
		!down[next]??[ASK, eval(me), 0] -> act(next, ASK, me, 0); a = 0 }
	:: d_step { !over && crashes > 0 ->
		crashes--; is_up = without(is_up, me); died = with(died, me); waits = without(waits, me);
		queue = 0; fed = 0; kept = 0; out = 0; placed = false; early = false; flush = false; found = false;
		next = 0; askers[me] = 0;
		do
		:: nempty(down[me]) -> down[me]?_, _, _
		:: empty(down[me]) -> break
		od;
		row = 0 }
		goto end_closed
	od;
end_closed:
	if
	:: d_step { !over && returns > 0 -> returns--; take_up(me); ends() } goto end_open
	fi
}

/* A link between nodes that loses its next message. */
active proctype loss()
{
	byte k;
end:
	do
	:: d_step { !over && loses > 0 && nempty(down[0]) && !down[0]?[PLACE, _, _] && !down[0]?[FLUSH, _, _] &&
		!down[0]?[TASK, _, NONE_OF] -> down[0]?_, _, _; loses-- }
	:: d_step { !over && loses > 0 && nempty(down[1]) && !down[1]?[PLACE, _, _] && !down[1]?[FLUSH, _, _] &&
		!down[1]?[TASK, _, NONE_OF] -> down[1]?_, _, _; loses-- }
	od
}

/* When no step is possible any more, the run has ended; otherwise an assertion says why, for each missing row. */
active proctype watch()
{
	byte r;
	d_step {
		c_code {
			hazard = given_as("HAZARD");
			MUTANT(asks_the_same_node_again_after_none);
			MUTANT(does_not_ask_node_0_for_pixels);
			MUTANT(master_ends_when_all_is_computed);
			now.crashes = given_as("CRASHES"); now.returns = given_as("RETURNS");
			now.loses = given_as("LOSES"); now.slow = given_as("SLOW");
		};
		began = true }
accept_end:
	timeout ->
	d_step {
		do
		:: !over && r < ROWS ->
			a = home(r); b = at[r];
			if
			:: has(complete, r) || has(computed, r) /* its node waits for the others */
			:: else ->
				a_node_that_ended_early = HAZARD(1) && has(died, a) && !has(is_up | reported, a) && b == a;
				a_stolen_row_whose_thief_dies = HAZARD(2) && !has(died, a) && b != a && has(died, b);
				a_lost_answer = HAZARD(4) && !died;
				the_heir_may_be_dead = HAZARD(5) && has(reported, a) && b != a && has(died, b) && !has(given, r);
				a_node_that_returns_hides_its_loss =
					HAZARD(7) && has(died & is_up, a) && !has(reported, a) && b == a;
				assert(!a_node_that_ended_early);
				assert(!a_stolen_row_whose_thief_dies);
				assert(!a_lost_answer);
				assert(!the_heir_may_be_dead);
				assert(!a_node_that_returns_hides_its_loss)
			fi;
			r++
		:: else -> break
		od;
		assert(hazard || over) }
}
