/*
 * The measured speed of a worker at the other end of a link, and the queue depth that hides the
 * link's delay. deal keeps one per slot; each ring node keeps one for its worker.
 */
#ifndef STORMRING_SCHED_PACE_H
#define STORMRING_SCHED_PACE_H

#include "patience/patience.h"
#include "sched/sched.h"

#define PACE_DEPTH_MOST 2500

struct pace {             /* 0: not known yet */
    double us_per_px;     /* recent mean */
    double task_us;       /* computing time of a task; recent mean */
    double most_us;       /* the round trip is at most this: the least sample */
    double round_trip_us; /* delay of a task beyond its computing time, if the worker was idle */
    bool measured;        /* that delay is one of the link; else preparation may be in it */
    uint32_t state;       /* the latest state of which a task is done, */
    int64_t ready_us;     /* and the arrival of its first `done` */
    int64_t doubted_us;   /* when less was assumed last, until the round trip is measured */
    int64_t done_us;      /* arrival of the latest `done` */
    double power;         /* as its host states it: only changes of it count */
};

/* Updates a recent mean with sample x; a mean of 0 takes x as it is. */
void pace_mix(double *mean, double x);
/* The worker's host states this power; 0: none. If it stated another one before, the measured times
 * change by the ratio, until they are measured again. Returns the ratio; 1: nothing has changed. */
double pace_power(struct pace *p, double power);
/* A task that the worker has done. */
struct pace_task {
    uint64_t px;              /* its pixels */
    uint32_t state;           /* the number of the state that it was computed with */
    int64_t sent_us, done_us; /* when it was sent; when its `done` arrived */
    int64_t wall_us;          /* its computing time, as the worker reports it; -1: not reported */
};
/* Records that a task is done. Returns its computing time: the reported one. If that is missing, or
 * longer than the time since the task was sent, it is the time since the task was sent or the one
 * before was done, whichever was later. */
double pace_note(struct pace *p, const struct pace_task *t);
/* The number of tasks that the worker should hold beyond the `width` that it computes at once, at
 * most PACE_DEPTH_MOST; 1 if it has done none. */
int32_t pace_depth(const struct pace *p, int32_t width);

#endif
