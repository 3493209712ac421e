/* A node of the ring: the lists of its tasks, and what it says to the hub. */
#include "sched/node_int.h"

void node_queue_take(struct node *n, int32_t i)
{
    list_remove(&n->has, &n->queue, i);
    n->queue_px -= tasks_px(&n->has, i);
}

void node_unlist(struct node *n, int32_t i)
{
    switch (node_task(n, i)->place) {
    case QUEUED: node_queue_take(n, i); break;
    case FED:
        list_remove(&n->has, &n->fed, i);
        n->fed_px -= tasks_px(&n->has, i);
        break;
    case COMPUTED: list_remove(&n->has, &n->computed, i); break;
    }
}

void node_enqueue(struct node *n, int32_t i)
{
    node_task(n, i)->place = QUEUED;
    n->has.at[i].delivered = 0;
    list_push_back(&n->has, &n->queue, i);
    n->queue_px += tasks_px(&n->has, i);
}

struct ring *node_say(enum ring_kind kind, int32_t peer, struct sched_actions *out)
{
    sched_act(out, SCHED_SAY, 0, NULL);
    struct ring *r = &out->at[out->n - 1].ring;
    *r = (struct ring){.kind = kind, .peer = peer, .next = -1};
    return r;
}

void node_give(struct node *n, int32_t i, int32_t peer, struct sched_actions *out)
{
    node_say(RING_GIVE, peer, out);
    out->at[out->n - 1].task = n->has.at[i].task;
    node_queue_take(n, i);
    tasks_remove(&n->has, i);
}
