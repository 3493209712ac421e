/*
 * deal: the ledger, and the copies that slots hold. Every entry is on the one list that its account
 * names.
 */
#include "sched/deal_int.h"

int32_t deal_enter(struct deal *d, const struct task *t, uint32_t frame_w, int32_t parent)
{
    int32_t i = tasks_add(&d->ledger, t, frame_w);
    if (d->n_accounts < d->ledger.cap) {
        d->n_accounts = d->ledger.cap;
        d->account = xrealloc(d->account, (size_t)d->n_accounts, sizeof *d->account);
    }
    d->account[i] = (struct account){.latest = -1, .parent = parent};
    struct frame_size *f = frames_find(&d->frames, t->frame);
    if (!f) f = frames_set(&d->frames, t->frame, frame_w, 1);
    if (t->id > f->top_id) f->top_id = t->id;
    return i;
}

static struct task_list *list_of(struct deal *d, int32_t i)
{
    struct slot *s = d->ledger.at[i].slot >= 0 ? &d->slots[d->ledger.at[i].slot] : NULL;
    switch (d->account[i].place) {
    case PROMISED: return &s->promised;
    case COMPUTED: return &s->computed;
    case OUT: return &d->out;
    case IN_POOL: break;
    }
    return &d->pool;
}

void deal_take(struct deal *d, int32_t i)
{
    list_remove(&d->ledger, list_of(d, i), i);
    d->n_promised -= d->account[i].place == PROMISED;
    if (d->account[i].place == COMPUTED) deal_mark(d, d->ledger.at[i].slot);
}

void deal_put(struct deal *d, int32_t i, enum place place, int32_t slot)
{
    d->account[i].place = place;
    d->ledger.at[i].slot = slot;
    list_push_back(&d->ledger, list_of(d, i), i);
    d->n_promised += place == PROMISED;
    if (place == COMPUTED) deal_mark(d, slot);
}

void deal_put_first(struct deal *d, int32_t i)
{
    d->account[i].place = IN_POOL;
    d->ledger.at[i].slot = -1;
    list_push_front(&d->ledger, &d->pool, i);
}

/* The owner of entry i, which is on no list, is gone. The entry is the next to be given, unless
 * other slots have a copy or a piece. */
static void put_back(struct deal *d, int32_t i)
{
    const struct account *a = &d->account[i];
    if (a->copies || a->pieces) deal_put(d, i, OUT, -1);
    else deal_put_first(d, i);
}

void deal_forget_pieces(struct deal *d, int32_t i)
{
    for (int32_t j = 0; d->account[i].pieces && j < d->ledger.cap; j++) {
        if (!d->ledger.at[j].live || d->account[j].parent != i) continue;
        deal_forget_pieces(d, j);
        deal_take(d, j);
        tasks_remove(&d->ledger, j);
        d->account[i].pieces--;
    }
}

void deal_commit(struct deal *d, int32_t i, struct sched_actions *out)
{
    while (i >= 0) {
        const struct task *t = &d->ledger.at[i].task;
        int32_t parent = d->account[i].parent;
        sched_act(out, SCHED_COMMIT, d->ledger.at[i].slot, t);
        if (parent < 0) d->left_px -= (double)lattice_count(&t->at);
        deal_forget_pieces(d, i);
        deal_take(d, i);
        tasks_remove(&d->ledger, i);
        i = parent;
        if (i >= 0 && --d->account[i].pieces) return;
    }
}

/* ---- copies ---------------------------------------------------------------------------------- */

void deal_share(struct deal *d, int32_t i)
{
    const struct task *t = &d->ledger.at[i].task;
    struct slot *s = &d->slots[d->account[i].latest];
    int32_t c = tasks_find(&s->has, t->frame, t->id);
    if (c < 0 || s->has.at[c].done) return;
    list_remove(&s->has, &s->held, c);
    list_push_back(&s->has, &s->shared, c);
    s->has.at[c].done = true;
    deal_mark(d, d->account[i].latest);
}

void deal_drop_copy(struct deal *d, int32_t k, int32_t c)
{
    struct slot *s = &d->slots[k];
    list_remove(&s->has, s->has.at[c].done ? &s->shared : &s->held, c);
    tasks_remove(&s->has, c);
    deal_mark(d, k);
}

/* The id of the input task that entry i is, or is a piece of. */
static uint32_t came_as(const struct deal *d, int32_t i)
{
    while (d->account[i].parent >= 0) i = d->account[i].parent;
    return d->ledger.at[i].task.id;
}

void deal_give(struct deal *d, int32_t k, int32_t i, int64_t now, struct sched_actions *out)
{
    struct slot *s = &d->slots[k];
    struct task_entry *e = &d->ledger.at[i];
    struct account *a = &d->account[i];
    int32_t c = tasks_find(&s->has, e->task.frame, e->task.id);
    if (c >= 0) deal_drop_copy(d, k, c); /* an earlier task with the same key */
    if (a->copies) deal_share(d, i);
    c = tasks_add(&s->has, &e->task, e->frame_w);
    s->has.at[c].since_us = now;
    s->has.at[c].tries = ++e->tries;
    s->has.at[c].done = a->copies > 0;
    list_push_back(&s->has, a->copies ? &s->shared : &s->held, c);
    s->asked = false;
    a->copies++;
    a->latest = k;
    e->done = false;
    e->since_us = now;
    deal_put(d, i, OUT, -1);
    deal_mark(d, k);
    sched_act(out, SCHED_GIVE, k, &e->task);
    out->at[out->n - 1].origin_id = came_as(d, i);
}

/* Tasks go back to the front of the pool in their order, unless other slots have them. */
void deal_lose(struct deal *d, int32_t k, struct task_list *l)
{
    struct slot *s = &d->slots[k];
    while (l->count) {
        const struct task *t = &s->has.at[l->tail].task;
        int32_t i = tasks_find(&d->ledger, t->frame, t->id);
        deal_drop_copy(d, k, l->tail);
        if (i < 0) continue; /* committed already */
        d->account[i].copies--;
        if (d->account[i].place != OUT) continue;
        deal_take(d, i);
        put_back(d, i);
    }
}

void deal_reclaim(struct deal *d, struct task_list *l)
{
    while (l->count) {
        int32_t i = l->tail;
        deal_take(d, i);
        d->ledger.at[i].done = false;
        put_back(d, i);
    }
}
