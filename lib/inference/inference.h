/*
 * inference: what samples tell about the distribution that they come from: confidence intervals of
 * means, differences and spreads, outliers, and claims about two methods of a table. Student's t
 * comes from GSL (libgsl-dev).
 */
#ifndef STORMRING_INFERENCE_H
#define STORMRING_INFERENCE_H

#include "stats/stats.h"
#include "table/table.h"

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

/* ---- points of a table ----------------------------------------------------------------------- */

/* Marks the outliers among the samples of each point. */
void inference_mark_outliers(struct table *t);
/* The mean of a point's y with its interval, and its *variance if that is not NULL. Samples that
 * are marked as outliers are left out. Returns their number in *kept. */
struct interval inference_point(const struct table *t, const struct table_point *p, double level,
    size_t *kept, double *variance);

/* Sets `shown` of each point to the mean of y and its interval, with one sample to that sample; and
 * the range of x to its median, because intervals are about y alone. Call table_medians before. */
void inference_means(struct table *t, double level);

/* A claim about two methods, A and B. */
struct claim {
    enum relation {
        INFERENCE_NONE,
        INFERENCE_LESS,    /* the mean of A is less than that of B; by pairs of samples */
        INFERENCE_MORE,    /* the same, but more */
        INFERENCE_SAME,    /* the means differ by at most margin x the mean of B */
        INFERENCE_STEADIER /* A varies less than B; by all samples */
    } relation;
    double margin; /* of INFERENCE_SAME */
    double level;  /* of intervals */
};
/*
 * The difference that the claim is about, A - B: of means, in fractions of B's mean for
 * INFERENCE_SAME, or of spreads. *used is the number of samples, or of pairs: samples of both with
 * the same number and seed. Samples that are marked as outliers are left out.
 */
struct interval inference_compare(const struct claim *c, const struct table *t,
    const struct table_point *a, const struct table_point *b, size_t *used);
/* "holds" or "fails" if the claim does so in the whole interval, else "open". */
const char *inference_verdict(const struct claim *c, struct interval of, size_t used);

#endif
