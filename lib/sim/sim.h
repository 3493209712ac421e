/*
 * sim: policies in virtual time. The shipped object code of a policy is driven by a model of what
 * lies behind it: a fan, FIFO links with latency, slots of unequal power, and seeded faults. One
 * seed is one run, exactly; the same seed gives the same event trace, whose hash is returned.
 *
 * What is checked after every event:
 *
 *   commit    a task commits once, and only when all of its pixels were passed on
 *   give      only to a slot that is up, only what is to do, from the pool only up to the depth;
 *             what somebody has already only to a slot that has nothing, when the input has ended
 *             and nothing waits, and only up to SIM_COPIES_MOST times at once
 *   withheld  what is computed elsewhere, only in an endgame, when that slot is busy, or was asked
 *             for its pixels, and only to a slot that owes none
 *   pieces    of tasks only in an endgame; under new ids, inside one task, beside each other
 *   idle      in an endgame no slot has nothing to do while something may still be copied
 *   revoked   with the depth that follows the link, and the input ended, no slot has more in store
 *             than twice its share of what waits
 *   end       once, when everything is committed; it stops the slots where one is still busy; it
 *             comes within the time that the work, the faults and the slowest slot allow
 */
#ifndef STORMRING_SIM_H
#define STORMRING_SIM_H

#include "sched/sched.h"

#define SIM_SLOTS_MOST 64
#define SIM_COPIES_MOST 3

/* What is to be rendered where a plan does not make it up: for measurements. */
struct sim_work {
    uint32_t frame_w, frame_h;
    const struct task *tasks; /* ids 0 .. n-1 of frame 0, in any order */
    const double *pixel_us;   /* what a pixel costs at power 1, row by row */
    const double *power;      /* of the slots */
    double task_us;           /* what a task costs its worker besides, at power 1 */
    int32_t slow_slot;        /* which slows down, or -1: */
    int64_t slow_at_us;       /* a task that it begins at or after this time */
    double slow_power;        /* is computed at this power instead */
};

/* Chances are per slot, or per answer; times in microseconds of virtual time. */
struct sim_plan {
    uint64_t seed;
    int32_t slots, tasks;
    int32_t rows;     /* of FRAME_W pixels, a task */
    int32_t depth;    /* the policy's */
    int32_t width;    /* tasks that a slot says it is on at once */
    bool endgame;     /* likewise */
    int32_t assigned; /* so many tasks have to=K */
    bool concentrate; /* slots hand over pixels on a flush only */
    double cost_us;   /* the least that a row costs at power 1; the most is exp(4) times that */
    double p_crash;   /* a slot dies; EOF is seen */
    double p_stall;   /* a slot falls silent; the fan gives it up after silence_us */
    double p_pause;   /* a slot is silent for less than that */
    double p_return;  /* a lost slot comes back */
    double p_twice;   /* an answer is sent twice */
    double p_garbage; /* an answer names what was not asked */
    bool calm;        /* no faults, and enough to do: it must take little longer than the bound */
    int64_t silence_us, latency_us;
    const struct sim_work *work; /* NULL: rows of random cost */
};
/* Everything above from the seed alone: small and large, kind and cruel. Slot 0 is never lost. */
struct sim_plan sim_plan_of(uint64_t seed);

struct sim_result {
    char failure[200]; /* empty: every check held */
    int64_t end_us;
    uint64_t trace_hash;
    int64_t events, gives, commits, crashes, stalls, pauses, twice, garbage, returns, flushes;
    int64_t copies, pieces, stops; /* gives of what another has; pieces given; ends that stop */
    int64_t withheld;              /* gives of what is computed elsewhere */
};

void sim_run(const struct policy *policy, const struct sim_plan *plan, struct sim_result *result);

#endif
