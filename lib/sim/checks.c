/* What must hold of every policy, checked as it acts. */
#include "sim/world.h"

/* Tasks that slot k was given and has not answered. */
static int32_t holding(const struct world *w, int32_t k)
{
    int32_t n = 0;
    for (int32_t i = 0; i < w->plan->tasks; i++)
        n += w->tasks[i].owner == k && !w->tasks[i].done && !w->tasks[i].committed;
    return n;
}

void check_give(struct world *w, const struct sched_action *a)
{
    struct vslot *s = &w->slots[a->slot];
    struct vtask *t = &w->tasks[a->task.id];
    w->result->gives++;
    if (!s->up) fail(w, "work given to a slot that is not up", a->slot, a->task.id);
    if (!t->known || t->committed) fail(w, "work given that is not to do", a->slot, a->task.id);
    if (t->owner >= 0) fail(w, "work given twice", t->owner, a->task.id);
    bool chosen = !t->given && t->to >= 0 && t->to < w->plan->slots && !w->slots[t->to].lost;
    if (chosen && t->to != a->slot) fail(w, "work of one slot given to another", t->to, a->slot);
    t->owner = a->slot;
    t->given = true;
    t->done = false;
    if (a->task.to != a->slot && holding(w, a->slot) > 1 + w->plan->depth)
        fail(w, "more given than the depth allows", a->slot, a->task.id);
}

void check_commit(struct world *w, const struct sched_action *a)
{
    struct vtask *t = &w->tasks[a->task.id];
    w->result->commits++;
    if (t->committed) fail(w, "a second commit", a->task.id, 0);
    if (t->sent != FRAME_W) fail(w, "a commit before the last pixel", a->task.id, (int64_t)t->sent);
    t->committed = true;
}

void check_end(struct world *w)
{
    if (w->ended) fail(w, "a second end", 0, 0);
    w->ended = true;
    w->result->end_us = w->now_us;
    for (int32_t i = 0; i < w->plan->tasks; i++)
        if (!w->tasks[i].committed) fail(w, "the end, with work uncommitted", i, w->tasks[i].owner);
}

/* What the policy has, by what it was told: an uncommitted task waits, or its owner is up. */
void check_owners(struct world *w)
{
    int64_t pool = 0;
    for (int32_t i = 0; i < w->plan->tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        if (!t->known || t->committed) continue;
        if (t->owner < 0) pool++;
        else if (!w->slots[t->owner].up) fail(w, "work left with a slot that is gone", t->owner, i);
    }
    if (w->policy->waiting(w->state) > pool) fail(w, "more waiting than there is", pool, 0);
}
