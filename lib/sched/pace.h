/*
 * How a worker at the other end of a link does, as seen from here, and how many tasks it must have
 * in store so that the link is hidden: shared by deal, for its slots, and by the nodes of a ring,
 * each for its worker.
 */
#ifndef STORMRING_SCHED_PACE_H
#define STORMRING_SCHED_PACE_H

#include "sched/sched.h"

struct pace {             /* 0: not known yet */
    double round_trip_us; /* what a task takes beyond its computing, when none is before it */
    double task_us;       /* the computing; a recent mean */
    double us_per_px;     /* likewise */
    int64_t done_us;      /* when its latest `done` came */
};

/* Pixels in a microsecond; 0: not known. */
static inline double pace_rate(const struct pace *p)
{
    return p->us_per_px > 0 ? 1 / p->us_per_px : 0;
}
/* x into a recent mean, which is 0 at first. */
void pace_mix(double *mean, double x);
/* A task is done, of which it had `copy`; wall_us: it says, or -1. */
void pace_note(struct pace *p, const struct task_entry *copy, int64_t wall_us, int64_t now_us);
/* So many tasks beyond the `width` that it is on at once should it have. */
int32_t pace_depth(const struct pace *p, int32_t width);

#endif
