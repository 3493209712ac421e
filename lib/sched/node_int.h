/*
 * A node of the ring, shared by its files: node.c (the queue, the worker, and the default
 * rules), gdc_node.c (the rules as published).
 *
 * A task is queued, then fed to the worker, then computed with pixels missing; when they have come
 * the node forgets it, as it does when it gives it away.
 */
#ifndef STORMRING_SCHED_NODE_INT_H
#define STORMRING_SCHED_NODE_INT_H

#include "sched/pace.h"

struct gdc_node;

struct node {
    struct task_table has;     /* on these lists: */
    struct task_list queue;    /* not begun, in the order in which they will be */
    struct task_list fed;      /* the worker has them */
    struct task_list computed; /* their pixels have not all come */
    double queue_px, fed_px;   /* of the tasks of these */
    int32_t width;             /* tasks that the worker is on at once; 0: there is none */
    struct pace pace;          /* of the worker */
    bool ended, flush, closed; /* the input has; what is held back is wanted; END was said */
    struct ring place;         /* the latest PLACE */
    bool placed;               /* there was one */
    int64_t asked_us;          /* default rules: when the ask was said that is outstanding, -1 */
    bool delayed;              /* likewise: that has to wait for work, not just for an answer */
    int64_t ask_us;            /* likewise: when one is due, INT64_MAX */
    double trip_us;            /* likewise: from an ask to the first task that comes of it */
    struct gdc_node *gdc;      /* published rules: theirs; NULL at first */
};

/* ---- node.c ----------------------------------------------------------------------------- */

/* Says it to the hub; the caller may set what else it says, until the next action. */
struct ring *node_say(enum ring_kind kind, int32_t peer, struct sched_actions *out);
/* Entry i, which is queued, is peer's from now on. */
void node_give(struct node *n, int32_t i, int32_t peer, struct sched_actions *out);

/* ---- gdc_node.c ------------------------------------------------------------------------------ */

/*
 * The rules as published. Called at the end of every step once PLACE said so, when the queue and
 * the worker have been seen to: a task that came is queued or fed, what is done is computed.
 */
void gdc_node_step(
    struct node *n, const struct sched_event *e, int64_t now_us, struct sched_actions *out);
/* When they want SCHED_WAKE; INT64_MAX: they do not. */
int64_t gdc_node_wake_us(const struct node *n);
void gdc_node_free(struct node *n);

#endif
