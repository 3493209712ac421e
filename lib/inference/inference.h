/*
 * inference: what samples tell about the distribution that they come from: confidence intervals of
 * means, differences and spreads, and outliers. Student's t comes from GSL (libgsl-dev).
 */
#ifndef STORMRING_INFERENCE_H
#define STORMRING_INFERENCE_H

#include "stats/stats.h"

/* A confidence interval: [low, high] contains the true value with the requested confidence. */
struct interval {
    double estimate, low, high; /* low, high: infinite if there are too few samples */
};

/* Interval of the mean for normally distributed samples. level is in (0, 1), such as .999. */
struct interval inference_mean(const double *x, size_t n, double level);
/*
 * Interval of the mean of x's distribution minus the mean of y's. The variances may differ (B. L.
 * Welch, "The generalization of `Student's' problem when several different population variances are
 * involved", Biometrika 34, 1947). n and m >= 1.
 */
struct interval inference_difference(
    const double *x, size_t n, const double *y, size_t m, double level);
/*
 * Compares the spread of x with that of y: the difference interval of the absolute deviations from
 * the medians (M. B. Brown, A. B. Forsythe, "Robust tests for the equality of variances", J. Amer.
 * Stat. Assoc. 69, 1974; differs in Welch's degrees of freedom). Infinite if either has fewer than
 * three samples. Overwrites x and y with their deviations.
 */
struct interval inference_spread(double *x, size_t n, double *y, size_t m, double level);

/*
 * The inner fences (J. W. Tukey, "Exploratory Data Analysis", 1977). Samples outside [*low, *high]
 * are outliers: more than 1.5 times the interquartile range beyond a quartile. The quartiles are
 * the medians of the lower and the upper half; both halves include a middle sample. With fewer than
 * 4 samples there are no outliers. Sorts x.
 */
void inference_fences(double *x, size_t n, double *low, double *high);

#endif
