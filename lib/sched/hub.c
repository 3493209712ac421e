/*
 * The hub of the ring: it passes on what nodes say to each other, over FIFO links, and keeps the
 * ledger of who owns which task. It does not decide how much is given, or which.
 *
 *   owner    of a task that is not committed     changes on
 *   pool     nobody that is known could have it  SLOTS, UP of a node: -> node
 *   node     NEW: it waits here for the node;    GIVE of its owner: -> the other one
 *            UP: it was given to it              GONE: -> the next before it that is up, or pool;
 *                                                it is late: -> an idle node (hub_hung.c)
 *   (any)    -                                   the last PIXELS: committed
 *
 * A task starts at the node it is preassigned to, else at node id mod n. A GIVE counts only from
 * the owner, and so does DONE; PIXELS count whoever sends them. What belongs to a connection that
 * was lost is thus void, and a task that reaches the next one on that slot, which does not own it,
 * is computed once too often at worst.
 *
 * The ledger alone ends the run.
 */
#include "sched/hub_int.h"

#include <stdlib.h>

#define SLOTS_MAX (1 << 20)

static void *ring_create(const struct sched_params *p)
{
    struct hub *h = xcalloc(1, sizeof *h);
    h->p = *p;
    h->pool = TASK_LIST_EMPTY;
    h->oldest = h->newest = h->stalest = h->freshest = -1;
    h->hung_us = INT64_MAX;
    return h;
}

static void ring_destroy(void *state)
{
    struct hub *h = state;
    if (!h) return;
    tasks_free(&h->ledger);
    set_free(&h->up);
    set_free(&h->hungry);
    set_free(&h->idle);
    for (int c = 0; c < LOADS; c++) set_free(&h->rich[c]);
    set_free(&h->late);
    set_free(&h->delayed);
    free(h->from);
    free(h->early);
    free(h->nodes);
    free(h);
}

/* ---- the ledger ------------------------------------------------------------------------------ */

static struct task_list *list_of(struct hub *h, int32_t i)
{
    const struct task_entry *e = &h->ledger.at[i];
    if (e->slot < 0) return &h->pool;
    return e->done ? &h->nodes[e->slot].computed : &h->nodes[e->slot].held;
}

static double px_of(const struct task_entry *e) { return (double)lattice_count(&e->task.at); }

static void unlist(struct hub *h, int32_t i)
{
    struct task_entry *e = &h->ledger.at[i];
    list_remove(&h->ledger, list_of(h, i), i);
    h->n_computed -= e->done;
    if (e->slot >= 0 && !e->done) h->nodes[e->slot].held_px -= px_of(e);
}

static void enlist(struct hub *h, int32_t i, int32_t k, bool done)
{
    struct task_entry *e = &h->ledger.at[i];
    e->slot = k;
    e->done = done;
    h->n_computed += done;
    list_push_back(&h->ledger, list_of(h, i), i);
    if (k >= 0 && !done) h->nodes[k].held_px += px_of(e);
}

/* Node k, which is up, is told of entry i, which is its. */
static void send(struct hub *h, int32_t k, int32_t i, struct sched_actions *out)
{
    struct hub_node *s = &h->nodes[k];
    s->flushed = false;
    h->ledger.at[i].tries += !h->ledger.at[i].tries;
    h->ledger.at[i].since_us = h->now_us;
    sched_act(out, SCHED_GIVE, k, &h->ledger.at[i].task);
    out->at[out->n - 1].from = h->from[i];
    ring_served(h, k);
    if (s->held.count == 1) ring_progress(h, k);
}

/* Entry i, on no list, is node k's, or, where that is gone, the next one's before it that is up. */
static void assign(struct hub *h, int32_t i, int32_t k, struct sched_actions *out)
{
    if (h->nodes[k].state == NODE_GONE) k = set_before(&h->up, k);
    enlist(h, i, k, false);
    if (hub_is_up(h, k)) send(h, k, i, out);
    else if (k >= 0) hub_mark(h, k);
}

void hub_give(struct hub *h, int32_t k, int32_t peer, int32_t n, struct sched_actions *out)
{
    while (n-- > 0) {
        int32_t i = h->nodes[k].held.head;
        unlist(h, i);
        h->from[i] = k;
        assign(h, i, peer, out);
    }
    hub_mark(h, k);
}

static void start(struct hub *h, int32_t i, struct sched_actions *out)
{
    const struct task *t = &h->ledger.at[i].task;
    bool chosen = t->to >= 0 && t->to < h->n_nodes;
    assign(h, i, chosen ? t->to : (int32_t)(t->id % (uint32_t)h->n_nodes), out);
}

/* Where node k is the only one that is up, it is everybody's heir; -1: nodes are known. */
static void take_pool(struct hub *h, int32_t k, struct sched_actions *out)
{
    for (int32_t left = h->pool.count; left > 0; left--) {
        int32_t i = h->pool.head;
        unlist(h, i);
        if (k >= 0) assign(h, i, k, out);
        else start(h, i, out);
    }
}

/* Once all of what node k has is computed, it is asked for what is missing of it. */
static void ask_flush(struct hub *h, int32_t k, struct sched_actions *out)
{
    struct hub_node *s = &h->nodes[k];
    bool wanted = (h->ended || h->flush) && s->state == NODE_UP;
    if (!wanted || s->flushed || s->held.count || !s->computed.count) return;
    s->flushed = true;
    hub_mark(h, k);
    ring_progress(h, k);
    sched_act(out, SCHED_ASK_FLUSH, k, NULL);
}

void hub_take_over(struct hub *h, int32_t i, int32_t thief, struct sched_actions *out)
{
    int32_t k = h->ledger.at[i].slot;
    unlist(h, i);
    h->from[i] = k;
    h->ledger.at[i].tries++;
    h->taken_over = true;
    assign(h, i, thief, out);
    hub_mark(h, k);
    ask_flush(h, k, out);
}

/* ---- events ---------------------------------------------------------------------------------- */

static void take_task(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    if (tasks_find(&h->ledger, e->task.frame, e->task.id) >= 0) return; /* the same key again */
    int32_t i = tasks_add(&h->ledger, &e->task, e->frame_w);
    if (h->n_from < h->ledger.cap) {
        h->n_from = h->ledger.cap;
        h->from = xrealloc(h->from, (size_t)h->n_from, sizeof *h->from);
    }
    h->from[i] = -1;
    if (h->n_nodes) start(h, i, out);
    else enlist(h, i, -1, false);
}

/* A node may be lost before it is known how many there are. */
static void note_gone(struct hub *h, int32_t k)
{
    if (h->n_nodes || k < 0) return;
    h->early = xrealloc(h->early, h->n_early + 1, sizeof *h->early);
    h->early[h->n_early++] = k;
}

static void take_slots(struct hub *h, int32_t n, struct sched_actions *out)
{
    if (h->n_nodes || n < 1 || n > SLOTS_MAX) return;
    h->n_nodes = n;
    h->nodes = xcalloc((size_t)n, sizeof *h->nodes);
    for (int32_t k = 0; k < n; k++)
        h->nodes[k] = (struct hub_node){.held = TASK_LIST_EMPTY,
            .computed = TASK_LIST_EMPTY,
            .load = -1,
            .thief = -1,
            .victim = -1};
    set_init(&h->up, n);
    set_init(&h->hungry, n);
    set_init(&h->idle, n);
    for (int c = 0; c < LOADS; c++) set_init(&h->rich[c], n);
    set_init(&h->late, n);
    set_init(&h->delayed, n);
    for (size_t i = 0; i < h->n_early; i++)
        if (h->early[i] < n) h->nodes[h->early[i]].state = NODE_GONE;
    take_pool(h, -1, out);
}

/* The tasks come first, so that it does not ask for what is under way. */
static void take_up(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    int32_t k = e->slot;
    struct hub_node *s = &h->nodes[k];
    if (s->state == NODE_UP) return;
    s->state = NODE_UP;
    s->width = e->n > 1 ? e->n : 1;
    set_put(&h->up, k, true);
    hub_mark(h, k);
    for (int32_t i = s->held.head; i >= 0; i = h->ledger.at[i].next) send(h, k, i, out);
    take_pool(h, k, out);
    sched_act(out, SCHED_SAY, k, NULL);
    out->at[out->n - 1].ring = (struct ring){
        .kind = RING_PLACE, .peer = -1, .next = -1, .me = k, .n = h->n_nodes, .one = h->p.one};
}

static void take_gone(struct hub *h, int32_t k, struct sched_actions *out)
{
    struct hub_node *s = &h->nodes[k];
    struct task_list *lists[] = {&s->computed, &s->held};
    bool had = s->state == NODE_UP;
    s->state = NODE_GONE;
    set_put(&h->up, k, false);
    ring_lost(h, k);
    for (int l = 0; l < 2; l++) {
        while (lists[l]->count) {
            int32_t i = lists[l]->head;
            unlist(h, i);
            h->from[i] = -1;
            h->ledger.at[i].tries += had;
            assign(h, i, k, out);
        }
    }
}

static void note_pace(struct hub *h, int32_t i, int64_t wall_us)
{
    const struct task_entry *e = &h->ledger.at[i];
    pace_note(&h->nodes[e->slot].pace, e, wall_us, h->now_us);
    pace_mix(&h->pace.us_per_px, h->nodes[e->slot].pace.us_per_px);
}

static void take_done(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    int32_t k = e->slot, i = tasks_find(&h->ledger, e->task.frame, e->task.id);
    if (i < 0 || !hub_is_up(h, k) || h->ledger.at[i].slot != k) return;
    /* Said before it was so? What it holds back it may not have had when it was asked. */
    if (h->ledger.at[i].done) h->nodes[k].flushed = false;
    else {
        note_pace(h, i, e->wall_us);
        ring_progress(h, k);
    }
    unlist(h, i);
    enlist(h, i, k, true);
    /* If it has more, it may be slower than it thought. */
    h->nodes[k].dry = false;
    hub_mark(h, k);
    ask_flush(h, k, out);
}

static void take_pixels(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    int32_t i = tasks_find(&h->ledger, e->task.frame, e->task.id);
    if (i < 0) return;
    uint64_t before = h->ledger.at[i].delivered;
    if (!tasks_deliver(&h->ledger, i, &e->task.at)) return;
    if (h->ledger.at[i].delivered > before && hub_is_up(h, e->slot)) ring_progress(h, e->slot);
    if (!tasks_whole(&h->ledger, i)) return;
    int32_t k = h->ledger.at[i].slot;
    sched_act(out, SCHED_COMMIT, k, &h->ledger.at[i].task);
    unlist(h, i);
    tasks_remove(&h->ledger, i);
    if (k < 0) return;
    hub_mark(h, k);
    ask_flush(h, k, out);
}

/* To a node that does not exist it was not given. What was not its to give is no gift, but an
 * answer: whoever asked waits for it no more. */
static void take_give(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    int32_t k = e->slot, peer = e->ring.peer;
    int32_t i = tasks_find(&h->ledger, e->task.frame, e->task.id);
    if (peer < 0 || peer >= h->n_nodes) peer = k;
    if (i >= 0 && h->ledger.at[i].slot == k) {
        ring_answers(h, k, peer);
        unlist(h, i);
        h->from[i] = k;
        assign(h, i, peer, out);
    } else ring_has_none(h, k, peer);
    hub_mark(h, k);
    ask_flush(h, k, out);
}

static void take_ring(struct hub *h, const struct sched_event *e, struct sched_actions *out)
{
    if (!hub_is_up(h, e->slot)) return;
    switch (e->ring.kind) {
    case RING_ASK: ring_asks(h, e->slot); break;
    case RING_GIVE: take_give(h, e, out); break;
    case RING_NONE: ring_has_none(h, e->slot, e->ring.peer); break;
    default: break;
    }
}

/* Pixels may be older. */
static void note_life(struct hub *h, const struct sched_event *e)
{
    if ((e->kind != SCHED_DONE && e->kind != SCHED_RING) || !hub_is_up(h, e->slot)) return;
    h->nodes[e->slot].silent = false;
    hub_mark(h, e->slot);
}

static void flush_all(struct hub *h, struct sched_actions *out)
{
    for (int32_t k = 0; k < h->n_nodes; k++) ask_flush(h, k, out);
}

static void ring_step(
    void *state, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    struct hub *h = state;
    bool known = e->slot >= 0 && e->slot < h->n_nodes;
    h->now_us = now;
    ring_late(h);
    note_life(h, e);
    switch (e->kind) {
    case SCHED_TASK: take_task(h, e, out); break;
    case SCHED_INPUT_END:
        h->ended = true;
        flush_all(h, out);
        break;
    case SCHED_FLUSH:
        h->flush = true;
        flush_all(h, out);
        break;
    case SCHED_SLOTS: take_slots(h, e->n, out); break;
    case SCHED_UP:
        if (known) take_up(h, e, out);
        break;
    case SCHED_GONE:
        if (known) take_gone(h, e->slot, out);
        else note_gone(h, e->slot);
        break;
    case SCHED_DONE: take_done(h, e, out); break;
    case SCHED_PIXELS: take_pixels(h, e, out); break;
    case SCHED_RING: take_ring(h, e, out); break;
    case SCHED_WAKE: break;
    }
    ring_match(h, out);
    ring_hung(h, out);
    if (!h->ledger.count) h->flush = false;
    if (!h->ended || h->ledger.count || h->closed) return;
    h->closed = true;
    sched_act(out, h->taken_over ? SCHED_STOP : SCHED_END, -1, NULL);
}

static int32_t ring_uncommitted(const void *state, uint32_t generation)
{
    return ((const struct hub *)state)->ledger.of[generation % GENERATIONS];
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
    return i >= 0 && h->ledger.at[i].slot == slot ? h->ledger.at[i].tries : 0;
}

static int64_t ring_wake_us(const void *state)
{
    const struct hub *h = state;
    int64_t late_us = ring_late_us(h);
    if (h->closed) return INT64_MAX;
    return late_us < h->hung_us ? late_us : h->hung_us;
}

const struct policy policy_ring = {"ringctl", ring_create, ring_step, ring_uncommitted,
    ring_waiting, ring_tries, ring_wake_us, ring_destroy};
