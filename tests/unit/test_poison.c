/* Tasks that cost each slot that computes them: the pixels given up, and the slots lost. */
#include "../oracles/oracles.h"
#include "sim/world.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define TASKS 25
#define ROWS 2
#define FAULTS 64

static struct sim_fault faults[FAULTS];

static struct sim_plan plan_of(int32_t slots, bool endgame)
{
    struct sim_plan p = {.seed = 1, .slots = slots, .tasks = TASKS, .rows = ROWS, .width = 1};
    p.cost_us = 1000;
    p.hops = 2;
    p.silence_us = 3000000;
    p.params.endgame = endgame;
    p.params.depth = endgame ? SCHED_DEPTH_AUTO : 0;
    p.faults = faults;
    return p;
}

/* Pixel x of task id, in its second row. */
static void poison(struct sim_plan *p, uint32_t x, uint32_t id)
{
    faults[p->n_faults++] = (struct sim_fault){.kind = SIM_POISON, .x = x, .y = id * ROWS + 1};
}

static struct sim_result run(const struct policy *policy, struct sim_plan p)
{
    struct sim_result r;
    bool ring = policy == &policy_ring;
    p.node = ring ? &policy_node : NULL;
    p.checks = ring ? &oracle_ring : &oracle_deal;
    for (size_t i = 0; i < p.n_faults; i++)
        if (p.faults[i].kind == SIM_REFUSE) p.checks = NULL; /* they know no refusals of a plan */
    sim_run(policy, &p, &r);
    assert_string_equal(r.failure, "");
    assert_int_equal(r.uncommitted, 0);
    return r;
}

static const struct policy *const policies[] = {&policy_deal, &policy_ring};

/* Three slots, and then at most two for each cut: 128 pixels are cut seven times. */
static void the_smallest_bad_part_is_given_up(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++)
        for (int endgame = 0; endgame < 2; endgame++)
            for (int32_t slots = 1; slots <= 8; slots *= 2) {
                struct sim_plan p = plan_of(slots, endgame);
                poison(&p, 10, 1);
                struct sim_result r = run(policies[i], p);
                if (r.abandoned != 1)
                    print_error("%s, %d slots, endgame %d: %lld poisoned\n", policies[i]->name,
                        slots, endgame, (long long)r.poisoned);
                assert_int_equal(r.abandoned, 1);
                assert_true(r.poisoned >= 4 && r.poisoned <= 3 + 7 + (endgame ? 4 : 0));
            }
}

static void a_slot_that_says_so_is_not_lost(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct sim_plan p = plan_of(4, false);
        poison(&p, 10, 1);
        faults[0].power = 1;
        struct sim_result r = run(policies[i], p);
        assert_int_equal(r.abandoned, 1);
        assert_int_equal(r.returns, 4); /* at the beginning */
    }
}

static int done_before; /* when the first half was given */
static bool halved;

static void note_line(const char *line)
{
    const char *given = strstr(line, "from hub: task ");
    halved |= given && strtol(given + strlen("from hub: task "), NULL, 10) >= TASKS;
    done_before += !halved && strstr(line, "to hub: done ");
}

static void everything_else_is_done_first(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct sim_plan p = plan_of(2, false);
        poison(&p, 10, 0);
        p.trace = note_line;
        p.params.losses = 1;
        p.cost_us = 100000; /* the input has ended long before */
        done_before = 0;
        halved = false;
        run(policies[i], p);
        assert_true(halved);
        assert_int_equal(done_before, TASKS - 1);
    }
}

static void two_bad_parts_of_one_task_cost_little_more_than_one(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct sim_plan p = plan_of(4, false);
        poison(&p, 0, 1);
        poison(&p, 63, 1);
        struct sim_result r = run(policies[i], p);
        assert_true(r.abandoned > 1 && r.abandoned <= 64 * ROWS);
        assert_true(r.poisoned <= 3 + 2 + 7);
    }
}

static void bad_tasks_apart_are_found_each(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct sim_plan p = plan_of(4, false);
        poison(&p, 5, 0);
        poison(&p, 6, 12);
        poison(&p, 7, TASKS - 1);
        assert_int_equal(run(policies[i], p).abandoned, 3);
    }
}

/* A bad frame costs three slots and one more, and not three for each of its tasks. In a ring, whose
 * tasks are at nodes from the beginning, it costs each node at most once more. */
static void a_bad_frame_is_given_up_as_a_whole(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct sim_plan p = plan_of(4, false);
        for (uint32_t id = 0; id < TASKS; id++) poison(&p, id, id);
        struct sim_result r = run(policies[i], p);
        assert_int_equal(r.abandoned, 64 * ROWS * TASKS);
        assert_true(r.poisoned <= 2 * 4 + 1);
    }
}

static void an_option_says_how_many_slots_a_task_may_cost(void **state)
{
    (void)state;
    struct sim_plan p = plan_of(4, false);
    poison(&p, 10, 3);
    p.params.losses = 1;
    int64_t few = run(&policy_deal, p).poisoned;
    p.params.losses = 6;
    assert_int_equal(run(&policy_deal, p).poisoned, few + 5);
}

/* Later state waits until the bad task is given up: it is not cut, because the input goes on. */
static void a_bad_task_does_not_hold_up_later_frames(void **state)
{
    (void)state;
    struct sim_plan p = plan_of(4, false);
    p.frames = 10;
    p.window = 2;
    poison(&p, 10, 1);
    assert_int_equal(run(&policy_deal, p).abandoned, 64 * ROWS);
}

static void slots_that_are_lost_for_other_reasons_give_nothing_up(void **state)
{
    (void)state;
    for (int32_t k = 0; k < 6; k++)
        faults[k] = (struct sim_fault){.kind = SIM_CRASH, .slot = k, .at_us = 400000 + 100 * k};
    for (int i = 0; i < 2; i++) {
        struct sim_plan p = plan_of(8, false);
        p.n_faults = 6;
        p.cost_us = 200000;
        struct sim_result r = run(policies[i], p);
        assert_int_equal(r.crashes, 6);
        assert_int_equal(r.abandoned, 0);
    }
}

/* The first hosts have not the memory for the state of some frames. They say so at once for each
 * task, and compute the others. */
static void a_slot_that_has_the_memory_computes_it(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++)
        for (int endgame = 0; endgame < 2; endgame++)
            for (uint32_t bad = 1; bad <= 5; bad++) {
                struct sim_plan p = plan_of(5, endgame);
                p.frames = 5;
                p.window = 5;
                for (int32_t k = 0; k < 4; k++)
                    for (uint32_t g = 0; g < bad; g++)
                        faults[p.n_faults++] =
                            (struct sim_fault){.kind = SIM_REFUSE, .slot = k, .y = g};
                assert_int_equal(run(policies[i], p).abandoned, 0);
            }
}

static void a_frame_that_all_refuse_is_given_up_and_no_other(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct sim_plan p = plan_of(4, true);
        p.frames = 5;
        p.window = 5;
        for (int32_t k = 0; k < 4; k++)
            faults[p.n_faults++] = (struct sim_fault){.kind = SIM_REFUSE, .slot = k, .y = 1};
        assert_int_equal(run(policies[i], p).abandoned, 64 * ROWS * TASKS / 5);
    }
}

/* It comes last, when the others have refused; or comes back, when it was lost. */
static void a_slot_that_has_the_memory_is_waited_for(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++)
        for (int64_t at_us = 0; at_us <= 1000000; at_us += 100000) {
            struct sim_plan p = plan_of(4, true);
            p.p_return = 1;
            p.start.connect_s = 1;
            p.start.spread = 2;
            for (int32_t k = 0; k < 3; k++)
                faults[p.n_faults++] = (struct sim_fault){.kind = SIM_REFUSE, .slot = k};
            faults[p.n_faults++] = (struct sim_fault){.kind = SIM_CRASH, .slot = 3, .at_us = at_us};
            assert_int_equal(run(policies[i], p).abandoned, 0);
        }
}

/* As in test_ring, without the rules that its checks have for each task. */
static void a_ring_computes_all_that_a_node_can(void **state)
{
    (void)state;
    int64_t refused = 0;
    for (uint64_t seed = 1; seed <= 400; seed++) {
        struct sim_plan p = sim_ring_plan_of(seed);
        struct sim_result r;
        p.poison = 0;
        p.p_refuse = (double)(seed % 10) / 10;
        sim_run(&policy_ring, &p, &r);
        if (*r.failure || r.abandoned) print_error("seed %d: %s\n", (int)seed, r.failure);
        assert_string_equal(r.failure, "");
        assert_int_equal(r.abandoned, 0);
        refused += r.refused;
    }
    assert_true(refused > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_smallest_bad_part_is_given_up),
        cmocka_unit_test(a_slot_that_says_so_is_not_lost),
        cmocka_unit_test(everything_else_is_done_first),
        cmocka_unit_test(two_bad_parts_of_one_task_cost_little_more_than_one),
        cmocka_unit_test(bad_tasks_apart_are_found_each),
        cmocka_unit_test(a_bad_frame_is_given_up_as_a_whole),
        cmocka_unit_test(an_option_says_how_many_slots_a_task_may_cost),
        cmocka_unit_test(a_bad_task_does_not_hold_up_later_frames),
        cmocka_unit_test(slots_that_are_lost_for_other_reasons_give_nothing_up),
        cmocka_unit_test(a_slot_that_has_the_memory_computes_it),
        cmocka_unit_test(a_frame_that_all_refuse_is_given_up_and_no_other),
        cmocka_unit_test(a_slot_that_has_the_memory_is_waited_for),
        cmocka_unit_test(a_ring_computes_all_that_a_node_can),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
