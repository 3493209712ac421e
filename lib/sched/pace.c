/*
 * How many tasks a worker must have in store follows what is measured: enough that the next task is
 * there when one ends, although the news of the end and the next task take a round trip. It is the
 * window of a link, bandwidth times delay, in tasks.
 *
 * A worker computes in the order in which it was given. With g when a task was given, d when its
 * `done` came, c how long it was computed, and e when the `done` before it came:
 *
 *     d - c - g    is the round trip, if the worker had nothing else; more, if it had
 *     e - g        is the least that tells that it had: the task was there before the last ended
 *
 * So the first sample is taken as it is; each lower one is nearer the truth; a higher one counts
 * where by what is known the worker was waiting, or where it stood idle for longer than a task
 * takes, and then with an eighth of its weight, so that one hiccup does not fill a queue.
 */
#include "sched/pace.h"

#define DEPTH_MOST 2500
#define SAFETY 1.25     /* tasks are not equal, nor are trips */
#define SHORT .01       /* so small a part of a task a trip is not worth a queue */
#define WEIGHT (1 / 8.) /* of the latest in a recent mean */

void pace_mix(double *mean, double x) { *mean += *mean > 0 ? WEIGHT * (x - *mean) : x; }

void pace_note(struct pace *p, const struct task_entry *copy, int64_t wall_us, int64_t now_us)
{
    int64_t before = p->done_us > copy->since_us ? p->done_us : copy->since_us;
    /* What a slot says of its time is limited by what was seen of it. */
    if (wall_us < 0 || wall_us > now_us - copy->since_us) wall_us = now_us - before;
    double computed_us = wall_us > 1 ? (double)wall_us : 1;
    double sample_us = (double)(now_us - copy->since_us - wall_us);
    double idle_us = (double)(now_us - wall_us - p->done_us);
    bool waited = !p->done_us || (double)copy->since_us + p->round_trip_us > (double)p->done_us;
    if (!p->done_us || sample_us < p->round_trip_us) p->round_trip_us = sample_us;
    else if (waited || idle_us > p->task_us)
        p->round_trip_us += WEIGHT * (sample_us - p->round_trip_us);
    pace_mix(&p->task_us, computed_us);
    pace_mix(&p->us_per_px, computed_us / (double)lattice_count(&copy->task.at));
    p->done_us = now_us;
}

int32_t pace_depth(const struct pace *p, int32_t width)
{
    if (p->task_us <= 0) return 1;
    double tasks = SAFETY * width * p->round_trip_us / p->task_us;
    if (tasks < SHORT) return 0;
    double depth = ceil(tasks + .5);
    return depth > DEPTH_MOST ? DEPTH_MOST : (int32_t)depth;
}
