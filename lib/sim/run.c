/*
 * One run: the plan's faults are laid out, then events are taken in order of time until none is
 * left.
 */
#include "sim/world.h"

#include <stdlib.h>

static void act(struct world *w, const struct sched_action *a)
{
    struct vslot *s = a->slot >= 0 && a->kind != SCHED_COMMIT ? &w->slots[a->slot] : NULL;
    struct sim_event e = {.slot = a->slot, .epoch = s ? s->epoch : 0};
    if (a->kind == SCHED_COMMIT) check_commit(w, a);
    if (a->kind == SCHED_END) check_end(w);
    if (a->kind == SCHED_GIVE) {
        check_give(w, a);
        e.kind = SIM_TO_SLOT;
        e.sched.task = a->task;
        schedule(w, arrival(w, &s->down_us), e);
    } else if (a->kind == SCHED_ASK_FLUSH) {
        e.kind = SIM_FLUSH;
        w->result->flushes++;
        schedule(w, arrival(w, &s->down_us), e);
    }
}

/* What the event means for the checks, before the policy sees it. */
static void note(struct world *w, const struct sched_event *e)
{
    struct vtask *t =
        e->task.frame == 0 && (int32_t)e->task.id < w->plan->tasks ? &w->tasks[e->task.id] : NULL;
    struct vslot *s = &w->slots[e->slot];
    if (e->kind == SCHED_TASK && t) t->known = true;
    if (e->kind == SCHED_UP) s->up = true;
    if (e->kind == SCHED_DONE && t && t->owner == e->slot) t->done = true;
    if (e->kind == SCHED_GONE) {
        s->up = false;
        s->lost = true;
        for (int32_t i = 0; i < w->plan->tasks; i++)
            if (w->tasks[i].owner == e->slot) w->tasks[i].owner = -1;
    }
    if (e->kind != SCHED_PIXELS || !t) return;
    struct lattice all = row_task((int32_t)e->task.id).at;
    int64_t n0 = lattice_offset(&all, FRAME_W, &e->task.at);
    if (n0 < 0 || (uint64_t)n0 > t->sent) return;
    uint64_t n1 = (uint64_t)n0 + lattice_count(&e->task.at);
    if (n1 > t->sent) t->sent = n1;
}

static void step(struct world *w, const struct sched_event *e)
{
    note(w, e);
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
        say(w, e->slot, (struct sched_event){.kind = SCHED_UP});
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
    case SIM_COMPUTED: computed(w, e->slot); break;
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
    int64_t known_us = draw(w) < .5 ? 0 : (int64_t)(draw(w) * 2e5);
    schedule(w, known_us, (struct sim_event){.sched = {.kind = SCHED_SLOTS, .n = p->slots}});
    for (int32_t k = 0; k < p->slots; k++) {
        w->slots[k].power = k ? .25 + 2 * draw(w) : 1;
        schedule(w, known_us + (int64_t)(draw(w) * 1e5),
            (struct sim_event){.kind = SIM_RETURN, .slot = k});
        plan_fault(w, k);
    }
    double spread_us = draw(w) < .5 ? 0 : 1e6 * draw(w);
    for (int32_t i = 0; i < p->tasks; i++) {
        struct sched_event e = {.kind = SCHED_TASK, .task = row_task(i), .frame_w = FRAME_W};
        w->tasks[i].owner = -1;
        /* One in eight is promised to a slot that does not exist. */
        if (i < p->assigned) e.task.to = (int32_t)(draw(w) * 1.125 * p->slots);
        w->tasks[i].to = e.task.to;
        schedule(w, (int64_t)(spread_us * i / p->tasks), (struct sim_event){.sched = e});
    }
    schedule(w, (int64_t)spread_us + 1, (struct sim_event){.sched = {.kind = SCHED_INPUT_END}});
}

/*
 * Slot 0 alone could do all of it, one round trip a task, once the faults are over; twice that is
 * enough.
 */
static int64_t time_allowed_us(const struct sim_plan *p)
{
    double each_us = 1000 * exp(4) + 4.0 * (double)p->latency_us;
    return (int64_t)(2 * (FAULTS_US + 2e6 + (double)p->silence_us + each_us * (p->tasks + 2)));
}

static void trace_event(struct world *w, const struct sim_event *e)
{
    const int64_t v[5] = {e->at_us, e->kind, e->slot, e->sched.kind, e->sched.task.id};
    w->result->trace_hash = hash64(w->result->trace_hash, v, sizeof v);
}

void sim_run(const struct policy *policy, const struct sim_plan *plan, struct sim_result *result)
{
    struct world w = {.policy = policy, .plan = plan, .result = result};
    const struct sched_params params = {.depth = plan->depth};
    struct sim_event e;
    *result = (struct sim_result){.trace_hash = HASH64_INIT};
    w.slots = xcalloc((size_t)plan->slots, sizeof *w.slots);
    w.tasks = xcalloc((size_t)plan->tasks + 1, sizeof *w.tasks);
    w.state = policy->create(&params);
    begin(&w);
    while (!*result->failure && heap_pop(&w.heap, &e)) {
        w.now_us = e.at_us;
        result->events++;
        trace_event(&w, &e);
        handle(&w, &e);
    }
    if (!w.ended) fail(&w, "the run did not end", result->commits, plan->tasks);
    else if (result->end_us > time_allowed_us(plan))
        fail(&w, "the end came late", result->end_us, 0);
    policy->destroy(w.state);
    for (int32_t k = 0; k < plan->slots; k++) free(w.slots[k].queue), free(w.slots[k].held);
    free(w.slots);
    free(w.tasks);
    free(w.heap.at);
    free(w.acts.at);
}
