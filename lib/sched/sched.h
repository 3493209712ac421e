/*
 * sched: scheduling policies as state machines. No clock, no I/O, no chance: an event and the time
 * go in, actions come out, and the same calls give the same actions. The live driver (deal,
 * ringctl) and the virtual-time simulation run the very same object code. Calls: policy->create,
 * then step for every event, then destroy.
 *
 * The GDC ring is two policies: the hub, around a fan of nodes, and the node, around one worker,
 * which is its slot 0; what they say to each other are ring messages. A node's work comes as
 * SCHED_TASK, and END is its input's end.
 *
 * What every policy around a fan guarantees to its driver: each task whose pixels were delivered is
 * committed once; a task that is not committed is in the pool, or has an owner that is up, or has
 * pieces for which that holds; SCHED_END or SCHED_STOP comes once, when, and only when, the input
 * has ended and nothing is uncommitted. policy_published guarantees the second and the "when" of
 * the third only as long as nothing fails.
 */
#ifndef STORMRING_SCHED_H
#define STORMRING_SCHED_H

#include "base/base.h"
#include "task/task.h"

/*
 * What a node and the hub say to each other (ringctl(1)). Slots number the nodes; peer is always
 * the other node that it is about. The links are FIFO; a task that a node gives to another one goes
 * up as RING_GIVE, and comes down as the task itself.
 */
enum ring_kind {
    RING_PLACE,   /* down: you are node `me` of n, by these rules */
    RING_ASK,     /* up: I want work of peer, or, -1, of who has some; down: peer wants some */
    RING_GIVE,    /* up: the task of this key is peer's now */
    RING_NONE,    /* up, and down to peer: I have nothing to give; idle, next; by the default rules,
                   * down to who asked, and is peer: you have to wait for work */
    RING_CRASHED, /* up, published rules: peer does not answer */
    RING_HEIR     /* down, published rules: the tasks that peer had follow; next came after it */
};
struct ring {
    enum ring_kind kind;
    int32_t peer;   /* -1: none */
    int32_t next;   /* NONE: ask this one, which had work; HEIR; -1: none */
    bool idle;      /* NONE: I have nothing to do myself */
    int32_t me, n;  /* PLACE */
    bool published; /* PLACE: as the paper has it */
    bool one;       /* PLACE: one task is given at a time, not half of them */
};

enum sched_event_kind {
    SCHED_TASK,      /* task, frame_w: work has come */
    SCHED_INPUT_END, /* no more work will come */
    SCHED_FLUSH,     /* whoever reads wants what is held back */
    SCHED_SLOTS,     /* n: slots are numbered 0 .. n-1 */
    SCHED_UP,        /* slot: it can be given work; n: and works on so many tasks at once, 1 if 0 */
    SCHED_GONE,      /* slot: its connection is lost, with all it held */
    SCHED_DONE,      /* slot, task key: computed; its pixels may still be held back there */
    SCHED_PIXELS,    /* slot, task key, at: these pixels have come, and were passed on */
    SCHED_RING, /* ring, task key where it is a GIVE: from the node on that slot; to a node: from
                      * the hub */
    SCHED_WAKE  /* it is as late as wake_us said, or later */
};
struct sched_event {
    enum sched_event_kind kind;
    int32_t slot, n;
    struct task task;
    uint32_t frame_w;
    int64_t wall_us; /* DONE: so long it was computed, as the slot says; -1: it does not */
    double power;    /* UP: of the slot, relative; 0: not known */
    int32_t from;    /* TASK, to a node: the node whose it was; -1: it was nobody's */
    struct ring ring;
};

enum sched_action_kind {
    SCHED_GIVE,      /* task to slot */
    SCHED_ASK_FLUSH, /* slot: hand over what is held back */
    SCHED_COMMIT,    /* task: all of its pixels have been passed on, once */
    SCHED_SAY,       /* ring, task key where it is a GIVE: to the node on that slot; of a node: to
                      * the hub */
    SCHED_END,       /* close the input of all slots */
    SCHED_STOP       /* the same, and stop them: what they are still on is needed no more */
};
struct sched_action {
    enum sched_action_kind kind;
    int32_t slot;
    struct task task;
    uint32_t of;  /* GIVE: the id of the task, as it came, that this one is, or is a piece of */
    int32_t from; /* GIVE, to a node: the node whose it was, -1 */
    struct ring ring;
};
/* The actions of one step, in order; the driver empties it. */
struct sched_actions {
    struct sched_action *at;
    size_t n, cap;
};
void sched_act(
    struct sched_actions *out, enum sched_action_kind kind, int32_t slot, const struct task *task);

#define SCHED_WAITING_MOST 65536 /* tasks waiting: the driver reads no more */
#define SCHED_DEPTH_AUTO (-1)
struct sched_params {
    int32_t depth; /* -q: tasks a slot may hold beyond those it is on, or SCHED_DEPTH_AUTO */
    bool endgame;  /* -e: the last tasks are cut smaller, and given to more than one slot */
    bool one;      /* ring -k one: nodes give one task at a time */
};

struct policy {
    const char *name;
    void *(*create)(const struct sched_params *p);
    void (*step)(
        void *state, const struct sched_event *e, int64_t now_us, struct sched_actions *out);
    /* Tasks of this generation; others modulo GENERATIONS have none. */
    int32_t (*uncommitted)(const void *state, uint32_t generation);
    /* Tasks that no slot was given yet: the driver reads on while they are few. */
    int64_t (*waiting)(const void *state);
    /* The copy of this task that slot is on, or has in store, was its so many-th; 0: it has none.
     */
    int32_t (*tries)(const void *state, int32_t slot, uint32_t frame, uint32_t id);
    /* When it wants SCHED_WAKE; INT64_MAX: it does not. NULL: it never does. */
    int64_t (*wake_us)(const void *state);
    void (*destroy)(void *state);
};

static inline int64_t sched_uncommitted(const struct policy *p, const void *state)
{
    int64_t n = 0;
    for (uint32_t g = 0; g < GENERATIONS; g++) n += p->uncommitted(state, g);
    return n;
}
/*
 * May state go on after which the oldest generation that may have tasks is `oldest`, where it was
 * `from`? Not while there is a task of one between: so few are alive at once (wire.h), and nobody
 * waits at the end of one.
 */
bool sched_admits(const struct policy *p, const void *state, uint32_t from, uint32_t oldest);

extern const struct policy policy_deal;
extern const struct policy policy_ring;      /* the hub */
extern const struct policy policy_published; /* the master of the ring as it was published */
extern const struct policy policy_node;      /* a node of either, as its PLACE says */

#endif
