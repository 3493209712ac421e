/*
 * The fan alone, as a policy: tasks wait until their slot is up, and then go there, once.
 */
#include "sim/sim.h"

#include <stdlib.h>

struct fan {
    struct task_table ledger;  /* uncommitted tasks */
    struct task_list *waiting; /* per slot; later they are on no list */
    bool *up;
    int32_t n_slots; /* 0: not known yet; all tasks wait in: */
    struct task_list early;
    int64_t n_waiting;
    bool ended, closed;
};

static void *fan_create(const struct sched_params *p)
{
    (void)p;
    struct fan *f = xcalloc(1, sizeof *f);
    tasks_init(&f->ledger, 0);
    f->early = TASK_LIST_EMPTY;
    return f;
}

static void fan_destroy(void *state)
{
    struct fan *f = state;
    tasks_free(&f->ledger);
    free(f->waiting);
    free(f->up);
    free(f);
}

static void give(struct fan *f, int32_t k, int32_t i, struct sched_actions *out)
{
    f->n_waiting--;
    sched_act(out, SCHED_GIVE, k, &f->ledger.at[i].task);
}

static void route(struct fan *f, int32_t i, struct sched_actions *out)
{
    const struct task *t = &f->ledger.at[i].task;
    int32_t k = t->to >= 0 && t->to < f->n_slots ? t->to : (int32_t)(t->id % (uint32_t)f->n_slots);
    if (f->up[k]) give(f, k, i, out);
    else list_push_back(&f->ledger, &f->waiting[k], i);
}

static void take_task(struct fan *f, const struct sched_event *e, struct sched_actions *out)
{
    int32_t i = tasks_add(&f->ledger, &e->task, e->frame_w);
    f->n_waiting++;
    if (f->n_slots) route(f, i, out);
    else list_push_back(&f->ledger, &f->early, i);
}

static void take_slots(struct fan *f, int32_t n, struct sched_actions *out)
{
    f->n_slots = n;
    f->waiting = xmalloc((size_t)n, sizeof *f->waiting);
    f->up = xcalloc((size_t)n, sizeof *f->up);
    for (int32_t k = 0; k < n; k++) f->waiting[k] = TASK_LIST_EMPTY;
    while (f->early.count) {
        int32_t i = f->early.head;
        list_remove(&f->ledger, &f->early, i);
        route(f, i, out);
    }
}

static void take_up(struct fan *f, int32_t k, struct sched_actions *out)
{
    f->up[k] = true;
    while (f->waiting[k].count) {
        int32_t i = f->waiting[k].head;
        list_remove(&f->ledger, &f->waiting[k], i);
        give(f, k, i, out);
    }
}

static void take_pixels(struct fan *f, const struct sched_event *e, struct sched_actions *out)
{
    int32_t i = tasks_find(&f->ledger, e->task.frame, e->task.id);
    if (i < 0 || !tasks_deliver(&f->ledger, i, &e->task.at) || !tasks_whole(&f->ledger, i)) return;
    sched_act(out, SCHED_COMMIT, e->slot, &f->ledger.at[i].task);
    tasks_remove(&f->ledger, i);
}

static void fan_step(
    void *state, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    struct fan *f = state;
    bool known = e->slot < f->n_slots; /* slots that join later get nothing */
    (void)now;
    switch (e->kind) {
    case SCHED_TASK: take_task(f, e, out); break;
    case SCHED_SLOTS: take_slots(f, e->n, out); break;
    case SCHED_UP:
        if (known) take_up(f, e->slot, out);
        break;
    case SCHED_GONE:
        if (known) f->up[e->slot] = false;
        break;
    case SCHED_PIXELS: take_pixels(f, e, out); break;
    case SCHED_INPUT_END: f->ended = true; break;
    default: break;
    }
    if (!f->ended || f->ledger.count || f->closed) return;
    f->closed = true;
    sched_act(out, SCHED_END, -1, NULL);
}

static int32_t fan_uncommitted(const void *state, uint32_t generation)
{
    return tasks_in_generation(&((const struct fan *)state)->ledger, generation);
}
static int64_t fan_waiting(const void *state) { return ((const struct fan *)state)->n_waiting; }
static int32_t fan_tries(const void *state, int32_t slot, uint32_t frame, uint32_t id)
{
    (void)state, (void)slot, (void)frame, (void)id;
    return 1;
}

const struct policy sim_fan = {
    "fan", fan_create, fan_step, fan_uncommitted, fan_waiting, fan_tries, NULL, fan_destroy, false};
