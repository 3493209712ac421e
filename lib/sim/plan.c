/* Makes up a plan from a seed. */
#include "sim/sim.h"

static double unit(uint64_t seed, uint64_t k) { return rng_unit(seed, 1000 + k); }

static int32_t pick(uint64_t seed, uint64_t k, int32_t least, int32_t most)
{
    return least + (int32_t)(unit(seed, k) * (most - least + 1));
}

/* A fault is absent in half of the plans, and sometimes nearly certain. */
static double chance(uint64_t seed, uint64_t k, double usual)
{
    double u = unit(seed, k);
    return u < .5 ? 0 : u < .9 ? usual : .9;
}

/* No faults; the depth follows a long link and must hide it. */
static void calm(struct sim_plan *p, bool tiny)
{
    p->calm = !tiny;
    p->params.depth = SCHED_DEPTH_AUTO;
    if (tiny) p->params.endgame = p->seed % 1000 > 500;
    p->width = 1;
    p->slots = tiny ? 1 : pick(p->seed, 2, 2, 8);
    p->tasks = tiny ? 6000 : 300 * p->slots;
    p->cost_us = tiny ? 5 : 1000;
    p->link.latency_us = tiny ? 200000 : 50000;
    p->concentrate = false;
    p->assigned = 0;
    p->rows = p->frames = 1;
    p->p_crash = p->p_silence = p->p_pause = p->p_slow = p->p_hang = p->p_kill = 0;
    p->p_return = p->p_twice = p->p_garbage = p->p_drain = 0;
    p->joins = p->poison = 0;
    p->p_refuse = 0;
    p->start = (struct sim_start){0};
}

struct sim_plan sim_plan_of(uint64_t seed)
{
    static const int32_t depths[] = {0, 0, 1, 2, 16, SCHED_DEPTH_AUTO, SCHED_DEPTH_AUTO};
    static const int64_t latencies_us[] = {0, 100, 5000, 200000};
    struct sim_plan p = {.seed = seed, .cost_us = 1000, .faults_us = 4000000, .hops = 2};
    p.jitter = .5;
    p.slots = unit(seed, 1) < .3 ? pick(seed, 2, 1, 3) : pick(seed, 2, 2, 24);
    p.tasks = unit(seed, 3) < .1 ? pick(seed, 4, 0, 3) : pick(seed, 4, 1, 200);
    p.params.depth = depths[pick(seed, 5, 0, 6)];
    p.assigned = unit(seed, 6) < .5 ? 0 : pick(seed, 7, 0, p.tasks);
    p.concentrate = unit(seed, 8) < .3;
    p.p_crash = chance(seed, 9, .3);
    p.p_silence = chance(seed, 10, .3);
    p.p_pause = chance(seed, 11, .3);
    p.p_return = chance(seed, 12, .5);
    p.p_twice = chance(seed, 13, .1);
    p.p_garbage = chance(seed, 14, .1);
    p.silence_us = 3000000;
    p.link.latency_us = latencies_us[pick(seed, 15, 0, 3)];
    p.params.endgame = unit(seed, 16) < .4;
    p.width = p.params.depth >= 0 && unit(seed, 19) < .2 ? pick(seed, 20, 2, 4) : 1;
    p.rows = unit(seed, 17) < .7 ? 1 : pick(seed, 18, 2, 5);
    p.p_slow = chance(seed, 21, .3);
    p.p_kill = chance(seed, 22, .3);
    if (p.params.endgame && unit(seed, 44) < .3) p.params.least_us = 20000;
    p.p_hang = p.params.endgame ? chance(seed, 25, .5) : 0;
    p.frames = unit(seed, 23) < .6 ? 1 : pick(seed, 24, 2, 20);
    p.window = pick(seed, 26, 2, 16);
    if (unit(seed, 40) < .25) p.p_drain = unit(seed, 41) < .5 ? .4 : .9;
    if (unit(seed, 42) < .25) p.joins = pick(seed, 43, 1, p.slots) - 1;
    p.tells_power = unit(seed, 44) < .5;
    if (unit(seed, 45) < .25)
        p.start = (struct sim_start){.build_s = .1 * unit(seed, 46), .spread = 4};
    if (unit(seed, 47) < .15) p.poison = pick(seed, 48, 1, 3);
    if (unit(seed, 49) < .1) p.p_refuse = unit(seed, 50);
    if (seed % 100 == 50) calm(&p, false);
    if (seed % 500 == 99) calm(&p, true);
    return p;
}

struct sim_plan sim_ring_plan_of(uint64_t seed)
{
    struct sim_plan p = sim_plan_of(seed);
    p.p_refuse = 0; /* the checks of the ring do not know it: test_poison */
    p.node = &policy_node;
    p.calm = false;
    p.p_hang = chance(seed, 25, .3);
    if (p.p_hang > 0) p.detect_us = 5000000;
    p.params = (struct sched_params){.endgame = unit(seed, 32) < .5};
    p.slots = unit(seed, 1) < .3 ? pick(seed, 2, 1, 4) : pick(seed, 2, 2, 64);
    if (unit(seed, 3) >= .1) p.tasks = pick(seed, 4, 1, 200);
    if (p.assigned > p.tasks) p.assigned = p.tasks;
    p.joins = unit(seed, 42) < .25 ? pick(seed, 43, 1, p.slots) - 1 : 0;
    p.width = unit(seed, 19) < .2 ? pick(seed, 20, 2, 4) : 1;
    p.p_false = fmin(p.p_garbage, .1);       /* each can cause the next: more would never end */
    if (unit(seed, 31) < .03) p.p_crash = 1; /* of all slots but one */
    return p;
}
