/* Policies do not read powers: with other powers of the slots, the same events give the same
 * actions (stormring-hosts(5): another power= changes nothing in a run). */
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_actions)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
