/* Methods by name, and their runs by seeds. */
#include "sim/sim.h"

#include <string.h>

const struct sim_method *sim_method_named(const char *name)
{
    static const struct sim_method table[] = {
        {.name = "fan", .policy = &sim_fan, .options = ""},
        {.name = "best", .policy = &sim_fan, .options = "", .best = true},
        {.name = "adaptive",
            .policy = &policy_deal,
            .params = {.depth = SCHED_DEPTH_AUTO, .endgame = true},
            .options = "",
            .tuned = true},
        {.name = "deal", .policy = &policy_deal, .options = "eqt"},
        {.name = "ring", .policy = &policy_ring, .node = &policy_node, .options = "ep"},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        if (strcmp(name, table[i].name) == 0) return &table[i];
    return NULL;
}

int64_t sim_run_seeds(const struct sim_method *m, uint64_t first, int64_t seeds,
    void (*trace)(const char *line), struct sim_result *sum)
{
    struct sim_result r;
    *sum = (struct sim_result){.trace_hash = HASH64_INIT};
    for (int64_t i = 0; i < seeds; i++) {
        uint64_t seed = first + (uint64_t)i;
        struct sim_plan plan = m->node ? sim_ring_plan_of(seed) : sim_plan_of(seed);
        if (m->tuned) plan.params = m->params, plan.width = 1;
        plan.trace = trace;
        plan.checks = m->checks;
        sim_run(m->policy, &plan, &r);
        sim_add(sum, &r);
        if (!*r.failure) continue;
        memcpy(sum->failure, r.failure, sizeof sum->failure);
        return i;
    }
    return seeds;
}
