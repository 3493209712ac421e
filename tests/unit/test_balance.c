/* How well deal -q auto -e and ringctl -e balance unequal slots, in virtual time: short and long
 * links, costs that cannot be expected, a row with much of the work, a slot that becomes slow, many
 * slots. Work and powers are drawn at random. The mean efficiency over all draws must reach a
 * bound. */
#include "rounds.h"
#include "sim/sim.h"

#include <math.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define W 64
#define H 96
#define ROUGH_H 2000
#define SLOTS 12
#define DRAWS 64

struct world_of {
    bool ring;     /* ringctl -e */
    int32_t slots; /* 0: SLOTS */
    int64_t latency_us;
    double dear;        /* one row costs this part of what all rows cost without it; 0: none does */
    bool rough;         /* many short rows; the cost of one says nothing about the next */
    const char *faults; /* as of simulate -f; NULL: none */
};

static void make_work(struct sim_workload *l, uint64_t seed, const struct world_of *in)
{
    char err[ERR_BYTES];
    const uint32_t h = in->rough ? ROUGH_H : H;
    bool good = sim_workload_frame(l, W, h, err);
    for (uint32_t y = 0; good && y < h; y++) {
        const uint32_t w = in->ring ? W / 4 : W;
        for (uint32_t x = 0; good && x < W; x += w) {
            const struct task t = {.id = (y * W + x) / w, .at = {x, y, w, 1, 1, 1}, .to = -1};
            good = sim_workload_task(l, &t, err);
        }
    }
    if (!good || !sim_workload_end(l, err)) fail_msg("%s", err);
    l->slots = in->slots ? in->slots : SLOTS;
    l->power = sim_draw_powers(seed, l->slots, 3);
    double sum = 0, us = 20000;
    for (uint32_t i = 0; i < W * h; i++) { /* unless rough, neighbours cost about the same */
        if (in->rough) us = 12 * exp(4 * rng_unit(seed, i / W));
        else us *= exp(.05 * (2 * rng_unit(seed, i) - 1));
        sum += l->pixel_us[i] = us;
    }
    uint32_t y = (uint32_t)(seed * 37 % H);
    for (uint32_t x = 0; in->dear > 0 && x < W; x++) l->pixel_us[y * W + x] = in->dear * sum / W;
}

/* Lower bound / makespan. */
static double efficiency(uint64_t seed, const struct world_of *in)
{
    char err[ERR_BYTES];
    struct sim_workload l = {0};
    struct sim_plan p = {.seed = seed, .link.latency_us = in->latency_us};
    struct sim_result r;
    struct sim_method m = *sim_method_named(in->ring ? "ring" : "deal");
    make_work(&l, seed, in);
    if (!in->ring) m.params.depth = SCHED_DEPTH_AUTO;
    m.params.endgame = true;
    p.params = m.params;
    if (in->rough) p.jitter = .5;
    if (in->faults && !sim_parse_faults(&p, in->faults)) fail_msg("%s", in->faults);
    if (!sim_workload_scale(&l, 1, err) || !sim_workload_plan(&l, &m, &p, err)) fail_msg("%s", err);
    sim_run(m.policy, &p, &r);
    assert_string_equal(r.failure, "");
    double e = 1e6 * sim_bound_s(&p) / (double)r.end_us;
    free(p.faults);
    sim_workload_free(&l);
    return e;
}

static void reaches(const char *name, double least, struct world_of in)
{
    const int draws = rounds(DRAWS);
    double sum = 0;
    for (int seed = 1; seed <= draws; seed++) sum += efficiency((uint64_t)seed, &in);
    if (draws < DRAWS || sum / DRAWS >= least) return; /* a few draws have another mean */
    fail_msg("%s: %.3f, expected %.3f; to repeat: test_balance", name, sum / DRAWS, least);
}

static void test_links(void **state)
{
    (void)state;
    reaches("short links", .98, (struct world_of){.latency_us = 500});
    reaches("long links", .915, (struct world_of){.latency_us = 100000});
}

static void test_rough_costs(void **state)
{
    (void)state;
    reaches("rough costs", .785, (struct world_of){.latency_us = 50000, .rough = true});
}

static void test_a_dear_row(void **state)
{
    (void)state;
    reaches("a dear row", .84, (struct world_of){.latency_us = 5000, .dear = .4});
}

static void test_a_slot_becomes_slow(void **state)
{
    (void)state;
    reaches("a slow slot", .916, (struct world_of){.latency_us = 5000, .faults = "slow@2s:3:.05"});
}

/* The ring has tasks of 16 pixels. */
static void test_ring_links(void **state)
{
    (void)state;
    reaches("ring, short links", .979, (struct world_of){.ring = true, .latency_us = 500});
    reaches("ring, long links", .9, (struct world_of){.ring = true, .latency_us = 100000});
}

static void test_ring_dear_row(void **state)
{
    (void)state;
    reaches(
        "ring, a dear row", .858, (struct world_of){.ring = true, .latency_us = 5000, .dear = .4});
}

static void test_ring_many_slots(void **state)
{
    (void)state;
    reaches(
        "ring, many slots", .66, (struct world_of){.ring = true, .slots = 200, .latency_us = 500});
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_links),
        cmocka_unit_test(test_rough_costs), cmocka_unit_test(test_a_dear_row),
        cmocka_unit_test(test_a_slot_becomes_slow), cmocka_unit_test(test_ring_links),
        cmocka_unit_test(test_ring_dear_row), cmocka_unit_test(test_ring_many_slots)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
