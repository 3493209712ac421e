/*
 * Slots. A slot is a process that takes its tasks in order. When it ends, messages under way to it
 * and its current task are void; messages that it had sent are not.
 */
#include "sim/world.h"

#include <stdlib.h>

#define RESTART_US 500000 /* from the death of a worker to its next hello */

/* ---- the worker ------------------------------------------------------------------------------ */

/* Sends to the fan; a node, if there is one, gets it at once. */
static void answer(struct world *w, int32_t k, struct sched_event e)
{
    sim_say(w, k, e);
    e.slot = 0;
    e.frame_w = w->frame_w;
    if (w->plan->node) sim_node_step(w, k, e);
}

/*
 * A wrong answer: about an unknown task, another slot's task, or pixels outside the task.
 */
static struct sched_event garbled(struct world *w, struct sched_event e)
{
    double u = sim_draw(w);
    w->result->garbage++;
    if (u < .3) e.task.id = UINT32_MAX; /* no piece has it */
    else if (u < .6) e.task.id = (uint32_t)(sim_draw(w) * w->plan->tasks);
    else if (e.kind == SCHED_PIXELS) e.task.at.x += 1 + (uint32_t)(sim_draw(w) * 70);
    else e.task.frame = 99;
    return e;
}

static void answer_twice_or_worse(struct world *w, int32_t k, struct sched_event e)
{
    if (sim_draw(w) < w->plan->p_garbage) answer(w, k, garbled(w, e));
    answer(w, k, e);
    if (sim_draw(w) >= w->plan->p_twice) return;
    w->result->twice++;
    answer(w, k, e);
}

/* Sends pixels in one piece if times are measured, else in a few. */
static void send_pixels(struct world *w, int32_t k, const struct task *t)
{
    struct sched_event e = {.kind = SCHED_PIXELS, .task = *t};
    uint64_t n0 = 0, all = lattice_count(&t->at);
    uint64_t most = w->plan->work ? all : 1 + (uint64_t)(sim_draw(w) * 2 * w->frame_w);
    while (n0 < all) {
        e.task.at = lattice_cut(&t->at, w->frame_w, n0, most);
        n0 += lattice_count(&e.task.at);
        answer_twice_or_worse(w, k, e);
    }
}

/* At power 1. */
static double cost_us(struct world *w, const struct task *t)
{
    if (w->plan->work) return sim_work_us(w->plan->work, t);
    uint64_t n = lattice_count(&t->at);
    return w->plan->cost_us * exp(4 * sim_draw(w)) * (double)n / FRAME_W;
}

void sim_start_next(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    if (s->clock.busy || s->prepares || s->stalled || !s->alive) return;
    if (s->queue.first == s->queue.n) return;
    const struct task *t = &s->queue.at[s->queue.first];
    double us = sim_refuses(w, k, t->generation) ? 1 : cost_us(w, t);
    w->cost_us += us;
    sim_clock_begin(&s->clock, w->now_us);
    sim_work_begin(w, k, SIM_COMPUTED, us);
}

void sim_hand_over(struct world *w, int32_t k)
{
    struct sim_tasks *held = &w->slots[k].held;
    for (size_t i = held->first; i < held->n; i++) send_pixels(w, k, &held->at[i]);
    held->first = held->n = 0;
}

/* The task costs the slot, or fails. The fan starts the slot again, unless it drains. */
static void poisoned(struct world *w, int32_t k, const struct task *t, bool said)
{
    bool drains = w->slots[k].drains;
    const int64_t each = POISON_TRIES + (int64_t)sim_losses(w->plan) * w->plan->slots;
    const int64_t most = each * (int64_t)w->n_poison * (1 + w->result->kills);
    if (++w->result->poisoned > most) sim_fail(w, "poison costs too many slots", most, k);
    if (said) {
        answer(w, k, (struct sched_event){.kind = SCHED_FAIL, .task = *t, .from = -1});
        sim_start_next(w, k);
        return;
    }
    sim_end_slot(w, k);
    sim_say(w, k, (struct sched_event){.kind = SCHED_GONE});
    if (!drains) sim_schedule(w, w->now_us + RESTART_US, k, (struct sim_event){.kind = SIM_RETURN});
}

static void computed(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    if (s->hung) return;
    int64_t wall_us = w->now_us - s->clock.began_us;
    sim_work_end(w, k);
    sim_clock_end(&s->clock, w->now_us);
    if (s->stalled) return; /* silent for ever */
    struct task t = s->queue.at[s->queue.first++];
    const struct poison *poison = sim_poison_in(w, &t);
    if (sim_refuses(w, k, t.generation)) {
        w->result->refused++;
        answer(
            w, k, (struct sched_event){.kind = SCHED_FAIL, .task = t, .refused = true, .from = -1});
        sim_start_next(w, k);
        return;
    }
    if (poison) {
        poisoned(w, k, &t, poison->said);
        return;
    }
    struct sched_event e = {.kind = SCHED_DONE, .task = t, .wall_us = wall_us, .from = -1};
    w->result->computed++;
    answer_twice_or_worse(w, k, e);
    if (w->plan->concentrate) sim_append_task(&s->held, &t);
    else send_pixels(w, k, &t);
    sim_start_next(w, k);
}

/* State that was under way to an earlier process may arrive as well. */
static void build(struct world *w, int32_t k)
{
    const struct vslot *s = &w->slots[k];
    if (s->prepares && !s->work.on) sim_work_begin(w, k, SIM_PREPARED, sim_build_us(w->plan, k));
}

static void prepared(struct world *w, int32_t k)
{
    if (w->slots[k].hung) return;
    sim_work_end(w, k);
    w->slots[k].prepares = false;
    sim_start_next(w, k);
}

/* ---- the process ----------------------------------------------------------------------------- */

static void keep(struct inbox *in, const struct sim_event *e)
{
    if (in->n == in->cap) {
        in->cap = in->cap ? 2 * in->cap : 8;
        in->at = xrealloc(in->at, in->cap, sizeof *in->at);
    }
    in->at[in->n++] = *e;
}

/* The policy has let the slot go: it ends, and is not started again. */
static void leave(struct world *w, int32_t k)
{
    w->result->leaves++;
    sim_end_slot(w, k);
    sim_say(w, k, (struct sched_event){.kind = SCHED_GONE});
}

/* Records that the worker reads itself, if there is no node. A node that was let go is stopped. */
static void read_down(struct world *w, int32_t k, const struct sched_event *e)
{
    if (e->kind == SCHED_FLUSH) sim_hand_over(w, k);
    if (e->kind == SCHED_INPUT_END) leave(w, k);
    if (e->kind != SCHED_TASK) return;
    sim_append_task(&w->slots[k].queue, &e->task);
    sim_start_next(w, k);
}

void sim_deliver(struct world *w, const struct sim_event *e)
{
    struct vslot *s = &w->slots[e->slot];
    if (e->kind == SIM_COMPUTED) computed(w, e->slot);
    else if (e->kind == SIM_PREPARED) prepared(w, e->slot);
    else if (s->stalled) keep(&s->inbox, e);
    else if (e->kind == SIM_STATE) build(w, e->slot);
    else if (e->kind == SIM_WAKE) sim_node_wake(w, e->slot);
    else if (w->plan->node && !(e->sched.kind == SCHED_INPUT_END && s->left))
        sim_node_step(w, e->slot, e->sched);
    else read_down(w, e->slot, &e->sched);
}

void sim_say_up(struct world *w, int32_t k)
{
    struct sched_event e = {.kind = SCHED_UP,
        .n = w->plan->width,
        .power = w->slots[k].power,
        .stated = !w->plan->unstated};
    sim_say(w, k, e);
}

void sim_slot_comes_up(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    s->alive = true;
    s->prepares = w->plan->start.state_bytes > 0 || w->plan->start.build_s > 0;
    w->result->returns++;
    if (w->plan->node) sim_node_begin(w, k);
    sim_say_up(w, k);
}

void sim_resume(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    s->stalled = s->paused = false;
    sim_work_changed(w, k);
    w->result->pauses++;
    for (size_t i = 0; i < s->inbox.n; i++) {
        struct sim_event e = s->inbox.at[i];
        sim_deliver(w, &e);
    }
    s->inbox.n = 0;
}

void sim_end_slot(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    sim_clock_end(&s->clock, w->now_us);
    if (w->plan->node && s->node) w->plan->node->destroy(s->node);
    s->node = NULL;
    s->alive = s->stalled = s->paused = s->hung = false;
    sim_work_end(w, k);
    w->primed_us[net_number_of(w->plan, k)] = -1;
    s->epoch++;
    s->inbox.n = 0;
    s->queue.first = s->queue.n = 0;
    s->held.first = s->held.n = 0;
}

void sim_lose_slot(struct world *w, int32_t k)
{
    sim_end_slot(w, k);
    sim_say(w, k, (struct sched_event){.kind = SCHED_GONE});
    if (sim_draw(w) >= w->plan->p_return) return;
    sim_schedule(
        w, w->now_us + (int64_t)(sim_draw(w) * 2e6), k, (struct sim_event){.kind = SIM_RETURN});
}
