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

/* Moves the tasks of a frame that are in the pool aside; or back, those that are not suspect. */
static void move_frame(struct deal *d, uint32_t frame, enum place to)
{
    struct task_list *from = to == ASIDE ? &d->pool : &d->aside;
    for (int32_t i = from->head, next; i >= 0; i = next) {
        next = d->ledger.at[i].next;
        bool moves = to == ASIDE || !blame_bad(&d->blame, &d->ledger, i, deal_account(d, i)->alone);
        if (task_of(d, i)->frame == frame && moves) move(d, i, to);
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
    if (blame_add(&d->blame, t, k)) move_frame(d, t->frame, ASIDE);
}

void deal_aside_blame(struct deal *d, int32_t k, struct sched_actions *out)
{
    const struct slot *s = &d->slots[k];
    int32_t held = s->held.head, shared = s->shared.head;
    for (int32_t n = s->width; n > 0 && (held >= 0 || shared >= 0); n--) {
        bool first = shared < 0 ||
                     (held >= 0 && deal_copy(s, held)->given_us <= deal_copy(s, shared)->given_us);
        int32_t *c = first ? &held : &shared;
        blame(d, k, &s->has.at[*c].task, out);
        *c = s->has.at[*c].next;
    }
}

void deal_aside_fail(struct deal *d, int32_t k, int32_t c, struct sched_actions *out)
{
    blame(d, k, &d->slots[k].has.at[c].task, out);
    d->slots[k].stalled = false;
    deal_lose_copy(d, k, c);
}

void deal_aside_well(struct deal *d, const struct task *t)
{
    if (blame_well(&d->blame, t)) move_frame(d, t->frame, IN_POOL);
}

int32_t deal_aside_other(struct deal *d, int32_t k)
{
    int32_t i = d->pool.head;
    if (!d->blame.tasks.count || d->up < 2) return i;
    for (int32_t n = LOOK_MOST; n > 0 && i >= 0; n--, i = d->ledger.at[i].next)
        if (!blame_is(&d->blame, task_of(d, i), k)) return i;
    move(d, d->pool.head, ASIDE);
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
    blame_abandon(&d->ledger, i, all, out);
    deal_commit(d, i, out);
}

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
        give(d, half[h], now, out);
    }
}

static void try_entry(struct deal *d, int32_t i, int64_t now, struct sched_actions *out)
{
    int32_t *alone = &deal_account(d, i)->alone;
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
    if (!blame_due(&d->blame, quiet, d->ended || d->flush, now)) return;
    for (int32_t n = d->aside.count; n > 0 && d->aside.count; n--) {
        int32_t i = d->aside.head;
        list_remove(&d->ledger, &d->aside, i);
        list_push_back(&d->ledger, &d->aside, i);
        try_entry(d, i, now, out);
    }
}
