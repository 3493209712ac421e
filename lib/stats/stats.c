/* Measures: see stats.h. */
#include "stats/stats.h"

#include <stdlib.h>

static int descending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

double lower_bound(double *c, size_t n, double *v, size_t m)
{
    double all_c = 0, all_v = 0, bound = 0, first_c = 0, first_v = 0;
    qsort(c, n, sizeof *c, descending);
    qsort(v, m, sizeof *v, descending);
    for (size_t i = 0; i < n; i++) all_c += c[i];
    for (size_t k = 0; k < m; k++) all_v += v[k];
    if (all_v > 0) bound = all_c / all_v;
    for (size_t k = 0; k + 1 < m && k < n; k++) {
        first_c += c[k];
        first_v += v[k];
        if (first_v > 0 && first_c / first_v > bound) bound = first_c / first_v;
    }
    return bound;
}

double mean(const double *x, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += x[i];
    return n ? sum / (double)n : 0;
}

double variance(const double *x, size_t n)
{
    double m = mean(x, n), sum = 0;
    for (size_t i = 0; i < n; i++) sum += (x[i] - m) * (x[i] - m);
    return n > 1 ? sum / (double)(n - 1) : 0;
}

double median(double *x, size_t n)
{
    if (!n) return 0;
    qsort(x, n, sizeof *x, descending);
    return n % 2 ? x[n / 2] : (x[n / 2 - 1] + x[n / 2]) / 2;
}
