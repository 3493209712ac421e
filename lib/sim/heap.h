/*
 * A priority queue of events by (time, order of insertion): equal times keep their order, so a seed
 * is one run.
 */
#ifndef STORMRING_SIM_HEAP_H
#define STORMRING_SIM_HEAP_H

#include "sched/sched.h"

enum sim_kind {
    SIM_SCHED,    /* sched event arrives at the hub's policy */
    SIM_AT_HUB,   /* it does, behind the pixels that pass the hub */
    SIM_INPUT,    /* the next tasks may be read */
    SIM_TO_SLOT,  /* sched event arrives at the slot: a task, a flush, a ring message, the end */
    SIM_COMPUTED, /* the slot has finished its task */
    SIM_WAKE,     /* of the slot's node, or, slot -1, of the hub */
    SIM_FAULT,    /* number sched.n of the plan's */
    SIM_RESUME,   /* the slot goes on after a pause */
    SIM_GIVE_UP,  /* it was silent for too long */
    SIM_RETURN,   /* it comes up */
    SIM_RESTART   /* a new hub begins */
};
struct sim_event {
    int64_t at_us;
    enum sim_kind kind;
    int32_t slot;
    uint32_t epoch; /* of the slot's process: what belongs to a dead one is void */
    uint32_t hub;   /* likewise, of the hub's */
    struct sched_event sched;
};
/* Keys are moved, events stay: those at or after n name bodies that are free. */
struct sim_key {
    int64_t at_us;
    uint64_t order;
    size_t body;
};
struct sim_heap {
    struct sim_key *at;
    struct sim_event *bodies;
    size_t n, cap;
    uint64_t order;
};
void sim_heap_push(struct sim_heap *h, const struct sim_event *e);
bool sim_heap_pop(struct sim_heap *h, struct sim_event *e);
void sim_heap_free(struct sim_heap *h);

#endif
