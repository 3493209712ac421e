/* What samples tell: against closed forms, printed tables and draws. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "inference/inference.h"

static void near(double got, double expected) { assert_true(fabs(got - expected) < 1e-12); }
static void close_to(double got, double expected, double tolerance)
{
    if (!(fabs(got - expected) <= tolerance)) fail_msg("got %.12g, not %.12g", got, expected);
}

/* Half the width of the interval at level 2 p - 1 of dof + 1 samples whose mean has error 1. */
static double t_of(double p, size_t dof)
{
    size_t n = dof + 1;
    double *x = xcalloc(n, sizeof *x);
    x[0] = sqrt((double)n * (double)dof / 2);
    x[1] = -x[0];
    double half = inference_mean(x, n, 2 * p - 1).high;
    free(x);
    return half;
}

/* One and two degrees of freedom have closed forms; the rest is of printed tables. */
static void quantiles_of_t(void **state)
{
    (void)state;
    const double pi = 3.14159265358979323846;
    for (double p = .501; p < .9996; p += .0331) {
        close_to(t_of(p, 1), tan(pi * (p - .5)), 1e-9 * (1 + tan(pi * (p - .5))));
        close_to(t_of(p, 2), (2 * p - 1) / sqrt(2 * p * (1 - p)), 1e-9);
    }
    static const struct {
        double p;
        size_t dof;
        double t;
    } table[] = {{.9995, 1, 636.619}, {.9995, 2, 31.599}, {.9995, 4, 8.610}, {.9995, 9, 4.781},
        {.9995, 14, 4.140}, {.9995, 29, 3.659}, {.9995, 49, 3.500}, {.975, 1, 12.706},
        {.975, 10, 2.228}, {.975, 30, 2.042}, {.975, 120, 1.980}, {.95, 5, 2.015}, {.95, 60, 1.671},
        {.995, 7, 3.499}, {.5, 3, 0}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        close_to(t_of(table[i].p, table[i].dof), table[i].t, 5.1e-4);
    close_to(t_of(.975, 1000000), 1.959964, 3e-6); /* the normal distribution's */
}

/* The sum of twelve even draws: nearly normal, with variance 1. */
static double normal(uint64_t seed, uint64_t at)
{
    double sum = -6;
    for (uint64_t i = 0; i < 12; i++) sum += rng_unit(seed, 12 * at + i);
    return sum;
}

/* Of 30,000 intervals of 99.9 % some 30 miss, give or take 5.5; here the seeds are fixed. */
static void intervals_cover_as_they_say(void **state)
{
    (void)state;
    enum { RUNS = 30000, N = 15 };
    int missed = 0, missed_by_two = 0, missed_between = 0, missed_spread = 0;
    for (uint64_t run = 0; run < RUNS; run++) {
        double x[N], y[2 * N];
        for (uint64_t i = 0; i < N; i++) x[i] = 7 + 2 * normal(1, run * N + i);
        for (uint64_t i = 0; i < 2 * N; i++) y[i] = 3 + .5 * normal(2, run * 2 * N + i);
        struct interval of = inference_mean(x, N, .999);
        missed += of.low > 7 || of.high < 7;
        of = inference_mean(x, 2, .999);
        missed_by_two += of.low > 7 || of.high < 7;
        struct interval between = inference_difference(x, N, y, 2 * N, .999);
        missed_between += between.low > 4 || between.high < 4;
        for (uint64_t i = 0; i < 2 * N; i++) y[i] *= 4; /* now both vary equally */
        struct interval spread = inference_spread(x, N, y, 2 * N, .99);
        missed_spread += spread.low > 0 || spread.high < 0;
    }
    assert_in_range(missed, 10, 50);
    assert_in_range(missed_by_two, 10, 50);
    assert_in_range(missed_between, 10, 50);
    /* 1 %: distances are not normal, nor quite independent. */
    assert_in_range(missed_spread, RUNS / 100 / 2, RUNS / 100 * 3 / 2);
}

/* 1 .. 5: mean 3, variance 2.5. t of .975 and 4 is 2.7764. */
static void intervals_by_hand(void **state)
{
    (void)state;
    double x[] = {1, 2, 3, 4, 5}, same[] = {2, 2, 2}, wide[] = {0, 10, -10, 20};
    struct interval of = inference_mean(x, 5, .95);
    close_to(of.high - 3, 2.7764 * sqrt(2.5 / 5), 1e-4);
    close_to(of.low + of.high, 6, 1e-12);
    of = inference_mean(same, 3, .999);
    near(of.low, 2);
    near(of.high, 2);
    of = inference_mean(x, 1, .95);
    assert_true(isinf(of.low) && isinf(of.high));
    of = inference_difference(x, 5, same, 3, .95); /* same has no variance: 4 degrees of freedom */
    near(of.estimate, 1);
    close_to(of.high - 1, 2.7764 * sqrt(2.5 / 5), 1e-4);
    of = inference_spread(wide, 4, x, 5, .95); /* distances 5 5 15 15 against 2 1 0 1 2 */
    near(of.estimate, 10 - 1.2);
    double three[] = {1, 2, 3}, two[] = {1, 9};
    of = inference_spread(
        three, 3, two, 2, .5); /* distances 1 0 1 against 4 4: of two, always the same */
    near(of.estimate, 2. / 3 - 4);
    assert_true(isinf(of.low) && isinf(of.high));
}

/* What overflows is not known: no interval that looks sure. */
static void intervals_of_what_is_too_large(void **state)
{
    (void)state;
    double x[] = {1e300, -1e300, 5e299}, y[] = {1e300, 1e299}, few[] = {1e300, -1e300};
    struct interval of = inference_mean(x, 3, .999);
    assert_true(of.low == -HUGE_VAL && of.high == HUGE_VAL);
    of = inference_difference(x, 3, y, 2, .999);
    assert_true(of.low == -HUGE_VAL && of.high == HUGE_VAL);
    of = inference_spread(x, 3, few, 2, .999);
    assert_true(of.low == -HUGE_VAL && of.high == HUGE_VAL);
}

static void outliers(void **state)
{
    (void)state;
    double low, high, x[] = {9, 1, 5, 3, 7}, four[] = {4, 1, 3, 2}, few[] = {1, 2, 1000};
    inference_fences(x, 5, &low, &high); /* quartiles 3 and 7 */
    near(low, 3 - 6);
    near(high, 7 + 6);
    inference_fences(four, 4, &low, &high); /* 1.5 and 3.5 */
    near(low, 1.5 - 3);
    near(high, 3.5 + 3);
    inference_fences(few, 3, &low, &high);
    assert_true(isinf(low) && isinf(high));
    double same[] = {2, 2, 2, 2, 3}; /* the middle half has no width: all else is outside */
    inference_fences(same, 5, &low, &high);
    near(low, 2);
    near(high, 2);
    /* The GDC paper's Sparc 20: 71 to 96 s, and 72.65 in the mean. */
    double sparc[50];
    for (int i = 0; i < 49; i++) sparc[i] = 71 + .05 * i;
    sparc[49] = 96;
    inference_fences(sparc, 50, &low, &high);
    assert_true(low < 71 && high > 73.4 && high < 96);
}

/* ---- points of a table made here: rows of method A, then of method B ------------------------- */

enum { PAIRS = 6 };
struct pairs {
    struct table_row rows[2 * PAIRS];
    struct table_point points[2];
    struct table t;
};

/* B is PAIRS different loads; A is B plus `more`, and varies by `noise` besides. */
static void make_pairs(struct pairs *p, double more, double noise)
{
    *p = (struct pairs){.points = {{.from = 0, .n = PAIRS}, {.from = PAIRS, .n = PAIRS}}};
    for (int i = 0; i < PAIRS; i++) {
        double load = 10 * (i + 1);
        p->rows[i] = (struct table_row){.sample = i, .y = load + more + (i % 2 ? noise : -noise)};
        p->rows[PAIRS + i] = (struct table_row){.sample = i, .y = load};
    }
    p->t = (struct table){.rows = p->rows, .points = p->points, .n_rows = 2 * PAIRS, .n_points = 2};
}

static const char *verdict(enum relation relation, double margin, double more, double noise)
{
    struct pairs p;
    size_t used;
    const struct claim c = {relation, margin, .999};
    make_pairs(&p, more, noise);
    struct interval of = inference_compare(&c, &p.t, &p.points[0], &p.points[1], &used);
    assert_int_equal(used, PAIRS);
    assert_string_equal(inference_verdict(&c, of, 1), "open");
    return inference_verdict(&c, of, used);
}

static void claims_are_decided_by_the_whole_interval(void **state)
{
    (void)state;
    assert_string_equal(verdict(INFERENCE_LESS, 0, -1, .01), "holds");
    assert_string_equal(verdict(INFERENCE_LESS, 0, 1, .01), "fails");
    assert_string_equal(verdict(INFERENCE_LESS, 0, -1, 5), "open");
    assert_string_equal(verdict(INFERENCE_LESS, 0, 0, 0), "fails"); /* the same samples */
    assert_string_equal(verdict(INFERENCE_MORE, 0, 0, 0), "fails");
    assert_string_equal(verdict(INFERENCE_MORE, 0, 1, .01), "holds");
    assert_string_equal(verdict(INFERENCE_MORE, 0, -1, .01), "fails");
    assert_string_equal(verdict(INFERENCE_MORE, 0, 0, .01), "open");
    assert_string_equal(verdict(INFERENCE_SAME, .1, 1, .01), "holds"); /* 1 of 35 */
    assert_string_equal(verdict(INFERENCE_SAME, .02, 1, .01), "fails");
    assert_string_equal(verdict(INFERENCE_SAME, .02, -1, .01), "fails");
    assert_string_equal(verdict(INFERENCE_SAME, 1. / 35, 1, .01), "open");
    assert_string_equal(verdict(INFERENCE_STEADIER, 0, 0, 1000), "fails");
    assert_string_equal(verdict(INFERENCE_STEADIER, 0, 0, 1), "open");
}

static void samples_are_paired_by_number_and_seed(void **state)
{
    (void)state;
    struct pairs p;
    size_t used;
    const struct claim less = {INFERENCE_LESS, 0, .95}, steadier = {INFERENCE_STEADIER, 0, .95};
    make_pairs(&p, 3, 0);
    p.rows[0].seed = 1;           /* now without a partner, and so is B's sample 0 */
    p.rows[PAIRS - 1].sample = 9; /* nor has this one */
    p.rows[PAIRS + 2].outlier = true;
    struct interval of = inference_compare(&less, &p.t, &p.points[0], &p.points[1], &used);
    assert_int_equal(used, PAIRS - 3);
    near(of.low, 3);
    near(of.high, 3);
    inference_compare(&steadier, &p.t, &p.points[0], &p.points[1], &used);
    assert_int_equal(used, PAIRS - 1);
}

static void means_of_points(void **state)
{
    (void)state;
    static const double y[] = {1, 2, 3, 4, 5, 99, 7, .1, .1, .1};
    struct table_row rows[10] = {{0}};
    struct table_point points[] = {
        {.from = 0, .n = 6, .x = {1, 2, 3}}, {.from = 6, .n = 1}, {.from = 7, .n = 3}};
    for (int i = 0; i < 10; i++) rows[i].y = y[i];
    struct table t = {.rows = rows, .points = points, .n_rows = 10, .n_points = 3};
    size_t n;
    double variance;
    struct interval of = inference_point(&t, points, .95, &n, &variance);
    assert_int_equal(n, 6);
    near(of.estimate, 19);
    inference_mark_outliers(&t);
    for (int i = 0; i < 10; i++) assert_int_equal(rows[i].outlier, i == 5);
    of = inference_point(&t, points, .95, &n, &variance);
    assert_int_equal(n, 5);
    near(variance, 2.5);
    inference_means(&t, .95);
    near(points[0].shown.at, 3);
    near(points[0].shown.low, of.low);
    near(points[1].shown.low, 7); /* one sample has no interval */
    near(points[1].shown.high, 7);
    assert_true(points[2].shown.low == .1 && points[2].shown.high == .1); /* rounding adds none */
    assert_true(points[0].x.low == 2 && points[0].x.high == 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantiles_of_t),
        cmocka_unit_test(intervals_cover_as_they_say),
        cmocka_unit_test(intervals_by_hand),
        cmocka_unit_test(intervals_of_what_is_too_large),
        cmocka_unit_test(outliers),
        cmocka_unit_test(claims_are_decided_by_the_whole_interval),
        cmocka_unit_test(samples_are_paired_by_number_and_seed),
        cmocka_unit_test(means_of_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
