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

/* The lowest of equals. */
static int32_t searched(const struct tournament *t, int32_t n, const struct tournament_filter *f)
{
    int32_t best = -1;
    for (int32_t k = 0; k < n; k++) {
        double most = best < 0 ? (double)INFINITY : tournament_key(t, best);
        if (f->may && !f->may(f->context, k)) continue;
        if (f->under && tournament_key(f->under, k) >= f->limit) continue;
        if (tournament_key(t, k) < most) best = k;
    }
    return best;
}

/* Keys are small whole numbers, so that many are equal. */
static void finds_the_least(void **state)
{
    (void)state;
    for (int seed = 0; seed < rounds(400); seed++) {
        struct tournament t, other;
        bool allowed[MOST];
        const struct tournament_filter all = {.may = NULL},
                                       some = {.may = is_allowed, .context = allowed};
        uint64_t drawn = 0;
        int32_t n = 1 + (int32_t)(rng_unit((uint64_t)seed, ++drawn) * MOST);
        tournament_init(&t, n);
        tournament_init(&other, n);
        assert_int_equal(tournament_least(&t, NULL), -1);
        for (int step = 0; step < 200; step++) {
            int32_t k = (int32_t)(rng_unit((uint64_t)seed, ++drawn) * n);
            double key = floor(20 * rng_unit((uint64_t)seed, ++drawn)) - 10;
            tournament_set(&t, k, key > 5 ? (double)INFINITY : key);
            for (int32_t i = 0; i < n; i++) allowed[i] = rng_unit((uint64_t)seed, ++drawn) < .3;
            tournament_set(&other, k, floor(10 * rng_unit((uint64_t)seed, ++drawn)));
            const struct tournament_filter under = {.under = &other, .limit = step % 10};
            int32_t best = tournament_least(&t, NULL);
            assert_int_equal(best, searched(&t, n, &all));
            if (best >= 0) assert_true(tournament_top(&t) >= tournament_key(&t, best));
            assert_int_equal(tournament_least(&t, &some), searched(&t, n, &some));
            assert_int_equal(tournament_least(&t, &under), searched(&t, n, &under));
        }
        tournament_free(&t);
        tournament_free(&other);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(finds_the_least)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
