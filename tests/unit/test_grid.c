/* Grids: what of VTK legacy is taken, what is refused and where, truncations; writing; values. */
#include "grid/grid.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define HEAD "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET RECTILINEAR_GRID\n"
#define AXES                                                                                       \
    "DIMENSIONS 2 2 3\nX_COORDINATES 2 float\n0 1\nY_COORDINATES 2 float\n10 12\n"                 \
    "Z_COORDINATES 3 double\n-1 0 4\n"
#define SCALARS "POINT_DATA 12\nSCALARS wind float 1\nLOOKUP_TABLE default\n"
#define VALUES "1 2 3 4 5 6 7 8 9 10 11 12\n"

static int read_bytes(const void *bytes, size_t n, struct grid *g, char err[ERR_BYTES])
{
    /* Exactly as long as the bytes, so that a read past them is seen. */
    unsigned char *copy = xmalloc(n, 1);
    if (n) memcpy(copy, bytes, n);
    int rc = grid_read("t", copy, n, g, err);
    free(copy);
    return rc;
}

static struct grid parse_n(const void *bytes, size_t n)
{
    struct grid g;
    char err[ERR_BYTES];
    if (read_bytes(bytes, n, &g, err) != 0) fail_msg("refused: %s", err);
    return g;
}

static struct grid parse(const char *text) { return parse_n(text, strlen(text)); }

static void assert_counts(const struct grid *g)
{
    for (size_t i = 0; i < 12; i++) assert_true(g->value[i] == (float)(i + 1));
}

static void test_ascii(void **state)
{
    (void)state;
    static const char *const same[] = {
        HEAD AXES SCALARS VALUES,
        HEAD AXES "POINT_DATA 12 SCALARS wind double\nLOOKUP_TABLE x\n" VALUES,
        HEAD AXES "POINT_DATA 12\nSCALARS wind unsigned_char\nLOOKUP_TABLE default\n" VALUES,
        HEAD AXES "POINT_DATA 12\nFIELD FieldData 1\nwind 1 12 float\n" VALUES,
        HEAD AXES SCALARS "1 2 3 4 5 6 7 8 9 10 11 12\nMETADATA\nINFORMATION 1\nx\n\n",
        HEAD "FIELD FieldData 2\nTIME 1 1 double\n.5\nMETADATA\nINFORMATION 0\n\n"
             "CYCLE 1 1 int\n7\n" AXES SCALARS VALUES,
        "# VTK datafile version 2.0\r\n\r\nascii\r\ndataset rectilinear_grid\r\n" AXES SCALARS
        "1 2. 3e0 +4 .5e1 0006\r\n7 8 9\t10 11 12",
    };
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        struct grid g = parse(same[i]);
        assert_true(g.n[0] == 2 && g.n[1] == 2 && g.n[2] == 3);
        assert_true(g.at[0][0] == 0 && g.at[0][1] == 1 && g.at[1][0] == 10 && g.at[1][1] == 12);
        assert_true(g.at[2][0] == -1 && g.at[2][1] == 0 && g.at[2][2] == 4);
        assert_string_equal(g.name, "wind");
        assert_counts(&g);
        grid_free(&g);
    }
    struct grid g = parse(HEAD AXES "POINT_DATA 12\nSCALARS a%20b%25%zz%2 float\nLOOKUP_TABLE d\n"
                                    "1 nan -nan NaN 5 6 7 8 9 10 11 -1e18");
    assert_string_equal(g.name, "a b%%zz%2");
    assert_true(isnan(g.value[1]) && isnan(g.value[2]) && isnan(g.value[3]));
    assert_true(g.value[11] == -1e18F);
    grid_free(&g);
}

/* What descends is turned round, the values with it. */
static void test_descending(void **state)
{
    (void)state;
    static const char *const axes[3][2] = {
        {"X_COORDINATES 2 int 0 1\n", "X_COORDINATES 2 int 1 0\n"},
        {"Y_COORDINATES 2 int 0 1\n", "Y_COORDINATES 2 int 1 0\n"},
        {"Z_COORDINATES 3 int 0 1 2\n", "Z_COORDINATES 3 int 2 1 0\n"}};
    for (unsigned down = 0; down < 8; down++) {
        char text[512];
        int n = snprintf(text, sizeof text, HEAD "DIMENSIONS 2 2 3\n%s%s%s" SCALARS VALUES,
            axes[0][down & 1], axes[1][down >> 1 & 1], axes[2][down >> 2]);
        struct grid g = parse_n(text, (size_t)n);
        for (uint32_t k = 0; k < 3; k++)
            for (uint32_t j = 0; j < 2; j++)
                for (uint32_t i = 0; i < 2; i++) {
                    uint32_t x = down & 1 ? 1 - i : i, y = down & 2 ? 1 - j : j;
                    uint32_t z = down & 4 ? 2 - k : k;
                    assert_true(g.at[0][i] == i && g.at[1][j] == j && g.at[2][k] == k);
                    assert_true(
                        g.value[grid_node(&g, i, j, k)] == (float)(1 + x + 2 * (y + 2 * z)));
                }
        grid_free(&g);
    }
}

/* ---- binary -------------------------------------------------------------------------------- */

static void put(struct buf *b, uint64_t bits, int size)
{
    while (size--) {
        unsigned char c = (unsigned char)(bits >> 8 * size);
        buf_append(b, &c, 1);
    }
}

static void put_real(struct buf *b, double v, int size)
{
    float f = (float)v;
    uint64_t bits = 0;
    uint32_t low;
    if (size == 4) memcpy(&low, &f, 4), bits = low;
    else memcpy(&bits, &v, 8);
    put(b, bits, size);
}

static struct buf binary(const char *type, int size, bool real)
{
    struct buf b = {0};
    buf_printf(&b, "# vtk DataFile Version 4.2\n\nBINARY\nDATASET RECTILINEAR_GRID\n"
                   "FIELD FieldData 1\nTIME 1 1 double\n");
    put_real(&b, 1e9, 8);
    buf_printf(&b, "\nDIMENSIONS 2 2 3\nX_COORDINATES 2 short\n");
    put(&b, 0x0a0d, 2); /* what line ends look like */
    put(&b, 0x2020, 2);
    buf_printf(&b, "\nMETADATA\nINFORMATION 0\n\nY_COORDINATES 2 float\n");
    put_real(&b, -1.5, 4);
    put_real(&b, 1.5, 4);
    buf_printf(&b, "\nZ_COORDINATES 3 double\n");
    for (int i = 0; i < 3; i++) put_real(&b, -i, 8);
    buf_printf(&b, "\nPOINT_DATA 12\nSCALARS s %s\nLOOKUP_TABLE default\n", type);
    for (int i = -4; i < 8; i++)
        if (real) put_real(&b, i, size);
        else put(&b, (uint64_t)i, size);
    buf_printf(&b, "\nMETADATA\nINFORMATION 0\n\n");
    return b;
}

static void test_binary(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int size;
        bool real;
        double wraps; /* what -4 is short of in an unsigned type */
    } types[] = {{"float", 4, true, 0}, {"double", 8, true, 0}, {"char", 1, false, 0},
        {"unsigned_char", 1, false, 0x1p8}, {"short", 2, false, 0},
        {"unsigned_short", 2, false, 0x1p16}, {"int", 4, false, 0},
        {"unsigned_int", 4, false, 0x1p32}, {"vtktypeint64", 8, false, 0}, {"LONG", 8, false, 0}};
    for (size_t t = 0; t < sizeof types / sizeof *types; t++) {
        struct buf b = binary(types[t].name, types[t].size, types[t].real);
        struct grid g = parse_n(buf_data(&b), buf_size(&b));
        assert_true(g.at[0][0] == 0x0a0d && g.at[0][1] == 0x2020);
        assert_true(g.at[1][0] == -1.5 && g.at[2][0] == -2 && g.at[2][2] == 0);
        for (uint32_t k = 0; k < 3; k++)
            for (uint32_t i = 0; i < 4; i++) {
                double v = (int)(i + 4 * (2 - k)) - 4;
                if (v < 0) v += types[t].wraps;
                assert_true(g.value[i + 4 * k] == (float)v);
            }
        grid_free(&g);
        buf_free(&b);
    }
}

/* ---- what is refused ----------------------------------------------------------------------- */

static void assert_refused(const char *text, const char *message)
{
    struct grid g;
    char err[ERR_BYTES];
    if (read_bytes(text, strlen(text), &g, err) == 0) fail_msg("taken: %s", text);
    if (!strstr(err, message)) fail_msg("got: %s, expected: %s", err, message);
    assert_true(!g.value && !g.at[0] && !g.at[1] && !g.at[2]);
}

static void test_refused(void **state)
{
    (void)state;
#define X2 "X_COORDINATES 2 float\n"
#define YZ "Y_COORDINATES 2 float 0 1\nZ_COORDINATES 2 float 0 1\n"
#define CUBE HEAD "DIMENSIONS 2 2 2\n" X2 "0 1\n" YZ
    static const struct {
        const char *text, *message;
    } bad[] = {
        {"", "t:1: no VTK legacy file"},
        {"<?xml version=\"1.0\"?>", "t:1: no VTK legacy file"},
        {"# vtk DataFile Version 3.0\nx\nTEXT\n", "t:3: form is 'TEXT', expected ASCII or BINARY"},
        {"# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\n",
            "t:4: dataset is 'STRUCTURED_POINTS', expected RECTILINEAR_GRID; "
            "vol2vtk makes one of STRUCTURED_POINTS"},
        {HEAD "DIMENSIONS 2 1 2\n", "t:5: nodes along y is '1', expected an integer from 2"},
        {HEAD "DIMENSIONS 2 -2 2\n", "t:5: nodes along y is '-2'"},
        {HEAD "DIMENSIONS 2147483647 2147483647 2147483647\n", "too short for its DIMENSIONS"},
        {HEAD "DIMENSIONS 2 2 2\n" X2 "0 0\n", "number 2 is 0 after 0, expected all to ascend"},
        {HEAD "DIMENSIONS 3 2 2\nX_COORDINATES 3 float\n0 2 1\n" YZ,
            "t:7: X_COORDINATES: number 3 is 1 after 2, expected all to ascend or all to descend"},
        {HEAD "DIMENSIONS 3 2 2\nX_COORDINATES 3 float\n2 1 1\n" YZ, "number 3 is 1 after 1"},
        {HEAD "DIMENSIONS 2 2 2\nX_COORDINATES 2 double\n0 1e-300\n",
            "number 2 is 1e-300 after 0, expected steps of 1e-18 at least"},
        {HEAD "DIMENSIONS 2 2 2\n" X2 "0 nan\n", "number 2 is nan, expected a number"},
        {HEAD "DIMENSIONS 2 2 2\n" X2 "0 1e19\n" YZ, "X_COORDINATES: 1e+19, expected numbers from"},
        {HEAD "DIMENSIONS 2 2 2\nX_COORDINATES 3 float\n0 1 2\n",
            "t:6: number of coordinates is '3', expected 2"},
        {HEAD "DIMENSIONS 2 2 2\nX_COORDINATES 2 bit\n0 1\n", "t:6: type of numbers is 'bit'"},
        {CUBE "CELL_DATA 1\nSCALARS s float\n", "t:10: word after the coordinates is 'CELL_DATA'"},
        {CUBE "POINT_DATA 1\n", "t:10: number of point data is '1', expected 8"},
        {CUBE "POINT_DATA 8\nVECTORS v float\n", "VECTORS, expected SCALARS"},
        {CUBE "POINT_DATA 8\nSCALARS v float 3\n", "number of components is '3'"},
        {CUBE "POINT_DATA 8\nSCALARS v float\n1 2 3 4 5 6 7 8",
            "t:12: next part is '2', expected LOOKUP_TABLE"},
        {CUBE "POINT_DATA 8\nFIELD FieldData 2\n", "number of arrays is '2'"},
        {CUBE "POINT_DATA 8\nFIELD FieldData 1\nv 3 8 float\n", "number of components is '3'"},
        {CUBE "POINT_DATA 8\nSCALARS v float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7",
            "values: 8 announced, but the file has bytes for 7"},
        {CUBE "POINT_DATA 8\nSCALARS v float\nLOOKUP_TABLE default\n1 2 3 4 5 6 12345678901234",
            "t:13: the file ends before values, expected a number"},
        {CUBE "POINT_DATA 8\nSCALARS v float\nLOOKUP_TABLE default\n1 2\n3 x 5 6 7 8\n",
            "t:14: values is 'x', expected a number"},
        {CUBE "POINT_DATA 8\nSCALARS v int\nLOOKUP_TABLE default\n1 2\n99999999999999 4 5 6 7 8\n",
            "t:14: values is '99999999999999', expected an integer from -2147483648 to 2147483647: "
            "it is of type int"},
        {CUBE "POINT_DATA 8\nSCALARS v unsigned_char\nLOOKUP_TABLE default\n1 2 3 -1 5 6 7 8\n",
            "t:13: values is '-1', expected an integer from 0 to 255"},
        {CUBE "POINT_DATA 8\nSCALARS v char\nLOOKUP_TABLE default\n1 2 3 128 5 6 7 8\n",
            "'128', expected an integer from -128 to 127"},
        {CUBE "POINT_DATA 8\nSCALARS v unsigned_long\nLOOKUP_TABLE default\n1 2 3 1.5 5 6 7 8\n",
            "'1.5', expected an integer from 0 to 18446744073709551615"},
        {CUBE "POINT_DATA 8\nSCALARS v short\nLOOKUP_TABLE default\n1 2 3 nan 5 6 7 8\n",
            "'nan', expected an integer from -32768 to 32767"},
        {CUBE "POINT_DATA 8\nSCALARS v double\nLOOKUP_TABLE default\n1 2 3 1e999 5 6 7 8\n",
            "'1e999', expected a number from -1.79769e+308"},
        {CUBE "POINT_DATA 8\nSCALARS v float\nLOOKUP_TABLE default\n1 2 3 1e39 5 6 7 8\n",
            "'1e39', expected a number from -3.40282e+38"},
        {CUBE "POINT_DATA 8\nSCALARS v float\nLOOKUP_TABLE default\n1 2 3 inf 5 6 7 8\n",
            "values is 'inf'"},
        {CUBE "POINT_DATA 8\nSCALARS v float\nLOOKUP_TABLE default\n1 2 3 9.97e36 5 6 7 8\n",
            "values: 9.97e+36, expected numbers from -1e+18 to 1e+18, and nan for missing ones"},
        {CUBE "POINT_DATA 8\nSCALARS v float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8 9\n",
            "t:13: word after the values is '9', expected one scalar and the file's end; "
            "vol2vtk takes one"},
        {CUBE "POINT_DATA 8\nSCALARS v float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\nSCALARS w int",
            "t:14: word after the values is 'SCALARS'"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(bad[i].text, bad[i].message);
}

#define FIRST HEAD AXES SCALARS VALUES
#define GROUND                                                                                     \
    HEAD "DIMENSIONS 3 2 1\nX_COORDINATES 3 int\n9 5 0\nY_COORDINATES 2 float\n1 2\n"              \
         "Z_COORDINATES 1 float\n7\nPOINT_DATA 6\nSCALARS h short\nLOOKUP_TABLE d\n3 2 1 6 5 4\n"
#define SECOND                                                                                     \
    "# vtk DataFile Version 3.0\nwind\nASCII\nDATASET RECTILINEAR_GRID\n" AXES SCALARS             \
    "12 11 nan 9 8 7 6 5 4 3 2 1\n"

/* A second field and a ground, in either order, may follow. */
static void test_further(void **state)
{
    (void)state;
    static const char *const texts[] = {FIRST SECOND GROUND, FIRST "\n" GROUND SECOND};
    for (int i = 0; i < 2; i++) {
        struct grid g = parse(texts[i]);
        assert_true(g.second && g.ground && g.ground->n[0] == 3 && g.ground->n[2] == 1);
        assert_string_equal(g.second_name, g.name);
        assert_string_equal(g.second_title, "wind");
        assert_true(g.ground->at[0][0] == 0 && g.ground->value[0] == 1 && g.ground->value[5] == 6);
        for (size_t k = 0; k < 12; k++) {
            assert_true(k == 2 ? isnan(g.value[k]) : g.value[k] == (float)(k + 1));
            assert_true(k == 2 ? isnan(g.second[k]) : g.second[k] == (float)(12 - k));
        }
        grid_free(&g);
    }
    static const char *const bad[][2] = {
        {GROUND FIRST, "a grid of several levels after one of one, expected it before that one"},
        {FIRST GROUND GROUND, "a second grid of one level, expected one at most"},
        {FIRST SECOND SECOND, "a third grid of several levels, expected two at most"},
        {FIRST HEAD "DIMENSIONS 2 2 2\nX_COORDINATES 2 float\n0 1\nY_COORDINATES 2 float\n10 12\n"
                    "Z_COORDINATES 2 double\n-1 0\nPOINT_DATA 8\nSCALARS wind float 1\n"
                    "LOOKUP_TABLE default\n1 2 3 4 5 6 7 8\n",
            "a second grid with other coordinates, expected those of the first, or one level"},
        {FIRST HEAD "FIELD FieldData 2\nbrick_whole 6 1 int\n0 1 10 12 -1 4\n"
                    "brick_own 6 1 int\n0 1 10 12 -1 4\n" AXES SCALARS VALUES,
            "a brick and another grid, expected one of them"},
        {FIRST "# vtk\n", "t:16: no VTK legacy file"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct grid g;
        char err[ERR_BYTES];
        assert_int_equal(read_bytes(bad[i][0], strlen(bad[i][0]), &g, err), -1);
        if (!strstr(err, bad[i][1])) fail_msg("%zu: %s, expected %s", i, err, bad[i][1]);
        assert_true(!g.value && !g.second && !g.ground);
    }
}

/* One level alone becomes two, with its values. */
static void test_flat(void **state)
{
    (void)state;
    struct grid g = parse(GROUND);
    assert_true(g.flat && g.n[2] == 2 && g.at[2][0] == 7 && g.at[2][1] > 7 && !g.ground);
    for (size_t k = 0; k < 12; k++) assert_true(g.value[k] == (float)(k % 6 + 1));
    assert_int_equal(grid_nodes((const unsigned char *)GROUND, sizeof GROUND - 1), 12);
    grid_free(&g);
    g = parse(GROUND GROUND);
    assert_true(g.flat && g.ground && g.ground->n[2] == 1 && !strcmp(g.ground_name, "h"));
    grid_free(&g);
}

/* Four columns of a circle, from 0 on, and those of a part of it, from 300 on. */
#define HEADED "# vtk DataFile Version 3.0\ns [K]; x lon [degrees_east]\nASCII\n"                 \
               "DATASET RECTILINEAR_GRID\n"
#define Y2 "Y_COORDINATES 2 float\n1 2\n"
#define EARTH(nx, x, nz, z, n, values)                                                             \
    HEADED "DIMENSIONS " #nx " 2 " #nz "\nX_COORDINATES " #nx " float\n" x "\n" Y2                 \
           "Z_COORDINATES " #nz " float\n" z "\nPOINT_DATA " #n                                    \
           "\nSCALARS s float\nLOOKUP_TABLE d\n" values "\n"
#define WEST EARTH(3, "-180 -90 0", 2, "0 1", 12, "1 1 1 1 1 1 1 1 1 1 1 1")

static void is_row(const struct grid *g, const double *x, const float *value, uint32_t n)
{
    assert_int_equal(g->n[0], n);
    for (uint32_t i = 0; i < n; i++) {
        assert_true(g->at[0][i] == x[i]);
        for (uint32_t row = 0; row < 2; row++) {
            const float v = g->value[row * n + i];
            assert_true(isnan(value[i]) ? isnan(v) : v == value[i] + 10 * (float)row);
        }
    }
}

/* Further grids are moved by whole circles to the first one. */
static void test_turned(void **state)
{
    (void)state;
    struct grid g = parse(WEST EARTH(4, "0 90 180 270", 1, "0", 8, "0 1 2 3 10 11 12 13"));
    is_row(g.ground, (double[]){-180, -90, 0}, (float[]){2, 3, 0}, 3);
    assert_true(grid_over_ground(&g) == 1);
    grid_free(&g);
    g = parse(WEST EARTH(4, "45 135 225 315", 1, "0", 8, "0 1 2 3 10 11 12 13"));
    is_row(g.ground, (double[]){-225, -135, -45, 45}, (float[]){1, 2, 3, 0}, 4);
    grid_free(&g);
    /* On both sides of the seam, with nothing between. */
    g = parse(EARTH(3, "-180 0 180", 2, "0 1", 12, "1 1 1 1 1 1 1 1 1 1 1 1")
            EARTH(3, "170 180 190", 1, "0", 6, "0 1 2 10 11 12"));
    is_row(g.ground, (double[]){-180, -170, 0, 170, 180}, (float[]){1, 2, NAN, 0, 1}, 5);
    assert_true(fabs(grid_over_ground(&g) - 2. / 3) < 1e-9);
    grid_free(&g);
    /* A second field, whose columns are found again; another one is refused. */
    g = parse(WEST EARTH(4, "0 90 180 270", 2, "0 1", 16, "0 1 2 3 4 5 6 7 0 1 2 3 4 5 6 7"));
    assert_true(g.second[0] == 2 && g.second[1] == 3 && g.second[2] == 0 && g.second[3] == 6);
    grid_free(&g);
    assert_refused(WEST EARTH(3, "0 91 180", 2, "0 1", 12, "0 1 2 3 4 5 0 1 2 3 4 5"),
        "a second grid with other coordinates");
    /* Without degrees nothing is moved. */
    g = parse(FIRST GROUND);
    assert_true(g.ground->at[0][0] == 0 && g.ground->n[0] == 3);
    grid_free(&g);
}

static void test_truncated(void **state)
{
    (void)state;
    struct grid g;
    char err[ERR_BYTES];
    static const char text[] = HEAD AXES SCALARS "1 2 3 4 5 6 7 8 9 10 11";
    for (size_t n = 0; n < sizeof text; n++) {
        assert_int_equal(read_bytes(text, n, &g, err), -1);
        assert_true(strncmp(err, "t:", 2) == 0 && strlen(err) > 8 && !g.value);
    }
    struct buf b = binary("float", 4, true);
    size_t whole = buf_size(&b) - strlen("\nMETADATA\nINFORMATION 0\n\n");
    for (size_t n = 0; n < whole; n++) assert_int_equal(read_bytes(buf_data(&b), n, &g, err), -1);
    assert_int_equal(read_bytes(buf_data(&b), whole, &g, err), 0);
    grid_free(&g);
    buf_free(&b);
}

/* ---- writing, and values ------------------------------------------------------------------- */

static void test_round_trip(void **state)
{
    (void)state;
    struct grid g = parse(HEAD "DIMENSIONS 2 3 2\nX_COORDINATES 2 double\n0.1 1e18\n"
                               "Y_COORDINATES 3 double\n3 -1e-17 -1\n"
                               "Z_COORDINATES 2 double\n1e-18 -0\nPOINT_DATA 12\n"
                               "SCALARS relative%20humidity double\nLOOKUP_TABLE default\n"
                               "1 2 3 4 5 nan 7 8 9 10 -0 1e-40\n");
    struct buf b = {0};
    char title[400];
    memset(title, 'x', sizeof title);
    title[3] = '\n';
    title[sizeof title - 1] = '\0';
    grid_write(&g, title, &b);
    struct grid again = parse_n(buf_data(&b), buf_size(&b));
    assert_memory_equal(g.n, again.n, sizeof g.n);
    for (int a = 0; a < 3; a++) assert_memory_equal(g.at[a], again.at[a], g.n[a] * sizeof *g.at[a]);
    assert_memory_equal(g.value, again.value, 12 * sizeof *g.value);
    assert_string_equal(again.name, "relative humidity");
    assert_int_equal(strlen(again.title), GRID_TITLE - 1);
    assert_int_equal(strspn(again.title, "x"), 3);
    assert_string_equal(g.title, "title");
    struct buf twice = {0};
    grid_write(&again, title, &twice);
    assert_int_equal(buf_size(&b), buf_size(&twice));
    assert_memory_equal(buf_data(&b), buf_data(&twice), buf_size(&b));
    buf_free(&b);
    buf_free(&twice);
    grid_free(&g);
    grid_free(&again);
}

static double at(const struct grid *g, double x, double y, double z)
{
    return grid_at(g, (const double[]){x, y, z});
}

static void test_values(void **state)
{
    (void)state;
    struct grid g = parse(HEAD AXES SCALARS VALUES);
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t j = 0; j < 2; j++)
            for (uint32_t i = 0; i < 2; i++)
                assert_true(at(&g, g.at[0][i], g.at[1][j], g.at[2][k]) == 1 + i + 2 * j + 4 * k);
    assert_true(at(&g, .25, 10.5, -.5) == 1 + .25 + .5 + 2);
    assert_true(at(&g, .5, 11, 1) == 1 + .5 + 1 + 5);
    assert_true(isnan(at(&g, -1e-9, 11, 0)) && isnan(at(&g, .5, 12.001, 0)));
    assert_true(isnan(at(&g, .5, 11, 4.001)) && isnan(at(&g, (double)NAN, 11, 0)));
    g.value[11] = NAN; /* the last node: the upper cell is missing, a face belongs to it */
    assert_true(isnan(at(&g, 0, 10, 0)) && !isnan(at(&g, 1, 12, -1e-9)));
    grid_free(&g);
}

/* Bytes that are given back while they are read make the same grid, and the same message. */
static void test_consume(void **state)
{
    (void)state;
    enum { N = 300 };
    struct buf b = {0};
    buf_printf(&b,
        "# vtk DataFile Version 3.0\n\nBINARY\nDATASET RECTILINEAR_GRID\n"
        "DIMENSIONS %d %d 2\n",
        N, N);
    for (int a = 0; a < 3; a++) {
        int n = a == 2 ? 2 : N;
        buf_printf(&b, "%c_COORDINATES %d short\n", "XYZ"[a], n);
        for (int i = 0; i < n; i++) put(&b, (uint64_t)i, 2);
        buf_printf(&b, "\n");
    }
    buf_printf(&b, "POINT_DATA %d\nSCALARS s float\nLOOKUP_TABLE default\n", 2 * N * N);
    for (int i = 0; i < 2 * N * N; i++) put_real(&b, i, 4);
    struct grid g = parse_n(buf_data(&b), buf_size(&b)), other;
    char err[ERR_BYTES], again[ERR_BYTES];
    buf_printf(&b, "\nx");
    assert_int_equal(read_bytes(buf_data(&b), buf_size(&b), &other, err), -1);
    struct buf copy = {0};
    buf_append(&copy, buf_data(&b), buf_size(&b));
    assert_int_equal(grid_consume("t", copy.data, copy.len, &other, again), -1);
    assert_string_equal(err, again);
    assert_int_equal(grid_consume("t", b.data, b.len - 2, &other, err), 0);
    assert_memory_equal(g.value, other.value, 2 * N * N * sizeof *g.value);
    grid_free(&g);
    grid_free(&other);
    buf_free(&b);
    buf_free(&copy);
}

/* Big-endian sizes and values; then the mask, in which only node 0 of layer 1 has a whole cell. */
static void test_df3(void **state)
{
    (void)state;
    static const unsigned char expected[] = {0, 2, 0, 2, 0, 6, /* */
        0, 0, 0, 0, 0, 0, 0, 0, 0x2e, 0x8b, 0xa2, 0xe9, 0x45, 0xd1, 0x74, 0x5d};
    struct grid g = parse(HEAD AXES SCALARS "1 nan 3 4 5 6 7 8 9 10 11 12\n");
    struct buf b = {0};
    grid_df3(&g, 1, 12, true, &b);
    const unsigned char *p = buf_data(&b);
    assert_int_equal(buf_size(&b), 6 + 4 * 24);
    assert_memory_equal(p, expected, sizeof expected);
    for (size_t i = 0; i < 12; i++)
        for (size_t k = 0; k < 4; k++) assert_int_equal(p[6 + 4 * (12 + i) + k], i == 4 ? 255 : 0);
    buf_free(&b);
    grid_df3(&g, 1, 12, false, &b);
    assert_int_equal(buf_size(&b), 6 + 4 * 12);
    p = buf_data(&b);
    assert_int_equal(p[5], 3);
    assert_int_equal(p[6 + 4 * 11], 255);
    buf_free(&b);
    grid_free(&g);
}

static void test_axis(void **state)
{
    (void)state;
    static const double up[] = {-1, 0, 1e-18, 5}, down[] = {5, 4, 3, 3.5}, flat[] = {1, 1};
    assert_int_equal(grid_axis_fault(up, 4), 0);
    assert_int_equal(grid_axis_fault(down, 3), 0);
    assert_int_equal(grid_axis_fault(down, 4), 3);
    assert_int_equal(grid_axis_fault(flat, 2), 1);
    assert_int_equal(grid_axis_fault((const double[]){0, (double)NAN, 1}, 3), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ascii),
        cmocka_unit_test(test_descending),
        cmocka_unit_test(test_binary),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_further),
        cmocka_unit_test(test_flat),
        cmocka_unit_test(test_turned),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_values),
        cmocka_unit_test(test_df3),
        cmocka_unit_test(test_axis),
        cmocka_unit_test(test_consume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
