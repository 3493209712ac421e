/*
 * The world of one simulated run, shared by its files: slots.c (slots, links), checks.c (what must
 * hold), run.c.
 */
#ifndef STORMRING_SIM_WORLD_H
#define STORMRING_SIM_WORLD_H

#include "sim/heap.h"
#include "sim/sim.h"

#define FRAME_W 64 /* a task is a row of the one frame */

struct vslot {
    bool up, lost; /* the policy was told that it is; that it is gone, ever */
    bool alive, stalled;
    uint32_t epoch;
    double power;
    struct task *queue; /* to compute, in order */
    size_t n_queue, cap_queue;
    struct task *held; /* computed, pixels not sent */
    size_t n_held, cap_held;
    bool busy, flush_due;   /* flush_due: asked while it was stalled */
    int64_t down_us, up_us; /* latest arrivals on its links, which keep order */
};

struct vtask {
    uint64_t sent;                      /* pixels 0 .. sent were passed to the policy */
    int32_t owner;                      /* slot it was last given to, -1 */
    int32_t to;                         /* preassigned slot, -1 */
    bool known, given, done, committed; /* done: its owner has said so */
};

struct world {
    const struct policy *policy;
    const struct sim_plan *plan;
    struct sim_result *result;
    void *state;
    struct sched_actions acts;
    struct sim_heap heap;
    struct vslot *slots;
    struct vtask *tasks;
    int64_t now_us;
    uint64_t draws;
    bool ended;
};

/* The next number in [0, 1) of this run. */
double draw(struct world *w);
/* Notes the first thing that does not hold. */
void fail(struct world *w, const char *what, int64_t a, int64_t b);
void schedule(struct world *w, int64_t at_us, struct sim_event e);
/* When what is sent now arrives over a link that keeps order. */
int64_t arrival(struct world *w, int64_t *latest);

struct task row_task(int32_t id);
/* Slot k (or its fan) tells the policy. */
void say(struct world *w, int32_t k, struct sched_event e);
void append_task(struct task **list, size_t *n, size_t *cap, const struct task *t);
void start_next(struct world *w, int32_t k);
void computed(struct world *w, int32_t k);
void hand_over(struct world *w, int32_t k);
void resume(struct world *w, int32_t k);
void kill_slot(struct world *w, int32_t k);

void check_give(struct world *w, const struct sched_action *a);
void check_commit(struct world *w, const struct sched_action *a);
void check_end(struct world *w);
void check_owners(struct world *w);

#endif
