/*
 * task: the tasks of a frame in an order, with their slots. On frames of random sizes every unit in
 * every order has each pixel once, and slots get the shares that are stated.
 */
#include "task/task.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define SIDE_MOST 40
#define ROUNDS 60
#define SLOTS_MOST 7

enum order { ASCENDING, SAMPLED, SORTED, ORDERS };
static const char *const units[] = {"row", "tile:7x5", "run:13", "run:1", "run:5000", "scatter",
    "fine", "coarse:9", "guided", "guided:7", "factoring", "factoring:3"};
#define UNITS (sizeof units / sizeof *units)

static uint64_t counter;
static uint32_t draw(uint32_t least, uint32_t most)
{
    return least + (uint32_t)(rng_unit(7, ++counter) * (most - least + 1));
}

static struct cut cut_of(const char *unit, int slots)
{
    struct cut cut;
    assert_true(cut_parse(unit, &cut));
    if (cut.unit == CUT_SCATTER) cut.w = (uint32_t)slots;
    return cut;
}

static double cost[SIDE_MOST * SIDE_MOST];

/* Few values, so that many tasks are equals. */
static void begin(
    struct cut_tasks *c, const struct cut *cut, uint32_t w, uint32_t h, enum order order)
{
    cut_tasks_begin(c, cut, w, h, SLOTS_MOST, NULL);
    for (uint32_t i = 0; i < c->n; i++) cost[i] = draw(0, 3);
    if (order == SAMPLED) cut_tasks_sample(c);
    if (order == SORTED) cut_tasks_sort(c, cost);
}

/* Marks the pixels of t, none of which was there. */
static void take(struct coverage *all, const struct task *t)
{
    assert_true(lattice_valid(&t->at, all->w, all->h));
    for (uint64_t k = 0; k < lattice_count(&t->at); k++)
        assert_true(coverage_set(all, lattice_pixel(&t->at, all->w, k)));
}

static void every_order_has_each_pixel_and_each_id_once(void **state)
{
    (void)state;
    for (size_t i = 0; i < ROUNDS * UNITS * ORDERS; i++) {
        uint32_t w = draw(1, SIDE_MOST), h = draw(1, SIDE_MOST), n = 0;
        struct cut cut = cut_of(units[i % UNITS], SLOTS_MOST);
        struct cut_tasks c;
        struct task t;
        struct coverage all;
        bool seen[SIDE_MOST * SIDE_MOST] = {0};
        begin(&c, &cut, w, h, (enum order)(i / UNITS % ORDERS));
        coverage_init(&all, w, h);
        for (; cut_tasks_next(&c, &t); n++) {
            assert_true(t.id < c.n && !seen[t.id]);
            seen[t.id] = true;
            take(&all, &t);
        }
        assert_int_equal(n, c.n);
        assert_true(coverage_full(&all));
        coverage_free(&all);
        cut_tasks_end(&c);
    }
}

/* An order changes neither the number nor the pixels of a task. */
static void an_order_only_orders(void **state)
{
    (void)state;
    struct cut cut = cut_of("tile:7x5", 1);
    for (enum order order = ASCENDING; order < ORDERS; order++) {
        struct cut_tasks c;
        struct task t;
        begin(&c, &cut, 33, 21, order);
        while (cut_tasks_next(&c, &t)) {
            struct task same = cut_task(&cut, 33, 21, t.id);
            assert_memory_equal(&t.at, &same.at, sizeof t.at);
        }
        cut_tasks_end(&c);
    }
}

static void the_dearest_come_first_and_equals_by_id(void **state)
{
    (void)state;
    struct cut cut = cut_of("run:3", 1);
    struct cut_tasks c;
    struct task t, before;
    begin(&c, &cut, 30, 30, SORTED);
    assert_true(cut_tasks_next(&c, &before));
    for (; cut_tasks_next(&c, &t); before = t)
        assert_true(
            cost[before.id] > cost[t.id] || (cost[before.id] == cost[t.id] && before.id < t.id));
    cut_tasks_end(&c);
}

/* ---- slots ----------------------------------------------------------------------------------- */

static void without_slots_no_task_has_one(void **state)
{
    (void)state;
    struct cut cut = cut_of("row", 1);
    struct cut_tasks c;
    struct task t;
    cut_tasks_begin(&c, &cut, 4, 9, 0, NULL);
    while (cut_tasks_next(&c, &t)) assert_int_equal(t.to, -1);
    cut_tasks_end(&c);
}

/* Interleaved I of N: the shares are disjoint, complete, and differ by one task at most. */
static void slots_take_turns_in_the_order_written(void **state)
{
    (void)state;
    for (int i = 0; i < ROUNDS; i++) {
        int slots = (int)draw(1, SLOTS_MOST);
        uint32_t w = draw(1, SIDE_MOST), h = draw(1, SIDE_MOST), n = 0, of[SLOTS_MOST] = {0};
        struct cut cut = cut_of("run:3", slots);
        struct cut_tasks c;
        struct task t;
        struct coverage share[SLOTS_MOST], all;
        cut_tasks_begin(&c, &cut, w, h, slots, NULL);
        for (uint32_t k = 0; k < c.n; k++) cost[k] = draw(0, 1000);
        cut_tasks_sort(&c, cost);
        coverage_init(&all, w, h);
        for (int k = 0; k < slots; k++) coverage_init(&share[k], w, h);
        for (; cut_tasks_next(&c, &t); n++) {
            assert_int_equal(t.to, n % (uint32_t)slots);
            take(&share[t.to], &t);
            take(&all, &t);
            of[t.to]++;
        }
        assert_true(coverage_full(&all));
        uint64_t sum = 0;
        for (int k = 0; k < slots; k++) {
            assert_in_range(of[k], n / (uint32_t)slots, n / (uint32_t)slots + 1);
            sum += share[k].done;
            coverage_free(&share[k]);
        }
        assert_int_equal(sum, (uint64_t)w * h);
        coverage_free(&all);
        cut_tasks_end(&c);
    }
}

/* The slots of the first n tasks as digits. */
static void by_power(const double *power, int slots, size_t n, char *text)
{
    struct cut cut = cut_of("run:1", slots);
    struct cut_tasks c;
    struct task t;
    cut_tasks_begin(&c, &cut, 1000, 10, slots, power);
    for (size_t i = 0; i < n; i++) {
        assert_true(cut_tasks_next(&c, &t));
        text[i] = (char)('0' + t.to);
    }
    text[n] = '\0';
    cut_tasks_end(&c);
}

static void powers_weigh_the_interleave(void **state)
{
    (void)state;
    char text[5001];
    by_power((double[]){1, 2, 1}, 3, 8, text);
    assert_string_equal(text, "01210121");
    by_power((double[]){1, 1, 1, 1}, 4, 8, text);
    assert_string_equal(text, "01230123");
    by_power((double[]){.1, .1, .1}, 3, 9, text); /* ten rounds of .1 */
    assert_string_equal(text, "012012012");
    by_power((double[]){.3, .1}, 2, 14, text); /* as with exact numbers */
    assert_string_equal(text, "00010001000100");
    by_power((double[]){.5, 1}, 2, 9, text);
    assert_string_equal(text, "101101101");
    by_power((double[]){1e6, 1e-6}, 2, 5000, text);
    assert_null(strchr(text, '1'));
    const double power[] = {.3, 1.7, 2.5, .5};
    by_power(power, 4, 5000, text);
    for (size_t n = 5; n <= 5000;
         n++) { /* each slot has its share at each time, within three tasks */
        size_t of[4] = {0};
        for (size_t i = 0; i < n; i++) of[text[i] - '0']++;
        for (int k = 0; k < 4; k++)
            assert_true(fabs((double)of[k] - (double)n * power[k] / 5) <= 3);
    }
}

/* Parts of rows: no slot is far from its share at any time, but its tasks are not at equal
 * distances. Equal slots take turns. */
static void fine_tasks_lie_at_random_places(void **state)
{
    (void)state;
    enum { SLOTS = 14 };
    double power[SLOTS] = {20}, sum = 20;
    for (int k = 1; k < SLOTS; k++) sum += power[k] = k == 13 ? .3 : 1;
    for (int equal = 0; equal < 2; equal++) {
        struct cut cut = cut_of("fine", 1);
        struct cut_tasks c;
        struct task t;
        int32_t n = 0, of[SLOTS] = {0}, last = 0, distances = 0;
        bool seen[4000] = {false};
        for (int k = 0; equal && k < SLOTS; k++) power[k] = 7;
        cut_tasks_begin(&c, &cut, 512, 512, SLOTS, power);
        for (; cut_tasks_next(&c, &t); n++) {
            of[t.to]++;
            if (equal) assert_int_equal(t.to, n % SLOTS);
            for (int k = 0; !equal && k < SLOTS; k++)
                assert_true(fabs(of[k] - n * power[k] / sum) < 1 + SLOTS * power[k] / sum);
            if (equal || t.to != 1) continue;
            distances += !seen[n - last];
            seen[n - last] = true;
            last = n;
        }
        assert_int_equal(n, c.n);
        assert_true(equal || distances > 20);
        cut_tasks_end(&c);
    }
}

static void with_powers_the_first_chunks_go_to_their_slots(void **state)
{
    (void)state;
    struct cut cut = cut_of("factoring", 3);
    struct cut_tasks c;
    struct task t;
    int32_t n = 0;
    cut_tasks_begin(&c, &cut, 8, 100, 3, (double[]){1, 3, 1});
    for (; cut_tasks_next(&c, &t); n++) {
        if (n < 3) assert_int_equal(t.at.h, n == 1 ? 30 : 10);
        assert_int_equal(t.to, n < 3 ? n : -1);
    }
    cut_tasks_end(&c);
}

/* ---- less than all --------------------------------------------------------------------------- */

/* Pixels that are there are left out: a task that has no other comes not, and takes no turn. */
static void what_is_there_is_left_out(void **state)
{
    (void)state;
    for (size_t i = 0; i < ROUNDS * UNITS; i++) {
        uint32_t w = draw(1, SIDE_MOST), h = draw(1, SIDE_MOST), turn = 0;
        struct cut cut = cut_of(units[i % UNITS], SLOTS_MOST);
        struct cut_tasks c;
        struct task t;
        struct coverage have, all;
        coverage_init(&have, w, h);
        for (uint64_t p = 0; p < (uint64_t)w * h; p++)
            if (p / w < h / 2) coverage_set(&have, p);
        coverage_copy(&all, &have);
        begin(&c, &cut, w, h, i % 2 ? SAMPLED : ASCENDING);
        c.have = &have;
        while (cut_tasks_next(&c, &t)) {
            assert_true(!cut_in_chunks(&cut) ? t.to == (int32_t)(turn++ % SLOTS_MOST) : t.to == -1);
            for (uint64_t k = 0; k < lattice_count(&t.at); k++)
                coverage_set(&all, lattice_pixel(&t.at, w, k));
        }
        assert_true(coverage_full(&all));
        coverage_free(&have);
        coverage_free(&all);
        cut_tasks_end(&c);
    }
}

static void only_the_first_are_assigned(void **state)
{
    (void)state;
    struct cut cut = cut_of("row", 2);
    for (uint32_t assigned = 0; assigned <= 11; assigned++) {
        struct cut_tasks c;
        struct task t;
        cut_tasks_begin(&c, &cut, 4, 10, 2, NULL);
        c.assigned = assigned;
        while (cut_tasks_next(&c, &t))
            assert_int_equal(t.to, t.id < assigned ? (int32_t)t.id % 2 : -1);
        cut_tasks_end(&c);
    }
}

static void a_share_is_a_number_or_a_fraction(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t n, expected; /* of n tasks */
    } good[] = {{"0", 9, 0}, {"5", 9, 5}, {"50", 9, 50}, {"4294967295", 9, UINT32_MAX},
        {"1/2", 9, 4}, {"0/7", 9, 0}, {"3/3", 9, 9}, {"400/512", 768, 600},
        {"4294967295/4294967295", UINT32_MAX, UINT32_MAX}, {"1/4294967295", 9, 0}};
    static const char *const bad[] = {"", "x", "-1", "/", "1/", "/1", "4/3", "0/0", "4294967296",
        "1/4294967296", "1/2/3", "123456789012345678901234567890"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct cut_share share;
        assert_true(cut_share_parse(good[i].text, &share));
        assert_int_equal(cut_share_of(&share, good[i].n), good[i].expected);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct cut_share share;
        if (cut_share_parse(bad[i], &share)) fail_msg("`%s` is taken", bad[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_order_has_each_pixel_and_each_id_once),
        cmocka_unit_test(an_order_only_orders),
        cmocka_unit_test(the_dearest_come_first_and_equals_by_id),
        cmocka_unit_test(without_slots_no_task_has_one),
        cmocka_unit_test(slots_take_turns_in_the_order_written),
        cmocka_unit_test(powers_weigh_the_interleave),
        cmocka_unit_test(fine_tasks_lie_at_random_places),
        cmocka_unit_test(with_powers_the_first_chunks_go_to_their_slots),
        cmocka_unit_test(what_is_there_is_left_out),
        cmocka_unit_test(only_the_first_are_assigned),
        cmocka_unit_test(a_share_is_a_number_or_a_fraction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
