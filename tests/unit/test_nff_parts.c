/* Reading NFF in parts: the same scene, or the same message, as in one piece. */
#include "rounds.h"
#include "scene/reader.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define VIEW "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 64 48\n"
#define PARTS_MOST 19

static void same_bytes(const void *a, const void *b, size_t n)
{
    assert_true(!a == !b);
    if (n && a) assert_memory_equal(a, b, n);
}

static void same_scene(const struct scene *a, const struct scene *b)
{
    assert_int_equal(a->n_lights, b->n_lights);
    assert_int_equal(a->n_materials, b->n_materials);
    assert_int_equal(a->n_prims, b->n_prims);
    assert_int_equal(a->n_vertices, b->n_vertices);
    same_bytes(&a->view, &b->view, sizeof a->view);
    same_bytes(a->background, b->background, sizeof a->background);
    for (uint32_t i = 0; i < a->n_lights; i++) {
        same_bytes(&a->lights[i].pos, &b->lights[i].pos, 6 * sizeof(double));
        assert_int_equal(a->lights[i].own_colour, b->lights[i].own_colour);
    }
    same_bytes(a->materials, b->materials, a->n_materials * sizeof *a->materials);
    same_bytes(a->vertices, b->vertices, a->n_vertices * sizeof *a->vertices);
    same_bytes(a->normals, b->normals, a->n_vertices * sizeof *a->normals);
    same_bytes(a->prims, b->prims, a->n_prims * sizeof *a->prims);
}

/* The text in one piece, and cut into FIRST to PARTS_MOST parts by steps. Is it a scene? */
static bool same_by_steps(const char *text, size_t n, uint32_t first, uint32_t step)
{
    struct scene want, got;
    char err[SCENE_ERR], err_got[SCENE_ERR];
    int status = nff_read("t", text, n, &want, err);
    for (uint32_t parts = first; parts <= PARTS_MOST; parts += step) {
        assert_int_equal(nff_read_parts("t", text, n, parts, 1, &got, err_got), status);
        assert_string_equal(err_got, err);
        same_scene(&want, &got);
        scene_free(&got);
    }
    scene_free(&want);
    return status == 0;
}

static bool same_by_parts(const char *text, size_t n) { return same_by_steps(text, n, 2, 1); }

/* Seeds take turns on the numbers of parts. */
static bool same_by_turns(const struct buf *b, uint64_t seed)
{
    const uint32_t step = (uint32_t)nightly(4, 1), first = 2 + (uint32_t)(seed / 50 + seed) % step;
    return same_by_steps((const char *)b->data, b->len, first, step);
}

static void put_numbers(struct buf *b, uint64_t seed, uint64_t *n, int count)
{
    static const char *const between[] = {" ", " ", "\t", "\n", "\r\n", " # p 3\n", "\n\n  "};
    for (int i = 0; i < count; i++) {
        int digits = (int)(3 + rng_u64(seed, *n) % 15);
        buf_printf(b, "%s", between[rng_u64(seed, (*n)++) % 7]);
        buf_printf(b, "%.*g", digits, rng_unit(seed, (*n)++) * 8 - 4);
    }
}

static void put_entity(struct buf *b, uint64_t seed, uint64_t *n, bool patches)
{
    static const char *const materials[] = {"1 0 0 .5 .5 10 0 0", "0 1 0 1 0 1 .5 1.5",
        "1 1 1 1 0 0 0 0" /* the default */, "-0 1 0 1 0 1 .5 1.5", "0 0 1 .2 .7 9 0 0"};
    uint64_t kind = rng_u64(seed, (*n)++) % 10, count = 3 + rng_u64(seed, *n) % 5;
    switch (kind) {
    case 0: buf_printf(b, "f %s", materials[rng_u64(seed, (*n)++) % 5]); break;
    case 1:
        buf_printf(b, "l");
        put_numbers(b, seed, n, 3);
        if (rng_u64(seed, *n) & 1) buf_printf(b, "\n.5 .25 1");
        break;
    case 2: buf_printf(b, "# a line that begins with a letter\ns 0 0 %d 1", (int)count); break;
    case 3: buf_printf(b, "c\n1 2 3 4 5 6 7 %d", (int)count); break;
    case 4: buf_printf(b, "%s", scene_sample(rng_u64(seed, (*n)++) % PRIM_KINDS)); break;
    default:
        patches = patches && kind > 6;
        buf_printf(b, patches ? "pp\t%d" : "p %d", (int)count);
        put_numbers(b, seed, n, (int)count * (patches ? 6 : 3));
    }
    buf_append(b, "\n", 1);
}

/* The view and the background are at places of their own. */
static void put_scene(struct buf *b, uint64_t seed)
{
    uint64_t n = 0, entities = 5 + rng_u64(seed, n++) % 60;
    uint64_t view = rng_u64(seed, n++) % entities, background = rng_u64(seed, n++) % entities;
    for (uint64_t i = 0; i < entities; i++) {
        if (i == view) buf_printf(b, VIEW);
        if (i == background) buf_printf(b, "b .25 .5 .75\n");
        put_entity(b, seed, &n, i > entities / 2 && seed % 3);
    }
}

static void test_same(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 150; seed++) {
        struct buf b = {0};
        put_scene(&b, seed);
        assert_true(same_by_turns(&b, seed));
        buf_free(&b);
    }
}

/* One byte changes, or the text ends early: the message has the same line. */
static void test_damaged(void **state)
{
    (void)state;
    static const char bytes[] = "?pslvbf#1 \n-e.";
    int refused = 0, taken = 0;
    for (uint64_t seed = 0; seed < (uint64_t)rounds(500); seed++) {
        struct buf b = {0};
        put_scene(&b, seed % 50);
        size_t at = rng_u64(seed, 1000) % b.len;
        if (seed % 5) b.data[at] = (unsigned char)bytes[seed % (sizeof bytes - 1)];
        else b.len = at;
        bool ok = same_by_turns(&b, seed);
        refused += !ok;
        taken += ok;
        buf_free(&b);
    }
    assert_true(refused > rounds(33) && taken > rounds(33));
}

static void test_contradictions(void **state)
{
    (void)state;
    static const char *const text[] = {"", VIEW, "s 0 0 0 1\n",
        VIEW "s 0 0 0 1\n" VIEW "s 0 0 0 1\n",
        VIEW "b 1 1 1\ns 0 0 0 1\ns 0 0 0 1\ns 0 0 0 1\ns 0 0 0 1\nb 1 1 1\n",
        VIEW "p 3 0 0 0\np 3 1 0 0\ns 0 0 0 1\n", VIEW "p 4 0 0 0 1 0 0 0 1 0\ns 0 0 0 1\n",
        "\xef\xbb\xbf" VIEW "s 0 0 0 1\ns 0 0 0 1\ns 0 0 0 1\ns 0 0 0 1\r\n\x1a",
        "s 0 0 0 1\nv from 0 0 5 at 0 0 0 up 0 1 0\nf 1 1 1 1 0 0 0 0\nangle 45 resolution 6 4\n"};
    int ok = 0;
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        ok += same_by_parts(text[i], strlen(text[i]));
    assert_int_equal(ok, 2);
}

/* A short entity ends the text, behind a long one in which parts are cut. */
static void test_last(void **state)
{
    (void)state;
    for (int corners = 200; corners < 240; corners++) {
        struct buf b = {0};
        buf_printf(&b, VIEW "p %d\n", corners);
        for (int i = 0; i < corners; i++) buf_printf(&b, "%d 0 %d\n", i % 10, i);
        buf_printf(&b, "s 0 0 0 1\n");
        assert_true(same_by_parts((char *)b.data, b.len));
        buf_free(&b);
    }
}

/* By its size, a text is cut or not. */
static void test_threads(void **state)
{
    (void)state;
    for (int lines = 10; lines <= 100000; lines *= 100) {
        struct buf b = {0};
        struct scene want, got;
        char err[SCENE_ERR];
        buf_printf(&b, VIEW);
        for (int i = 0; i < lines; i++)
            buf_printf(&b, "s %d 0 0 1\nf 1 1 .%d 1 0 0 0 0\n", i, i % 99);
        assert_int_equal(nff_read("t", (char *)b.data, b.len, &want, err), 0);
        for (int threads = 1; threads <= 3; threads++) {
            assert_int_equal(nff_read_parallel("t", (char *)b.data, b.len, threads, &got, err), 0);
            same_scene(&want, &got);
            scene_free(&got);
        }
        scene_free(&want);
        buf_free(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_contradictions),
        cmocka_unit_test(test_last),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_same), /* the long ones last: a mutant that others find ends soon */
        cmocka_unit_test(test_damaged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
