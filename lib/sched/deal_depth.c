/*
 * deal: how many tasks a slot may hold. With SCHED_DEPTH_AUTO that follows what is measured: enough
 * that the next task is there when one ends, although the news of the end and the next task take a
 * round trip. It is the window of a link, bandwidth times delay, in tasks.
 *
 * A worker computes in the order in which it was given. With g when a task was given, d when its
 * `done` came, c how long it was computed, and e when the `done` before it came:
 *
 *     d - c - g    is the round trip, if the worker had nothing else; more, if it had
 *     e - g        is the least that tells that it had: the task was there before the last ended
 *
 * So the first sample is taken as it is; each lower one is nearer the truth; a higher one counts
 * where by what is known the worker was waiting, or where it stood idle for longer than a task
 * takes, and then with an eighth of its weight, so that one hiccup does not fill a queue. What is
 * too deep shows nothing: it costs nothing either until the end, and there the queues are run down:
 * when the input has ended, no slot may hold more beyond the task it is on than SHARES times its
 * share of the pool.
 */
#include "sched/deal_int.h"

#define DEPTH_MOST 1000
#define SAFETY 1.25     /* tasks are not equal, nor are trips */
#define SHORT .01       /* so small a part of a task a trip is not worth a queue */
#define SHARES 2        /* of the pool, a slot may have in store at the end */
#define WEIGHT (1 / 8.) /* of the latest in a recent mean */

static void mix(double *mean, double x) { *mean += *mean > 0 ? WEIGHT * (x - *mean) : x; }

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
    else if (waited || idle_us > p->task_us) mix(&p->round_trip_us, sample_us);
    mix(&p->task_us, computed_us);
    mix(&p->px_per_us, (double)lattice_count(&copy->task.at) / computed_us);
    p->done_us = now_us;
}

/* What slot s may hold beyond the task it is on, as long as there is enough for all. */
static int32_t depth_of(const struct deal *d, const struct slot *s)
{
    if (d->p.depth != SCHED_DEPTH_AUTO) return d->p.depth;
    if (s->pace.task_us <= 0 || BUG(24)) return 1;
    double tasks = SAFETY * s->width * s->pace.round_trip_us / s->pace.task_us;
    if (tasks < SHORT) return 0;
    double depth = ceil(tasks + .5);
    return depth > DEPTH_MOST && !BUG(25) ? DEPTH_MOST : (int32_t)depth;
}

int32_t pace_limit(const struct deal *d, const struct slot *s)
{
    int32_t depth = depth_of(d, s) + (BUG(5) ? 1 : 0);
    bool revoked = d->ended && (d->p.depth == SCHED_DEPTH_AUTO || d->p.endgame);
    int32_t share = revoked && !BUG(23) ? SHARES * d->pool.count / d->up : depth;
    return s->width + (depth < share ? depth : share);
}
