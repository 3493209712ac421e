/*
 * The world of one simulated run, shared by its files: run.c (the hub, its input, the loop),
 * links.c, start.c (what comes before the first task), slots.c (processes and workers), work.c
 * (what they work on, and how fast), node.c (a node's policy), faults.c, poison.c, checks.c (checks
 * of every run).
 */
#ifndef STORMRING_SIM_WORLD_H
#define STORMRING_SIM_WORLD_H

#include "sim/heap.h"
#include "sim/net.h"
#include "sim/worker.h"

#define FRAME_W 64       /* pixels; of frames that the plan makes up */
#define SLOWEST .05      /* share of its power left to a slot slowed down by chance */
#define POWER_LEAST 1e-3 /* likewise, by all slow-downs together */
#define POISON_TRIES 40  /* slots that a pixel may cost: three, and two for each cut */

/* A pixel that costs slots. */
struct poison {
    uint32_t x, y;
    bool said; /* the slot says that it cannot compute it, and goes on; else it dies */
};

/* Events for a stopped process wait here. */
struct inbox {
    struct sim_event *at;
    size_t n, cap;
};

/* What a slot's processor is at: the task that its clock counts, or its preparation. */
struct vwork {
    bool on;
    enum sim_kind ends; /* the event at its end */
    double left_us;     /* at power 1, of what was left at: */
    int64_t since_us;
    double speed; /* since then */
    int32_t turn; /* the event of an earlier turn is void: the speed has changed since */
};

struct vslot {
    bool up, lost;     /* the hub's policy was told that it is up; that it was lost, ever */
    bool drains, left; /* it was told that it drains; and has let it go */
    bool hands_over;   /* it was told so in this step */
    /* The process: */
    bool alive, stalled;
    uint32_t epoch;
    struct inbox inbox; /* while it is stalled */
    void *node;         /* state of its policy, if the plan names one */
    bool node_ended;    /* that policy has sent END */
    bool asks;          /* asked for work, and got none since */
    int64_t wake_us;    /* next wake-up, INT64_MAX: none */
    /* Its worker: */
    double power;
    double share; /* of that, which other users leave */
    bool paused;
    bool prepares; /* it has no state to compute with yet */
    struct vwork work;
    struct sim_tasks queue; /* to compute, in order */
    struct sim_tasks held;  /* computed, pixels not sent */
    struct sim_clock clock;
    bool hung; /* busy for ever */
    /* Its link: latest arrivals, which keep order. */
    int64_t down_us, up_us, pixels_us;
    /* For the checks of deal: */
    void *note;  /* data of the plan's checks; NULL at first, freed with the slot */
    int32_t has; /* tasks given and not answered */
    bool asked;  /* asked to flush since it was last given work */
    uint64_t refused[GENERATIONS / 64]; /* bit g: it is up, and has refused such a generation */
};

/* A task of the plan, or a piece that the policy made of one. */
struct vtask {
    struct task task;
    int32_t to; /* preassigned slot, -1: none */
    bool known, committed;
    uint64_t sent;  /* pixels 0 .. sent were passed to the policy under this id */
    int32_t blamed; /* slots that were lost over it, by the policy */
    void *note;     /* data of the plan's checks; freed with the task */
};

struct world {
    const struct policy *policy;
    const struct sim_plan *plan;
    const struct sim_checks *checks;
    struct sim_result *result;
    void *state;
    uint32_t hub; /* its number; events for an earlier hub are void */
    bool down;    /* killed, and not started again yet */
    int64_t wake_us;
    struct sched_actions acts, node_acts;
    struct sim_heap heap;
    struct vslot *slots;
    struct vtask *tasks; /* by id: those of the plan, then pieces */
    int32_t n_tasks, cap_tasks;
    uint32_t *order;              /* ids in order of arrival */
    int32_t n_read;               /* number of tasks read */
    int64_t spread_us, begun_us;  /* tasks arrive over spread_us, from begun_us on */
    int32_t n_open;               /* known tasks of the plan that are not committed */
    int32_t open_of[GENERATIONS]; /* of these, by generation */
    uint32_t generation;          /* the latest admitted generation */
    bool waits;                   /* the next one is not admitted yet */
    uint32_t frame_w, frame_h;
    struct coverage sent;  /* pixels passed on, or given up */
    struct poison *poison; /* pixels that cost slots, */
    size_t n_poison;       /* of this number */
    uint64_t wanted_px;    /* of all tasks of the plan */
    int64_t now_us;
    double hub_us;                  /* pixels pass the hub until then */
    struct net_queue *up, *down_to; /* of links, by their numbers */
    double *primed_us;              /* likewise: when the state has left; -1: it was not sent */
    double cost_us;                 /* sum of costs drawn, at power 1 */
    double alone_us;                /* time of all tasks on the slowest slot */
    double start_us;                /* the most time until a slot is prepared, or a load changes */
    double latency_us;              /* the most of a link */
    double bytes_us;                /* time of all their records on the slowest link */
    uint64_t draws;
    bool slots_known, input_ended, ended;
    void *note;     /* data of the plan's checks */
    bool input_due; /* more input will come at a known time */
};

/*
 * The checks of a policy. Each that is not NULL is called after the checks of all runs; sim_fail()
 * reports a violation. restart: forget everything except the pixels passed on.
 */
struct sim_checks {
    void (*task)(struct vtask *t); /* first of all, and after a restart: makes the task's note */
    void (*event)(struct world *w, const struct sched_event *e); /* before the hub gets it */
    void (*action)(struct world *w, const struct sched_action *a);
    void (*after)(struct world *w); /* after a step of the hub and all of its actions */
    void (*restart)(struct world *w);
    void (*node_event)(struct world *w, int32_t k, const struct sched_event *e);
    void (*node_action)(struct world *w, int32_t k, const struct sched_action *a);
};

/* ---- run.c ----------------------------------------------------------------------------------- */

/* The next random number in [0, 1) of this run. */
double sim_draw(struct world *w);
/* Notes the first violation. */
void sim_fail(struct world *w, const char *what, int64_t a, int64_t b);
/* An event for the current process of slot k, or for the current hub. */
void sim_schedule(struct world *w, int64_t at_us, int32_t k, struct sim_event e);
/* Schedules the wake-up that this policy and state want; k: a node's slot, or -1 for the hub. */
void sim_schedule_wake(struct world *w, const struct policy *p, void *state, int32_t k);
/* The task of that id, or NULL if none can have it. */
struct vtask *sim_vtask_at(struct world *w, uint32_t id);
/* Tells the hub the number of slots, and starts them. */
void sim_start_slots(struct world *w, int64_t known_us);

/* ---- links.c --------------------------------------------------------------------------------- */

/* Sends to the hub, from slot k or its fan: control, pixels or, for GONE and UP, after both. */
void sim_say(struct world *w, int32_t k, struct sched_event e);
/* These pixels are at the hub; all pixels pass it one after the other. */
void sim_pass_hub(struct world *w, const struct sim_event *e);
/* Sends the hub's action to slot k. */
void sim_send_down(struct world *w, int32_t k, const struct sched_action *a);
/* The hub knows that slot k is up: sends it the state, if its link has not had it. */
void sim_prime(struct world *w, int32_t k);

/* ---- start.c --------------------------------------------------------------------------------- */

/* When slot k connects: 0, or the time at which it joins; INT64_MAX: never. */
int64_t sim_joins_us(const struct sim_plan *p, int32_t k);
/* The time that it needs to come up then. */
int64_t sim_connect_us(const struct sim_plan *p, int32_t k);
/* The time that it needs to build at power 1. */
double sim_build_us(const struct sim_plan *p, int32_t k);
/* The index of its first load, or that of a later slot's, or n_loads. */
size_t sim_first_load(const struct sim_plan *p, int32_t k);

/* ---- work.c ---------------------------------------------------------------------------------- */

/* Slot k begins what takes us at power 1; the event `ends` comes at the end, with sched.n. */
void sim_work_begin(struct world *w, int32_t k, enum sim_kind ends, double us);
/* Its power, share or pause has changed: what it is at ends earlier or later. */
void sim_work_changed(struct world *w, int32_t k);
/* Adds what slot k has computed since its speed changed last to the work of the run. */
void sim_work_count(struct world *w, int32_t k);
/* It has ended, in one way or another. */
void sim_work_end(struct world *w, int32_t k);
/* The event is for work that has ended, or whose speed has changed since. */
bool sim_work_over(const struct world *w, const struct sim_event *e);
/* Schedules the first load of each slot. */
void sim_plan_loads(struct world *w);
void sim_take_load(struct world *w, const struct sim_event *e);

/* ---- slots.c --------------------------------------------------------------------------------- */

/* An event arrives at slot k, which is alive. */
void sim_deliver(struct world *w, const struct sim_event *e);
void sim_start_next(struct world *w, int32_t k);
void sim_hand_over(struct world *w, int32_t k);
void sim_slot_comes_up(struct world *w, int32_t k);
/* The fan says that slot k is up, with its power. */
void sim_say_up(struct world *w, int32_t k);
void sim_resume(struct world *w, int32_t k);
/* Ends the process with all that it has. */
void sim_end_slot(struct world *w, int32_t k);
/* The same; the hub is told later, and the slot may come back. */
void sim_lose_slot(struct world *w, int32_t k);

/* ---- node.c ---------------------------------------------------------------------------------- */

void sim_node_step(struct world *w, int32_t k, struct sched_event e);
void sim_node_begin(struct world *w, int32_t k);
void sim_node_wake(struct world *w, int32_t k);

/* ---- poison.c -------------------------------------------------------------------------------- */

/* The first pixel of the task that costs slots, or NULL. */
const struct poison *sim_poison_in(const struct world *w, const struct task *t);
/* Chooses pixels for that. */
void sim_plan_poison(struct world *w);
/* Has slot k not the memory for the state of this generation? */
bool sim_refuses(const struct world *w, int32_t k, uint32_t generation);

/* ---- faults.c -------------------------------------------------------------------------------- */

/* Schedules the faults that the plan names, and draws some for slot k; k -1: for the hub. */
void sim_plan_faults(struct world *w);
void sim_draw_fault(struct world *w, int32_t k);
void sim_inject_fault(struct world *w, const struct sim_event *e);
/* More tasks are committed: starts the faults that wait for that. */
void sim_inject_by_commits(struct world *w, int64_t before);
void sim_restart_hub(struct world *w);

/* ---- trace.c --------------------------------------------------------------------------------- */

#define SIM_LINE 128
/* The event in words; lost: no process receives it. */
void sim_trace_line(const struct sim_event *e, bool lost, char line[SIM_LINE]);

/* ---- checks.c -------------------------------------------------------------------------------- */

/* Checks an event before the hub's policy gets it; checks an action. */
void sim_note_event(struct world *w, const struct sched_event *e);
void sim_note_action(struct world *w, const struct sched_action *a);
bool sim_is_sent(const struct world *w, const struct lattice *at);

#endif
