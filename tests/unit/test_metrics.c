/* image_compare against figures worked out by hand, and against sorting. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "image/image.h"

static void near(double a, double b)
{
    if (!(fabs(a - b) <= 1e-6 * fmax(fabs(a), fabs(b)))) fail_msg("%.9g is not %.9g", a, b);
}

/* Two equal grey pictures, opaque. */
static void pair(struct image *a, struct image *b, uint32_t w, uint32_t h)
{
    image_init(a, w, h);
    for (size_t i = 0; i < (size_t)w * h * 4; i++) a->rgba[i] = i % 4 == 3 ? 1 : 0.5f;
    image_init(b, w, h);
    memcpy(b->rgba, a->rgba, (size_t)w * h * 4 * sizeof(float));
}

static void pair_free(struct image *a, struct image *b)
{
    image_free(a);
    image_free(b);
}

static void test_equal(void **state)
{
    (void)state;
    struct image a, b;
    struct image_diff d;
    pair(&a, &b, 9, 7);
    image_compare(&a, &b, 0, 0.001, &d);
    assert_true(
        d.rmse == 0 && d.rmse_kept == 0 && d.worst == 0 && isinf(d.psnr_db) && d.psnr_db > 0);
    assert_int_equal(d.over + d.differing, 0);
    assert_int_equal(d.pixels, 63);
    pair_free(&a, &b);
}

static void test_figures(void **state)
{
    (void)state;
    struct image a, b;
    struct image_diff d;
    pair(&a, &b, 10, 10);
    b.rgba[4 * 42] += 0.25f;      /* pixel (2, 4), red */
    b.rgba[4 * 17 + 1] -= 0.125f; /* pixel (7, 1), green */
    b.rgba[4 * 99 + 3] = 0.5f;    /* the last, alpha: counts, but not in rmse */
    image_compare(&a, &b, 0.2, 0.01, &d);
    near(d.rmse, sqrt((0.0625 + 0.015625) / 300));
    near(d.psnr_db, -10 * log10((0.0625 + 0.015625) / 300));
    assert_int_equal(d.dropped, 1);
    near(d.rmse_kept, sqrt(0.015625 / 297));
    near(d.worst, 0.5);
    assert_int_equal(d.worst_x, 9);
    assert_int_equal(d.worst_y, 9);
    assert_int_equal(d.over, 2);
    assert_int_equal(d.differing, 3);
    pair_free(&a, &b);
}

/* Exactly the tolerance is not over it; what clamping hides differs, but by nothing. */
static void test_edges(void **state)
{
    (void)state;
    struct image a, b;
    struct image_diff d;
    pair(&a, &b, 4, 1);
    b.rgba[0] = 0.75f;
    a.rgba[4] = 1, b.rgba[4] = 7;
    a.rgba[8] = 0, b.rgba[8] = -3;
    image_compare(&a, &b, 0.25, 0, &d);
    assert_int_equal(d.over, 0);
    assert_int_equal(d.differing, 3);
    near(d.worst, 0.25);
    image_compare(&a, &b, 0.2499, 0, &d);
    assert_int_equal(d.over, 1);
    pair_free(&a, &b);
}

static void test_nan(void **state)
{
    (void)state;
    struct image a, b;
    struct image_diff d;
    pair(&a, &b, 3, 1);
    a.rgba[0] = b.rgba[0] = NAN;
    a.rgba[5] = NAN;
    image_compare(&a, &b, 0.5, 0, &d);
    near(d.worst, 1);
    near(d.rmse, sqrt(1.0 / 9));
    assert_int_equal(d.worst_x, 1);
    assert_int_equal(d.over, 1);
    assert_int_equal(d.differing, 1);
    pair_free(&a, &b);
}

static int ascending(const void *p, const void *q)
{
    double a = *(const double *)p, b = *(const double *)q;
    return (a > b) - (a < b);
}

/* The selection must agree with sorting, with many ties and with few, at every share. */
static void test_kept_is_what_sorting_keeps(void **state)
{
    (void)state;
    enum { W = 50, H = 40, N = W * H };
    struct image a, b;
    struct image_diff d;
    double *error = malloc(N * sizeof *error);
    assert_non_null(error);
    for (unsigned levels = 2; levels < 100000; levels *= 7) {
        pair(&a, &b, W, H);
        for (size_t i = 0; i < N; i++) {
            float off = (float)(rng_u64(levels, i) % levels) / (float)(2 * levels);
            b.rgba[4 * i] = 0.5f + off;
            double e = (double)b.rgba[4 * i] - 0.5;
            error[i] = e * e;
        }
        qsort(error, N, sizeof *error, ascending);
        for (size_t drop = 0; drop < N; drop += 97) {
            double sum = 0;
            for (size_t i = 0; i < N - drop; i++) sum += error[i];
            image_compare(&a, &b, 0, ((double)drop + 0.5) / (double)N, &d);
            assert_int_equal(d.dropped, drop);
            near(d.rmse_kept, sqrt(sum / (3.0 * (double)(N - drop))));
        }
        image_compare(&a, &b, 0, 1, &d);
        assert_true(d.rmse_kept == 0 && d.dropped == N);
        pair_free(&a, &b);
    }
    free(error);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equal),
        cmocka_unit_test(test_figures),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_nan),
        cmocka_unit_test(test_kept_is_what_sorting_keeps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
