/* The ring by its default rules in virtual time under seeded faults; seeds.h says how it is run. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "sched/hub_int.h"
#define SEEDS_TEST "test_ring"
#include "../oracles/oracles.h"
#include "seeds.h"

static struct sim_result total;
static int64_t all_but_one; /* seeds in which nearly all nodes were lost */
static int64_t joins;       /* nodes that come later, in all seeds */

static bool run_seed(uint64_t seed, struct sim_result *r)
{
    struct sim_plan plan = sim_ring_plan_of(seed);
    plan.checks = &oracle_ring;
    sim_run(&policy_ring, &plan, r);
    return !*r->failure;
}

static void note_seed(uint64_t seed, const struct sim_result *r)
{
    sim_add(&total, r);
    joins += sim_ring_plan_of(seed).joins;
    all_but_one += r->crashes + r->silences >= sim_ring_plan_of(seed).slots - 1;
}

static void say_seed(uint64_t seed, const struct sim_result *r)
{
    struct sim_plan p = sim_ring_plan_of(seed);
    printf("%d nodes, %d tasks, %d assigned: %lld events, %lld messages, %lld steals, "
           "%lld commits, %lld crashes, %d join, %lld drain",
        p.slots, p.tasks, p.assigned, (long long)r->events, (long long)r->messages,
        (long long)r->steals, (long long)r->commits, (long long)r->crashes, p.joins,
        (long long)r->drains);
}

static void every_seed_commits_each_task_once_and_ends(void **state)
{
    (void)state;
    int64_t seeds = run_seeds();
    print_message("# %lld seeds: %lld events, %lld tasks given, %lld commits, %lld crashes, "
                  "%lld silences, %lld pauses, %lld slow-downs, %lld hubs killed, "
                  "%lld comings up, %lld answers twice, %lld of garbage, %lld ring messages, "
                  "%lld steals, %lld tasks stolen; %lld hang, %lld tasks taken over, %lld pieces; "
                  "%lld drain, %lld leave, %lld join\n",
        (long long)seeds, (long long)total.events, (long long)total.gives, (long long)total.commits,
        (long long)total.crashes, (long long)total.silences, (long long)total.pauses,
        (long long)total.slows, (long long)total.kills, (long long)total.returns,
        (long long)total.twice, (long long)total.garbage, (long long)total.messages,
        (long long)total.steals, (long long)total.passed, (long long)total.hangs,
        (long long)total.taken_over, (long long)total.pieces, (long long)total.drains,
        (long long)total.leaves, (long long)joins);
    assert_true(seeds_hold);
}

/* In the first three, nodes without work are given the last task, which costs them, as long as its
 * failures are on their way; once without end. In the last one, two nodes of equal speed give each
 * other a task. */
static void the_last_task_is_not_passed_round(void **state)
{
    (void)state;
    const uint64_t seeds[] = {1281, 51785, 261128202, 261131989};
    for (size_t i = 0; i < sizeof seeds / sizeof *seeds; i++) {
        struct sim_result r;
        assert_true(try_seed(seeds[i], &r));
    }
}

/* In the step in which a node drains, an idle node takes over the late task that it computes. */
static void a_late_task_of_a_node_that_drains_is_taken_over(void **state)
{
    (void)state;
    struct sim_result r;
    assert_true(try_seed(3001102, &r));
}

/* A simulation that meets no fault proves nothing. */
static void faults_of_every_kind_happened(void **state)
{
    (void)state;
    if (!seeds_hold || seeds_run < 1000) skip();
    assert_true(total.crashes > 100 && total.silences > 100 && total.pauses > 100);
    assert_true(total.slows > 100 && total.kills > 50 && total.returns > 1000);
    assert_true(total.hangs > 100 && total.taken_over > 1000 && total.stops > 100);
    assert_true(total.twice > 1000 && total.garbage > 1000);
    assert_true(total.steals > 1000 && total.passed > 1000 && total.flushes > 100);
    assert_true(total.pieces > 1000);
    assert_true(all_but_one > 10);
    assert_true(joins > 1000 && total.drains > 100 && total.leaves > 100);
    assert_true(total.leaves < total.drains);
}

/* ---- the paper's hosts ----------------------------------------------------------------------- */

#define ROWS 512
#define HOSTS 14

/* By the bound: all of the work by all of the power. Rows cost what they like, dear ones in the
 * middle; and not, in the second half of the plans. */
static double efficiency(uint64_t seed, int64_t latency_us, double total_s)
{
    static const double power[HOSTS] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, .442, 1.347};
    static double row_us[ROWS];
    static struct task rows[ROWS];
    double sum_us = 0, sum_power = 0;
    for (uint32_t y = 0; y < ROWS; y++) {
        double hump = seed % 2 ? 1 : .3 + sin(3.14159 * y / ROWS);
        rows[y] = (struct task){0, y, {0, y, 1, 1, 1, 1}, -1, 0};
        row_us[y] = hump * (.5 + rng_unit(seed, y));
        sum_us += row_us[y];
    }
    for (int y = 0; y < ROWS; y++) row_us[y] *= 1e6 * total_s / sum_us;
    for (int k = 0; k < HOSTS; k++) sum_power += power[k];
    struct sim_work work = {
        .frame_w = 1, .frame_h = ROWS, .tasks = rows, .pixel_us = row_us, .power = power};
    struct sim_plan plan = {.seed = seed,
        .node = &policy_node,
        .checks = &oracle_ring,
        .slots = HOSTS,
        .tasks = ROWS,
        .width = 1,
        .link.latency_us = latency_us,
        .hops = 2,
        .work = &work};
    struct sim_result r;
    sim_run(&policy_ring, &plan, &r);
    if (*r.failure) print_error("%s\n", r.failure);
    assert_true(!*r.failure);
    return 1e6 * total_s / sum_power / (double)r.end_us;
}

/* A slow node is relieved in time, wherever it is in the ring. */
static void work_is_spread_over_unequal_hosts(void **state)
{
    double mean = 0, far = 0;
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++) {
        mean += efficiency(seed, 500, 97.86) / 20;
        far += efficiency(seed, 20000, 44.53) / 20;
    }
    print_message("# efficiency: %.4f at 0.5 ms, %.4f at 20 ms\n", mean, far);
    assert_true(mean > .97 && far > .93);
}

/* ---- a node alone ---------------------------------------------------------------------------- */

/* So many things of this kind it says, or, GIVE, has its worker do; the latest is *last. */
static int count_acts(struct sched_actions *acts, enum sched_action_kind kind, uint32_t *last)
{
    int n = 0;
    for (size_t i = 0; i < acts->n; i++) {
        if (acts->at[i].kind != kind) continue;
        n++;
        if (last) *last = acts->at[i].task.id;
    }
    acts->n = 0;
    return n;
}

/* Asks at 0, is told to wait or not, has work at 10 s: 100 tasks of 1 ms. When does it ask again,
 * in microseconds after that? */
static int64_t asks_again_us(bool told)
{
    const struct policy *p = &policy_node;
    struct sched_actions acts = {0};
    void *n = p->create(&(struct sched_params){0});
    int64_t now = 0, asked_us = -1;
    struct sched_event place = {.kind = SCHED_RING, .ring = {.kind = RING_PLACE, .n = 2}};
    struct sched_event wait = {.kind = SCHED_RING, .ring = {.kind = RING_NONE, .peer = 0}};
    p->step(n, &(struct sched_event){.kind = SCHED_UP, .n = 1}, now, &acts);
    p->step(n, &place, now, &acts);
    assert_int_equal(count_acts(&acts, SCHED_SAY, NULL), 1);
    if (told) p->step(n, &wait, now + 1000, &acts);
    now = 10000000;
    uint32_t id = 0;
    for (uint32_t i = 0; i < 100; i++) {
        struct sched_event e = {.kind = SCHED_TASK, .frame_w = 64, .from = 1};
        e.task = (struct task){0, i, {0, i, 64, 1, 1, 1}, -1, 0};
        p->step(n, &e, now, &acts);
    }
    count_acts(&acts, SCHED_GIVE, &id);
    while (asked_us < 0) {
        struct sched_event e = {.kind = SCHED_DONE, .wall_us = 1000, .from = -1};
        e.task = (struct task){0, id, {0, id, 64, 1, 1, 1}, -1, 0};
        now += 1000;
        p->step(n, &e, now, &acts);
        for (size_t i = 0; i < acts.n; i++)
            if (acts.at[i].kind == SCHED_SAY) asked_us = now - 10000000;
        count_acts(&acts, SCHED_GIVE, &id);
    }
    p->destroy(n);
    free(acts.at);
    return asked_us;
}

/* A node that waited long for work does not count as early from then on. */
static void a_wait_for_work_is_no_measure_of_an_ask(void **state)
{
    (void)state;
    if (!seeds_hold) skip(); /* the ring may never ask again */
    assert_true(asks_again_us(true) == 100000);
    assert_true(asks_again_us(false) == 1000); /* where that is what an ask takes */
}

/* A node with 100 tasks is asked for work by one that takes this percentage of its time: how many
 * does it give? */
static int given_to(int32_t takes)
{
    const struct policy *p = &policy_node;
    struct sched_actions acts = {0};
    void *n = p->create(&(struct sched_params){0});
    struct sched_event place = {.kind = SCHED_RING, .ring = {.kind = RING_PLACE, .n = 2}};
    struct sched_event ask = {.kind = SCHED_RING, .ring = {.kind = RING_ASK, .peer = 1}};
    p->step(n, &(struct sched_event){.kind = SCHED_UP, .n = 1}, 0, &acts);
    for (uint32_t i = 0; i < 101; i++) {
        struct sched_event e = {.kind = SCHED_TASK, .frame_w = 64, .from = -1};
        e.task = (struct task){0, i, {0, i, 64, 1, 1, 1}, -1, 0};
        p->step(n, &e, 0, &acts);
    }
    p->step(n, &place, 0, &acts);
    struct sched_event done = {.kind = SCHED_DONE, .wall_us = 1000, .from = -1};
    done.task = (struct task){0, 0, {0, 0, 64, 1, 1, 1}, -1, 0};
    p->step(n, &done, 1000, &acts);
    acts.n = 0;
    ask.ring.takes = takes;
    p->step(n, &ask, 1000, &acts);
    int given = count_acts(&acts, SCHED_SAY, NULL);
    p->destroy(n);
    free(acts.at);
    return given;
}

/* Both are to end at the same time. */
static void a_slow_node_is_given_less_and_a_fast_one_more(void **state)
{
    (void)state;
    int half = given_to(0), few = given_to(900), most = given_to(10);
    assert_true(half == given_to(100) && half > 45 && half <= 50);
    assert_true(few > 5 && few <= 10 && most > 85 && most <= 91);
}

/* ---- a node that is out of reach ------------------------------------------------------------- */

static int32_t given_by[3]; /* tasks, of the nodes */
static void watched_step(
    void *state, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    if (e->kind == SCHED_RING && e->ring.kind == RING_GIVE) given_by[e->slot]++;
    policy_ring.step(state, e, now, out);
}

/* Node 0 has little to do, and asks node 1, which has most; then again, when that hangs, and node 2
 * has work as well. It is 10 s until node 1 is given up. */
static void who_asks_a_node_that_hangs_asks_another_one(void **state)
{
    static struct task rows[71];
    static double row_us[71];
    static const double power[] = {1, 1, 1};
    (void)state;
    for (uint32_t y = 0; y < 71; y++) {
        rows[y] = (struct task){.id = y,
            .at = {0, y, 1, 1, 1, 1},
            .to = y < 1    ? 0
                  : y < 41 ? 1
                           : 2};
        row_us[y] = 100000;
    }
    struct sim_work work = {
        .frame_w = 1, .frame_h = 71, .tasks = rows, .pixel_us = row_us, .power = power};
    struct sim_fault hangs = {.kind = SIM_SILENCE, .slot = 1, .at_us = 1000000};
    struct sim_plan plan = {.node = &policy_node,
        .checks = &oracle_ring,
        .slots = 3,
        .tasks = 71,
        .width = 1,
        .link.latency_us = 10000,
        .hops = 2,
        .silence_us = 10000000,
        .faults = &hangs,
        .n_faults = 1,
        .work = &work};
    struct policy watched = policy_ring;
    struct sim_result r;
    watched.step = watched_step;
    sim_run(&watched, &plan, &r);
    if (*r.failure) print_error("%s\n", r.failure);
    assert_true(!*r.failure);
    assert_true(given_by[1] > 15 && given_by[2] > 2);
}

/* ---- sets of slots, against sets of flags ---------------------------------------------------- */

static int32_t next_flag(const bool *flags, int32_t n, int32_t k, int32_t by)
{
    for (int32_t i = 1; i <= n; i++) {
        int32_t at = (int32_t)(((int64_t)k + (int64_t)by * i + 2 * (int64_t)n) % n);
        if (flags[at]) return at;
    }
    return -1;
}

static void a_set_finds_the_next_round_the_ring(void **state)
{
    static const int32_t sizes[] = {1, 2, 63, 64, 65, 127, 4096, 4097, 300000};
    (void)state;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        int32_t n = sizes[i], members = 0;
        bool *flags = xcalloc((size_t)n, sizeof *flags);
        struct slot_set s;
        set_init(&s, n);
        for (uint64_t draw = 0; draw < 300; draw++) {
            int32_t k = (int32_t)(rng_unit(i, 2 * draw) * n);
            bool put = draw < 150 ? rng_unit(i, 2 * draw + 1) < .7 : rng_unit(i, 2 * draw + 1) < .1;
            if (draw >= 150 && set_after(&s, k) >= 0) k = set_after(&s, k);
            members += put - flags[k];
            flags[k] = put;
            set_put(&s, k, put);
            int32_t from = (int32_t)(rng_unit((uint64_t)n, draw) * n);
            assert_int_equal(s.count, members);
            assert_int_equal(set_has(&s, k), put);
            assert_int_equal(set_after(&s, from), next_flag(flags, n, from, 1));
            assert_int_equal(set_before(&s, from), next_flag(flags, n, from, -1));
        }
        set_free(&s);
        free(flags);
    }
}

int main(int argc, char **argv)
{
    if (argc > 1) return one_seed(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_seed_commits_each_task_once_and_ends),
        cmocka_unit_test(the_last_task_is_not_passed_round),
        cmocka_unit_test(a_late_task_of_a_node_that_drains_is_taken_over),
        cmocka_unit_test(faults_of_every_kind_happened),
        cmocka_unit_test(a_seed_is_one_run_exactly),
        cmocka_unit_test(work_is_spread_over_unequal_hosts),
        cmocka_unit_test(a_wait_for_work_is_no_measure_of_an_ask),
        cmocka_unit_test(a_slow_node_is_given_less_and_a_fast_one_more),
        cmocka_unit_test(who_asks_a_node_that_hangs_asks_another_one),
        cmocka_unit_test(a_set_finds_the_next_round_the_ring),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
