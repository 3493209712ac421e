/*
 * sched: scheduling policies as state machines without clock, I/O or random numbers. An event and
 * the time go in, actions come out; the same calls give the same actions. The live drivers (deal,
 * ringctl) and the virtual-time simulation run the same object code. Call policy->create, then step
 * for each event, then destroy.
 *
 * The GDC ring is two policies: the hub, around a fan of nodes, and the node, around one worker,
 * which is the node's slot 0. Hub and nodes exchange ring messages. Work reaches a node as
 * SCHED_TASK; SCHED_END to a node's fan closes the node's input.
 *
 * If `joins` is true, slots may come with numbers above those of SCHED_SLOTS, and a slot may be
 * told to leave: SCHED_DRAIN. The policy gives that slot nothing more, and says SCHED_LEAVE once,
 * when the slot owes no task. The slot is SCHED_GONE then, or earlier if it is lost.
 *
 * Every policy around a fan guarantees three things to its driver. (1) Each task whose pixels were
 * delivered is committed exactly once. (2) An uncommitted task is in the pool, or its owner is up,
 * or (1) to (3) hold for its pieces. (3) SCHED_END or SCHED_STOP comes exactly once: as soon as the
 * input has ended and no task is uncommitted, never before. policy_published guarantees (2), and
 * that the end comes at all, only while nothing fails.
 *
 * A task that costs each slot that computes it is given up in the end (blame.h), by SCHED_ABANDON:
 * then it, or the pieces of it that are good, and the rest count as committed.
 */
#ifndef STORMRING_SCHED_H
#define STORMRING_SCHED_H

#include "base/base.h"
#include "task/task.h"

/*
 * Messages between a node and the hub (ringctl(1)). Slots number the nodes; `peer` is always the
 * other node that the message concerns. The links are FIFO. A task that a node gives to another
 * goes up as RING_GIVE and comes down as the task itself.
 */
enum ring_kind {
    RING_PLACE,   /* down: you are node `me` of n; these rules apply */
    RING_ASK,     /* up: I want work from peer, or from any node (-1); down: peer wants some */
    RING_GIVE,    /* up: the task with this key now belongs to peer */
    RING_NONE,    /* up, and down to peer: I have nothing to give; sets idle, next; by the default
                   * rules also down to the asking node, which is peer then: wait for work */
    RING_CRASHED, /* up, published rules: peer does not answer */
    RING_HEIR     /* down, published rules: peer's tasks follow; next came after peer */
};
#define RING_TAKES_MOST 1000000
struct ring {
    enum ring_kind kind;
    int32_t peer;   /* -1: none */
    int32_t next;   /* NONE: ask this node, which had work; HEIR: see there; -1: none */
    bool idle;      /* NONE: I have nothing to do myself */
    int32_t takes;  /* ASK, down: peer's time for work in percent of this node's; 0: not known */
    int32_t me, n;  /* PLACE */
    bool published; /* PLACE: the rules as published apply */
};

enum sched_event_kind {
    SCHED_TASK,      /* task, frame_w: a task has arrived */
    SCHED_INPUT_END, /* no more tasks will arrive */
    SCHED_FLUSH,     /* the reader wants the pixels that are held back */
    SCHED_SLOTS,     /* n: slots are numbered 0 .. n-1 */
    SCHED_UP,        /* slot: it can be given work; n: tasks it computes at once, 1 if 0; again,
                      * if it is up: its power has changed */
    SCHED_GONE,      /* slot: its connection is lost, with all that the slot held */
    SCHED_DRAIN,     /* slot: it is to leave the run; SCHED_LEAVE is the answer */
    SCHED_DONE,      /* slot, task key: computed; the slot may still hold back pixels */
    SCHED_FAIL,      /* slot, task key: the slot cannot compute it, and goes on */
    SCHED_PIXELS,    /* slot, task key, at: these pixels have arrived and were passed on */
    SCHED_RING, /* ring, task key for a GIVE; slot: the sending node; to a node: from the hub */
    SCHED_WAKE  /* the time is wake_us or later */
};
struct sched_event {
    enum sched_event_kind kind;
    int32_t slot, n;
    struct task task;
    uint32_t frame_w;
    int64_t wall_us; /* DONE: computing time, as the slot reports it; -1: not reported */
    bool refused;    /* FAIL: the slot has not the memory for the state of the task */
    double power;    /* UP: relative power of the slot; 0: unknown */
    bool stated;     /* UP: the hosts file states that power; else it was measured in a moment */
    int32_t from;    /* TASK, to a node: the previous owner; -1: none */
    struct ring ring;
};

enum sched_action_kind {
    SCHED_GIVE,      /* task to slot */
    SCHED_ASK_FLUSH, /* slot: send the pixels that are held back */
    SCHED_COMMIT,    /* task: all of its pixels have been passed on, each once, or given up */
    SCHED_BLAME,     /* slot, task: the slot was lost, or has failed, while it computed the task */
    SCHED_ABANDON,   /* task: its missing pixels are given up; all: and those of its frame */
    SCHED_SAY,   /* ring, task key for a GIVE; slot: the receiving node; from a node: to the hub */
    SCHED_LEAVE, /* slot, after SCHED_DRAIN: it holds nothing more, and gets nothing more */
    SCHED_END,   /* close the input of all slots */
    SCHED_STOP   /* the same, and stop the slots: their current tasks are not needed */
};
struct sched_action {
    enum sched_action_kind kind;
    int32_t slot;
    struct task task;
    uint32_t origin_id; /* GIVE: id of the input task that this one is, or is a piece of */
    int32_t from;       /* GIVE, to a node: the previous owner; -1: none */
    bool all;           /* ABANDON: no task of the frame could be computed */
    bool refused;       /* ABANDON: all slots that are up refuse its state; BLAME: the slot does */
    struct ring ring;
};
/* The actions of one step, in order. The driver empties the list and frees it at last. */
struct sched_actions {
    struct sched_action *at;
    size_t n, cap;
};
void sched_act(
    struct sched_actions *out, enum sched_action_kind kind, int32_t slot, const struct task *task);

#define SCHED_WAITING_MOST 65536 /* undispatched tasks: the driver pauses its input */
#define SCHED_DEPTH_AUTO (-1)
#define SCHED_LOSSES 3 /* slots that a task may cost before it is put aside, by default */
struct sched_params {
    int32_t depth;   /* -q: tasks a slot may hold beyond those it computes, or SCHED_DEPTH_AUTO */
    bool endgame;    /* -e: cut the last tasks smaller and give them to more than one slot */
    double least_us; /* -t: least time of a piece, and of a task out before it is copied; 0: none */
    int32_t losses;  /* -l: slots that a task may cost before it is put aside; 0: SCHED_LOSSES */
};

struct policy {
    const char *name;
    void *(*create)(const struct sched_params *p);
    void (*step)(
        void *state, const struct sched_event *e, int64_t now_us, struct sched_actions *out);
    /* Uncommitted tasks of this generation. No generation equal to it modulo GENERATIONS may have
     * any. */
    int32_t (*uncommitted)(const void *state, uint32_t generation);
    /* Tasks not yet dispatched; the driver pauses its input at SCHED_WAITING_MOST. */
    int64_t (*waiting)(const void *state);
    /* Attempt number of the copy that this slot holds, from 1; 0: it holds none. */
    int32_t (*tries)(const void *state, int32_t slot, uint32_t frame, uint32_t id);
    /* Time at which the policy wants SCHED_WAKE; INT64_MAX: none. A NULL pointer: never. */
    int64_t (*wake_us)(const void *state);
    void (*destroy)(void *state);
    bool joins; /* slots may join the run and leave it */
};

static inline int64_t sched_uncommitted(const struct policy *p, const void *state)
{
    int64_t n = 0;
    for (uint32_t g = 0; g < GENERATIONS; g++) n += p->uncommitted(state, g);
    return n;
}
/*
 * True if the oldest live generation may advance from `from` to `oldest`: no task of the
 * generations before `oldest` is uncommitted. This limits the generations that are alive at once
 * (wire.h); no slot waits at the end of a generation.
 */
bool sched_admits(const struct policy *p, const void *state, uint32_t from, uint32_t oldest);

extern const struct policy policy_deal;
extern const struct policy policy_ring;      /* the hub */
extern const struct policy policy_published; /* the master of the ring as published */
extern const struct policy policy_node;      /* a node of either ring, as its PLACE states */

#endif
