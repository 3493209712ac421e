/*
 * deal: demand-driven distribution (self-scheduling; the papers' master-slave and D_S).
 *
 * The ledger holds each task until it is committed. A task is in one of these states:
 *
 *   state     where                 leaves it on
 *   pool      pool list             a slot that is up may hold one more: -> out
 *   promised  slot's promised list  its slot comes up: -> out; is gone, or does not exist: -> pool
 *   out       out list; copies in   DONE from a slot that has a copy: -> computed; the last such
 *             `has` of some slots   slot gone, and no piece left: -> pool (front; if it was being
 *                                   computed, back), or aside if it has cost some slots
 *   aside     aside list            nothing else is to be done: -> out, pieces of it or itself; or
 *                                   it is given up (deal_aside.c)
 *   computed  slot's computed list  slot gone: -> out if another has a copy, else the list of
 *                                   another slot that owes its pixels, else pool (front);
 *                                   given once more (deal_end.c, rule 4): -> out
 *   (any)     -                     the last PIXELS, its own or those of its pieces: committed
 *
 * A task with to=K goes to slot K at once, whatever the depth (the hybrid's first phase). PIXELS
 * count from any slot: a slot that was given up may still deliver first. DONE counts only from a
 * slot that has a copy. Anything else is late or wrong, and is ignored. A copy occupies its slot,
 * needed or not, until the slot reports DONE or is gone. From then on the slot owes its pixels, and
 * is not given the task again: a slot that buffers its pixels would compute it without end.
 *
 * A task has more than one copy only at the end or if it is late, and pieces only at the end:
 * deal_end.c.
 */
#include "sched/deal_int.h"

#include <stdlib.h>

#define SLOTS_MAX (1 << 20)
#define COSTS 4096 /* observed costs that are kept */

static void *deal_create(const struct sched_params *p)
{
    struct deal *d = xcalloc(1, sizeof *d);
    d->p = *p;
    tasks_init(&d->ledger, sizeof(struct account));
    blame_init(&d->blame, p->losses);
    cost_init(&d->costs, COSTS);
    d->pool = d->out = d->aside = TASK_LIST_EMPTY;
    d->late_us = INT64_MAX;
    deal_make_room(d, 1);
    return d;
}

static void deal_destroy(void *state)
{
    struct deal *d = state;
    if (!d) return;
    for (int32_t k = 0; k < d->n_slots; k++) tasks_free(&d->slots[k].has);
    tasks_free(&d->ledger);
    blame_free(&d->blame);
    cost_free(&d->costs);
    deal_close_room(d);
    free(d->slots);
    free(d);
}

static struct slot *slot_at(struct deal *d, int32_t k)
{
    deal_make_room(d, k + 1);
    for (; d->n_slots <= k; d->n_slots++) {
        struct slot *s = &d->slots[d->n_slots];
        *s = (struct slot){.promised = TASK_LIST_EMPTY,
            .computed = TASK_LIST_EMPTY,
            .held = TASK_LIST_EMPTY,
            .shared = TASK_LIST_EMPTY,
            .owed = TASK_LIST_EMPTY,
            .outrun = TASK_LIST_EMPTY};
        tasks_init_slot(&s->has, sizeof(struct copy));
    }
    return &d->slots[k];
}

/* ---- giving ---------------------------------------------------------------------------------- */

/* Gives entry i, or a piece of it, to slot k. */
static void hand(struct deal *d, int32_t k, int32_t i, int64_t now, struct sched_actions *out)
{
    i = deal_end_piece(d, k, i);
    deal_take(d, i);
    deal_give(d, k, i, now, out);
}

/* Slots that refused all of the pool may find something in it. */
static void feed(struct deal *d)
{
    d->fed = false;
    for (int32_t k = 0; d->blame.refusals.n && k < d->n_slots; k++) {
        bool was = d->slots[k].starved;
        d->slots[k].starved = false;
        if (was) deal_mark(d, k);
    }
}

static void hand_out(struct deal *d, int64_t now, struct sched_actions *out)
{
    int32_t k, last = -1, next = -1;
    if (d->fed) feed(d);
    while (d->pool.count && (k = deal_pick_hungriest(d)) >= 0) {
        bool follows = k == last && next >= 0 && !deal_refuses(d, k, next);
        int32_t i = follows ? next : deal_aside_other(d, k);
        if (i < 0) continue;
        next = deal_pick_apart(d, last = k, i);
        hand(d, k, i, now, out);
    }
}

/* With the pool empty, idle slots get copies of other slots' tasks, or pieces of them. A cut
 * leaves pieces in the pool, which other slots can take. */
static void hand_copies(struct deal *d, int64_t now, struct sched_actions *out)
{
    int32_t k, i;
    while (!d->pool.count && (i = deal_end_other(d, &k, now)) >= 0) {
        hand(d, k, i, now, out);
        hand_out(d, now, out);
    }
}

/* ---- events ---------------------------------------------------------------------------------- */

static void take_task(
    struct deal *d, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    if (tasks_find(&d->ledger, e->task.frame, e->task.id) >= 0) return; /* the same key again */
    int32_t i = deal_enter(d, &e->task, e->frame_w), to = e->task.to;
    struct slot *s = to >= 0 && to < (d->known ? d->known : SLOTS_MAX) ? slot_at(d, to) : NULL;
    if (s && s->state == SLOT_UP) deal_give(d, to, i, now, out);
    else if (s && s->state == SLOT_NEW) deal_put(d, i, PROMISED, to);
    else deal_put_last(d, i);
}

static void take_gone(struct deal *d, int32_t k, struct sched_actions *out)
{
    struct slot *s = slot_at(d, k);
    deal_aside_blame(d, k, out);
    deal_lose(d, k, &s->shared);
    deal_lose(d, k, &s->held);
    while (s->owed.count) deal_drop_copy(d, k, s->owed.tail);
    while (s->outrun.count) deal_drop_copy(d, k, s->outrun.tail);
    deal_reclaim(d, &s->computed);
    deal_reclaim(d, &s->promised);
    d->up -= s->state == SLOT_UP;
    d->drains -= s->state == SLOT_DRAINS;
    s->state = SLOT_GONE;
    d->stale_us = 0;
    deal_accepts(d, k);
    deal_mark(d, k);
}

static void take_up(
    struct deal *d, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    int32_t k = e->slot;
    struct slot *s = slot_at(d, k);
    s->stated = e->stated ? e->power : 0;
    if (s->state == SLOT_UP || s->state == SLOT_DRAINS) {
        deal_scale(d, k, pace_power(&s->pace, e->power));
        deal_mark(d, k);
        return;
    }
    s->state = SLOT_UP;
    s->width = e->n > 1 ? e->n : 1;
    d->up++;
    s->pace = (struct pace){.power = e->power};
    d->stale_us = 0;
    s->speed = (struct speed){0};
    s->work = s->ends_us = s->px = 0;
    s->stalled = false;
    deal_mark(d, k);
    while (s->promised.count) {
        int32_t i = s->promised.head;
        deal_take(d, i);
        deal_give(d, k, i, now, out);
    }
}

/* Tasks promised to slots that do not exist go to the pool. */
static void take_slots(struct deal *d, int32_t n)
{
    d->known = n;
    for (int32_t k = n; k < d->n_slots; k++) deal_reclaim(d, &d->slots[k].promised);
}

/* Copy c of slot s is done. */
static double note_pace(struct slot *s, int32_t c, int64_t wall_us, int64_t now)
{
    const struct pace_task done = {.px = lattice_count(&s->has.at[c].task.at),
        .state = s->has.at[c].task.generation,
        .sent_us = deal_copy(s, c)->given_us,
        .done_us = now,
        .wall_us = wall_us};
    return pace_note(&s->pace, &done);
}

static void take_done(struct deal *d, const struct sched_event *e, int64_t now)
{
    struct slot *s = e->slot < d->n_slots ? &d->slots[e->slot] : NULL;
    if (!s || (s->state != SLOT_UP && s->state != SLOT_DRAINS)) return;
    int32_t i = tasks_find(&d->ledger, e->task.frame, e->task.id);
    int32_t c = tasks_find(&s->has, e->task.frame, e->task.id);
    if (c < 0 || deal_computed(s, c)) {
        /* If DONE was repeated, perhaps the slot had no such pixels when it was asked to flush. */
        if (c >= 0) s->asked = false;
        deal_mark(d, e->slot);
        return;
    }
    deal_aside_well(d, &s->has.at[c].task);
    deal_cost_note(d, e->slot, c, note_pace(s, c, e->wall_us, now));
    s->stalled = false;
    if (i >= 0) deal_account(d, i)->copies--;
    if (tasks_whole(&s->has, c)) deal_drop_copy(d, e->slot, c);
    else if (i >= 0) deal_owe(d, e->slot, c, i);
    else deal_outrun(d, e->slot, c);
    if (i < 0) return;
    if (deal_account(d, i)->place != OUT && deal_account(d, i)->place != ASIDE)
        return; /* another slot finished first */
    deal_forget_pieces(d, i);
    deal_take(d, i);
    deal_account(d, i)->progress_us = now;
    deal_put(d, i, COMPUTED, e->slot);
}

static void take_fail(struct deal *d, const struct sched_event *e, struct sched_actions *out)
{
    const struct slot *s = e->slot < d->n_slots ? &d->slots[e->slot] : NULL;
    int32_t c = s ? tasks_find(&s->has, e->task.frame, e->task.id) : -1;
    if (c >= 0) deal_aside_fail(d, e->slot, c, e->refused, out); /* whatever it said before */
}

/* Slot k has sent pixels: it may owe fewer. */
static void note_pixels(struct deal *d, int32_t k, const struct task *t)
{
    struct slot *s = k >= 0 && k < d->n_slots ? &d->slots[k] : NULL;
    int32_t c = s ? tasks_find(&s->has, t->frame, t->id) : -1;
    if (c < 0 || !tasks_deliver(&s->has, c, &t->at)) return;
    if (tasks_whole(&s->has, c) && deal_computed(s, c)) deal_drop_copy(d, k, c);
}

static void take_pixels(struct deal *d, const struct sched_event *e, struct sched_actions *out)
{
    note_pixels(d, e->slot, &e->task);
    int32_t i = tasks_find(&d->ledger, e->task.frame, e->task.id);
    if (i < 0 || !tasks_deliver(&d->ledger, i, &e->task.at)) return;
    if (tasks_whole(&d->ledger, i)) deal_commit(d, i, out);
}

/* With nothing left to give, flushes the slots that have computed all of their tasks. */
static void ask_flush(struct deal *d, struct sched_actions *out)
{
    int32_t k;
    while ((k = set_after(&d->unflushed, -1)) >= 0) {
        d->slots[k].asked = true;
        deal_mark(d, k);
        sched_act(out, SCHED_ASK_FLUSH, k, NULL);
    }
}

static void deal_step(
    void *state, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    struct deal *d = state;
    d->now_us = now;
    switch (e->kind) {
    case SCHED_TASK: take_task(d, e, now, out); break;
    case SCHED_INPUT_END: d->ended = true; break;
    case SCHED_FLUSH: d->flush = true; break;
    case SCHED_SLOTS: take_slots(d, e->n); break;
    case SCHED_UP: take_up(d, e, now, out); break;
    case SCHED_GONE: take_gone(d, e->slot, out); break;
    case SCHED_DRAIN:
        slot_at(d, e->slot);
        deal_drain(d, e->slot);
        break;
    case SCHED_DONE: take_done(d, e, now); break;
    case SCHED_FAIL: take_fail(d, e, out); break;
    case SCHED_PIXELS: take_pixels(d, e, out); break;
    case SCHED_RING:
    case SCHED_WAKE: break; /* a task is late, or a slot needs one */
    }
    deal_aside_settle(d);
    hand_out(d, now, out);
    deal_let_go(d, out); /* before copies are given of what it asks for */
    deal_aside_try(d, now, out);
    hand_copies(d, now, out);
    if ((d->ended || d->flush) && !d->pool.count) {
        ask_flush(d, out);
        hand_copies(d, now, out); /* also of tasks that slots were asked to flush */
    }
    if (d->pool.count && deal_timed(d)) {
        double us = deal_pick_us(d);
        if (us < (double)d->late_us) d->late_us = (int64_t)us + 1;
    }
    if (!d->ledger.count) d->flush = false;
    if (d->ended && !d->ledger.count && !d->closed) {
        d->closed = true;
        sched_act(out, deal_end_busy(d) ? SCHED_STOP : SCHED_END, -1, NULL);
    }
}

static int32_t deal_uncommitted(const void *state, uint32_t generation)
{
    return tasks_in_generation(&((const struct deal *)state)->ledger, generation);
}

static int64_t deal_waiting(const void *state)
{
    const struct deal *d = state;
    return (int64_t)d->pool.count + d->n_promised;
}

static int32_t deal_tries(const void *state, int32_t slot, uint32_t frame, uint32_t id)
{
    const struct deal *d = state;
    if (slot < 0 || slot >= d->n_slots) return 0;
    const struct slot *s = &d->slots[slot];
    int32_t c = tasks_find(&s->has, frame, id);
    return c < 0 || deal_copy(s, c)->list == OUTRUN ? 0 : deal_copy(s, c)->tries;
}

static int64_t deal_wake_us(const void *state)
{
    const struct deal *d = state;
    return d->closed ? INT64_MAX : d->late_us;
}

const struct policy policy_deal = {"deal", deal_create, deal_step, deal_uncommitted, deal_waiting,
    deal_tries, deal_wake_us, deal_destroy, true};
