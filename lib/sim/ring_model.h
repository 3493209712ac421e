/*
 * The ring as its checks see it, shared by ring_model.c (the ledger), checks_ring.c (the hub) and
 * checks_node.c (the nodes):
 * a ledger of their own.
 */
#ifndef STORMRING_SIM_RING_MODEL_H
#define STORMRING_SIM_RING_MODEL_H

#include "sim/world.h"

/* Of a task; the bits are of slots. */
enum rplace { RING_ABSENT, RING_ORPHAN, RING_HELD, RING_COMPUTED };
struct rtask {
    enum rplace place;
    int32_t base;   /* whose it is; ORPHAN: whose it is to be, or whose heir's; -1: not known */
    int32_t from;   /* whose it was before, where it was given away, -1 */
    int32_t passes; /* so often it was, since a connection was lost with it */
    uint64_t queued, fed;         /* the node there has it, not begun; its worker has it */
    int64_t came[SIM_SLOTS_MOST]; /* there as the so many-th of all that were queued anywhere */
};

enum rstate { RING_NEW, RING_UP, RING_GONE };
struct rslot {
    enum rstate state;
    /* as the hub knows it */
    int32_t held, computed, promised;                /* tasks; promised: ORPHAN, while it is NEW */
    bool asking, told, passed, dry, flushed, placed; /* passed: its ask is, to another one */
    bool hungry, rich;    /* wants, and nobody was asked for it; has, and may be asked */
    int64_t given;        /* tasks */
    int32_t thieves;      /* nodes for which it was asked, and that have not been given any */
    int32_t victim;       /* the node that was asked for it; -1 */
    int64_t given_before; /* what that one had been given then */
    int64_t since_us;     /* and when that was */
    bool silent;          /* it did not answer in time, and has said nothing since */
    int64_t moved_us;     /* it made progress, or had none to make, last then */
    /* the node itself, since it began */
    int32_t queued, fed;
    bool has_place, asked, ended;
    int32_t asker;           /* the node whose ask it has to answer in this step, -1 */
    int32_t answers;         /* GIVEs so far */
    bool in_time;            /* its worker was, when it was asked */
    double has_px;           /* of what is queued and fed */
    double had_px, given_px; /* before it was asked; in the answers */
};

struct ring_model {
    int32_t orphans, promised, up, hungry, rich, open, computed;
    bool known, input_ended, flush;
    bool taken_over;         /* a task of a node that was late */
    bool paced;              /* the hub knows how fast a node is */
    int64_t came;            /* tasks that were queued */
    int32_t late, late_left; /* the slot not up whose tasks are being given, and how many may be */
    double most_px;          /* of a task */
    int32_t touched;         /* the slot of the latest event, -1 */
    int64_t answer_us;       /* the longest answer, of late, 0 */
    struct rslot slots[];
};

/* ---- ring_model.c ---------------------------------------------------------------------------- */

struct ring_model *sim_ring_model(struct world *w);
/* What is known of the task of that key, NULL where there is none. */
struct rtask *sim_ring_task(struct world *w, const struct task *t);
/* Slot k has changed. */
void sim_ring_mark(struct world *w, struct ring_model *m, int32_t k);
/* Who is to be given a task whose base is k; -1: nobody, yet. */
int32_t sim_ring_receiver(const struct world *w, const struct ring_model *m, int32_t k);
/* Task t is in place p, with base k, from now on. */
void sim_ring_enter(
    struct world *w, struct ring_model *m, struct rtask *t, enum rplace p, int32_t k);
static inline double px_of(const struct task *t) { return (double)lattice_count(&t->at); }

/* ---- checks_node.c --------------------------------------------------------------------------- */

void sim_ring_node_event(struct world *w, int32_t k, const struct sched_event *e);
void sim_ring_node_action(struct world *w, int32_t k, const struct sched_action *a);

#endif
