/* Specifications: words, defaults, ranges; what is refused and where; truncations. */
#include "spec/spec.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define VIEW "from 0 -5 2\nat 1 2 3\nup 0 0 1\nangle 40\nresolution 64 48\n"
#define MAP "map 1 .1 .2 .3 .4\nmap 2 1 1 1 0\n"

static int read_bytes(const char *text, size_t n, struct spec *s, char err[ERR_BYTES])
{
    /* Exactly as long as the text, so that a read past it is seen. */
    char *copy = xmalloc(n, 1);
    if (n) memcpy(copy, text, n);
    int rc = spec_read("t", copy, n, s, err);
    free(copy);
    return rc;
}

static struct spec parse(const char *text)
{
    struct spec s;
    char err[ERR_BYTES];
    if (read_bytes(text, strlen(text), &s, err) != 0) fail_msg("refused: %s", err);
    return s;
}

static void test_defaults(void **state)
{
    (void)state;
    struct spec s = parse(VIEW MAP);
    assert_true(s.from[0] == 0 && s.from[1] == -5 && s.from[2] == 2);
    assert_true(s.at[0] == 1 && s.at[1] == 2 && s.at[2] == 3);
    assert_true(s.up[0] == 0 && s.up[1] == 0 && s.up[2] == 1);
    assert_true(s.angle == 40 && s.w == 64 && s.h == 48);
    assert_true(!s.lit && !s.backed && s.attenuation == 0 && s.opacity_limit == .9999);
    assert_true(s.scale[0] == 1 && s.scale[1] == 1 && s.scale[2] == 1);
    assert_true(s.n_knots == 2 && s.n_isos == 0);
    assert_true(s.knot[0].s == 1 && s.knot[0].k == .4);
    assert_true(s.knot[0].rgb[0] == .1 && s.knot[0].rgb[1] == .2 && s.knot[0].rgb[2] == .3);
    assert_true(s.knot[1].s == 2 && s.knot[1].rgb[2] == 1 && s.knot[1].k == 0);
    spec_free(&s);
    assert_true(!s.knot && !s.n_knots);
}

static void test_words(void **state)
{
    (void)state;
    struct spec s =
        parse("# a comment\r\n  iso 7 .5 .6 .7 .8#behind\n\n" VIEW
              "iso -2 1 1 1 1\rlight 1 2 3\rattenuation 1e-3\nscale 1 -2 .001\n"
              "limit 1\nbackground 9 0 .5\nmap 3 0 0 0 1\nmap 3 1 1 1 1\n\tmap 4 0 0 0 0");
    assert_true(s.lit && s.light[0] == 1 && s.light[1] == 2 && s.light[2] == 3);
    assert_true(s.attenuation == 1e-3 && s.opacity_limit == 1);
    assert_true(s.scale[0] == 1 && s.scale[1] == -2 && s.scale[2] == .001);
    assert_true(s.backed && s.background[0] == 9 && s.background[2] == .5);
    assert_true(s.n_isos == 2 && s.iso[0].s == -2 && s.iso[1].s == 7 && s.iso[1].opacity == .8);
    assert_true(s.n_knots == 3 && s.knot[0].s == 3 && s.knot[1].s == 3 && s.knot[1].rgb[0] == 1);
    spec_free(&s);
    s = parse(VIEW MAP "slice z 5 .5\nslice x 7 1\nslice z -5 0\nclip -1 0 .5 1 2 3");
    assert_true(s.n_slices == 3 && s.slice[0].axis == 0 && s.slice[0].at == 7);
    assert_true(s.slice[1].axis == 2 && s.slice[1].at == -5 && s.slice[2].opacity == .5);
    assert_true(s.clipped && s.clip[0][0] == -1 && s.clip[0][1] == 1 && s.clip[2][1] == 3);
    spec_free(&s);
    assert_null(s.slice);
    s = parse(VIEW "palette grey\nground -5 0\nground 0 .5\nground 9 1 1 0\n" MAP "colour 7 1 1 0");
    assert_true(s.n_grounds == 10 && s.ground[9].s == 9 && s.ground[9].rgb[2] == 0);
    assert_true(s.n_colours == 1 && s.colour[0].s == 7 && s.n_knots == 2);
    spec_free(&s);
    assert_true(!s.ground && !s.colour);
    s = parse(VIEW MAP "light off");
    assert_false(s.clipped);
    assert_false(s.lit);
    spec_free(&s);
}

/* Places in a palette: the colours of its source at the ends, and those between two places. */
static void test_palettes(void **state)
{
    (void)state;
    double rgb[SPEC_PALETTE_POINTS][3], out[3];
    assert_true(spec_palette("viridis", 7, rgb));
    assert_false(spec_palette("viridi", 6, rgb) || spec_palette("", 0, rgb));
    /* 0xfd, 0xe7, 0x25 of sRGB in linear light */
    assert_true(fabs(rgb[16][0] - .982251) < 1e-6 && fabs(rgb[16][1] - .799103) < 1e-6);
    assert_true(fabs(rgb[16][2] - .018500) < 1e-6);
    spec_palette_at((const double(*)[3])rgb, 1, out);
    assert_memory_equal(out, rgb[16], sizeof out);
    spec_palette_at((const double(*)[3])rgb, 1 / 32., out);
    assert_true(fabs(out[1] - (rgb[0][1] + rgb[1][1]) / 2) < 1e-15);

    struct spec s = parse("palette viridis\n" VIEW "iso 7 1 .5\nmap 0 1 1\nmap 16 0 3\n"
                          "map 16 .1 .2 .3 4\nmap 20 .5 0\nmap 30 .5 0\nmap 40 .55 0");
    assert_memory_equal(s.iso[0].rgb, rgb[16], sizeof out);
    assert_true(s.iso[0].opacity == .5);
    assert_true(s.n_knots == 21);
    for (int i = 0; i <= 16; i++) {
        assert_memory_equal(s.knot[i].rgb, rgb[16 - i], sizeof out);
        assert_true(s.knot[i].s == i && fabs(s.knot[i].k - (1 + i / 8.)) < 1e-15);
    }
    assert_true(s.knot[17].s == 16 && s.knot[17].k == 4 && s.knot[18].s == 20);
    assert_memory_equal(s.knot[18].rgb, rgb[8], sizeof out);
    assert_true(s.knot[19].s == 30 && s.knot[20].s == 40);
    spec_free(&s);
    /* Between neighbouring numbers there is no room for other knots. */
    s = parse("palette grey\n" VIEW "map 1 0 1\nmap 1.0000000000000002 1 1");
    assert_true(s.n_knots == 2);
    spec_free(&s);
}

/* The profile: its words, its values between levels, and a field less it. */
static void test_profile(void **state)
{
    (void)state;
    float value[] = {11, 12, 13, 14, 21, 22, (float)NAN, 24};
    double x[] = {0, 1}, z[] = {1, 3};
    const struct grid g = {.n = {2, 2, 2}, .at = {x, x, z}, .value = value};
    struct spec s = parse(VIEW MAP);
    assert_true(!s.n_profile && !spec_deviation(&s, &g) && spec_profile_at(&s, 5) == 0);
    spec_free(&s);
    s = parse(VIEW "profile 0 8\n" MAP "profile 2 12\nprofile 4 20\n");
    assert_true(s.n_profile == 3 && s.profile[2].z == 4 && s.profile[2].s == 20);
    static const double at[][2] = {{-9, 8}, {0, 8}, {1, 10}, {2, 12}, {3, 16}, {4, 20}, {9, 20}};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++)
        assert_true(spec_profile_at(&s, at[i][0]) == at[i][1]);
    float *less = spec_deviation(&s, &g);
    for (int i = 0; i < 8; i++)
        assert_true(i == 6 ? isnan(less[i]) : less[i] == value[i] - (i < 4 ? 10 : 16));
    free(less);
    spec_free(&s);
}

static void test_many(void **state)
{
    (void)state;
    struct buf b = {0};
    buf_printf(&b, "%s", VIEW);
    for (int i = 0; i < 1000; i++) buf_printf(&b, "map %d 0 0 0 1\niso %d 0 0 0 1\n", i, -i);
    buf_append(&b, "", 1);
    struct spec s = parse((const char *)buf_data(&b));
    assert_true(s.n_knots == 1000 && s.n_isos == 1000);
    for (size_t i = 0; i < 1000; i++)
        assert_true(s.knot[i].s == (double)i && s.iso[i].s == (double)i - 999);
    spec_free(&s);
    buf_free(&b);
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *err;
    } bad[] = {
        {"", "t:0: no 'from', expected from, at, up, angle and resolution"},
        {"from 0 0 0\nat 0 0 1\nup 0 1 0\nangle 9\n",
            "t:4: no 'resolution', expected from, at, up, angle and resolution"},
        {VIEW "fog 1", "t:6: line: first word is 'fog', expected from, at, up, angle, resolution, "
                       "light, attenuation, scale, limit, background, palette, clip, map, iso, "
                       "slice, colour, ground, flat or profile"},
        {VIEW "hither 0", "t:6: line: first word is 'hither', expected from, at, up, angle, "
                          "resolution, light, attenuation, scale, limit, background, palette, "
                          "clip, map, iso, slice, colour, ground, flat or profile"},
        {VIEW "at 0 0 0", "t:6: at: twice, expected it once"},
        {VIEW "light off\nlight 1 1 1", "t:7: light: twice, expected it once"},
        {VIEW "light on", "t:6: light: x is 'on', expected a number from -1e+18 to 1e+18"},
        {VIEW "light offf", "t:6: light: x is 'offf', expected a number from -1e+18 to 1e+18"},
        {VIEW "light off 1", "t:6: light: next word is '1', expected the line's end"},
        {VIEW "light 1 2", "t:6: light: no z, expected a number from -1e+18 to 1e+18"},
        {VIEW "map 1 .1 .2 .3 x", "t:6: map: extinction is 'x', expected a number from 0 to 1e+18"},
        {VIEW "map 1 .1 .2 .3 -1",
            "t:6: map: extinction is '-1', expected a number from 0 to 1e+18"},
        {VIEW "map nan .1 .2 .3 1",
            "t:6: map: value is 'nan', expected a number from -1e+18 to 1e+18"},
        {VIEW "map 1 .1 .2 .3 4 5", "t:6: map: next word is '5', expected the line's end"},
        {VIEW MAP "map 1.5 0 0 0 0", "t:8: map: 1.5 after 2, expected values that ascend"},
        {VIEW MAP "map 2 0 0 0 0\nmap 2 0 0 0 0",
            "t:9: map: 2 for the third time, expected a value twice at most"},
        {VIEW "map 1 0 0 0 0", "t:6: one map line, expected two or more"},
        {VIEW, "t:5: nothing is visible, expected map, iso or ground lines"},
        {VIEW "iso 1 0 0 0 2", "t:6: iso: opacity is '2', expected a number from 0 to 1"},
        {VIEW "iso 1 0 0 0 1\niso 2 0 0 0 1\niso 1 0 0 0 1",
            "t:8: iso: 1 twice, expected a value once"},
        {VIEW "scale 1 0 1", "t:6: scale: y is 0, expected 1e-09 to 1e+09, or the same below 0"},
        {VIEW MAP "clip 0 0 0 1 1", "t:8: clip: no z1, expected a number from -1e+18 to 1e+18"},
        {VIEW MAP "clip 0 0 0 1 -1 1", "t:8: clip: y from 0 to -1, expected numbers that ascend"},
        {VIEW MAP "clip 0 0 0 1 1 1\nclip 0 0 0 2 2 2", "t:9: clip: twice, expected it once"},
        {VIEW MAP "slice", "t:8: slice: no axis, expected x, y or z"},
        {VIEW MAP "slice xy 1 1", "t:8: slice: axis is 'xy', expected x, y or z"},
        {VIEW MAP "slice w 1 1", "t:8: slice: axis is 'w', expected x, y or z"},
        {VIEW MAP "slice x 1", "t:8: slice: no opacity, expected a number from 0 to 1"},
        {VIEW MAP "slice x 1 2", "t:8: slice: opacity is '2', expected a number from 0 to 1"},
        {VIEW MAP "slice x 1 1\nslice y 1 1\nslice x 1 0",
            "t:10: slice: x 1 twice, expected a place once"},
        {VIEW "iso 1 0 0 0 1\nslice x 1 1",
            "t:7: slice: no map, expected map lines, which colour it"},
        {VIEW "slice x 1 1", "t:6: nothing is visible, expected map, iso or ground lines"},
        {VIEW MAP "colour 1 2", "t:8: colour: 2 numbers and no palette, expected a palette line "
                                "above, or 4 numbers"},
        {VIEW MAP "colour 1 0 0 0\ncolour 0 0 0 0",
            "t:9: colour: 0 after 1, expected values that ascend"},
        {VIEW MAP "colour 1 0 0", "t:8: colour: no blue, expected a number from 0 to 1000000"},
        {VIEW "iso 1 0 0 0 1\ncolour 1 0 0 0",
            "t:7: colour: no map, expected map lines, whose extinction it colours"},
        {VIEW "palette vik\nground 1 0 0 0 1",
            "t:7: ground: next word is '1', expected the line's end"},
        {VIEW MAP "flat 1 .5\nground 1 0 0 0",
            "t:9: flat: 1 ground lines, expected two or more, which colour it"},
        {VIEW "flat 1 1.5", "t:6: flat: opacity is '1.5', expected a number from 0 to 1"},
        {VIEW "flat 1 1\nflat 2 1", "t:7: flat: twice, expected it once"},
        {VIEW "palette vik\nground 1 2",
            "t:7: ground: place is '2', expected a number from 0 to 1"},
        {VIEW "profile 1", "t:6: profile: no value, expected a number from -1e+18 to 1e+18"},
        {VIEW "profile 1 2\nprofile 1 3",
            "t:7: profile: 1 after 1, expected heights that ascend"},
        {VIEW "limit 0", "t:6: limit: opacity is '0', expected a number from 0.001 to 1"},
        {"angle 180", "t:1: angle: degrees is '180', expected a number from 1e-06 to 179.999999"},
        {"resolution 0 1", "t:1: resolution: width is '0', expected a number from 1 to 65535"},
        {"resolution 1 1.5", "t:1: resolution: 1 1.5, expected whole pixels"},
        {"from 0 0 0\nat 0 0 0\nup 0 0 1\nangle 9\nresolution 1 1",
            "t:5: from and at are one point, expected two"},
        {"from 0 0 0\nat 0 0 1\nup 0 0 0\nangle 9\nresolution 1 1",
            "t:5: up is zero, expected a direction"},
        {"from 0 0 0\nat 0 0 1\nup 0 0 -2\nangle 9\nresolution 1 1",
            "t:5: up is along the viewing direction, expected another"},
        {VIEW "palette jet", "t:6: palette: name is 'jet', expected " SPEC_PALETTES},
        {VIEW "palette grey\npalette grey", "t:7: palette: twice, expected it once"},
        {VIEW "map 1 .5 2",
            "t:6: map: 3 numbers and no palette, expected a palette line above, or 5 numbers"},
        {VIEW "palette vik\nmap 1 1.5 2",
            "t:7: map: place is '1.5', expected a number from 0 to 1"},
        {"angle \x01\x80",
            "t:1: angle: degrees is '?\?', expected a number from 1e-06 to 179.999999"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct spec s;
        char err[ERR_BYTES];
        assert_int_equal(read_bytes(bad[i].text, strlen(bad[i].text), &s, err), -1);
        assert_string_equal(err, bad[i].err);
        assert_true(!s.knot && !s.iso);
    }
}

/* Wherever it is cut off: a specification, or a message. */
static void test_truncated(void **state)
{
    (void)state;
    static const char text[] = VIEW MAP "iso 7 .5 .6 .7 .8\nlight 1 2 3\nscale 1 2 .001\n";
    for (size_t n = 0; n < sizeof text; n++) {
        struct spec s;
        char err[ERR_BYTES];
        if (read_bytes(text, n, &s, err) == 0) spec_free(&s);
        else assert_true(strncmp(err, "t:", 2) == 0 && strstr(err, "expected"));
    }
    struct spec s;
    char err[ERR_BYTES];
    assert_int_equal(read_bytes("angle 4\0", 8, &s, err), -1);
}

/* Bit by bit. */
static bool same_bits(const void *a, const void *b, size_t n)
{
    return n == 0 || memcmp(a, b, n) == 0;
}

static bool same_slices(const struct spec *a, const struct spec *b)
{
    for (size_t i = 0; i < a->n_slices; i++)
        if (a->slice[i].axis != b->slice[i].axis || a->slice[i].at != b->slice[i].at ||
            a->slice[i].opacity != b->slice[i].opacity)
            return false;
    return a->n_slices == b->n_slices;
}

static bool same_spec(const struct spec *a, const struct spec *b)
{
    return same_bits(a->from, b->from, sizeof a->from) && same_bits(a->at, b->at, sizeof a->at) &&
           same_bits(a->up, b->up, sizeof a->up) && a->angle == b->angle && a->w == b->w &&
           a->h == b->h && a->lit == b->lit && same_bits(a->light, b->light, sizeof a->light) &&
           a->attenuation == b->attenuation && same_bits(a->scale, b->scale, sizeof a->scale) &&
           a->opacity_limit == b->opacity_limit && a->backed == b->backed &&
           same_bits(a->background, b->background, sizeof a->background) &&
           a->n_knots == b->n_knots && a->n_isos == b->n_isos && same_slices(a, b) &&
           a->flat == b->flat && a->flat_at == b->flat_at && a->flat_opacity == b->flat_opacity &&
           a->n_colours == b->n_colours && a->n_grounds == b->n_grounds &&
           a->clipped == b->clipped && same_bits(a->knot, b->knot, a->n_knots * sizeof *a->knot) &&
           same_bits(a->iso, b->iso, a->n_isos * sizeof *a->iso) &&
           same_bits(a->colour, b->colour, a->n_colours * sizeof *a->colour) &&
           same_bits(a->ground, b->ground, a->n_grounds * sizeof *a->ground) &&
           same_bits(a->clip, b->clip, sizeof a->clip);
}

static void test_written(void **state)
{
    (void)state;
    static const char *const texts[] = {VIEW MAP,
        "from 1e-17 -5.000000000000001 2\nat 1 2 3\nup .1 .2 .3\nangle 1e-6\nresolution 1 65535\n"
        "light -1 .3 3\nattenuation .001\nscale 1 -.0010000000000000002 1e9\nlimit 1\n"
        "background .02 .3 0\nclip -1 -2 -3 1 2 3.3\npalette vik\nmap 1 .1 .3\nmap 1 .4 .3\n"
        "map 7 .9 0\ncolour 1 0\ncolour 2 1\nground 0 .3\nground 5 .6\nflat 2 .7\niso 3 .2 .5\n"
        "iso 1 9 9 9 .1\nslice z 1 .5\nslice x -.1 1\n",
        VIEW "ground 1 1 1 1\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct spec s = parse(texts[i]);
        struct buf b = {0};
        spec_write(&s, &b);
        buf_append(&b, "", 1);
        struct spec back = parse((const char *)buf_data(&b));
        assert_true(same_spec(&s, &back));
        spec_free(&s);
        spec_free(&back);
        buf_free(&b);
    }
}

static struct spec recoloured(const struct spec *s, const char *palette)
{
    struct buf b = {0};
    spec_write_in(s, palette, &b);
    buf_append(&b, "", 1);
    const struct spec to = parse((const char *)buf_data(&b));
    buf_free(&b);
    return to;
}

/* The colours of another palette have the places of the old one, or else places by value. */
static void test_recoloured(void **state)
{
    (void)state;
    double vik[SPEC_PALETTE_POINTS][3], rgb[3];
    assert_true(spec_palette("vik", 3, vik));
    struct spec s = parse(VIEW "palette magma\nmap 1 .25 .5\nmap 1 .5 .5\nmap 9 1 0\niso 3 .5 1\n");
    struct spec to = recoloured(&s, "vik"), back = recoloured(&to, "magma");
    assert_true(to.n_knots == s.n_knots && back.n_knots == s.n_knots);
    spec_palette_at((const double(*)[3])vik, .25, rgb);
    for (int c = 0; c < 3; c++) assert_true(fabs(to.knot[0].rgb[c] - rgb[c]) < 1e-9);
    spec_palette_at((const double(*)[3])vik, .5, rgb);
    for (int c = 0; c < 3; c++) assert_true(fabs(to.knot[1].rgb[c] - rgb[c]) < 1e-9);
    for (size_t i = 0; i < s.n_knots; i++) {
        assert_true(fabs(back.knot[i].s - s.knot[i].s) < 1e-9 && to.knot[i].k == s.knot[i].k);
        for (int c = 0; c < 3; c++)
            assert_true(fabs(back.knot[i].rgb[c] - s.knot[i].rgb[c]) < 1e-9);
    }
    assert_memory_equal(to.iso, s.iso, sizeof *s.iso);
    spec_free(&s), spec_free(&to), spec_free(&back);
    s = parse(VIEW "map 1 .1 .2 .3 1\nmap 2 .5 .5 .7 2\nmap 3 1 1 1 0\n");
    to = recoloured(&s, "vik");
    assert_true(to.n_knots == SPEC_PALETTE_POINTS && to.knot[8].s == 2 && to.knot[8].k == 2);
    assert_memory_equal(to.knot[8].rgb, vik[8], sizeof vik[8]);
    spec_free(&s), spec_free(&to);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_words),
        cmocka_unit_test(test_palettes),
        cmocka_unit_test(test_profile),
        cmocka_unit_test(test_many),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_written),
        cmocka_unit_test(test_recoloured),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
