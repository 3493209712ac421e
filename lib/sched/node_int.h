/*
 * A node of the ring, shared by its files: node.c (events, the worker, and the default rules),
 * gdc_node.c (the rules as published), node_queue.c (the lists of tasks).
 *
 * A task is queued, then fed to the worker, then computed with pixels missing. The node removes it
 * when the pixels have come, or when it gives the task away.
 */
#ifndef STORMRING_SCHED_NODE_INT_H
#define STORMRING_SCHED_NODE_INT_H

#include "sched/pace.h"

struct gdc_node;

/* Payload of a task of a node. */
struct node_task {
    enum { QUEUED, FED, COMPUTED } place; /* the list it is on */
    int64_t fed_us;                       /* FED: when the worker was given it */
};

struct node {
    struct task_table has;     /* its tasks, on these lists: */
    struct task_list queue;    /* not begun, in the order in which they will be fed */
    struct task_list fed;      /* the worker has them */
    struct task_list computed; /* computed, pixels are missing */
    double queue_px, fed_px;   /* pixels of `queue` and `fed` */
    int32_t width;             /* tasks that the worker computes at once; 0: no worker */
    struct pace pace;          /* of the worker */
    bool ended, flush, closed; /* input has ended; pixels held back are wanted; END was sent */
    struct ring place;         /* the latest PLACE */
    bool placed;               /* a PLACE has come */
    int64_t asked_us;          /* default rules: when the outstanding ask was sent; -1: none */
    bool delayed;              /* likewise: that ask has to wait for work */
    int64_t ask_us;            /* likewise: when an ask is due; INT64_MAX: none */
    double trip_us;            /* likewise: time from an ask to the first task that answers it */
    int64_t up_us;             /* when its worker came up, so that it said hello */
    struct gdc_node *gdc;      /* state of the published rules; NULL at first */
};

static inline struct node_task *node_task(const struct node *n, int32_t i)
{
    return tasks_extra(&n->has, i);
}

/* ---- node_queue.c ----------------------------------------------------------------------- */

/* Adds a message to the hub. The caller may set its other fields until the next action. */
struct ring *node_say(enum ring_kind kind, int32_t peer, struct sched_actions *out);
/* Gives entry i, which is queued, to node peer. */
void node_give(struct node *n, int32_t i, int32_t peer, struct sched_actions *out);
/* Takes entry i off the queue; off its list. */
void node_queue_take(struct node *n, int32_t i);
void node_unlist(struct node *n, int32_t i);
/* Entry i, on no list, is the last of the queue. */
void node_enqueue(struct node *n, int32_t i);

/* ---- gdc_node.c ------------------------------------------------------------------------------ */

/*
 * The rules as published. Called at the end of each step once PLACE has asked for them, when the
 * queue and the worker are up to date: a task that came is queued or fed, a done one is computed.
 */
void gdc_node_step(
    struct node *n, const struct sched_event *e, int64_t now_us, struct sched_actions *out);
/* When they want SCHED_WAKE; INT64_MAX: never. */
int64_t gdc_node_wake_us(const struct node *n);
void gdc_node_free(struct node *n);

#endif
