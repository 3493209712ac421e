/* deal's policy in virtual time under seeded faults; seeds.h says how it is run. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#define SEEDS_TEST "test_sim"
#include "../oracles/oracles.h"
#include "seeds.h"

static struct sim_result total;

static bool run_seed(uint64_t seed, struct sim_result *r)
{
    struct sim_plan plan = sim_plan_of(seed);
    plan.checks = &oracle_deal;
    sim_run(&policy_deal, &plan, r);
    return !*r->failure;
}

static void note_seed(uint64_t seed, const struct sim_result *r)
{
    (void)seed;
    sim_add(&total, r);
}

static void say_seed(uint64_t seed, const struct sim_result *r)
{
    struct sim_plan p = sim_plan_of(seed);
    printf("%d slots, %d tasks, depth %d%s, %d assigned: %lld events, %lld gives, %lld commits, "
           "%lld crashes, %lld silences",
        p.slots, p.tasks, p.params.depth, p.params.endgame ? " and endgame" : "", p.assigned,
        (long long)r->events, (long long)r->gives, (long long)r->commits, (long long)r->crashes,
        (long long)r->silences);
}

static void every_seed_commits_each_task_once_and_ends(void **state)
{
    (void)state;
    int64_t seeds = run_seeds();
    print_message(
        "# %lld seeds: %lld events, %lld gives, %lld commits, %lld crashes, %lld silences, "
        "%lld pauses, %lld slow-downs, %lld hang, %lld drain, %lld leave, %lld hubs killed, %lld "
        "comings up, %lld answers "
        "twice, %lld "
        "of garbage, %lld copies, %lld pieces, "
        "%lld ends that stop, %lld copies of what was late, %lld slots poisoned, %lld pixels given "
        "up\n",
        (long long)seeds, (long long)total.events, (long long)total.gives, (long long)total.commits,
        (long long)total.crashes, (long long)total.silences, (long long)total.pauses,
        (long long)total.slows, (long long)total.hangs, (long long)total.drains,
        (long long)total.leaves, (long long)total.kills, (long long)total.returns,
        (long long)total.twice, (long long)total.garbage, (long long)total.copies,
        (long long)total.pieces, (long long)total.stops, (long long)total.late_copies,
        (long long)total.poisoned, (long long)total.abandoned);
    assert_true(seeds_hold);
}

/* A simulation that meets no fault proves nothing. */
static void faults_of_every_kind_happened(void **state)
{
    (void)state;
    if (!seeds_hold || seeds_run < 1000) skip();
    assert_true(total.crashes > 100 && total.silences > 100 && total.pauses > 100);
    assert_true(total.slows > 100 && total.kills > 50);
    assert_true(total.hangs > 100 && total.late_copies > 100);
    assert_true(total.drains > 100 && total.leaves > 100 && total.leaves < total.drains);
    assert_true(total.refused > 1000);
    assert_true(total.poisoned > 500 && total.abandoned > 50);
    assert_true(total.twice > 1000 && total.garbage > 1000 && total.gives > total.commits + 100);
    assert_true(
        total.copies > 1000 && total.pieces > 1000 && total.stops > 100 && total.withheld > 100);
}

int main(int argc, char **argv)
{
    if (argc > 1) return one_seed(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_seed_commits_each_task_once_and_ends),
        cmocka_unit_test(faults_of_every_kind_happened),
        cmocka_unit_test(a_seed_is_one_run_exactly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
