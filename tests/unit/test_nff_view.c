/* A view in a file of its own: what is taken, what is refused and where, truncations, writing. */
#include "scene/scene.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define KEY "from 1 2 3\nat .5 0 -1\nup 0 0 1\nangle 30\n"

static bool same(const struct view *a, const struct view *b)
{
    return v3_len(v3_sub(a->from, b->from)) == 0 && v3_len(v3_sub(a->at, b->at)) == 0 &&
           v3_len(v3_sub(a->up, b->up)) == 0 && a->angle_deg == b->angle_deg &&
           a->hither == b->hither && a->res_x == b->res_x && a->res_y == b->res_y;
}

static void test_taken(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double hither;
        uint32_t w, h;
    } of[] = {
        {KEY, 0, 0, 0},
        {KEY "hither .5\nresolution 640 480\n", .5, 640, 480},
        {"\xef\xbb\xbf# a key\r\nangle 30\r\nup 0 0 1 at .5 0 -1\r\nfrom\r\n1 2 3 # eye", 0, 0, 0},
        {"resolution 4 3 " KEY "hither 0\n\x1a", 0, 4, 3},
    };
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const struct view want = {
            {1, 2, 3}, {.5, 0, -1}, {0, 0, 1}, 30, of[i].hither, of[i].w, of[i].h};
        struct view v = {.res_x = 7};
        char err[SCENE_ERR];
        if (nff_read_view("k", of[i].text, strlen(of[i].text), &v, err) != 0)
            fail_msg("%zu: %s", i, err);
        assert_true(same(&v, &want));
    }
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } of[] = {
        {"", "k:1: view without 'from', expected from at up angle"},
        {"from 1 2 3\nat 0 0 0\nup 0 0 1\n",
            "k:4: view without 'angle', expected from at up angle"},
        {KEY "map 1 2 3 4\n",
            "k:5: word is 'map', expected one of from at up angle hither resolution"},
        {"v\n" KEY, "k:1: word is 'v', expected one of from at up angle hither resolution"},
        {KEY "\nat 1 1 1\n", "k:6: view: a second 'at', expected one"},
        {"from 1 2\nat 0 0 0\n", "k:2: view from is 'at', expected a number"},
        {"from 1 2", "k:1: the file ends before view from, expected a number"},
        {KEY "hither -1\n", "k:5: view hither is '-1', expected a number from 0 to 1e+18"},
        {KEY "resolution 0 4\n",
            "k:5: view resolution is '0', expected an integer from 1 to 65535"},
        {"at 1 2 3\nfrom 1 2 3\nup 0 0 1\nangle 9\n",
            "k:5: view: from and at are the same point, expected two"},
    };
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        struct view v = {.res_x = 7};
        char err[SCENE_ERR] = "";
        assert_int_equal(nff_read_view("k", of[i].text, strlen(of[i].text), &v, err), -1);
        assert_string_equal(err, of[i].says);
        assert_int_equal(v.res_x, 7);
    }
}

/* Cut anywhere, it is refused, or is the view up to a number that was cut. */
static void test_truncated(void **state)
{
    (void)state;
    static const char text[] = KEY "hither .5\nresolution 64 48\n";
    for (size_t n = 0; n < sizeof text; n++) {
        struct view v;
        char err[SCENE_ERR], *part = xmalloc(n, 1);
        if (n) memcpy(part, text, n);
        const int rc = nff_read_view("k", part, n, &v, err);
        if (n + 4 < sizeof KEY) assert_int_equal(rc, -1);
        if (rc) assert_memory_equal(err, "k:", 2);
        else assert_true(v.from.z == 3 && (v.angle_deg == 30 || v.angle_deg == 3));
        free(part);
    }
}

/* What is written is read as the same view. */
static void test_written(void **state)
{
    (void)state;
    static const struct view views[] = {
        {{1.0 / 3, -2e-9, 3e17}, {0, 0, 0}, {0, 1, 0}, 1e-5, 0, 0, 0},
        {{5, 4, 3}, {.1, .2, .3}, {1, 0, 1e-7}, 179.9, 1e9, 65535, 1}};
    for (size_t i = 0; i < 2; i++) {
        char *text = NULL, err[SCENE_ERR];
        size_t n;
        struct view v;
        struct nff_out o = {open_memstream(&text, &n), NFF_DIGITS_MAX};
        nff_put_view_words(&o, &views[i]);
        assert_int_equal(fclose(o.f), 0);
        if (nff_read_view("k", text, n, &v, err) != 0) fail_msg("%s\n%s", err, text);
        assert_true(same(&v, &views[i]));
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_taken),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
