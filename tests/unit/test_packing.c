/*
 * Packing. coder: there and back for every form and length; the bytes of an arrangement; what
 * shrinks; damage, bombs and wrong sizes are refused without a write beyond the room; when packing
 * pays. Packed records of wire: there and back; negotiation; bad lines; damage costs one record.
 */
#include "coder/coder.h"
#include "wire/wire.h"

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
    for (size_t plain = 0; plain <= n + GUARD; plain++)
        if (plain != n)
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
    /* and what others packed so is not unpacked: 65536 zeros as a frame of RFC 8878. */
    const unsigned char bomb[] = {0x28, 0xb5, 0x2f, 0xfd, 0xa0, 0, 0, 1, 0, 3, 0, 8, 0};
    assert_false(coder_unpack(zeros, 65536, CODER_BYTES, bomb, sizeof bomb));
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

/* ---- records ---------------------------------------------------------------------------- */

#define JOB "0123456789abcdef"
#define PIXELS 96

static void put_frag(struct buf *b, uint32_t id)
{
    float rgba[4 * PIXELS];
    struct task t = {.id = id, .at = {0, id, PIXELS, 1, 1, 1}, .to = -1};
    for (int i = 0; i < 4 * PIXELS; i++) rgba[i] = i % 4 == 3 ? 1 : (float)id + .001f * (float)i;
    wire_frag(b, &t, &t.at, JOB, rgba);
}

/* Binary numbers, as in a grid. */
static void put_grid(struct buf *b)
{
    unsigned char body[8192];
    for (size_t i = 0; i < sizeof body / 4; i++)
        float_to(body + 4 * i, 280 + (float)rng_unit(8, i));
    wire_state(b, REC_GRID, body, sizeof body);
}

static void put_scene(struct buf *b)
{
    char text[2000];
    for (size_t i = 0; i < sizeof text; i++) text[i] = "s 1 0.5 22 7 .3\n"[rng_u64(9, i) % 16];
    wire_state(b, REC_SCENE, text, sizeof text);
}

/* The first record of the unread bytes of b, which stay its memory. */
static struct record first(const struct buf *b)
{
    struct decoder d = wire_over(b->data + b->off, buf_size(b));
    struct record r;
    if (wire_next(&d, &r) != WIRE_RECORD) fail_msg("refused: %s", d.why);
    return r;
}

static struct decoder decoder_of(const struct buf *b, bool coded)
{
    struct decoder d = {.coded = coded};
    wire_feed(&d, buf_data(b), buf_size(b));
    wire_end(&d);
    return d;
}

static void assert_next(struct decoder *d, const struct record *expected)
{
    struct record r;
    if (wire_next(d, &r) != WIRE_RECORD) fail_msg("refused: %s", d->why);
    assert_int_equal(r.kind, expected->kind);
    assert_int_equal(r.line_len, expected->line_len);
    assert_memory_equal(r.line, expected->line, r.line_len);
    assert_int_equal(r.body_len, expected->body_len);
    assert_memory_equal(r.body, expected->body, r.body_len);
}

static void assert_end(struct decoder *d, uint64_t bad)
{
    struct record r;
    while (wire_next(d, &r) != WIRE_MORE) assert_true(d->bad <= bad);
    assert_int_equal(d->bad, bad);
    wire_free(d);
}

/* Four packed records one after the other are the plain ones, for a reader that takes them. */
static void packed_records_come_back_as_they_were(void **state)
{
    (void)state;
    struct buf plain[4] = {{0}}, b = {0};
    struct record r[4];
    put_frag(&plain[0], 1);
    put_grid(&plain[1]);
    put_scene(&plain[2]);
    put_frag(&plain[3], 3);
    for (int i = 0; i < 4; i++) {
        r[i] = first(&plain[i]);
        const size_t at = buf_size(&b);
        assert_true(wire_pack(&b, &r[i]));
        assert_true(buf_size(&b) - at < buf_size(&plain[i]));
    }
    struct decoder d = decoder_of(&b, true);
    for (int i = 0; i < 4; i++) assert_next(&d, &r[i]);
    assert_end(&d, 0);
    d = decoder_of(&b, false);
    assert_int_equal(wire_next(&d, &(struct record){0}), WIRE_BAD);
    assert_non_null(strstr(d.why, "packed body, expected plain ones here"));
    wire_free(&d);
    for (int i = 0; i < 4; i++) buf_free(&plain[i]);
    buf_free(&b);
}

/* Of two records the last is packed in place, if it is a frag without such keys of its own. */
static void the_last_frag_is_packed_in_place(void **state)
{
    (void)state;
    struct buf plain = {0}, b = {0};
    put_frag(&plain, 1);
    put_frag(&b, 1);
    const size_t one = buf_size(&b);
    put_frag(&b, 1);
    wire_pack_last(&b, one);
    assert_memory_equal(buf_data(&b), buf_data(&plain), one);
    assert_true(buf_size(&b) < 2 * one);
    struct decoder d = decoder_of(&b, true);
    const struct record r = first(&plain);
    assert_next(&d, &r);
    assert_next(&d, &r);
    assert_end(&d, 0);
    buf_consume(&b, buf_size(&b));
    put_scene(&b);
    const size_t n = buf_size(&b);
    wire_pack_last(&b, 0);
    assert_int_equal(buf_size(&b), n);
    /* A key of the same name, but of another meaning, stays. */
    buf_consume(&b, buf_size(&b));
    wire_forward(&b, &r, NULL, "words=none");
    const struct record named = first(&b);
    assert_false(wire_pack(&plain, &named));
    assert_int_equal(buf_size(&plain), one);
    buf_free(&plain);
    buf_free(&b);
}

/* A flipped bit costs its record at most; the one before and the one behind are there. */
static void damage_costs_one_record(void **state)
{
    (void)state;
    struct buf plain[3] = {{0}}, b = {0};
    struct record r[3], got;
    size_t at[4] = {0};
    for (uint32_t i = 0; i < 3; i++) {
        put_frag(&plain[i], i);
        r[i] = first(&plain[i]);
        assert_true(wire_pack(&b, &r[i]));
        at[i + 1] = buf_size(&b);
    }
    for (size_t bit = 8 * at[1]; bit < 8 * at[2]; bit++) {
        b.data[b.off + bit / 8] ^= (unsigned char)(1 << bit % 8);
        struct decoder d = decoder_of(&b, true);
        assert_next(&d, &r[0]);
        int seen = 1;
        uint32_t last = 0;
        for (enum wire_result result; (result = wire_next(&d, &got)) != WIRE_MORE;) {
            if (result == WIRE_BAD) continue;
            seen++;
            last = got.task.id;
            const struct record *same = &r[last < 3 ? last : 0];
            assert_true(last > 0 && last < 3 && got.body_len == same->body_len);
            assert_memory_equal(got.body, same->body, got.body_len);
        }
        assert_int_equal(seen + (int)d.bad, 3);
        assert_int_equal(last, 2);
        wire_free(&d);
        b.data[b.off + bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
    for (int i = 0; i < 3; i++) buf_free(&plain[i]);
    buf_free(&b);
}

/* These lines are refused before their body has come. */
static void bad_lines_of_packed_records_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *line, *why;
    } bad[] = {
        {"scene crc=1 bytes=10 plain=10\n", "of another size"},
        {"scene crc=1 bytes=10 plain=10241\n", "of another size"},
        {"scene crc=1 bytes=10 plain=9\n", "of another size"},
        {"grid crc=1 bytes=2147483646 plain=2147483648\n", "of another size"},
        {"grid crc=1 bytes=10 plain=20 words=8\n", "words=4, in state"},
        {"grid bytes=10 plain=20\n", "packed body without crc"},
        {"frag 0 0 0 0 1 1 1 1 job=0 ch=4 crc=1 bytes=10 plain=16 words=4\n", "words=4, in state"},
        {"frag 0 0 0 0 1 1 1 1 job=0 ch=4 crc=1 bytes=10 plain=17\n", "bytes=16*W*H"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct decoder d = {.coded = true};
        wire_feed(&d, bad[i].line, strlen(bad[i].line));
        assert_int_equal(wire_next(&d, &(struct record){0}), WIRE_BAD);
        if (!strstr(d.why, bad[i].why)) fail_msg("%s: %s", bad[i].line, d.why);
        wire_free(&d);
    }
}

/* The crc is that of the plain body: a whole packed body in the place of another is refused. */
static void the_body_of_another_record_is_refused(void **state)
{
    (void)state;
    struct buf plain = {0}, other = {0}, b = {0};
    put_frag(&plain, 1);
    put_frag(&other, 2);
    struct record r = first(&plain);
    const struct record from = first(&other);
    r.body = from.body;
    assert_true(wire_pack(&b, &r));
    struct decoder d = decoder_of(&b, true);
    assert_int_equal(wire_next(&d, &r), WIRE_BAD);
    assert_non_null(strstr(d.why, "crc differs"));
    wire_free(&d);
    buf_free(&plain);
    buf_free(&other);
    buf_free(&b);
}

/* The answer to a probe has the length that was asked for, on the wire as well. */
static void an_answer_to_a_probe_is_not_packed(void **state)
{
    (void)state;
    struct buf b = {0}, packed = {0};
    struct record r;
    wire_probe(&b, 5000, NULL);
    struct decoder d = {.upward = true, .coded = true};
    wire_feed(&d, buf_data(&b), buf_size(&b));
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    assert_true(r.kind == REC_CODE && r.body_len == 5000);
    assert_false(wire_pack(&packed, &r));
    wire_free(&d);
    buf_free(&packed);
    buf_free(&b);
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
        cmocka_unit_test(packed_records_come_back_as_they_were),
        cmocka_unit_test(the_last_frag_is_packed_in_place),
        cmocka_unit_test(damage_costs_one_record),
        cmocka_unit_test(bad_lines_of_packed_records_are_refused),
        cmocka_unit_test(the_body_of_another_record_is_refused),
        cmocka_unit_test(an_answer_to_a_probe_is_not_packed),
    };
    if (!coder_there()) return puts("1..0 # SKIP built without libzstd"), 0;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
