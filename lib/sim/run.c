/*
 * One run: the plan's faults are laid out, then events are taken in order of time until none is
 * left.
 */
#include "sim/world.h"

#include <stdlib.h>

static void act(struct world *w, const struct sched_action *a)
{
    if (a->kind == SCHED_COMMIT) check_commit(w, a);
    if (a->kind == SCHED_END || a->kind == SCHED_STOP) check_end(w, a->kind == SCHED_STOP);
    if (a->kind != SCHED_GIVE && a->kind != SCHED_ASK_FLUSH) return;
    struct vslot *s = &w->slots[a->slot];
    struct sim_event e = {.slot = a->slot, .epoch = s->epoch};
    if (a->kind == SCHED_GIVE) {
        check_give(w, a);
        e.kind = SIM_TO_SLOT;
        e.sched.task = a->task;
    } else {
        e.kind = SIM_FLUSH;
        w->result->flushes++;
        s->asked = true;
    }
    schedule(w, arrival(w, &s->down_us), e);
}

static void step(struct world *w, const struct sched_event *e)
{
    note_event(w, e);
    w->policy->step(w->state, e, w->now_us, &w->acts);
    for (size_t i = 0; i < w->acts.n; i++) act(w, &w->acts.at[i]);
    w->acts.n = 0;
    check_owners(w);
}

static void handle(struct world *w, const struct sim_event *e)
{
    struct vslot *s = &w->slots[e->slot];
    if (e->kind == SIM_SCHED) {
        step(w, &e->sched);
        return;
    }
    if (e->kind == SIM_RETURN) {
        s->alive = true;
        w->result->returns++;
        say(w, e->slot, (struct sched_event){.kind = SCHED_UP, .n = w->plan->width});
        return;
    }
    if (!s->alive || e->epoch != s->epoch) return; /* for a process that is no more */
    switch (e->kind) {
    case SIM_TO_SLOT:
        append_task(&s->queue, &s->n_queue, &s->cap_queue, &e->sched.task);
        start_next(w, e->slot);
        break;
    case SIM_FLUSH:
        s->flush_due = s->stalled;
        if (!s->stalled) hand_over(w, e->slot);
        break;
    case SIM_COMPUTED: computed(w, e->slot, e->sched.wall_us); break;
    case SIM_CRASH:
        w->result->crashes++;
        kill_slot(w, e->slot);
        break;
    case SIM_STALL: s->stalled = true; break;
    case SIM_RESUME: resume(w, e->slot); break;
    case SIM_GIVE_UP:
        w->result->stalls++;
        kill_slot(w, e->slot);
        break;
    default: break;
    }
}

/* ---- a run ------------------------------------------------------------------------------ */

/* One fault for slot k, by the plan; all before FAULTS_US. */
#define FAULTS_US 4000000

static void plan_fault(struct world *w, int32_t k)
{
    const struct sim_plan *p = w->plan;
    struct sim_event e = {.slot = k};
    int64_t at = (int64_t)(draw(w) * draw(w) * FAULTS_US);
    double u = draw(w);
    bool mortal = k > 0;
    if (mortal && u < p->p_crash) {
        e.kind = SIM_CRASH;
        schedule(w, at, e);
    } else if (mortal && draw(w) < p->p_stall) {
        e.kind = SIM_STALL;
        schedule(w, at, e);
        e.kind = SIM_GIVE_UP;
        schedule(w, at + p->silence_us, e);
    } else if (draw(w) < p->p_pause) {
        e.kind = SIM_STALL;
        schedule(w, at, e);
        e.kind = SIM_RESUME;
        schedule(w, at + (int64_t)(draw(w) * (double)p->silence_us), e);
    }
}

static void begin(struct world *w)
{
    const struct sim_plan *p = w->plan;
    /* How many slots there are may be known before or after the first tasks. */
    int64_t known_us = draw(w) < .5 || p->work ? 0 : (int64_t)(draw(w) * 2e5);
    schedule(w, known_us, (struct sim_event){.sched = {.kind = SCHED_SLOTS, .n = p->slots}});
    for (int32_t k = 0; k < p->slots; k++) {
        w->slots[k].power = k ? .25 + 2 * draw(w) : 1;
        if (p->work) w->slots[k].power = p->work->power[k];
        int64_t up_us = p->work ? 0 : known_us + (int64_t)(draw(w) * 1e5);
        schedule(w, up_us, (struct sim_event){.kind = SIM_RETURN, .slot = k});
        plan_fault(w, k);
    }
    double spread_us = draw(w) < .5 || p->calm || p->work ? 0 : 1e6 * draw(w);
    for (int32_t i = 0; i < p->tasks; i++) {
        struct vtask *t = &w->tasks[w->order[i]];
        /* One in eight is promised to a slot that does not exist. */
        if (i < p->assigned) t->to = t->task.to = (int32_t)(draw(w) * 1.125 * p->slots);
        struct sched_event e = {.kind = SCHED_TASK, .task = t->task, .frame_w = w->frame_w};
        schedule(w, (int64_t)(spread_us * i / p->tasks), (struct sim_event){.sched = e});
    }
    schedule(w, (int64_t)spread_us + 1, (struct sim_event){.sched = {.kind = SCHED_INPUT_END}});
}

/*
 * Slot 0 alone could do all of it, one round trip a task, once the faults are over; twice that is
 * enough. Pieces are more tasks, of less work.
 */
static int64_t time_allowed_us(const struct world *w)
{
    const struct sim_plan *p = w->plan;
    double row_us = p->cost_us * exp(4), trip_us = 4.0 * (double)p->latency_us;
    double work_us = row_us * p->rows * (p->tasks + 2), trips_us = trip_us * (w->n_tasks + 2);
    return (int64_t)(2 * (FAULTS_US + 2e6 + (double)p->silence_us + work_us + trips_us));
}

/* Without faults, and the link hidden: the bound, what is on the way at both ends, a last task. */
static int64_t calm_us(const struct world *w)
{
    double power = 0, least = 1;
    for (int32_t k = 0; k < w->plan->slots; k++) {
        power += w->slots[k].power;
        least = fmin(least, w->slots[k].power);
    }
    double last_us = w->plan->cost_us * exp(4) / least;
    return (int64_t)(1.25 * w->cost_us / power + last_us + 8 * (double)w->plan->latency_us);
}

static void trace_event(struct world *w, const struct sim_event *e)
{
    const int64_t v[5] = {e->at_us, e->kind, e->slot, e->sched.kind, e->sched.task.id};
    w->result->trace_hash = hash64(w->result->trace_hash, v, sizeof v);
}

static void open_world(struct world *w)
{
    const struct sim_plan *p = w->plan;
    w->frame_w = p->work ? p->work->frame_w : FRAME_W;
    w->frame_h = p->work ? p->work->frame_h : (uint32_t)(p->rows * p->tasks + 1);
    w->slots = xcalloc((size_t)p->slots, sizeof *w->slots);
    w->order = xcalloc((size_t)p->tasks + 1, sizeof *w->order);
    coverage_init(&w->sent, w->frame_w, w->frame_h);
    for (int32_t i = 0; i < p->tasks; i++) {
        uint32_t id = (uint32_t)i, rows = (uint32_t)p->rows;
        struct task made = {0, id, {0, id * rows, FRAME_W, rows, 1, 1}, -1};
        w->order[i] = p->work ? p->work->tasks[i].id : id;
        struct vtask *t = vtask_at(w, w->order[i]);
        t->task = p->work ? p->work->tasks[i] : made;
        t->to = t->task.to;
    }
}

static void close_world(struct world *w)
{
    for (int32_t k = 0; k < w->plan->slots; k++) free(w->slots[k].queue), free(w->slots[k].held);
    coverage_free(&w->sent);
    free(w->slots);
    free(w->order);
    free(w->tasks);
    free(w->heap.at);
    free(w->acts.at);
}

void sim_run(const struct policy *policy, const struct sim_plan *plan, struct sim_result *result)
{
    struct world w = {.policy = policy, .plan = plan, .result = result};
    const struct sched_params params = {.depth = plan->depth, .endgame = plan->endgame};
    struct sim_event e;
    *result = (struct sim_result){.trace_hash = HASH64_INIT};
    open_world(&w);
    w.state = policy->create(&params);
    begin(&w);
    while (!*result->failure && !result->stops && heap_pop(&w.heap, &e)) {
        w.now_us = e.at_us;
        result->events++;
        trace_event(&w, &e);
        handle(&w, &e);
    }
    if (!w.ended) fail(&w, "the run did not end", result->commits, plan->tasks);
    else if (!plan->work && result->end_us > time_allowed_us(&w))
        fail(&w, "the end came late", result->end_us, time_allowed_us(&w));
    else if (plan->calm && result->end_us > calm_us(&w))
        fail(&w, "a long link was not hidden", result->end_us, calm_us(&w));
    policy->destroy(w.state);
    close_world(&w);
}
