/* Outlines that break a map: without points, with one, beyond the globe. Labels of many maps: none
 * covers another, nor leaves its part of the picture. Times. */
#include "backdrop/backdrop.h"
#include "rounds.h"
#include "units/units.h"

#include <math.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void load(struct grid *g, struct spec *s)
{
    static const char vtk[] =
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 2\n"
        "X_COORDINATES 2 float\n0 20\nY_COORDINATES 2 float\n40 50\nZ_COORDINATES 2 float\n0 1\n"
        "POINT_DATA 8\nSCALARS x float 1\nLOOKUP_TABLE default\n0 1 0 1 0 1 0 1\n";
    static const char spec[] = "from 10 45 30\nat 10 45 0\nup 0 1 0\nangle 60\nresolution 40 "
                               "40\nmap 0 1 1 1 1\nmap 1 1 1 1 1\n";
    char err[ERR_BYTES];
    if (grid_read("grid", (const unsigned char *)vtk, strlen(vtk), g, err) != 0)
        fail_msg("%s", err);
    if (spec_read("spec", spec, strlen(spec), s, err) != 0) fail_msg("%s", err);
}

/* The script for these lines ends with its plot, and tells of coasts where there is one. */
static void draws(const struct grid *g, const struct spec *s, const char *lines, bool coast)
{
    struct backdrop b = {
        .grid = g, .spec = s, .w = 40, .h = 40, .title = "x", .unit = "m", .time = ""};
    struct buf out = {0};
    char err[BACKDROP_ERR];
    b.lines_name = "lines";
    b.lines = lines;
    if (backdrop_write(&b, BACKDROP_ALL, &out, err) != 0) fail_msg("%s", err);
    buf_append(&out, "", 1);
    const char *text = (const char *)buf_data(&out);
    assert_non_null(strstr(text, "$edges with lines"));
    assert_int_equal(strstr(text, "$lines with lines") != NULL, coast);
    buf_free(&out);
}

static void test_outlines(void **state)
{
    (void)state;
    struct grid g;
    struct spec s;
    load(&g, &s);
    draws(&g, &s, "", false);
    draws(&g, &s, ">\n>\n\n# nothing\n", false);
    draws(&g, &s, "> land\n> water\n>\n", false);
    draws(&g, &s, "> land\n10 45\n> water\n10 45\n>\n10 45\n", false);
    draws(&g, &s, "5 42\n15 48\n>\n", true);
    draws(&g, &s, "1e18 42\n-1e18 48\n> land\n-1e18 -1e18\n1e18 -1e18\n1e18 1e18\n", true);
    grid_free(&g);
    spec_free(&s);
}

/* ---- labels ---------------------------------------------------------------------------------- */

static double between(uint64_t *seed, double lo, double hi)
{
    return lo + (hi - lo) * rng_unit(1, (*seed)++);
}

static void put_view(uint64_t *seed, struct buf *b)
{
    const double far = between(seed, 1, 60), w = between(seed, 100, 4000);
    buf_printf(b, "from %g %g %g\nat %g %g %g\nup 0 .1 1\nangle %g\nresolution %d %d\n",
        between(seed, -far, 20 + far), between(seed, 40 - far, 50 + far),
        between(seed, -far / 4, far), between(seed, 0, 20), between(seed, 40, 50),
        between(seed, 0, 3), between(seed, 1, 150), (int)w, (int)between(seed, 80, w));
}

static void put_colours(uint64_t *seed, struct buf *b)
{
    const double size = pow(10, between(seed, -9, 9));
    int knots = (int)between(seed, 0, 12), isos = (int)between(seed, knots < 2, 40);
    double at = between(seed, -size, size);
    for (int i = 0; i < knots && knots > 1; i++, at += between(seed, 0, size / knots))
        buf_printf(b, "map %.9g 1 0 0 %g\n", at, between(seed, 0, 9));
    for (int i = 0; i < isos; i++, at += between(seed, size / 1e4, size / isos))
        buf_printf(b, "iso %.9g 0 1 0 .5\n", at);
}

struct label {
    double x0, x1, y0, y1;
};

/* A text's rectangle by the widths of most characters of DejaVu Sans, and the height of a digit. */
static bool read_label(const char *line, double em, struct label *l)
{
    const char *text = line + strlen("set label '"), *at = strstr(line, "' at ");
    char *end;
    if (strncmp(line, "set label '", strlen("set label '")) != 0 || !at) return false;
    double wide = 0, x = strtod(at + 5, &end), y = strtod(end + 1, &end);
    for (const char *c = text; c < at; c++)
        wide += (*c & 0xc0) == 0x80 ? 0 : strchr(" .:-", *c) ? .32 : .55;
    wide *= em;
    x -= strncmp(end, " left", 5) == 0 ? 0 : strncmp(end, " right", 6) == 0 ? wide : wide / 2;
    *l = (struct label){x, x + wide, y - em / 2, y + em / 2};
    return true;
}

static void check_labels(const char *script, const struct backdrop *b, const char *spec)
{
    struct label l[512];
    size_t n = 0, in_strip = 0;
    double strip = backdrop_strip(b), em = 16 * fmax(.4, fmin(b->h / 720.0, b->w / 1080.0));
    char plate[96];
    snprintf(plate, sizeof plate, "rect from 0.00,-%.2f to %.2f,0.00 ", strip, (double)b->w);
    const char *legend = strstr(script, plate); /* later labels are those of the strip */
    if (!legend) fail_msg("no plate %s:\n%s", plate, spec);
    for (const char *p = script; p && n < 512; p = strchr(p, '\n'), p = p ? p + 1 : p) {
        if (!read_label(p, em, &l[n])) continue;
        const struct label *k = &l[n++];
        bool below = p > legend;
        in_strip += below;
        if (k->x0 < 0 || k->x1 > b->w || k->y0 < (below ? -strip : 0) || k->y1 > (below ? 0 : b->h))
            fail_msg("outside: %.60s:\n%s", p, spec);
        for (size_t i = 0; i + 1 < n; i++)
            if (l[i].x0 < k->x1 && k->x0 < l[i].x1 && l[i].y0 < k->y1 && k->y0 < l[i].y1)
                fail_msg("covers another one: %.60s:\n%s", p, spec);
    }
    if (in_strip < 2 && b->w > 150) fail_msg("%zu labels in the legend:\n%s", in_strip, spec);
}

static void test_labels(void **state)
{
    (void)state;
    /* globes of some metres */
    static const char *const planes[] = {"+proj=stere +lat_0=90 +R=20 +x_0=10 +y_0=45",
        "+proj=merc +R=3.2 +x_0=10 +y_0=45", "+proj=lcc +lat_1=50 +R=9 +x_0=10 +y_0=45",
        "+proj=laea +lon_0=170 +R=3 +x_0=10 +y_0=45", "+proj=utm +zone=3 +ellps=WGS84"};
    struct grid g;
    struct spec s;
    char err[ERR_BYTES];
    load(&g, &s);
    spec_free(&s);
    uint64_t seed = 1;
    for (int round = 0; round < rounds(400); round++) {
        struct buf text = {0}, out = {0};
        put_view(&seed, &text);
        put_colours(&seed, &text);
        buf_printf(&text, "scale 1 1 %g\n", between(&seed, .01, 9));
        if (spec_read("spec", (const char *)buf_data(&text), buf_size(&text), &s, err) != 0)
            fail_msg("%s", err);
        buf_append(&text, "", 1);
        struct backdrop b = {.grid = &g,
            .spec = &s,
            .w = s.w,
            .h = s.h,
            .title = "wind speed, m/s",
            .unit = "hPa",
            .time = "2026-11-23 12:00 UTC"};
        if (round % 3 == 1) b.flat = "m", b.proj = planes[round % 5];
        if (backdrop_write(&b, BACKDROP_ALL, &out, err) != 0) fail_msg("%s", err);
        buf_append(&out, "", 1);
        check_labels((const char *)buf_data(&out), &b, (const char *)buf_data(&text));
        buf_free(&out);
        buf_free(&text);
        spec_free(&s);
    }
    grid_free(&g);
}

/* ---- legends --------------------------------------------------------------------------------- */

/* The number of patches of these colours in the legend of a specification with these lines. */
static int patches(const char *lines, const char *rgb)
{
    struct grid g;
    struct spec s;
    struct buf text = {0}, out = {0};
    char err[ERR_BYTES], rest[48];
    int n = 0;
    load(&g, &s);
    spec_free(&s);
    buf_printf(
        &text, "from 10 45 30\nat 10 45 0\nup 0 1 0\nangle 60\nresolution 400 300\n%s", lines);
    if (spec_read("spec", (const char *)buf_data(&text), buf_size(&text), &s, err) != 0)
        fail_msg("%s", err);
    struct backdrop b = {
        .grid = &g, .spec = &s, .w = s.w, .h = s.h, .title = "x", .unit = "m", .time = ""};
    if (backdrop_write(&b, BACKDROP_ALL, &out, err) != 0) fail_msg("%s", err);
    buf_append(&out, "", 1);
    snprintf(rest, sizeof rest, "front fs solid noborder fc rgb '#%s", rgb);
    for (const char *p = (const char *)buf_data(&out); (p = strstr(p, rest)); p++) n++;
    buf_free(&text);
    buf_free(&out);
    grid_free(&g);
    spec_free(&s);
    return n;
}

/* The plate under the legend, in the colour of the page, is a patch too. */
static void test_legends(void **state)
{
    (void)state;
    assert_int_equal(patches("map 0 1 0 0 1e6\nmap 1 1 0 0 1e6\n", "ff0000"), 48);
    assert_int_equal(patches("map 0 1 0 0 0\nmap 1 1 0 0 0\n", ""), 1);
    /* A slice shows colours without extinction. */
    assert_int_equal(patches("map 0 1 0 0 0\nmap 1 1 0 0 0\nslice z .5 1\n", "ff0000"), 48);
    assert_int_equal(
        patches("map 0 1 0 0 0\nmap 1 1 0 0 0\nslice z .5 .5\nslice x 9 1\n", "ff0000"), 48);
    assert_int_equal(patches("map 0 1 0 0 0\nmap 1 1 0 0 0\nslice z .5 .5\n", "fab5b5"), 48);
    assert_int_equal(patches("map 0 1 0 0 1e6\nmap 1 1 0 0 1e6\nslice z .5 .5\n", "ff0000"), 48);
    /* The second field's colours are opaque, and hold beyond the knots. */
    static const char second[] = "map 0 1 0 0 .1\nmap 1 1 0 0 .1\niso .5 0 1 0 1\nslice z .5 .5\n"
                                 "colour 7 0 0 1\ncolour 9 0 0 1\n";
    assert_int_equal(patches(second, "0000ff"), 50);
    assert_int_equal(patches(second, ""), 51);
    assert_int_equal(patches("map 0 1 0 0 1\nmap 1 1 0 0 1\ncolour 7 0 0 1\n", "0000ff"), 2);
}

static void is_time(const char *title, const char *expected)
{
    char text[BACKDROP_TIME];
    backdrop_time(title, text);
    assert_string_equal(text, expected);
}

static void test_times(void **state)
{
    (void)state;
    is_time("T [K]; x lon [degrees_east]", "");
    is_time("T [K]; t time 0.5 [d]", "time 0.5 d");
    is_time("T [K]; t validity 202611231200 [YYYYMMDDhhmm]", "2026-11-23 12:00 UTC");
    is_time("T [K]; t validity 202611231200 to 202611240000 [YYYYMMDDhhmm]",
        "2026-11-23 12:00 to 2026-11-24 00:00 UTC");
    is_time("T [K]; t time 0 to 6 [h]", "time 0 to 6 h");
    is_time("T [K]; t validity 2026 [YYYYMMDDhhmm]", "validity 2026 YYYYMMDDhhmm");
    is_time("T [K]; t time 3 [months since 2000-01-01]", "time 3 months since 2000-01-01");
    is_time("T [K]; t time 3 [years since 2000-01-01]", "time 3 years since 2000-01-01");
    is_time("T [K]; t time x [days since 2000-01-01]", "time x days since 2000-01-01");
    is_time("T [K]; t time 1e17 [days since 2000-01-01]", "time 1e17 days since 2000-01-01");
    char err[ERR_BYTES];
    struct units_linear l;
    if (!units_linear("h", "s", &l, err)) return; /* built without udunits */
    is_time("T [K]; t time 20780.5 [days since 1970-01-01 00:00:00]", "2026-11-23 12:00 UTC");
    is_time("T [K]; t time 90 [minutes since 2000-2-28 23:00]", "2000-02-29 00:30 UTC");
    is_time("T [K]; t time 58 to 59 [days since 2000-01-01 (noleap)]",
        "2000-02-28 00:00 to 2000-03-01 00:00 (noleap)");
    is_time("T [K]; t time 739000 [days since 1-1-1]", "2024-04-23 00:00 UTC");
    is_time("T [K]; t time 0 [days since 1582-10-15]", "1582-10-15 00:00 UTC");
    is_time("T [K]; t time -1 [days since 1582-10-15]", "1582-10-04 00:00 UTC");
    is_time("T [K]; t time 366 [hour since 0000-01-01]", "0001-01-16 06:00 UTC");
    is_time("T [K]; t time 0 [days since 1999-03-01 00:00 +01:00]", "1999-02-28 23:00 UTC");
    /* Calendars of models. */
    is_time("T [K]; t time 59 [days since 2000-01-01 (noleap)]", "2000-03-01 00:00 (noleap)");
    is_time("T [K]; t time 59 [days since 2000-01-01 (NOLEAP)]", "2000-03-01 00:00 (NOLEAP)");
    is_time("T [K]; t time 59 [days since 1999-01-01 (366_day)]", "1999-02-29 00:00 (366_day)");
    is_time("T [K]; t time 59 [days since 2000-01-01 (360_day)]", "2000-02-30 00:00 (360_day)");
    is_time("T [K]; t time 13.5 [months since 2000-01-01 (360_day)]", "2001-02-16 00:00 (360_day)");
    is_time("T [K]; t time -1 [hours since 1-1-1 00:00:00 (julian)]", "0000-12-31 23:00 (julian)");
    is_time("T [K]; t time 36600 [days since 1900-01-01 (julian)]", "2000-03-16 00:00 (julian)");
    is_time("T [K]; t time 0.5 [days since 1400-02-28 12:00 (proleptic_gregorian)]",
        "1400-03-01 00:00 (proleptic_gregorian)");
    is_time("T [K]; t time 90 [minutes since 2000-12-30T23:00:00.0 UTC (365_day)]",
        "2000-12-31 00:30 (365_day)");
    is_time("T [K]; t time 2 [months since 2000-01-01 (noleap)]",
        "time 2 months since 2000-01-01 (noleap)");
    is_time("T [K]; t time 1 [days since 1999-02-29 (noleap)]",
        "time 1 days since 1999-02-29 (noleap)");
    is_time(
        "T [K]; t time 1 [days since 1999-02-01 (lunar)]", "time 1 days since 1999-02-01 (lunar)");
    is_time("T [K]; t time -1e9 [days since 1999-02-01 (julian)]",
        "time -1e9 days since 1999-02-01 (julian)");
}

/* What the map of a grid with this title is labelled with; unit: of -z. */
static void is_named(const char *title, const char *unit, const struct backdrop *expected)
{
    struct grid g;
    struct spec s;
    struct backdrop_names n;
    load(&g, &s);
    snprintf(g.title, sizeof g.title, "%s", title);
    struct backdrop b = {.grid = &g, .spec = &s};
    backdrop_name(&b, NULL, unit, &n);
    assert_string_equal(b.title, expected->title);
    assert_string_equal(b.unit, expected->unit);
    assert_string_equal(b.flat ? b.flat : "", expected->flat ? expected->flat : "");
    assert_string_equal(b.levels ? b.levels : "", expected->levels ? expected->levels : "");
    assert_int_equal(b.down, expected->down);
    grid_free(&g);
    spec_free(&s);
}

static void test_names(void **state)
{
    (void)state;
    is_named("", NULL, &(struct backdrop){.title = "x", .unit = ""});
    is_named("T [K]; x lon [degrees_east]; z height [m]", NULL,
        &(struct backdrop){.title = "T, K", .unit = "m"});
    is_named("T [K]; x easting [m]; z -depth [m]", NULL,
        &(struct backdrop){.title = "T, K", .unit = "m", .flat = "m", .down = true});
    is_named("T [K]; x rlon [degrees]", NULL,
        &(struct backdrop){.title = "T, K", .unit = "", .flat = BACKDROP_DEGREE});
    is_named("T [K]; x grid_longitude []", NULL,
        &(struct backdrop){.title = "T, K", .unit = "", .flat = BACKDROP_DEGREE});
    is_named("T [K]; x rlon [rad]", NULL,
        &(struct backdrop){.title = "T, K", .unit = "", .flat = "rad"});
    is_named("T [K]; x longitude [degrees]", NULL, &(struct backdrop){.title = "T, K", .unit = ""});
    is_named("T [K]; z lev [sigma_level]", NULL,
        &(struct backdrop){.title = "T, K", .unit = "sigma_level", .levels = "lev"});
    is_named("T [K]; z lev [sigma_level]", "-hPa",
        &(struct backdrop){.title = "T, K", .unit = "hPa", .down = true});
}

static void test_alike(void **state)
{
    (void)state;
    struct grid a, b;
    struct spec s;
    load(&a, &s);
    spec_free(&s);
    load(&b, &s);
    assert_true(backdrop_alike(&a, &b));
    strcpy(a.title, "T [K]; t time 1 [h]");
    strcpy(b.title, "T [K]; t time 22 [h]");
    assert_true(backdrop_alike(&a, &b));
    strcpy(b.title, "U [K]; t time 1 [h]");
    assert_false(backdrop_alike(&a, &b));
    strcpy(b.title, a.title);
    b.at[2][1] = 2;
    assert_false(backdrop_alike(&a, &b));
    b.at[2][1] = a.at[2][1];
    strcpy(b.name, "y");
    assert_false(backdrop_alike(&a, &b));
    grid_free(&a);
    grid_free(&b);
    spec_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_outlines),
        cmocka_unit_test(test_labels), cmocka_unit_test(test_legends), cmocka_unit_test(test_times),
        cmocka_unit_test(test_names), cmocka_unit_test(test_alike)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
