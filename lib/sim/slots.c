/*
 * Slots and links. A slot is a process that takes its tasks in order; killing it voids what is on
 * the way to it and what it was computing, not what it had sent. Links keep order.
 */
#include "sim/world.h"

#include <string.h>

#define PIECES_MOST (1 << 20) /* no policy needs ids so far above those that it was given */

double draw(struct world *w) { return rng_unit(w->plan->seed, w->draws++ << 8); }

void fail(struct world *w, const char *what, int64_t a, int64_t b)
{
    if (*w->result->failure) return;
    snprintf(w->result->failure, sizeof w->result->failure, "%s (%lld, %lld) at %lld us", what,
        (long long)a, (long long)b, (long long)w->now_us);
}

void schedule(struct world *w, int64_t at_us, struct sim_event e)
{
    e.at_us = at_us;
    heap_push(&w->heap, e);
}

/* Arrival over a link that keeps order. */
int64_t arrival(struct world *w, int64_t *latest)
{
    int64_t at = w->now_us + (int64_t)((double)w->plan->latency_us * (.5 + draw(w)));
    if (at < *latest) at = *latest;
    return *latest = at;
}

struct vtask *vtask_at(struct world *w, uint32_t id)
{
    if (id >= (uint32_t)w->plan->tasks + PIECES_MOST) return NULL;
    while (w->n_tasks <= (int32_t)id) {
        if (w->n_tasks == w->cap_tasks) {
            w->cap_tasks = w->cap_tasks ? 2 * w->cap_tasks : 256;
            w->tasks = xrealloc(w->tasks, (size_t)w->cap_tasks, sizeof *w->tasks);
        }
        struct vtask *t = &w->tasks[w->n_tasks];
        *t = (struct vtask){.to = -1, .computed_by = -1};
        t->task.id = (uint32_t)w->n_tasks++;
    }
    return &w->tasks[id];
}

void append_task(struct task **list, size_t *n, size_t *cap, const struct task *t)
{
    if (*n == *cap) {
        *cap = *cap ? 2 * *cap : 8;
        *list = xrealloc(*list, *cap, sizeof **list);
    }
    (*list)[(*n)++] = *t;
}

void say(struct world *w, int32_t k, struct sched_event e)
{
    struct vslot *s = &w->slots[k];
    e.slot = k;
    e.frame_w = w->frame_w;
    schedule(
        w, arrival(w, &s->up_us), (struct sim_event){.kind = SIM_SCHED, .slot = k, .sched = e});
}

/*
 * A wrong answer: about work that does not exist, about another slot's, or with pixels beside the
 * task.
 */
static struct sched_event garbled(struct world *w, struct sched_event e)
{
    double u = draw(w);
    w->result->garbage++;
    if (u < .3) e.task.id = (uint32_t)w->plan->tasks + 7;
    else if (u < .6) e.task.id = (uint32_t)(draw(w) * w->plan->tasks);
    else if (e.kind == SCHED_PIXELS) e.task.at.x += 1 + (uint32_t)(draw(w) * 70);
    else e.task.frame = 99;
    return e;
}

static void say_twice_or_worse(struct world *w, int32_t k, struct sched_event e)
{
    if (draw(w) < w->plan->p_garbage) say(w, k, garbled(w, e));
    say(w, k, e);
    if (draw(w) >= w->plan->p_twice) return;
    w->result->twice++;
    say(w, k, e);
}

static void send_pixels(struct world *w, int32_t k, const struct task *t)
{
    struct sched_event e = {.kind = SCHED_PIXELS, .task = *t};
    uint64_t most = 1 + (uint64_t)(draw(w) * 2 * w->frame_w), n0 = 0, all = lattice_count(&t->at);
    while (n0 < all) {
        e.task.at = lattice_cut(&t->at, w->frame_w, n0, most);
        n0 += lattice_count(&e.task.at);
        say_twice_or_worse(w, k, e);
    }
}

/* At power 1. */
static double cost_us(struct world *w, const struct task *t)
{
    const struct sim_work *work = w->plan->work;
    uint64_t n = lattice_count(&t->at);
    if (!work) return w->plan->cost_us * exp(4 * draw(w)) * (double)n / FRAME_W;
    double us = work->task_us;
    for (uint64_t i = 0; i < n; i++) us += work->pixel_us[lattice_pixel(&t->at, w->frame_w, i)];
    return us;
}

void start_next(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    const struct sim_work *work = w->plan->work;
    if (s->busy || s->stalled || !s->alive || !s->n_queue) return;
    s->busy = true;
    bool slow = work && work->slow_slot == k && w->now_us >= work->slow_at_us;
    double us = cost_us(w, &s->queue[0]);
    w->cost_us += us;
    us /= slow ? work->slow_power : s->power;
    schedule(w, w->now_us + (int64_t)us,
        (struct sim_event){
            .kind = SIM_COMPUTED, .slot = k, .epoch = s->epoch, .sched.wall_us = (int64_t)us});
}

void hand_over(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    for (size_t i = 0; i < s->n_held; i++) send_pixels(w, k, &s->held[i]);
    s->n_held = 0;
}

void computed(struct world *w, int32_t k, int64_t wall_us)
{
    struct vslot *s = &w->slots[k];
    s->busy = false;
    if (s->stalled) return; /* it will begin again when it resumes */
    struct task t = s->queue[0];
    memmove(s->queue, s->queue + 1, --s->n_queue * sizeof *s->queue);
    say_twice_or_worse(
        w, k, (struct sched_event){.kind = SCHED_DONE, .task = t, .wall_us = wall_us});
    if (w->plan->concentrate) append_task(&s->held, &s->n_held, &s->cap_held, &t);
    else send_pixels(w, k, &t);
    start_next(w, k);
}

void resume(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    s->stalled = false;
    w->result->pauses++;
    if (s->flush_due) hand_over(w, k);
    s->flush_due = false;
    start_next(w, k);
}

void kill_slot(struct world *w, int32_t k)
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
