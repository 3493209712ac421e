/*
 * Checks of a node of the ring (default rules) after each action. The node's tasks, and those of
 * its worker, are recorded apart from the hub's view.
 */
#include "ring_model.h"

/* Tasks that a node may feed its worker beyond the current ones; also if pauses, and wrong
 * answers, make its link seem slow. */
#define SLACK 1
#define SLACK_MOST 2501

/* True if a node's measurements of its worker are valid. */
static bool is_steady(const struct world *w)
{
    const struct sim_plan *p = w->plan;
    double faults = p->p_pause + p->p_silence + p->p_slow + p->p_garbage;
    return p->width == 1 && faults <= 0 && p->start.build_s <= 0;
}

/* Before the next event of node k: all due actions were taken. */
static void settle(struct world *w, struct rslot *s, int32_t k)
{
    const int32_t width = w->plan->width;
    double most_px = s->had_px * s->part + sim_ring_model(w)->most_px;
    if (s->asker >= 0 && !s->answers) sim_fail(w, "an ask was not answered", k, s->asker);
    if (s->in_time && s->given_px > most_px)
        sim_fail(w, "a node gives more than its share of its queue", (int64_t)s->given_px, k);
    s->asker = -1;
    if (s->queued && s->fed < width)
        sim_fail(w, "a worker waits while its node has tasks", k, s->queued);
    if (!s->queued && !s->fed && s->has_place && !s->asked && !s->ended)
        sim_fail(w, "an idle node does not ask", k, 0);
}

static void node_begins(struct world *w, struct rslot *s, int32_t k)
{
    uint64_t others = ~(UINT64_C(1) << k);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        struct rtask *t = w->tasks[i].note;
        if (t) t->queued &= others, t->fed &= others;
    }
    s->queued = s->fed = 0;
    s->has_px = s->had_px = s->given_px = 0;
    s->has_place = s->asked = s->ended = false;
    s->asker = -1;
}

/* A worker cannot be late before the shortest task time has passed. */
static void node_takes_ring(struct world *w, struct rslot *s, int32_t k, const struct ring *r)
{
    const struct vslot *v = &w->slots[k];
    double shortest_us = w->plan->cost_us * w->plan->rows / v->power;
    if (r->kind == RING_PLACE) s->has_place = true;
    /* before its PLACE, asks were for an earlier node */
    if (r->kind != RING_ASK || !s->has_place) return;
    s->asker = r->peer;
    s->answers = 0;
    s->given_px = 0;
    s->had_px = s->has_px;
    s->part = 1 / (1 + (r->takes ? r->takes / 100. : 1));
    s->in_time =
        is_steady(w) && v->clock.busy && (double)(w->now_us - v->clock.began_us) < shortest_us;
}

/* It was computed, or given away, or all of its pixels have come. */
static void node_forgets(struct rslot *s, int32_t k, struct rtask *t, const struct task *task)
{
    uint64_t bit = UINT64_C(1) << k;
    if (!((t->queued | t->fed) & bit)) return;
    s->queued -= (t->queued & bit) != 0;
    s->fed -= (t->fed & bit) != 0;
    s->has_px -= px_of(task);
    t->queued &= ~bit;
    t->fed &= ~bit;
}

void sim_ring_node_event(struct world *w, int32_t k, const struct sched_event *e)
{
    struct rslot *s = &sim_ring_model(w)->slots[k];
    struct rtask *t = e->kind == SCHED_TASK || e->kind == SCHED_DONE || e->kind == SCHED_FAIL
                          ? sim_ring_task(w, &e->task)
                          : NULL;
    uint64_t bit = UINT64_C(1) << k;
    if (e->kind == SCHED_SLOTS) node_begins(w, s, k);
    else settle(w, s, k);
    if (e->kind == SCHED_RING) node_takes_ring(w, s, k, &e->ring);
    if (e->kind == SCHED_INPUT_END) s->ended = true;
    if (e->kind == SCHED_TASK) s->asked = false;
    if (e->kind == SCHED_TASK && !((t->queued | t->fed) & bit)) {
        t->queued |= bit;
        t->came[k] = sim_ring_model(w)->came++;
        s->queued++;
        s->has_px += px_of(&e->task);
    }
    if ((e->kind == SCHED_DONE || e->kind == SCHED_FAIL) && t && t->fed & bit)
        node_forgets(s, k, t, &e->task);
}

static void check_give_away(
    struct world *w, struct rslot *s, int32_t k, struct rtask *t, const struct sched_action *a)
{
    uint64_t bit = UINT64_C(1) << k;
    if (!t || !(t->queued & bit)) {
        sim_fail(w, "a node gives a task that it does not have", k, (int32_t)a->task.id);
        return;
    }
    if (a->ring.peer != s->asker)
        sim_fail(w, "a node gives a task to a node that has not asked", k, a->ring.peer);
    if (s->asked) sim_fail(w, "a node that has asked gives a task", k, (int32_t)a->task.id);
    for (int32_t i = 0; i < w->n_tasks && w->plan->p_false <= 0; i++) {
        const struct rtask *other = w->tasks[i].note;
        if (other && other->queued & bit && other->came[k] < t->came[k])
            sim_fail(w, "a node gives tasks out of order", k, (int32_t)a->task.id);
    }
    node_forgets(s, k, t, &a->task);
    s->given_px += px_of(&a->task);
    s->answers++;
}

static void check_node_says(
    struct world *w, struct rslot *s, int32_t k, const struct sched_action *a)
{
    switch (a->ring.kind) {
    case RING_ASK:
        if (s->asked) sim_fail(w, "a node asks again before the answer", k, 0);
        if (!s->has_place || s->ended) sim_fail(w, "a node without a place asks", k, 0);
        s->asked = true;
        break;
    case RING_NONE:
        if (s->answers++ || a->ring.peer != s->asker)
            sim_fail(w, "a node answers NONE, and no node has asked", k, a->ring.peer);
        break;
    case RING_GIVE: check_give_away(w, s, k, sim_ring_task(w, &a->task), a); break;
    default: sim_fail(w, "a node sends a message that it must not send", k, a->ring.kind);
    }
}

static void check_feed(struct world *w, struct rslot *s, int32_t k, const struct sched_action *a)
{
    struct rtask *t = sim_ring_task(w, &a->task);
    uint64_t bit = UINT64_C(1) << k;
    int32_t slack = is_steady(w) ? SLACK : SLACK_MOST * w->plan->width;
    if (!t || !(t->queued & bit)) {
        sim_fail(w, "a node feeds a task that is not in its queue", k, (int32_t)a->task.id);
        return;
    }
    t->queued &= ~bit;
    t->fed |= bit;
    s->queued--;
    if (++s->fed > w->plan->width + slack)
        sim_fail(w, "a node feeds more tasks than its worker has room for", k, s->fed);
}

void sim_ring_node_action(struct world *w, int32_t k, const struct sched_action *a)
{
    struct rslot *s = &sim_ring_model(w)->slots[k];
    if (a->kind == SCHED_SAY) check_node_says(w, s, k, a);
    if (a->kind == SCHED_GIVE) check_feed(w, s, k, a);
    if (a->kind == SCHED_COMMIT) node_forgets(s, k, sim_ring_task(w, &a->task), &a->task);
}
