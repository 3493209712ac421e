/*
 * A priority queue of events by (time, order of insertion): equal times keep their order, so a seed
 * is one run.
 */
#ifndef STORMRING_SIM_HEAP_H
#define STORMRING_SIM_HEAP_H

#include "sched/sched.h"

enum sim_kind {
    SIM_SCHED,    /* sched event arrives at the policy */
    SIM_TO_SLOT,  /* task arrives at the slot */
    SIM_FLUSH,    /* a flush does */
    SIM_COMPUTED, /* the slot has finished its task */
    SIM_CRASH,
    SIM_STALL,
    SIM_RESUME,
    SIM_GIVE_UP,
    SIM_RETURN
};
struct sim_event {
    int64_t at_us;
    uint64_t order;
    enum sim_kind kind;
    int32_t slot;
    uint32_t epoch; /* of the slot's process: what belongs to a dead one is void */
    struct sched_event sched;
};
struct sim_heap {
    struct sim_event *at;
    size_t n, cap;
    uint64_t order;
};
void heap_push(struct sim_heap *h, struct sim_event e);
bool heap_pop(struct sim_heap *h, struct sim_event *e);

#endif
