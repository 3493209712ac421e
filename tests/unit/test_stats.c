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
    near(stats_lower_bound(c, 8, v, 2), 4);
    double w[] = {1, 3};
    near(stats_lower_bound(c, 8, w, 2), 2);
}

static void bound_is_the_longest_piece_on_the_fastest_slot(void **state)
{
    (void)state;
    double c[] = {1, 10, 1}, v[] = {1, 2};
    near(stats_lower_bound(c, 3, v, 2), 5);
    double two[] = {9, 9, 1}, three[] = {1, 3, 3};
    near(stats_lower_bound(two, 3, three, 3), 3); /* (9 + 9) / (3 + 3) and 9 / 3 */
}

static void bound_of_one_slot_or_of_nothing(void **state)
{
    (void)state;
    double c[] = {2, 3}, v[] = {.5};
    near(stats_lower_bound(c, 2, v, 1), 10);
    near(stats_lower_bound(c, 0, v, 1), 0);
    double one[] = {6}, many[] = {1, 1, 2};
    near(stats_lower_bound(one, 1, many, 3), 3); /* one piece is not split */
}

static void bound_of_kinds_of_pieces(void **state)
{
    (void)state;
    struct pieces p[] = {{1, 3}, {4, 2}, {0, 0}};
    double c[] = {1, 4, 1, 1, 4}, v[] = {3, 1, 1}, w[] = {1, 3, 1};
    near(stats_lower_bound_pieces(p, 3, v, 3), stats_lower_bound(c, 5, w, 3));
    struct pieces few[] = {{9, 1}, {5, 1}};
    double slow[] = {1, 1, 1, 1};
    near(stats_lower_bound_pieces(few, 2, slow, 4), 9);
    struct pieces many[] = {{2, 1000}};
    near(stats_lower_bound_pieces(many, 1, slow, 4), 500);
}

static void all_time_is_accounted_for(void **state)
{
    (void)state;
    struct span at[] = {
        {.slot = 0, .end_s = 3, .took_s = 2},                 /* idle until 1 */
        {.slot = 1, .end_s = 5, .took_s = 4, .wasted = true}, /* idle until 1 */
        {.slot = 0, .end_s = 6, .took_s = 2},                 /* waited for 1 */
        {.slot = 0, .end_s = 9, .took_s = 3.5},               /* overlaps: from 6 on */
        {.run = 1, .slot = 1, .end_s = 2, .took_s = 7},       /* not before the run began */
    };
    struct times of[3];
    double run_s[2];
    stats_timeline(at, 5, of, 3, run_s, 2);
    near(run_s[0], 9);
    near(run_s[1], 2);
    near(at[3].begin_s, 6);
    near(at[4].begin_s, 0);
    const double expected[3][5] = {{7, 0, 1 + 2, 1, 0}, {2, 4, 1, 0, 4}, {0, 0, 11, 0, 0}};
    for (int k = 0; k < 3; k++) {
        near(of[k].busy_s, expected[k][0]);
        near(of[k].wasted_s, expected[k][1]);
        near(of[k].startup_s, expected[k][2]);
        near(of[k].waiting_s, expected[k][3]);
        near(of[k].tail_s, expected[k][4]);
    }
}

static void without_a_clock_tasks_follow_each_other(void **state)
{
    (void)state;
    struct span at[] = {{.end_s = -1, .took_s = 2}, {.end_s = -1, .took_s = 3},
        {.run = 1, .end_s = -1, .took_s = 1}};
    struct times of[1];
    double run_s[2];
    stats_timeline(at, 3, of, 1, run_s, 2);
    near(run_s[0], 5);
    near(run_s[1], 1);
    near(at[1].begin_s, 2);
    near(of[0].busy_s, 6);
    near(of[0].startup_s + of[0].waiting_s + of[0].tail_s + of[0].wasted_s, 0);
    stats_timeline(NULL, 0, of, 1, run_s, 0);
    near(of[0].startup_s, 0);
}

static void moments(void **state)
{
    (void)state;
    double x[] = {4, 1, 3, 2}, y[] = {5, 1, 9};
    near(stats_mean(x, 4), 2.5);
    near(stats_variance(x, 4), 5. / 3);
    near(stats_variance(x, 1), 0);
    near(stats_median(x, 4), 2.5);
    near(stats_median(y, 3), 5);
    near(stats_median(y, 0), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bound_is_the_sum_when_pieces_are_small),
        cmocka_unit_test(bound_is_the_longest_piece_on_the_fastest_slot),
        cmocka_unit_test(bound_of_one_slot_or_of_nothing),
        cmocka_unit_test(bound_of_kinds_of_pieces),
        cmocka_unit_test(all_time_is_accounted_for),
        cmocka_unit_test(without_a_clock_tasks_follow_each_other),
        cmocka_unit_test(moments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
