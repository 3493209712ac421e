/*
 * The hub: nodes that make no progress. No node can be asked for its worker's current task, and a
 * node may never answer although beats tell its fan that it is alive. So if a node is idle and no
 * node can be asked for work, the hub looks at the node that has made no progress for longest. If
 * that node's task is late, the idle node becomes its owner. A task is late if the idle node could
 * have done it PATIENCE_TASK_TIMES since. If the first node finishes it first, its pixels count.
 */
#include "sched/hub_int.h"

#define TRIES 8 /* takeovers of a task that add its first wait once more */

/* The time from which entry i of node k is late for node thief. */
static int64_t late_us(const struct hub *h, int32_t i, int32_t k, int32_t thief)
{
    uint64_t px = lattice_count(&h->ledger.at[i].task.at);
    const struct pace *p = &h->nodes[thief].pace;
    double us_per_px = p->us_per_px > 0 ? p->us_per_px : h->pace.us_per_px;
    double us = (double)px * us_per_px;
    us = PATIENCE_TASK_US + PATIENCE_TASK_TIMES * (us + p->round_trip_us + (double)h->answer_us);
    us *= 1 + hub_task(h, i)->tries / TRIES;
    return h->nodes[k].progress_us + (int64_t)fmin(us, PATIENCE_TASK_MOST_US);
}

void hub_hung(struct hub *h, struct sched_actions *out)
{
    h->hung_us = INT64_MAX;
    while (h->idle.count && h->stalest >= 0) {
        int32_t k = h->stalest, thief = set_before(&h->idle, k);
        if (thief == k)
            k = h->nodes[k]
                    .fresher; /* the idle node owes pixels itself, and no other node is idle */
        if (k < 0) return;
        const struct hub_node *s = &h->nodes[k];
        int32_t i = s->held.head;
        while (i >= 0 && pieces_exist(&h->ledger, i)) i = h->ledger.at[i].next;
        if (i < 0) i = s->computed.head;
        h->hung_us = late_us(h, i, k, thief);
        if (h->now_us < h->hung_us) return;
        h->hung_us = INT64_MAX;
        hub_take_over(h, i, thief, out);
    }
}
