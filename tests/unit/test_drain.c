/* The hub of a ring and a node that leaves, event by event; test_ring.c has it in virtual time. */
#include "sched/sched.h"

#include <setjmp.h>
#include <stdlib.h>
#include <cmocka.h>

static void *hub;
static struct sched_actions acts;

static void tell_at(int64_t now_us, struct sched_event e)
{
    e.from = -1;
    acts.n = 0;
    policy_ring.step(hub, &e, now_us, &acts);
}

static void tell(struct sched_event e) { tell_at(0, e); }

static struct sched_event about(enum sched_event_kind kind, int32_t slot, uint32_t id)
{
    return (struct sched_event){.kind = kind,
        .slot = slot,
        .task = {.id = id, .at = {0, id, 8, 1, 1, 1}, .to = 1},
        .frame_w = 8,
        .wall_us = -1};
}

/* Nodes 0 and 1 are up, node 1 has tasks 0 to 3, and drains. */
static int begin(void **state)
{
    (void)state;
    hub = policy_ring.create(&(struct sched_params){0});
    tell((struct sched_event){.kind = SCHED_SLOTS, .n = 2});
    for (int32_t k = 0; k < 2; k++) tell((struct sched_event){.kind = SCHED_UP, .slot = k, .n = 1});
    for (uint32_t id = 0; id < 4; id++) tell(about(SCHED_TASK, -1, id));
    tell((struct sched_event){.kind = SCHED_DRAIN, .slot = 1});
    return 0;
}

static int end(void **state)
{
    (void)state;
    policy_ring.destroy(hub);
    free(acts.at);
    acts = (struct sched_actions){0};
    return 0;
}

static void assert_given(size_t i, int32_t slot, uint32_t id)
{
    assert_true(i < acts.n);
    assert_int_equal(acts.at[i].kind, SCHED_GIVE);
    assert_int_equal(acts.at[i].slot, slot);
    assert_int_equal(acts.at[i].task.id, id);
}

static void it_hands_over_what_it_has_not_begun(void **state)
{
    (void)state;
    assert_int_equal(acts.n, 3);
    for (uint32_t id = 1; id < 4; id++) assert_given(id - 1, 0, id);
    assert_int_equal(policy_ring.tries(hub, 0, 0, 1), 2);
    assert_int_equal(policy_ring.tries(hub, 1, 0, 0), 1);
}

static void it_leaves_when_its_task_is_done_and_its_pixels_have_come(void **state)
{
    (void)state;
    tell(about(SCHED_DONE, 1, 0));
    assert_int_equal(acts.n, 1); /* it may hold them back */
    assert_int_equal(acts.at[0].kind, SCHED_ASK_FLUSH);
    tell(about(SCHED_PIXELS, 1, 0));
    assert_int_equal(acts.n, 2);
    assert_int_equal(acts.at[0].kind, SCHED_COMMIT);
    assert_int_equal(acts.at[1].kind, SCHED_LEAVE);
    assert_int_equal(acts.at[1].slot, 1);
    tell(about(SCHED_TASK, -1, 5)); /* to=1 */
    assert_given(0, 0, 5);
}

/* It had no worker, so its first task was in its queue, and crosses `drain` on the way. */
static void a_task_that_it_gives_away_is_not_lost(void **state)
{
    (void)state;
    struct sched_event e = about(SCHED_RING, 1, 0);
    e.ring = (struct ring){.kind = RING_GIVE, .peer = 0};
    tell(e);
    assert_given(0, 0, 0);
    assert_int_equal(acts.at[0].from, 1);
    assert_int_equal(acts.at[acts.n - 1].kind, SCHED_LEAVE);
}

static void an_idle_node_gets_its_task_if_it_hangs(void **state)
{
    (void)state;
    for (uint32_t id = 1; id < 4; id++) {
        tell(about(SCHED_DONE, 0, id));
        tell(about(SCHED_PIXELS, 0, id));
    }
    tell((struct sched_event){
        .kind = SCHED_RING, .slot = 0, .ring = {.kind = RING_ASK, .peer = -1}});
    int64_t late_us = policy_ring.wake_us(hub);
    assert_true(late_us > 0 && late_us < INT64_MAX);
    tell_at(late_us, (struct sched_event){.kind = SCHED_WAKE, .slot = -1});
    assert_given(0, 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(it_hands_over_what_it_has_not_begun, begin, end),
        cmocka_unit_test_setup_teardown(
            it_leaves_when_its_task_is_done_and_its_pixels_have_come, begin, end),
        cmocka_unit_test_setup_teardown(a_task_that_it_gives_away_is_not_lost, begin, end),
        cmocka_unit_test_setup_teardown(an_idle_node_gets_its_task_if_it_hangs, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
