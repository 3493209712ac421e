/*
 * sim: policies in virtual time. The shipped object code of a policy is driven by a model of what
 * lies behind it: a fan, FIFO links with latency, slots of unequal power, and seeded faults. One
 * seed is one run, exactly; the same seed gives the same event trace, whose hash is returned.
 *
 * What is checked after every event: a task commits once, and only when all of its pixels were
 * passed on; work is given only to slots that are up, and from the pool only up to the depth; the
 * end comes when everything is committed, and comes within the time that the work, the faults and
 * the slowest slot allow.
 */
#ifndef STORMRING_SIM_H
#define STORMRING_SIM_H

#include "sched/sched.h"

/* Chances are per slot, or per answer; times in microseconds of virtual time. */
struct sim_plan {
    uint64_t seed;
    int32_t slots, tasks;
    int32_t depth;    /* the policy's */
    int32_t assigned; /* so many tasks have to=K */
    bool concentrate; /* slots hand over pixels on a flush only */
    double p_crash;   /* a slot dies; EOF is seen */
    double p_stall;   /* a slot falls silent; the fan gives it up after silence_us */
    double p_pause;   /* a slot is silent for less than that */
    double p_return;  /* a lost slot comes back */
    double p_twice;   /* an answer is sent twice */
    double p_garbage; /* an answer names what was not asked */
    int64_t silence_us, latency_us;
};
/* Everything above from the seed alone: small and large, kind and cruel. Slot 0 is never lost. */
struct sim_plan sim_plan_of(uint64_t seed);

struct sim_result {
    char failure[200]; /* empty: every check held */
    int64_t end_us;
    uint64_t trace_hash;
    int64_t events, gives, commits, crashes, stalls, pauses, twice, garbage, returns, flushes;
};

void sim_run(const struct policy *policy, const struct sim_plan *plan, struct sim_result *result);

#endif
