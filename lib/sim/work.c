/*
 * The work of a slot, and its speed. Other users leave the slot a share of its power: that is its
 * speed. While the slot is paused, its speed is 0. When the speed changes, the work that is done is
 * subtracted, and the remaining work gets a new end. So the integral of the speed over the time of
 * a task is the work of the task.
 */
#include "sim/world.h"

static double speed_of(const struct vslot *s) { return s->paused ? 0 : s->power * s->share; }

static void schedule_end(struct world *w, int32_t k, bool first)
{
    struct vslot *s = &w->slots[k];
    if (s->work.speed <= 0 || s->hung) return;
    double us = s->work.left_us / s->work.speed;
    sim_schedule(w, w->now_us + (first ? sim_clock_round(&s->clock, us) : llround(us)), k,
        (struct sim_event){.kind = s->work.ends, .sched.n = s->work.turn});
}

void sim_work_begin(struct world *w, int32_t k, enum sim_kind ends, double us)
{
    struct vslot *s = &w->slots[k];
    int32_t turn = s->work.turn + 1;
    s->work = (struct vwork){true, ends, us, w->now_us, speed_of(s), turn};
    schedule_end(w, k, true);
}

void sim_work_count(struct world *w, int32_t k)
{
    const struct vwork *work = &w->slots[k].work;
    if (!work->on || work->ends != SIM_COMPUTED) return;
    double us = (double)(w->now_us - work->since_us) * work->speed;
    w->result->work_us += fmin(us, work->left_us);
}

void sim_work_changed(struct world *w, int32_t k)
{
    struct vwork *work = &w->slots[k].work;
    if (!work->on) return;
    if (!w->ended) sim_work_count(w, k);
    work->left_us -= (double)(w->now_us - work->since_us) * work->speed;
    work->left_us = fmax(work->left_us, 0);
    work->since_us = w->now_us;
    work->speed = speed_of(&w->slots[k]);
    work->turn++;
    schedule_end(w, k, false);
}

void sim_work_end(struct world *w, int32_t k)
{
    if (!w->ended) sim_work_count(w, k);
    w->slots[k].work.on = false;
    w->slots[k].work.turn++;
}

bool sim_work_over(const struct world *w, const struct sim_event *e)
{
    if (e->kind != SIM_COMPUTED && e->kind != SIM_PREPARED) return false;
    return e->epoch == w->slots[e->slot].epoch && e->sched.n != w->slots[e->slot].work.turn;
}

static void schedule_load(struct world *w, size_t i)
{
    const struct sim_load *l = &w->plan->loads[i];
    struct sim_event e = {.kind = SIM_LOAD, .sched = {.n = (int32_t)i, .power = l->share}};
    sim_schedule(w, l->at_us, l->slot, e);
}

void sim_plan_loads(struct world *w)
{
    const struct sim_plan *p = w->plan;
    for (size_t i = 0; i < p->n_loads; i++)
        if (i == 0 || p->loads[i].slot != p->loads[i - 1].slot) schedule_load(w, i);
}

void sim_take_load(struct world *w, const struct sim_event *e)
{
    const struct sim_plan *p = w->plan;
    size_t next = (size_t)e->sched.n + 1;
    w->slots[e->slot].share = e->sched.power;
    sim_work_changed(w, e->slot);
    if (next < p->n_loads && p->loads[next].slot == e->slot) schedule_load(w, next);
}
