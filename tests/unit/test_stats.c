/* Measures against known answers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "stats/stats.h"

static void near(double got, double expected) { assert_true(fabs(got - expected) < 1e-12); }

static void bound_is_the_sum_when_pieces_are_small(void **state)
{
    (void)state;
    double c[] = {1, 1, 1, 1, 1, 1, 1, 1}, v[] = {1, 1};
    near(lower_bound(c, 8, v, 2), 4);
    double w[] = {1, 3};
    near(lower_bound(c, 8, w, 2), 2);
}

static void bound_is_the_longest_piece_on_the_fastest_slot(void **state)
{
    (void)state;
    double c[] = {1, 10, 1}, v[] = {1, 2};
    near(lower_bound(c, 3, v, 2), 5);
    double two[] = {9, 9, 1}, three[] = {1, 3, 3};
    near(lower_bound(two, 3, three, 3), 3); /* (9 + 9) / (3 + 3) and 9 / 3 */
}

static void bound_of_one_slot_or_of_nothing(void **state)
{
    (void)state;
    double c[] = {2, 3}, v[] = {.5};
    near(lower_bound(c, 2, v, 1), 10);
    near(lower_bound(c, 0, v, 1), 0);
    double one[] = {6}, many[] = {1, 1, 2};
    near(lower_bound(one, 1, many, 3), 3); /* one piece is not split */
}

static void moments(void **state)
{
    (void)state;
    double x[] = {4, 1, 3, 2}, y[] = {5, 1, 9};
    near(mean(x, 4), 2.5);
    near(variance(x, 4), 5. / 3);
    near(variance(x, 1), 0);
    near(median(x, 4), 2.5);
    near(median(y, 3), 5);
    near(median(y, 0), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bound_is_the_sum_when_pieces_are_small),
        cmocka_unit_test(bound_is_the_longest_piece_on_the_fastest_slot),
        cmocka_unit_test(bound_of_one_slot_or_of_nothing),
        cmocka_unit_test(moments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
