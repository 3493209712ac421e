/* The measures of a run: the lower bound, and a schedule made with all costs known. */
#include "sim/sim.h"
#include "stats/stats.h"

#include <stdlib.h>
#include <string.h>

/* ---- the bound ------------------------------------------------------------------------------- */

double sim_bound_s(const struct sim_plan *p)
{
    size_t n = (size_t)p->work->frame_w * p->work->frame_h, m = (size_t)p->slots;
    double *v = xmalloc(m, sizeof *v);
    memcpy(v, p->work->power, m * sizeof *v);
    double s = stats_lower_bound(p->work->pixel_us, n, v, m) * 1e-6;
    double px = 0;
    for (int32_t i = 0; i < p->tasks; i++) px += (double)lattice_count(&p->work->tasks[i].at);
    px = fmin(px, (double)n); /* tasks may leave out pixels, or overlap */
    if (p->hub_bytes_per_s > 0) s = fmax(s, SIM_PIXEL_BYTES * px / p->hub_bytes_per_s);
    free(v);
    return s;
}

/* ---- longest first, then local search -------------------------------------------------------- */

struct job {
    double us; /* at power 1 */
    int32_t task;
};
struct best {
    const double *power;
    struct job *jobs; /* longest first */
    int32_t n, slots;
    double *load_us; /* of each slot, at power 1 */
    int32_t *to;     /* slot of each job */
};

static int longest_first(const void *a, const void *b)
{
    const struct job *x = a, *y = b;
    if (x->us != y->us) return x->us > y->us ? -1 : 1;
    return x->task < y->task ? -1 : 1;
}

/* The end of slot k with this much more work. */
static double ends_us(const struct best *b, int32_t k, double more_us)
{
    return (b->load_us[k] + more_us) / b->power[k];
}

static void put(struct best *b, int32_t j, int32_t k)
{
    if (b->to[j] >= 0) b->load_us[b->to[j]] -= b->jobs[j].us;
    b->to[j] = k;
    b->load_us[k] += b->jobs[j].us;
}

static int32_t first_done(const struct best *b, double us)
{
    int32_t best = 0;
    for (int32_t k = 1; k < b->slots; k++)
        if (ends_us(b, k, us) < ends_us(b, best, us)) best = k;
    return best;
}

static int32_t last_done(const struct best *b)
{
    int32_t last = 0;
    for (int32_t k = 1; k < b->slots; k++)
        if (ends_us(b, k, 0) > ends_us(b, last, 0)) last = k;
    return last;
}

/* True if moving job j from slot `last` to k, with other_us coming back, makes `last` end
 * earlier and no other slot end as late. */
static bool relieves(const struct best *b, int32_t last, int32_t j, int32_t k, double other_us)
{
    double moved_us = b->jobs[j].us - other_us, end_us = ends_us(b, last, 0);
    return moved_us > 1e-9 * end_us && ends_us(b, k, moved_us) < end_us * (1 - 1e-12);
}

/* Moves or swaps a job of the slot that ends last. False if nothing helps. */
static bool improve(struct best *b)
{
    int32_t last = last_done(b);
    for (int32_t j = 0; j < b->n; j++) {
        if (b->to[j] != last) continue;
        int32_t k = first_done(b, b->jobs[j].us);
        if (k != last && relieves(b, last, j, k, 0)) {
            put(b, j, k);
            return true;
        }
        for (int32_t i = j + 1; i < b->n; i++) { /* shorter ones */
            k = b->to[i];
            if (k == last || !relieves(b, last, j, k, b->jobs[i].us)) continue;
            put(b, j, k);
            put(b, i, last);
            return true;
        }
    }
    return false;
}

void sim_best(const struct sim_work *work, int32_t tasks, int32_t slots, int32_t *to)
{
    struct best b = {.power = work->power, .n = tasks, .slots = slots};
    b.jobs = xcalloc((size_t)tasks + 1, sizeof *b.jobs);
    b.to = xcalloc((size_t)tasks + 1, sizeof *b.to);
    b.load_us = xcalloc((size_t)slots, sizeof *b.load_us);
    for (int32_t i = 0; i < tasks; i++) {
        const struct lattice *at = &work->tasks[i].at;
        b.jobs[i] = (struct job){work->task_us, i};
        for (uint64_t n = 0, all = lattice_count(at); n < all; n++)
            b.jobs[i].us += work->pixel_us[lattice_pixel(at, work->frame_w, n)];
        b.to[i] = -1;
    }
    qsort(b.jobs, (size_t)tasks, sizeof *b.jobs, longest_first);
    for (int32_t j = 0; j < tasks; j++) put(&b, j, first_done(&b, b.jobs[j].us));
    while (improve(&b))
        ;
    for (int32_t j = 0; j < tasks; j++) to[b.jobs[j].task] = b.to[j];
    free(b.jobs);
    free(b.to);
    free(b.load_us);
}
