/* The round trip and task time of a worker as pace measures them over a link, in virtual time. */
#include "sched/pace.h"

#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define TASK_US 10000
#define MOST 256

/* A worker, and when its n queued tasks were sent: sent_us from `first`, modulo MOST. */
struct line {
    struct pace pace;
    int64_t now_us, free_us, sent_us[MOST];
    uint32_t first, n;
    uint64_t drawn;
};

static double draw(struct line *l) { return rng_unit(1, ++l->drawn); }

/* The worker does n tasks, whose times are from 1/7 to 7 times TASK_US, the median, over a link
 * with this round trip; each way takes up to 10 % longer. Returns the measured round trip. */
static double after(struct line *l, int n, double trip_us)
{
    for (int i = 0; i < n; i++) {
        uint32_t depth = 1 + (uint32_t)pace_depth(&l->pace, 1);
        for (; l->n < (depth < MOST ? depth : MOST); l->n++)
            l->sent_us[(l->first + l->n) % MOST] = l->now_us;
        int64_t sent_us = l->sent_us[l->first++ % MOST];
        int64_t here_us = sent_us + (int64_t)(trip_us * (.5 + .05 * draw(l)));
        int64_t wall_us = (int64_t)(TASK_US * exp(4 * draw(l) - 2));
        l->n--;
        l->free_us = (here_us > l->free_us ? here_us : l->free_us) + wall_us;
        int64_t back_us = l->free_us + (int64_t)(trip_us * (.5 + .05 * draw(l)));
        l->now_us = back_us > l->now_us ? back_us : l->now_us;
        const struct pace_task done = {
            .px = 1, .sent_us = sent_us, .done_us = l->now_us, .wall_us = wall_us};
        pace_note(&l->pace, &done);
    }
    return l->pace.round_trip_us;
}

/* The queue follows the measured round trip, which must not follow the queue. */
static void test_a_round_trip_stays(void **state)
{
    (void)state;
    struct line l = {0};
    double first_us = after(&l, 1, 100000);
    assert_true(first_us >= 100000 && first_us <= 110000);
    for (int i = 0; i < 100; i++) assert_true(after(&l, 100, 100000) < 160000);
    assert_true(l.pace.task_us > TASK_US / 4 && l.pace.task_us < 6 * TASK_US);
}

static void test_a_round_trip_that_changes(void **state)
{
    (void)state;
    struct line l = {0};
    after(&l, 100, 100000);
    double longer_us = after(&l, 500, 400000);
    assert_true(longer_us > 300000 && longer_us < 640000);
    double shorter_us = after(&l, 300, 20000);
    assert_true(shorter_us < 60000);
}

/* One task that takes long on its way fills no queue. */
static void test_a_hiccup(void **state)
{
    (void)state;
    struct line l = {0};
    double before_us = after(&l, 30, 100000);
    assert_true(l.pace.measured);
    assert_true(after(&l, 1, 1000000) < before_us + 130000);
}

/* A task waited half a second in the queue, and the worker then waited 20 ms for it. */
static void test_a_long_queue(void **state)
{
    (void)state;
    struct pace p = {.task_us = TASK_US,
        .most_us = 5000,
        .round_trip_us = 5000,
        .measured = true,
        .done_us = 510000};
    const struct pace_task done = {.px = 1, .done_us = 540000, .wall_us = TASK_US};
    pace_note(&p, &done);
    assert_true(fabs(p.round_trip_us - 7500) < .5);
}

/* Reading and building a scene is in no round trip: not of the first state, once a task that was
 * sent later found the worker idle, and not of the next state. */
static void test_preparation(void **state)
{
    (void)state;
    struct pace p = {0};
    const struct {
        uint32_t state;
        int64_t sent_us, done_us;
        bool measured;
        double trip_us;
    } of[] = {{0, 0, 1020000, false, 1010000}, {0, 0, 1030000, false, 1010000},
        {0, 1030000, 1050000, true, 10000}, {1, 1050000, 3060000, true, 10000},
        {1, 1050000, 3070000, true, 10000}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const struct pace_task done = {.px = 1,
            .state = of[i].state,
            .sent_us = of[i].sent_us,
            .done_us = of[i].done_us,
            .wall_us = TASK_US};
        pace_note(&p, &done);
        assert_int_equal(p.measured, of[i].measured);
        assert_true(fabs(p.round_trip_us - of[i].trip_us) < .5);
    }
}

/* A round trip that preparation may be part of is doubted, until an idle worker shows the true one.
 * A moment between two tasks shows nothing. */
static void test_doubt(void **state)
{
    (void)state;
    struct pace p = {0};
    const struct {
        int64_t sent_us, done_us;
        bool measured;
        double trip_us;
    } of[] = {{0, 1010000, false, 1000000}, {0, 1020100, false, 1000000},
        {0, 2020000, false, 1000000}, {1010001, 2030100, false, 800000},
        {1010001, 2040200, false, 800000}, {2030101, 3050000, true, 1000000}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const struct pace_task done = {
            .px = 1, .sent_us = of[i].sent_us, .done_us = of[i].done_us, .wall_us = TASK_US};
        pace_note(&p, &done);
        assert_int_equal(p.measured, of[i].measured);
        assert_true(fabs(p.round_trip_us - of[i].trip_us) < .5);
    }
}

static void test_depth(void **state)
{
    (void)state;
    const struct {
        double trip_us, task_us;
        int32_t width, depth;
    } of[] = {{0, 0, 1, 1}, {100, 1e6, 1, 0}, {1000, 1000, 1, 2}, {100000, 10000, 1, 13},
        {100000, 10000, 4, 51}, {1e9, 1, 1, PACE_DEPTH_MOST}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const struct pace p = {.round_trip_us = of[i].trip_us, .task_us = of[i].task_us};
        assert_int_equal(pace_depth(&p, of[i].width), of[i].depth);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_a_round_trip_stays),
        cmocka_unit_test(test_a_round_trip_that_changes), cmocka_unit_test(test_a_hiccup),
        cmocka_unit_test(test_a_long_queue), cmocka_unit_test(test_preparation),
        cmocka_unit_test(test_doubt), cmocka_unit_test(test_depth)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
