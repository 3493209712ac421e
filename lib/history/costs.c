/* What the tasks of a log cost: see history.h. */
#include "history/history.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int64_t history_longest_us(const struct history *l, int64_t most_us)
{
    int64_t longest_us = 0;
    int32_t run = -1;
    for (size_t i = 0; i < l->n_dones; i++) {
        const struct history_done *d = &l->dones[i];
        int64_t us = d->run == run ? d->wall_us : d->recv_us;
        run = d->run;
        /* wall_us is the worker's word: no task took longer than fan had run. */
        if (d->recv_us >= 0 && us > d->recv_us) us = d->recv_us;
        if (us > longest_us && us <= most_us) longest_us = us;
    }
    return longest_us;
}

/* Each pixel costs its share of the task that brought it first; the others get the mean. */
static void spread(const struct history *l, struct history_costs *c)
{
    const struct history_frame *f = &l->frames[0];
    const size_t n = (size_t)f->w * f->h;
    size_t known = 0;
    double sum = 0;
    *c = (struct history_costs){f->w, f->h, xmalloc(n, sizeof *c->us)};
    for (size_t p = 0; p < n; p++) c->us[p] = -1;
    for (size_t k = 0; k < l->n_frags; k++) {
        const struct history_frag *frag = &l->frags[k];
        if (frag->frame != f->number || frag->done < 0) continue;
        const struct history_done *d = &l->dones[frag->done];
        for (uint64_t i = 0; i < lattice_count(&frag->at); i++) {
            double *us = &c->us[lattice_pixel(&frag->at, f->w, i)];
            if (*us >= 0) continue;
            *us = (double)d->cpu_us / (double)d->sent;
            sum += *us;
            known++;
        }
    }
    for (size_t p = 0; p < n; p++)
        if (c->us[p] < 0) c->us[p] = sum / (double)known;
    if (!known) history_costs_free(c);
}

bool history_costs_read(const char *path, struct history_costs *c, char err[HISTORY_ERR])
{
    struct history l = {0};
    struct history_file file;
    *c = (struct history_costs){0};
    if (history_open(&file, path) != 0) {
        snprintf(err, HISTORY_ERR, "%s", strerror(errno));
        return false;
    }
    history_read_bytes(&l, file.bytes, file.n);
    const bool good = !l.refused;
    if (!good) snprintf(err, HISTORY_ERR, "%s", l.why);
    else if (l.n_frames) spread(&l, c);
    history_free(&l);
    history_close(&file);
    return good;
}

void history_costs_free(struct history_costs *c)
{
    free(c->us);
    *c = (struct history_costs){0};
}

static double cost_at(const struct history_costs *c, uint64_t p, uint32_t frame_w, uint32_t frame_h)
{
    uint64_t x = p % frame_w * c->w / frame_w, y = p / frame_w * c->h / frame_h;
    return c->us[y * c->w + x];
}

void history_costs_put(const struct history_costs *c, const struct lattice *at, uint32_t frame_w,
    uint32_t frame_h, double *us)
{
    for (uint64_t k = 0, n = lattice_count(at); k < n; k++) {
        uint64_t p = lattice_pixel(at, frame_w, k);
        us[p] = cost_at(c, p, frame_w, frame_h);
    }
}

double history_cost_of(
    const struct history_costs *c, const struct lattice *at, uint32_t frame_w, uint32_t frame_h)
{
    double us = 0;
    for (uint64_t k = 0, n = lattice_count(at); k < n; k++)
        us += cost_at(c, lattice_pixel(at, frame_w, k), frame_w, frame_h);
    return us;
}
