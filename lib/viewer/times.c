/* How long a user waits. */
#include "viewer/viewer_int.h"

#include <inttypes.h>
#include <stdlib.h>

void times_input(struct times *t, int64_t at_us)
{
    buf_append(&t->waiting, &at_us, sizeof at_us);
    t->inputs++;
}

static void move_all(struct buf *to, struct buf *from)
{
    buf_append(to, buf_data(from), buf_size(from));
    buf_consume(from, buf_size(from));
}

/* Inputs whose view was given up wait for the next one. */
void times_view(struct times *t) { move_all(&t->asked, &t->waiting); }

static void note_all(struct buf *to, const struct buf *from, int64_t now_us)
{
    const int64_t *at = (const int64_t *)(const void *)buf_data(from);
    for (size_t i = 0; i < buf_size(from) / sizeof *at; i++) {
        const double us = (double)(now_us - at[i]);
        buf_append(to, &us, sizeof us);
    }
}

void times_coarse(struct times *t, int64_t now_us)
{
    if (!buf_size(&t->asked)) return;
    note_all(&t->coarse, &t->asked, now_us);
    buf_consume(&t->rough, buf_size(&t->rough));
    move_all(&t->rough, &t->asked);
}

/* Only the last input of a view: that is when the user let go. */
void times_whole(struct times *t, int64_t now_us)
{
    const size_t n = buf_size(&t->rough);
    if (n) buf_consume(&t->rough, n - sizeof(int64_t));
    note_all(&t->whole, &t->rough, now_us);
    buf_consume(&t->rough, buf_size(&t->rough));
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median and 95th percentile: the least value that 50 or 95 of 100 do not exceed. */
static void put_ranks(struct buf *out, const char *name, const struct buf *of)
{
    const size_t n = buf_size(of) / sizeof(double);
    buf_printf(out, "%s\t%zu\n", name, n);
    if (!n) return;
    double *v = xmalloc(n, sizeof *v);
    for (size_t i = 0; i < n; i++) v[i] = ((const double *)(const void *)buf_data(of))[i];
    qsort(v, n, sizeof *v, by_size);
    buf_printf(out, "%s_median_ms\t%.3f\n", name, v[(n + 1) / 2 - 1] / 1e3);
    buf_printf(out, "%s_p95_ms\t%.3f\n", name, v[(95 * n + 99) / 100 - 1] / 1e3);
    free(v);
}

void times_write(const struct times *t, const struct look_counts *c, struct buf *out)
{
    buf_printf(out, "inputs\t%" PRIu64 "\n", t->inputs);
    put_ranks(out, "coarse", &t->coarse);
    put_ranks(out, "whole", &t->whole);
    const struct {
        const char *name;
        uint64_t n;
    } rows[] = {{"views", c->views}, {"tasks", c->tasks}, {"pixels", c->px},
        {"stale_pixels", c->stale_px}, {"again_pixels", c->again_px},
        {"failed_pixels", c->failed_px}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        buf_printf(out, "%s\t%" PRIu64 "\n", rows[i].name, rows[i].n);
}

void times_free(struct times *t)
{
    buf_free(&t->waiting);
    buf_free(&t->asked);
    buf_free(&t->rough);
    buf_free(&t->coarse);
    buf_free(&t->whole);
}
