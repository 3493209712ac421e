/* inference: quantiles, confidence intervals, outliers; see stats.h. */
#include "stats/stats.h"

#include <float.h>
#include <stdlib.h>

/* ---- Student's t ---------------------------------------------------------------------------- */

/*
 * The incomplete beta function's continued fraction (M. Abramowitz, I. A. Stegun, "Handbook of
 * Mathematical Functions", 1964, 26.5.8), evaluated from the front (W. J. Lentz, "Generating Bessel
 * functions in Mie scattering calculations using continued fractions", Applied Optics 15, 1976).
 * Converges in about sqrt(max(a, b)) terms if x < (a + 1) / (a + b + 2).
 */
static double beta_fraction(double a, double b, double x)
{
    double c = 1, d = 1 / (1 - (a + b) * x / (a + 1)), value = d;
    for (int i = 1; i < 1000000; i++) {
        double m = i;
        double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / (1 + even * d);
        c = 1 + even / c;
        value *= c * d;
        d = 1 / (1 + odd * d);
        c = 1 + odd / c;
        value *= c * d;
        if (fabs(c * d - 1) < 4 * DBL_EPSILON) break;
    }
    return value;
}

/* I_x(a, b). The caller passes y = 1 - x, because it knows y more accurately than that
 * difference. */
static double beta_part(double a, double b, double x, double y)
{
    double front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log(y));
    if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
    return 1 - front * beta_fraction(b, a, y) / b;
}

/* The probability of a value above t > 0. */
static double t_tail(double t, double dof)
{
    double all = dof + t * t;
    return beta_part(dof / 2, .5, dof / all, t * t / all) / 2;
}

double t_quantile(double p, double dof)
{
    if (p == .5) return 0;
    if (p < .5) return -t_quantile(1 - p, dof);
    double low = 0, high = 1;
    while (t_tail(high, dof) > 1 - p) low = high, high *= 2;
    for (double t; (t = (low + high) / 2) > low && t < high;)
        *(t_tail(t, dof) > 1 - p ? &low : &high) = t;
    return high;
}

/* ---- intervals ------------------------------------------------------------------------------- */

/* Interval around an estimate with this standard error. Infinite without degrees of freedom. */
static struct interval around(double estimate, double error, double dof, double level)
{
    double half = HUGE_VAL;
    if (dof > 0) half = error > 0 ? t_quantile((1 + level) / 2, dof) * error : 0;
    return (struct interval){estimate, estimate - half, estimate + half};
}

struct interval mean_interval(const double *x, size_t n, double level)
{
    return around(mean(x, n), sqrt(variance(x, n) / (double)n), (double)n - 1, level);
}

struct interval difference_interval(
    const double *x, size_t n, const double *y, size_t m, double level)
{
    double a = variance(x, n) / (double)n, b = variance(y, m) / (double)m, dof = 0;
    if (n > 1 && m > 1) {
        dof = (double)(n + m - 2);
        if (a + b > 0)
            dof = (a + b) * (a + b) / (a * a / (double)(n - 1) + b * b / (double)(m - 1));
    }
    return around(mean(x, n) - mean(y, m), sqrt(a + b), dof, level);
}

static void to_distances(double *x, size_t n)
{
    double middle = median(x, n);
    for (size_t i = 0; i < n; i++) x[i] = fabs(x[i] - middle);
}

struct interval spread_interval(double *x, size_t n, double *y, size_t m, double level)
{
    to_distances(x, n);
    to_distances(y, m);
    /* Two samples are always equally far from their median, so they count as one. */
    return difference_interval(x, n == 2 ? 1 : n, y, m == 2 ? 1 : m, level);
}

/* ---- outliers -------------------------------------------------------------------------------- */

void fences(double *x, size_t n, double *low, double *high)
{
    *low = -HUGE_VAL;
    *high = HUGE_VAL;
    if (n < 4) return;
    median(x, n); /* sorts, descending */
    size_t half = (n + 1) / 2;
    double upper = median(x, half), lower = median(x + n - half, half);
    *low = lower - 1.5 * (upper - lower);
    *high = upper + 1.5 * (upper - lower);
}
