/* Bricks: the arrays that make a grid one, written and read again; refusals; parts of a cut. */
#include "grid/grid.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#define HEAD "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET RECTILINEAR_GRID\n"
#define REST                                                                                       \
    "DIMENSIONS 4 2 3\nX_COORDINATES 4 float\n1 2 4 8\nY_COORDINATES 2 float\n12 10\n"             \
    "Z_COORDINATES 3 double\n-1 0 4\nPOINT_DATA 24\nSCALARS s float\nLOOKUP_TABLE d\n"             \
    "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24\n"
#define WHOLE "brick_whole 6 1 double\n0 9 10 12 -1 9\n"

static int read_text(const char *text, struct grid *g, char err[ERR_BYTES])
{
    return grid_read("t", (const unsigned char *)text, strlen(text), g, err);
}

static void test_arrays(void **state)
{
    (void)state;
    static const char text[] = HEAD "FIELD FieldData 3\n" WHOLE
                                    "TIME 1 1 int\n7\nbrick_own 6 1 float\n2 4 10 12 -1 0\n" REST;
    static const uint32_t own[3][2] = {{1, 2}, {0, 1}, {0, 1}};
    static const double whole[3][2] = {{0, 9}, {10, 12}, {-1, 9}};
    struct grid g, again;
    struct buf b = {0};
    char err[ERR_BYTES];
    if (read_text(text, &g, err) != 0) fail_msg("refused: %s", err);
    assert_true(g.brick.is);
    assert_memory_equal(g.brick.own, own, sizeof own);
    assert_memory_equal(g.brick.whole, whole, sizeof whole);
    grid_write(&g, "title", &b);
    assert_int_equal(grid_read("again", buf_data(&b), buf_size(&b), &again, err), 0);
    assert_true(again.brick.is);
    assert_memory_equal(again.brick.own, own, sizeof own);
    assert_memory_equal(again.brick.whole, whole, sizeof whole);
    assert_memory_equal(again.value, g.value, 24 * sizeof *g.value);
    buf_free(&b);
    grid_free(&g);
    grid_free(&again);
    if (read_text(HEAD REST, &g, err) != 0) fail_msg("refused: %s", err);
    assert_false(g.brick.is);
    grid_free(&g);
}

static void test_refused(void **state)
{
    (void)state;
    static const char *const bad[][2] = {
        {HEAD "FIELD FieldData 1\n" WHOLE REST, "do not fit x"},
        {HEAD "FIELD FieldData 2\n" WHOLE "brick_own 6 1 float\n2 5 10 12 -1 0\n" REST,
            "do not fit x"}, /* no plane */
        {HEAD "FIELD FieldData 2\n" WHOLE "brick_own 6 1 float\n4 2 10 12 -1 0\n" REST,
            "do not fit x"}, /* turned */
        {HEAD "FIELD FieldData 2\n" WHOLE "brick_own 6 1 float\n1 4 10 12 -1 0\n" REST,
            "do not fit x"}, /* no overlap below */
        {HEAD "FIELD FieldData 2\n" WHOLE "brick_own 6 1 float\n2 4 10 12 -1 4\n" REST,
            "do not fit z"}, /* no overlap above */
        {HEAD "FIELD FieldData 2\nbrick_whole 6 1 int\n2 9 10 12 -1 9\n"
              "brick_own 6 1 float\n2 4 10 12 -1 0\n" REST,
            "do not fit x"}, /* planes outside of the whole */
        {HEAD "FIELD FieldData 2\n" WHOLE WHOLE REST, "brick_whole: twice, expected six"},
        {HEAD "FIELD FieldData 1\nbrick_own 5 1 int\n1 2 3 4 5\n" REST, "brick_own: no bounds"},
        {HEAD "FIELD FieldData 2\n" WHOLE "brick_own 6 1 float\n2 nan 10 12 -1 0\n" REST,
            "do not fit x"},
        {HEAD "FIELD FieldData 2\n" WHOLE "brick_own 6 1 float\n2 4 10 x -1 0\n" REST,
            "t:9: brick_own is 'x', expected"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct grid g;
        char err[ERR_BYTES];
        assert_int_equal(read_text(bad[i][0], &g, err), -1);
        if (!strstr(err, bad[i][1])) fail_msg("%zu: %s, expected %s", i, err, bad[i][1]);
        assert_null(g.value);
    }
}

/* Each cell of the grid is some brick's own, once. Axes and values are those of the grid. */
static void test_cut(void **state)
{
    (void)state;
    static const uint32_t parts[3] = {3, 1, 2};
    char err[ERR_BYTES], names[6][24], *path[6];
    struct grid g;
    unsigned seen[3][1][2] = {{{0}}};
    char room[] = "/tmp/test_brick.XXXXXX";
    assert_true(mkdtemp(room) && chdir(room) == 0);
    assert_int_equal(outfile_put("brick-whole.vtk", HEAD REST, strlen(HEAD REST)), 0);
    struct grid_file *f = grid_file_open("brick-whole.vtk", err);
    assert_non_null(f);
    for (int i = 0; i < 6; i++) {
        snprintf(names[i], sizeof names[i], "brick-%d.vtk", i);
        path[i] = names[i];
    }
    assert_int_equal(grid_file_cut(f, parts, path, err), ST_OK);
    grid_file_close(f);
    assert_int_equal(read_text(HEAD REST, &g, err), 0);
    for (int i = 0; i < 6; i++) {
        struct grid b;
        if (grid_load(path[i], &b, err) != 0) fail_msg("refused: %s", err);
        assert_true(b.brick.is && b.brick.whole[0][1] == 8 && b.brick.whole[1][0] == 10);
        for (uint32_t k = 0; k < b.n[2]; k++)
            for (uint32_t j = 0; j < b.n[1]; j++)
                for (uint32_t x = 0; x < b.n[0]; x++) {
                    const double at[3] = {b.at[0][x], b.at[1][j], b.at[2][k]};
                    assert_true(grid_at(&g, at) == (double)b.value[grid_node(&b, x, j, k)]);
                }
        uint32_t cell[3];
        for (int a = 0; a < 3; a++) {
            assert_int_equal(b.brick.own[a][1] - b.brick.own[a][0], 1);
            for (cell[a] = 0; g.at[a][cell[a]] != b.at[a][b.brick.own[a][0]];) cell[a]++;
        }
        seen[cell[0]][cell[1]][cell[2]]++;
        grid_free(&b);
        remove(path[i]);
    }
    for (int i = 0; i < 6; i++) assert_int_equal(seen[i % 3][0][i / 3], 1);
    grid_free(&g);
    remove("brick-whole.vtk");
    assert_int_equal(rmdir(room), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_arrays),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
