/* Reading NFF: what is taken, what is refused and where, every truncation; bounds; writing. */
#include "prim_kinds.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define VIEW "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 64 48\n"

static struct scene parse(const char *text)
{
    struct scene s;
    char err[SCENE_ERR];
    if (nff_read("t", text, strlen(text), &s, err) != 0) fail_msg("refused: %s", err);
    return s;
}

static void assert_vec(struct vec3 v, double x, double y, double z)
{
    assert_true(v.x == x && v.y == y && v.z == z);
}

static void test_view(void **state)
{
    (void)state;
    struct scene s = parse(
        "b .1 .2 3e-1\nv from 1 2 3 at -0 1e-16 0 up 0 0 1 angle 30 hither .5 resolution 640 480");
    assert_vec(s.view.from, 1, 2, 3);
    assert_vec(s.view.at, 0, 1e-16, 0);
    assert_vec(s.view.up, 0, 0, 1);
    assert_true(s.view.angle_deg == 30 && s.view.hither == .5);
    assert_int_equal(s.view.res_x, 640);
    assert_int_equal(s.view.res_y, 480);
    assert_true(s.background[0] == .1 && s.background[1] == .2 && s.background[2] == .3);
    scene_free(&s);
    /* Any order, no hither, after the primitives, background last. */
    s = parse("s 0 0 0 1\nv\nresolution 2 3\nup 0 1 0\nangle 90\nat 0 0 0\nfrom 0 0 5\nb 1 0 0\n");
    assert_true(s.view.hither == 0 && s.view.angle_deg == 90 && s.view.res_y == 3);
    assert_true(s.background[0] == 1 && s.n_prims == 1);
    scene_free(&s);
}

static void test_layout_is_free(void **state)
{
    (void)state;
    static const char *const same[] = {
        VIEW "c 1 2 3 4 5 6 7 8\n",
        VIEW "c\n1 2 3 4\n5 6 7 8",
        VIEW "c#x\n1 2#y 9\n3\t4\f5 # z\n\n 6 7 8#",
        VIEW "# c 9 9 9 9\r\nc 1 2 3 4\r\n5 6 7 8\r\n\x1a",
        "\xef\xbb\xbf" VIEW "c\r1 2 3 4\r5 6 7 8\r",
        VIEW "c +1 2. 3.0e0 4E+0 .5e1 600e-2 7 00008",
    };
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        struct scene s = parse(same[i]);
        assert_int_equal(s.n_prims, 1);
        assert_int_equal(s.prims[0].kind, PRIM_CONE);
        assert_vec(s.prims[0].cone.base, 1, 2, 3);
        assert_vec(s.prims[0].cone.apex, 5, 6, 7);
        assert_true(s.prims[0].cone.base_radius == 4 && s.prims[0].cone.apex_radius == 8);
        scene_free(&s);
    }
}

static void test_lights(void **state)
{
    (void)state;
    struct scene s =
        parse(VIEW "l 1 2 3\nl 4 5 6 .5 .25 2 # own\nl 7 8 9 # 1 1 1\nl 0 0 1\ns 0 0 0 1\n");
    assert_int_equal(s.n_lights, 4);
    assert_false(s.lights[0].own_colour || s.lights[2].own_colour || s.lights[3].own_colour);
    assert_true(s.lights[1].own_colour);
    assert_true(s.lights[0].r == .5 && s.lights[2].g == .5 && s.lights[3].b == .5);
    assert_true(s.lights[1].r == .5 && s.lights[1].g == .25 && s.lights[1].b == 2);
    assert_vec(s.lights[2].pos, 7, 8, 9);
    scene_free(&s);
}

static void test_materials(void **state)
{
    (void)state;
    struct scene s =
        parse(VIEW "s 0 0 0 1\nf .1 .2 .3 .4 .5 1e5 0 0\ns 0 0 0 2\nf 0 0 0 .4 .5 3 .8 1.5\n"
                   "s 0 0 0 3\nf .1 .2 .3 .4 .5 100000 -0 0\ns 0 0 0 4\n");
    const struct material *m = s.materials;
    assert_int_equal(s.n_materials, 3);
    assert_true(m[0].r == 1 && m[0].g == 1 && m[0].b == 1 && m[0].kd == 1);
    assert_true(m[0].ks == 0 && m[0].t == 0);
    assert_true(
        m[1].g == .2 && m[1].kd == .4 && m[1].ks == .5 && m[1].shine == 1e5 && m[1].ior == 0);
    assert_true(m[2].t == .8 && m[2].ior == 1.5);
    assert_int_equal(s.prims[0].material, 0);
    assert_int_equal(s.prims[1].material, 1);
    assert_int_equal(s.prims[2].material, 2);
    assert_int_equal(s.prims[3].material, 1); /* equal ones are one */
    scene_free(&s);
}

static void test_many_materials(void **state)
{
    (void)state;
    struct buf b = {0};
    buf_printf(&b, VIEW);
    for (int i = 0; i < 3000; i++) buf_printf(&b, "f 0 0 .5 1 0 %d 0 0\ns 0 0 0 1\n", i % 1000);
    struct scene s;
    char err[SCENE_ERR];
    assert_int_equal(nff_read("t", (const char *)buf_data(&b), buf_size(&b), &s, err), 0);
    assert_int_equal(s.n_materials, 1001);
    for (uint32_t i = 0; i < s.n_prims; i++)
        assert_true(s.materials[s.prims[i].material].shine == i % 1000);
    scene_free(&s);
    buf_free(&b);
}

static void test_primitives(void **state)
{
    (void)state;
    struct scene s =
        parse(VIEW "p 3 0 0 0 1 0 0 0 1 0 s 1 2 3 -4 c 0 0 0 -2 0 0 1 -0\n"
                   "pp 3\n0 0 1 0 0 2\n1 0 1 3 0 4\n0 1 1 0 0 0\np 4 0 0 0 1 0 0 1 1 0 0 1 0\n");
    assert_int_equal(s.n_prims, 5);
    assert_int_equal(s.n_vertices, 10);
    assert_true(s.prims[1].kind == PRIM_SPHERE && s.prims[1].sphere.radius == 4);
    assert_true(s.prims[2].cone.base_radius == 2 && s.prims[2].cone.apex_radius == 0);
    assert_int_equal(s.prims[3].kind, PRIM_PATCH);
    assert_int_equal(s.prims[3].poly.first, 3);
    assert_int_equal(s.prims[4].poly.first, 6);
    assert_int_equal(s.prims[4].poly.count, 4);
    assert_vec(s.vertices[4], 1, 0, 1);
    assert_vec(s.normals[0], 0, 0, 0); /* a polygon's */
    assert_vec(s.normals[3], 0, 0, 1); /* made unit */
    assert_true(fabs(s.normals[4].x - .6) < 1e-15 && fabs(s.normals[4].z - .8) < 1e-15);
    assert_vec(s.normals[5], 0, 0, 1); /* was zero: the patch's own */
    assert_vec(s.normals[9], 0, 0, 0);
    scene_free(&s);
    s = parse(VIEW "p 3 0 0 0 1 0 0 0 1 0");
    assert_null(s.normals);
    scene_free(&s);
    s = parse(VIEW); /* nothing to see is a picture too */
    assert_int_equal(s.n_prims, 0);
    scene_free(&s);
}

static void check_refused(const char *text, uint32_t line, const char *says)
{
    struct scene s;
    char err[SCENE_ERR], where[32];
    snprintf(where, sizeof where, "t:%u: ", line);
    if (nff_read("t", text, strlen(text), &s, err) == 0) fail_msg("accepted: %s", text);
    if (strncmp(err, where, strlen(where)) != 0 || !strstr(err, says) ||
        !(strstr(err, "expected") || strstr(err, "more")))
        fail_msg("'%s' does not say '%s...%s'", err, where, says);
    assert_null(s.prims);
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t line;
        const char *says;
    } bad[] = {
        {"", 1, "without a view"},
        {"s 0 0 0 1\n", 2, "without a view"},
        {VIEW "? 1 2 3", 8, "entity is '?', expected one of v b l f "},
        {VIEW "tpp 3", 8, "entity is 'tpp'"},
        {VIEW "s 0 0 0 1\n\n0 0 0", 10, "entity is '0'"},
        {VIEW "s 0 0\nnan 1", 9, "sphere's centre is 'nan', expected a number"},
        {VIEW "s 0 0 inf 1", 8, "'inf'"},
        {VIEW "s 0 0 -Infinity 1", 8, "'-Infinity'"},
        {VIEW "s 0 0 1e999 1", 8, "expected a number from"},
        {VIEW "s 0 0 1e19 1", 8, "expected a number from -1e+18 to 1e+18"},
        {VIEW "s 0 0 0x10 1", 8, "'0x10'"},
        {VIEW "s 0 0 1e 1", 8, "'1e'"},
        {VIEW "s 0 0 . 1", 8, "'.'"},
        {VIEW "s 0 0 1,5 1", 8, "'1,5'"},
        {VIEW "s 0 0 1.2.3 1", 8, "'1.2.3'"},
        {VIEW "s 0 0 - 1", 8, "'-'"},
        {VIEW "s 0 0 0", 8, "the file ends before sphere's radius"},
        {VIEW "s 0 0 0 \x01\xff\x7f", 8, "is '\?\?\?'"},
        {VIEW "p 3.5", 8, "'3.5'"},
        {VIEW "p -3", 8, "'-3'"},
        {VIEW "p 99999999999999999999", 8, "expected an integer"},
        {VIEW "p 1000001\n0 0 0", 8, "expected an integer from 3 to 1000000"},
        {VIEW "p 1000000\n0 0 0 1 0 0 0 1 0", 9, "the file ends before polygon's vertex"},
        {VIEW "pp 3\n0 0 0 0 0 1\n0 0 0 0 0 1\n0 0 0 0 0", 11, "before patch's normal"},
        {VIEW "f 1 1 1 1 0 0 0", 8, "index of refraction"},
        {VIEW "f -1 1 1 1 0 0 0 0", 8, "colour is '-1'"},
        {VIEW "f 1 1 1 1 0 0 1.5 1", 8, "transmittance"},
        {VIEW "f 1 1 1 1 0 0 .5 0", 8, "index of refraction is '0'"},
        {VIEW "f 1 1 1 1 0 -1 0 0", 8, "Shine"},
        {VIEW "f red", 8, "'red'"},
        {VIEW "l 0 0", 8, "light's position"},
        {VIEW "l 0 0 0 1\ns 0 0 0 1", 9, "light's colour is 's'"},
        {VIEW "l 0 0 0 1 1 -1", 8, "light's colour is '-1'"},
        {VIEW "b 1 1", 8, "background"},
        {VIEW "b 1 1 1\nb 0 0 0", 9, "second background, expected only the one at line 8"},
        {VIEW VIEW, 8, "second view"},
        {"v from 0 0 5 at 0 0 0 up 0 1 0 resolution 4 4", 1, "without 'angle'"},
        {"v at 0 0 0 up 0 1 0 angle 45 resolution 4 4\ns 0 0 0 1", 2, "without 'from'"},
        {"v from 1 2 3 at 1 2 3 up 0 1 0 angle 45 resolution 4 4", 1, "same point"},
        {"v from 0 0 1 at 0 0 0 up 0 0 2 angle 45 resolution 4 4", 1, "parallel"},
        {"v from 0 0 1 at 0 0 0 up 0 0 0 angle 45 resolution 4 4", 1, "up is zero"},
        {"v from 0 0 1 at 0 0 0 up 0 1 0 angle 0 resolution 4 4", 1, "angle"},
        {"v from 0 0 1 at 0 0 0 up 0 1 0 angle 180 resolution 4 4", 1, "angle"},
        {"v from 0 0 1 at 0 0 0 up 0 1 0 angle -45 resolution 4 4", 1, "angle"},
        {"v from 0 0 1 at 0 0 0 up 0 1 0 angle 45 resolution 0 4", 1, "resolution"},
        {"v from 0 0 1 at 0 0 0 up 0 1 0 angle 45 resolution 4 65536", 1, "resolution"},
        {"v from 0 0 1 at 0 0 0 up 0 1 0 angle 45 resolution 4 4.5", 1, "resolution"},
        {"v from 0 0 1 at 0 0 0 up 0 1 0 angle 45 hither -1 resolution 4 4", 1, "hither"},
        {"v from 0 0 1 from 0 0 2", 1, "second 'from'"},
        {"v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\nangle forty", 5, "'forty'"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        check_refused(bad[i].text, bad[i].line, bad[i].says);
    for (int kind = 0; kind < PRIM_KINDS; kind++)
        for (int i = 0; i < 4 && prim_kinds[kind].refused[i].text; i++) {
            char text[1024];
            snprintf(text, sizeof text, VIEW "%s", prim_kinds[kind].refused[i].text);
            check_refused(text, 8, prim_kinds[kind].refused[i].says);
        }
}

/* Each kind has a sample, which is read, written and read again. */
static void test_samples(void **state)
{
    (void)state;
    for (int kind = 0; kind < PRIM_KINDS; kind++) {
        char one[1024], *text;
        size_t n;
        snprintf(one, sizeof one, VIEW "%s", scene_sample((enum prim_kind)kind));
        struct scene s = parse(one);
        struct nff_out o = {open_memstream(&text, &n), NFF_DIGITS_MAX};
        assert_true(s.n_prims == 1 && s.n_materials == 2);
        assert_int_equal(s.prims[0].kind, kind);
        nff_put_view(&o, &s.view);
        nff_put_material(&o, &s.materials[1]);
        scene_put_prim(&o, &s, &s.prims[0]);
        fclose(o.f);
        struct scene again = parse(text);
        s.prims[0].material = again.prims[0].material;
        assert_memory_equal(s.prims, again.prims, sizeof *s.prims);
        assert_int_equal(s.n_vertices, again.n_vertices);
        for (uint32_t i = 0; i < s.n_vertices; i++)
            assert_memory_equal(&s.vertices[i], &again.vertices[i], sizeof *s.vertices);
        scene_free(&s);
        scene_free(&again);
        free(text);
    }
}

static void test_long_names(void **state)
{
    (void)state;
    char name[1000], err[SCENE_ERR];
    struct scene s;
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    assert_int_equal(nff_read(name, name, 999, &s, err), -1);
    assert_true(strlen(err) < SCENE_ERR && strstr(err, ":1: entity is"));
}

/*
 * A file cut anywhere is refused, or is a scene whose primitives are the first ones of the
 * whole file's.
 */
static void check_truncated(const char *text, size_t size, size_t least)
{
    struct scene whole = parse(text);
    size_t taken = 0;
    for (size_t n = 0; n < size; n++) {
        struct scene s;
        char err[SCENE_ERR],
            *copy = malloc(n + !n); /* its own size: reading past it shows under ASan */
        memcpy(copy, text, n);
        int rc = nff_read("t", copy, n, &s, err);
        free(copy);
        if (rc != 0) {
            assert_true(strncmp(err, "t:", 2) == 0);
            continue;
        }
        taken++;
        assert_true(s.n_prims <= whole.n_prims && n > sizeof VIEW - 4);
        for (uint32_t i = 0; i + 1 < s.n_prims; i++) /* the last one's last number may be cut */
            assert_memory_equal(&s.prims[i], &whole.prims[i], sizeof *s.prims);
        scene_free(&s);
    }
    assert_true(taken > least);
    scene_free(&whole);
}

static void test_truncated(void **state)
{
    (void)state;
    static const char text[] =
        VIEW "# all kinds\nb .1 .2 .3\nl 1 2 3\nl 1 2 3 .5 .5 .5\nf 1 .5 .25 .5 .5 10 .5 1.5\n"
             "s 1.5 2.5 3.5 4.5\nc 1 2 3 4\n5 6 7 8\np 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
             "pp 3\n0 0 1 0 0 2\n1 0 1 3 0 4\n0 1 1 0 0 1e-1\ns 0 0 0 1\n";
    check_truncated(text, sizeof text, 20);
    for (int kind = 0; kind < PRIM_KINDS; kind++) {
        char one[1024];
        snprintf(one, sizeof one, VIEW "%s", scene_sample((enum prim_kind)kind));
        check_truncated(one, strlen(one) + 1, 1);
    }
}

/* Near the end of the text and far from it, where short numbers are read faster. */
static void check_number(const char *text)
{
    static const char *const rest[] = {"", " # far from the end"};
    double want = strtod(text, NULL);
    for (int i = 0; i < 2; i++) {
        struct buf b = {0};
        struct scene s;
        char err[SCENE_ERR];
        buf_printf(&b, VIEW "s %s 0 0 1%s", text, rest[i]);
        if (nff_read("t", (const char *)buf_data(&b), buf_size(&b), &s, err) != 0)
            fail_msg("%s", err);
        double got = s.prims[0].sphere.center.x;
        if (memcmp(&got, &want, sizeof got) != 0) fail_msg("%s reads as %.17g", text, got);
        scene_free(&s);
        buf_free(&b);
    }
}

/* Every number is read as strtod reads it, to the bit. */
static void test_numbers(void **state)
{
    (void)state;
    static const char *const hard[] = {"0", "-0", "-0.0e9", "1e-16", "9007199254740993",
        "9007199254740992.5", "2.2250738585072011e-308", "5e-324", "2e-324", "1e-400",
        "999999999999999e3", "1e17", "1e-22", "123456789012345e-22",
        "0.000000000000000000000000000000123456789", "1.00000000000000011102230246251565404",
        "00000000000000000000000001", "0.1", "0.3", "7.2057594037927933e16", "-1.5",
        ".000000000000001", "123456789012345", "1234567890.12345", "1234567890.123456", "+7",
        "1234567890123456", "12.", "-.5", "99999999999999.9", "00000000000000.1",
        "1.7976931348623157e-290", "1e-999999999999", "0e999999999"};
    for (size_t i = 0; i < sizeof hard / sizeof *hard; i++) check_number(hard[i]);
    for (uint64_t i = 0; i < 20000; i++) {
        char text[64];
        double v = (rng_unit(1, 2 * i) - .5) * pow(10, 60 * rng_unit(1, 2 * i + 1) - 44);
        snprintf(text, sizeof text, "%.*g", 1 + (int)(i % 18), v);
        check_number(text);
    }
}

/* Points of the surface lie within the bounds, and touch each of them. */
static void check_bounds(
    const char *text, struct vec3 (*point)(const struct prim *, double, double))
{
    struct scene s = parse(text);
    struct vec3 lo, hi, slack_lo, slack_hi;
    scene_prim_bounds(&s, s.prims, &lo, &hi);
    slack_lo = slack_hi = v3(1, 1, 1);
    for (int i = 0; i <= 2000; i++)
        for (int j = 0; j <= 60; j++) {
            struct vec3 p = point(s.prims, i / 2000., j / 60.);
            assert_true(p.x >= lo.x && p.y >= lo.y && p.z >= lo.z);
            assert_true(p.x <= hi.x && p.y <= hi.y && p.z <= hi.z);
            slack_lo = v3(fmin(slack_lo.x, p.x - lo.x), fmin(slack_lo.y, p.y - lo.y),
                fmin(slack_lo.z, p.z - lo.z));
            slack_hi = v3(fmin(slack_hi.x, hi.x - p.x), fmin(slack_hi.y, hi.y - p.y),
                fmin(slack_hi.z, hi.z - p.z));
        }
    assert_true(fmax(fmax(slack_lo.x, slack_lo.y), slack_lo.z) < 2e-2);
    assert_true(fmax(fmax(slack_hi.x, slack_hi.y), slack_hi.z) < 2e-2);
    scene_free(&s);
}

static struct vec3 sphere_point(const struct prim *p, double u, double v)
{
    double a = 2 * M_PI * u, b = M_PI * v;
    struct vec3 d = v3(cos(a) * sin(b), sin(a) * sin(b), cos(b));
    return v3_mad(p->sphere.center, d, p->sphere.radius);
}

static struct vec3 cone_point(const struct prim *p, double u, double v)
{
    struct vec3 axis = v3_unit(v3_sub(p->cone.apex, p->cone.base));
    struct vec3 x = v3_unit(v3_cross(axis, fabs(axis.x) < .5 ? v3(1, 0, 0) : v3(0, 1, 0))),
                y = v3_cross(axis, x);
    double r = p->cone.base_radius + v * (p->cone.apex_radius - p->cone.base_radius),
           a = 2 * M_PI * u;
    struct vec3 c = v3_mad(p->cone.base, v3_sub(p->cone.apex, p->cone.base), v);
    return v3_mad(v3_mad(c, x, r * cos(a)), y, r * sin(a));
}

static void test_bounds(void **state)
{
    (void)state;
    check_bounds(VIEW "s 1 -2 3 2.5", sphere_point);
    check_bounds(VIEW "c 1 2 3 1 4 0 5 .25", cone_point);
    check_bounds(VIEW "c 0 0 0 1 0 0 2 1", cone_point);
    check_bounds(VIEW "c 0 0 0 0 0 .01 0 2", cone_point);
    struct scene s = parse(VIEW "p 4 0 0 0 1 5 0 -3 1 0 0 1 7");
    struct vec3 lo, hi;
    scene_prim_bounds(&s, s.prims, &lo, &hi);
    assert_vec(lo, -3, 0, 0);
    assert_vec(hi, 1, 5, 7);
    scene_free(&s);
}

static void test_hither(void **state)
{
    (void)state;
    static const struct {
        const char *text; /* the eye looks down from z 5; hither is 1; +-22.5 degrees, wider in x */
        bool clips;
    } cases[] = {
        {VIEW "s 0 0 0 1", false},
        {VIEW "s 0 0 3.5 .4", false},
        {VIEW "s 0 0 3.5 .6", true},
        {VIEW "s 0 0 5 100", false}, /* the eye inside, the surface far away */
        {VIEW "s 0 0 5 .9", true},
        {VIEW "s 0 0 7 1.9", false}, /* behind */
        {VIEW "s 3 0 4.5 1", false}, /* beside */
        {VIEW "p 4 -9 -2 9 9 -2 9 9 -2 -9 -9 -2 -9",
            false}, /* a floor that passes below the picture's edge */
        {VIEW "p 4 -9 -.2 9 9 -.2 9 9 -.2 -9 -9 -.2 -9", true},
        {VIEW "p 3 0 0 4.5 .1 0 4.5 0 .1 4.5", true},
        {VIEW "pp 3 0 0 3.5 0 0 1 1 0 3.5 0 0 1 0 1 3.5 0 0 1", false},
        {VIEW "c 0 0 0 1 0 0 3.9 1", false},
        {VIEW "c 0 0 0 .1 0 0 4.5 .1", true},
        {VIEW "s 0 0 0 1 s 0 0 4.5 .01", true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene s = parse(cases[i].text);
        uint32_t which;
        if (scene_hither_clips(&s, &which) != cases[i].clips) fail_msg("%s", cases[i].text);
        if (cases[i].clips) assert_int_equal(which, s.n_prims - 1);
        scene_free(&s);
    }
}

static void test_written(void **state)
{
    (void)state;
    static const char want[] =
        "b 0.1 0.2 0.3\nv\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 64 48\n"
        "l 1 2 3\nl 4 5 6 0.5 0.25 0\nf 1 1 1 0.5 0 100000 0 1.5\ns 0 0 0 0.333333\nc 1 2 3 4 5 6 "
        "7 8\n"
        "p 3\n0 0 0\n1 0 0\n0 1 0\npp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n";
    char *text;
    size_t n;
    struct nff_out o = {open_memstream(&text, &n), NFF_DIGITS_SPD};
    const struct vec3 v[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                      up[] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    nff_put_background(&o, .1, .2, .3);
    nff_put_view(&o, &(struct view){v3(0, 0, 5), v3(0, 0, 0), v3(0, 1, 0), 45, 1, 64, 48});
    nff_put_light(&o, &(struct light){v3(1, 2, 3), 9, 9, 9, false});
    nff_put_light(&o, &(struct light){v3(4, 5, 6), .5, .25, 0, true});
    nff_put_material(&o, &(struct material){1, 1, 1, .5, 0, 1e5, 0, 1.5});
    nff_put_sphere(&o, v3(0, 0, 0), 1 / 3.);
    nff_put_cone(&o, v3(1, 2, 3), 4, v3(5, 6, 7), 8);
    nff_put_polygon(&o, 3, v, NULL);
    nff_put_polygon(&o, 3, v, up);
    fclose(o.f);
    assert_string_equal(text, want);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_view),
        cmocka_unit_test(test_layout_is_free),
        cmocka_unit_test(test_lights),
        cmocka_unit_test(test_materials),
        cmocka_unit_test(test_many_materials),
        cmocka_unit_test(test_primitives),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_samples),
        cmocka_unit_test(test_long_names),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_hither),
        cmocka_unit_test(test_written),
    };
    return cmocka_run_group_tests_name("nff", tests, NULL, NULL);
}
