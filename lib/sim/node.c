/*
 * Nodes: the policy between a slot's link and its worker. Its messages go up the link; its tasks
 * reach the worker at once. So node.c and slots.c call each other.
 */
#include "sim/world.h"

/* A false message: GIVE of a task that it perhaps does not have, NONE or ASK, to a random node. */
static void say_false(struct world *w, int32_t k)
{
    static const enum ring_kind kinds[] = {RING_GIVE, RING_GIVE, RING_NONE, RING_ASK, RING_HEIR};
    struct sched_event e = {.kind = SCHED_RING, .ring.next = -1};
    e.ring.kind = kinds[(int)(sim_draw(w) * 5)];
    e.ring.peer = (int32_t)(sim_draw(w) * (w->plan->slots + 2)) - 1;
    e.task.id = (uint32_t)(sim_draw(w) * w->plan->tasks);
    w->result->garbage++;
    sim_say(w, k, e);
}

static void say_ring(struct world *w, int32_t k, const struct sched_action *a)
{
    struct vslot *s = &w->slots[k];
    w->result->messages++;
    w->result->passed += a->ring.kind == RING_GIVE;
    w->result->reports += a->ring.kind == RING_CRASHED;
    if (a->ring.kind == RING_ASK) s->asks = true;
    if (w->plan->p_false > 0 && sim_draw(w) < w->plan->p_false) say_false(w, k);
    sim_say(w, k, (struct sched_event){.kind = SCHED_RING, .task = a->task, .ring = a->ring});
}

static void node_act(struct world *w, int32_t k, const struct sched_action *a)
{
    struct vslot *s = &w->slots[k];
    if (w->checks && w->checks->node_action) w->checks->node_action(w, k, a);
    switch (a->kind) {
    case SCHED_GIVE:
        sim_append_task(&s->queue, &a->task);
        sim_start_next(w, k);
        break;
    case SCHED_SAY: say_ring(w, k, a); break;
    case SCHED_ASK_FLUSH: sim_hand_over(w, k); break;
    case SCHED_LEAVE:
    case SCHED_BLAME:
    case SCHED_ABANDON:
    case SCHED_COMMIT: break;
    case SCHED_END:
    case SCHED_STOP:
        s->node_ended = true;
        sim_hand_over(w, k);
        break;
    }
}

/* An action may make the worker answer, which is the node's next event: one list holds the
 * actions of both. */
void sim_node_step(struct world *w, int32_t k, struct sched_event e)
{
    struct vslot *s = &w->slots[k];
    struct sched_actions *acts = &w->node_acts;
    bool within = acts->n > 0;
    if (e.kind == SCHED_TASK && e.from >= 0 && s->asks) {
        w->result->steals++;
        s->asks = false;
    }
    if (w->checks && w->checks->node_event) w->checks->node_event(w, k, &e);
    w->plan->node->step(s->node, &e, w->now_us, acts);
    if (within) return;
    for (size_t i = 0; i < acts->n; i++) {
        struct sched_action a = acts->at[i];
        node_act(w, k, &a);
    }
    acts->n = 0;
    sim_schedule_wake(w, w->plan->node, s->node, k);
}

void sim_node_begin(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    s->node = w->plan->node->create(&(struct sched_params){0});
    s->node_ended = s->asks = false;
    s->wake_us = INT64_MAX;
    sim_node_step(w, k, (struct sched_event){.kind = SCHED_SLOTS, .n = 1, .from = -1});
    sim_node_step(w, k, (struct sched_event){.kind = SCHED_UP, .n = w->plan->width, .from = -1});
}

void sim_node_wake(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    s->wake_us = INT64_MAX;
    if (w->plan->node->wake_us(s->node) <= w->now_us)
        sim_node_step(w, k, (struct sched_event){.kind = SCHED_WAKE, .from = -1});
    else sim_schedule_wake(w, w->plan->node, s->node, k);
}
