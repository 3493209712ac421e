/*
 * sim: trees of hubs. Each seed makes up a tree, links, powers, costs and options of deal; all
 * tasks are committed once, the times add up, and no run beats the bound. Where the tree is one
 * hub, sim_run must say the same.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define SEEDS_TEST "test_tree"
#include "../oracles/oracles.h"
#include "seeds.h"

#define FRAME_W 24

/* A plan and what it points at. */
struct made {
    struct sim_plan plan;
    struct sim_work work;
    struct task tasks[60];
    double pixel_us[FRAME_W * 60], power[40];
    struct sim_link links[40];
    int32_t link_of[40], groups[3];
};

static int32_t pick(uint64_t seed, uint64_t i, int32_t least, int32_t most)
{
    return least + (int32_t)(rng_unit(seed, i << 8) * (most - least + 1));
}

/* A task is the first w pixels of a row. */
static void make_tasks(struct made *m, uint64_t seed, int32_t n, uint32_t w)
{
    for (int32_t i = 0; i < n; i++)
        m->tasks[i] =
            (struct task){.id = (uint32_t)i, .at = {0, (uint32_t)i, w, 1, 1, 1}, .to = -1};
    double us = pow(10, pick(seed, 1, 1, 4));
    for (uint64_t p = 0; p < FRAME_W * (uint64_t)n; p++)
        if (p % FRAME_W < w) m->pixel_us[p] = us * exp(2 * rng_unit(seed, 1000 + p));
    m->work = (struct sim_work){.frame_w = FRAME_W,
        .frame_h = 60,
        .tasks = m->tasks,
        .pixel_us = m->pixel_us,
        .power = m->power,
        .task_us = pick(seed, 2, 0, 1) * 50};
    m->plan.tasks = n;
    m->plan.work = &m->work;
}

static void make_slots(struct made *m, uint64_t seed, int32_t n)
{
    static const int64_t latencies_us[] = {0, 300, 20000};
    static const double rates[] = {0, 1e4, 1e6};
    m->plan.slots = n;
    m->plan.link.latency_us = latencies_us[pick(seed, 3, 0, 2)];
    m->plan.link.bytes_per_s = rates[pick(seed, 4, 0, 2)];
    m->plan.hub_bytes_per_s = rates[pick(seed, 5, 0, 2)];
    for (int32_t k = 0; k < n; k++) {
        uint64_t i = 100 + 4 * (uint64_t)k;
        m->power[k] = pow(3, 2 * rng_unit(seed, i << 8) - 1);
        m->links[k] = (struct sim_link){
            latencies_us[pick(seed, i + 1, 0, 2)], rates[pick(seed, i + 2, 0, 2)]};
        m->link_of[k] = k / 2; /* two slots on each host */
    }
    if (pick(seed, 6, 0, 1)) return;
    m->plan.links = m->links;
    m->plan.link_of = m->link_of;
    m->plan.n_links = (n + 1) / 2;
}

static void make(struct made *m, uint64_t seed)
{
    static const int32_t depths[] = {0, 1, 5, SCHED_DEPTH_AUTO};
    memset(m, 0, sizeof *m);
    m->plan.seed = seed;
    m->plan.hops = 2;
    m->plan.width = 1;
    m->plan.silence_us = 3000000;
    m->plan.params.depth = depths[pick(seed, 7, 0, 3)];
    m->plan.params.endgame = pick(seed, 8, 0, 1);
    make_tasks(m, seed, pick(seed, 9, 1, 60), (uint32_t)pick(seed, 10, 1, FRAME_W));
    make_slots(m, seed, pick(seed, 11, 1, 40));
    m->plan.levels = (size_t)pick(seed, 12, 0, 3);
    for (size_t i = 0; i < m->plan.levels; i++) m->groups[i] = pick(seed, 13 + i, 1, 4);
    m->plan.groups = m->groups;
    m->plan.message_us = pick(seed, 16, 0, 1) * 40;
}

static void fail_seed(struct sim_result *r, const char *what, double got, double expected)
{
    if (!*r->failure)
        snprintf(r->failure, sizeof r->failure, "%s: %.9g, expected %.9g", what, got, expected);
}

/* The tree of one hub is what sim_run simulates. */
static void compare(struct sim_plan *p, struct sim_result *r)
{
    struct sim_result flat;
    p->checks = &oracle_deal;
    p->unstated = true; /* as from the hosts of a tree */
    sim_run(&policy_deal, p, &flat);
    if (*flat.failure) snprintf(r->failure, sizeof r->failure, "%s", flat.failure);
    if (flat.end_us != r->end_us)
        fail_seed(r, "one hub ends at another time", (double)r->end_us, (double)flat.end_us);
    if (fabs(flat.busy_us - r->busy_us) + fabs(flat.tail_us - r->tail_us) > 1)
        fail_seed(r, "busy time", r->busy_us, flat.busy_us);
    if (flat.computed != r->computed)
        fail_seed(r, "tasks computed", (double)r->computed, (double)flat.computed);
}

static bool run_seed(uint64_t seed, struct sim_result *r)
{
    static struct made m;
    make(&m, seed);
    sim_tree_run(&policy_deal, &m.plan, r);
    double all_us = r->busy_us + r->startup_us + r->waiting_us + r->tail_us;
    if (r->uncommitted) fail_seed(r, "uncommitted tasks", (double)r->uncommitted, 0);
    if (fabs(all_us - (double)r->end_us * m.plan.slots) > 1)
        fail_seed(r, "the times of all slots", all_us, (double)r->end_us * m.plan.slots);
    /* The whole frame is more pixels than the tasks have: without the hub's bandwidth. */
    double hub = m.plan.hub_bytes_per_s;
    m.plan.hub_bytes_per_s = 0;
    double bound_us = 1e6 * sim_bound_s(&m.plan);
    if ((double)r->end_us + 1 + (double)r->computed < bound_us) /* each task is rounded */
        fail_seed(r, "faster than the bound", (double)r->end_us, bound_us);
    if (!m.plan.levels && m.plan.message_us <= 0 && hub <= 0) compare(&m.plan, r);
    return !*r->failure;
}

static int64_t trees;
static void note_seed(uint64_t seed, const struct sim_result *r)
{
    (void)seed;
    trees += r->hubs > 2;
}

static void say_seed(uint64_t seed, const struct sim_result *r)
{
    static struct made m;
    make(&m, seed);
    printf("%d slots, %lld hubs, %d tasks, end %lld us", m.plan.slots, (long long)r->hubs,
        m.plan.tasks, (long long)r->end_us);
}

static void every_seed_holds(void **state)
{
    (void)state;
    int64_t seeds = run_seeds();
    assert_true(seeds_hold);
    if (seeds >= 100) assert_true(trees > seeds / 4);
}

/* ---- by hand --------------------------------------------------------------------------------- */

/* Four tasks of 1 s, hosts of power 1 and 2, links of .1 s. */
static struct made two_hosts(void)
{
    static struct made m;
    memset(&m, 0, sizeof m);
    m.plan.params.depth = 0;
    m.plan.link.latency_us = 100000;
    m.plan.slots = 2;
    m.power[0] = 1;
    m.power[1] = 2;
    make_tasks(&m, 0, 4, 1);
    m.work.task_us = 0;
    for (int i = 0; i < 4; i++) m.pixel_us[i * FRAME_W] = 1e6;
    m.plan.groups = m.groups;
    return m;
}

static struct sim_result run(struct made *m)
{
    struct sim_result r;
    m->plan.work = &m->work;
    m->work.tasks = m->tasks;
    m->work.pixel_us = m->pixel_us;
    m->work.power = m->power;
    m->plan.groups = m->groups;
    sim_tree_run(&policy_deal, &m->plan, &r);
    assert_string_equal(r.failure, "");
    return r;
}

/*
 * The root knows the inner hub at .1 and gives it two tasks, which are at the hosts at .3. The
 * second host has done its task at .8; the root knows at 1.0, and its next one runs from 1.2 to
 * 1.7. The first has done its task at 1.3; its next one runs from 1.7 to 2.7.
 */
static void a_hub_within_a_hub_by_hand(void **state)
{
    (void)state;
    struct made m = two_hosts();
    m.plan.levels = 1;
    m.groups[0] = 1;
    struct sim_result r = run(&m);
    assert_int_equal(r.end_us, 2900000);
    assert_int_equal(r.hubs, 2);
    assert_int_equal(r.hub_tasks, 4);
    /* up; three records for each task; a flush of the last pixels, which are under way */
    assert_int_equal(r.hub_records, 1 + 12 + 1);
    assert_true(r.busy_us > 2999999 && r.busy_us < 3000001);
    m = two_hosts();
    m.plan.levels = 0;
    assert_int_equal(run(&m).end_us, 2500000);
}

/*
 * One hub that needs .1 s for a record, without latency. It hears of both hosts at .1 and .2, and
 * has given a task to each at .3 and .4, in the order in which it acts.
 */
static void a_slow_hub_by_hand(void **state)
{
    (void)state;
    struct made m = two_hosts();
    m.plan.link.latency_us = 0;
    m.plan.message_us = 100000;
    m.plan.tasks = 2;
    /* Up of both: .1, .2; tasks: the first is given at .1 and leaves at .3, the second at .2 and
     * leaves at .4. The second host is done at .9: done .1, pixels .1. The first at 1.3: 1.5. */
    assert_int_equal(run(&m).end_us, 1500000);
}

/* The link of a host is that of its slots together. */
static void slots_share_the_link_of_their_host(void **state)
{
    (void)state;
    struct made m = two_hosts();
    m.plan.link.latency_us = 0;
    m.plan.tasks = 2;
    m.power[0] = 2;
    m.plan.links = m.links;
    m.plan.link_of = m.link_of;
    m.plan.n_links = 2;
    m.links[0].bytes_per_s = m.links[1].bytes_per_s = 100;
    m.link_of[1] = 1;
    int64_t apart_us = run(&m).end_us;
    m.plan.n_links = 1;
    m.link_of[1] = 0;
    int64_t together_us = run(&m).end_us;
    assert_true(together_us > apart_us + 1000000);
}

static void groups_are_as_equal_as_possible(void **state)
{
    (void)state;
    struct made m = two_hosts();
    m.plan.slots = 7;
    for (int k = 0; k < 7; k++) m.power[k] = 1;
    m.plan.levels = 2;
    m.groups[0] = 3;
    m.groups[1] = 2;
    struct sim_result r = run(&m);
    assert_int_equal(r.hubs, 1 + 3 + 6);
    assert_int_equal(r.hub_slots, 3);
    m.groups[1] = 50; /* no more hubs than slots */
    r = run(&m);
    assert_int_equal(r.hubs, 1 + 3 + 7);
}

int main(int argc, char **argv)
{
    if (argc == 2) return one_seed(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_seed_holds),
        cmocka_unit_test(a_seed_is_one_run_exactly),
        cmocka_unit_test(a_hub_within_a_hub_by_hand),
        cmocka_unit_test(a_slow_hub_by_hand),
        cmocka_unit_test(slots_share_the_link_of_their_host),
        cmocka_unit_test(groups_are_as_equal_as_possible),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
