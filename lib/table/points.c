/* From rows to points: order, medians, the Pareto front. */
#include "table/table.h"
#include "stats/stats.h"

#include <stdlib.h>
#include <string.h>

static int differ(double a, double b) { return (a > b) - (a < b); }
static int apart(const char *a, const char *b) { return a == b ? 0 : strcmp(a, b); }

/* Orders by setting or, if there is none, by x. */
static int by_point(const struct table_row *a, const struct table_row *b)
{
    int d = apart(a->experiment, b->experiment);
    if (!d) d = apart(a->kind, b->kind);
    if (!d) d = apart(a->method, b->method);
    if (!d && !a->setting) d = differ(a->x, b->x);
    return d;
}

int table_by_sample(const struct table_row *a, const struct table_row *b)
{
    int d = (a->sample > b->sample) - (a->sample < b->sample);
    return d ? d : (a->seed > b->seed) - (a->seed < b->seed);
}

static int by_line(const void *a, const void *b)
{
    const struct table_row *p = a, *q = b;
    return (p->line > q->line) - (p->line < q->line);
}

static int in_order(const void *a, const void *b)
{
    int d = by_point(a, b);
    if (!d) d = table_by_sample(a, b);
    return d ? d : by_line(a, b);
}

static int points_by_line(const void *a, const void *b)
{
    const struct table_point *p = a, *q = b;
    return (p->line > q->line) - (p->line < q->line);
}

bool table_points(struct table *t, char err[ERR_BYTES])
{
    qsort(t->rows, t->n_rows, sizeof *t->rows, in_order);
    for (size_t i = 1; i < t->n_rows; i++) {
        const struct table_row *a = &t->rows[i - 1], *b = &t->rows[i];
        if (by_point(a, b) == 0 && table_by_sample(a, b) == 0)
            return err_set(err,
                "%.100s:%zu: the same experiment, kind, method, %s, sample and seed as in line "
                "%zu, expected each once",
                t->name, b->line, a->setting ? "setting" : "x", a->line);
    }
    if (t->intervals) return true;
    t->points = xmalloc(t->n_rows, sizeof *t->points);
    for (size_t i = 0; i < t->n_rows; i++) {
        if (!i || by_point(&t->rows[i - 1], &t->rows[i]) != 0)
            t->points[t->n_points++] = (struct table_point){.from = i, .line = SIZE_MAX};
        struct table_point *p = &t->points[t->n_points - 1];
        p->n++;
        if (t->rows[i].line < p->line) p->line = t->rows[i].line;
    }
    return true;
}

size_t table_samples(const struct table_row *r, size_t n, double *y)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++)
        if (!r[i].outlier) y[kept++] = r[i].y;
    return kept;
}

/* Median and range of at least one value. Sorts v. */
static struct table_range range(double *v, size_t n)
{
    double median = stats_median(v, n); /* sorts, descending */
    return (struct table_range){v[n - 1], median, v[0]};
}

void table_medians(struct table *t)
{
    for (size_t i = 0; i < t->n_points; i++) {
        struct table_point *p = &t->points[i];
        double *v = xmalloc(p->n, sizeof *v);
        size_t kept = 0;
        for (size_t k = 0; k < p->n; k++)
            if (!t->rows[p->from + k].outlier) v[kept++] = t->rows[p->from + k].x;
        p->x = range(v, kept);
        for (size_t k = 0; k < p->n; k++) v[k] = t->rows[p->from + k].y;
        p->y = range(v, p->n);
        p->shown = range(v, table_samples(&t->rows[p->from], p->n, v));
        free(v);
    }
}

void table_as_read(struct table *t)
{
    if (t->intervals) qsort(t->rows, t->n_rows, sizeof *t->rows, by_line);
    else qsort(t->points, t->n_points, sizeof *t->points, points_by_line);
}

/* ---- the front ------------------------------------------------------------------------------- */

struct place {
    const char *experiment;
    struct table_point *point;
};

static int by_place(const void *a, const void *b)
{
    const struct place *p = a, *q = b;
    int d = apart(p->experiment, q->experiment);
    if (!d) d = differ(p->point->x.at, q->point->x.at);
    if (!d) d = differ(p->point->shown.at, q->point->shown.at);
    return d ? d : points_by_line(p->point, q->point);
}

/* From the left to the right, the front has the points below all before them. */
void table_front(struct table *t)
{
    struct place *all = xmalloc(t->n_points, sizeof *all);
    const struct place *last = NULL; /* on the front */
    for (size_t i = 0; i < t->n_points; i++)
        all[i] = (struct place){t->rows[t->points[i].from].experiment, &t->points[i]};
    qsort(all, t->n_points, sizeof *all, by_place);
    for (size_t i = 0; i < t->n_points; i++) {
        const struct place *p = &all[i];
        p->point->front = !last || last->experiment != p->experiment ||
                          p->point->shown.at < last->point->shown.at;
        if (p->point->front) last = p;
    }
    free(all);
}
