/*
 * A run of a tree in virtual time: its workers, its input, its loop. The policies are those that
 * deal runs; see sim_tree_run in sim.h.
 */
#include "sim/tree.h"

#define AT_ONCE                                                                                    \
    100 /* limit of events at one time per node, task and pixel, against endless loops */

/* ---- workers --------------------------------------------------------------------------------- */

static void start_next(struct tree *t, int32_t i)
{
    int32_t k = i - t->n_hubs;
    struct tree_worker *w = &t->workers[k];
    if (w->clock.busy || w->queue.first == w->queue.n) return;
    const struct sim_work *work = t->plan->work;
    double us = sim_work_us(work, &w->queue.at[w->queue.first]) / work->power[k];
    int64_t wall_us = sim_clock_round(&w->clock, us);
    struct sim_event e = {.kind = SIM_COMPUTED, .slot = i, .sched.wall_us = wall_us};
    e.at_us = t->now_us + e.sched.wall_us;
    sim_clock_begin(&w->clock, t->now_us);
    sim_heap_push(&t->heap, &e);
}

static void computed(struct tree *t, int32_t i, int64_t wall_us)
{
    struct tree_worker *w = &t->workers[i - t->n_hubs];
    struct task task = w->queue.at[w->queue.first++];
    struct sched_event e = {.kind = SCHED_DONE, .task = task, .wall_us = wall_us, .from = -1};
    sim_clock_end(&w->clock, t->now_us);
    t->result->computed++;
    tree_say(t, i, e);
    e.kind = SCHED_PIXELS;
    tree_say(t, i, e);
    start_next(t, i);
}

/* What its parent sent arrives at node i. A worker holds back no pixels to flush. */
static void arrives(struct tree *t, int32_t i, const struct sched_event *e)
{
    if (!tree_is_worker(t, i)) tree_step(t, i, e);
    else if (e->kind == SCHED_TASK) {
        sim_append_task(&t->workers[i - t->n_hubs].queue, &e->task);
        start_next(t, i);
    }
}

/* ---- the run --------------------------------------------------------------------------------- */

/* The root reads tasks while few wait, as the live driver does. */
static void read_input(struct tree *t)
{
    const struct sim_plan *p = t->plan;
    while (t->n_read < p->tasks && t->policy->waiting(t->hubs[0].state) < SCHED_WAITING_MOST) {
        struct sched_event e = {.kind = SCHED_TASK,
            .task = p->work->tasks[t->n_read++],
            .frame_w = p->work->frame_w,
            .from = -1};
        if (++t->held > t->result->hub_tasks) t->result->hub_tasks = t->held;
        tree_step(t, 0, &e);
    }
    if (t->n_read < p->tasks || t->input_ended) return;
    t->input_ended = true;
    tree_step(t, 0, &(struct sched_event){.kind = SCHED_INPUT_END});
}

/* All hubs and workers start at once; each tells its parent, with its number of slots. */
static void begin(struct tree *t)
{
    struct sim_result *r = t->result;
    int32_t n = t->n_hubs + t->plan->slots;
    r->hubs = t->n_hubs;
    for (int32_t i = 0; i < t->n_hubs; i++) {
        struct sched_event slots = {.kind = SCHED_SLOTS, .n = t->nodes[i].n};
        if (slots.n > r->hub_slots) r->hub_slots = slots.n;
        tree_step(t, i, &slots);
    }
    for (int32_t i = 1; i < n; i++) {
        const struct tree_node *at = &t->nodes[i];
        if (t->nodes[at->parent].first + at->number != i) tree_fail(t, "a node has no hub", i, n);
        tree_say(t, i, (struct sched_event){.kind = SCHED_UP, .n = at->n});
    }
    read_input(t);
}

static void wake(struct tree *t, int32_t hub)
{
    t->hubs[hub].wake_us = INT64_MAX;
    if (t->policy->wake_us(t->hubs[hub].state) > t->now_us) tree_sleep(t, hub);
    else tree_step(t, hub, &(struct sched_event){.kind = SCHED_WAKE});
}

static void handle(struct tree *t, const struct sim_event *e)
{
    switch (e->kind) {
    case SIM_SCHED: tree_take(t, e); break;
    case SIM_AT_HUB: tree_pass(t, e); break;
    case SIM_TO_SLOT: arrives(t, e->slot, &e->sched); break;
    case SIM_COMPUTED: computed(t, e->slot, e->sched.wall_us); break;
    case SIM_WAKE: wake(t, e->slot); break;
    default: break;
    }
}

static void account(struct tree *t)
{
    t->result->end_us = t->now_us;
    for (int32_t k = 0; k < t->plan->slots; k++) {
        double before_us = t->result->busy_us;
        sim_clock_split(&t->workers[k].clock, t->now_us, t->result);
        t->result->work_us += (t->result->busy_us - before_us) * t->plan->work->power[k];
    }
}

static void trace_event(struct tree *t, const struct sim_event *e)
{
    const int64_t v[5] = {e->at_us, e->kind, e->slot, e->sched.kind, e->sched.task.id};
    t->result->trace_hash = hash64(t->result->trace_hash, v, sizeof v);
}

void sim_tree_run(
    const struct policy *policy, const struct sim_plan *plan, struct sim_result *result)
{
    struct tree t = {.policy = policy, .plan = plan, .result = result};
    struct sim_event e;
    *result = (struct sim_result){.trace_hash = HASH64_INIT};
    tree_build(&t);
    int64_t at_once = 0, most = AT_ONCE * ((int64_t)t.n_hubs + plan->slots + plan->tasks);
    begin(&t);
    while (!*result->failure && !t.ended && sim_heap_pop(&t.heap, &e)) {
        at_once = e.at_us > t.now_us ? 0 : at_once + 1;
        if (at_once > most) tree_fail(&t, "time stands still", at_once, most);
        t.now_us = e.at_us;
        result->events++;
        trace_event(&t, &e);
        handle(&t, &e);
        if (!t.ended) read_input(&t);
    }
    account(&t);
    result->uncommitted = plan->tasks - result->commits;
    if (!t.ended) tree_fail(&t, "the run did not end", result->commits, plan->tasks);
    tree_close(&t);
}
