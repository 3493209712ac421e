/*
 * deal: the ledger, and the copies that slots hold. Every entry is on the one list that its account
 * names.
 */
#include "sched/deal_int.h"

int32_t deal_enter(struct deal *d, const struct task *t, uint32_t frame_w)
{
    int32_t i = tasks_add(&d->ledger, t, frame_w);
    deal_account(d, i)->piece = PIECE_OF_NONE;
    deal_open_account(d, i, 0);
    blame_note(&d->blame, t);
    return i;
}

void deal_open_account(struct deal *d, int32_t i, int32_t tries)
{
    struct account *a = deal_account(d, i);
    a->owner = a->latest = a->owing = -1;
    a->tries = tries;
}

static struct task_list *list_of(struct deal *d, int32_t i)
{
    const struct account *a = deal_account(d, i);
    struct slot *s = a->owner >= 0 ? &d->slots[a->owner] : NULL;
    switch (a->place) {
    case PROMISED: return &s->promised;
    case COMPUTED: return &s->computed;
    case OUT: return &d->out;
    case ASIDE: return &d->aside;
    case IN_POOL: break;
    }
    return &d->pool;
}

/* Entry i enters the pool (sign 1), or leaves it (-1). */
static void count_pool(struct deal *d, int32_t i, double sign)
{
    struct account *a = deal_account(d, i);
    int32_t *n = &d->pool_of[d->ledger.at[i].task.generation % GENERATIONS];
    bool whole = a->piece.parent < 0;
    if (sign > 0 && !*n) d->fed = true;
    *n += sign > 0 ? 1 : -1;
    if (sign > 0) a->work = whole ? tasks_px(&d->ledger, i) : deal_work(d, i);
    *(whole ? &d->pool_px : &d->pool_work) += sign * a->work;
}

/* Entry i enters a list (sign 1), or leaves it (-1). */
static void count_left(struct deal *d, int32_t i, double sign)
{
    const struct account *a = deal_account(d, i);
    bool left = a->place != COMPUTED && a->place != ASIDE;
    if (a->piece.parent < 0 && left) d->left_px += sign * tasks_px(&d->ledger, i);
}

void deal_take(struct deal *d, int32_t i)
{
    const struct account *a = deal_account(d, i);
    count_left(d, i, -1);
    list_remove(&d->ledger, list_of(d, i), i);
    if (a->place == IN_POOL) count_pool(d, i, -1);
    d->n_promised -= a->place == PROMISED;
    if (a->place == COMPUTED) deal_mark(d, a->owner);
}

void deal_put(struct deal *d, int32_t i, enum place place, int32_t owner)
{
    deal_account(d, i)->place = place;
    deal_account(d, i)->owner = owner;
    list_push_back(&d->ledger, list_of(d, i), i);
    count_left(d, i, 1);
    if (place == IN_POOL) count_pool(d, i, 1);
    d->n_promised += place == PROMISED;
    if (place == COMPUTED) deal_mark(d, owner);
}

void deal_put_first(struct deal *d, int32_t i)
{
    deal_account(d, i)->place = IN_POOL;
    deal_account(d, i)->owner = -1;
    list_push_front(&d->ledger, &d->pool, i);
    count_left(d, i, 1);
    count_pool(d, i, 1);
}

bool deal_bad(const struct deal *d, int32_t i)
{
    return blame_bad(&d->blame, &d->ledger, i, deal_account(d, i)->alone);
}

void deal_put_last(struct deal *d, int32_t i)
{
    deal_put(d, i, deal_bad(d, i) ? ASIDE : IN_POOL, -1);
}

/* The owner of entry i, which is on no list, is gone. The entry is the next to be given, or the
 * last if slots were lost over it, unless other slots have a copy or a piece, or have computed it.
 * If it is bad, it is put aside although others have a copy: they may hang. */
static void put_back(struct deal *d, int32_t i)
{
    const struct account *a = deal_account(d, i);
    int32_t lost = blame_sum(&d->blame, &d->ledger, i);
    bool bad = a->alone || lost >= d->blame.most, cut = pieces_exist(&d->ledger, i);
    if (cut || (a->copies && !bad)) deal_put(d, i, OUT, -1);
    else if (a->owing >= 0) deal_put(d, i, COMPUTED, a->owing);
    else if (lost || deal_bad(d, i)) deal_put_last(d, i);
    else deal_put_first(d, i);
}

/* Entry i, which has no pieces, leaves the ledger: no slot owes its pixels any more. */
static void leave(struct deal *d, int32_t i)
{
    deal_take(d, i);
    const struct task *t = &d->ledger.at[i].task;
    int32_t k;
    while ((k = deal_account(d, i)->owing) >= 0)
        deal_outrun(d, k, tasks_find(&d->slots[k].has, t->frame, t->id));
    blame_forget(&d->blame, t);
    pieces_remove(&d->ledger, i);
}

void deal_forget_pieces(struct deal *d, int32_t i)
{
    int32_t j;
    while ((j = pieces_leaf(&d->ledger, i)) >= 0) leave(d, j);
}

void deal_commit(struct deal *d, int32_t i, struct sched_actions *out)
{
    do {
        int32_t parent = pieces_parent(&d->ledger, i);
        sched_act(out, SCHED_COMMIT, deal_account(d, i)->owner, &d->ledger.at[i].task);
        deal_forget_pieces(d, i);
        leave(d, i);
        i = parent;
    } while (i >= 0 && !pieces_exist(&d->ledger, i));
}

/* ---- copies ---------------------------------------------------------------------------------- */

static struct task_list *copies_on(struct slot *s, enum copy_list list)
{
    switch (list) {
    case HELD: return &s->held;
    case SHARED: return &s->shared;
    case OWED: return &s->owed;
    case OUTRUN: break;
    }
    return &s->outrun;
}

static void move_copy(struct slot *s, int32_t c, enum copy_list to)
{
    list_remove(&s->has, copies_on(s, deal_copy(s, c)->list), c);
    list_push_back(&s->has, copies_on(s, to), c);
    deal_copy(s, c)->list = to;
}

void deal_share(struct deal *d, int32_t i)
{
    const struct task *t = &d->ledger.at[i].task;
    struct slot *s = &d->slots[deal_account(d, i)->latest];
    int32_t c = tasks_find(&s->has, t->frame, t->id);
    if (c < 0 || deal_copy(s, c)->list != HELD) return;
    move_copy(s, c, SHARED);
    deal_mark(d, deal_account(d, i)->latest);
}

/* Slot k, which owes the pixels of its copy c, owes them no more. */
static void forgive(struct deal *d, int32_t k, int32_t c)
{
    const struct slot *s = &d->slots[k];
    const struct task *t = &s->has.at[c].task;
    int32_t i = tasks_find(&d->ledger, t->frame, t->id);
    int32_t *at = &deal_account(d, i)->owing;
    while (*at != k) {
        const struct slot *other = &d->slots[*at];
        at = &deal_copy(other, tasks_find(&other->has, t->frame, t->id))->next;
    }
    *at = deal_copy(s, c)->next;
}

void deal_drop_copy(struct deal *d, int32_t k, int32_t c)
{
    struct slot *s = &d->slots[k];
    enum copy_list list = deal_copy(s, c)->list;
    if (list == OWED) forgive(d, k, c);
    list_remove(&s->has, copies_on(s, list), c);
    if (!deal_computed(s, c)) deal_forget(d, k, c);
    tasks_remove(&s->has, c);
    deal_mark(d, k);
}

void deal_outrun(struct deal *d, int32_t k, int32_t c)
{
    struct slot *s = &d->slots[k];
    if (deal_copy(s, c)->list == OWED) forgive(d, k, c);
    else deal_forget(d, k, c);
    move_copy(s, c, OUTRUN);
    deal_mark(d, k);
}

void deal_owe(struct deal *d, int32_t k, int32_t c, int32_t i)
{
    struct slot *s = &d->slots[k];
    move_copy(s, c, OWED);
    deal_forget(d, k, c);
    deal_copy(s, c)->next = deal_account(d, i)->owing;
    deal_account(d, i)->owing = k;
    deal_mark(d, k);
}

bool deal_owes(const struct deal *d, int32_t k, int32_t i)
{
    const struct task *t = &d->ledger.at[i].task;
    int32_t c = deal_account(d, i)->owing < 0 ? -1 : tasks_find(&d->slots[k].has, t->frame, t->id);
    return c >= 0 && deal_copy(&d->slots[k], c)->list == OWED;
}

void deal_give(struct deal *d, int32_t k, int32_t i, int64_t now, struct sched_actions *out)
{
    struct slot *s = &d->slots[k];
    const struct task_entry *e = &d->ledger.at[i];
    struct account *a = deal_account(d, i);
    int32_t c = tasks_find(&s->has, e->task.frame, e->task.id);
    if (c >= 0) deal_drop_copy(d, k, c); /* an earlier task with the same key */
    if (a->copies) deal_share(d, i);
    c = tasks_add(&s->has, &e->task, e->frame_w);
    *deal_copy(s, c) = (struct copy){.given_us = now,
        .work = deal_work(d, i),
        .came_as = pieces_came_as(&d->ledger, i),
        .tries = ++a->tries,
        .list = a->copies ? SHARED : HELD,
        .next = -1};
    deal_foresee(d, k, c);
    list_push_back(&s->has, copies_on(s, deal_copy(s, c)->list), c);
    s->asked = false;
    a->copies++;
    a->latest = k;
    a->progress_us = now;
    deal_put(d, i, OUT, -1);
    deal_mark(d, k);
    sched_act(out, SCHED_GIVE, k, &e->task);
    out->at[out->n - 1].origin_id = pieces_came_as(&d->ledger, i);
}

void deal_lose_copy(struct deal *d, int32_t k, int32_t c)
{
    const struct task *t = &d->slots[k].has.at[c].task;
    int32_t i = tasks_find(&d->ledger, t->frame, t->id);
    bool computed = deal_computed(&d->slots[k], c);
    deal_drop_copy(d, k, c);
    if (i < 0) return; /* committed already */
    const struct account *a = deal_account(d, i);
    if (!computed) deal_account(d, i)->copies--;
    if (a->place != (computed ? COMPUTED : OUT) || (computed && a->owner != k)) return;
    deal_take(d, i);
    put_back(d, i);
}

/* Tasks go back to the front of the pool in their order, unless other slots have them. */
void deal_lose_after(struct deal *d, int32_t k, struct task_list *l, int32_t keep)
{
    while (l->count > keep) deal_lose_copy(d, k, l->tail);
}

void deal_lose(struct deal *d, int32_t k, struct task_list *l) { deal_lose_after(d, k, l, 0); }

void deal_reclaim(struct deal *d, struct task_list *l)
{
    while (l->count) {
        int32_t i = l->tail;
        deal_take(d, i);
        put_back(d, i);
    }
}
