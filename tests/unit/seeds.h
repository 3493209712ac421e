/*
 * What tests of a policy in virtual time under seeded faults have in common. `test_NAME SEED` runs
 * one seed and says what happened; `test_NAME` runs seeds 0 .. 999 (fewer under sanitizers), and
 * ends at the first that fails. FIRST and SEEDS in the environment are another seed to begin with
 * and another number. The file that includes it defines the functions declared first, and
 * SEEDS_TEST, the test's name.
 */
#ifndef STORMRING_TESTS_SEEDS_H
#define STORMRING_TESTS_SEEDS_H

#include "rounds.h"
#include "sim/sim.h"

/* False where it failed; why is in r->failure. */
static bool run_seed(uint64_t seed, struct sim_result *r);
static void note_seed(uint64_t seed, const struct sim_result *r);
/* The plan, and what happened, without a line's end. */
static void say_seed(uint64_t seed, const struct sim_result *r);

static bool seeds_hold;   /* every one of them; else the other tests have nothing to say */
static int64_t seeds_run; /* below 1000, few faults happen */

static bool try_seed(uint64_t seed, struct sim_result *r)
{
    bool good = run_seed(seed, r);
    if (!good)
        print_error("%s\nto repeat: build/unit/" SEEDS_TEST " %llu\n", r->failure,
            (unsigned long long)seed);
    return good;
}

/* A number of the environment. */
static int64_t seeds_number(const char *name, int64_t least, int64_t usual)
{
    const char *text = getenv(name);
    if (text && !parse_int(text, least, 1000000000, &usual)) fail_msg("%s=%s", name, text);
    return usual;
}

/* How many were wanted. */
static int64_t run_seeds(void)
{
    int64_t seeds = seeds_number("SEEDS", 1, rounds(1000));
    int64_t first = seeds_number("FIRST", 0, 0);
    seeds_hold = true;
    seeds_run = seeds;
    for (int64_t seed = first; seed < first + seeds && seeds_hold; seed++) {
        struct sim_result r;
        seeds_hold = try_seed((uint64_t)seed, &r);
        note_seed((uint64_t)seed, &r);
    }
    return seeds;
}

static void a_seed_is_one_run_exactly(void **state)
{
    (void)state;
    if (!seeds_hold) skip();
    uint64_t first = (uint64_t)seeds_number("FIRST", 0, 0);
    for (uint64_t seed = first; seed < first + (uint64_t)rounds(60); seed++) {
        struct sim_result a, b;
        try_seed(seed, &a);
        try_seed(seed, &b);
        assert_true(a.trace_hash == b.trace_hash && a.events == b.events && a.end_us == b.end_us);
    }
}

/* The exit status of `test_NAME SEED`. */
static int one_seed(const char *text)
{
    struct sim_result r;
    int64_t seed;
    if (!parse_int(text, 0, INT64_MAX, &seed)) return 2;
    bool good = try_seed((uint64_t)seed, &r);
    printf("seed %lld: ", (long long)seed);
    say_seed((uint64_t)seed, &r);
    printf(", end %lld us, trace %016llx: %s\n", (long long)r.end_us,
        (unsigned long long)r.trace_hash, *r.failure ? r.failure : "complete");
    return !good;
}

#endif
