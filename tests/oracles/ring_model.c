/* The ledger of the ring's checks. */
#include "ring_model.h"

#include <stdlib.h>

struct ring_model *sim_ring_model(struct world *w)
{
    if (!w->note) {
        size_t n = (size_t)w->plan->slots;
        struct ring_model *m = xcalloc(1, sizeof *m + n * sizeof *m->slots);
        for (size_t k = 0; k < n; k++) m->slots[k].victim = m->slots[k].asker = -1;
        w->note = m;
    }
    return w->note;
}

struct rtask *sim_ring_task(struct world *w, const struct task *t)
{
    struct vtask *v = t->frame ? NULL : t->id < (uint32_t)w->n_tasks ? &w->tasks[t->id] : NULL;
    if (!v) return NULL;
    if (!v->note) {
        struct rtask *r = xcalloc(1, sizeof *r);
        r->base = r->from = r->parent = -1;
        v->note = r;
    }
    return v->note;
}

void sim_ring_mark(struct world *w, struct ring_model *m, int32_t k)
{
    struct rslot *s = &m->slots[k];
    bool up = s->state == RING_UP, has = s->held > w->plan->width + s->thieves;
    bool hungry = up && s->asking && s->victim < 0;
    bool rich = up && has && !s->asking && !s->dry && !s->silent;
    m->hungry += hungry - s->hungry;
    m->rich += rich - s->rich;
    s->hungry = hungry;
    s->rich = rich;
}

/* The nearest slot before k that is up, k itself last; -1 if none. */
static int32_t heir_of(const struct world *w, const struct ring_model *m, int32_t k)
{
    const int32_t n = w->plan->slots;
    for (int32_t i = 1; i <= n && m->up; i++) {
        int32_t at = (k - i + n) % n;
        if (m->slots[at].state == RING_UP) return at;
    }
    return -1;
}

int32_t sim_ring_receiver(const struct world *w, const struct ring_model *m, int32_t k)
{
    if (k < 0 || m->slots[k].state == RING_NEW) return -1;
    return m->slots[k].state == RING_UP ? k : heir_of(w, m, k);
}

/* Adds `more` to the tasks of slot k in that place, if k is a slot. */
static void count(struct ring_model *m, enum rplace p, int32_t k, int32_t more)
{
    bool promised = p == RING_ORPHAN && k >= 0 && m->slots[k].state == RING_NEW;
    m->orphans += p == RING_ORPHAN ? more : 0;
    m->computed += p == RING_COMPUTED ? more : 0;
    m->promised += promised ? more : 0;
    if (k < 0) return;
    struct rslot *s = &m->slots[k];
    s->held += p == RING_HELD ? more : 0;
    s->computed += p == RING_COMPUTED ? more : 0;
    s->promised += promised ? more : 0;
}

void sim_ring_enter(
    struct world *w, struct ring_model *m, struct rtask *t, enum rplace p, int32_t k)
{
    int32_t before = t->base;
    count(m, t->place, before, -1);
    t->place = p;
    t->base = k;
    count(m, p, k, 1);
    if (before >= 0) sim_ring_mark(w, m, before);
    if (k >= 0) sim_ring_mark(w, m, k);
}

bool sim_ring_costly(const struct world *w, const struct rtask *t)
{
    int32_t i = 0, blamed = 0;
    while (w->tasks[i].note != t) i++;
    for (; i >= 0; i = ((struct rtask *)w->tasks[i].note)->parent) blamed += w->tasks[i].blamed;
    return blamed >= sim_losses(w->plan);
}

bool sim_ring_bad(const struct world *w, const struct ring_model *m, const struct rtask *t)
{
    return t->alone || m->all_aside || sim_ring_costly(w, t);
}

void sim_ring_hand_on(struct world *w, struct ring_model *m, struct rtask *t, int32_t k)
{
    if (t->place != RING_ORPHAN) t->passes = 0;
    t->from = -1;
    t->lost = m->n_events;
    bool waits = t->parent >= 0 && !m->up;
    enum rplace to = t->cut                  ? RING_CUT
                     : sim_ring_bad(w, m, t) ? RING_ASIDE
                     : waits                 ? RING_REST
                                             : RING_ORPHAN;
    sim_ring_enter(w, m, t, to, to == RING_ORPHAN ? k : -1);
}

/* Is t one of the tasks that slot k computes at once: the first ones that it was given? */
static bool is_begun(const struct world *w, const struct rtask *t, int32_t k)
{
    int32_t before = 0;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct rtask *o = w->tasks[i].note;
        before += o && o->base == k && o->place == RING_HELD && o->given < t->given;
    }
    return before < w->plan->width;
}

/* In the same step an idle node may have taken over what the slot computes, if that is late. */
void sim_ring_hand_over(struct world *w, struct ring_model *m, int32_t k)
{
    if (!w->slots[k].hands_over) return;
    w->slots[k].hands_over = false;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        struct rtask *t = w->tasks[i].note;
        if (!t || t->base != k || t->place != RING_HELD || is_begun(w, t, k)) continue;
        if (w->policy->tries(w->state, k, 0, (uint32_t)i))
            sim_fail(w, "a node that drains keeps tasks that it has not begun", k, i);
        sim_ring_hand_on(w, m, t, k);
    }
}
