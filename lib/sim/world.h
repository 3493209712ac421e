/*
 * The world of one simulated run, shared by its files: run.c (the hub, its input, the loop),
 * links.c, slots.c (processes and workers), node.c (a node's policy), faults.c, checks.c (what must
 * hold of all), checks_deal.c.
 */
#ifndef STORMRING_SIM_WORLD_H
#define STORMRING_SIM_WORLD_H

#include "sim/heap.h"
#include "sim/sim.h"

#define FRAME_W 64  /* of the one frame, where the plan makes it up */
#define SLOWEST .05 /* of its power, that is left to a slot that slows down by chance */

/* What comes to a stopped process waits for it. */
struct inbox {
    struct sim_event *at;
    size_t n, cap;
};
struct tasks {
    struct task *at;
    size_t first, n, cap; /* tasks first .. n-1 */
};

struct vslot {
    bool up, lost; /* the hub's policy was told that it is; that it is gone, ever */
    /* the process */
    bool alive, stalled;
    uint32_t epoch;
    struct inbox inbox; /* while it is stalled */
    void *node;         /* the state of its policy, where the plan names one */
    bool node_ended;    /* that said END */
    bool asks;          /* it said that it wants work, and none has come since */
    int64_t wake_us;    /* when it is woken next, INT64_MAX */
    /* its worker */
    double power;
    struct tasks queue; /* to compute, in order */
    struct tasks held;  /* computed, pixels not sent */
    bool busy, hung;    /* hung: and will be for ever */
    /* its links: latest arrivals, which keep order, and when the last pixels have left it */
    int64_t down_us, up_us, pixels_us, left_us;
    /* its time */
    int64_t first_us, began_us, last_us; /* its first task, the one that it is on; its last end */
    double busy_us;
    /* for the checks of deal */
    void *note;  /* what else the plan's checks know of it; NULL at first, freed with it */
    int32_t has; /* tasks that it was given and has not answered */
    bool asked;  /* for a flush, since it was last given work */
};

/* A task of the plan, or a piece that the policy made of one. */
struct vtask {
    struct task task;
    int32_t to; /* preassigned slot, -1 */
    bool known, committed;
    uint64_t sent; /* pixels 0 .. sent were passed to the policy under this id */
    void *note;    /* what else the plan's checks know of it; freed with it */
};

struct world {
    const struct policy *policy;
    const struct sim_plan *plan;
    const struct sim_checks *checks;
    struct sim_result *result;
    void *state;
    uint32_t hub; /* which one it is; what was for an earlier one is void */
    bool down;    /* it was killed, and is not started again */
    int64_t wake_us;
    struct sched_actions acts, node_acts;
    struct sim_heap heap;
    struct vslot *slots;
    struct vtask *tasks; /* by id: those of the plan, then pieces */
    int32_t n_tasks, cap_tasks;
    uint32_t *order;              /* ids in the order in which they come */
    int32_t n_read;               /* of these */
    int64_t spread_us, begun_us;  /* they come over this time, from then on */
    int32_t n_open;               /* tasks of the plan that are known and not committed */
    int32_t open_of[GENERATIONS]; /* of these, by their generation */
    uint32_t generation;          /* the latest that was admitted */
    bool waits;                   /* the next one is not yet */
    uint32_t frame_w, frame_h;
    struct coverage sent; /* pixels that were passed on */
    uint64_t wanted_px;   /* of all tasks of the plan */
    int64_t now_us;
    int64_t hub_us;  /* until then pixels pass the hub */
    double cost_us;  /* drawn so far, at power 1 */
    double alone_us; /* what all would take the slowest slot */
    uint64_t draws;
    bool slots_known, input_ended, ended;
    void *note;     /* of the plan's checks, likewise */
    bool input_due; /* more will come, and when is known */
};

/*
 * The checks of a policy. Each is called where it is not NULL, after those of all runs; sim_fail()
 * says what does not hold. restart: all is forgotten except what has been passed on.
 */
struct sim_checks {
    void (*task)(struct vtask *t); /* first of all, and after a restart: to make its note */
    void (*event)(struct world *w, const struct sched_event *e); /* before the hub sees it */
    void (*action)(struct world *w, const struct sched_action *a);
    void (*after)(struct world *w); /* a step of the hub, with all of its actions */
    void (*restart)(struct world *w);
    void (*node_event)(struct world *w, int32_t k, const struct sched_event *e);
    void (*node_action)(struct world *w, int32_t k, const struct sched_action *a);
};

/* ---- run.c ----------------------------------------------------------------------------------- */

/* The next number in [0, 1) of this run. */
double sim_draw(struct world *w);
/* Notes the first thing that does not hold. */
void sim_fail(struct world *w, const char *what, int64_t a, int64_t b);
/* e for slot k's process as it is now, or what this hub is to know of it. */
void sim_schedule(struct world *w, int64_t at_us, int32_t k, struct sim_event e);
/* Sees to it that who has this policy and state is woken in time; k: a node's, or -1. */
void sim_schedule_wake(struct world *w, const struct policy *p, void *state, int32_t k);
/* The task of that id, or NULL when there can be none. */
struct vtask *sim_vtask_at(struct world *w, uint32_t id);
/* Tells the hub how many slots there are, and starts them. */
void sim_start_slots(struct world *w, int64_t known_us);

/* ---- links.c --------------------------------------------------------------------------------- */

/* To the hub, from slot k or its fan: control, pixels, or, for GONE and UP, behind both. */
void sim_say(struct world *w, int32_t k, struct sched_event e);
/* These are at the hub, through which all pixels go one after the other. */
void sim_pass_hub(struct world *w, const struct sim_event *e);
/* The hub's action, to slot k. */
void sim_send_down(struct world *w, int32_t k, const struct sched_action *a);

/* ---- slots.c --------------------------------------------------------------------------------- */

/* What has come to slot k, which is alive. */
void sim_deliver(struct world *w, const struct sim_event *e);
void sim_append_task(struct tasks *list, const struct task *t);
void sim_start_next(struct world *w, int32_t k);
void sim_hand_over(struct world *w, int32_t k);
void sim_slot_comes_up(struct world *w, int32_t k);
void sim_resume(struct world *w, int32_t k);
/* The process and all that it has is no more. */
void sim_end_slot(struct world *w, int32_t k);
/* The same, and the hub will hear of it; it may come back. */
void sim_lose_slot(struct world *w, int32_t k);

/* ---- node.c ---------------------------------------------------------------------------------- */

void sim_node_step(struct world *w, int32_t k, struct sched_event e);
void sim_node_begin(struct world *w, int32_t k);
void sim_node_wake(struct world *w, int32_t k);

/* ---- faults.c -------------------------------------------------------------------------------- */

/* Those that the plan names, and those that it draws for slot k; k -1: for the hub. */
void sim_plan_faults(struct world *w);
void sim_draw_fault(struct world *w, int32_t k);
void sim_inject_fault(struct world *w, const struct sim_event *e);
/* More tasks are committed than before: those that wait for that. */
void sim_inject_by_commits(struct world *w, int64_t before);
void sim_restart_hub(struct world *w);

/* ---- trace.c --------------------------------------------------------------------------------- */

#define SIM_LINE 128
/* The event in words; lost: it meets nobody. */
void sim_trace_line(const struct sim_event *e, bool lost, char line[SIM_LINE]);

/* ---- checks.c -------------------------------------------------------------------------------- */

/* What an event means, before the hub's policy sees it; what it does. */
void sim_note_event(struct world *w, const struct sched_event *e);
void sim_note_action(struct world *w, const struct sched_action *a);
bool sim_is_sent(const struct world *w, const struct lattice *at);

#endif
