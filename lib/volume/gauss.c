/*
 * gauss: Gauss-Legendre rules. The roots of each Legendre polynomial interlace with those of the
 * previous one. So bisection finds them by arithmetic alone, with the same bits on every host.
 */
#include "volume/volume_int.h"

/* P_m at x; *slope: its derivative, for |x| < 1. */
static double legendre(int m, double x, double *slope)
{
    double before = 1, p = x;
    for (int k = 2; k <= m; k++) {
        double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
    }
    *slope = m * (before - x * p) / (1 - x * x);
    return p;
}

static double root_between(int m, double lo, double hi)
{
    double unused, low = legendre(m, lo, &unused);
    for (int i = 0; i < 100; i++) {
        double mid = lo + (hi - lo) / 2;
        if ((legendre(m, mid, &unused) < 0) == (low < 0)) lo = mid;
        else hi = mid;
    }
    return lo;
}

void volume_gauss_rule(struct rule *r, int m)
{
    r->m = m;
    double x[GAUSS_MAX] = {0}, old[GAUSS_MAX + 2] = {-1 + 0x1p-52, 1 - 0x1p-52};
    for (int n = 1; n <= m; n++) {
        for (int i = 0; i < n; i++) x[i] = root_between(n, old[i], old[i + 1]);
        for (int i = 0; i < n; i++) old[i + 1] = x[i];
        old[n + 1] = 1 - 0x1p-52;
    }
    for (int i = 0; i < m; i++) {
        double slope;
        legendre(m, x[i], &slope);
        r->node[i] = 0.5 + 0.5 * x[i];
        r->weight[i] = 1 / ((1 - x[i] * x[i]) * slope * slope);
    }
}
