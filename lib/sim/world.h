/*
 * The world of one simulated run, shared by its files: slots.c (slots, links), checks.c (what must
 * hold), run.c.
 */
#ifndef STORMRING_SIM_WORLD_H
#define STORMRING_SIM_WORLD_H

#include "sim/heap.h"
#include "sim/sim.h"

#define FRAME_W 64 /* of the one frame, where the plan makes it up */

struct vslot {
    bool up, lost; /* the policy was told that it is; that it is gone, ever */
    int32_t has;   /* tasks that it was given and has not answered */
    bool asked;    /* for a flush, since it was last given work */
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

/* A task of the plan, or a piece that the policy made of one. */
struct vtask {
    struct task task;
    uint64_t sent;   /* pixels 0 .. sent were passed to the policy under this id */
    uint64_t owners; /* slots that were given it and have not answered: bit K */
    int32_t gives;
    int64_t order;               /* of the latest, among all gives */
    uint8_t nth[SIM_SLOTS_MOST]; /* which of these the slot's was */
    int32_t to;                  /* preassigned slot, -1 */
    int32_t computed_by;         /* the first slot that said so, and is not lost, -1 */
    bool known, committed;
    bool overtaken; /* a piece of what was computed since */
};

struct world {
    const struct policy *policy;
    const struct sim_plan *plan;
    struct sim_result *result;
    void *state;
    struct sched_actions acts;
    struct sim_heap heap;
    struct vslot *slots;
    struct vtask *tasks; /* by id: those of the plan, then pieces */
    int32_t n_tasks, cap_tasks;
    uint32_t *order; /* ids in the order in which they come */
    uint32_t frame_w, frame_h;
    struct coverage sent; /* pixels that were passed on */
    int64_t now_us;
    double cost_us; /* drawn so far, at power 1 */
    uint64_t draws;
    bool slots_known, input_ended, ended;
};

/* The next number in [0, 1) of this run. */
double draw(struct world *w);
/* Notes the first thing that does not hold. */
void fail(struct world *w, const char *what, int64_t a, int64_t b);
void schedule(struct world *w, int64_t at_us, struct sim_event e);
/* When what is sent now arrives over a link that keeps order. */
int64_t arrival(struct world *w, int64_t *latest);

/* The task of that id, or NULL when there can be none. */
struct vtask *vtask_at(struct world *w, uint32_t id);
/* Slot k (or its fan) tells the policy. */
void say(struct world *w, int32_t k, struct sched_event e);
void append_task(struct task **list, size_t *n, size_t *cap, const struct task *t);
void start_next(struct world *w, int32_t k);
void computed(struct world *w, int32_t k, int64_t wall_us);
void hand_over(struct world *w, int32_t k);
void resume(struct world *w, int32_t k);
void kill_slot(struct world *w, int32_t k);

/* What an event means for the checks, before the policy sees it. */
void note_event(struct world *w, const struct sched_event *e);
void check_give(struct world *w, const struct sched_action *a);
void check_commit(struct world *w, const struct sched_action *a);
void check_end(struct world *w, bool stop);
/* After a step. */
void check_owners(struct world *w);

#endif
