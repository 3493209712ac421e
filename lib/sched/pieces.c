#include "sched/pieces.h"

uint32_t pieces_came_as(const struct task_table *ledger, int32_t i)
{
    while (pieces_parent(ledger, i) >= 0) i = pieces_parent(ledger, i);
    return ledger->at[i].task.id;
}

/* ---- new numbers ----------------------------------------------------------------------------- */

static uint32_t *top_of(const struct frames *ids, uint32_t frame)
{
    return frames_extra(ids, frames_find(ids, frame));
}

void pieces_note_id(struct frames *ids, const struct task *t)
{
    if (!frames_find(ids, t->frame)) frames_set(ids, t->frame, 0, 0);
    uint32_t *top = top_of(ids, t->frame);
    if (t->id > *top) *top = t->id;
}

bool pieces_id_left(const struct frames *ids, const struct task *t)
{
    return *top_of(ids, t->frame) < UINT32_MAX - 1;
}

int32_t pieces_add(
    struct task_table *ledger, struct frames *ids, int32_t parent, const struct lattice *at)
{
    struct task t = ledger->at[parent].task;
    t.at = *at;
    t.id = ++*top_of(ids, t.frame);
    int32_t i = tasks_add(ledger, &t, ledger->at[parent].frame_w);
    int32_t after = pieces_at(ledger, parent)->first;
    *pieces_at(ledger, i) = (struct piece){parent, -1, -1, after};
    if (after >= 0) pieces_at(ledger, after)->before = i;
    pieces_at(ledger, parent)->first = i;
    return i;
}

void pieces_remove(struct task_table *ledger, int32_t i)
{
    const struct piece *p = pieces_at(ledger, i);
    if (p->after >= 0) pieces_at(ledger, p->after)->before = p->before;
    if (p->before >= 0) pieces_at(ledger, p->before)->after = p->after;
    else if (p->parent >= 0) pieces_at(ledger, p->parent)->first = p->after;
    tasks_remove(ledger, i);
}

int32_t pieces_leaf(const struct task_table *ledger, int32_t i)
{
    int32_t j = pieces_at(ledger, i)->first;
    while (j >= 0 && pieces_exist(ledger, j)) j = pieces_at(ledger, j)->first;
    return j;
}

/* ---- cutting --------------------------------------------------------------------------------- */

struct lattice pieces_missing(const struct task_entry *e)
{
    const struct lattice *at = &e->task.at;
    return at->h == 1 ? lattice_cut(at, e->frame_w, e->delivered, at->w) : *at;
}

uint64_t pieces_px(double share_us, double least_us, double pixel_us, double most)
{
    double px = pixel_us > 0 ? fmax(share_us, least_us) / pixel_us : most;
    return (uint64_t)fmax(fmin(px, most), 1);
}

uint64_t pieces_rows(const struct lattice *at, uint64_t px)
{
    if (at->h == 1) return px;
    return px < at->w ? at->w : px - px % at->w;
}

int32_t pieces_cut(struct task_table *ledger, struct frames *ids, int32_t i, uint64_t px)
{
    struct task_entry *e = &ledger->at[i];
    struct lattice at = lattice_cut(&e->task.at, e->frame_w, 0, px);
    e->task.at = lattice_cut(&e->task.at, e->frame_w, px, UINT32_MAX);
    return pieces_add(ledger, ids, pieces_parent(ledger, i), &at);
}
