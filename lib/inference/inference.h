/*
 * inference: what samples tell about the distribution that they come from: confidence intervals of
 * means, differences and spreads, and outliers. Student's t comes from GSL (libgsl-dev).
 */
#ifndef STORMRING_INFERENCE_H
#define STORMRING_INFERENCE_H

#include "stats/stats.h"

/* The estimated value lies between low and high, with the confidence that was asked for. */
struct interval {
    double estimate, low, high; /* low and high are infinite if there are too few samples */
};

/* Of the mean, at the level (0 to 1, as .999), for samples of a normal distribution. */
struct interval inference_mean(const double *x, size_t n, double level);
/*
 * Of the mean that x is from minus that of y, which need not vary equally (B. L. Welch, "The
 * generalization of `Student's' problem when several different population variances are involved",
 * Biometrika 34, 1947). n and m >= 1.
 */
struct interval inference_difference(
    const double *x, size_t n, const double *y, size_t m, double level);
/*
 * How much more x varies than y: the same of the distances of each from its median (M. B. Brown,
 * A. B. Forsythe, "Robust tests for the equality of variances", J. Amer. Stat. Assoc. 69, 1974;
 * differs in Welch's degrees of freedom). Fewer than three of either tell nothing. Leaves these in
 * x and y.
 */
struct interval inference_spread(double *x, size_t n, double *y, size_t m, double level);

/*
 * The inner fences (J. W. Tukey, "Exploratory Data Analysis", 1977): samples outside of [*low,
 * *high] are outliers: further from the middle half than 1.5 times its width. The quartiles are the
 * medians of the lower and the upper half, the middle one being in both. Of fewer than 4 samples
 * none is an outlier. Sorts x.
 */
void inference_fences(double *x, size_t n, double *low, double *high);

#endif
