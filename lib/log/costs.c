/* The cost of pixels, from a log. */
#include "log/log.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct survey {
    struct log_costs *costs;
    uint32_t frame;
    struct task_table tasks; /* of this run: in another run a key may mean another task */
    size_t before;           /* tasks of earlier runs; their entries come first */
    double *us;              /* time of the task; -1 if the log has none */
    uint32_t *pixels;
    size_t room;
    uint32_t *of; /* by pixel: 1 + the entry of its task, or 0 */
};

static size_t place_of(struct survey *s, const struct task *t)
{
    int32_t i = tasks_find(&s->tasks, t->frame, t->id);
    if (i >= 0) return s->before + (size_t)i;
    size_t place = s->before + (size_t)tasks_add(&s->tasks, t, 0);
    if (s->room < s->before + (size_t)s->tasks.cap) {
        s->room = s->before + (size_t)s->tasks.cap;
        s->us = xrealloc(s->us, s->room, sizeof *s->us);
        s->pixels = xrealloc(s->pixels, s->room, sizeof *s->pixels);
    }
    s->us[place] = -1;
    s->pixels[place] = 0;
    return place;
}

/* A hello begins a run. No task is removed, so the table's indices are consecutive from 0. */
static void begin_run(struct survey *s)
{
    s->before += (size_t)s->tasks.count;
    tasks_free(&s->tasks);
}

static void take_frag(struct survey *s, const struct task *t)
{
    const struct log_costs *c = s->costs;
    if (!s->of || t->frame != s->frame || !lattice_valid(&t->at, c->w, c->h)) return;
    size_t place = place_of(s, t);
    for (uint64_t i = 0, n = lattice_count(&t->at); i < n; i++) {
        uint32_t *of = &s->of[lattice_pixel(&t->at, c->w, i)];
        if (*of) continue;
        *of = (uint32_t)place + 1;
        s->pixels[place]++;
    }
}

static void take(void *ctx, const struct record *r)
{
    struct survey *s = ctx;
    int64_t us;
    if (r->kind == REC_HELLO) begin_run(s);
    if (r->kind == REC_FRAME && !s->of) {
        s->frame = r->task.frame;
        s->costs->w = r->frame_w;
        s->costs->h = r->frame_h;
        s->of = xcalloc((size_t)r->frame_w * r->frame_h, sizeof *s->of);
    }
    if (r->kind == REC_FRAG) take_frag(s, &r->task);
    if (r->kind == REC_DONE && rec_int(r, "cpu_us", 0, INT64_MAX, &us)) {
        size_t i = place_of(s, &r->task);
        if (s->us[i] < 0) s->us[i] = (double)us;
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
        uint32_t of = s->of[p];
        c->us[p] = of && s->us[of - 1] >= 0 ? s->us[of - 1] / s->pixels[of - 1] : -1;
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
    struct intake unused = {0};
    const struct log_reader reader = {.record = take, .ctx = &s};
    *c = (struct log_costs){0};
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    int failed = fd < 0 ? -1 : log_read(&unused, fd, path, &reader);
    if (failed) snprintf(why, LOG_WHY, "%s", failed > 0 ? unused.why : strerror(errno));
    if (fd >= 0) close(fd);
    if (!failed && s.of) spread(&s);
    tasks_free(&s.tasks);
    free(s.us);
    free(s.pixels);
    free(s.of);
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
