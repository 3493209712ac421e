/*
 * The ring's checks keep a ledger of their own. It is shared by ring_model.c (the ledger),
 * ring.c (the hub) and node.c (the nodes).
 */
#ifndef STORMRING_SIM_RING_MODEL_H
#define STORMRING_SIM_RING_MODEL_H

#include "oracles.h"
#include "sim/world.h"

/* The state of a task; bits are slots. CUT: no node has it, but its pieces are missing. REST: no
 * node has this piece. */
/* ASIDE: it has cost nodes, and none has it. */
enum rplace { RING_ABSENT, RING_ORPHAN, RING_HELD, RING_COMPUTED, RING_CUT, RING_REST, RING_ASIDE };
struct rtask {
    enum rplace place;
    int32_t parent; /* the task that it is a piece of; -1: none */
    bool cut;       /* it has pieces */
    bool alone;     /* it was aside and is tried once more, or is a part of such a task */
    int64_t tried;  /* the number of the event in which it was tried once more; */
    int64_t lost;   /* the number of the event in which its node was lost */
    int32_t base;   /* its owner; ORPHAN: its future owner, or that one's heir; -1: not known */
    int32_t from;   /* previous owner, if it was given away; else -1 */
    int64_t given;  /* HELD: the number of the GIVE to its owner, of all */
    int32_t passes; /* times it was given away since a lost connection had it */
    uint64_t queued, fed;         /* the slot's node has it, not begun; the slot's worker has it */
    int64_t came[SIM_SLOTS_MOST]; /* order of arrival there, among all queued tasks */
};

enum rstate { RING_NEW, RING_UP, RING_DRAINS, RING_GONE };
struct rslot {
    enum rstate state;
    /* The hub's view: */
    int32_t held, computed, promised;                /* tasks; promised: ORPHAN, while it is NEW */
    bool asking, told, passed, dry, flushed, placed; /* passed: its ask went to another victim */
    bool hungry, rich;    /* wants work and has no victim; has work and may be asked */
    int64_t given;        /* tasks given to it */
    int32_t thieves;      /* nodes for which it was asked, and that have no task yet */
    int32_t victim;       /* the node asked on its behalf; -1: none */
    int64_t given_before; /* tasks that the victim had been given then */
    int64_t since_us;     /* time of that ask */
    bool silent;          /* did not answer in time, and has sent nothing since */
    bool timed;           /* it has done a task of its own */
    int64_t moved_us;     /* last progress, or last time with nothing to do */
    /* The node itself, since it began: */
    int32_t queued, fed;
    bool has_place, asked, ended;
    int32_t asker;           /* the node whose ask it must answer in this step, -1: none */
    int32_t answers;         /* GIVEs so far */
    bool in_time;            /* its worker was in time when the node was asked */
    double has_px;           /* pixels queued and fed */
    double had_px, given_px; /* has_px before the ask; pixels given in the answers */
    double part;             /* of had_px that the asking node does in the same time as the rest */
};

struct ring_model {
    int32_t n; /* nodes so far; 0: not known */
    int32_t orphans, promised, up, hungry, rich, open, computed;
    int32_t cuts; /* tasks that have pieces */
    bool input_ended, flush;
    bool taken_over;         /* a task of a late node was taken over */
    bool paced;              /* the hub knows the speed of a node */
    int64_t came;            /* tasks queued so far */
    int32_t late, late_left; /* the slot not up whose tasks are given away; how many may be */
    double most_px;          /* most pixels of a task */
    int32_t touched;         /* the slot of the latest event, -1: none */
    int64_t n_events;        /* so far */
    int64_t n_given;         /* GIVEs so far */
    int32_t blames;          /* nodes lost over tasks before one was done; */
    bool well;               /* one was; */
    bool all_aside;          /* none was, and too many nodes were lost */
    int64_t answer_us;       /* the longest recent answer, 0: none */
    struct rslot slots[];
};

/* ---- ring_model.c ---------------------------------------------------------------------------- */

struct ring_model *sim_ring_model(struct world *w);
/* The record of the task with that key, or NULL. */
struct rtask *sim_ring_task(struct world *w, const struct task *t);
/* Slot k has changed. */
void sim_ring_mark(struct world *w, struct ring_model *m, int32_t k);
/* The node that gets a task whose base is k; -1: none yet. */
int32_t sim_ring_receiver(const struct world *w, const struct ring_model *m, int32_t k);
/* Moves task t to place p, with base k. */
void sim_ring_enter(
    struct world *w, struct ring_model *m, struct rtask *t, enum rplace p, int32_t k);
/* Task t has cost too many nodes; or all tasks have. */
bool sim_ring_costly(const struct world *w, const struct rtask *t);
bool sim_ring_bad(const struct world *w, const struct ring_model *m, const struct rtask *t);
/* Task t of slot k is not its own any more. */
void sim_ring_hand_on(struct world *w, struct ring_model *m, struct rtask *t, int32_t k);
/* If slot k drains since this step: the policy has handed over all of its tasks but those that it
 * computes at once. */
void sim_ring_hand_over(struct world *w, struct ring_model *m, int32_t k);
static inline bool sim_ring_works(const struct rslot *s)
{
    return s->state == RING_UP || s->state == RING_DRAINS;
}
static inline double px_of(const struct task *t) { return (double)lattice_count(&t->at); }

/* ---- ring_end.c ---------------------------------------------------------------------------- */

/* A task with a new id, or a piece without a node, is given. False: that breaks a rule. */
bool sim_ring_piece(struct world *w, struct ring_model *m, const struct sched_action *a);
/* Task t leaves the ledger, with its pieces. */
void sim_ring_forget(struct world *w, struct ring_model *m, struct rtask *t);

/* ---- ring_aside.c -------------------------------------------------------------------------- */

/* The node that a task without owner begins at. */
int32_t sim_ring_home(const struct ring_model *m, const struct task *t);
/* A task was done: tasks that were aside with all others have owners again. */
void sim_ring_note_well(struct world *w, struct ring_model *m);
/* Slot k cannot compute t, which goes to the next node. */
void sim_ring_note_fail(struct world *w, struct ring_model *m, struct rtask *t, int32_t k);
/* A node was lost over a task: this may be put aside, with others that the node had. */
void sim_ring_note_blame(struct world *w, struct ring_model *m, const struct sched_action *a);
/* Slot k is given t, which was aside. */
void sim_ring_check_tried(struct world *w, struct ring_model *m, struct rtask *t, int32_t k);

/* ---- node.c --------------------------------------------------------------------------- */

void sim_ring_node_event(struct world *w, int32_t k, const struct sched_event *e);
void sim_ring_node_action(struct world *w, int32_t k, const struct sched_action *a);

#endif
