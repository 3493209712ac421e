/*
 * stats: the measures by which runs are judged.
 */
#ifndef STORMRING_STATS_H
#define STORMRING_STATS_H

#include "base/base.h"

/*
 * The least time in which n pieces of cost c (any unit of time at speed 1) can be done by m slots
 * of speed v, whatever the schedule: the largest of sum c / sum v and, for k = 1 .. m-1, (sum of
 * the k largest c) / (sum of the k largest v). A piece is never split. Sorts both arrays,
 * descending. 0 when n is 0. (T. Gonzalez, O. Ibarra, S. Sahni, "Bounds for LPT schedules on
 * uniform processors", SIAM J. Comput. 6, 1977.)
 */
double lower_bound(double *c, size_t n, double *v, size_t m);
double mean(const double *x, size_t n);
/* Of a sample: divides by n - 1. 0 when n < 2. */
double variance(const double *x, size_t n);
/* Sorts x. The mean of the two middle ones when n is even. */
double median(double *x, size_t n);

#endif
