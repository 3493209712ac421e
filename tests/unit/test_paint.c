/*
 * Painted backgrounds: lines, coasts and labels are where the list of backdrop has them, from many
 * views, also within the grid; what a window may ask for: one pixel, long titles, no camera. With
 * four arguments, GRID SPEC LINES OUT.ppm, it writes a picture, which 24_backdrop.t compares with
 * that of gnuplot.
 */
#include "paint/paint.h"
#include "rounds.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define DARK 135 /* green: only text is darker */
#define ALL (PAINT_MAP | PAINT_AXES | PAINT_STRIP)

static const char coast[] = "> land\n3 42\n9 41\n15 44\n16 48\n8 49\n4 46\n> water\n7 44\n10 44\n"
                            "10 46\n>\n12 40.5\n19 49\n> land\n355 38\n2 38\n2 41\n355 41\n";

/* For the sanitizer of leaks: fontconfig has tables until the program ends. */
#ifdef __clang__
#pragma clang diagnostic ignored "-Wreserved-identifier"
#endif
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) { return "leak:libfontconfig"; }

struct scene {
    struct grid g;
    struct spec s;
    struct backdrop b;
    struct paint *p;
    uint32_t *argb;
    uint32_t rows; /* with the strip */
};

static void paint_in(struct scene *c, uint32_t w, uint32_t h, unsigned parts)
{
    c->b.w = w;
    c->b.h = h;
    c->rows = h + backdrop_strip(&c->b);
    free(c->argb);
    c->argb = xcalloc((size_t)w * c->rows, sizeof *c->argb);
    assert_true(paint_backdrop(c->p, &c->b, parts, c->argb));
    for (size_t i = 0; i < (size_t)w * c->rows; i++) assert_int_equal(c->argb[i] >> 24, 255);
}

static void open_scene(struct scene *c)
{
    static const char vtk[] =
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 2\n"
        "X_COORDINATES 2 float\n0 20\nY_COORDINATES 2 float\n40 50\nZ_COORDINATES 2 float\n0 5\n"
        "POINT_DATA 8\nSCALARS x float 1\nLOOKUP_TABLE default\n0 1 0 1 0 1 0 1\n";
    static const char spec[] = "from 10 20 30\nat 10 45 0\nup 0 0 1\nangle 50\nresolution 400 "
                               "300\nmap 0 1 1 1 1\nmap 1 1 1 0 1\n";
    char err[ERR_BYTES];
    *c = (struct scene){.rows = 0};
    assert_int_equal(grid_read("grid", (const unsigned char *)vtk, strlen(vtk), &c->g, err), 0);
    assert_int_equal(spec_read("spec", spec, strlen(spec), &c->s, err), 0);
    c->b = (struct backdrop){.grid = &c->g, .spec = &c->s, .title = "speed, m/s", .unit = "hPa"};
    c->b.time = "2026-11-23 12:00 UTC";
    c->b.lines_name = "lines";
    c->b.lines = coast;
    c->p = paint_open(&c->b, err);
    assert_non_null(c->p);
}

static void close_scene(struct scene *c)
{
    paint_free(c->p);
    free(c->argb);
    grid_free(&c->g);
    spec_free(&c->s);
}

static double between(uint64_t *seed, double lo, double hi)
{
    return lo + (hi - lo) * rng_unit(1, (*seed)++);
}

/* A view from a place in, above or beside the grid. */
static void turn(struct scene *c, uint64_t *seed)
{
    const double far = between(seed, 1, 50);
    const double from[] = {between(seed, -far, 20 + far), between(seed, 40 - far, 50 + far),
        between(seed, -far / 4, far)};
    const double at[] = {between(seed, 0, 20), between(seed, 40, 50), between(seed, 0, 3)};
    memcpy(c->s.from, from, sizeof from);
    memcpy(c->s.at, at, sizeof at);
    c->s.angle = between(seed, 5, 120);
}

/* ---- places ---------------------------------------------------------------------------------- */

static int green(uint32_t argb) { return argb >> 8 & 255; }

/* The darkest green within a pixel of a place, y upwards; 255 outside of the picture. */
static int darkest(const struct scene *c, double x, double y)
{
    int least = 255;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            double px = floor(x) + dx, py = floor(c->b.h - y) + dy;
            if (px < 0 || py < 0 || px >= c->b.w || py >= c->b.h) continue;
            int v = green(c->argb[(size_t)py * c->b.w + (size_t)px]);
            if (v < least) least = v;
        }
    return least;
}

static bool is_inside(const struct scene *c, const struct backdrop_at *at)
{
    return at->x > 2 && at->y > 2 && at->x < c->b.w - 2 && at->y < c->b.h - 2;
}

/* Every point of these lines is darker than the lightest of what they are drawn over. */
static size_t check_lines(
    const struct scene *c, const struct backdrop_list *l, const struct backdrop_mark *m, int over)
{
    size_t seen = 0;
    for (const struct backdrop_at *at = l->at + m->first; at < l->at + m->first + m->n; at++) {
        if (!is_inside(c, at) || isnan(at[1].x)) continue; /* a piece may have one point */
        seen++;
        if (darkest(c, at->x, at->y) >= over)
            fail_msg("no line at %g %g, from %g %g %g at %g %g %g angle %g", at->x, at->y,
                c->s.from[0], c->s.from[1], c->s.from[2], c->s.at[0], c->s.at[1], c->s.at[2],
                c->s.angle);
    }
    return seen;
}

/* Black pixels are in boxes of labels, and each box has some. */
static size_t check_labels(const struct scene *c, const struct backdrop_list *l)
{
    uint8_t *box = xcalloc(c->b.w, c->rows);
    size_t n = 0;
    for (const struct backdrop_mark *m = l->mark; m < l->mark + l->n_marks; m++) {
        if (m->kind != BACKDROP_LABEL) continue;
        const struct backdrop_at at = l->at[m->first];
        const double wide = l->em * (double)strlen((const char *)buf_data(&l->text) + m->text);
        const double x0 = at.x - wide * (m->align + 1) / 2 - 2, y = c->b.h - at.y;
        int black = 0;
        for (double py = fmax(0, floor(y - l->em)); py < fmin(c->rows, y + l->em); py++)
            for (double px = fmax(0, floor(x0)); px < fmin(c->b.w, x0 + wide + 4); px++) {
                size_t i = (size_t)py * c->b.w + (size_t)px;
                box[i] = 1;
                black += green(c->argb[i]) < DARK;
            }
        if (!black) fail_msg("no text at %g %g", at.x, at.y);
        n++;
    }
    for (size_t i = 0; i < (size_t)c->b.w * c->rows; i++)
        if (!box[i] && green(c->argb[i]) < DARK)
            fail_msg("text at %zu %zu, where no label is", i % c->b.w, i / c->b.w);
    free(box);
    return n;
}

static void test_places(void **state)
{
    (void)state;
    struct scene c;
    struct backdrop_list l = {.em = 0};
    char err[ERR_BYTES];
    size_t edges = 0, coasts = 0, labels = 0;
    uint64_t seed = 1;
    open_scene(&c);
    struct backdrop_lines *lines = backdrop_lines_read(&c.b, err);
    for (int round = 0; round < rounds(200); round++) {
        turn(&c, &seed);
        paint_in(&c, (uint32_t)between(&seed, 40, 500), (uint32_t)between(&seed, 40, 400), ALL);
        backdrop_draw(&c.b, lines, BACKDROP_ALL, &l); /* not clipped */
        for (const struct backdrop_mark *m = l.mark; m < l.mark + l.n_marks; m++) {
            if (m->kind == BACKDROP_EDGES) edges += check_lines(&c, &l, m, 0xd0);
            if (m->kind == BACKDROP_LINES) coasts += check_lines(&c, &l, m, 0xd3);
        }
        labels += check_labels(&c, &l);
    }
    assert_true(edges > 600 && coasts > 50 && labels > 80);
    backdrop_lines_free(lines);
    backdrop_list_free(&l);
    close_scene(&c);
}

/* ---- what a window may ask for --------------------------------------------------------------- */

static size_t count(const struct scene *c, uint32_t rgb)
{
    size_t n = 0;
    for (size_t i = 0; i < (size_t)c->b.w * c->rows; i++) n += c->argb[i] == (0xff000000u | rgb);
    return n;
}

static size_t count_dark(const struct scene *c)
{
    size_t n = 0;
    for (size_t i = 0; i < (size_t)c->b.w * c->rows; i++) n += green(c->argb[i]) < DARK;
    return n;
}

static void test_parts(void **state)
{
    (void)state;
    struct scene c;
    const uint32_t sea = 0xe3ebf1, land = 0xd9d9cf;
    open_scene(&c);
    paint_in(&c, 400, 300, ALL);
    assert_true(count(&c, sea) > 3000 && count(&c, land) > 2000 && count_dark(&c) > 20);
    paint_in(&c, 400, 300, PAINT_AXES);
    assert_true(count(&c, sea) == 0 && count(&c, land) == 0 && count_dark(&c) > 20);
    paint_in(&c, 400, 300, PAINT_MAP);
    assert_true(count(&c, sea) > 3000 && count(&c, land) > 2000 && count_dark(&c) == 0);
    paint_in(&c, 400, 300, PAINT_STRIP);
    assert_true(count(&c, sea) == 0 && count(&c, land) == 0 && count_dark(&c) > 20);
    paint_in(&c, 400, 300, 0);
    assert_int_equal(count(&c, BACKDROP_PAPER), 400 * c.rows);
    close_scene(&c);
}

/* Nothing remains of other pictures. */
static void test_again(void **state)
{
    (void)state;
    struct scene c;
    uint64_t seed = 7;
    open_scene(&c);
    paint_in(&c, 300, 200, ALL);
    uint32_t *first = c.argb;
    const size_t bytes = 300 * c.rows * sizeof *first;
    const struct spec kept = c.s;
    c.argb = NULL;
    for (int i = 0; i < 3; i++) {
        turn(&c, &seed);
        paint_in(&c, 300, i == 1 ? 90 : 200, ALL);
    }
    c.s = kept;
    paint_in(&c, 300, 200, ALL);
    assert_memory_equal(first, c.argb, bytes);
    free(first);
    close_scene(&c);
}

static void test_odd(void **state)
{
    (void)state;
    struct scene c;
    char title[600], err[ERR_BYTES];
    open_scene(&c);
    const struct spec kept = c.s;
    paint_in(&c, 1, 1, ALL);
    paint_in(&c, 3000, 2, ALL);
    paint_in(&c, 2, 900, ALL);
    memset(title, 'W', sizeof title - 1);
    title[sizeof title - 1] = '\0';
    c.b.title = title;
    paint_in(&c, 200, 100, ALL);
    c.b.title = "\xff\xfe m\xc3";
    paint_in(&c, 200, 100, ALL);
    for (int i = 0; i < 3; i++) { /* in a corner of the map, and no camera at all */
        memcpy(c.s.from, (double[3]){i < 2 ? 0 : (double)NAN, 40, 0}, sizeof c.s.from);
        memcpy(c.s.at, i ? c.s.from : c.s.at, sizeof c.s.at);
        paint_in(&c, 200, 100, ALL);
    }
    c.s = kept;
    c.s.scale[2] = -1e12;
    paint_in(&c, 200, 100, ALL);
    c.b.w = 40000;
    c.b.h = 1;
    assert_false(paint_backdrop(c.p, &c.b, ALL, c.argb));
    c.b.lines = "1 2\nwords\n";
    assert_null(paint_open(&c.b, err));
    assert_string_equal(err, "lines:2: expected longitude and latitude");
    close_scene(&c);
}

/* ---- text over a picture --------------------------------------------------------------------- */

static void test_text(void **state)
{
    (void)state;
    enum { W = 200, H = 120 };
    static uint32_t argb[W * H],
        corners[] = {8 + 8 * W, W - 9 + 8 * W, 8 + (H - 9) * W, W - 9 + (H - 9) * W};
    for (int place = 0; place < 4; place++) {
        for (int i = 0; i < W * H; i++) argb[i] = 0xffffffffu;
        assert_true(paint_text(argb, W, H, "drag  turns", (enum paint_place)place));
        for (int k = 0; k < 4; k++) assert_int_equal(argb[corners[k]] == 0xffffffffu, k != place);
    }
    assert_true(paint_text(argb, 1, 1, "x", PAINT_TOP_LEFT));
    assert_true(paint_text(argb, W, H, "\xff\n\n\xc3(", PAINT_BOTTOM_RIGHT));
    char many[4000];
    for (size_t i = 0; i < sizeof many - 1; i++) many[i] = i % 40 ? 'm' : '\n';
    many[sizeof many - 1] = '\0';
    assert_true(paint_text(argb, W, H, many, PAINT_TOP_RIGHT));
    assert_false(paint_text(argb, 0, 0, "x", PAINT_TOP_LEFT));
}

/* ---- a picture for 24_backdrop.t ------------------------------------------------------------- */

static int write_picture(char **argv)
{
    struct scene c = {.rows = 0};
    struct backdrop_names names;
    struct buf lines = {0};
    char err[ERR_BYTES], time[BACKDROP_TIME];
    FILE *out = fopen(argv[4], "wb");
    if (!out || grid_load(argv[1], &c.g, err) != 0 || spec_load(argv[2], &c.s, err) != 0 ||
        read_file(argv[3], &lines) != 0)
        return 1;
    buf_append(&lines, "", 1);
    backdrop_time(c.g.title, time);
    c.b = (struct backdrop){.grid = &c.g, .spec = &c.s, .time = time, .lines_name = argv[3]};
    c.b.lines = (const char *)buf_data(&lines);
    backdrop_name(&c.b, NULL, NULL, &names);
    c.p = paint_open(&c.b, err);
    if (!c.p) return 1;
    paint_in(&c, c.s.w, c.s.h, ALL | BACKDROP_RAISED);
    fprintf(out, "P6 %u %u 255\n", (unsigned)c.b.w, (unsigned)c.rows);
    for (size_t i = 0; i < (size_t)c.b.w * c.rows; i++)
        for (int shift = 16; shift >= 0; shift -= 8) fputc((int)(c.argb[i] >> shift & 255), out);
    close_scene(&c);
    buf_free(&lines);
    return fclose(out) == 0 ? 0 : 1;
}

int main(int argc, char **argv)
{
    if (argc == 5) return write_picture(argv);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_places), cmocka_unit_test(test_parts),
        cmocka_unit_test(test_again), cmocka_unit_test(test_odd), cmocka_unit_test(test_text)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
