/* Workers of every simulated run: their tasks, and their time. */
#include "sim/worker.h"

#include <stdio.h>
#include <string.h>

void sim_append_task(struct sim_tasks *l, const struct task *t)
{
    if (l->first > l->n / 2) { /* reuses the room of taken entries */
        l->n -= l->first;
        memmove(l->at, l->at + l->first, l->n * sizeof *l->at);
        l->first = 0;
    }
    if (l->n == l->cap) {
        l->cap = l->cap ? 2 * l->cap : 4;
        l->at = xrealloc(l->at, l->cap, sizeof *l->at);
    }
    l->at[l->n++] = *t;
}

double sim_work_us(const struct sim_work *work, const struct task *t)
{
    double us = work->task_us;
    for (uint64_t i = 0, n = lattice_count(&t->at); i < n; i++)
        us += work->pixel_us[lattice_pixel(&t->at, work->frame_w, i)];
    return us;
}

/* ---- time ------------------------------------------------------------------------------------ */

void sim_clock_begin(struct sim_clock *c, int64_t now_us)
{
    c->busy = true;
    c->began_us = now_us;
    if (c->first_us < 0) c->first_us = now_us;
}

int64_t sim_clock_round(struct sim_clock *c, double us)
{
    c->rest_us += us;
    int64_t whole_us = llround(fmax(c->rest_us, 0));
    c->rest_us -= (double)whole_us;
    return whole_us;
}

void sim_clock_end(struct sim_clock *c, int64_t now_us)
{
    if (!c->busy) return;
    c->busy = false;
    c->busy_us += (double)(now_us - c->began_us);
    c->last_us = now_us;
}

void sim_clock_split(const struct sim_clock *c, int64_t end_us, struct sim_result *r)
{
    double end = (double)end_us, first = (double)c->first_us;
    if (c->first_us < 0) {
        r->startup_us += end;
        return;
    }
    double busy = c->busy_us + (c->busy ? end - (double)c->began_us : 0);
    double last = c->busy ? end : (double)c->last_us;
    r->startup_us += first;
    r->busy_us += busy;
    r->waiting_us += last - first - busy;
    r->tail_us += end - last;
}

/* ---- failures -------------------------------------------------------------------------------- */

void sim_note_failure(struct sim_result *r, int64_t now_us, const char *what, int64_t a, int64_t b)
{
    if (*r->failure) return;
    snprintf(r->failure, sizeof r->failure, "%s (%lld, %lld) at %lld us", what, (long long)a,
        (long long)b, (long long)now_us);
}
