/* The world of a run: its random numbers, its queue of events, its tasks. */
#include "sim/world.h"

#include <stdlib.h>

#define PIECES_MOST (1 << 20) /* limit of new ids above those of the plan */

double sim_draw(struct world *w) { return rng_unit(w->plan->seed, w->draws++ << 8); }

void sim_fail(struct world *w, const char *what, int64_t a, int64_t b)
{
    sim_note_failure(w->result, w->now_us, what, a, b);
}

void sim_schedule(struct world *w, int64_t at_us, int32_t k, struct sim_event e)
{
    e.at_us = at_us;
    e.slot = k;
    e.epoch = k >= 0 ? w->slots[k].epoch : 0;
    e.hub = w->hub;
    sim_heap_push(&w->heap, &e);
}

void sim_schedule_wake(struct world *w, const struct policy *p, void *state, int32_t k)
{
    int64_t *next_us = k < 0 ? &w->wake_us : &w->slots[k].wake_us;
    int64_t at = p->wake_us ? p->wake_us(state) : INT64_MAX;
    if (at >= *next_us) return;
    *next_us = at < w->now_us ? w->now_us : at;
    sim_schedule(w, *next_us, k, (struct sim_event){.kind = SIM_WAKE});
}

struct vtask *sim_vtask_at(struct world *w, uint32_t id)
{
    if (id >= (uint32_t)w->plan->tasks + PIECES_MOST) return NULL;
    while (w->n_tasks <= (int32_t)id) {
        if (w->n_tasks == w->cap_tasks) {
            w->cap_tasks = w->cap_tasks ? 2 * w->cap_tasks : 256;
            w->tasks = xrealloc(w->tasks, (size_t)w->cap_tasks, sizeof *w->tasks);
        }
        struct vtask *t = &w->tasks[w->n_tasks];
        *t = (struct vtask){.to = -1};
        t->task.id = (uint32_t)w->n_tasks++;
        if (w->checks && w->checks->task) w->checks->task(t);
    }
    return &w->tasks[id];
}

void sim_start_slots(struct world *w, int64_t known_us)
{
    const struct sim_plan *p = w->plan;
    sim_schedule(w, known_us, 0,
        (struct sim_event){
            .kind = SIM_SCHED, .sched = {.kind = SCHED_SLOTS, .n = p->slots - p->joins}});
    for (int32_t k = 0; k < p->slots; k++) {
        double latest_us = k < p->slots - p->joins ? 1e5 : (double)p->faults_us;
        int64_t up_us = p->work ? 0 : (int64_t)(sim_draw(w) * latest_us);
        int64_t from_us = known_us > sim_joins_us(p, k) ? known_us : sim_joins_us(p, k);
        sim_schedule(
            w, from_us + up_us + sim_connect_us(p, k), k, (struct sim_event){.kind = SIM_RETURN});
    }
}
