/*
 * Where the ring as published fails: a small fixed plan for each hazard that ringctl(1) lists. It
 * shows with the published rules, for the reason stated, and not with the default ones.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "../oracles/oracles.h"
#include "sim/sim.h"

#include <string.h>

#define MS 1000
#define NODES_MOST 8
#define ROWS_MOST 64

/* ---- plans ----------------------------------------------------------------------------------- */

/* Nodes of power 1, 10 ms from the hub; rows in the order in which they are added. */
struct hazard {
    int32_t nodes, rows;
    struct task row[ROWS_MOST];
    double row_us[ROWS_MOST];
    struct sim_fault fault[4];
    size_t faults;
    struct sim_plan more; /* what else the plan has */
};

/* So many rows of node k; returns the first. */
static int32_t add_rows(struct hazard *h, int32_t k, int32_t count, double ms)
{
    int32_t first = h->rows;
    for (int32_t i = 0; i < count; i++) {
        uint32_t y = (uint32_t)h->rows++;
        h->row[y] = (struct task){0, y, {0, y, 1, 1, 1, 1}, k, 0};
        h->row_us[y] = ms * MS;
    }
    return first;
}

static void add_fault(struct hazard *h, enum sim_fault_kind kind, int32_t k, int64_t at_ms)
{
    h->fault[h->faults++] = (struct sim_fault){.kind = kind, .slot = k, .at_us = at_ms * MS};
}

/* ---- what the hub sees ----------------------------------------------------------------------- */

struct seen {
    struct sim_result r;
    int32_t computed[ROWS_MOST];      /* how often a node reported it */
    bool gave[NODES_MOST][ROWS_MOST]; /* node k gave that row to another one */
    int32_t holder[ROWS_MOST];        /* the node it was sent to last */
    int32_t came_back;                /* a row that went back to a node that gave it away; -1 */
    int64_t waited_us;                /* the time since that node had asked */
    int64_t asked_us[NODES_MOST];     /* the latest time */
    bool committed[ROWS_MOST];
    int32_t last;                /* the last row that was committed */
    int32_t reports[NODES_MOST]; /* how often node k was reported dead */
    int32_t heirs[NODES_MOST];   /* the number of its heirs */
    bool lost[NODES_MOST];       /* node k is; and the time of: */
    int64_t lost_us, said_us;    /* the latest loss; the latest word of a node */
};
static struct seen *seen;
static const struct policy *inner;

static void note_event(const struct sched_event *e, int64_t now)
{
    if (e->kind == SCHED_GONE) {
        seen->lost[e->slot] = true;
        seen->lost_us = now;
    }
    if (e->kind == SCHED_DONE) seen->computed[e->task.id]++;
    if (e->kind != SCHED_RING) return;
    seen->said_us = now;
    if (e->ring.kind == RING_ASK) seen->asked_us[e->slot] = now;
    if (e->ring.kind == RING_GIVE) seen->gave[e->slot][e->task.id] = true;
    if (e->ring.kind == RING_CRASHED) seen->reports[e->ring.peer]++;
}

static void note_action(const struct sched_action *a, int64_t now)
{
    uint32_t y = a->task.id;
    if (a->kind == SCHED_SAY && a->ring.kind == RING_HEIR) seen->heirs[a->ring.peer]++;
    if (a->kind == SCHED_COMMIT) {
        seen->committed[y] = true;
        seen->last = (int32_t)y;
    }
    if (a->kind != SCHED_GIVE) return;
    if (seen->gave[a->slot][y]) {
        seen->came_back = (int32_t)y;
        seen->waited_us = now - seen->asked_us[a->slot];
    }
    seen->holder[y] = a->slot;
}

static void watched_step(
    void *state, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    size_t first = out->n;
    note_event(e, now);
    inner->step(state, e, now, out);
    for (size_t i = first; i < out->n; i++) note_action(&out->at[i], now);
}

static void run(struct hazard *h, bool published, struct seen *s)
{
    static const double power[NODES_MOST] = {1, 1, 1, 1, 1, 1, 1, 1};
    const struct sim_work work = {.frame_w = 1,
        .frame_h = (uint32_t)h->rows,
        .tasks = h->row,
        .pixel_us = h->row_us,
        .power = power};
    struct sim_plan p = h->more;
    p.node = &policy_node;
    p.checks = published ? &oracle_gdc : &oracle_ring;
    p.slots = h->nodes;
    p.tasks = h->rows;
    p.width = 1;
    p.link.latency_us = 10 * MS;
    p.hops = 2;
    if (!p.silence_us) p.silence_us = 10000 * MS;
    p.faults = h->fault;
    p.n_faults = h->faults;
    p.work = &work;
    if (!published) p.p_lose = p.p_double = p.p_late = 0; /* pipes do none of that */
    inner = published ? &policy_published : &policy_ring;
    struct policy watched = *inner;
    watched.step = watched_step;
    *s = (struct seen){.came_back = -1, .last = -1};
    seen = s;
    sim_run(&watched, &p, &s->r);
    seen = NULL;
}

/* As published: it never ends, and exactly this row is missing (or more after it). */
static void never_ends(const struct seen *s, const struct hazard *h, int32_t from)
{
    assert_true(strncmp(s->r.failure, "the run did not end", 19) == 0);
    for (int32_t y = 0; y < h->rows; y++) assert_int_equal(s->committed[y], y < from);
}

static void by_default_it_ends(struct hazard *h, bool each_once)
{
    struct seen s;
    run(h, false, &s);
    if (*s.r.failure) print_error("by default: %s\n", s.r.failure);
    assert_true(!*s.r.failure && s.r.uncommitted == 0);
    if (each_once) assert_int_equal(s.r.computed, s.r.commits);
}

static int32_t computed_twice(const struct seen *s)
{
    int32_t n = 0;
    for (int32_t y = 0; y < ROWS_MOST; y++) n += s->computed[y] > 1;
    return n;
}

/* ---- the hazards ----------------------------------------------------------------------------- */

/* Node 1 says that it has none to give while it is on its last row; node 0 ends; node 1 dies. */
static void a_node_that_ended_early_takes_no_work_that_reappears(void **state)
{
    struct hazard h = {.nodes = 2};
    struct seen s;
    (void)state;
    add_rows(&h, 0, 1, 200);
    add_rows(&h, 1, 1, 400);
    int32_t last = add_rows(&h, 1, 1, 3000);
    add_fault(&h, SIM_CRASH, 1, 1000);
    run(&h, true, &s);
    never_ends(&s, &h, last);
    assert_true(!s.lost[0] && s.reports[1] == 0); /* node 0 lives, and says nothing any more */
    assert_true(s.said_us < s.lost_us);
    by_default_it_ends(&h, true);
}

/* Node 0 steals the last row of node 1, and dies of it: the table has it as a row of node 1. */
static void a_stolen_row_whose_thief_dies_is_in_nobodys_account(void **state)
{
    struct hazard h = {.nodes = 2};
    struct seen s;
    (void)state;
    add_rows(&h, 0, 1, 200);
    add_rows(&h, 1, 2, 400);
    int32_t stolen = add_rows(&h, 1, 1, 3000);
    add_fault(&h, SIM_CRASH, 0, 1000);
    run(&h, true, &s);
    never_ends(&s, &h, stolen);
    assert_true(s.gave[1][stolen] && s.holder[stolen] == 0 && s.lost[0]);
    assert_true(
        s.heirs[0] == 1 && !s.lost[1]); /* node 1 found out, and what it was told was: none */
    by_default_it_ends(&h, true);
}

/* No fault at all: node 1 is on a row that is longer than four timeouts of node 0. */
static void a_slow_row_looks_like_a_crash_and_is_rendered_twice(void **state)
{
    struct hazard h = {.nodes = 2};
    struct seen s;
    (void)state;
    add_rows(&h, 0, 1, 100);
    int32_t slow = add_rows(&h, 1, 1, 10000);
    add_rows(&h, 1, 1, 4000);
    run(&h, true, &s);
    assert_true(!*s.r.failure && s.r.crashes == 0);
    assert_true(s.reports[1] == 1 && s.computed[slow] == 2);
    by_default_it_ends(&h, true);
}

/* The answer that brings a row is a datagram, and lost: node 1 has it no more, node 0 never. */
static void a_lost_answer_leaves_a_row_with_no_owner(void **state)
{
    struct hazard h = {.nodes = 2, .more = {.seed = 1, .p_lose = .2}};
    struct seen s;
    (void)state;
    add_rows(&h, 0, 1, 200);
    add_rows(&h, 1, 2, 400);
    int32_t stolen = add_rows(&h, 1, 1, 400);
    run(&h, true, &s);
    never_ends(&s, &h, stolen);
    assert_true(s.r.crashes == 0 && s.r.lost > 0 && s.r.passed == 1);
    by_default_it_ends(&h, true);
}

/* Node 2 dies; node 1 finds out, and dies while its rows are on the way; node 0 had ended. */
static void the_heir_may_be_dead_itself(void **state)
{
    struct hazard h = {.nodes = 3};
    struct seen s;
    (void)state;
    add_rows(&h, 0, 2, 100);
    add_rows(&h, 1, 1, 300);
    add_rows(&h, 1, 1, 500);
    add_rows(&h, 2, 1, 500);
    int32_t last = add_rows(&h, 2, 1, 4000);
    add_fault(&h, SIM_CRASH, 2, 600);
    add_fault(&h, SIM_CRASH, 1, 4835);
    run(&h, true, &s);
    never_ends(&s, &h, last);
    assert_true(s.heirs[2] == 1 && s.holder[last] == 1 && s.lost[1] && !s.lost[0]);
    by_default_it_ends(&h, false);
}

/* Nodes 0 and 1 both wait for node 2 when it dies, and both are told to take over all it had. */
static void two_detectors_both_take_over(void **state)
{
    struct hazard h = {.nodes = 3};
    struct seen s;
    (void)state;
    add_rows(&h, 0, 1, 100);
    add_rows(&h, 1, 1, 100);
    add_rows(&h, 2, 10, 400);
    add_fault(&h, SIM_CRASH, 2, 200);
    run(&h, true, &s);
    assert_true(!*s.r.failure && s.heirs[2] == 2);
    assert_true(computed_twice(&s) >= 8);
    by_default_it_ends(&h, true);
}

/* Node 1 is stopped for longer than four timeouts: node 0 takes over. Node 1 goes on as if nothing
 * had been. */
static void a_node_declared_dead_returns(void **state)
{
    struct hazard h = {.nodes = 2, .more = {.seed = 1}};
    struct seen s;
    (void)state;
    add_rows(&h, 0, 1, 100);
    add_rows(&h, 1, 12, 1000);
    add_fault(&h, SIM_PAUSE, 1, 200);
    run(&h, true, &s);
    assert_true(!*s.r.failure && s.r.pauses == 1 && s.r.crashes == 0);
    assert_true(s.heirs[1] == 1 && computed_twice(&s) >= 2);
    by_default_it_ends(&h, false); /* what it is on may be taken over, when that is late */
}

/* Node 1 dies and comes up again before it is missed. It answers, so its rows are not asked for. */
static void a_node_that_returns_before_it_is_missed_hides_its_loss(void **state)
{
    struct hazard h = {.nodes = 2, .more = {.seed = 1, .p_return = 1}};
    struct seen s;
    (void)state;
    add_rows(&h, 0, 1, 100);
    int32_t first = add_rows(&h, 1, 4, 1000);
    add_fault(&h, SIM_CRASH, 1, 200);
    run(&h, true, &s);
    never_ends(&s, &h, first);
    assert_true(s.r.returns == 3 && s.reports[1] == 0);
    by_default_it_ends(&h, true);
}

/* Node 0 asks three times while node 1 is on a long row, and is given three rows; then node 1 is
 * idle, asks for the last of them, and waits for it until node 0 is done with one. By default what
 * comes back comes at once. */
static void the_last_row_is_passed_round(void **state)
{
    struct hazard h = {.nodes = 2};
    struct seen s;
    (void)state;
    add_rows(&h, 0, 1, 100);
    add_rows(&h, 1, 1, 1400);
    add_rows(&h, 1, 1, 100);
    int32_t round = add_rows(&h, 1, 1, 1000);
    add_rows(&h, 1, 2, 1000);
    run(&h, true, &s);
    assert_true(!*s.r.failure && s.came_back == round && s.last == round);
    assert_true(s.gave[1][round] && s.gave[0][round] && s.holder[round] == 1);
    assert_true(s.waited_us > 800 * MS);
    run(&h, false, &s);
    assert_true(!*s.r.failure && s.waited_us < 100 * MS);
}

/* Messages for each time that a node that asked was brought a row, with four rows a node. */
static double messages_a_steal(const struct policy *policy, int32_t nodes)
{
    struct sim_result r;
    const struct sim_plan p = {.seed = 1,
        .node = &policy_node,
        .slots = nodes,
        .tasks = 4 * nodes,
        .rows = 1,
        .width = 1,
        .cost_us = 10 * MS,
        .link.latency_us = 500,
        .jitter = .5,
        .hops = 2,
        .silence_us = 10000 * MS};
    sim_run(policy, &p, &r);
    if (*r.failure) print_error("%d nodes: %s\n", nodes, r.failure);
    assert_true(!*r.failure && r.steals > nodes / 10);
    return (double)r.messages / (double)r.steals;
}

static void probing_costs_as_many_messages_a_row_as_there_are_nodes(void **state)
{
    (void)state;
    double published[2] = {
        messages_a_steal(&policy_published, 125), messages_a_steal(&policy_published, 1000)};
    double ours[2] = {messages_a_steal(&policy_ring, 125), messages_a_steal(&policy_ring, 1000)};
    print_message("# messages a steal, 125 and 1000 nodes: as published %.1f and %.1f; by default "
                  "%.1f and %.1f\n",
        published[0], published[1], ours[0], ours[1]);
    assert_true(published[1] > 1000 / 8 && published[1] > 4 * published[0]);
    assert_true(ours[1] < 2 * 10 && ours[1] < 2 * ours[0]); /* log2(1000) is 10 */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_node_that_ended_early_takes_no_work_that_reappears),
        cmocka_unit_test(a_stolen_row_whose_thief_dies_is_in_nobodys_account),
        cmocka_unit_test(a_slow_row_looks_like_a_crash_and_is_rendered_twice),
        cmocka_unit_test(a_lost_answer_leaves_a_row_with_no_owner),
        cmocka_unit_test(the_heir_may_be_dead_itself),
        cmocka_unit_test(two_detectors_both_take_over),
        cmocka_unit_test(a_node_declared_dead_returns),
        cmocka_unit_test(a_node_that_returns_before_it_is_missed_hides_its_loss),
        cmocka_unit_test(the_last_row_is_passed_round),
        cmocka_unit_test(probing_costs_as_many_messages_a_row_as_there_are_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
