/* sim: the tasks, the time and the failures of workers in a run, by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "sim/worker.h"

/* The four parts of the time, in whole microseconds, which together are the time of the run. */
static void splits(const struct sim_clock *c, int64_t end_us, int64_t startup, int64_t busy,
    int64_t waiting, int64_t tail)
{
    struct sim_result r = {0};
    sim_clock_split(c, end_us, &r);
    assert_int_equal(llround(r.startup_us), startup);
    assert_int_equal(llround(r.busy_us), busy);
    assert_int_equal(llround(r.waiting_us), waiting);
    assert_int_equal(llround(r.tail_us), tail);
    assert_int_equal(startup + busy + waiting + tail, end_us);
}

/* One task from 10 to 40, one from 60 to 100. */
static void time_is_split_in_four_parts(void **state)
{
    (void)state;
    struct sim_clock c = SIM_CLOCK_INIT;
    sim_clock_begin(&c, 10);
    sim_clock_end(&c, 40);
    splits(&c, 45, 10, 30, 0, 5);
    sim_clock_begin(&c, 60);
    sim_clock_end(&c, 100);
    splits(&c, 100, 10, 70, 20, 0);
    splits(&c, 130, 10, 70, 20, 30);
}

/* The same tasks, while they are computed. */
static void a_task_that_has_not_ended_is_work_until_now(void **state)
{
    (void)state;
    struct sim_clock c = SIM_CLOCK_INIT;
    sim_clock_begin(&c, 10);
    splits(&c, 25, 10, 15, 0, 0);
    sim_clock_end(&c, 40);
    sim_clock_begin(&c, 60);
    splits(&c, 60, 10, 30, 20, 0);
    splits(&c, 75, 10, 45, 20, 0);
}

static void a_worker_without_a_task_has_not_started(void **state)
{
    (void)state;
    struct sim_clock c = SIM_CLOCK_INIT;
    splits(&c, 50, 50, 0, 0, 0);
    sim_clock_end(&c, 30); /* there is none to end */
    splits(&c, 50, 50, 0, 0, 0);
    sim_clock_begin(&c, 0);
    splits(&c, 50, 0, 50, 0, 0);
}

static void a_task_that_was_ended_ends_once(void **state)
{
    (void)state;
    struct sim_clock c = SIM_CLOCK_INIT;
    sim_clock_begin(&c, 10);
    sim_clock_end(&c, 40);
    sim_clock_end(&c, 70);
    splits(&c, 80, 10, 30, 0, 40);
}

static void times_of_workers_are_added(void **state)
{
    (void)state;
    struct sim_result r = {.startup_us = 1, .busy_us = 2, .waiting_us = 3, .tail_us = 4};
    struct sim_clock c = SIM_CLOCK_INIT;
    sim_clock_split(&c, 50, &r);
    sim_clock_begin(&c, 10);
    sim_clock_end(&c, 20);
    sim_clock_begin(&c, 30);
    sim_clock_end(&c, 35);
    sim_clock_split(&c, 50, &r);
    assert_int_equal(llround(r.startup_us), 1 + 50 + 10);
    assert_int_equal(llround(r.busy_us), 2 + 15);
    assert_int_equal(llround(r.waiting_us), 3 + 10);
    assert_int_equal(llround(r.tail_us), 4 + 15);
}

/* Tasks are taken while others come, so that the list moves them and grows. */
static void tasks_are_taken_in_order(void **state)
{
    (void)state;
    struct sim_tasks l = {0};
    uint32_t came = 0, taken = 0;
    for (uint32_t round = 0; round < 100; round++) {
        for (uint32_t i = 0; i < round % 7; i++) sim_append_task(&l, &(struct task){.id = came++});
        for (uint32_t i = 0; i < round % 6 && l.first < l.n; i++)
            assert_int_equal(l.at[l.first++].id, taken++);
        assert_int_equal(l.n - l.first, came - taken);
    }
    assert_true(taken > 100 && l.cap < came / 2); /* room was used again */
    free(l.at);
}

static void work_is_that_of_the_pixels_and_of_the_task(void **state)
{
    (void)state;
    const double pixel_us[] = {1, 2, 4, 8, 16, 32};
    const struct sim_work work = {.frame_w = 3, .frame_h = 2, .pixel_us = pixel_us, .task_us = 100};
    struct task t = {.at = {1, 0, 2, 2, 1, 1}};
    assert_int_equal(llround(sim_work_us(&work, &t)), 100 + 2 + 4 + 16 + 32);
    t.at = (struct lattice){0, 0, 2, 1, 2, 1};
    assert_int_equal(llround(sim_work_us(&work, &t)), 100 + 1 + 4);
}

static void the_first_failure_is_kept(void **state)
{
    (void)state;
    struct sim_result r = {0};
    sim_note_failure(&r, 7, "a reason", 1, -2);
    sim_note_failure(&r, 8, "another one", 3, 4);
    assert_string_equal(r.failure, "a reason (1, -2) at 7 us");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(time_is_split_in_four_parts),
        cmocka_unit_test(a_task_that_has_not_ended_is_work_until_now),
        cmocka_unit_test(a_worker_without_a_task_has_not_started),
        cmocka_unit_test(a_task_that_was_ended_ends_once),
        cmocka_unit_test(times_of_workers_are_added),
        cmocka_unit_test(tasks_are_taken_in_order),
        cmocka_unit_test(work_is_that_of_the_pixels_and_of_the_task),
        cmocka_unit_test(the_first_failure_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
