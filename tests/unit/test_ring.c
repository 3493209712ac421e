/*
 * The ring, by its default rules, in virtual time under seeded faults. `test_ring SEED` runs one
 * seed and prints what happened; `test_ring` runs seeds 0 .. 999 (SEEDS in the environment: another
 * number), and ends at the first that fails.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "sim/sim.h"

static struct sim_result total;
static int64_t all_but_one; /* seeds in which nearly all nodes were lost */

static bool run_seed(uint64_t seed, struct sim_result *r)
{
    struct sim_plan plan = sim_ring_plan_of(seed);
    sim_run(&policy_ring, &plan, r);
    if (*r->failure)
        print_error(
            "%s\nto repeat: build/unit/test_ring %llu\n", r->failure, (unsigned long long)seed);
    return !*r->failure;
}

static void add(const struct sim_result *r)
{
    total.events += r->events;
    total.gives += r->gives;
    total.commits += r->commits;
    total.crashes += r->crashes;
    total.silences += r->silences;
    total.pauses += r->pauses;
    total.slows += r->slows;
    total.kills += r->kills;
    total.returns += r->returns;
    total.twice += r->twice;
    total.garbage += r->garbage;
    total.messages += r->messages;
    total.steals += r->steals;
    total.passed += r->passed;
    total.flushes += r->flushes;
}

static void every_seed_commits_each_task_once_and_ends(void **state)
{
    (void)state;
    const char *text = getenv("SEEDS");
    int64_t seeds = 1000;
    if (text && !parse_int(text, 1, 100000000, &seeds)) fail_msg("SEEDS=%s", text);
    int64_t failed = 0;
    for (int64_t seed = 0; seed < seeds && !failed; seed++) {
        struct sim_result r;
        failed += !run_seed((uint64_t)seed, &r);
        add(&r);
        all_but_one += r.crashes + r.silences >= sim_ring_plan_of((uint64_t)seed).slots - 1;
    }
    print_message("# %lld seeds: %lld events, %lld tasks given, %lld commits, %lld crashes, "
                  "%lld silences, %lld pauses, %lld slow-downs, %lld hubs killed, "
                  "%lld comings up, %lld answers twice, %lld of garbage, %lld ring messages, "
                  "%lld steals, %lld tasks stolen\n",
        (long long)seeds, (long long)total.events, (long long)total.gives, (long long)total.commits,
        (long long)total.crashes, (long long)total.silences, (long long)total.pauses,
        (long long)total.slows, (long long)total.kills, (long long)total.returns,
        (long long)total.twice, (long long)total.garbage, (long long)total.messages,
        (long long)total.steals, (long long)total.passed);
    if (failed) total.events = 0; /* the other tests have nothing to say */
    assert_int_equal(failed, 0);
}

/* A simulation that meets no fault proves nothing. */
static void faults_of_every_kind_happened(void **state)
{
    (void)state;
    if (!total.events) skip();
    assert_true(total.crashes > 100 && total.silences > 100 && total.pauses > 100);
    assert_true(total.slows > 100 && total.kills > 50 && total.returns > 1000);
    assert_true(total.twice > 1000 && total.garbage > 1000);
    assert_true(total.steals > 1000 && total.passed > 1000 && total.flushes > 100);
    assert_true(all_but_one > 10);
}

static void a_seed_is_one_run_exactly(void **state)
{
    (void)state;
    if (!total.events) skip();
    for (uint64_t seed = 0; seed < 60; seed++) {
        struct sim_result a, b;
        run_seed(seed, &a);
        run_seed(seed, &b);
        assert_true(a.trace_hash == b.trace_hash && a.events == b.events && a.end_us == b.end_us);
    }
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        struct sim_result r;
        int64_t seed;
        if (!parse_int(argv[1], 0, INT64_MAX, &seed)) return 2;
        bool good = run_seed((uint64_t)seed, &r);
        struct sim_plan p = sim_ring_plan_of((uint64_t)seed);
        printf("seed %lld: %d nodes, %d tasks, %d assigned: %lld events, %lld messages, "
               "%lld steals, %lld commits, %lld crashes, end %lld us, trace %016llx: %s\n",
            (long long)seed, p.slots, p.tasks, p.assigned, (long long)r.events,
            (long long)r.messages, (long long)r.steals, (long long)r.commits, (long long)r.crashes,
            (long long)r.end_us, (unsigned long long)r.trace_hash, good ? "good" : r.failure);
        return !good;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_seed_commits_each_task_once_and_ends),
        cmocka_unit_test(faults_of_every_kind_happened),
        cmocka_unit_test(a_seed_is_one_run_exactly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
