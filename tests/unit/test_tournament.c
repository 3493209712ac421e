/* sched: the slot with the least key, beside a search of all. */
#include "sched/tournament.h"

#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "rounds.h"

#define MOST 70

static bool is_allowed(const void *allowed, int32_t k) { return ((const bool *)allowed)[k]; }

static int32_t searched(const struct tournament *t, int32_t n, const bool *allowed)
{
    int32_t best = -1;
    for (int32_t k = 0; k < n; k++) {
        if (allowed && !allowed[k]) continue;
        double most = best < 0 ? (double)INFINITY : tournament_key(t, best);
        if (tournament_key(t, k) < most) best = k;
    }
    return best;
}

static void check(const struct tournament *t, int32_t found, int32_t expected)
{
    assert_int_equal(found < 0, expected < 0);
    if (found >= 0) assert_true(tournament_key(t, found) <= tournament_key(t, expected));
}

/* Keys are small whole numbers, so that many are equal. */
static void finds_the_least(void **state)
{
    (void)state;
    for (int seed = 0; seed < rounds(400); seed++) {
        struct tournament t;
        bool allowed[MOST];
        uint64_t drawn = 0;
        int32_t n = 1 + (int32_t)(rng_unit((uint64_t)seed, ++drawn) * MOST);
        tournament_init(&t, n);
        assert_int_equal(tournament_least(&t, NULL, NULL), -1);
        for (int step = 0; step < 200; step++) {
            int32_t k = (int32_t)(rng_unit((uint64_t)seed, ++drawn) * n);
            double key = floor(20 * rng_unit((uint64_t)seed, ++drawn)) - 10;
            tournament_set(&t, k, key > 5 ? (double)INFINITY : key);
            for (int32_t i = 0; i < n; i++) allowed[i] = rng_unit((uint64_t)seed, ++drawn) < .3;
            check(&t, tournament_least(&t, NULL, NULL), searched(&t, n, NULL));
            int32_t found = tournament_least(&t, is_allowed, allowed);
            check(&t, found, searched(&t, n, allowed));
            assert_true(found < 0 || allowed[found]);
        }
        tournament_free(&t);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(finds_the_least)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
