/* sim: links, and records whose lengths are those of lib/wire. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "sim/net.h"
#include "wire/wire.h"

static const struct task tasks[] = {
    {.id = 0, .at = {0, 0, 1, 1, 1, 1}, .to = -1},
    {.id = 9, .at = {10, 99, 100, 1, 1, 1}, .to = -1},
    {.id = 4096, .frame = 12, .at = {0, 65000, 300, 200, 12, 1}, .to = -1},
    {.id = 99999, .frame = 100, .at = {1000, 1, 1, 64, 1, 10}, .to = -1},
};
#define TASKS (sizeof tasks / sizeof *tasks)

/* The bytes that are in b, and empties it. */
static double taken(struct buf *b)
{
    double n = (double)buf_size(b);
    buf_consume(b, buf_size(b));
    return n;
}

static void records_have_the_lengths_of_the_wire(void **state)
{
    (void)state;
    struct buf b = {0};
    float *pixels = xcalloc(300 * 200, 4 * sizeof *pixels);
    for (size_t i = 0; i < TASKS; i++) {
        const struct task *t = &tasks[i];
        struct sched_event e = {.kind = SCHED_TASK, .task = *t, .wall_us = 1234};
        wire_give(&b, t, NULL);
        assert_true(net_bytes(&e) == taken(&b));
        e.kind = SCHED_DONE;
        wire_done(&b, t, 1234, 1234);
        assert_true(net_bytes(&e) == taken(&b));
        e.kind = SCHED_PIXELS;
        wire_frag(&b, t, &t->at, "0123456789abcdef0123456789abcdef", pixels);
        double got = taken(&b), most = net_bytes(&e);
        assert_true(got <= most && got >= most - 9); /* the crc has 1 to 10 digits */
    }
    struct sched_event hello = {.kind = SCHED_UP}, flush = {.kind = SCHED_FLUSH};
    wire_hello(&b, "rtworker", "0123456789abcdef", 1.23456, 0, 1);
    bool packs = text_find(buf_data(&b), buf_size(&b), " zstd=1", 7) != NULL;
    assert_true(net_bytes(&hello) == taken(&b) + (packs ? 0 : 7)); /* built without libzstd */
    wire_plain(&b, REC_FLUSH, NULL);
    assert_true(net_bytes(&flush) == taken(&b));
    free(pixels);
    buf_free(&b);
}

static void long_tasks_come_in_several_records(void **state)
{
    (void)state;
    struct sched_event one = {.kind = SCHED_PIXELS, .task.at = {0, 0, 256, 256, 1, 1}}, two = one;
    two.task.at.h = 512;
    double line = net_bytes(&one) - 65536. * SIM_PIXEL_BYTES;
    assert_true(line > 80 && line < 120);
    assert_true(net_bytes(&two) == 2 * net_bytes(&one));
}

static void small_records_overtake_pixels_and_take_time(void **state)
{
    (void)state;
    struct net_queue q = {0};
    assert_int_equal(net_send(&q, 1000, 1000, 0, true), 1000000);
    assert_int_equal(net_send(&q, 100, 1000, 0, false), 100000);
    assert_int_equal(net_send(&q, 100, 1000, 50000, false), 200000);
    assert_int_equal(net_send(&q, 1000, 1000, 60000, true), 2200000);
    assert_int_equal(net_send(&q, 1000, 1000, 3000000, true), 4000000);
    assert_int_equal(net_send(&q, 1000, 0, 5000000, true), 5000000); /* no limit */
}

static void a_plan_has_one_link_or_those_of_its_hosts(void **state)
{
    (void)state;
    const struct sim_link links[] = {{5, 100}, {2000, 0}, {70, 30}};
    const int32_t of[] = {0, 0, 1, 2};
    struct sim_plan p = {.slots = 4, .link = {9, 50}};
    assert_int_equal(net_link_of(&p, 3).latency_us, 9);
    assert_int_equal(net_number_of(&p, 3), 3);
    assert_int_equal(net_links(&p), 4);
    assert_true(net_least_rate(&p) == 50);
    p.links = links;
    p.link_of = of;
    p.n_links = 3;
    assert_int_equal(net_link_of(&p, 2).latency_us, 2000);
    assert_int_equal(net_number_of(&p, 1), 0);
    assert_int_equal(net_links(&p), 3);
    assert_int_equal(net_least_us(&p), 5);
    assert_int_equal(net_most_us(&p), 2000);
    assert_true(net_least_rate(&p) == 30);
    p.hub_bytes_per_s = 20;
    assert_true(net_least_rate(&p) == 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(records_have_the_lengths_of_the_wire),
        cmocka_unit_test(long_tasks_come_in_several_records),
        cmocka_unit_test(small_records_overtake_pixels_and_take_time),
        cmocka_unit_test(a_plan_has_one_link_or_those_of_its_hosts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
