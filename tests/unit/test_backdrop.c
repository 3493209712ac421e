/* Outlines that break a map: without points, with one, beyond the globe. */
#include "backdrop/backdrop.h"

#include <setjmp.h>
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
    struct backdrop b = {.grid = g, .spec = s, .w = 40, .h = 40, .title = "x", .unit = "m"};
    struct buf out = {0};
    char err[BACKDROP_ERR];
    b.lines_name = "lines";
    b.lines = lines;
    if (backdrop_write(&b, &out, err) != 0) fail_msg("%s", err);
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_outlines)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
