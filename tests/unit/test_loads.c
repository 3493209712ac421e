/* sim: work at a speed that changes, and what comes before a slot's first task, by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "scratch.h"
#include "sim/sim.h"

#include <unistd.h>

#define TASKS 4 /* pixels of 1 s */

static char err[ERR_BYTES];

/* One slot of power 1, and one of power 2, .1 s away. */
static double power[] = {1, 2};
static double pixel_us[] = {1e6, 1e6, 1e6, 1e6};
static struct task tasks[TASKS];
static struct sim_work work = {
    .frame_w = 1, .frame_h = TASKS, .tasks = tasks, .pixel_us = pixel_us, .power = power};

static struct sim_plan plan_of(int32_t slots)
{
    for (uint32_t i = 0; i < TASKS; i++)
        tasks[i] = (struct task){.id = i, .at = {0, i, 1, 1, 1, 1}, .to = -1};
    return (struct sim_plan){.slots = slots,
        .tasks = TASKS,
        .width = 1,
        .link.latency_us = 100000,
        .hops = 2,
        .silence_us = 3000000,
        .work = &work};
}

static char lines[16384];
static void keep(const char *line)
{
    size_t n = strlen(lines);
    snprintf(lines + n, sizeof lines - n, "%s\n", line);
}

/* Loads are the lines of a file. */
static bool read_loads(struct sim_plan *p, const char *text)
{
    char dir[SCRATCH_BYTES], path[SCRATCH_BYTES + 8];
    assert_true(scratch_make(dir));
    snprintf(path, sizeof path, "%s/loads", dir);
    assert_int_equal(outfile_put(path, text, strlen(text)), 0);
    bool good = sim_read_loads(p, path, err);
    assert_true(unlink(path) == 0 && rmdir(dir) == 0);
    return good;
}

static struct sim_result run(const struct policy *policy, struct sim_plan p, const char *loads)
{
    struct sim_result r;
    if (loads && !read_loads(&p, loads)) fail_msg("%s", err);
    p.trace = keep;
    *lines = '\0';
    sim_run(policy, &p, &r);
    assert_string_equal(r.failure, "");
    assert_true(sim_least_s(&p) <= 1e-6 * (double)r.end_us);
    free(p.loads);
    return r;
}

static void happened(const char *line)
{
    if (!strstr(lines, line)) fail_msg("no %s in\n%s", line, lines);
}

/* When that happened for the n-th time, in microseconds. */
static int64_t when(const char *what, int n)
{
    for (const char *line = lines; *line; line = strchr(line, '\n') + 1) {
        const char *at = strstr(line, what);
        if (at && at < strchr(line, '\n') && --n == 0) return strtoll(line, NULL, 10);
    }
    fail_msg("no %s in\n%s", what, lines);
    return -1;
}

/* The fan gives all to the slot at .2 s. The first task has .3 at .5 s, then .1 a second, and .2 of
 * a second later all of the power. */
static void a_task_ends_where_the_integral_of_its_share_is_its_work(void **state)
{
    (void)state;
    struct sim_plan p = plan_of(1);
    struct sim_result r = run(&sim_fan, p, "0.5 0 .1\n0.7 0 1 # others are gone\n\n");
    happened("500000 0: share 0.1\n");
    happened("1380000 0: computed\n");
    assert_int_equal(r.end_us, 4480000);
    p.loads = NULL;
    p.n_loads = 0;
    r = run(&sim_fan, p, "9 0 .5\n");
    assert_int_equal(r.end_us, 4300000); /* a load that comes too late */
    r = run(&sim_fan, p, "0 0 .5");
    assert_int_equal(r.end_us, 8300000);
}

/* It stops in its first task, and in its second; a load that changes meanwhile counts later. */
static void a_task_waits_while_its_slot_is_paused(void **state)
{
    (void)state;
    struct sim_fault pause[] = {
        {.kind = SIM_PAUSE, .at_us = 500000}, {.kind = SIM_SLOW, .at_us = 400000, .power = .5}};
    struct sim_plan p = plan_of(1);
    p.faults = pause;
    p.n_faults = 1;
    struct sim_result r = run(&sim_fan, p, NULL);
    int64_t paused_us = when(" 0: resumes", 1) - 500000;
    assert_int_equal(r.end_us, 4300000 + paused_us);
    p.n_faults = 2;
    r = run(&sim_fan, p, NULL);
    assert_int_equal(r.end_us, 8100000 + paused_us); /* all but .2 s of it at half of the power */
    assert_int_equal(r.slows, 1);
}

/* Slot 1 comes at 1 s; deal knows at 1.1 and gives it task 1. */
static void a_slot_joins_at_its_first_share(void **state)
{
    (void)state;
    run(&policy_deal, plan_of(2), "1 1 .25\n0 1 0\n");
    happened("1000000 1: starts\n");
    happened("1200000 1 from hub: task 1\n");
    happened("3200000 1: computed\n");
}

/* Slots connect at .5 s. The state has left after .4 s, and arrives at 1.1; then it is built. */
static void a_slot_prepares_before_its_first_task(void **state)
{
    (void)state;
    struct sim_plan p = plan_of(2);
    p.start = (struct sim_start){.connect_s = .5, .state_bytes = 4e8, .build_s = 1, .spread = 1};
    p.link.bytes_per_s = 1e9;
    run(&policy_deal, p, NULL);
    happened("500000 0: starts\n");
    happened("600000 0 to hub: up\n");
    happened("1100000 0: has its state\n");
    happened("1600000 1: is prepared\n");
    happened("2100000 0: is prepared\n"); /* of power 1 */
    happened("3100000 0: computed\n");
    /* 4 s of work, and a second of building each; slots have .5 + .4 + .3 s less */
    assert_true(fabs(sim_least_s(&p) - 3.2) < 1e-6);
    run(&policy_deal, p, "1.6 0 .5\n"); /* half of the first slot's power is left at 1.6 */
    happened("2600000 0: is prepared\n");
    p.faults = &(struct sim_fault){.kind = SIM_CRASH, .slot = 1, .at_us = 1200000};
    p.n_faults = 1;
    p.p_return = 1;
    run(&policy_deal, p, NULL); /* it comes back, and prepares again */
    assert_int_equal(when(" 1: has its state", 2) - when(" 1: starts", 2), 600000);
}

/* Two slots of a host have its state at once, and need the same time for it. */
static void a_host_gets_its_state_once(void **state)
{
    (void)state;
    static const struct sim_link links[] = {{100000, 1e9}};
    static const int32_t link_of[] = {0, 0};
    struct sim_plan p = plan_of(2);
    p.start = (struct sim_start){.state_bytes = 4e8, .build_s = 1, .spread = 3};
    p.links = links;
    p.link_of = link_of;
    p.n_links = 1;
    run(&policy_deal, p, NULL);
    happened("600000 0: has its state\n");
    happened("600000 1: has its state\n");
    int64_t a = when(" 1: is prepared", 1) - 600000, b = when(" 0: is prepared", 1) - 600000;
    assert_true(llabs(b - 2 * a) <= 1 && llabs(b - 1000000) > 1000); /* by their powers */
}

static void refused(const char *text, const char *words)
{
    struct sim_plan p = {0};
    assert_false(read_loads(&p, text));
    if (!strstr(err, words) || !strstr(err, "expected")) fail_msg("%s: %s", text, err);
    free(p.loads);
}

static void other_loads_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {"1 0", "1 0 .5 2", "x 0 .5", "1 -1 .5", "1 .5 .5", "1 0 1.5",
        "1 0 0", "0 0 .0001", "1 0 .0001", "-1 0 .5"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) refused(bad[i], "line 1,");
    refused("# none\n1 0 .5\n2 0 2\n", "line 3,");
    refused("1 0 .5\n2 1 .5\n1 0 1", "slot 0 twice");
    refused("0 3 0", "slot 3 never joins");
    struct sim_plan p = {0};
    assert_false(sim_read_loads(&p, "no such file", err));
    assert_true(read_loads(&p, "") && p.n_loads == 0);
    free(p.loads);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_task_ends_where_the_integral_of_its_share_is_its_work),
        cmocka_unit_test(a_task_waits_while_its_slot_is_paused),
        cmocka_unit_test(a_slot_joins_at_its_first_share),
        cmocka_unit_test(a_slot_prepares_before_its_first_task),
        cmocka_unit_test(a_host_gets_its_state_once),
        cmocka_unit_test(other_loads_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
