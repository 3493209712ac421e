/*
 * A priority queue of events by (time, order of insertion). Equal times keep their order, so that a
 * seed gives exactly one run.
 */
#ifndef STORMRING_SIM_HEAP_H
#define STORMRING_SIM_HEAP_H

#include "sched/sched.h"

enum sim_kind {
    SIM_SCHED,    /* sched event arrives at the hub's policy */
    SIM_AT_HUB,   /* the same, after the pixels that pass the hub */
    SIM_INPUT,    /* the next tasks may be read */
    SIM_TO_SLOT,  /* sched event arrives at the slot: task, flush, ring message or end */
    SIM_STATE,    /* the state of the frames arrives at the slot */
    SIM_PREPARED, /* the slot has built it; sched.n: the turn of its work */
    SIM_COMPUTED, /* the slot has finished its task; likewise */
    SIM_LOAD,     /* load number sched.n of the plan; sched.power: the share that it leaves */
    SIM_WAKE,     /* of the slot's node; slot -1: of the hub */
    SIM_FAULT,    /* fault number sched.n of the plan */
    SIM_RESUME,   /* the slot continues after a pause */
    SIM_GIVE_UP,  /* the fan gives up the silent slot */
    SIM_RETURN,   /* the slot comes up again */
    SIM_RESTART   /* a new hub starts */
};
struct sim_event {
    int64_t at_us;
    enum sim_kind kind;
    int32_t slot;
    uint32_t epoch; /* of the slot's process: events for a dead one are void */
    uint32_t hub;   /* likewise, of the hub's process */
    struct sched_event sched;
};
/* The heap moves keys; events stay. Keys at or after n name free bodies. */
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
