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
/* n pieces of cost c each. */
struct pieces {
    double c;
    uint64_t n;
};
/* The same of n kinds of pieces. Sorts both arrays, descending. */
double lower_bound_pieces(struct pieces *p, size_t n, double *v, size_t m);
double mean(const double *x, size_t n);
/* Of a sample: divides by n - 1. 0 when n < 2. */
double variance(const double *x, size_t n);
/* Sorts x, descending. The mean of the two middle ones when n is even. */
double median(double *x, size_t n);

/* ---- who did what, when --------------------------------------------------------------------- */

/* A task that a slot did. Times are in seconds since its run began. */
struct span {
    uint32_t run, slot;
    double end_s;  /* when it was done; < 0: nobody looked at a clock */
    double took_s; /* how long the slot was on it, by its own account */
    bool wasted;   /* another one's pixels were taken */
    double begin_s;
};

/*
 * What slots did with their time. The five make up all of it, to the last digit: of all slots they
 * are slots x the makespans of all runs.
 */
struct times {
    double busy_s;    /* on tasks whose pixels were taken */
    double wasted_s;  /* on tasks whose pixels were not */
    double startup_s; /* idle from the beginning to its first task; without one, all the time */
    double waiting_s; /* idle between tasks */
    double tail_s;    /* idle after its last task, until the last one of all was done */
};

/*
 * Lays the spans on one line a slot, and accounts for the time on it. Spans come run by run, those
 * of a slot in the order in which they were done; runs and slots are numbered from 0. A slot is on
 * one task at a time: where clocks of two processes say otherwise, the later task begins when the
 * earlier one is done. A span without a clock follows the one before it at once. Sets begin_s and
 * end_s of all spans, of[slot], and run_s[run]: the makespan, until its last task was done.
 */
void timeline(
    struct span *at, size_t n, struct times *of, size_t n_slots, double *run_s, size_t n_runs);

#endif
