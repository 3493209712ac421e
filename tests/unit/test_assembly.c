/* The commit: once per pixel, the first stands; access; memory; missing pixels. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "image/image.h"

#define ROOM (UINT64_C(1) << 30)

static float shade(uint64_t p, int c) { return (float)p + (float)c / 4; }

/* Commits lattice `at` of a frame of width w with shade() + off. */
static enum assembly_verdict put_as(struct assembly *a, uint32_t frame, const char *job,
    uint16_t source, uint32_t w, struct lattice at, float off)
{
    static float rgba[4 * 4096];
    uint64_t n = lattice_count(&at);
    assert_true(n <= 4096);
    for (uint64_t i = 0; i < n; i++)
        for (int c = 0; c < 4; c++)
            rgba[4 * i + (uint64_t)c] = shade(lattice_pixel(&at, w, i), c) + off;
    return assembly_commit(a, frame, job, source, &at, rgba);
}

static enum assembly_verdict put(
    struct assembly *a, uint32_t frame, uint32_t w, struct lattice at, float off)
{
    return put_as(a, frame, "j", 1, w, at, off);
}

static void check_picture(const struct assembly_frame *f)
{
    const struct image_rows rows = assembly_rows(f);
    for (uint32_t y = 0; y < rows.h; y++) {
        const float *row = rows.row(&rows, y);
        for (uint32_t i = 0; i < 4 * rows.w; i++)
            assert_true(row[i] == shade((uint64_t)y * rows.w + i / 4, (int)(i % 4)));
    }
}

/* Rows, tiles, runs that wrap and scattered sets, in shuffled order, each twice: one picture. */
static void test_any_cut_any_order(void **state)
{
    (void)state;
    static const char *const cuts[] = {"row", "tile:7x5", "run:11", "scatter"};
    for (int k = 0; k < 4; k++) {
        struct cut cut;
        assert_true(cut_parse(cuts[k], &cut));
        if (cut.unit == CUT_SCATTER) cut.w = 6;
        struct assembly a;
        assembly_init(&a, true, ROOM);
        assert_int_equal(assembly_declare(&a, 3, 32, 17, "j"), ASSEMBLY_TAKEN);
        uint32_t n = cut_count(&cut, 32, 17), step = 1 + n / 2;
        while (n % step == 0 && step > 1) step--;
        for (uint32_t twice = 0; twice < 2; twice++)
            for (uint32_t i = 0, id = 0; i < n; i++, id = i * 5 % n) {
                if (n % 5 == 0) id = n - 1 - i;
                struct task t = cut_task(&cut, 32, 17, id);
                assert_int_equal(put(&a, 3, 32, t.at, 0), ASSEMBLY_TAKEN);
            }
        struct assembly_frame *f = assembly_find(&a, 3);
        assert_true(coverage_full(&f->have));
        assert_true(assembly_whole(&a));
        assert_int_equal(f->again, 32 * 17);
        assert_int_equal(a.differing, 0);
        check_picture(f);
        assembly_free(&a);
    }
}

/* Overlap: only what is new is taken; what differs is counted, with where and by how much. */
static void test_first_stands(void **state)
{
    (void)state;
    struct assembly a;
    assembly_init(&a, true, ROOM);
    assembly_declare(&a, 0, 8, 8, "j");
    assert_int_equal(put(&a, 0, 8, (struct lattice){0, 0, 8, 4, 1, 1}, 0), ASSEMBLY_TAKEN);
    const struct lattice below = {0, 2, 8, 6, 1, 1};
    assert_int_equal(put_as(&a, 0, "j", 7, 8, below, 0.5f), ASSEMBLY_TAKEN);
    assert_int_equal(
        put_as(&a, 0, "j", 9, 8, (struct lattice){1, 3, 2, 1, 1, 1}, 2), ASSEMBLY_TAKEN);
    struct assembly_frame *f = assembly_find(&a, 0);
    assert_int_equal(f->again, 18);
    assert_int_equal(a.differing, 18);
    assert_int_equal(assembly_again(&a), 0);
    const struct assembly_dispute want[] = {
        {.first = 1, .second = 7, .pixels = 16, .worst = .5, .x = 0, .y = 2},
        {.first = 1, .second = 9, .pixels = 2, .worst = 2, .x = 1, .y = 3}};
    assert_int_equal(a.n_disputes, 2);
    for (int i = 0; i < 2; i++) {
        const struct assembly_dispute *d = &a.disputes[i];
        assert_true(d->first == want[i].first && d->second == want[i].second);
        assert_true(d->pixels == want[i].pixels && d->worst == want[i].worst);
        assert_true(d->x == want[i].x && d->y == want[i].y);
    }
    const struct image_rows rows = assembly_rows(f);
    for (uint64_t p = 0; p < 64; p++)
        assert_true(
            rows.row(&rows, (uint32_t)p / 8)[p % 8 * 4] == shade(p, 0) + (p < 32 ? 0 : 0.5f));
    assembly_free(&a);
}

/* -0 and 0 are equal numbers and different bits: bit by bit is what is asked for. */
static void test_bits_not_values(void **state)
{
    (void)state;
    struct assembly a;
    assembly_init(&a, true, ROOM);
    assembly_declare(&a, 0, 1, 1, "j");
    const struct lattice one = {0, 0, 1, 1, 1, 1};
    const float zero[4] = {0, 0, 0, 0}, minus[4] = {0, -0.0f, 0, 0};
    assembly_commit(&a, 0, "j", 1, &one, zero);
    assert_true(assembly_whole(&a)); /* black, transparent, and there */
    assembly_commit(&a, 0, "j", 1, &one, zero);
    assert_int_equal(a.differing, 0);
    assembly_commit(&a, 0, "j", 1, &one, minus);
    assert_int_equal(a.differing, 1);
    assembly_free(&a);
}

static void test_refusals(void **state)
{
    (void)state;
    struct assembly a;
    const struct lattice row = {0, 0, 8, 1, 1, 1};
    assembly_init(&a, true, ROOM);
    assert_int_equal(put(&a, 0, 8, row, 0), ASSEMBLY_UNDECLARED);
    assembly_declare(&a, 0, 8, 8, "j");
    const struct lattice outside[] = {{0, 8, 8, 1, 1, 1}, {8, 0, 1, 1, 1, 1}, {0, 0, 8, 9, 1, 1},
        {1, 7, 8, 1, 1, 1}, {0, 0, 9, 1, 8, 1}, {0, 0, 2, 2, 60, 1}};
    for (int i = 0; i < 6; i++) assert_int_equal(put(&a, 0, 8, outside[i], 0), ASSEMBLY_OUTSIDE);
    assert_int_equal(assembly_declare(&a, 0, 8, 8, "other"), ASSEMBLY_FOREIGN);
    assert_int_equal(assembly_declare(&a, 0, 8, 9, "j"), ASSEMBLY_FOREIGN);
    assert_int_equal(assembly_declare(&a, 0, 9, 8, "j"), ASSEMBLY_FOREIGN);
    assert_int_equal(put_as(&a, 0, "jj", 1, 8, row, 9), ASSEMBLY_FOREIGN);
    assert_int_equal(put_as(&a, 0, "other", 1, 8, row, 9), ASSEMBLY_FOREIGN);
    assert_int_equal(put_as(&a, 0, "", 1, 8, row, 9), ASSEMBLY_FOREIGN);
    assert_int_equal(assembly_find(&a, 0)->have.done, 0);
    assert_int_equal(put(&a, 0, 8, row, 0), ASSEMBLY_TAKEN);
    assert_int_equal(assembly_declare(&a, 0, 8, 8, "j"), ASSEMBLY_TAKEN);
    assert_int_equal(a.refused[ASSEMBLY_FOREIGN], 3);
    assert_int_equal(a.refused[ASSEMBLY_OUTSIDE], 6);
    assert_int_equal(a.refused[ASSEMBLY_UNDECLARED], 1);
    assert_int_equal(a.differing, 0);
    assembly_free(&a);
}

/* Room for two frames of 16x16: declarations cost nothing, whole ones make room, the last is
 * still compared. */
static void test_memory_is_bounded(void **state)
{
    (void)state;
    struct assembly a;
    const struct lattice all = {0, 0, 16, 16, 1, 1}, row = {0, 0, 16, 1, 1, 1};
    assembly_init(&a, true, 2 * (18 * 16 * 16 + 16 * 16 / 8 + 8));
    for (uint32_t f = 100; f-- > 0;) assembly_declare(&a, f, 16, 16, "j");
    assert_int_equal(put(&a, 0, 16, row, 0), ASSEMBLY_TAKEN);
    assert_int_equal(put(&a, 1, 16, row, 0), ASSEMBLY_TAKEN);
    assert_int_equal(put(&a, 2, 16, row, 0), ASSEMBLY_NO_ROOM);
    for (uint32_t f = 1; f < 100; f++) {
        assert_int_equal(put(&a, f, 16, all, 0), ASSEMBLY_TAKEN);
        struct assembly_frame *frame = assembly_find(&a, f);
        check_picture(frame);
        assembly_release(&a, frame);
        put(&a, f, 16, row, 1); /* late: kept until the next is released */
        assert_int_equal(a.differing, 16 * f);
        if (f > 1) assert_null(assembly_find(&a, f - 1)->pixels);
    }
    put(&a, 5, 16, row, 1); /* too late: counted only */
    assert_int_equal(assembly_find(&a, 5)->again, 16);
    assert_int_equal(assembly_find(&a, 5)->late, 16);
    assert_int_equal(a.differing, 16 * 99);
    assert_int_equal(a.n_disputes, ASSEMBLY_DISPUTES_MAX);
    assert_false(assembly_whole(&a));
    assert_int_equal(put(&a, 0, 16, all, 0), ASSEMBLY_TAKEN);
    assert_true(assembly_whole(&a));
    assembly_free(&a);
}

/* However much room there is: what was written is given back, except for the last. */
static void test_released_is_given_back(void **state)
{
    (void)state;
    struct assembly a;
    const struct lattice all = {0, 0, 16, 16, 1, 1};
    assembly_init(&a, true, ROOM);
    for (uint32_t f = 0; f < 10; f++) {
        assembly_declare(&a, f, 16, 16, "j");
        put(&a, f, 16, all, 0);
        assembly_release(&a, assembly_find(&a, f));
        assert_int_equal(ROOM - a.room_bytes, 18 * 16 * 16 + 16 * 16 / 8 + 8);
    }
    assembly_free(&a);
}

static void test_without_pixels(void **state)
{
    (void)state;
    struct assembly a;
    const struct lattice row = {0, 5, 65535, 1, 1, 1};
    assembly_init(&a, false, ROOM);
    assembly_declare(&a, 0, 65535, 65535, "j");
    assert_int_equal(assembly_commit(&a, 0, "j", 1, &row, NULL), ASSEMBLY_TAKEN);
    assert_int_equal(assembly_commit(&a, 0, "j", 1, &row, NULL), ASSEMBLY_TAKEN);
    assert_int_equal(assembly_find(&a, 0)->have.done, 65535);
    assert_null(assembly_find(&a, 0)->pixels);
    assembly_free(&a);
}

static void missing_is(const struct assembly *a, const char *want)
{
    char text[ASSEMBLY_TEXT];
    assembly_missing_text(assembly_find(a, 0), text);
    assert_string_equal(text, want);
}

static void test_missing_in_words(void **state)
{
    (void)state;
    struct assembly a;
    assembly_init(&a, true, ROOM);
    assert_false(assembly_whole(&a)); /* of nothing, nothing is whole */
    assembly_declare(&a, 0, 4, 40, "j");
    missing_is(&a, "160 of 160 pixels missing: rows 0-39");
    for (uint32_t y = 0; y < 40; y += 2) put(&a, 0, 4, (struct lattice){0, y, 4, 1, 1, 1}, 0);
    missing_is(&a, "80 of 160 pixels missing: rows 1, 3, 5, 7, 9, 11, 13, 15, ...");
    for (uint32_t y = 1; y < 40; y += 2)
        if (y != 7 && y != 21) put(&a, 0, 4, (struct lattice){0, y, 4, 1, 1, 1}, 0);
    missing_is(&a, "8 of 160 pixels missing: rows 7, 21");
    put(&a, 0, 4, (struct lattice){0, 21, 4, 1, 1, 1}, 0);
    put(&a, 0, 4, (struct lattice){1, 7, 2, 1, 1, 1}, 0);
    missing_is(&a, "2 of 160 pixels missing: row 7");
    assembly_free(&a);
}

/* Of 70x31 pixels, 3x3 become one; at the edges, fewer. Missing ones count as transparent black. */
static void test_small(void **state)
{
    (void)state;
    enum { W = 70, H = 31, K = 3 };
    struct assembly a;
    struct image small;
    assembly_init(&a, true, ROOM);
    assembly_declare(&a, 0, W, H, "j");
    put(&a, 0, W, (struct lattice){5, 2, 30, 9, 1, 1}, 0);
    put(&a, 0, W, (struct lattice){1, 20, 10, 2, 7, 1}, 0);
    put(&a, 0, W, (struct lattice){64, 29, 6, 2, 1, 1}, 0);
    const struct assembly_frame *f = assembly_find(&a, 0);
    assert_true(assembly_small(f, 25, &small));
    assert_int_equal(small.w, (W + K - 1) / K);
    assert_int_equal(small.h, (H + K - 1) / K);
    struct image slow;
    image_init(&slow, small.w, small.h);
    const struct image_rows rows = assembly_rows(f);
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            uint32_t w = x / K * K + K > W ? W % K : K, h = y / K * K + K > H ? H % K : K;
            for (uint32_t c = 0; c < 4; c++)
                slow.rgba[4 * (y / K * slow.w + x / K) + c] +=
                    rows.row(&rows, y)[4 * x + c] / ((float)w * (float)h);
        }
    assert_memory_equal(slow.rgba, small.rgba, 4 * sizeof(float) * small.w * small.h);
    image_free(&slow);
    image_free(&small);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_cut_any_order),
        cmocka_unit_test(test_first_stands),
        cmocka_unit_test(test_bits_not_values),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_memory_is_bounded),
        cmocka_unit_test(test_released_is_given_back),
        cmocka_unit_test(test_without_pixels),
        cmocka_unit_test(test_missing_in_words),
        cmocka_unit_test(test_small),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
