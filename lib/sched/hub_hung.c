/*
 * The hub: nodes that make no progress. Nobody can be asked for a task that a worker is on, and a
 * node may not answer at all, while beats tell its fan that it lives. So when a node has nothing to
 * do, and nobody can be asked for it, the hub gives it a task of the node that has made no progress
 * for longest, if that is late: if the idle one could have done the task LATE_TIMES over since. It
 * is the idle node's then; if the other one has it first after all, its pixels count.
 *
 * Progress is a task done, or new pixels, or a first task after none. Nodes that have something to
 * do, or were asked for pixels that have not come, stand in a list in the order of their latest
 * progress.
 */
#include "sched/hub_int.h"

#define LATE_TIMES 4
#define LATE_US 200000 /* and so much besides: a machine that is busy */
#define LATE_MOST_US 86400e6
#define TRIES 8 /* after each TRIES takeovers of a task the wait grows by its first length */

static void unlist(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    if (!s->busy) return;
    *(s->staler >= 0 ? &h->nodes[s->staler].fresher : &h->stalest) = s->fresher;
    *(s->fresher >= 0 ? &h->nodes[s->fresher].staler : &h->freshest) = s->staler;
    s->busy = false;
}

static void enlist(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    s->busy = true;
    s->progress_us = h->now_us;
    s->staler = h->freshest;
    s->fresher = -1;
    *(h->freshest >= 0 ? &h->nodes[h->freshest].fresher : &h->stalest) = k;
    h->freshest = k;
}

void ring_busy(struct hub *h, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    bool busy = s->state == NODE_UP && (s->held.count || (s->computed.count && s->flushed));
    if (busy && !s->busy) enlist(h, k);
    if (!busy) unlist(h, k);
    set_put(&h->idle, k, s->state == NODE_UP && s->asking && s->victim < 0 && !s->held.count);
}

void ring_progress(struct hub *h, int32_t k)
{
    if (!h->nodes[k].busy) return;
    unlist(h, k);
    enlist(h, k);
}

/* Entry i of node k is late for node thief then. */
static int64_t late_us(const struct hub *h, int32_t i, int32_t k, int32_t thief)
{
    const struct task_entry *e = &h->ledger.at[i];
    const struct pace *p = &h->nodes[thief].pace;
    double us_per_px = p->us_per_px > 0 ? p->us_per_px : h->pace.us_per_px;
    double us = (double)lattice_count(&e->task.at) * us_per_px;
    us = LATE_US + LATE_TIMES * (us + p->round_trip_us + (double)h->answer_us);
    return h->nodes[k].progress_us + (int64_t)fmin(us * (1 + e->tries / TRIES), LATE_MOST_US);
}

void ring_hung(struct hub *h, struct sched_actions *out)
{
    h->hung_us = INT64_MAX;
    while (h->idle.count && h->stalest >= 0) {
        int32_t k = h->stalest, thief = set_before(&h->idle, k);
        if (thief == k)
            k = h->nodes[k].fresher; /* it owes pixels itself, and nobody else is idle */
        if (k < 0) return;
        const struct hub_node *s = &h->nodes[k];
        int32_t i = s->held.count ? s->held.head : s->computed.head;
        h->hung_us = late_us(h, i, k, thief);
        if (h->now_us < h->hung_us) return;
        h->hung_us = INT64_MAX;
        hub_take_over(h, i, thief, out);
    }
}
