/* stats: measures for judging runs. */
#ifndef STORMRING_STATS_H
#define STORMRING_STATS_H

#include "base/base.h"

/*
 * Lower bound on the time in which m slots of speed v can do n pieces of cost c (any unit of time
 * at speed 1), for any schedule. It is the largest of sum c / sum v and, for k = 1 .. m-1, (sum of
 * the k largest c) / (sum of the k largest v). Pieces are never split. Sorts v, descending. 0 if n
 * is 0. (T. Gonzalez, O. Ibarra, S. Sahni, "Bounds for LPT schedules on uniform processors", SIAM
 * J. Comput. 6, 1977.)
 */
double stats_lower_bound(const double *c, size_t n, double *v, size_t m);
/* n pieces of cost c each. */
struct pieces {
    double c;
    uint64_t n;
};
/* The same for n kinds of pieces. Sorts both arrays, descending. */
double stats_lower_bound_pieces(struct pieces *p, size_t n, double *v, size_t m);
double stats_mean(const double *x, size_t n);
/* Sample variance: divides by n - 1. 0 if n < 2. */
double stats_variance(const double *x, size_t n);
/* Sorts x, descending. For even n the mean of the two middle values. */
double stats_median(double *x, size_t n);

/* ---- timelines of slots ---------------------------------------------------------------------- */

/* A task that a slot completed. Times are in seconds since the start of its run. */
struct span {
    uint32_t run, slot;
    double end_s;  /* completion time; < 0: unknown */
    double took_s; /* time spent on it, as the slot reported */
    bool wasted;   /* another copy's pixels were used */
    double begin_s;
};

/*
 * How slots spent their time. The five values add up exactly: summed over all slots, they equal
 * slots x the makespans of all runs.
 */
struct times {
    double busy_s;    /* on tasks whose pixels were used */
    double wasted_s;  /* on tasks whose pixels were not used */
    double startup_s; /* idle until its first task; all the time if it had none */
    double waiting_s; /* idle between tasks */
    double tail_s;    /* idle from its last task to the end of the run */
};

/*
 * Places the spans on one timeline per slot and accounts for the time. Spans are ordered by run,
 * and those of a slot by completion; runs and slots are numbered from 0. A slot does one task at a
 * time: if clocks of two processes say otherwise, the later task begins when the earlier one ends.
 * A span without a completion time directly follows the previous one. Sets begin_s and end_s of all
 * spans, of[slot], and run_s[run], the makespan: the time until the run's last task ends.
 */
void stats_timeline(
    struct span *at, size_t n, struct times *of, size_t n_slots, double *run_s, size_t n_runs);

#endif
