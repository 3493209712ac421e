/* Measured work: tasks, costs and powers from outside, and the plan of a run with them. */
#include "patience/patience.h"
#include "sim/sim.h"

#include <stdlib.h>

#define MOST_US 1e14       /* all tasks on the weakest slot: sums of times must fit int64_t */
#define DETECT_US 20000000 /* for nodes to detect a dead one, by the rules as published */

/* ---- tasks ----------------------------------------------------------------------------------- */

bool sim_workload_frame(
    struct sim_workload *l, uint32_t frame_w, uint32_t frame_h, char err[ERR_BYTES])
{
    if (l->frame_w) return err_set(err, "a second frame, expected one");
    l->frame_w = frame_w;
    l->frame_h = frame_h;
    return true;
}

bool sim_workload_task(struct sim_workload *l, const struct task *t, char err[ERR_BYTES])
{
    if (!lattice_valid(&t->at, l->frame_w, l->frame_h))
        return err_set(err, "task %u, expected one inside the frame", t->id);
    int32_t n = l->n++;
    if (n == 0 || (n >= 1024 && !(n & (n - 1)))) /* a power of two: full */
        l->tasks = xrealloc(l->tasks, n ? 2 * (size_t)n : 1024, sizeof *l->tasks);
    l->tasks[n] = *t;
    l->tasks[n].frame = 0;
    return true;
}

bool sim_workload_end(struct sim_workload *l, char err[ERR_BYTES])
{
    if (!l->n) return err_set(err, "no task, expected those of one frame");
    uint32_t n = (uint32_t)l->n, odd = n;
    bool *seen = xcalloc(n, sizeof *seen);
    for (uint32_t i = 0; i < n && odd == n; i++) {
        uint32_t id = l->tasks[i].id;
        if (id >= n || seen[id]) odd = i;
        else seen[id] = true;
    }
    free(seen);
    if (odd < n)
        return err_set(
            err, "task %u of %u, expected each number from 0 on, once", l->tasks[odd].id, n);
    l->pixel_us = xcalloc((size_t)l->frame_w * l->frame_h, sizeof *l->pixel_us);
    return true;
}

void sim_workload_free(struct sim_workload *l)
{
    free(l->tasks);
    free(l->pixel_us);
    free(l->power);
    free(l->links);
    free(l->link_of);
    *l = (struct sim_workload){0};
}

/* ---- costs and powers ------------------------------------------------------------------------ */

/* A number in [-1, 1), the same for the same seed and index. */
static double drawn(uint64_t seed, uint64_t i) { return 2 * rng_unit(seed, i) - 1; }

void sim_draw_costs(struct sim_workload *l, uint64_t seed, double us, double spread)
{
    for (int32_t i = 0; i < l->n; i++) {
        const struct task *t = &l->tasks[i];
        double task_us = us * pow(spread, drawn(seed, 2 * (uint64_t)t->id));
        for (uint64_t k = 0, n = lattice_count(&t->at); k < n; k++)
            l->pixel_us[lattice_pixel(&t->at, l->frame_w, k)] = task_us;
    }
}

double *sim_draw_powers(uint64_t seed, int32_t slots, double spread)
{
    double *power = xmalloc((size_t)slots, sizeof *power);
    for (int32_t k = 0; k < slots; k++) power[k] = pow(spread, drawn(seed, 2 * (uint64_t)k + 1));
    return power;
}

bool sim_workload_scale(struct sim_workload *l, double factor, char err[ERR_BYTES])
{
    double us = 0, least = 1;
    for (uint64_t p = 0, n = (uint64_t)l->frame_w * l->frame_h; p < n; p++)
        us += l->pixel_us[p] *= factor;
    for (int32_t k = 0; k < l->slots; k++) least = fmin(least, l->power[k]);
    if (us / least <= MOST_US) return true;
    return err_set(err, "tasks of %g s on the weakest slot, expected at most %g s",
        us / least * 1e-6, MOST_US * 1e-6);
}

/* ---- the plan -------------------------------------------------------------------------------- */

static void preassign_best(struct sim_workload *l)
{
    int32_t *to = xcalloc((size_t)l->n, sizeof *to);
    sim_best(&l->work, l->n, l->slots, to);
    for (int32_t i = 0; i < l->n; i++) l->tasks[i].to = to[i];
    free(to);
}

bool sim_workload_plan(
    struct sim_workload *l, const struct sim_method *m, struct sim_plan *p, char err[ERR_BYTES])
{
    for (size_t i = 0; i < p->n_faults; i++)
        if (p->faults[i].slot >= l->slots)
            return err_set(
                err, "slot %d of %d, expected one from 0 on", p->faults[i].slot, l->slots);
    if (p->n_loads && p->loads[p->n_loads - 1].slot >= l->slots)
        return err_set(
            err, "slot %d of %d, expected one from 0 on", p->loads[p->n_loads - 1].slot, l->slots);
    l->work = (struct sim_work){.frame_w = l->frame_w,
        .frame_h = l->frame_h,
        .tasks = l->tasks,
        .pixel_us = l->pixel_us,
        .power = l->power};
    if (m->best) preassign_best(l);
    p->slots = l->slots;
    p->links = l->links;
    p->link_of = l->link_of;
    p->n_links = l->n_links;
    p->tasks = l->n;
    p->width = 1;
    p->work = &l->work;
    p->node = m->node;
    p->silence_us = PATIENCE_SILENCE_US;
    p->detect_us = m->policy == &policy_published ? DETECT_US : 0;
    p->faults_us = (int64_t)(1e6 * sim_bound_s(p));
    return true;
}
