/*
 * deal: tasks that cost slots (blame.h). A suspect goes to the end of the pool, and a slot that was
 * lost over it does not get it again while others can. A task or a frame that has cost too many is
 * put aside. When no slot computes anything else, and the input has ended, waits or brings nothing,
 * what was put aside is tried once more, or given up: blame_due, blame_step.
 */
#include "sched/deal_int.h"

#define LOOK_MOST 64 /* tasks of the pool that are looked at for a slot that was lost over some */

static const struct task *task_of(const struct deal *d, int32_t i) { return &d->ledger.at[i].task; }

static void move(struct deal *d, int32_t i, enum place to)
{
    deal_take(d, i);
    deal_put(d, i, to, -1);
}

/* Moves the bad tasks of the pool aside; or those back that are not, of a frame or a generation. */
static void move_all(struct deal *d, enum place to, const uint32_t *frame, uint32_t generation)
{
    struct task_list *from = to == ASIDE ? &d->pool : &d->aside;
    for (int32_t i = from->head, next; i >= 0; i = next) {
        next = d->ledger.at[i].next;
        bool is = frame ? task_of(d, i)->frame == *frame : task_of(d, i)->generation == generation;
        if (is && deal_bad(d, i) == (to == ASIDE)) move(d, i, to);
    }
}

/* ---- blame ------------------------------------------------------------------------- */

static void blame(struct deal *d, int32_t k, const struct task *t, struct sched_actions *out)
{
    int32_t i = tasks_find(&d->ledger, t->frame, t->id);
    const struct account *a = i < 0 ? NULL : deal_account(d, i);
    bool its = a && (a->place == OUT || (a->place == COMPUTED && a->owner == k));
    if (!its) return; /* another slot has computed it */
    sched_act(out, SCHED_BLAME, k, t);
    if (blame_add(&d->blame, t, k)) move_all(d, ASIDE, &t->frame, 0);
}

void deal_aside_blame(struct deal *d, int32_t k, struct sched_actions *out)
{
    const struct slot *s = &d->slots[k];
    int32_t held = s->held.head, shared = s->shared.head;
    blame_gone(&d->blame, d->now_us);
    for (int32_t n = s->width; n > 0 && (held >= 0 || shared >= 0); n--) {
        bool first = shared < 0 ||
                     (held >= 0 && deal_copy(s, held)->given_us <= deal_copy(s, shared)->given_us);
        int32_t *c = first ? &held : &shared;
        blame(d, k, &s->has.at[*c].task, out);
        *c = s->has.at[*c].next;
    }
}

void deal_aside_fail(struct deal *d, int32_t k, int32_t c, bool refused, struct sched_actions *out)
{
    const struct task *t = &d->slots[k].has.at[c].task;
    if (!refused) blame(d, k, t, out);
    else if (d->slots[k].state == SLOT_UP) {
        sched_act(out, SCHED_BLAME, k, t);
        out->at[out->n - 1].refused = true;
        refuse_add(&d->blame.refusals, t->generation, k);
    }
    d->slots[k].stalled = false;
    deal_lose_copy(d, k, c);
}

void deal_aside_well(struct deal *d, const struct task *t)
{
    if (blame_well(&d->blame, t)) move_all(d, IN_POOL, &t->frame, 0);
}

void deal_aside_settle(struct deal *d)
{
    uint32_t generation;
    while (refuse_settle(&d->blame.refusals, d->up, d->now_us, &generation))
        move_all(d, refuse_all(&d->blame.refusals, generation) ? ASIDE : IN_POOL, NULL, generation);
}

/* From entry i of the pool on, the first that slot k does not refuse; -1: none. */
static int32_t accepted(const struct deal *d, int32_t k, int32_t i)
{
    while (i >= 0 && deal_refuses(d, k, i)) i = d->ledger.at[i].next;
    return i;
}

int32_t deal_aside_other(struct deal *d, int32_t k)
{
    int32_t first = accepted(d, k, d->pool.head), i = first;
    if (i < 0) {
        d->slots[k].starved = true;
        deal_mark(d, k);
    }
    if (i < 0 || !d->blame.tasks.count || d->up < 2) return i;
    for (int32_t n = LOOK_MOST; n > 0 && i >= 0; n--, i = accepted(d, k, d->ledger.at[i].next))
        if (!blame_is(&d->blame, task_of(d, i), k)) return i;
    move(d, first, ASIDE);
    return -1;
}

/* ---- trying again ---------------------------------------------------------------------------- */

/* The pool is empty, and no slot computes a task that is needed. */
static bool is_quiet(const struct deal *d)
{
    int32_t i = d->pool.count ? -1 : d->out.head;
    while (i >= 0 && pieces_exist(&d->ledger, i)) i = d->ledger.at[i].next;
    return !d->pool.count && i < 0;
}

/* False: no slot is idle. */
static bool give(struct deal *d, int32_t i, int64_t now, struct sched_actions *out)
{
    int32_t k = blame_pick(&d->blame, task_of(d, i), &d->idle, NULL, NULL);
    if (k < 0) return false;
    deal_take(d, i);
    deal_give(d, k, i, now, out);
    return true;
}

static void abandon(struct deal *d, int32_t i, bool all, struct sched_actions *out)
{
    blame_abandon(&d->blame, &d->ledger, i, all, out);
    deal_commit(d, i, out);
}

/* The time until which a slot may come that is not up. */
static int64_t returns_us(const struct deal *d, uint32_t generation)
{
    int64_t until_us = d->n_slots < d->known || !d->known ? INT64_MAX : 0;
    for (int32_t k = 0; k < d->n_slots && until_us < INT64_MAX; k++) {
        const struct slot *s = &d->slots[k];
        if (s->state == SLOT_NEW && k < d->known) until_us = INT64_MAX;
        if (s->state == SLOT_GONE && s->width)
            until_us = refuse_until_us(&d->blame.refusals, generation);
    }
    return until_us;
}

/* All slots that are up refuse entry i: gives its frame up, if no other may come. */
static void try_refused(struct deal *d, int32_t i, int64_t now, struct sched_actions *out)
{
    int64_t until_us = d->up ? returns_us(d, task_of(d, i)->generation) : INT64_MAX;
    if (now >= until_us) abandon(d, i, true, out);
    else if (until_us < d->late_us) d->late_us = until_us;
}

static void try_entry(struct deal *d, int32_t i, int64_t now, struct sched_actions *out);

/* Cuts entry i into halves. */
static void halve(struct deal *d, int32_t i, int64_t now, struct sched_actions *out)
{
    int32_t half[2];
    half[0] = deal_end_open(d, i);
    const struct lattice at = task_of(d, half[0])->at;
    half[1] = deal_end_cut(d, half[0], pieces_rows(&at, lattice_count(&at) / 2));
    for (int h = 1; h >= 0; h--) { /* the one that was cut off is the first */
        deal_account(d, half[h])->alone = 1;
        move(d, half[h], ASIDE);
    }
    for (int h = 1; h >= 0; h--) try_entry(d, half[h], now, out);
}

static void try_entry(struct deal *d, int32_t i, int64_t now, struct sched_actions *out)
{
    int32_t *alone = &deal_account(d, i)->alone;
    if (refuse_all(&d->blame.refusals, task_of(d, i)->generation)) {
        try_refused(d, i, now, out);
        return;
    }
    switch (blame_step(&d->blame, &d->ledger, &d->aside, i, *alone, d->ended)) {
    case BLAME_GIVE_FRAME:
        if (is_quiet(d) && give(d, i, now, out)) blame_tried(&d->blame, task_of(d, i));
        break;
    case BLAME_ABANDON_FRAME: abandon(d, i, true, out); break;
    case BLAME_WAIT: break;
    case BLAME_ABANDON_PARENT: i = pieces_parent(&d->ledger, i); /* fallthrough */
    case BLAME_ABANDON: abandon(d, i, false, out); break;
    case BLAME_HALVE:
        if (d->idle.count) halve(d, i, now, out);
        break;
    case BLAME_GIVE_ALONE:
        if (give(d, i, now, out)) *alone = 1 + blame_count(&d->blame, task_of(d, i));
        break;
    case BLAME_GIVE: give(d, i, now, out); break;
    }
}

void deal_aside_try(struct deal *d, int64_t now, struct sched_actions *out)
{
    bool quiet = d->aside.count && is_quiet(d);
    d->late_us = INT64_MAX;
    bool due = blame_due(&d->blame, quiet, d->ended || d->flush, now);
    for (int32_t n = due ? d->aside.count : 0; n > 0 && d->aside.count; n--) {
        int32_t i = d->aside.head;
        list_remove(&d->ledger, &d->aside, i);
        list_push_back(&d->ledger, &d->aside, i);
        try_entry(d, i, now, out);
    }
    int64_t wake_us = blame_wake_us(&d->blame, now);
    if (wake_us < d->late_us) d->late_us = wake_us;
}
