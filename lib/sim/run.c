/*
 * One run: the model of slots and links, and the checks. A slot is a process that takes its tasks in order; killing
 * it voids what is on the way to it and what it was computing, not what it had sent. Links keep order.
 */
#include "sim/sim.h"
#include "sim/heap.h"

#include <stdlib.h>
#include <string.h>

#define FRAME_W 64 /* a task is a row of the one frame */

struct vslot {
    bool up; /* the policy was told so, and not that it is gone */
    bool alive, stalled;
    uint32_t epoch;
    double power;
    struct task *queue; /* to compute, in order */
    size_t n_queue, cap_queue;
    struct task *held; /* computed, pixels not sent */
    size_t n_held, cap_held;
    bool busy, flush_due;   /* flush_due: asked while it was stalled */
    int64_t down_us, up_us; /* latest arrivals on its links, which keep order */
};

struct vtask {
    uint64_t sent;               /* pixels 0 .. sent were passed to the policy */
    int32_t owner;               /* slot it was last given to, -1 */
    bool known, done, committed; /* done: its owner has said so */
};

struct world {
    const struct policy *policy;
    const struct sim_plan *plan;
    struct sim_result *result;
    void *state;
    struct sched_actions acts;
    struct sim_heap heap;
    struct vslot *slots;
    struct vtask *tasks;
    int64_t now_us;
    uint64_t draws;
    bool ended;
};

static double draw(struct world *w) { return rng_unit(w->plan->seed, w->draws++ << 8); }

static void fail(struct world *w, const char *what, int64_t a, int64_t b)
{
    if (*w->result->failure) return;
    snprintf(w->result->failure, sizeof w->result->failure, "%s (%lld, %lld) at %lld us", what,
        (long long)a, (long long)b, (long long)w->now_us);
}

static void schedule(struct world *w, int64_t at_us, struct sim_event e)
{
    e.at_us = at_us;
    heap_push(&w->heap, e);
}

/* Arrival over a link that keeps order. */
static int64_t arrival(struct world *w, int64_t *latest)
{
    int64_t at = w->now_us + (int64_t)((double)w->plan->latency_us * (.5 + draw(w)));
    if (at < *latest) at = *latest;
    return *latest = at;
}

/* ---- slots ------------------------------------------------------------------------------ */

static struct task row_task(int32_t id)
{
    return (struct task){0, (uint32_t)id, {0, (uint32_t)id, FRAME_W, 1, 1, 1}, -1};
}

static void append(struct task **list, size_t *n, size_t *cap, const struct task *t)
{
    if (*n == *cap) {
        *cap = *cap ? 2 * *cap : 8;
        *list = xrealloc(*list, *cap, sizeof **list);
    }
    (*list)[(*n)++] = *t;
}

static void say(struct world *w, int32_t k, struct sched_event e)
{
    struct vslot *s = &w->slots[k];
    e.slot = k;
    e.frame_w = FRAME_W;
    schedule(
        w, arrival(w, &s->up_us), (struct sim_event){.kind = SIM_SCHED, .slot = k, .sched = e});
}

static void say_twice_or_worse(struct world *w, int32_t k, struct sched_event e)
{
    if (draw(w) < w->plan->p_garbage) {
        struct sched_event bad = e;
        w->result->garbage++;
        bad.task.id = draw(w) < .5 ? (uint32_t)w->plan->tasks + 7 : e.task.id;
        if (bad.kind == SCHED_PIXELS) bad.task.at.x += 1 + (uint32_t)(draw(w) * 70);
        else if (bad.task.id == e.task.id) bad.task.frame = 99;
        say(w, k, bad);
    }
    say(w, k, e);
    if (draw(w) >= w->plan->p_twice) return;
    w->result->twice++;
    say(w, k, e);
}

static void send_pixels(struct world *w, int32_t k, const struct task *t)
{
    struct sched_event e = {.kind = SCHED_PIXELS, .task = *t};
    uint64_t most = 1 + (uint64_t)(draw(w) * 2 * FRAME_W), n0 = 0, all = lattice_count(&t->at);
    while (n0 < all) {
        e.task.at = lattice_cut(&t->at, FRAME_W, n0, most);
        n0 += lattice_count(&e.task.at);
        say_twice_or_worse(w, k, e);
    }
}

static void start_next(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    if (s->busy || s->stalled || !s->alive || !s->n_queue) return;
    s->busy = true;
    double cost_us = 1000 * exp(4 * draw(w)) / s->power;
    schedule(w, w->now_us + (int64_t)cost_us,
        (struct sim_event){.kind = SIM_COMPUTED, .slot = k, .epoch = s->epoch});
}

static void hand_over(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    for (size_t i = 0; i < s->n_held; i++) send_pixels(w, k, &s->held[i]);
    s->n_held = 0;
}

static void computed(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    s->busy = false;
    if (s->stalled) return; /* it will begin again when it resumes */
    struct task t = s->queue[0];
    memmove(s->queue, s->queue + 1, --s->n_queue * sizeof *s->queue);
    say_twice_or_worse(w, k, (struct sched_event){.kind = SCHED_DONE, .task = t});
    if (w->plan->concentrate) append(&s->held, &s->n_held, &s->cap_held, &t);
    else send_pixels(w, k, &t);
    start_next(w, k);
}

static void resume(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    s->stalled = false;
    w->result->pauses++;
    if (s->flush_due) hand_over(w, k);
    s->flush_due = false;
    start_next(w, k);
}

static void kill_slot(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    s->alive = s->busy = s->stalled = s->flush_due = false;
    s->epoch++;
    s->n_queue = s->n_held = 0;
    say(w, k, (struct sched_event){.kind = SCHED_GONE});
    if (draw(w) >= w->plan->p_return) return;
    schedule(
        w, w->now_us + (int64_t)(draw(w) * 2e6), (struct sim_event){.kind = SIM_RETURN, .slot = k});
}

/* ---- checks ----------------------------------------------------------------------------- */

/* Tasks that slot k was given and has not answered. */
static int32_t holding(const struct world *w, int32_t k)
{
    int32_t n = 0;
    for (int32_t i = 0; i < w->plan->tasks; i++)
        n += w->tasks[i].owner == k && !w->tasks[i].done && !w->tasks[i].committed;
    return n;
}

static void check_give(struct world *w, const struct sched_action *a)
{
    struct vslot *s = &w->slots[a->slot];
    struct vtask *t = &w->tasks[a->task.id];
    w->result->gives++;
    if (!s->up) fail(w, "work given to a slot that is not up", a->slot, a->task.id);
    if (!t->known || t->committed) fail(w, "work given that is not to do", a->slot, a->task.id);
    if (t->owner >= 0) fail(w, "work given twice", t->owner, a->task.id);
    t->owner = a->slot;
    t->done = false;
    if (a->task.to != a->slot && holding(w, a->slot) > 1 + w->plan->depth)
        fail(w, "more given than the depth allows", a->slot, a->task.id);
}

static void check_commit(struct world *w, const struct sched_action *a)
{
    struct vtask *t = &w->tasks[a->task.id];
    w->result->commits++;
    if (t->committed) fail(w, "a second commit", a->task.id, 0);
    if (t->sent != FRAME_W) fail(w, "a commit before the last pixel", a->task.id, (int64_t)t->sent);
    t->committed = true;
}

static void check_end(struct world *w)
{
    if (w->ended) fail(w, "a second end", 0, 0);
    w->ended = true;
    w->result->end_us = w->now_us;
    for (int32_t i = 0; i < w->plan->tasks; i++)
        if (!w->tasks[i].committed) fail(w, "the end, with work uncommitted", i, w->tasks[i].owner);
}

/* What the policy has, by what it was told: an uncommitted task waits, or its owner is up. */
static void check_owners(struct world *w)
{
    int64_t pool = 0;
    for (int32_t i = 0; i < w->plan->tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        if (!t->known || t->committed) continue;
        if (t->owner < 0) pool++;
        else if (!w->slots[t->owner].up) fail(w, "work left with a slot that is gone", t->owner, i);
    }
    if (w->policy->waiting(w->state) > pool) fail(w, "more waiting than there is", pool, 0);
}

/* ---- the policy's side ------------------------------------------------------------------ */

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
    if (e->kind == SCHED_TASK) t->known = true;
    if (e->kind == SCHED_UP) s->up = true;
    if (e->kind == SCHED_DONE && t && t->owner == e->slot) t->done = true;
    if (e->kind == SCHED_GONE) {
        s->up = false;
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
        append(&s->queue, &s->n_queue, &s->cap_queue, &e->sched.task);
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
    schedule(w, 0, (struct sim_event){.sched = {.kind = SCHED_SLOTS, .n = p->slots}});
    for (int32_t k = 0; k < p->slots; k++) {
        w->slots[k].power = k ? .25 + 2 * draw(w) : 1;
        schedule(w, (int64_t)(draw(w) * 1e5), (struct sim_event){.kind = SIM_RETURN, .slot = k});
        plan_fault(w, k);
    }
    double spread_us = draw(w) < .5 ? 0 : 1e6 * draw(w);
    for (int32_t i = 0; i < p->tasks; i++) {
        struct sched_event e = {.kind = SCHED_TASK, .task = row_task(i), .frame_w = FRAME_W};
        w->tasks[i].owner = -1;
        /* One in eight is promised to a slot that does not exist. */
        if (i < p->assigned) e.task.to = (int32_t)(draw(w) * 1.125 * p->slots);
        schedule(w, (int64_t)(spread_us * i / p->tasks), (struct sim_event){.sched = e});
    }
    schedule(w, (int64_t)spread_us + 1, (struct sim_event){.sched = {.kind = SCHED_INPUT_END}});
}

/* Slot 0 alone could do all of it, one round trip a task, once the faults are over; twice that is enough. */
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
