/* Confidence intervals and outliers: see inference.h. */
#include "inference/inference.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>

/* ---- intervals ------------------------------------------------------------------------------- */

/* Interval around an estimate with this standard error. Infinite without degrees of freedom. */
static struct interval around(double estimate, double error, double dof, double level)
{
    double half = HUGE_VAL;
    gsl_set_error_handler_off(); /* GSL's default aborts the program */
    if (dof > 0) half = error > 0 ? gsl_cdf_tdist_Pinv((1 + level) / 2, dof) * error : 0;
    return (struct interval){estimate, estimate - half, estimate + half};
}

static bool all_equal(const double *x, size_t n)
{
    for (size_t i = 1; i < n; i++)
        if (x[i] != x[0]) return false;
    return n > 0;
}

struct interval inference_mean(const double *x, size_t n, double level)
{
    /* Rounding would give equal samples a mean beside them, and an interval of some width. */
    if (all_equal(x, n)) return around(x[0], 0, (double)n - 1, level);
    return around(stats_mean(x, n), sqrt(stats_variance(x, n) / (double)n), (double)n - 1, level);
}

struct interval inference_difference(
    const double *x, size_t n, const double *y, size_t m, double level)
{
    double a = stats_variance(x, n) / (double)n, b = stats_variance(y, m) / (double)m, dof = 0;
    if (n > 1 && m > 1) {
        dof = (double)(n + m - 2);
        if (a + b > 0)
            dof = (a + b) * (a + b) / (a * a / (double)(n - 1) + b * b / (double)(m - 1));
    }
    return around(stats_mean(x, n) - stats_mean(y, m), sqrt(a + b), dof, level);
}

static void to_distances(double *x, size_t n)
{
    double middle = stats_median(x, n);
    for (size_t i = 0; i < n; i++) x[i] = fabs(x[i] - middle);
}

struct interval inference_spread(double *x, size_t n, double *y, size_t m, double level)
{
    to_distances(x, n);
    to_distances(y, m);
    /* Two samples are always equally far from their median, so they count as one. */
    return inference_difference(x, n == 2 ? 1 : n, y, m == 2 ? 1 : m, level);
}

/* ---- outliers -------------------------------------------------------------------------------- */

void inference_fences(double *x, size_t n, double *low, double *high)
{
    *low = -HUGE_VAL;
    *high = HUGE_VAL;
    if (n < 4) return;
    stats_median(x, n); /* sorts, descending */
    size_t half = (n + 1) / 2;
    double upper = stats_median(x, half), lower = stats_median(x + n - half, half);
    *low = lower - 1.5 * (upper - lower);
    *high = upper + 1.5 * (upper - lower);
}
