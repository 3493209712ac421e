/* Starters: the view, quantiles and deviations of small fields; what is refused. */
#include "spec/spec.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define N 3 /* nodes along each axis */
#define NODES (N * N * N)

static float value[NODES];
static double at[3][N] = {{0, .5, 1}, {0, .5, 1}, {0, .0005, .001}};
static const struct grid g = {
    .n = {N, N, N}, .at = {at[0], at[1], at[2]}, .value = value, .name = "s"};

/* The starter of these values. */
static struct spec starter(enum spec_kind kind)
{
    const struct spec_wish wish = {kind, NULL, 300, 200};
    struct buf b = {0};
    struct spec s = {0};
    char err[ERR_BYTES];
    if (!spec_starter(&g, &wish, &b, err) ||
        spec_read("t", (const char *)buf_data(&b), buf_size(&b), &s, err) != 0)
        fail_msg("%s", err);
    buf_free(&b);
    return s;
}

/* A box of 1 x 1 x .001 with values from 0 to 26. */
static void test_fog(void **state)
{
    (void)state;
    for (int i = 0; i < NODES; i++) value[i] = (float)i;
    struct spec s = starter(SPEC_FOG);
    assert_true(s.w == 300 && s.h == 200 && s.scale[0] == 1 && s.scale[2] == 250);
    assert_true(s.knot[0].s == 0 && s.knot[s.n_knots - 1].s == 26 && !s.n_profile);
    for (size_t i = 1; i < s.n_knots; i++) assert_true(s.knot[i].k >= s.knot[i - 1].k);
    spec_free(&s);

    for (int i = 0; i < NODES; i++) value[i] = i < 20 ? -1 : (float)i; /* one is transparent */
    s = starter(SPEC_FOG);
    assert_true(s.knot[0].s == -1 && s.knot[0].k == 0 && s.knot[1].k > 0);
    assert_true(s.knot[1].s == 20 && s.knot[s.n_knots - 1].s == 26);
    spec_free(&s);

    /* An outlier does not take the colours of the others: the last tenth below it is not dark. */
    for (int i = 0; i < NODES; i++) value[i] = i == 13 ? 1e9F : (float)((i * 7) % NODES);
    s = starter(SPEC_FOG);
    size_t last = s.n_knots - 1;
    while (s.knot[last].s > 25) last--;
    assert_true(s.knot[last].rgb[1] > .3);
    spec_free(&s);
}

static bool transparent(const struct spec *s, double v)
{
    size_t i = 1;
    while (i < s->n_knots && s->knot[i].s < v) i++;
    return s->knot[i - 1].k == 0 && s->knot[i].k == 0;
}

/* A field that falls with height: its deviation from the means is seen. */
static void test_anomaly(void **state)
{
    (void)state;
    for (int i = 0; i < NODES; i++) value[i] = (float)(i % 9 - 4) - 100.F * (float)(i / 9);
    struct spec s = starter(SPEC_AUTO);
    assert_int_equal(s.n_profile, N);
    for (int k = 0; k < N; k++)
        assert_true(s.profile[k].z == at[2][k] && s.profile[k].s == -100. * k);
    assert_true(s.knot[0].s == -4 && s.knot[s.n_knots - 1].s == 4);
    assert_true(transparent(&s, 0) && !transparent(&s, 3.5) && !transparent(&s, -3.5));
    assert_true(s.knot[0].rgb[2] > s.knot[0].rgb[0]); /* blue below, red above */
    assert_true(s.knot[s.n_knots - 1].rgb[0] > s.knot[s.n_knots - 1].rgb[2]);
    spec_free(&s);
    s = starter(SPEC_FOG);
    assert_int_equal(s.n_profile, 0);
    spec_free(&s);

    for (int i = 0; i < NODES; i++) value[i] = (float)(i % 9 - 4); /* both signs: from 0 */
    s = starter(SPEC_AUTO);
    assert_true(!s.n_profile && transparent(&s, 0) && !transparent(&s, -3.5));
    spec_free(&s);

    for (int i = 0; i < NODES; i++) value[i] = (float)(i % 9); /* one sign, and not by height */
    s = starter(SPEC_AUTO);
    assert_true(!s.n_profile && !transparent(&s, 4));
    spec_free(&s);

    for (int i = 0; i < NODES; i++) value[i] = (float)(i / 9); /* nothing is left of it */
    s = starter(SPEC_AUTO);
    assert_true(!s.n_profile && s.n_knots);
    spec_free(&s);
}

static void test_slices_and_surfaces(void **state)
{
    (void)state;
    for (int i = 0; i < NODES; i++) value[i] = (float)(i % 9);
    struct spec s = starter(SPEC_SLICES);
    assert_int_equal(s.n_slices, 3);
    for (size_t i = 0; i < s.n_knots; i++) assert_true(s.knot[i].k == 0);
    for (int a = 0; a < 3; a++)
        assert_true(s.slice[a].axis == a && s.slice[a].at > 0 && s.slice[a].at < at[a][N - 1]);
    spec_free(&s);
    s = starter(SPEC_SURFACES);
    assert_true(s.lit && !s.n_knots && s.n_isos > 1);
    for (size_t i = 0; i < s.n_isos; i++) assert_true(s.iso[i].s > 0 && s.iso[i].s < 8);
    spec_free(&s);
}

/* All values are equal: each kind shows where they are. */
static void test_one_value(void **state)
{
    (void)state;
    for (int i = 0; i < NODES; i++) value[i] = 5;
    for (enum spec_kind kind = SPEC_AUTO; kind <= SPEC_ANOMALY; kind++) {
        struct spec s = starter(kind);
        assert_true(s.n_knots == 2 && s.knot[0].s < 5 && s.knot[1].s > 5 && s.knot[0].k > 0);
        spec_free(&s);
    }
}

static void test_refused(void **state)
{
    (void)state;
    const struct spec_wish wish = SPEC_WISH_DEFAULT;
    struct buf b = {0};
    char err[ERR_BYTES];
    for (int i = 0; i < NODES; i++) value[i] = i == 13 ? (float)NAN : 1;
    assert_false(spec_starter(&g, &wish, &b, err));
    assert_string_equal(err, "each cell has a missing corner, expected one that has none");
    for (int i = 0; i < NODES; i++) value[i] = (float)NAN;
    assert_false(spec_starter(&g, &wish, &b, err));
    assert_string_equal(err, "all values are missing, expected some that are not");
    buf_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fog),
        cmocka_unit_test(test_anomaly),
        cmocka_unit_test(test_slices_and_surfaces),
        cmocka_unit_test(test_one_value),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
