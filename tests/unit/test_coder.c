/*
 * coder: there and back for every form and length; the bytes of an arrangement; what shrinks;
 * damage, bombs and wrong sizes are refused without a write beyond the room; when packing pays.
 */
#include "coder/coder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define GUARD 64

static const enum coder_form forms[] = {CODER_BYTES, CODER_WORDS, CODER_PIXELS};

static void float_to(unsigned char *to, float v)
{
    uint32_t bits;
    memcpy(&bits, &v, 4);
    for (int k = 0; k < 4; k++) to[k] = (unsigned char)(bits >> (8 * k));
}

/* Opaque pixels of smooth light. */
static void smooth(unsigned char *to, size_t pixels)
{
    for (size_t i = 0; i < 4 * pixels; i++)
        float_to(
            to + 4 * i, i % 4 == 3 ? 1 : (float)(.3 + .0001 * (double)i + .1 * (double)(i % 4)));
}

static void the_arrangement_is_that_of_the_page(void **state)
{
    (void)state;
    unsigned char out[40];
    const unsigned char words[] = {1, 2, 3, 4, 11, 12, 13, 14, 99};
    const unsigned char in_planes[] = {1, 11, 2, 12, 3, 13, 4, 14, 99};
    coder_arrange(out, CODER_WORDS, words, sizeof words);
    assert_memory_equal(out, in_planes, sizeof words);
    coder_arrange(out, CODER_BYTES, words, sizeof words);
    assert_memory_equal(out, words, sizeof words);
    /* Red 0x01020304 rises by 1; green falls from 2 to 1; blue and alpha are constant. */
    const unsigned char pixels[] = {4, 3, 2, 1, 2, 0, 0, 0, 7, 0, 0, 0, 0, 0, 128, 63, /* and */
        5, 3, 2, 1, 1, 0, 0, 0, 7, 0, 0, 0, 0, 0, 128, 63, 77};
    const unsigned char planes[] = {8, 2, 6, 0, 4, 0, 2, 0, /* red */
        4, 1, 0, 0, 0, 0, 0, 0, 14, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 127, 0, 77};
    coder_arrange(out, CODER_PIXELS, pixels, sizeof pixels);
    /* 0x3f800000 doubled is 0x7f000000 */
    assert_memory_equal(out, planes, sizeof pixels);
}

static void arranged_bytes_are_restored(void **state)
{
    (void)state;
    unsigned char in[100], out[100], back[100 + GUARD];
    for (size_t i = 0; i < sizeof in; i++) in[i] = (unsigned char)rng_u64(3, i);
    for (size_t k = 0; k < 3; k++)
        for (size_t n = 0; n <= sizeof in; n++) {
            memset(back, 0xa5, sizeof back);
            coder_arrange(out, forms[k], in, n);
            coder_restore(back, forms[k], out, n);
            assert_memory_equal(back, in, n);
            for (size_t i = n; i < sizeof back; i++) assert_int_equal(back[i], 0xa5);
        }
}

/* Packs and unpacks; returns the packed size, 0 if it was not packed. */
static size_t round_trip(enum coder_form form, const unsigned char *p, size_t n)
{
    struct buf b = {0};
    buf_append(&b, "before", 6);
    bool packed = coder_pack(&b, form, p, n);
    assert_memory_equal(buf_data(&b), "before", 6);
    size_t size = buf_size(&b) - 6;
    assert_int_equal(packed, size > 0);
    if (packed) {
        assert_true(size < n && size * CODER_RATIO_MAX >= n);
        unsigned char *out = xmalloc(n + GUARD, 1);
        memset(out, 0xa5, n + GUARD);
        assert_true(coder_unpack(out, n, form, buf_data(&b) + 6, size));
        assert_memory_equal(out, p, n);
        for (size_t i = n; i < n + GUARD; i++) assert_int_equal(out[i], 0xa5);
        free(out);
    }
    buf_free(&b);
    return size;
}

static void bodies_come_back_as_they_were(void **state)
{
    (void)state;
    const size_t sizes[] = {0, 1, 15, 16, 17, 4096, CODER_BLOCK - 16, CODER_BLOCK, CODER_BLOCK + 1,
        3 * CODER_BLOCK + 5};
    unsigned char *p = xmalloc(3 * CODER_BLOCK + 32, 1);
    smooth(p, (3 * CODER_BLOCK + 16) / 16);
    for (size_t k = 0; k < 3; k++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) round_trip(forms[k], p, sizes[i]);
    assert_in_range(round_trip(CODER_PIXELS, p, CODER_BLOCK), 1, CODER_BLOCK / 3);
    for (size_t i = 0; i < CODER_BLOCK; i++) p[i] = (unsigned char)rng_u64(5, i);
    for (size_t k = 0; k < 3; k++) assert_int_equal(round_trip(forms[k], p, CODER_BLOCK), 0);
    free(p);
}

static void a_constant_alpha_costs_next_to_nothing(void **state)
{
    (void)state;
    const size_t pixels = 4096, n = pixels * CODER_PIXEL_BYTES;
    unsigned char *p = xmalloc(n, 1);
    for (size_t i = 0; i < n; i++) p[i] = (unsigned char)rng_u64(6, i);
    for (size_t i = 0; i < pixels; i++) float_to(p + 16 * i + 12, 1);
    assert_in_range(round_trip(CODER_PIXELS, p, n), 1, pixels * 12 + pixels / 10);
    free(p);
}

static void numbers_are_packed_as_words(void **state)
{
    (void)state;
    const size_t n = 300000;
    unsigned char *p = xmalloc(n + 8, 1);
    for (size_t i = 0; i < n / 4; i++) float_to(p + 3 + 4 * i, 280 + (float)rng_unit(8, i));
    for (size_t i = 0; i < 3; i++) p[i] = 'D';
    assert_int_equal(coder_form_of(p, n), CODER_WORDS);
    for (size_t i = 0; i < n; i++) p[i] = (unsigned char)"s 1 0.5 22 7 .3\n"[rng_u64(9, i) % 16];
    assert_int_equal(coder_form_of(p, n), CODER_BYTES);
    assert_int_equal(coder_form_of(p, 0), CODER_BYTES);
    free(p);
}

/* Whatever the damage: nothing beyond the room is written, and another size is refused. */
static void damage_stays_within_its_room(void **state)
{
    (void)state;
    const size_t n = 64 * CODER_PIXEL_BYTES;
    unsigned char p[64 * CODER_PIXEL_BYTES], out[64 * CODER_PIXEL_BYTES + GUARD];
    struct buf b = {0};
    smooth(p, 64);
    assert_true(coder_pack(&b, CODER_PIXELS, p, n));
    for (size_t plain = 0; plain < n; plain++)
        assert_false(coder_unpack(out, plain, CODER_PIXELS, buf_data(&b), buf_size(&b)));
    for (size_t size = 0; size < buf_size(&b); size++)
        assert_false(coder_unpack(out, n, CODER_PIXELS, buf_data(&b), size));
    for (uint64_t i = 0; i < 20000; i++) {
        unsigned char *bad = xmalloc(buf_size(&b), 1);
        memcpy(bad, buf_data(&b), buf_size(&b));
        for (uint64_t k = 0; k <= i % 3; k++)
            bad[rng_u64(i, 2 * k) % buf_size(&b)] ^=
                (unsigned char)(1 << rng_u64(i, 2 * k + 1) % 8);
        memset(out, 0xa5, sizeof out);
        coder_unpack(out, n, CODER_PIXELS, bad, buf_size(&b));
        for (size_t k = n; k < sizeof out; k++) assert_int_equal(out[k], 0xa5);
        free(bad);
    }
    buf_free(&b);
}

static void bombs_are_refused(void **state)
{
    (void)state;
    const size_t n = 16 << 20;
    unsigned char *zeros = xcalloc(n, 1);
    /* A constant body shrinks by more than the limit, so it is not packed, */
    assert_int_equal(round_trip(CODER_BYTES, zeros, n), 0);
    /* and a small packed body is not unpacked to it. */
    struct buf b = {0};
    assert_true(coder_pack(&b, CODER_BYTES, zeros, 4096));
    assert_false(coder_unpack(zeros, n, CODER_BYTES, buf_data(&b), buf_size(&b)));
    buf_free(&b);
    free(zeros);
}

static void packing_pays_on_slow_links(void **state)
{
    (void)state;
    assert_true(coder_speed() > 0);
    assert_true(coder_pays(1.25, 250));  /* 10 Mbit/s */
    assert_true(coder_pays(125, 250));   /* 1 Gbit/s */
    assert_false(coder_pays(1250, 250)); /* 10 Gbit/s */
    assert_false(coder_pays(1.25, 1));   /* a slow machine */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_arrangement_is_that_of_the_page),
        cmocka_unit_test(arranged_bytes_are_restored),
        cmocka_unit_test(bodies_come_back_as_they_were),
        cmocka_unit_test(a_constant_alpha_costs_next_to_nothing),
        cmocka_unit_test(numbers_are_packed_as_words),
        cmocka_unit_test(damage_stays_within_its_room),
        cmocka_unit_test(bombs_are_refused),
        cmocka_unit_test(packing_pays_on_slow_links),
    };
    if (!coder_there()) return puts("1..0 # SKIP built without libzstd"), 0;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
