/*
 * Checks of the ring: tasks that cost nodes. Which tasks are aside, by the rules of blame.h, and
 * when they are tried once more.
 */
#include "ring_model.h"

int32_t sim_ring_home(const struct ring_model *m, const struct task *t)
{
    const int32_t n = m->n;
    return t->to >= 0 && t->to < n ? t->to : (int32_t)(t->id % (uint32_t)n);
}

/* Tasks that are not bad themselves have owners again. */
void sim_ring_note_well(struct world *w, struct ring_model *m)
{
    m->well = true;
    if (!m->all_aside) return;
    m->all_aside = false;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        struct rtask *t = w->tasks[i].note;
        if (t && t->place == RING_ASIDE && !sim_ring_bad(w, m, t))
            sim_ring_enter(w, m, t, RING_ORPHAN, sim_ring_home(m, &w->tasks[i].task));
    }
}

/* Slot k cannot compute t, which goes to the next node. */
void sim_ring_note_fail(struct world *w, struct ring_model *m, struct rtask *t, int32_t k)
{
    if (t->base != k || !sim_ring_works(&m->slots[k])) return;
    if (t->place != RING_HELD && t->place != RING_COMPUTED) return;
    const enum rstate state = m->slots[k].state;
    sim_ring_hand_on(w, m, t, k);
    m->slots[k].state = RING_GONE;
    if (t->place == RING_ORPHAN) {
        m->up -= state == RING_UP;
        int32_t heir = sim_ring_receiver(w, m, k);
        m->up += state == RING_UP;
        m->slots[k].state = state;
        sim_ring_enter(w, m, t, RING_ORPHAN, heir < 0 ? k : heir);
    }
    m->slots[k].state = state;
}

/* A node was lost over a task: then it may be put aside, with others that the node had. */
void sim_ring_note_blame(struct world *w, struct ring_model *m, const struct sched_action *a)
{
    struct rtask *t = sim_ring_task(w, &a->task);
    if (!t || t->lost != m->n_events)
        sim_fail(w, "a node is lost over a task that it did not have", a->slot, a->task.id);
    m->all_aside |= !m->well && ++m->blames >= sim_losses(w->plan);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        t = w->tasks[i].note;
        bool lost = t && t->lost == m->n_events && t->place >= RING_ORPHAN && t->place != RING_CUT;
        if (lost && (t->place == RING_ORPHAN || t->place == RING_REST) && sim_ring_bad(w, m, t))
            sim_ring_enter(w, m, t, RING_ASIDE, -1);
    }
}

/* A task that was aside is tried: no node has another one to compute. */
void sim_ring_check_tried(struct world *w, struct ring_model *m, struct rtask *t, int32_t k)
{
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct rtask *other = w->tasks[i].note;
        bool now = other && other->tried == m->n_events; /* another one that is tried */
        if (other && other->place == RING_HELD && !other->cut && !other->alone && !now)
            sim_fail(w, "a task is tried again while others are to be done", i, k);
    }
    t->alone |= sim_ring_costly(w, t);
    t->tried = m->n_events;
    t->from = -1;
    sim_ring_enter(w, m, t, RING_ORPHAN, k);
}
