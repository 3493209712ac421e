/*
 * The hub: the ledger. Each entry is on the one list that its owner, its state and its pieces name.
 */
#include "sched/hub_int.h"

static struct task_list *list_of(struct hub *h, int32_t i)
{
    const struct hub_task *t = hub_task(h, i);
    if (t->owner < 0) return t->piece >= 0 ? &h->cut : t->parent >= 0 ? &h->rest : &h->pool;
    return t->computed ? &h->nodes[t->owner].computed : &h->nodes[t->owner].held;
}

/* Entry i enters the list `held` of its owner, or leaves it. */
static void count(struct hub *h, int32_t i, int32_t more)
{
    const struct hub_task *t = hub_task(h, i);
    if (t->owner < 0 || t->computed) return;
    struct hub_node *s = &h->nodes[t->owner];
    s->held_px += more * tasks_px(&h->ledger, i);
    if (t->piece < 0) {
        h->left_px += more * tasks_px(&h->ledger, i);
        return;
    }
    s->cut += more;
    s->cut_px += more * tasks_px(&h->ledger, i);
}

void hub_unlist(struct hub *h, int32_t i)
{
    list_remove(&h->ledger, list_of(h, i), i);
    h->n_computed -= hub_task(h, i)->computed;
    count(h, i, -1);
}

void hub_enlist(struct hub *h, int32_t i, int32_t k, bool computed)
{
    hub_task(h, i)->owner = k;
    hub_task(h, i)->computed = computed;
    h->n_computed += computed;
    list_push_back(&h->ledger, list_of(h, i), i);
    count(h, i, 1);
}

void hub_note_id(struct hub *h, const struct task *t)
{
    const struct frame_size *f = frames_find(&h->frames, t->frame);
    if (!f) f = frames_set(&h->frames, t->frame, 0, 0);
    uint32_t *top = frames_extra(&h->frames, f);
    if (t->id > *top) *top = t->id;
}

uint32_t hub_came_as(const struct hub *h, int32_t i)
{
    while (hub_task(h, i)->parent >= 0) i = hub_task(h, i)->parent;
    return h->ledger.at[i].task.id;
}

/* Entry i has these pieces now: the first of them, or -1. */
static void set_piece(struct hub *h, int32_t i, int32_t piece)
{
    struct hub_task *t = hub_task(h, i);
    count(h, i, -1);
    if (t->owner < 0) list_remove(&h->ledger, list_of(h, i), i);
    t->piece = piece;
    if (t->owner < 0) list_push_back(&h->ledger, list_of(h, i), i);
    count(h, i, 1);
}

int32_t hub_enter(struct hub *h, int32_t parent, const struct lattice *at)
{
    struct task t = h->ledger.at[parent].task;
    uint32_t *top = frames_extra(&h->frames, frames_find(&h->frames, t.frame));
    t.at = *at;
    t.id = ++*top;
    int32_t i = tasks_add(&h->ledger, &t, h->ledger.at[parent].frame_w);
    const struct hub_task *p = hub_task(h, parent);
    *hub_task(h, i) = (struct hub_task){.owner = -1,
        .from = p->owner,
        .tries = p->tries,
        .parent = parent,
        .piece = -1,
        .before = -1,
        .after = p->piece};
    if (p->piece >= 0) hub_task(h, p->piece)->before = i;
    set_piece(h, parent, i);
    hub_enlist(h, i, -1, false);
    return i;
}

void hub_remove(struct hub *h, int32_t i)
{
    const struct hub_task *t = hub_task(h, i);
    hub_unlist(h, i);
    if (t->after >= 0) hub_task(h, t->after)->before = t->before;
    if (t->before >= 0) hub_task(h, t->before)->after = t->after;
    else if (t->parent >= 0) set_piece(h, t->parent, t->after);
    tasks_remove(&h->ledger, i);
}
