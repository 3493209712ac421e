/*
 * The ring by default, for spin: the hub (lib/sched/hub.c, hub_match.c), the nodes (node.c) and the links
 * between them. Functions of C have their names here. tests/55_models.t runs it.
 *
 *     spin -a ring.pml && cc -O1 -DNOREDUCE -DNOFAIR -o pan pan.c && CRASHES=2 ./pan -a
 *
 * These hold in every order of the steps:
 *
 * - A row is committed once.
 * - An uncommitted row has an owner that is up, or waits for a node that may come up.
 * - The run does not end before all rows are committed.
 * - When no step is possible any more, the run has ended.
 * - No state comes twice, so every run ends. (Until the end, watch accepts all states, and -a finds every cycle.)
 *
 * At any moment a node may die, at most CRASHES times, and reconnect, at most RETURNS times. So faults stop. Links are
 * FIFO. When a node dies, its link loses messages from the first one up to any other; the next connection gets the
 * rest. Messages from a node need no states: a node acts on others only through its one link, so a message that arrives
 * late is a step taken late, and a message lost with the connection was never sent. Pixels may be held back until a
 * flush. When a node dies, its pixels are lost or come late.
 *
 * At most LATE answers take too long, at any moment, of any node.
 *
 * Left out:
 *
 * - Time. The hub asks the next node that has rows, not the one with most work. A node that is asked gives nothing, or
 *   half of its queue, whatever the costs. A node may ask ahead once while its worker computes a row. (In C it asks
 *   when the rest of the row takes as long as an ask.) The hub sends no NONE to nodes that wait, which use it to measure
 *   time.
 * - The worker behind the node, and its pipe.
 * - Frames, and pieces of a row.
 */
/* One verifier for all cases: the environment says which faults to try, and MUTANT which mutant of the rules. */
c_decl {
	\#include <stdlib.h>
	\#include <string.h>
	static long given_as(const char *name) { return getenv(name) ? strtol(getenv(name), NULL, 10) : 0; }
	static int is_mutant(const char *name) { return getenv("MUTANT") && strcmp(getenv("MUTANT"), name) == 0; }
}
/* Mutants: bugs that the verifier must find. Those of tests/mutants/ring have the same names there. */
#define MUTANT(name) name = is_mutant(#name)
hidden byte asks_while_its_worker_computes, counts_a_gift_from_a_node_that_does_not_own_the_task,
	does_not_ask_a_node_again_for_pixels_of_later_tasks, does_not_send_a_node_the_tasks_that_waited_for_it,
	forgets_computed_tasks_of_a_lost_node, forgets_held_tasks_of_a_lost_node,
	hub_ends_when_all_is_computed, ignores_a_computed_task_that_comes_again, ignores_a_gift_of_a_computed_row,
	ignores_a_gift_that_comes_late, takes_a_void_gift_for_no_answer;
#define N 3
#define ROWS 4
#define EARLY 3 /* rows that exist at the start; the others come at any time */
#define KEPT 1 /* the first rows, whose pixels are held back */
#define LINK 8 /* messages on a link */

#define NONE_OF N /* -1 in C */
#define bit(i) (1 << (i))
#define has(set, i) (((set) >> (i)) & 1)
#define with(set, i) ((set) | bit(i))
#define without(set, i) ((set) & (255 - bit(i)))
#define EVERY (bit(ROWS) - 1)
/* Of sets of up to four members: the number of members; the first member of a set that is not empty. */
#define size(set) (has(set, 0) + has(set, 1) + has(set, 2) + has(set, 3))
#define first(set) (has(set, 0) -> 0 : (has(set, 1) -> 1 : (has(set, 2) -> 2 : 3)))
/* Of sets of nodes: the first member after k, or before k; k itself comes last. NONE_OF if the set is empty. */
#define at_or(set, k, or) (has(set, k) -> (k) : or)
#define set_after(set, k) at_or(set, ((k) + 1) % N, at_or(set, ((k) + 2) % N, at_or(set, k, NONE_OF)))
#define set_before(set, k) at_or(set, ((k) + 2) % N, at_or(set, ((k) + 1) % N, at_or(set, k, NONE_OF)))

mtype = { TASK, FLUSH, PLACE, ASK };

chan down[N] = [LINK] of { mtype, byte }; /* TASK row; ASK for peer; FLUSH; PLACE */
byte crashes, returns, late_answers; /* that may still happen */
byte strays; /* rows whose pixels outlived their connection */
byte came;   /* rows that have come in */
bool began, input_ended, over; /* over: the hub has sent END */

/* The ledger. held: rows not computed; computed: rows whose pixels are missing; owned: rows of each node, and of the
   pool at NONE_OF. */
byte held, computed, owned[N + 1];
/* The hub's knowledge of the nodes, as sets. given: thieves whose victim has got a row since it was asked. */
byte is_up, gone, asking, dry, silent, flushed, given, hungry, rich, late;
byte victim[N] = NONE_OF; /* of a node: the node that was asked for it and has not answered */
byte committed; /* for watch */

hidden byte a, b, c, d, e, f;

/* ---- the hub ------------------------------------------------------------------------------------ */

inline act(to, w, arg)
{
	assert(nfull(down[to]));
	down[to]!w, arg
}

inline put(set, k, member)
{
	set = ((member) -> with(set, k) : without(set, k))
}

#define thieves(k) ((victim[0] == (k)) + (victim[1] == (k)) + (victim[2] == (k)))

inline hub_mark(k)
{
	put(late, k, !has(is_up | gone, k) && held & owned[k]);
	put(hungry, k, has(is_up & asking, k) && victim[k] == NONE_OF);
	put(rich, k, has(is_up & ~(asking | dry | silent), k) && size(held & owned[k]) > 1 + thieves(k))
}

inline pair(k, thief)
{
	victim[thief] = k; given = without(given, thief);
	hub_mark(k); hub_mark(thief)
}

/* Uses d. */
inline part(thief)
{
	d = victim[thief];
	if
	:: d != NONE_OF -> victim[thief] = NONE_OF; hub_mark(d); hub_mark(thief)
	:: else
	fi
}

/* Nodes that wait for an answer of k must ask another node. Uses e. */
inline pass_on(k)
{
	e = 0;
	do
	:: e < N && victim[e] == k -> part(e); e++
	:: e < N && victim[e] != k -> e++
	:: else -> break
	od
}

/* An answer of k takes too long. k may be out of reach, or not. */
inline ring_late(k)
{
	late_answers--;
	silent = with(silent, k);
	pass_on(k);
	hub_mark(k)
}

inline note_life(k)
{
	silent = without(silent, k);
	hub_mark(k)
}

/* Node k, or the pool, owns row r. */
inline enlist(r, k)
{
	owned[0] = without(owned[0], r); owned[1] = without(owned[1], r);
	owned[2] = without(owned[2], r); owned[3] = without(owned[3], r);
	owned[k] = with(owned[k], r); held = with(held, r); computed = without(computed, r)
}

inline send(k, r)
{
	put(flushed, k, does_not_ask_a_node_again_for_pixels_of_later_tasks && has(flushed, k));
	act(k, TASK, r);
	asking = without(asking, k);
	dry = without(dry, k);
	given = given | (victim[0] == k) | (victim[1] == k) << 1 | (victim[2] == k) << 2;
	part(k);
	hub_mark(k)
}

inline assign(r, k)
{
	c = (has(gone, k) -> set_before(is_up, k) : (k));
	enlist(r, c);
	if
	:: c != NONE_OF && has(is_up, c) -> send(c, r)
	:: c != NONE_OF && !has(is_up, c) -> hub_mark(c)
	:: else
	fi
}

/* The hub gives away the first half of the rows that wait for a node that is not up yet. */
inline give_late()
{
	do
	:: hungry && late ->
		b = set_after(late, set_after(hungry, N - 1));
		a = set_before(hungry, b);
		f = (size(held & owned[b]) + 1) / 2;
		do
		:: f > 0 -> f--; e = first(held & owned[b]); enlist(e, a); send(a, e)
		:: else -> break
		od;
		hub_mark(b)
	:: else -> break
	od
}

inline ring_match()
{
	give_late();
	do
	:: hungry && rich ->
		b = set_after(rich, set_after(hungry, N - 1));
		a = set_before(hungry, b);
		pair(b, a);
		act(b, ASK, a)
	:: else -> break
	od;
	a = 0; b = 0; d = 0; e = 0
}

inline ask_flush(k)
{
	if
	:: input_ended && has(is_up & ~flushed, k) && !(held & owned[k]) && (computed & owned[k]) ->
		flushed = with(flushed, k);
		act(k, FLUSH, 0)
	:: else
	fi
}

inline take_up(k)
{
	is_up = with(is_up, k); gone = without(gone, k);
	hub_mark(k);
	a = 0;
	do
	:: a < ROWS ->
		if
		:: has(held & owned[k], a) && !does_not_send_a_node_the_tasks_that_waited_for_it -> send(k, a)
		:: has(owned[NONE_OF], a) -> assign(a, k)
		:: else
		fi;
		a++
	:: else -> break
	od;
	act(k, PLACE, 0)
}

inline take_gone(k)
{
	is_up = without(is_up, k); gone = with(gone, k);
	asking = without(asking, k); dry = without(dry, k); silent = without(silent, k);
	part(k);
	pass_on(k);
	hub_mark(k);
	a = 0;
	do
	:: a < ROWS ->
		if
		:: has(owned[k] & (held * !forgets_held_tasks_of_a_lost_node |
			computed * !forgets_computed_tasks_of_a_lost_node), a) -> assign(a, k)
		:: else
		fi;
		a++
	:: else -> break
	od
}

inline take_done(k, r)
{
	if
	:: has(owned[k], r) && has(is_up, k) ->
		if
		:: has(computed, r) -> flushed = without(flushed, k)
		:: else
		fi;
		held = without(held, r); computed = with(computed, r);
		dry = without(dry, k);
		hub_mark(k);
		ask_flush(k)
	:: else
	fi
}

inline take_pixels(r)
{
	if
	:: has(held | computed, r) ->
		assert(!has(committed, r));
		committed = with(committed, r);
		a = (has(owned[0], r) -> 0 : (has(owned[1], r) -> 1 : (has(owned[2], r) -> 2 : NONE_OF)));
		owned[a] = without(owned[a], r); held = without(held, r); computed = without(computed, r);
		if
		:: a != NONE_OF -> hub_mark(a); ask_flush(a)
		:: else
		fi
	:: else
	fi
}

inline ring_has_none(k, peer)
{
	if
	:: victim[peer] == k ->
		put(dry, k, !has(given, peer));
		part(peer);
		hub_mark(k)
	:: else
	fi
}

inline take_give(k, r, peer)
{
	if
	:: has(owned[k] & ~(computed * ignores_a_gift_of_a_computed_row), r) &&
		(!ignores_a_gift_that_comes_late || victim[peer] == k) ||
		(counts_a_gift_from_a_node_that_does_not_own_the_task && has(held | computed, r)) -> assign(r, peer)
	:: else ->
		if
		:: !takes_a_void_gift_for_no_answer -> ring_has_none(k, peer)
		:: else
		fi
	fi;
	assert(victim[peer] != k); /* the node that asked waits for no answer any more */
	hub_mark(k);
	ask_flush(k)
}

/* Ends every step, and checks what must hold after it. */
inline ends()
{
	ring_match();
	assert(!(held & computed) && (owned[0] | owned[1] | owned[2] | owned[3]) == (held | computed));
	assert(!(owned[0] * has(gone, 0) | owned[1] * has(gone, 1) | owned[2] * has(gone, 2)));
	assert(!owned[NONE_OF] || !is_up);
	if
	:: input_ended && !held && (!computed || hub_ends_when_all_is_computed) ->
		assert(committed == EVERY);
		over = true
	:: else
	fi;
	c = 0
}

/* Rows that come in, and pixels that outlived their connection. */
active proctype input()
{
	d_step {
		c_code {
			now.crashes = given_as("CRASHES"); now.late_answers = given_as("LATE");
			MUTANT(asks_while_its_worker_computes);
			MUTANT(counts_a_gift_from_a_node_that_does_not_own_the_task);
			MUTANT(does_not_ask_a_node_again_for_pixels_of_later_tasks);
			MUTANT(does_not_send_a_node_the_tasks_that_waited_for_it);
			MUTANT(forgets_computed_tasks_of_a_lost_node);
			MUTANT(forgets_held_tasks_of_a_lost_node);
			MUTANT(hub_ends_when_all_is_computed);
			MUTANT(ignores_a_computed_task_that_comes_again);
			MUTANT(ignores_a_gift_of_a_computed_row);
			MUTANT(ignores_a_gift_that_comes_late);
			MUTANT(takes_a_void_gift_for_no_answer);
		};
		returns = (crashes == 1);
		do /* these rows exist when the nodes come up */
		:: came < EARLY -> assign(came, came % N); came++
		:: else -> break
		od;
		input_ended = (EARLY == ROWS);
		b = 0;
		do /* with crashes, all nodes are up from the start; without, they come up at any time */
		:: crashes && b < N -> take_up(b); b++
		:: else -> break
		od;
		began = true;
		ends() }
end:
	do
	:: d_step { !over && came < ROWS -> assign(came, came % N); came++; ends() }
	:: d_step { !over && came == ROWS && !input_ended ->
		input_ended = true;
		a = 0;
		do
		:: a < N -> ask_flush(a); a++
		:: else -> break
		od;
		ends() }
	:: d_step { !over && strays ->
		b = first(strays);
		strays = without(strays, b);
		take_pixels(b);
		ends() }
	:: d_step { !over && late_answers && thieves(0) -> ring_late(0); ends() }
	:: d_step { !over && late_answers && thieves(1) -> ring_late(1); ends() }
	:: d_step { !over && late_answers && thieves(2) -> ring_late(2); ends() }
	od
}

/* ---- a node ------------------------------------------------------------------------------------- */

#define me (_pid - 1)

inline says_ask()
{
	asked = true; asking = with(asking, me);
	note_life(me);
	ring_match()
}

/* The worker gets one row; rule 1; an idle node sends the pixels that it held back. */
inline feed()
{
	if
	:: queue && !fed -> row = first(queue); queue = without(queue, row); fed = bit(row)
	:: else
	fi;
	if
	:: placed && !asked && !queue && (!fed || asks_while_its_worker_computes) -> says_ask()
	:: else
	fi;
	if
	:: flush && !queue && !fed -> sent = sent | kept; kept = 0; flush = false
	:: else
	fi;
	row = 0
}

/* Rules 2 and 3: the first half of the queue. */
inline answer(peer)
{
	e = (size(queue) + 1) / 2; d = 0;
	do
	:: e > 0 ->
		if
		:: has(queue, d) -> queue = without(queue, d); gives = with(gives, d); e--
		:: else
		fi;
		d++
	:: else -> break
	od;
	kept = kept & ~gives; /* fan takes no pixels of rows that were given away */
	to = peer; d = 0;
	feed()
}

active [N] proctype node()
{
	byte queue, fed, kept, sent; /* kept: computed, pixels held back; sent: pixels under way */
	bool placed, asked, flush;
	bool ahead; /* it has asked while its worker computed this row */
	/* Before any other step it sends these to node `to`: NONE, or GIVEs one by one. */
	bool none;
	byte gives, to;
	byte row;
	mtype what;

end_opening:
	if
	:: has(is_up, me) -> goto end_open
	:: d_step { !over && began && !has(is_up, me) -> take_up(me); ends() }
	:: d_step { !over && began && !has(is_up, me) && crashes > 0 -> crashes--; take_gone(me); ends() } goto end_closed
	fi;
end_open:
	do
	:: d_step { !over && gives -> row = first(gives); gives = without(gives, row);
		note_life(me); take_give(me, row, to); ends(); row = 0; to = to * (gives > 0) }
	:: d_step { !over && none -> none = false; note_life(me); ring_has_none(me, to); ends(); to = 0 }
	:: d_step { !over && sent -> row = first(sent); sent = without(sent, row); queue = without(queue, row);
		take_pixels(row); ends(); feed() }
	:: d_step { !over && !gives && !none && fed ->
		row = first(fed); fed = 0; ahead = false;
		note_life(me);
		take_done(me, row);
		if
		:: row >= KEPT -> take_pixels(row)
		:: else -> kept = with(kept, row)
		fi;
		ends();
		feed() }
	:: d_step { !over && !gives && !none && placed && !asked && !queue && fed && !ahead ->
		ahead = true; says_ask(); ends() }
	:: d_step { !over && !gives && !none && nempty(down[me]) ->
		down[me]?what, row;
		if
		:: what == TASK ->
			asked = false;
			if
			:: has(queue | fed | kept * ignores_a_computed_task_that_comes_again, row)
			:: else -> queue = with(queue, row)
			fi
		:: what == ASK -> none = placed; to = row * placed
		:: what == FLUSH -> flush = true
		:: what == PLACE -> placed = true
		fi;
		what = 0;
		feed() }
	:: d_step { !over && none && !asked && queue -> none = false; answer(to) }
	:: d_step { !over && crashes > 0 ->
		crashes--; take_gone(me); ends();
		queue = 0; fed = 0; placed = false; asked = false; ahead = false; flush = false;
		none = false; gives = 0; to = 0 }
		goto dying
	od;
dying:	atomic {
		if
		:: kept | sent -> strays = strays | kept | sent
		:: true
		fi;
		kept = 0; sent = 0;
		do
		:: nempty(down[me]) -> down[me]?_, _
		:: returns > 0 || empty(down[me]) -> break
		od }
end_closed:
	if
	:: d_step { !over && returns > 0 -> returns--; take_up(me); ends() } goto end_open
	fi
}

active proctype watch()
{
accept_end:
	timeout -> assert(over)
}
