/* Heights: the standard atmosphere against its tables; columns moved to planes; units. */
#include "convert/convert.h"
#include "units/units.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Geopotential heights and pressures of table I of the U.S. Standard Atmosphere, 1976: layer
 * boundaries, and points between. */
static void test_atmosphere(void **state)
{
    (void)state;
    static const double table[][2] = {{-1000, 113929}, {0, 101325}, {5000, 54019.9},
        {11000, 22632.06}, {15000, 12044.6}, {20000, 5474.889}, {25000, 2511.02}, {32000, 868.0187},
        {40000, 277.522}, {47000, 110.9063}, {51000, 66.93887}, {60000, 20.3143}, {71000, 3.956420},
        {80000, .886272}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        assert_true(fabs(convert_standard_height(table[i][1]) - table[i][0]) < .3);
    /* It goes on upwards. */
    assert_true(convert_standard_height(1e-6) > 90000);
    assert_true(isfinite(convert_standard_height(1e-300)));
}

/* The check value of the algorithm's report; and depths of TEOS-10 (gsw.z_from_p of Debian's
 * python3-gsw 3.6), which differ by the properties of sea water. */
static void test_sea(void **state)
{
    (void)state;
    static const double teos[][3] = {{10, 50, 9.91404641}, {500, 50, 495.11556686},
        {2000, 50, 1973.42273782}, {1000, 0, 992.11738902}, {1000, 60, 988.19228457},
        {10000, 30, 9713.7351768}};
    assert_true(fabs(convert_sea_depth(10000, 30) - 9712.653) < 5e-4);
    assert_true(convert_sea_depth(0, 90) == 0);
    for (size_t i = 0; i < sizeof teos / sizeof *teos; i++)
        assert_true(
            fabs(convert_sea_depth(teos[i][0], teos[i][1]) - teos[i][2]) < 2e-4 * teos[i][2]);
    float value[8] = {2e7f, 2e7f, 2e7f, 2e7f, 0, 0, 0, 0};
    double y[2] = {0, 60};
    struct grid g = {.n = {2, 2, 2}, .at = {NULL, y, NULL}, .value = value};
    convert_sea_pressures(&g);
    assert_true(fabs((double)value[0] + convert_sea_depth(2000, 0)) < 1e-3);
    assert_true(fabs((double)value[3] + convert_sea_depth(2000, 60)) < 1e-3 && value[7] == 0);
}

static struct grid grid_of(float *value) { return (struct grid){.n = {2, 2, 3}, .value = value}; }

static void test_columns(void **state)
{
    (void)state;
    const float nan = (float)NAN;
    /* Columns: from 0 to 200; 150 higher; 40 higher; with a missing height. */
    float height[12] = {0, 150, 40, 0, 100, 250, 140, nan, 200, 350, 240, 200};
    float value[12] = {1, 1, 1, 1, 2, 2, 2, 2, 3, 3, nan, 3};
    struct grid h = grid_of(height), g = grid_of(value);
    double plane[3];
    char err[ERR_BYTES];
    assert_true(convert_planes(&h, plane, err));
    assert_true(plane[0] == 0 && plane[1] == 100 && plane[2] == 200);
    plane[1] = 140;
    convert_to_planes(&g, &h, plane);
    assert_true(value[0] == 1 && fabsf(value[4] - 2.4f) < 1e-6f && value[8] == 3);
    /* 0 is more than half a layer below 150, in the ground; 140 is less. */
    assert_true(isnan(value[1]) && value[5] == 1 && fabsf(value[9] - 1.5f) < 1e-6f);
    /* Beside a missing value all is missing, and its neighbour's own height is not. */
    assert_true(value[2] == 1 && value[6] == 2 && isnan(value[10]));
    /* The level without height is left out. */
    assert_true(value[3] == 1 && fabsf(value[7] - 2.4f) < 1e-6f && value[11] == 3);
}

static void test_refused(void **state)
{
    (void)state;
    const float nan = (float)NAN;
    float height[12] = {0, 0, 0, 0, nan, nan, nan, nan, 3, 3, 3, 3};
    struct grid h = grid_of(height);
    double plane[3];
    char err[ERR_BYTES];
    assert_false(convert_planes(&h, plane, err));
    assert_string_equal(err, "all heights of the level 1 are missing, expected some");
    for (int i = 4; i < 8; i++) height[i] = -1;
    assert_false(convert_planes(&h, plane, err));
    assert_string_equal(err, "the height of the level 1 is -1 after 0, expected it to ascend");
}

static void test_units(void **state)
{
    (void)state;
    struct units_linear l;
    char err[ERR_BYTES];
    if (!units_linear("K", "degC", &l, err)) skip(); /* built without the library */
    assert_true(l.factor == 1 && fabs(l.offset + 273.15) < 1e-9);
    assert_true(units_linear("mb", "Pa", &l, err) && fabs(l.factor - 100) < 1e-9);
    assert_true(units_linear("m s**-1", "km/h", &l, err) && fabs(l.factor - 3.6) < 1e-9);
    assert_false(units_linear("m/s", "K", &l, err));
    assert_string_equal(err, "'m/s' does not convert to 'K'");
    assert_false(units_linear("furlongs per", "K", &l, err));
    assert_string_equal(err, "'furlongs per' is unknown, expected a unit of udunits2");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_atmosphere),
        cmocka_unit_test(test_sea),
        cmocka_unit_test(test_columns),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_units),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
