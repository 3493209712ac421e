/*
 * The queue depth of a worker follows measurements. The next task must be there when one ends,
 * although the `done` and the next task take a round trip. The depth is the window of the link,
 * bandwidth times delay, in tasks.
 *
 * A worker computes its tasks in the order in which they were sent. Let g be the time at which a
 * task was sent, d the arrival of its `done`, c its computing time, e the arrival of the previous
 * `done`:
 *
 *     d - c - g    is the round trip if the worker was idle, and more if it was busy
 *     e - g        >= round trip: the worker was busy; the task was there before the last ended
 *     d - c - e    the time for which the worker was idle before the task; <= 0: it was not
 *
 * A sample of the round trip is d - c - g. The first sample is taken as it is, and so is each lower
 * one. A higher sample counts only if the worker was idle, and either e - g was shorter than a
 * round trip, or the worker was idle for longer than a task takes. It counts as higher by at most
 * the idle time: else a long queue would look like a long round trip, and grow. Its weight is 1/8,
 * so that one hiccup does not fill a queue.
 *
 * Preparation is no round trip. Before its first task with new state, such as a scene, a worker
 * waits for the state and builds from it. That time is in the samples of all tasks that were sent
 * before the first `done` of this state came. None of them counts as higher. The first sample of
 * all is taken, because it is the most that the round trip can be. The round trip is measured when
 * a task that was sent later finds the worker idle: then d - c - g has no other part. Until then
 * less is assumed, each time that a task is done that was sent since, while it is longer than a few
 * tasks. So a deep queue gets shorter, until that happens, which costs a part of a round trip once.
 * And deal gives the worker no more than a part of its share of the work (deal_mark.c).
 */
#include "sched/pace.h"

#define SAFETY 1.25     /* margin: tasks and trips vary */
#define SHORT .01       /* of a task: a shorter round trip needs no queue */
#define IDLE .1         /* of a sample: less idle time between two tasks is not the link's */
#define DOUBT .8        /* of a round trip that was not measured is assumed after the next one */
#define DEEP 4          /* tasks: a round trip of fewer is not doubted */
#define WEIGHT (1 / 8.) /* weight of the latest sample in a recent mean */

void pace_mix(double *mean, double x) { *mean += *mean > 0 ? WEIGHT * (x - *mean) : x; }

double pace_power(struct pace *p, double power)
{
    double ratio = p->power > 0 && power > 0 ? p->power / power : 1;
    if (power > 0) p->power = power;
    p->us_per_px *= ratio;
    p->task_us *= ratio;
    return ratio;
}

double pace_note(struct pace *p, const struct pace_task *t)
{
    int64_t before = p->done_us > t->sent_us ? p->done_us : t->sent_us;
    int64_t wall_us = t->wall_us;
    /* The observed time limits the time that a slot reports. */
    if (wall_us < 0 || wall_us > t->done_us - t->sent_us) wall_us = t->done_us - before;
    double computed_us = wall_us > 1 ? (double)wall_us : 1;
    double sample_us = (double)(t->done_us - t->sent_us - wall_us);
    double idle_us = (double)(t->done_us - wall_us - p->done_us);
    bool newer = !p->done_us || (int32_t)(t->state - p->state) > 0;
    if (newer) {
        p->state = t->state;
        p->ready_us = p->doubted_us = t->done_us;
    }
    bool ready = t->sent_us >= p->ready_us;
    bool waited = !p->done_us || (double)t->sent_us + p->round_trip_us > (double)p->done_us;
    bool idle = idle_us > IDLE * sample_us;
    if (!p->done_us || sample_us < p->most_us) p->most_us = sample_us;
    if (!p->done_us || sample_us < p->round_trip_us) p->round_trip_us = sample_us;
    else if (ready && idle && !p->measured) p->round_trip_us = p->most_us;
    else if (ready && idle_us > 0 && (waited || idle_us > p->task_us))
        p->round_trip_us += WEIGHT * fmin(sample_us - p->round_trip_us, idle_us);
    p->measured = p->measured || (ready && idle);
    if (!p->measured && t->sent_us > p->doubted_us && p->round_trip_us > DEEP * p->task_us) {
        p->round_trip_us *= DOUBT;
        p->doubted_us = t->done_us;
    }
    pace_mix(&p->task_us, computed_us);
    pace_mix(&p->us_per_px, computed_us / (double)t->px);
    p->done_us = t->done_us;
    return computed_us;
}

int32_t pace_depth(const struct pace *p, int32_t width)
{
    if (p->task_us <= 0) return 1;
    double tasks = SAFETY * width * p->round_trip_us / p->task_us;
    if (tasks < SHORT) return 0;
    double depth = ceil(tasks + .5);
    return depth > PACE_DEPTH_MOST ? PACE_DEPTH_MOST : (int32_t)depth;
}
