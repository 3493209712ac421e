/*
 * The ring as published, in virtual time. `test_gdc SEED` runs one seed and prints what happened;
 * `test_gdc` runs seeds 0 .. 999 (SEEDS in the environment: another number). Every second
 * one has no faults, and has to be complete. In the others slots fail and messages are lost,
 * doubled and late, as datagrams are; there the rules of the paper must be kept to the letter, and
 * how it ends is counted.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "sim/sim.h"

#include <string.h>

static bool is_kind(uint64_t seed) { return seed % 2 == 0; }

static struct sim_plan plan_of(uint64_t seed)
{
    struct sim_plan p = sim_ring_plan_of(seed);
    p.checks = &sim_checks_gdc;
    p.detect_us = 20000000;
    p.p_false = 0; /* the paper's master takes a node's word */
    if (seed % 4 == 3) p.p_lose = p.p_double = p.p_late = .05;
    if (seed % 8 == 4) p.cost_us = 50000; /* a row may look like a crash */
    if (is_kind(seed)) {
        p.p_crash = p.p_silence = p.p_pause = p.p_slow = p.p_kill = 0;
        p.p_return = p.p_twice = p.p_garbage = 0;
    }
    return p;
}

/* Without faults, a row is computed twice only where somebody was taken for dead. */
static bool run_seed(uint64_t seed, struct sim_result *r)
{
    struct sim_plan plan = plan_of(seed);
    sim_run(&policy_published, &plan, r);
    bool incomplete = strncmp(r->failure, "the run did not end", 19) == 0;
    if (!*r->failure && is_kind(seed) && !r->reports && r->computed != r->commits)
        snprintf(r->failure, sizeof r->failure, "%lld rows computed, of %lld",
            (long long)r->computed, (long long)r->commits);
    if (!*r->failure || (incomplete && !is_kind(seed))) return true;
    print_error("%s\nto repeat: build/unit/test_gdc %llu\n", r->failure, (unsigned long long)seed);
    return false;
}

struct outcome {
    int64_t seeds, complete, twice, rows, lost_rows, reports, steals, messages;
    int64_t lost, doubled, late, crashes, silences, pauses, returns;
};

static void note(struct outcome *o, const struct sim_result *r)
{
    o->seeds++;
    o->complete += !r->uncommitted;
    o->twice += !r->uncommitted && r->computed > r->commits;
    o->rows += r->commits;
    o->lost_rows += r->uncommitted;
    o->reports += r->reports;
    o->steals += r->steals;
    o->messages += r->messages;
    o->lost += r->lost;
    o->doubled += r->doubled;
    o->late += r->late;
    o->crashes += r->crashes;
    o->silences += r->silences;
    o->pauses += r->pauses;
    o->returns += r->returns;
}

static void say(const char *which, const struct outcome *o)
{
    print_message(
        "# %lld seeds %s: %lld complete, %lld of these with rows computed twice; %lld rows, "
        "%lld more missing; "
        "%lld steals, %lld messages, %lld lost, %lld doubled, %lld late; %lld crashes, "
        "%lld silences, %lld pauses, %lld comings up; %lld taken for dead\n",
        (long long)o->seeds, which, (long long)o->complete, (long long)o->twice, (long long)o->rows,
        (long long)o->lost_rows, (long long)o->steals, (long long)o->messages, (long long)o->lost,
        (long long)o->doubled, (long long)o->late, (long long)o->crashes, (long long)o->silences,
        (long long)o->pauses, (long long)o->returns, (long long)o->reports);
}

static struct outcome kind, cruel;

static void every_seed_keeps_the_rules_and_without_faults_completes(void **state)
{
    (void)state;
    const char *text = getenv("SEEDS");
    int64_t seeds = 1000;
    if (text && !parse_int(text, 1, 100000000, &seeds)) fail_msg("SEEDS=%s", text);
    int64_t failed = 0;
    for (int64_t seed = 0; seed < seeds && !failed; seed++) {
        struct sim_result r;
        failed += !run_seed((uint64_t)seed, &r);
        note(is_kind((uint64_t)seed) ? &kind : &cruel, &r);
    }
    say("without faults", &kind);
    say("with faults", &cruel);
    if (failed) cruel.seeds = 0; /* the other tests have nothing to say */
    assert_int_equal(failed, 0);
}

/* A simulation that meets no fault proves nothing. */
static void faults_of_every_kind_happened(void **state)
{
    (void)state;
    if (cruel.seeds < 500) skip();
    assert_int_equal(kind.complete, kind.seeds);
    assert_true(kind.steals > 1000 && kind.messages > 10000 && kind.reports > 0);
    assert_true(cruel.crashes > 100 && cruel.silences > 100 && cruel.pauses > 100);
    assert_true(cruel.lost > 100 && cruel.doubled > 100 && cruel.late > 100);
    assert_true(cruel.returns > 100 && cruel.reports > 100);
    /* It does recover, not always, and not without doing things twice. */
    assert_true(cruel.complete > 10 && cruel.complete < cruel.seeds && cruel.twice > 10);
}

static void a_seed_is_one_run_exactly(void **state)
{
    (void)state;
    if (!cruel.seeds) skip();
    for (uint64_t seed = 0; seed < 60; seed++) {
        struct sim_result a, b;
        run_seed(seed, &a);
        run_seed(seed, &b);
        assert_true(a.trace_hash == b.trace_hash && a.events == b.events && a.end_us == b.end_us);
    }
}

/* ---- the paper's own test -------------------------------------------------------------------- */

#define ROWS 512
#define HOSTS 9

/*
 * "9 workstations are added in the PVM's environment. After the master process gathered 300
 * scanlines from the slave processes, two workstations (i.e. two Sparc 20) are deleted." Whichever
 * two of the four these are.
 */
static void two_of_nine_hosts_are_removed_after_300_rows(void **state)
{
    static const double power[HOSTS] = {.77, .77, .77, 1, 1, 1.96, 1.96, 1.96, 1.96};
    static double row_us[ROWS];
    static struct task rows[ROWS];
    (void)state;
    for (uint32_t y = 0; y < ROWS; y++) {
        rows[y] = (struct task){0, y, {0, y, 1, 1, 1, 1}, -1};
        row_us[y] = 170e6 / ROWS * (.5 + rng_unit(3, y)); /* 12.15 hosts need 14 seconds */
    }
    struct sim_work work = {
        .frame_w = 1, .frame_h = ROWS, .tasks = rows, .pixel_us = row_us, .power = power};
    for (int32_t a = 5; a < HOSTS; a++) {
        for (int32_t b = a + 1; b < HOSTS; b++) {
            struct sim_fault faults[2] = {
                {.kind = SIM_CRASH, .slot = a, .at_us = -1, .commits = 300},
                {.kind = SIM_CRASH, .slot = b, .at_us = -1, .commits = 300}};
            struct sim_plan plan = {.seed = 1,
                .node = &policy_node,
                .checks = &sim_checks_gdc,
                .slots = HOSTS,
                .tasks = ROWS,
                .width = 1,
                .latency_us = 500,
                .hops = 2,
                .silence_us = 3000000,
                .faults = faults,
                .n_faults = 2,
                .work = &work};
            struct sim_result r;
            sim_run(&policy_published, &plan, &r);
            if (*r.failure) print_error("hosts %d and %d removed: %s\n", a, b, r.failure);
            print_message("# hosts %d and %d removed: %.1f s, %lld rows computed\n", a, b,
                (double)r.end_us / 1e6, (long long)r.computed);
            assert_true(!*r.failure && r.crashes == 2 && r.commits == ROWS);
        }
    }
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        struct sim_result r;
        int64_t seed;
        if (!parse_int(argv[1], 0, INT64_MAX, &seed)) return 2;
        bool good = run_seed((uint64_t)seed, &r);
        struct sim_plan p = plan_of((uint64_t)seed);
        printf(
            "seed %lld: %d nodes, %d rows: %lld events, %lld messages, %lld steals, %lld commits, "
            "%lld crashes, end %lld us, trace %016llx: %s\n",
            (long long)seed, p.slots, p.tasks, (long long)r.events, (long long)r.messages,
            (long long)r.steals, (long long)r.commits, (long long)r.crashes, (long long)r.end_us,
            (unsigned long long)r.trace_hash, *r.failure ? r.failure : "complete");
        return !good;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_seed_keeps_the_rules_and_without_faults_completes),
        cmocka_unit_test(faults_of_every_kind_happened),
        cmocka_unit_test(a_seed_is_one_run_exactly),
        cmocka_unit_test(two_of_nine_hosts_are_removed_after_300_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
