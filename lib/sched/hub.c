/*
 * The hub of the ring: it forwards messages between nodes over FIFO links, and keeps the ledger of
 * the owner of each task. It does not decide how many tasks are given, or which.
 *
 *   owner    of an uncommitted task              changes on
 *   pool     no known node could have it         SLOTS, UP of a node: -> node
 *   node     NEW: it waits here for the node;    GIVE of its owner: -> the other one
 *            UP: it was given to it              GONE: -> the next before it that is up, or pool;
 *                                                it is late: -> an idle node (hub_hung.c)
 *   (any)    -                                   the last PIXELS: committed
 *
 * A task starts at the node it is preassigned to, else at node id mod n. GIVE and DONE count only
 * from the owner; PIXELS count from any node. So messages of a lost connection are void. A task of
 * a lost connection may still reach the next node on that slot, which does not own it: at worst it
 * is computed once too often.
 *
 * The ledger alone ends the run.
 */
#include "sched/hub_int.h"

#include <stdlib.h>

#define COSTS 16384 /* observed costs that are kept: nodes are at different parts of the picture */

static void *ring_create(const struct sched_params *p)
{
    struct hub *h = xcalloc(1, sizeof *h);
    h->p = *p;
    tasks_init(&h->ledger, sizeof(struct hub_task));
    cost_init(&h->costs, COSTS);
    h->pool = h->rest = h->cut = h->aside = TASK_LIST_EMPTY;
    blame_init(&h->blame, p->losses);
    h->oldest = h->newest = h->stalest = h->freshest = -1;
    h->hung_us = h->end_us = h->return_us = INT64_MAX;
    return h;
}

static void ring_destroy(void *state)
{
    struct hub *h = state;
    if (!h) return;
    tasks_free(&h->ledger);
    blame_free(&h->blame);
    cost_free(&h->costs);
    hub_sets_free(h);
    free(h->early);
    free(h->nodes);
    free(h);
}

/* ---- tasks without owner --------------------------------------------------------------------- */

/* The pool goes to node k, the only one that is up (k >= 0); or each task to its first node,
 * once nodes are known (-1). */
static void take_pool(struct hub *h, int32_t k, struct sched_actions *out)
{
    for (int32_t left = h->pool.count; left > 0; left--) {
        int32_t i = h->pool.head;
        hub_unlist(h, i);
        if (k >= 0) hub_assign(h, i, k, out);
        else hub_start(h, i, out);
    }
}

/* ---- events ---------------------------------------------------------------------------------- */

static void take_task(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    if (tasks_find(&h->ledger, e->task.frame, e->task.id) >= 0) return; /* the same key again */
    int32_t i = hub_enter(h, &e->task, e->frame_w);
    if (h->n_nodes) hub_start(h, i, out);
    else hub_enlist(h, i, -1, false);
}

static void take_slots(struct hub *h, int32_t n, struct sched_actions *out)
{
    if (hub_set_nodes(h, n)) take_pool(h, -1, out);
}

/* Tasks come before PLACE, so that the node does not ask for tasks that are under way. */
static void take_up(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    int32_t k = e->slot;
    struct hub_node *s = &h->nodes[k];
    s->speed.us *= pace_power(&s->pace, e->power);
    if (hub_works(h, k)) {
        hub_mark(h, k);
        return;
    }
    s->state = NODE_UP;
    s->width = e->n > 1 ? e->n : 1;
    set_put(&h->up, k, true);
    hub_mark(h, k);
    for (int32_t i = s->held.head; i >= 0; i = h->ledger.at[i].next) hub_send(h, k, i, out);
    take_pool(h, k, out);
    sched_act(out, SCHED_SAY, k, NULL);
    out->at[out->n - 1].ring =
        (struct ring){.kind = RING_PLACE, .peer = -1, .next = -1, .me = k, .n = h->n_nodes};
}

static void take_gone(struct hub *h, int32_t k, struct sched_actions *out)
{
    struct hub_node *s = &h->nodes[k];
    struct task_list *lists[] = {&s->computed, &s->held};
    bool had = hub_works(h, k);
    if (had) hub_aside_blame(h, k, out);
    s->state = NODE_GONE;
    set_put(&h->up, k, false);
    refuse_end(&h->blame.refusals, k);
    hub_aside_settle(h, out);
    hub_lost(h, k);
    for (int l = 0; l < 2; l++)
        while (lists[l]->count) {
            hub_task(h, lists[l]->head)->tries += had;
            hub_hand_on(h, lists[l]->head, k, out);
        }
}

static void note_pace(struct hub *h, int32_t i, int64_t wall_us)
{
    const struct hub_task *t = hub_task(h, i);
    struct pace *pace = &h->nodes[t->owner].pace;
    const struct pace_task done = {.px = lattice_count(&h->ledger.at[i].task.at),
        .state = h->ledger.at[i].task.generation,
        .sent_us = t->sent_us,
        .done_us = h->now_us,
        .wall_us = wall_us};
    hub_cost_note(h, i, (double)done.px, pace_note(pace, &done));
    pace_mix(&h->pace.us_per_px, pace->us_per_px);
}

static void take_done(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    int32_t k = e->slot, i = tasks_find(&h->ledger, e->task.frame, e->task.id);
    if (i < 0 || !hub_works(h, k) || hub_task(h, i)->owner != k) return;
    /* If DONE was repeated, perhaps the node had no such pixels when it was asked to flush. */
    if (hub_task(h, i)->computed) h->nodes[k].flushed = false;
    else {
        note_pace(h, i, e->wall_us);
        hub_progress(h, k);
        hub_aside_well(h, i, out);
    }
    hub_unlist(h, i);
    hub_enlist(h, i, k, true);
    /* If it has more, it may be slower than it thought, and can give some. */
    h->nodes[k].dry = false;
    hub_mark(h, k);
    hub_ask_flush(h, k, out);
}

static void take_fail(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    int32_t i = tasks_find(&h->ledger, e->task.frame, e->task.id);
    if (i < 0 || !hub_works(h, e->slot) || hub_task(h, i)->owner != e->slot) return;
    hub_aside_fail(h, e->slot, i, e->refused, out);
}

static void take_pixels(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    int32_t i = tasks_find(&h->ledger, e->task.frame, e->task.id);
    if (i < 0) return;
    uint64_t before = h->ledger.at[i].delivered;
    if (!tasks_deliver(&h->ledger, i, &e->task.at)) return;
    if (h->ledger.at[i].delivered > before && hub_works(h, e->slot)) hub_progress(h, e->slot);
    if (!tasks_whole(&h->ledger, i)) return;
    hub_commit(h, i, out);
}

/* A GIVE to a node that does not exist leaves the task with its owner. A GIVE of a task that the
 * node does not own gives nothing, but answers the ask: the asking node stops waiting for it. The
 * same holds for a task that has pieces: these are enough. */
static void take_give(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    int32_t k = e->slot, peer = e->ring.peer;
    int32_t i = tasks_find(&h->ledger, e->task.frame, e->task.id);
    bool owns = i >= 0 && hub_task(h, i)->owner == k, cut = owns && pieces_exist(&h->ledger, i);
    if (peer < 0 || peer >= h->n_nodes) peer = k;
    if (owns) hub_unlist(h, i);
    if (cut) hub_enlist(h, i, -1, false);
    if (owns && !cut) {
        hub_answers(h, k, peer);
        hub_task(h, i)->from = k;
        hub_assign(h, i, peer, out);
    } else hub_has_none(h, k, peer);
    hub_mark(h, k);
    hub_ask_flush(h, k, out);
}

static void take_ring(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    if (!hub_works(h, e->slot)) return;
    switch (e->ring.kind) {
    case RING_ASK: hub_asks(h, e->slot); break;
    case RING_GIVE: take_give(h, e, out); break;
    case RING_NONE: hub_has_none(h, e->slot, e->ring.peer); break;
    default: break;
    }
}

/* A record of this node proves that it lives. Pixels do not: they may come from before. */
static void note_life(struct hub *h, const struct sched_event *e)
{
    if ((e->kind != SCHED_DONE && e->kind != SCHED_FAIL && e->kind != SCHED_RING) ||
        !hub_works(h, e->slot))
        return;
    h->nodes[e->slot].silent = false;
    hub_mark(h, e->slot);
}

static void flush_all(struct hub *h, struct sched_actions *out)
{
    for (int32_t k = 0; k < h->n_nodes; k++) hub_ask_flush(h, k, out);
}

static void ring_step(
    void *state, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    struct hub *h = state;
    bool known = e->slot >= 0 && e->slot < h->n_nodes;
    h->now_us = now;
    hub_late(h);
    note_life(h, e);
    switch (e->kind) {
    case SCHED_TASK: take_task(h, e, out); break;
    case SCHED_INPUT_END:
        h->ended = true;
        for (int32_t k = 0; k < h->n_nodes; k++) hub_mark(h, k);
        flush_all(h, out);
        break;
    case SCHED_FLUSH:
        h->flush = true;
        flush_all(h, out);
        break;
    case SCHED_SLOTS: take_slots(h, e->n, out); break;
    case SCHED_UP:
        if (hub_join(h, e->slot)) take_up(h, e, out);
        break;
    case SCHED_GONE:
        if (known) take_gone(h, e->slot, out);
        else hub_note_early(h, e->slot);
        break;
    case SCHED_DONE: take_done(h, e, out); break;
    case SCHED_FAIL: take_fail(h, e, out); break;
    case SCHED_PIXELS: take_pixels(h, e, out); break;
    case SCHED_RING: take_ring(h, e, out); break;
    case SCHED_DRAIN:
        if (known) hub_drain(h, e->slot, out);
        break;
    case SCHED_WAKE: break;
    }
    hub_aside_settle(h, out);
    hub_aside_try(h, out);
    hub_match(h, out);
    hub_hung(h, out);
    hub_let_go(h, out);
    if (!h->ledger.count) h->flush = false;
    if (!h->ended || h->ledger.count || h->closed) return;
    h->closed = true;
    sched_act(out, h->taken_over ? SCHED_STOP : SCHED_END, -1, NULL);
}

static int32_t ring_uncommitted(const void *state, uint32_t generation)
{
    return tasks_in_generation(&((const struct hub *)state)->ledger, generation);
}

static int64_t ring_waiting(const void *state)
{
    const struct hub *h = state;
    return h->ledger.count - h->n_computed;
}

static int32_t ring_tries(const void *state, int32_t slot, uint32_t frame, uint32_t id)
{
    const struct hub *h = state;
    int32_t i = tasks_find(&h->ledger, frame, id);
    return i >= 0 && hub_task(h, i)->owner == slot ? hub_task(h, i)->tries : 0;
}

static int64_t ring_wake_us(const void *state)
{
    const struct hub *h = state;
    int64_t late_us = hub_late_us(h), due_us = blame_wake_us(&h->blame, h->now_us);
    if (h->closed) return INT64_MAX;
    if (due_us < late_us) late_us = due_us;
    if (h->return_us < late_us) late_us = h->return_us;
    if (h->end_us < late_us) late_us = h->end_us;
    return late_us < h->hung_us ? late_us : h->hung_us;
}

const struct policy policy_ring = {"ringctl", ring_create, ring_step, ring_uncommitted,
    ring_waiting, ring_tries, ring_wake_us, ring_destroy, true};
