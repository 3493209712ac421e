/* The rules of a node as published: so far its first phase, in which nobody asks. */
#include "sched/node_int.h"

void gdc_node_step(
    struct node *n, const struct sched_event *e, int64_t now_us, struct sched_actions *out)
{
    (void)n;
    (void)now_us;
    if (e->kind == SCHED_RING && e->ring.kind == RING_ASK) node_say(RING_NONE, e->ring.peer, out);
}

int64_t gdc_node_wake_us(const struct node *n)
{
    (void)n;
    return INT64_MAX;
}

void gdc_node_free(struct node *n) { (void)n; }
