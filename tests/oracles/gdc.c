/*
 * Checks of the ring as published under all faults: the sender, receiver and time of each message.
 * They do not check that a run ends.
 */
#include "oracles.h"
#include "sim/world.h"

#include <stdlib.h>

#define REQUESTS_MOST 4 /* to one node without an answer, then a report */
#define OWED_MOST 4     /* answers, per node of the ring */
#define TIMEOUT_LEAST_US 500000

/* The checks' record of a node. The latest SLOTS, its first event, resets it. */
struct shadow {
    bool placed, began;         /* it has a PLACE; it has had a row */
    int64_t placed_us, step_us; /* time of its PLACE; of its latest step */
    int32_t asked;              /* the node asked last in this search; itself: none yet */
    int32_t requests;           /* unanswered requests to that node */
    int64_t asked_us;           /* time of the latest one */
    bool found;                 /* that node answered with a row last time */
    int32_t next; /* the node to ask next, if that one has none or is given up; -1: that one */
    int32_t owes; /* answers */
    int32_t queued, begun;
    bool done;    /* this step handles a row that is done */
    int32_t at[]; /* by slot: answers it owes to that slot; then by task: its place */
};
enum row { ELSEWHERE, QUEUED, BEGUN };

static struct shadow *shadow_of(struct world *w, int32_t k)
{
    size_t n = sizeof(struct shadow) + (size_t)(w->plan->slots + w->plan->tasks) * sizeof(int32_t);
    if (!w->slots[k].note) w->slots[k].note = xcalloc(1, n);
    return w->slots[k].note;
}

static int32_t *row_of(struct world *w, struct shadow *x, const struct task *t)
{
    bool known = t->frame == 0 && t->id < (uint32_t)w->plan->tasks;
    return known ? &x->at[w->plan->slots + (int32_t)t->id] : NULL;
}

static int32_t after(const struct world *w, int32_t k) { return (k + 1) % w->plan->slots; }
static int32_t distance(const struct world *w, int32_t from, int32_t to)
{
    return (to - from + w->plan->slots) % w->plan->slots;
}

/* ---- events of a node ------------------------------------------------------------------------ */

static void forget(struct world *w, int32_t k)
{
    free(w->slots[k].note);
    w->slots[k].note = NULL;
    shadow_of(w, k)->asked = k;
}

static void search_from(struct shadow *x, int32_t asked, int32_t next)
{
    x->asked = asked;
    x->next = next;
    x->requests = 0;
    x->found = false;
}

static void note_row(struct world *w, int32_t k, const struct sched_event *e)
{
    struct shadow *x = shadow_of(w, k);
    int32_t *row = row_of(w, x, &e->task);
    if (e->from < 0) search_from(x, k, after(w, k));
    else if (x->requests && e->from == x->asked) x->found = true;
    x->requests = 0;
    x->began = x->placed;
    if (!row || *row != ELSEWHERE) return;
    *row = QUEUED;
    x->queued++;
}

static void note_ring(struct world *w, int32_t k, const struct ring *r)
{
    struct shadow *x = shadow_of(w, k);
    bool answer = x->requests && r->peer == x->asked;
    if (r->kind == RING_PLACE && !x->placed) {
        x->placed = true;
        x->placed_us = w->now_us;
        search_from(x, k, after(w, k));
    }
    if (r->kind == RING_ASK && x->placed && x->owes < OWED_MOST * w->plan->slots) {
        x->at[r->peer]++;
        x->owes++;
    }
    if (r->kind == RING_HEIR && answer) search_from(x, x->asked, r->next);
    if (r->kind != RING_NONE || !answer) return;
    bool ahead = r->next >= 0 && distance(w, k, r->next) > distance(w, k, x->asked);
    search_from(x, x->asked, r->idle && ahead ? r->next : after(w, x->asked));
}

/* The state that the previous step must have left. */
static void check_left(struct world *w, int32_t k)
{
    const struct shadow *x = shadow_of(w, k);
    bool early = !x->began && x->step_us < x->placed_us + TIMEOUT_LEAST_US;
    bool idle = x->placed && !early && !x->queued && !x->begun, over = x->next == k;
    if (x->queued && !x->begun && x->placed) sim_fail(w, "a node has rows and begins none", k, 0);
    if (!x->begun && x->owes) sim_fail(w, "an idle node does not answer", k, x->owes);
    if (idle && !over && !x->requests && !w->ended)
        sim_fail(w, "an idle node does not ask", k, x->next);
}

static void node_event(struct world *w, int32_t k, const struct sched_event *e)
{
    if (e->kind == SCHED_SLOTS) forget(w, k);
    else if (e->kind == SCHED_RING || e->kind == SCHED_WAKE) check_left(w, k);
    struct shadow *x = shadow_of(w, k);
    x->step_us = w->now_us;
    x->done = e->kind == SCHED_DONE;
    if (e->kind == SCHED_TASK) note_row(w, k, e);
    if (e->kind == SCHED_RING) note_ring(w, k, &e->ring);
    int32_t *row = row_of(w, x, &e->task);
    if (e->kind != SCHED_DONE || !row || *row != BEGUN) return;
    *row = ELSEWHERE;
    x->begun--;
}

/* ---- what it does ---------------------------------------------------------------------------- */

/* The node asks again, or reports. */
static void check_again(struct world *w, int32_t k, const struct ring *r)
{
    const struct shadow *x = shadow_of(w, k);
    bool report = r->kind == RING_CRASHED;
    if (r->peer != x->asked) sim_fail(w, "a node asks another node before the answer", k, r->peer);
    if (report != (x->requests >= REQUESTS_MOST))
        sim_fail(w, "a crash is reported after the wrong number of requests", k, x->requests);
    if (w->now_us - x->asked_us < TIMEOUT_LEAST_US)
        sim_fail(w, "a request is repeated too soon", k, r->peer);
}

static void check_ask(struct world *w, int32_t k, const struct ring *r)
{
    struct shadow *x = shadow_of(w, k);
    int32_t next = x->next < 0 ? x->asked : x->next;
    if (x->queued || x->begun) sim_fail(w, "a node that has rows asks", k, x->queued);
    if (!x->began && w->now_us < x->placed_us + TIMEOUT_LEAST_US)
        sim_fail(w, "a node asks before phase 1", k, 0);
    if (r->peer == k) sim_fail(w, "a node asks itself", k, k);
    if (x->requests) check_again(w, k, r);
    else if (r->kind == RING_CRASHED)
        sim_fail(w, "a node reports one that it did not ask", k, r->peer);
    else if (r->peer != next) sim_fail(w, "a node asks the wrong node", k, r->peer);
    x->asked = r->peer;
    x->next = -1;
    x->requests++;
    x->asked_us = w->now_us;
}

static void check_answer(struct world *w, int32_t k, const struct sched_action *a)
{
    struct shadow *x = shadow_of(w, k);
    const struct ring *r = &a->ring;
    int32_t *row = row_of(w, x, &a->task);
    int32_t hint = !x->begun && x->found ? x->asked : -1;
    if (!x->at[r->peer]--) sim_fail(w, "a node answers one that did not ask", k, r->peer);
    x->owes--;
    if (x->begun && !x->done) sim_fail(w, "a node answers while it computes", k, r->peer);
    if (r->kind == RING_GIVE) {
        if (row && *row == QUEUED) {
            *row = ELSEWHERE;
            x->queued--;
        } else sim_fail(w, "a node gives a row that is not in its queue", k, a->task.id);
        return;
    }
    if (x->queued) sim_fail(w, "a node that has rows gives none", k, x->queued);
    if (r->idle != !x->begun)
        sim_fail(w, "an answer is wrong about whether the node is idle", k, r->idle);
    if (r->next != hint) sim_fail(w, "an answer names the wrong next node", r->next, hint);
}

static void node_action(struct world *w, int32_t k, const struct sched_action *a)
{
    struct shadow *x = shadow_of(w, k);
    int32_t *row = row_of(w, x, &a->task);
    if (a->kind == SCHED_GIVE && row && *row == QUEUED) {
        *row = BEGUN;
        x->queued--;
        x->begun++;
    } else if (a->kind == SCHED_GIVE)
        sim_fail(w, "a node begins a row that is not in its queue", k, a->task.id);
    if (a->kind != SCHED_SAY) return;
    if (a->ring.kind == RING_ASK || a->ring.kind == RING_CRASHED) check_ask(w, k, &a->ring);
    else check_answer(w, k, a);
}

/* ---- the master ------------------------------------------------------------------------------ */

static int32_t home_of(const struct world *w, const struct vtask *t)
{
    int32_t n = w->plan->slots;
    return t->to >= 0 && t->to < n ? t->to : (int32_t)(t->task.id % (uint32_t)n);
}

/* The event that the master handles; the messages and rows that it has sent for it. */
struct master {
    struct sched_event event;
    int32_t says, rows;
};

static struct master *master_of(struct world *w)
{
    if (!w->note) w->note = xcalloc(1, sizeof(struct master));
    return w->note;
}

static void event(struct world *w, const struct sched_event *e)
{
    *master_of(w) = (struct master){.event = *e};
}

/* Node to node unchanged; HEIR to the reporting node; PLACE to the node that came up. */
static void check_say(struct world *w, const struct sched_action *a)
{
    struct master *m = master_of(w);
    const struct ring *said = &m->event.ring, *r = &a->ring;
    int32_t from = m->event.slot;
    bool good = false;
    if (r->kind == RING_PLACE)
        good = m->event.kind == SCHED_UP && a->slot == from && r->me == from && r->published;
    else if (m->event.kind == SCHED_RING && r->kind == RING_HEIR)
        good = said->kind == RING_CRASHED && a->slot == from && r->peer == said->peer &&
               r->next == after(w, r->peer) && !m->rows;
    else if (m->event.kind == SCHED_RING)
        good = said->kind == r->kind && a->slot == said->peer && r->peer == from &&
               r->idle == said->idle && r->next == said->next;
    if (!good || m->says++)
        sim_fail(w, "the master forwards a message that no node sent", a->slot, r->kind);
}

/* In phase 1 to its node, once; or forwarded; or taken over. */
static void check_row(struct world *w, const struct sched_action *a)
{
    struct master *m = master_of(w);
    struct vtask *t = &w->tasks[a->task.id];
    const struct ring *said = &m->event.ring;
    bool good = false;
    if (a->from < 0) {
        good = a->slot == home_of(w, t) && !t->note;
        if (!t->note) t->note = xcalloc(1, 1);
    } else if (m->event.kind == SCHED_RING && said->kind == RING_GIVE)
        good = a->slot == said->peer && a->from == m->event.slot && !m->rows &&
               a->task.id == m->event.task.id;
    else if (m->event.kind == SCHED_RING && said->kind == RING_CRASHED)
        good = a->slot == m->event.slot && a->from == said->peer && a->from == home_of(w, t);
    if (!good || t->committed) sim_fail(w, "a row goes to the wrong node", a->slot, a->task.id);
    m->rows += a->from >= 0;
}

static void action(struct world *w, const struct sched_action *a)
{
    if (a->kind == SCHED_SAY) check_say(w, a);
    if (a->kind == SCHED_GIVE) check_row(w, a);
    if (a->kind != SCHED_SAY && a->kind != SCHED_GIVE) return;
    if (!w->slots[a->slot].up) sim_fail(w, "a message goes to a node that is not up", a->slot, 0);
}

/* All rows to be forwarded or taken over were sent. */
static void after_step(struct world *w)
{
    const struct master *m = master_of(w);
    const struct ring *said = &m->event.ring;
    if (m->event.kind != SCHED_RING || said->peer < 0 || said->peer >= w->plan->slots) return;
    bool report = said->kind == RING_CRASHED, give = said->kind == RING_GIVE;
    bool up = w->slots[report ? m->event.slot : said->peer].up;
    int32_t rows = give && !w->tasks[m->event.task.id].committed;
    for (int32_t i = 0; i < w->plan->tasks && report; i++) {
        const struct vtask *t = &w->tasks[i];
        rows += t->known && !t->committed && home_of(w, t) == said->peer;
    }
    if (m->rows != up * rows)
        sim_fail(w, "the master did not send the rows that it should", m->rows, rows);
    if (m->says != (up && !give))
        sim_fail(w, "the master did not forward a message", m->says, said->kind);
}

const struct sim_checks oracle_gdc = {.event = event,
    .action = action,
    .after = after_step,
    .node_event = node_event,
    .node_action = node_action};
