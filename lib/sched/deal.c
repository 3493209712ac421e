/*
 * deal: demand-driven distribution (self-scheduling; the papers' master-slave and D_S).
 *
 * A task is in one of these states; the ledger holds it until it is committed and forgets it then.
 *
 *   state     where                 leaves it on
 *   pool      pool list             a slot that is up holds fewer than 1 + depth: -> held
 *   promised  slot's promised list  its slot comes up: -> held; is gone, or does not exist: -> pool
 *   held      slot's held list      DONE from that slot: -> computed; slot gone: -> pool (front)
 *   computed  slot's computed list  slot gone: -> pool (front)
 *   (any)     -                     the last PIXELS: committed
 *
 * Tasks with to=K are sent to slot K at once, all of them, whatever the depth (the hybrid's first
 * phase). PIXELS count whoever sends them: a slot that was given up may still be the first to
 * deliver. DONE counts only from the slot that holds the task. Anything else is late or wrong, and
 * ignored.
 */
#include "sched/sched.h"

#include <stdlib.h>

#define SLOTS_MAX (1 << 20)

enum slot_state { SLOT_NEW, SLOT_UP, SLOT_GONE };

struct slot {
    enum slot_state state;
    bool asked; /* for a flush, since it was last given work */
    struct task_list promised, held, computed;
};

struct deal {
    struct sched_params p;
    struct task_table ledger;
    struct task_list pool;
    struct slot *slots;
    int32_t n_slots; /* entries of slots */
    int32_t known;   /* what SLOTS said, 0 before */
    bool ended, flush, closed;
};

static void *deal_create(const struct sched_params *p)
{
    struct deal *d = xcalloc(1, sizeof *d);
    d->p = *p;
    d->pool = TASK_LIST_EMPTY;
    return d;
}

static void deal_destroy(void *state)
{
    struct deal *d = state;
    if (!d) return;
    tasks_free(&d->ledger);
    free(d->slots);
    free(d);
}

static struct slot *slot_at(struct deal *d, int32_t k)
{
    if (k >= d->n_slots) {
        d->slots = xrealloc(d->slots, (size_t)k + 1, sizeof *d->slots);
        for (; d->n_slots <= k; d->n_slots++)
            d->slots[d->n_slots] =
                (struct slot){SLOT_NEW, false, TASK_LIST_EMPTY, TASK_LIST_EMPTY, TASK_LIST_EMPTY};
    }
    return &d->slots[k];
}

/* The list that entry i is on. */
static struct task_list *list_of(struct deal *d, int32_t i)
{
    const struct task_entry *e = &d->ledger.at[i];
    if (e->slot < 0) return &d->pool;
    struct slot *s = &d->slots[e->slot];
    if (s->state == SLOT_NEW) return &s->promised;
    return e->done ? &s->computed : &s->held;
}

static void give(struct deal *d, int32_t k, int32_t i, struct sched_actions *out)
{
    struct task_entry *e = &d->ledger.at[i];
    e->slot = k;
    e->done = false;
    list_push_back(&d->ledger, &d->slots[k].held, i);
    d->slots[k].asked = BUG(7);
    sched_act(out, SCHED_GIVE, k, &e->task);
}

/* The hungriest slot, the lowest of equals, or -1 when all have what they may hold. */
static int32_t hungriest(const struct deal *d)
{
    int32_t best = -1, least = d->p.depth + (BUG(5) ? 2 : 1);
    for (int32_t k = 0; k < d->n_slots; k++) {
        const struct slot *s = &d->slots[k];
        if (s->state != SLOT_UP || s->held.count >= least) continue;
        best = k;
        least = s->held.count;
    }
    return best;
}

static void hand_out(struct deal *d, struct sched_actions *out)
{
    while (d->pool.count) {
        int32_t k = hungriest(d);
        if (k < 0) return;
        int32_t i = d->pool.head;
        list_remove(&d->ledger, &d->pool, i);
        give(d, k, i, out);
    }
}

static void take_task(struct deal *d, const struct sched_event *e, struct sched_actions *out)
{
    if (tasks_find(&d->ledger, e->task.frame, e->task.id) >= 0) return; /* the same key again */
    int32_t i = tasks_add(&d->ledger, &e->task, e->frame_w), to = BUG(12) ? -1 : e->task.to;
    struct slot *s = to >= 0 && to < (d->known ? d->known : SLOTS_MAX) ? slot_at(d, to) : NULL;
    if (s && s->state == SLOT_UP) {
        give(d, to, i, out);
    } else if (s && s->state == SLOT_NEW) {
        d->ledger.at[i].slot = to;
        list_push_back(&d->ledger, &s->promised, i);
    } else {
        list_push_back(&d->ledger, &d->pool, i);
    }
}

/* Everything on l goes back to the front of the pool, in its order. */
static void reclaim(struct deal *d, struct task_list *l)
{
    while (l->count) {
        int32_t i = l->tail;
        list_remove(&d->ledger, l, i);
        d->ledger.at[i].slot = -1;
        d->ledger.at[i].done = false;
        list_push_front(&d->ledger, &d->pool, i);
    }
}

static void take_gone(struct deal *d, int32_t k)
{
    struct slot *s = slot_at(d, k);
    if (!BUG(1)) reclaim(d, &s->held);
    if (!BUG(2)) reclaim(d, &s->computed);
    reclaim(d, &s->promised);
    s->state = BUG(3) ? SLOT_UP : SLOT_GONE;
}

static void take_up(struct deal *d, int32_t k, struct sched_actions *out)
{
    struct slot *s = slot_at(d, k);
    if (s->state == SLOT_UP) return;
    s->state = SLOT_UP;
    while (s->promised.count) {
        int32_t i = s->promised.head;
        list_remove(&d->ledger, &s->promised, i);
        give(d, k, i, out);
    }
}

/* Tasks promised to slots that do not exist are everybody's. */
static void take_slots(struct deal *d, int32_t n)
{
    d->known = n;
    for (int32_t k = BUG(4) ? d->n_slots : n; k < d->n_slots; k++)
        reclaim(d, &d->slots[k].promised);
}

/* The last pixels of entry i have been passed on: forget it. */
static void commit(struct deal *d, int32_t i, struct sched_actions *out)
{
    sched_act(out, SCHED_COMMIT, d->ledger.at[i].slot, &d->ledger.at[i].task);
    if (BUG(9)) return;
    list_remove(&d->ledger, list_of(d, i), i);
    tasks_remove(&d->ledger, i);
}

static void take_done(struct deal *d, const struct sched_event *e, struct sched_actions *out)
{
    (void)out;
    int32_t i = tasks_find(&d->ledger, e->task.frame, e->task.id);
    if (i < 0 || (!BUG(11) && d->ledger.at[i].slot != e->slot) || d->ledger.at[i].done) return;
    if (BUG(11) && d->ledger.at[i].slot < 0) return;
    if (d->slots[e->slot].state != SLOT_UP) return;
    struct slot *s = &d->slots[e->slot];
    list_remove(&d->ledger, &s->held, i);
    d->ledger.at[i].done = true;
    list_push_back(&d->ledger, &s->computed, i);
    if (BUG(6)) commit(d, i, out);
}

static void take_pixels(struct deal *d, const struct sched_event *e, struct sched_actions *out)
{
    int32_t i = tasks_find(&d->ledger, e->task.frame, e->task.id);
    if (i < 0 || !tasks_deliver(&d->ledger, i, &e->task.at)) return;
    if (BUG(8) || tasks_whole(&d->ledger, i)) commit(d, i, out);
}

/* With nothing left to give, slots that have computed all of theirs are asked for it. */
static void ask_flush(struct deal *d, struct sched_actions *out)
{
    for (int32_t k = 0; k < d->n_slots; k++) {
        struct slot *s = &d->slots[k];
        if (s->state != SLOT_UP || s->asked || s->held.count || !s->computed.count) continue;
        s->asked = true;
        sched_act(out, SCHED_ASK_FLUSH, k, NULL);
    }
}

static void deal_step(
    void *state, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    struct deal *d = state;
    (void)now;
    switch (e->kind) {
    case SCHED_TASK: take_task(d, e, out); break;
    case SCHED_INPUT_END: d->ended = true; break;
    case SCHED_FLUSH: d->flush = true; break;
    case SCHED_SLOTS: take_slots(d, e->n); break;
    case SCHED_UP: take_up(d, e->slot, out); break;
    case SCHED_GONE: take_gone(d, e->slot); break;
    case SCHED_DONE: take_done(d, e, out); break;
    case SCHED_PIXELS: take_pixels(d, e, out); break;
    }
    hand_out(d, out);
    if ((d->ended || d->flush) && !d->pool.count) ask_flush(d, out);
    if (!d->ledger.count) d->flush = false;
    if (d->ended && !(BUG(10) ? d->pool.count : d->ledger.count) && !d->closed) {
        d->closed = true;
        sched_act(out, SCHED_END, -1, NULL);
    }
}

static int64_t deal_uncommitted(const void *state)
{
    return ((const struct deal *)state)->ledger.count;
}

static int64_t deal_waiting(const void *state)
{
    const struct deal *d = state;
    int64_t n = d->pool.count;
    for (int32_t k = 0; k < d->n_slots; k++) n += d->slots[k].promised.count;
    return n;
}

const struct policy policy_deal = {
    "deal", deal_create, deal_step, deal_uncommitted, deal_waiting, deal_destroy};
