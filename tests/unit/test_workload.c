/* sim: work put together from tasks, costs and powers; methods by name; the table of figures. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "../oracles/oracles.h"
#include "sim/sim.h"

static char err[ERR_BYTES];

static struct task row(uint32_t id, uint32_t y, uint32_t w)
{
    return (struct task){.frame = 3, .id = id, .at = {0, y, w, 1, 1, 1}, .to = -1};
}

/* A frame of 4 x n pixels; the tasks are its rows, ids backwards. */
static struct sim_workload rows(uint32_t n)
{
    struct sim_workload l = {0};
    assert_true(sim_workload_frame(&l, 4, n, err));
    for (uint32_t y = 0; y < n; y++) {
        struct task t = row(n - 1 - y, y, 4);
        assert_true(sim_workload_task(&l, &t, err));
    }
    assert_true(sim_workload_end(&l, err));
    return l;
}

static void powers(struct sim_workload *l, const double *power, int32_t slots)
{
    l->slots = slots;
    l->power = xmalloc((size_t)slots, sizeof *power);
    memcpy(l->power, power, (size_t)slots * sizeof *power);
}

static void refused(const char *words)
{
    assert_non_null(strstr(err, words));
    assert_non_null(strstr(err, "expected"));
}

/* ---- tasks ----------------------------------------------------------------------------------- */

static void tasks_in_any_order_are_kept(void **state)
{
    (void)state;
    struct sim_workload l = rows(3000);
    assert_int_equal(l.n, 3000);
    for (uint32_t i = 0; i < 3000; i++) {
        assert_int_equal(l.tasks[i].id, 2999 - i);
        assert_int_equal(l.tasks[i].at.y, i);
        assert_int_equal(l.tasks[i].frame, 0);
    }
    for (size_t p = 0; p < 4 * 3000; p++) assert_true(l.pixel_us[p] == 0);
    sim_workload_free(&l);
}

static void other_input_is_refused(void **state)
{
    (void)state;
    struct sim_workload l = {0};
    struct task t = row(0, 0, 4), beyond = row(0, 2, 4), wide = row(0, 0, 9), other = row(2, 1, 4);
    assert_false(sim_workload_task(&l, &t, err)); /* no frame */
    refused("inside the frame");
    assert_true(sim_workload_frame(&l, 4, 2, err));
    assert_false(sim_workload_frame(&l, 4, 2, err));
    refused("second frame");
    assert_false(sim_workload_task(&l, &beyond, err));
    assert_false(sim_workload_task(&l, &wide, err));
    refused("inside the frame");
    assert_false(sim_workload_end(&l, err));
    refused("no task");
    assert_true(sim_workload_task(&l, &t, err));
    assert_true(sim_workload_task(&l, &other, err));
    assert_false(sim_workload_end(&l, err)); /* 0, 2 */
    refused("task 2 of 2");
    l.tasks[1].id = 0;
    assert_false(sim_workload_end(&l, err)); /* 0, 0 */
    refused("task 0 of 2");
    l.tasks[1].id = 1;
    assert_true(sim_workload_end(&l, err));
    sim_workload_free(&l);
}

/* ---- costs and powers ------------------------------------------------------------------------ */

static void costs_follow_seed_and_id(void **state)
{
    (void)state;
    struct sim_workload l = rows(200), other = rows(200);
    double least = 1e9, most = 0;
    sim_draw_costs(&l, 5, 100, 4);
    sim_draw_costs(&other, 6, 100, 4);
    for (int32_t i = 0; i < 200; i++) {
        double us = l.pixel_us[4 * i];
        for (int32_t x = 1; x < 4; x++) assert_true(l.pixel_us[4 * i + x] == us);
        assert_true(us >= 25 && us < 400 && us != other.pixel_us[4 * i]);
        least = fmin(least, us);
        most = fmax(most, us);
    }
    assert_true(least < 30 && most > 330);
    sim_draw_costs(&other, 5, 100, 4);
    assert_memory_equal(l.pixel_us, other.pixel_us, 800 * sizeof *l.pixel_us);
    sim_draw_costs(&l, 5, 100, 1);
    assert_true(l.pixel_us[0] == 100 && l.pixel_us[799] == 100);
    sim_workload_free(&l);
    sim_workload_free(&other);
}

static void powers_are_drawn_by_their_logarithm(void **state)
{
    (void)state;
    const int32_t n = 2000;
    double *p = sim_draw_powers(1, n, 9), sum = 0;
    int32_t above = 0;
    for (int32_t k = 0; k < n; k++) {
        assert_true(p[k] >= 1. / 9 && p[k] <= 9);
        sum += log(p[k]) / log(9);
        above += p[k] > 3;
    }
    assert_true(fabs(sum / n) < .05);                   /* 0, standard deviation .013 */
    assert_in_range(above, n * 21 / 100, n * 29 / 100); /* a quarter */
    free(p);
    p = sim_draw_powers(1, 3, 1);
    assert_true(p[0] == 1 && p[2] == 1);
    free(p);
}

static void work_beyond_the_clock_is_refused(void **state)
{
    (void)state;
    struct sim_workload l = rows(10);
    sim_draw_costs(&l, 0, 1e9, 1); /* 4e10 us */
    powers(&l, (double[]){1, .5}, 2);
    assert_true(sim_workload_scale(&l, 1000, err)); /* 8e13 on the weakest slot */
    assert_true(l.pixel_us[0] == 1e12 && l.pixel_us[39] == 1e12);
    assert_false(sim_workload_scale(&l, 2, err));
    refused("tasks of 1.6e+08 s");
    l.power[0] = l.power[1] = 9; /* more power allows no more work */
    assert_false(sim_workload_scale(&l, 1.5, err));
    sim_workload_free(&l);
}

/* ---- the plan -------------------------------------------------------------------------------- */

static struct sim_plan plan_of(struct sim_workload *l, const char *method)
{
    struct sim_plan p = {.hops = 2};
    p.params = sim_method_named(method)->params;
    assert_true(sim_workload_plan(l, sim_method_named(method), &p, err));
    return p;
}

static void a_plan_has_the_work_of_its_method(void **state)
{
    (void)state;
    struct sim_workload l = rows(8);
    sim_draw_costs(&l, 0, 1000, 1);
    powers(&l, (double[]){1, 3}, 2);
    struct sim_plan p = plan_of(&l, "deal");
    assert_true(p.tasks == 8 && p.slots == 2 && p.width == 1);
    assert_int_equal(p.faults_us, 8000); /* 32 pixels of a millisecond by powers of 4 */
    assert_null(p.node);
    assert_ptr_equal(plan_of(&l, "ring").node, &policy_node);
    assert_int_equal(plan_of(&l, "ring").detect_us, 0);
    struct sim_method published = *sim_method_named("ring");
    published.policy = &policy_published;
    assert_true(sim_workload_plan(&l, &published, &p, err));
    assert_true(p.detect_us > 0);
    sim_workload_free(&l);
}

static void a_fault_needs_its_slot(void **state)
{
    (void)state;
    struct sim_workload l = rows(8);
    struct sim_plan p = {.hops = 2};
    powers(&l, (double[]){1, 1}, 2);
    assert_true(sim_parse_faults(&p, "crash@3:1"));
    assert_true(sim_workload_plan(&l, sim_method_named("deal"), &p, err));
    assert_true(sim_parse_faults(&p, "hang@3:2"));
    assert_false(sim_workload_plan(&l, sim_method_named("deal"), &p, err));
    refused("slot 2 of 2");
    free(p.faults);
    sim_workload_free(&l);
}

static void best_preassigns(void **state)
{
    (void)state;
    struct sim_workload l = rows(4);
    int32_t of[2] = {0};
    sim_draw_costs(&l, 0, 1000, 1);
    powers(&l, (double[]){1, 3}, 2);
    plan_of(&l, "fan");
    for (int32_t i = 0; i < 4; i++) assert_int_equal(l.tasks[i].to, -1);
    plan_of(&l, "best");
    for (int32_t i = 0; i < 4; i++) of[l.tasks[i].to]++;
    assert_true(of[0] == 1 && of[1] == 3);
    sim_workload_free(&l);
}

/* ---- methods and figures --------------------------------------------------------------------- */

static void methods_have_names(void **state)
{
    (void)state;
    static const char *const names[] = {"fan", "best", "adaptive", "deal", "ring"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        assert_string_equal(sim_method_named(names[i])->name, names[i]);
    assert_null(sim_method_named("rin"));
    assert_null(sim_method_named(""));
    assert_int_equal(sim_method_named("adaptive")->params.depth, SCHED_DEPTH_AUTO);
    assert_true(sim_method_named("adaptive")->params.endgame);
    assert_false(sim_method_named("deal")->params.endgame);
}

static void seeds_add_up(void **state)
{
    (void)state;
    for (int ring = 0; ring < 2; ring++) {
        struct sim_method of = *sim_method_named(ring ? "ring" : "deal");
        const struct sim_method *m = &of;
        of.checks = ring ? &oracle_ring : &oracle_deal;
        struct sim_result all, part, sum = {.trace_hash = HASH64_INIT};
        assert_int_equal(sim_run_seeds(m, 40, 10, NULL, &all), 10);
        for (uint64_t seed = 40; seed < 50; seed++) {
            struct sim_plan p = ring ? sim_ring_plan_of(seed) : sim_plan_of(seed);
            p.checks = of.checks;
            sim_run(m->policy, &p, &part);
            sim_add(&sum, &part);
        }
        assert_true(all.trace_hash == sum.trace_hash && all.commits == sum.commits);
        assert_string_equal(all.failure, "");
    }
    struct sim_method tuned = *sim_method_named("adaptive");
    struct sim_result r;
    tuned.checks = &oracle_deal;
    assert_int_equal(sim_run_seeds(&tuned, 0, 50, NULL, &r), 50);
    struct sim_method losing = *sim_method_named("deal");
    losing.policy = &sim_fan; /* tasks of a lost slot stay lost */
    int64_t held = sim_run_seeds(&losing, 0, 1000, NULL, &r);
    assert_in_range(held, 0, 999);
    assert_string_not_equal(r.failure, "");
    assert_int_equal(
        sim_run_seeds(&losing, (uint64_t)held, 1, NULL, &r), 0); /* the seed to repeat */
}

/* ---- the judge of deal ----------------------------------------------------------------------- */

/* deal, which gets the tasks when all have come, ordered by their numbers. */
static struct sched_event held[8];
static size_t n_held;
static void step_by_number(
    void *state, const struct sched_event *e, int64_t now_us, struct sched_actions *out)
{
    if (e->kind == SCHED_TASK) {
        assert_true(e->task.id < 8);
        held[e->task.id] = *e;
        n_held++;
        return;
    }
    for (size_t i = 0; e->kind == SCHED_INPUT_END && i < n_held; i++)
        policy_deal.step(state, &held[i], now_us, out);
    policy_deal.step(state, e, now_us, out);
}

/* Tasks whose numbers are in no order go in the order of arrival. */
static void the_judge_of_deal_wants_the_order_of_arrival(void **state)
{
    (void)state;
    struct sim_workload l = rows(8);
    struct sim_result r;
    sim_draw_costs(&l, 0, 1000, 1);
    powers(&l, (double[]){1, 3}, 2);
    struct sim_plan p = plan_of(&l, "deal");
    p.checks = &oracle_deal;
    sim_run(&policy_deal, &p, &r);
    assert_string_equal(r.failure, "");
    assert_int_equal(r.commits, 8);
    struct policy by_number = policy_deal;
    by_number.step = step_by_number;
    sim_run(&by_number, &p, &r);
    assert_non_null(strstr(r.failure, "a task was given out of order"));
    sim_workload_free(&l);
}

/* The value of this key; NULL: there is none. */
static const char *value(const char *text, const char *key, char out[40])
{
    char line[40];
    snprintf(line, sizeof line, "\n%s\t", key);
    const char *at = strstr(text, line);
    if (!at) return NULL;
    at += strlen(line);
    snprintf(out, 40, "%.*s", (int)strcspn(at, "\n"), at);
    return out;
}

static void figures_are_lines(void **state)
{
    (void)state;
    struct sim_workload l = rows(8);
    sim_draw_costs(&l, 0, 1000, 1);
    powers(&l, (double[]){1, 3}, 2);
    struct sim_plan p = plan_of(&l, "deal");
    p.link.latency_us = 500;
    const struct sim_result r = {.end_us = 16000,
        .computed = 9,
        .messages = 7,
        .steals = 2,
        .crashes = 1,
        .silences = 2,
        .pauses = 3,
        .slows = 4,
        .hangs = 5,
        .kills = 6,
        .returns = 8,
        .twice = 10,
        .garbage = 11,
        .lost = 12,
        .doubled = 13,
        .late = 14,
        .events = 15,
        .busy_us = 1e6,
        .trace_hash = 0xabc};
    static const char *const expected[][2] = {{"slots", "2"}, {"tasks", "8"}, {"uncommitted", "0"},
        {"computed", "9"}, {"makespan_s", "0.016000"}, {"busy_s", "1.000000"},
        {"bound_s", "0.008000"}, {"least_s", "0.009500"}, {"efficiency", "0.5000"},
        {"messages", "7"}, {"messages_per_steal", "3.500"}, {"crashes", "1"}, {"silences", "2"},
        {"pauses", "3"}, {"slows", "4"}, {"hangs", "5"}, {"kills", "6"}, {"returns", "8"},
        {"twice", "10"}, {"garbage", "11"}, {"lost", "12"}, {"doubled", "13"}, {"late", "14"},
        {"events", "15"}, {"trace", "0000000000000abc"}};
    struct buf out = {0};
    char text[40];
    buf_append(&out, "\n", 1);
    sim_report(&p, &r, &out);
    buf_append(&out, "", 1);
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        const char *found = value((const char *)buf_data(&out), expected[i][0], text);
        if (!found) fail_msg("no %s", expected[i][0]);
        assert_string_equal(found, expected[i][1]);
    }
    buf_consume(&out, buf_size(&out));
    const struct sim_result lost = {.end_us = 16000, .uncommitted = 1};
    sim_report(&p, &lost, &out);
    buf_append(&out, "", 1);
    assert_string_equal(value((const char *)buf_data(&out), "efficiency", text), "0.0000");
    assert_string_equal(value((const char *)buf_data(&out), "messages_per_steal", text), "0.000");
    buf_free(&out);
    sim_workload_free(&l);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tasks_in_any_order_are_kept),
        cmocka_unit_test(other_input_is_refused),
        cmocka_unit_test(costs_follow_seed_and_id),
        cmocka_unit_test(powers_are_drawn_by_their_logarithm),
        cmocka_unit_test(work_beyond_the_clock_is_refused),
        cmocka_unit_test(a_plan_has_the_work_of_its_method),
        cmocka_unit_test(a_fault_needs_its_slot),
        cmocka_unit_test(best_preassigns),
        cmocka_unit_test(methods_have_names),
        cmocka_unit_test(seeds_add_up),
        cmocka_unit_test(the_judge_of_deal_wants_the_order_of_arrival),
        cmocka_unit_test(figures_are_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
