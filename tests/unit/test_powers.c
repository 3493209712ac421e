/* Policies measure the speed of their slots: with other powers of the slots, the same events give
 * the same actions. But a power that changes during the run changes the measured speed at once
 * (stormring-hosts(5)). */
#include "sched/sched.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define SLOTS 3
#define ROWS 40

struct play {
    const struct policy *p;
    void *state;
    double power[SLOTS];
    int64_t now_us;
    struct sched_actions acts;
};

static void tell(struct play *y, struct sched_event e)
{
    e.from = -1;
    if (e.kind == SCHED_UP) e.power = y->power[e.slot];
    y->p->step(y->state, &e, y->now_us += 1000, &y->acts);
}

/* Every task that a slot was given since `from` is done there. Returns the number of actions. */
static size_t answer(struct play *y, size_t from)
{
    const size_t n = y->acts.n;
    for (size_t i = from; i < n; i++) {
        const struct sched_action a = y->acts.at[i];
        if (a.kind != SCHED_GIVE) continue;
        tell(y, (struct sched_event){.kind = SCHED_DONE,
                    .slot = a.slot,
                    .task = a.task,
                    .frame_w = 8,
                    .wall_us = 500 * (a.slot + 1)});
        tell(y, (struct sched_event){
                    .kind = SCHED_PIXELS, .slot = a.slot, .task = a.task, .frame_w = 8});
    }
    return n;
}

/* The actions of a run; slot 1 is lost and comes up again. */
static struct sched_actions played(
    const struct policy *p, const struct sched_params *params, const double power[SLOTS])
{
    struct play y = {.p = p, .state = p->create(params)};
    size_t seen = 0;
    memcpy(y.power, power, sizeof y.power);
    tell(&y, (struct sched_event){.kind = SCHED_SLOTS, .n = SLOTS});
    for (int32_t k = 0; k < SLOTS; k++)
        tell(&y, (struct sched_event){.kind = SCHED_UP, .slot = k, .n = 1});
    for (uint32_t id = 0; id < ROWS; id++)
        tell(&y, (struct sched_event){.kind = SCHED_TASK,
                     .task = {.id = id, .at = {0, id, 8, 1, 1, 1}, .to = -1},
                     .frame_w = 8});
    tell(&y, (struct sched_event){.kind = SCHED_INPUT_END});
    for (int round = 0; round < 2 * ROWS && seen < y.acts.n; round++) {
        seen = answer(&y, seen);
        if (round == 2) tell(&y, (struct sched_event){.kind = SCHED_GONE, .slot = 1});
        if (round == 3) tell(&y, (struct sched_event){.kind = SCHED_UP, .slot = 1, .n = 1});
        if (p->wake_us && p->wake_us(y.state) <= y.now_us)
            tell(&y, (struct sched_event){.kind = SCHED_WAKE});
    }
    p->destroy(y.state);
    return y.acts;
}

static void test_same_actions(void **state)
{
    (void)state;
    static const double even[SLOTS] = {1, 1, 1}, uneven[SLOTS] = {1e-6, 1e6, 7};
    static const struct sched_params params[] = {{.depth = 0}, {.depth = 3},
        {.depth = SCHED_DEPTH_AUTO}, {.depth = SCHED_DEPTH_AUTO, .endgame = true}};
    static const struct policy *const policies[] = {&policy_deal, &policy_ring, &policy_published};
    for (size_t p = 0; p < sizeof policies / sizeof *policies; p++)
        for (size_t i = 0; i < sizeof params / sizeof *params; i++) {
            struct sched_actions a = played(policies[p], &params[i], even);
            struct sched_actions b = played(policies[p], &params[i], uneven);
            assert_true(a.n >= SLOTS);
            if (policies[p] == &policy_deal) assert_true(a.n >= ROWS);
            assert_int_equal(a.n, b.n);
            for (size_t k = 0; k < a.n; k++) {
                assert_int_equal(a.at[k].kind, b.at[k].kind);
                assert_int_equal(a.at[k].slot, b.at[k].slot);
                assert_memory_equal(&a.at[k].task, &b.at[k].task, sizeof a.at[k].task);
            }
            free(a.at);
            free(b.at);
        }
}

/* ---- a power that changes ---- */

#define WIDE 6000 /* pixels of a task */

static struct sched_event task_of(uint32_t id)
{
    return (struct sched_event){.kind = SCHED_TASK,
        .task = {.id = id, .at = {0, id, WIDE, 1, 1, 1}, .to = -1},
        .frame_w = WIDE};
}

static struct sched_event done_of(int32_t k, uint32_t id)
{
    struct sched_event e = task_of(id);
    e.kind = SCHED_DONE;
    e.slot = k;
    e.wall_us = 1000;
    return e;
}

/* The pixels come before the `done`, which makes a policy act. There is no round trip. */
static void finish(struct play *y, int32_t k, uint32_t id)
{
    struct sched_event e = done_of(k, id);
    e.kind = SCHED_PIXELS;
    tell(y, e);
    e.kind = SCHED_DONE;
    e.wall_us = -1;
    tell(y, e);
}

static void begin(struct play *y, const struct policy *p)
{
    *y = (struct play){.p = p, .power = {4, 4, 4}};
    y->state = p->create(&(struct sched_params){.endgame = true});
    tell(y, (struct sched_event){.kind = SCHED_SLOTS, .n = SLOTS});
    for (int32_t k = 0; k < SLOTS; k++)
        tell(y, (struct sched_event){.kind = SCHED_UP, .slot = k, .n = 1});
}

static void change_power(struct play *y, int32_t k, double power)
{
    y->power[k] = power;
    tell(y, (struct sched_event){.kind = SCHED_UP, .slot = k, .n = 1});
    tell(y, (struct sched_event){.kind = SCHED_UP, .slot = k, .n = 1}); /* no other change */
}

static void end(struct play *y)
{
    y->p->destroy(y->state);
    free(y->acts.at);
}

/* Slots of equal speed have a task each, after another one, and the pool has one. The power of slot
 * 1 becomes this; then it is free, in the endgame. The pixels that it is given. */
static uint64_t piece_px(double power)
{
    struct play y;
    begin(&y, &policy_deal);
    for (uint32_t id = 0; id < 2 * SLOTS + 1; id++) tell(&y, task_of(id));
    for (int32_t k = 0; k < SLOTS; k++) finish(&y, k, (uint32_t)k);
    tell(&y, (struct sched_event){.kind = SCHED_INPUT_END});
    change_power(&y, 1, power);
    y.acts.n = 0;
    finish(&y, 1, SLOTS + 1);
    const struct sched_action *last = &y.acts.at[y.acts.n - 1];
    assert_int_equal(last->kind, SCHED_GIVE);
    assert_int_equal(last->slot, 1);
    uint64_t px = lattice_count(&last->task.at);
    end(&y);
    return px;
}

static void test_deal_cuts_by_the_new_power(void **state)
{
    (void)state;
    assert_in_range(piece_px(4), 16, WIDE - 1);
    assert_in_range(piece_px(.4), piece_px(4) / 20, piece_px(4) / 4);
    assert_true(piece_px(16) > 3 * piece_px(4) / 2);
}

/* Nodes 1 and 2 have ten tasks each, node 0 has one. The power of node k becomes this. The node
 * that is asked on behalf of node 0. */
static int32_t asked(int32_t k, double power)
{
    struct play y;
    int32_t victim = -1;
    begin(&y, &policy_ring);
    for (uint32_t id = 0; id < 21; id++) {
        struct sched_event e = task_of(id);
        e.task.to = id ? 1 + (int32_t)id % 2 : 0;
        tell(&y, e);
    }
    tell(&y, done_of(0, 0));
    tell(&y, done_of(1, 2));
    tell(&y, done_of(2, 1));
    change_power(&y, k, power);
    y.acts.n = 0;
    tell(&y, (struct sched_event){.kind = SCHED_RING, .ring = {.kind = RING_ASK, .peer = -1}});
    for (size_t i = 0; i < y.acts.n; i++)
        if (y.acts.at[i].ring.kind == RING_ASK) victim = y.acts.at[i].slot;
    end(&y);
    return victim;
}

static void test_the_hub_asks_by_the_new_power(void **state)
{
    (void)state;
    assert_int_equal(asked(0, 4), 1); /* the next one in the ring */
    assert_int_equal(asked(2, 1), 2); /* its work lasts longer now */
    assert_int_equal(asked(1, 16), 2);
    assert_int_equal(asked(1, 1), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_actions),
        cmocka_unit_test(test_deal_cuts_by_the_new_power),
        cmocka_unit_test(test_the_hub_asks_by_the_new_power)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
