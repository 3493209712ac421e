/* What a table's samples tell: intervals of points, claims about two methods. See inference.h. */
#include "inference/inference.h"

#include <float.h>
#include <stdlib.h>

static const struct table_row *rows_of(const struct table *t, const struct table_point *p)
{
    return &t->rows[p->from];
}

void inference_mark_outliers(struct table *t)
{
    for (size_t i = 0; i < t->n_points; i++) {
        struct table_row *r = &t->rows[t->points[i].from];
        size_t n = t->points[i].n;
        double low, high, *y = xmalloc(n, sizeof *y);
        inference_fences(y, table_samples(r, n, y), &low, &high);
        for (size_t k = 0; k < n; k++) r[k].outlier = r[k].y < low || r[k].y > high;
        free(y);
    }
}

struct interval inference_point(const struct table *t, const struct table_point *p, double level,
    size_t *kept, double *variance)
{
    double *y = xmalloc(p->n, sizeof *y);
    *kept = table_samples(rows_of(t, p), p->n, y);
    struct interval of = inference_mean(y, *kept, level);
    if (variance) *variance = stats_variance(y, *kept);
    free(y);
    return of;
}

void inference_means(struct table *t, double level)
{
    for (struct table_point *p = t->points; p < t->points + t->n_points; p++) {
        size_t n;
        struct interval of = inference_point(t, p, level, &n, NULL);
        p->shown = (struct table_range){of.low, of.estimate, of.high};
        if (n < 2) p->shown.low = p->shown.high = of.estimate;
        p->x.low = p->x.high = p->x.at;
    }
}

/* ---- two methods ----------------------------------------------------------------------------- */

/* Differences of the samples that both methods have. */
static size_t pair(
    const struct table_row *a, size_t n, const struct table_row *b, size_t m, double *y)
{
    size_t pairs = 0;
    for (size_t i = 0, k = 0; i < n && k < m;) {
        int d = table_by_sample(&a[i], &b[k]);
        if (d == 0 && !a[i].outlier && !b[k].outlier) y[pairs++] = a[i].y - b[k].y;
        if (d <= 0) i++;
        if (d >= 0) k++;
    }
    return pairs;
}

struct interval inference_compare(const struct claim *c, const struct table *t,
    const struct table_point *a, const struct table_point *b, size_t *used)
{
    const struct table_row *of_a = rows_of(t, a), *of_b = rows_of(t, b);
    double *x = xmalloc(a->n + b->n, sizeof *x), *y = x + a->n;
    struct interval of;
    if (c->relation == INFERENCE_STEADIER) {
        size_t p = table_samples(of_a, a->n, x), q = table_samples(of_b, b->n, y);
        of = inference_spread(x, p, y, q, c->level);
        *used = p < q ? p : q;
    } else {
        *used = pair(of_a, a->n, of_b, b->n, x);
        of = inference_mean(x, *used, c->level);
    }
    if (c->relation == INFERENCE_SAME) {
        /* If the mean is 0, only 0 counts as the same. */
        double whole = fmax(fabs(stats_mean(y, table_samples(of_b, b->n, y))), DBL_MIN);
        of = (struct interval){of.estimate / whole, of.low / whole, of.high / whole};
    }
    free(x);
    return of;
}

const char *inference_verdict(const struct claim *c, struct interval of, size_t used)
{
    if (used < 2) return "open";
    switch (c->relation) {
    case INFERENCE_MORE: return of.low > 0 ? "holds" : of.high <= 0 ? "fails" : "open";
    case INFERENCE_SAME:
        if (of.low >= -c->margin && of.high <= c->margin) return "holds";
        return of.low > c->margin || of.high < -c->margin ? "fails" : "open";
    default: return of.high < 0 ? "holds" : of.low >= 0 ? "fails" : "open";
    }
}
