/* How slots spent a run, and the bound: by logs of lines whose sums are known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "account/account.h"

#define JOB "0123456789abcdef"
enum { W = 8, H = 4 };

static void near(double got, double expected)
{
    if (!(fabs(got - expected) < 1e-12)) fail_msg("got %.12g, not %.12g", got, expected);
}

/* Lines up to a NULL, each sealed. */
static struct buf of_lines(const char *const *line)
{
    struct buf b = {0};
    for (; *line; line++) {
        size_t at = buf_size(&b);
        buf_append(&b, *line, strlen(*line));
        wire_seal(&b, at);
    }
    return b;
}

/* A task that cost cpu_us, done by a lone worker, with its pixels. */
static void put_done(struct buf *b, uint32_t id, struct lattice at, int64_t used_us)
{
    float rgba[4 * W * H] = {0};
    struct task t = {.id = id, .at = at, .to = -1};
    for (int i = 3; i < 4 * W * H; i += 4) rgba[i] = 1;
    wire_done(b, &t, used_us, used_us);
    wire_frag(b, &t, &at, JOB, rgba);
}

static void slots_of_hellos_and_of_records(void **state)
{
    (void)state;
    static const char *const lines[] = {"hello deal 0.1 format=4 selftest=1 slots=4",
        "done 0 0 cpu_us=1 w=10", "done 0 1 cpu_us=1 w=2.1", "done 0 2 cpu_us=1 w=0",
        "done 0 3 cpu_us=1 w=2.0 from=1", NULL};
    static const char *const names[] = {"0", "1", "2.0", "2.1", "3", "10"};
    struct buf b = of_lines(lines);
    struct history l = {0};
    struct account a;
    history_read_bytes(&l, b.data, b.len);
    account_make(&a, &l);
    assert_int_equal(a.n_slots, 6);
    for (int k = 0; k < 6; k++) {
        assert_string_equal(a.slots[k].name, names[k]);
        assert_int_equal(a.slots[k].tasks, k != 1 && k != 4);
        assert_int_equal(a.slots[k].steals, k == 2);
        near(a.slots[k].power, 1);
    }
    assert_int_equal(a.slot_of[0], 5);
    account_free(&a);
    history_free(&l);
    buf_free(&b);
    assert_int_equal(account_outermost("12.3"), 12);
    assert_int_equal(account_outermost("12"), 12);
    assert_int_equal(account_outermost("-"), -1);
}

static void a_lone_worker_is_no_idle_slot(void **state)
{
    (void)state;
    static const char *const lines[] = {"hello rtworker 0.1 format=4 selftest=1 slots=1",
        "done 0 0 cpu_us=3000 wall_us=1000", "done 0 1 cpu_us=1000 wall_us=2000", NULL};
    struct buf b = of_lines(lines);
    struct history l = {0};
    struct account a;
    history_read_bytes(&l, b.data, b.len);
    account_make(&a, &l);
    assert_int_equal(a.n_slots, 1);
    assert_string_equal(a.slots[0].name, "-");
    near(a.makespan_s, .005); /* not faster than its CPU time */
    near(account_bound(&a, NULL), .004);
    account_free(&a);
    history_free(&l);
    buf_free(&b);
}

static void times_of_two_runs(void **state)
{
    (void)state;
    static const char *const lines[] = {"hello deal 0.1 format=4 selftest=0 slots=3",
        "done 0 0 cpu_us=90000 wall_us=100000 w=0 recv_us=120000",
        "done 0 1 cpu_us=200000 wall_us=200000 w=1 recv_us=230000",
        "done 0 2 cpu_us=100000 wall_us=100000 w=0 recv_us=240000",
        "done 0 2 cpu_us=50000 wall_us=50000 w=1 recv_us=300000 try=2",
        "hello deal 0.1 format=4 selftest=0 slots=3",
        "done 0 3 cpu_us=1000 wall_us=1000 w=2 recv_us=102000", NULL};
    struct buf b = of_lines(lines);
    struct history l = {0};
    struct account a;
    history_read_bytes(&l, b.data, b.len);
    account_make(&a, &l);
    near(a.run_s[0], .3);
    near(a.run_s[1], .102);
    near(a.makespan_s, .402);
    assert_int_equal(a.tasks, 4);
    near(a.spans[0].begin_s, .02);
    near(a.slots[1].times.wasted_s, .05);
    const struct account_slot all = account_total(&a);
    assert_int_equal(all.tasks, 5);
    assert_int_equal(all.duplicates, 1);
    assert_int_equal(all.retries, 1);
    near(all.cpu_s, .441);
    near(all.times.busy_s + all.times.wasted_s + all.times.startup_s + all.times.waiting_s +
             all.times.tail_s,
        3 * .402);
    near(account_bound(&a, NULL), .2); /* the dearest task on one slot */
    a.slots[1].power = .5;             /* its task would take .1 at power 1 */
    near(account_bound(&a, NULL), (.09 + .1 + .1 + .001) / 2.5);
    account_free(&a);
    history_free(&l);
    buf_free(&b);
}

/* One log of four rows, the dearest of 6 us; the other has the same pixels, perhaps in columns. */
static double bound_us(bool split)
{
    static const char *const lines[] = {"frame 0 8 4 job=" JOB, NULL};
    struct buf rows = of_lines(lines), other = of_lines(lines);
    struct history one = {0}, l = {0};
    struct account a;
    for (uint32_t y = 0; y < H; y++)
        put_done(&rows, y, (struct lattice){0, y, W, 1, 1, 1}, y ? 1 : 6);
    for (uint32_t i = 0; i < 2; i++)
        put_done(&other, i,
            split ? (struct lattice){4 * i, 0, 4, H, 1, 1} : (struct lattice){0, 2 * i, W, 2, 1, 1},
            7);
    history_read_bytes(&one, rows.data, rows.len);
    history_read_bytes(&l, other.data, other.len);
    account_make(&a, &l);
    struct account_slot two[2] = {a.slots[0], a.slots[0]};
    struct account pair = a;
    pair.slots = two;
    pair.n_slots = 2;
    two[0].power = two[1].power = 1.25;
    double bound_s = account_bound(&pair, &one);
    account_free(&a);
    history_free(&one);
    history_free(&l);
    buf_free(&rows);
    buf_free(&other);
    return bound_s * 1e6;
}

static void the_bound_is_the_same_for_all_cuts(void **state)
{
    (void)state;
    near(bound_us(false), 9 / 2.5); /* not 6 / 1.25, the dearest row on one slot */
    near(bound_us(true), 9 / 2.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slots_of_hellos_and_of_records),
        cmocka_unit_test(a_lone_worker_is_no_idle_slot),
        cmocka_unit_test(times_of_two_runs),
        cmocka_unit_test(the_bound_is_the_same_for_all_cuts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
