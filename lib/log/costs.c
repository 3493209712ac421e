/* The cost of pixels, from a log. */
#include "log/log.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The size and the time of a task. */
struct cost {
    double us; /* its time; -1: not known */
    uint32_t pixels;
};

/* Payload of a task. */
struct cost_ref {
    size_t at; /* index of its cost */
};

struct survey {
    struct log_costs *costs;
    uint32_t frame;
    struct task_table tasks; /* of this run: in another run a key may mean another task */
    struct cost *cost;       /* of tasks of all runs */
    size_t n;
    uint32_t *of;   /* by pixel: 1 + the index of its task's cost, or 0 */
    uint32_t *last; /* the same of the last task that brought it */
};

/* The index of the task's cost. */
static size_t place_of(struct survey *s, const struct task *t)
{
    int32_t i = tasks_find(&s->tasks, t->frame, t->id);
    if (i >= 0) return ((const struct cost_ref *)tasks_extra(&s->tasks, i))->at;
    struct cost_ref *ref = tasks_extra(&s->tasks, tasks_add(&s->tasks, t, 0));
    if ((s->n & (s->n - 1)) == 0) /* full: a power of two */
        s->cost = xrealloc(s->cost, s->n ? 2 * s->n : 1, sizeof *s->cost);
    s->cost[s->n] = (struct cost){.us = -1};
    return ref->at = s->n++;
}

static void take_frag(struct survey *s, const struct task *t)
{
    const struct log_costs *c = s->costs;
    if (!s->of || t->frame != s->frame || !lattice_valid(&t->at, c->w, c->h)) return;
    size_t place = place_of(s, t);
    for (uint64_t i = 0, n = lattice_count(&t->at); i < n; i++) {
        const uint64_t p = lattice_pixel(&t->at, c->w, i);
        if (!s->of[p]) s->of[p] = (uint32_t)place + 1;
        if (s->last[p] == place + 1) continue; /* a second copy of the task */
        s->last[p] = (uint32_t)place + 1;
        s->cost[place].pixels++;
    }
}

static void take(void *ctx, const struct record *r)
{
    struct survey *s = ctx;
    int64_t us;
    if (r->kind == REC_HELLO) tasks_free(&s->tasks); /* a run begins */
    if (r->kind == REC_FRAME && !s->of) {
        s->frame = r->task.frame;
        s->costs->w = r->frame_w;
        s->costs->h = r->frame_h;
        s->of = xcalloc((size_t)r->frame_w * r->frame_h, sizeof *s->of);
        s->last = xcalloc((size_t)r->frame_w * r->frame_h, sizeof *s->last);
    }
    if (r->kind == REC_FRAG) take_frag(s, &r->task);
    if (r->kind == REC_DONE && rec_int(r, "cpu_us", 0, INT64_MAX, &us)) {
        size_t place = place_of(s, &r->task);
        struct cost *cost = &s->cost[place];
        if (cost->us < 0) cost->us = (double)us;
    }
}

/* Pixels without a cost get the mean of the others. */
static void spread(struct survey *s)
{
    struct log_costs *c = s->costs;
    size_t n = (size_t)c->w * c->h, known = 0;
    double sum = 0;
    c->us = xmalloc(n, sizeof *c->us);
    for (size_t p = 0; p < n; p++) {
        const struct cost *cost = s->of[p] ? &s->cost[s->of[p] - 1] : NULL;
        c->us[p] = cost && cost->us >= 0 ? cost->us / cost->pixels : -1;
        if (c->us[p] < 0) continue;
        known++;
        sum += c->us[p];
    }
    for (size_t p = 0; p < n; p++)
        if (c->us[p] < 0) c->us[p] = sum / (double)known;
    if (!known) log_costs_free(c);
}

int log_costs_read(const char *path, struct log_costs *c, char why[LOG_WHY])
{
    struct survey s = {.costs = c};
    const struct log_reader reader = {.record = take, .ctx = &s};
    *c = (struct log_costs){0};
    tasks_init(&s.tasks, sizeof(struct cost_ref));
    int failed = log_read_path(path, &reader, why);
    if (failed < 0) snprintf(why, LOG_WHY, "%s", strerror(errno));
    if (!failed && s.of) spread(&s);
    tasks_free(&s.tasks);
    free(s.cost);
    free(s.of);
    free(s.last);
    return failed;
}

void log_costs_free(struct log_costs *c)
{
    free(c->us);
    *c = (struct log_costs){0};
}

double log_cost_at(const struct log_costs *c, uint64_t p, uint32_t frame_w, uint32_t frame_h)
{
    uint64_t x = p % frame_w * c->w / frame_w, y = p / frame_w * c->h / frame_h;
    return c->us[y * c->w + x];
}

void log_costs_put(const struct log_costs *c, const struct lattice *at, uint32_t frame_w,
    uint32_t frame_h, double *us)
{
    for (uint64_t k = 0, n = lattice_count(at); k < n; k++) {
        uint64_t p = lattice_pixel(at, frame_w, k);
        us[p] = log_cost_at(c, p, frame_w, frame_h);
    }
}

double log_cost_of(
    const struct log_costs *c, const struct lattice *at, uint32_t frame_w, uint32_t frame_h)
{
    double us = 0;
    for (uint64_t k = 0, n = lattice_count(at); k < n; k++)
        us += log_cost_at(c, lattice_pixel(at, frame_w, k), frame_w, frame_h);
    return us;
}
