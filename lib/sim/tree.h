/*
 * A simulated tree of hubs, shared by its files: tree.c (the run), tree_hub.c (hubs and links),
 * tree_build.c (the nodes).
 */
#ifndef STORMRING_SIM_TREE_H
#define STORMRING_SIM_TREE_H

#include "sim/heap.h"
#include "sim/net.h"
#include "sim/worker.h"

/* A hub, or a worker. Hub 0 is the root; the workers follow all hubs. */
struct tree_node {
    int32_t parent;   /* -1: the root */
    int32_t number;   /* the slot that it is for its parent */
    int32_t first, n; /* of a hub: its children; n 0: a worker */
};

struct tree_hub {
    void *state;
    int64_t wake_us;           /* next wake-up, INT64_MAX: none */
    double busy_us;            /* it handles records until then */
    double pixels_us;          /* pixels pass its bandwidth until then */
    struct net_queue up, down; /* of its link to its parent */
};

struct tree_worker {
    struct sim_tasks queue; /* to compute, in order */
    struct sim_clock clock;
};

struct tree {
    const struct policy *policy;
    const struct sim_plan *plan;
    struct sim_result *result;
    struct sim_heap heap;
    struct sched_actions acts;
    struct tree_node *nodes;
    int32_t n_hubs;
    struct tree_hub *hubs;
    struct tree_worker *workers;
    struct net_queue *up, *down; /* of the workers' links, by their numbers */
    struct coverage sent;        /* pixels that have reached the root */
    bool *committed;             /* of each task of the plan */
    int32_t n_read;              /* tasks of the plan that the root has read */
    int64_t held;                /* tasks of the plan that are read and not committed */
    bool input_ended, ended;
    int64_t now_us;
};

/* ---- tree_build.c ---------------------------------------------------------------------------- */

/* Makes all nodes of the plan. */
void tree_build(struct tree *t);
void tree_close(struct tree *t);
static inline bool tree_is_worker(const struct tree *t, int32_t i) { return i >= t->n_hubs; }

/* ---- tree_hub.c ------------------------------------------------------------------------------ */

/* The hub gets an event; its actions are carried out. */
void tree_step(struct tree *t, int32_t hub, const struct sched_event *e);
/* Schedules the wake-up that the hub's policy wants. */
void tree_sleep(struct tree *t, int32_t hub);
/* Node i sends this to its parent. */
void tree_say(struct tree *t, int32_t i, struct sched_event e);
/* A record of node i is at its parent, which passes records one after the other. */
void tree_pass(struct tree *t, const struct sim_event *e);
/* The parent of node i has passed its record. */
void tree_take(struct tree *t, const struct sim_event *e);
void tree_fail(struct tree *t, const char *what, int64_t a, int64_t b);

#endif
