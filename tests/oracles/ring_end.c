/*
 * Checks of the ring's endgame: pieces of tasks. The hub's pieces without a node are not known here
 * until they are given.
 */
#include "ring_model.h"

static struct rtask *at(const struct world *w, int32_t id) { return w->tasks[id].note; }

/* The smallest task of the ledger, but the latest of equal ones, that has these pixels; -1: none.
 * That is the task which `piece` is a piece of. */
static int32_t parent_of(const struct world *w, const struct task *piece)
{
    int32_t found = -1;
    uint64_t least = UINT64_MAX;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct rtask *t = at(w, i);
        const struct lattice *l = &w->tasks[i].task.at;
        bool there = t && t->place != RING_ABSENT && t->place != RING_REST;
        if (!there || i == (int32_t)piece->id || lattice_count(l) > least) continue;
        if (lattice_offset(l, w->frame_w, &piece->at) < 0) continue;
        found = i;
        least = lattice_count(l);
    }
    return found;
}

/* Another piece of the same task has some of these pixels. */
static bool overlaps(const struct world *w, int32_t parent, const struct task *piece)
{
    const struct lattice *whole = &w->tasks[parent].task.at;
    int64_t n0 = lattice_offset(whole, w->frame_w, &piece->at);
    int64_t n1 = n0 + (int64_t)lattice_count(&piece->at);
    for (int32_t i = w->plan->tasks; i < w->n_tasks; i++) {
        const struct rtask *t = at(w, i);
        if (!t || t->parent != parent || i == (int32_t)piece->id || t->place == RING_REST) continue;
        int64_t m0 = lattice_offset(whole, w->frame_w, &w->tasks[i].task.at);
        if (m0 < n1 && n0 < m0 + (int64_t)lattice_count(&w->tasks[i].task.at)) return true;
    }
    return false;
}

bool sim_ring_piece(struct world *w, struct ring_model *m, const struct sched_action *a)
{
    const struct rslot *s = &m->slots[a->slot];
    int32_t id = (int32_t)a->task.id, parent = parent_of(w, &a->task);
    struct vtask *v = sim_vtask_at(w, a->task.id);
    struct rtask *t = v ? sim_ring_task(w, &a->task) : NULL;
    if (!t || parent < 0 || (t->parent >= 0 && t->place != RING_REST) || v->committed) {
        sim_fail(w, "a task is given that is no piece of another one", a->slot, id);
        return false;
    }
    bool alone = at(w, parent)->place == RING_ASIDE || at(w, parent)->alone;
    if (alone) { /* a half of a task that has cost nodes */
        if (!m->input_ended || overlaps(w, parent, &a->task))
            sim_fail(w, "a task is cut that must not be", a->slot, id);
        at(w, parent)->alone = t->alone = true;
        if (at(w, parent)->place == RING_ASIDE) sim_ring_enter(w, m, at(w, parent), RING_CUT, -1);
    }
    if (!alone && (!w->plan->params.endgame || !m->input_ended))
        sim_fail(w, "a piece is given before the endgame", a->slot, id);
    if (!alone && (!s->asking || s->victim >= 0 || m->rich))
        sim_fail(w, "a node gets a piece that could get a task, or wants none", a->slot, id);
    if (overlaps(w, parent, &a->task)) sim_fail(w, "pieces overlap", parent, id);
    for (int32_t i = parent; i >= 0 && !alone; i = at(w, i)->parent)
        if (at(w, i)->base == a->slot)
            sim_fail(w, "a node gets a piece of its own task", a->slot, id);
    m->open += t->place == RING_ABSENT;
    m->cuts += !at(w, parent)->cut;
    at(w, parent)->cut = true;
    m->taken_over |= !alone;
    t->parent = parent;
    t->from = a->from;
    v->task = a->task;
    sim_ring_enter(w, m, t, RING_ORPHAN, a->slot);
    return true;
}

void sim_ring_forget(struct world *w, struct ring_model *m, struct rtask *t)
{
    if (t->place == RING_ABSENT) return;
    for (int32_t i = w->plan->tasks; t->cut && i < w->n_tasks; i++)
        if (at(w, i) && at(w, i)->parent >= 0 && at(w, at(w, i)->parent) == t)
            sim_ring_forget(w, m, at(w, i));
    m->open--;
    m->cuts -= t->cut;
    t->cut = false;
    sim_ring_enter(w, m, t, RING_ABSENT, -1);
}
