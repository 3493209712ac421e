/* stats: measures; see stats.h. */
#include "stats/stats.h"

#include <stdlib.h>

static int descending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

static int dearest(const void *a, const void *b)
{
    return descending(&((const struct pieces *)a)->c, &((const struct pieces *)b)->c);
}

double stats_lower_bound_pieces(struct pieces *p, size_t n, double *v, size_t m)
{
    double all_c = 0, all_v = 0, bound = 0, first_c = 0, first_v = 0;
    qsort(p, n, sizeof *p, dearest);
    qsort(v, m, sizeof *v, descending);
    for (size_t i = 0; i < n; i++) all_c += p[i].c * (double)p[i].n;
    for (size_t k = 0; k < m; k++) all_v += v[k];
    if (all_v > 0) bound = all_c / all_v;
    uint64_t used = 0; /* pieces of kind i among the k largest */
    for (size_t k = 0, i = 0; k + 1 < m; k++, used++) {
        for (; i < n && used >= p[i].n; i++) used = 0;
        if (i == n) break;
        first_c += p[i].c;
        first_v += v[k];
        if (first_v > 0 && first_c / first_v > bound) bound = first_c / first_v;
    }
    return bound;
}

/* Equal costs in a row are one kind, so costs of a coarse picture's pixels need no long sort. */
double stats_lower_bound(const double *c, size_t n, double *v, size_t m)
{
    struct pieces *p = xmalloc(n + 1, sizeof *p);
    size_t kinds = 0;
    for (size_t i = 0; i < n; i++) {
        bool same = i && descending(&c[i], &c[i - 1]) == 0;
        if (same) p[kinds - 1].n++;
        else p[kinds++] = (struct pieces){c[i], 1};
    }
    double bound = stats_lower_bound_pieces(p, kinds, v, m);
    free(p);
    return bound;
}

double stats_mean(const double *x, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += x[i];
    return n ? sum / (double)n : 0;
}

double stats_variance(const double *x, size_t n)
{
    double m = stats_mean(x, n), sum = 0;
    for (size_t i = 0; i < n; i++) sum += (x[i] - m) * (x[i] - m);
    return n > 1 ? sum / (double)(n - 1) : 0;
}

double stats_median(double *x, size_t n)
{
    if (!n) return 0;
    qsort(x, n, sizeof *x, descending);
    return n % 2 ? x[n / 2] : (x[n / 2 - 1] + x[n / 2]) / 2;
}
