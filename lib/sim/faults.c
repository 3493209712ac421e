/*
 * Faults: crash, silence, pause, slow-down, hang, drain, and a killed hub. At most one random fault
 * befalls a slot, and one more if it drains; slot 0 is never lost.
 */
#include "sim/world.h"

#include <stdlib.h>
#include <string.h>

#define HUB_DOWN_US 1e6 /* at most, from one hub to the next */

static void plan_fault(
    struct world *w, int64_t at_us, int32_t k, enum sim_fault_kind kind, double power)
{
    struct sim_event e = {.kind = SIM_FAULT, .sched = {.n = (int32_t)kind, .power = power}};
    sim_schedule(w, at_us, k, e);
}

/* ---- plans ----------------------------------------------------------------------------------- */

/* A slot that drains may be lost or hang. */
static void draw_drain(struct world *w, int32_t k, int64_t at)
{
    static const enum sim_fault_kind kinds[] = {SIM_CRASH, SIM_SILENCE, SIM_PAUSE, SIM_HANG};
    plan_fault(w, at, k, SIM_DRAIN, 0);
    enum sim_fault_kind kind = kinds[(int)(sim_draw(w) * (w->plan->p_hang > 0 ? 4 : 3))];
    at += (int64_t)(1e6 * pow(sim_draw(w), 6)); /* mostly before it has left */
    if (sim_draw(w) < .4) plan_fault(w, at, k, kind, sim_draw(w) < .5);
}

/* Half of the slow slots have all of their power again later. */
static void draw_slow(struct world *w, int32_t k, int64_t at)
{
    double power = SLOWEST + (.5 - SLOWEST) * sim_draw(w);
    plan_fault(w, at, k, SIM_SLOW, power);
    if (sim_draw(w) < .5) return;
    plan_fault(w, at + (int64_t)(sim_draw(w) * 1e6), k, SIM_SLOW, 1 / power);
}

void sim_draw_fault(struct world *w, int32_t k)
{
    const struct sim_plan *p = w->plan;
    int64_t at = (int64_t)(sim_draw(w) * sim_draw(w) * (double)p->faults_us);
    bool mortal = k > 0;
    if (sim_draw(w) < p->p_crash && mortal) plan_fault(w, at, k, SIM_CRASH, 0);
    else if (sim_draw(w) < p->p_silence && mortal) plan_fault(w, at, k, SIM_SILENCE, 0);
    else if (sim_draw(w) < p->p_pause) plan_fault(w, at, k, SIM_PAUSE, 0);
    else if (sim_draw(w) < p->p_slow && mortal) draw_slow(w, k, at);
    else if (p->p_hang > 0 && sim_draw(w) < p->p_hang && mortal)
        plan_fault(w, at, k, SIM_HANG, sim_draw(w) < .5);
    else if (p->p_drain > 0 && sim_draw(w) < p->p_drain && mortal) draw_drain(w, k, at);
}

void sim_plan_faults(struct world *w)
{
    const struct sim_plan *p = w->plan;
    for (size_t i = 0; i < p->n_faults; i++) {
        const struct sim_fault *f = &p->faults[i];
        if (f->at_us >= 0 && f->kind < SIM_POISON)
            plan_fault(w, f->at_us, f->slot, f->kind, f->power);
    }
    if (sim_draw(w) < p->p_kill)
        plan_fault(w, (int64_t)(sim_draw(w) * (double)p->faults_us), 0, SIM_KILL, 0);
}

void sim_inject_by_commits(struct world *w, int64_t before)
{
    const struct sim_plan *p = w->plan;
    for (size_t i = 0; i < p->n_faults; i++) {
        const struct sim_fault *f = &p->faults[i];
        if (f->at_us < 0 && f->kind < SIM_POISON && f->commits > before &&
            f->commits <= w->result->commits)
            plan_fault(w, w->now_us, f->slot, f->kind, f->power);
    }
}

/* The hub and all slots die. */
static void kill_hub(struct world *w)
{
    if (w->ended || w->down) return;
    w->result->kills++;
    for (int32_t k = 0; k < w->plan->slots; k++) sim_end_slot(w, k);
    w->hub++;
    w->down = true;
    int64_t at = w->now_us + (int64_t)(sim_draw(w) * HUB_DOWN_US);
    sim_schedule(w, at, 0, (struct sim_event){.kind = SIM_RESTART});
}

void sim_inject_fault(struct world *w, const struct sim_event *e)
{
    int32_t k = e->slot;
    struct vslot *s = &w->slots[k];
    enum sim_fault_kind kind = (enum sim_fault_kind)e->sched.n;
    int64_t silence_us = w->plan->silence_us, pause_us;
    if (kind == SIM_KILL) kill_hub(w);
    const bool any = kind == SIM_CRASH || kind == SIM_SLOW;
    if (!s->alive || (s->stalled && !any) || kind == SIM_KILL) return;
    switch (kind) {
    case SIM_CRASH:
        w->result->crashes++;
        sim_lose_slot(w, k);
        break;
    case SIM_SILENCE:
        s->stalled = true;
        sim_schedule(w, w->now_us + silence_us, k, (struct sim_event){.kind = SIM_GIVE_UP});
        break;
    case SIM_PAUSE:
        s->stalled = true;
        pause_us = (int64_t)(sim_draw(w) * (double)silence_us);
        s->paused = true;
        sim_work_changed(w, k);
        sim_schedule(w, w->now_us + pause_us, k, (struct sim_event){.kind = SIM_RESUME});
        break;
    case SIM_SLOW:
        w->result->slows++;
        s->power = fmax(
            s->power * e->sched.power, POWER_LEAST * (w->plan->work ? w->plan->work->power[k] : 1));
        sim_work_changed(w, k);
        if (w->plan->tells_power) sim_say_up(w, k);
        break;
    case SIM_HANG:
        w->result->hangs++;
        s->hung = true;
        s->stalled = e->sched.power > 0; /* it does not read its input either */
        break;
    case SIM_DRAIN:
        w->result->drains++;
        sim_say(w, k, (struct sched_event){.kind = SCHED_DRAIN});
        break;
    case SIM_KILL:
    case SIM_POISON:
    case SIM_REFUSE: break;
    }
}

/* ---- the next hub ---------------------------------------------------------------------------- */

/* Tasks that the log does not have as a whole come again as new. The last task always comes
 * again, so that the ids of pieces stay above those of the plan. */
static void forget(struct world *w, struct vtask *t)
{
    bool last = t->task.id + 1 == (uint32_t)w->plan->tasks;
    t->known = false;
    t->sent = 0;
    t->committed = !last && sim_is_sent(w, &t->task.at);
    for (uint64_t i = 0, n = lattice_count(&t->task.at); i < n && !t->committed; i++) {
        uint64_t p = lattice_pixel(&t->task.at, w->frame_w, i), bit = UINT64_C(1) << (p & 63);
        w->sent.done -= (w->sent.bits[p >> 6] & bit) != 0;
        w->sent.bits[p >> 6] &= ~bit;
    }
}

void sim_restart_hub(struct world *w)
{
    w->down = false;
    w->policy->destroy(w->state);
    w->state = w->policy->create(&w->plan->params);
    w->wake_us = INT64_MAX;
    w->slots_known = w->input_ended = w->input_due = false;
    w->n_read = w->n_open = 0;
    memset(w->open_of, 0, sizeof w->open_of);
    w->generation = 0;
    w->waits = false;
    w->spread_us = 0;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        struct vtask *t = &w->tasks[i];
        free(t->note);
        t->note = NULL;
        t->blamed = 0;
        if (i >= w->plan->tasks) continue;
        forget(w, t);
        if (w->checks && w->checks->task) w->checks->task(t);
    }
    w->n_tasks = w->plan->tasks;
    for (int32_t k = 0; k < w->plan->slots; k++) {
        struct vslot *s = &w->slots[k];
        s->up = s->lost = s->asked = s->drains = s->left = false;
        memset(s->refused, 0, sizeof s->refused);
        s->has = 0;
    }
    if (w->checks && w->checks->restart) w->checks->restart(w);
    sim_start_slots(w, w->now_us);
}
