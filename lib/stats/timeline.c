/* timeline: when each slot worked and when it was idle; see stats.h. */
#include "stats/stats.h"

#include <stdlib.h>

/* A slot in the current run. */
struct line {
    double until_s; /* end of its last task */
    bool began;     /* it has had a task */
};

/* Places a span after the slot's previous one, by the reported times. */
static void lay(struct span *s, struct line *line, struct times *t)
{
    if (s->end_s < 0) s->end_s = line->until_s + s->took_s;
    if (s->end_s < line->until_s) s->end_s = line->until_s;
    s->begin_s = s->end_s - s->took_s;
    if (s->begin_s < line->until_s) s->begin_s = line->until_s;
    *(line->began ? &t->waiting_s : &t->startup_s) += s->begin_s - line->until_s;
    *(s->wasted ? &t->wasted_s : &t->busy_s) += s->end_s - s->begin_s;
    *line = (struct line){s->end_s, true};
}

void stats_timeline(
    struct span *at, size_t n, struct times *of, size_t n_slots, double *run_s, size_t n_runs)
{
    struct line *lines = xmalloc(n_slots, sizeof *lines);
    for (size_t k = 0; k < n_slots; k++) of[k] = (struct times){0};
    size_t i = 0;
    for (size_t r = 0; r < n_runs; r++) {
        run_s[r] = 0;
        for (size_t k = 0; k < n_slots; k++) lines[k] = (struct line){0};
        for (; i < n && at[i].run == r; i++) {
            lay(&at[i], &lines[at[i].slot], &of[at[i].slot]);
            if (at[i].end_s > run_s[r]) run_s[r] = at[i].end_s;
        }
        for (size_t k = 0; k < n_slots; k++)
            *(lines[k].began ? &of[k].tail_s : &of[k].startup_s) += run_s[r] - lines[k].until_s;
    }
    free(lines);
}
