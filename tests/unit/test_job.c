/* What files mean: kinds by their first bytes, pictures of grids and specifications, the options of
 * a worker and the frames that it prints. */
#include "job/job.h"
#include "spec/spec.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

#include "scratch.h"

#define GRID                                                                                       \
    "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 2\n"       \
    "X_COORDINATES 2 float\n0 1\nY_COORDINATES 2 float\n0 1\nZ_COORDINATES 2 float\n0 1\n"         \
    "POINT_DATA 8\nSCALARS s float 1\nLOOKUP_TABLE default\n3 2 2 1 1 0 0 0\n"
#define BYTES(s) (const unsigned char *)(s), sizeof(s) - 1

/* ---- kinds ---------------------------------------------------------------------------------- */

static void test_kinds(void **state)
{
    (void)state;
    static const struct {
        const unsigned char *bytes;
        size_t n;
        const char *is, *by;
    } of[] = {
        {BYTES("CDF\1\0\0\0\0"), "a NetCDF file", "nc2vtk"},
        {BYTES("CDF\2"), "a NetCDF file", "nc2vtk"},
        {BYTES("CDF\5"), "a NetCDF file", "nc2vtk"},
        {BYTES("\211HDF\r\n\032\n\0"), "an HDF5 file", "nc2vtk"},
        {BYTES("GRIB\0\0\0\2"), "a GRIB file", "grib2vtk"},
        {BYTES("<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">"), "a VTK XML file",
            "vol2vtk"},
        {BYTES("<VTKFile type=\"RectilinearGrid\">"), "a VTK XML file", "vol2vtk"},
        {BYTES("\357\273\277<?xml?><COLLADA>"), "a Collada scene", "mesh2nff"},
        {BYTES("<svg>"), "an XML file", "no program"},
        {BYTES("NRRD0004\ntype: float\n"), "a NRRD volume", "vol2vtk"},
        {BYTES("ObjectType = Image\nNDims = 3\n"), "a MetaImage volume", "vol2vtk"},
        {BYTES("NDims = 3\n"), "a MetaImage volume", "vol2vtk"},
        {BYTES("\134\1\0\0rest"), "a NIfTI volume", "vol2vtk"},
        {BYTES("\0\0\1\134rest"), "a NIfTI volume", "vol2vtk"},
        {BYTES("\211PNG\r\n\032\n\0\0"), "a PNG picture", "blend"},
        {BYTES("glTF\2\0\0\0"), "a glTF scene", "mesh2nff"},
        {BYTES("{\"asset\":{\"version\":\"2.0\"}}"), "a JSON file", "mesh2nff"},
        {BYTES("# made by hand\n\nmtllib x.mtl\nv 1 2 3\n"), "an OBJ mesh", "mesh2nff"},
        {BYTES("v  -1.5 2 3\nf 1 2 3\n"), "an OBJ mesh", "mesh2nff"},
        {BYTES("o cube\nv 1 2 3\n"), "an OBJ mesh", "mesh2nff"},
        {BYTES("solid cube\nfacet normal 0 0 1\n"), "an STL mesh", "mesh2nff"},
        {BYTES("ply\nformat ascii 1.0\n"), "a PLY mesh", "mesh2nff"},
        {BYTES("ply\r\n"), "a PLY mesh", "mesh2nff"},
        {BYTES("BLENDER-v300"), "a file of Blender", "export glTF"},
        {BYTES("\037\213\b\0"), "a file that gzip has packed", "vol2vtk"},
        {BYTES("\050\265\057\375\0"), "a file that zstd has packed", "unzstd"},
    };
    char err[ERR_BYTES];
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        *err = '\0';
        if (job_readable(of[i].bytes, of[i].n, of[i].n, err) || !strstr(err, of[i].is) ||
            !strstr(err, of[i].by) || !strstr(err, "expected") || strlen(err) > ERR_BYTES - 40)
            fail_msg("%zu: %s", i, err);
        assert_false(job_is_grid(of[i].bytes, of[i].n));
        /* Half of what tells is not enough, and reads nothing behind it. */
        unsigned char *one = xmalloc(1, 1);
        *one = *of[i].bytes;
        if (*one != '{' && *one != '<') assert_true(job_readable(one, 1, 1, err));
        free(one);
    }
}

static void test_own_kinds(void **state)
{
    (void)state;
    static const char *const text[] = {"", "v\nfrom 1 2 3\n", "v from 3 4 5 at 0 0 0\n",
        "# a scene\nb .1 .3 .7\nv\n", "s 0 0 0 1\n", "f .9 .2 .2 .5 .5 30 0 0\n", "from 3 2 4\n",
        "# vtk DataFile Version 3.0\n", "#VRML", "   \n\n", "v", "v ", "p 3\n"};
    char err[ERR_BYTES];
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        if (!job_readable((const unsigned char *)text[i], strlen(text[i]), strlen(text[i]), err))
            fail_msg("%s: %s", text[i], err);
    assert_true(job_is_grid(BYTES("# vtk DataFile Version 3.0")));
    assert_true(job_is_grid(BYTES("# VTK datafile")));
    assert_false(job_is_grid(BYTES("# vtk DataFil")));
    assert_false(job_is_grid(BYTES("# vtl DataFile")));
}

static void test_views(void **state)
{
    (void)state;
    static const char *const yes[] = {"from 1 2 3\n", "# key\r\n\n at\t0 0 0", "up 0", "angle\n30",
        "hither 1", "\357\273\277resolution 4 3"};
    static const char *const no[] = {"", "f", "from", "fromage 1", "v\nfrom 1 2 3\n",
        "map 1 2 3\nfrom 1 2 3", "# from 1\n", "at"};
    for (size_t i = 0; i < sizeof yes / sizeof *yes; i++)
        if (!job_is_view((const unsigned char *)yes[i], strlen(yes[i]))) fail_msg("%s", yes[i]);
    for (size_t i = 0; i < sizeof no / sizeof *no; i++)
        if (job_is_view((const unsigned char *)no[i], strlen(no[i]))) fail_msg("%s", no[i]);
    assert_false(job_is_view(BYTES("from\0")));
}

/* The header and the length of the file tell it, and text of that length is none. */
static void test_binary_stl(void **state)
{
    (void)state;
    unsigned char stl[134];
    char err[ERR_BYTES];
    memset(stl, ' ', sizeof stl);
    memcpy(stl + 80, "\1\0\0\0", 4);
    assert_false(job_readable(stl, sizeof stl, 134, err));
    assert_non_null(strstr(err, "STL"));
    assert_true(job_readable(stl, sizeof stl, 135, err));
    assert_true(job_readable(stl, 83, 134, err));
    memset(stl + 80, ' ', 4);
    assert_true(job_readable(stl, sizeof stl, 84 + 50 * UINT64_C(0x20202020), err));
}

/* ---- files ---------------------------------------------------------------------------------- */

static char none[] = "none", dash[] = "-", odd[] = "-none", scene[] = "s.nff", other[] = "t.nff",
            a[] = "a.vtk", b[] = "b.vtk", x[] = "x.spec", y[] = "y.spec", nc[] = "d.nc",
            pov[] = "p=1.POV", blend[] = "b=1.Blend", plus[] = "+kff.pov", own[] = "/tmp/p=1.pov",
            fifo[] = "fifo";

static void save(const char *path, const char *text)
{
    assert_int_equal(outfile_put(path, text, strlen(text)), 0);
}

static char directory[SCRATCH_BYTES];

static int enter(void **state)
{
    (void)state;
    if (!scratch_make(directory) || chdir(directory) != 0) return -1;
    save(scene, "v\n");
    save(other, "v\n");
    save(a, GRID);
    save(b, GRID);
    save(x, "from 1 2 3\n");
    save(y, "# a key\r\n\nresolution 4 3\n");
    save(nc, "CDF\1");
    return mkfifo(fifo, 0600);
}

static int leave(void **state)
{
    (void)state;
    char *const made[] = {scene, other, a, b, x, y, nc, fifo};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++) unlink(made[i]);
    return chdir("/") != 0 || rmdir(directory) != 0 ? -1 : 0;
}

#define FILES(...) (char *[]){__VA_ARGS__}, sizeof((char *[]){__VA_ARGS__}) / sizeof(char *)

static void test_together(void **state)
{
    (void)state;
    struct job j;
    char err[ERR_BYTES];
    assert_true(job_of(&j, FILES(scene), err));
    assert_string_equal(job_worker(&j), "rtworker");
    assert_int_equal(job_states(&j), 1);
    assert_true(job_of(&j, FILES(dash), err) && j.what == JOB_SCENE);
    assert_true(job_of(&j, FILES(none), err) && j.what == JOB_SCENE); /* the worker says so */
    assert_true(job_of(&j, FILES(a), err) && j.starter && j.subjects == 1);
    assert_string_equal(job_worker(&j), "vcworker");
    assert_int_equal(job_states(&j), 1);
    assert_true(job_of(&j, FILES(a, b, x), err) && j.subjects == 2 && !j.starter);
    assert_int_equal(job_states(&j), 2);
    assert_true(job_of(&j, FILES(a, x, b), err) && j.subjects == 1); /* b is no specification */
    assert_false(job_of(&j, FILES(scene, other), err));
    assert_non_null(strstr(err, "expected a view or a specification: the lines behind `v`"));
    assert_true(job_of(&j, FILES(scene, x), err) && j.subjects == 1 && j.what == JOB_SCENE);
    assert_true(job_of(&j, FILES(scene, other, x, y, a), err) && j.what == JOB_SCENE);
    assert_int_equal(job_states(&j), 6);
    assert_true(job_of(&j, FILES(plus, x), err) && j.what == JOB_POV);
    assert_string_equal(j.path[0], "./+kff.pov");
    assert_string_equal(job_worker(&j), "povworker");
    assert_int_equal(job_states(&j), 1);
    free(j.path[0]);
    assert_true(job_of(&j, FILES(pov), err));
    assert_string_equal(j.path[0], "./p=1.POV");
    free(j.path[0]);
    assert_true(job_of(&j, FILES(blend, x), err) && j.what == JOB_BLEND && job_foreign(&j));
    assert_string_equal(j.path[0], "./b=1.Blend");
    assert_string_equal(job_worker(&j), "blendworker");
    assert_int_equal(job_states(&j), 1);
    free(j.path[0]);
    assert_true(job_of(&j, FILES(own), err));
    assert_ptr_equal(j.path[0], own);
}

static void test_refused(void **state)
{
    (void)state;
    struct job j;
    char err[ERR_BYTES];
    assert_false(job_of(&j, FILES(a, b), err));
    assert_string_equal(err, "b.vtk: is a grid, expected a specification after the grids");
    static const char *const lone =
        "x.spec: is a view or a specification, expected a scene or a grid before it";
    assert_false(job_of(&j, FILES(x), err));
    assert_string_equal(err, lone);
    assert_false(job_of(&j, FILES(x, scene, y), err));
    assert_string_equal(err, lone);
    assert_false(job_of(&j, FILES(scene, dash), err));
    assert_string_equal(err, "-: is one of 2 files, expected it alone");
    assert_false(job_of(&j, FILES(odd), err));
    assert_string_equal(err, "-none: no such file; options are before the files");
    assert_false(job_of(&j, FILES(fifo), err));
    assert_non_null(strstr(err, "fifo: is a pipe"));
    assert_false(job_of(&j, FILES(a, nc), err));
    assert_non_null(strstr(err, "d.nc: is a NetCDF file"));
}

/* Each scene or grid with each view or specification; only what changed is new. */
static void test_states(void **state)
{
    (void)state;
    const struct job two = {.what = JOB_SCENE, .n = 4, .subjects = 2};
    static const struct job_state of[] = {
        {0, 2, true, true}, {0, 3, false, true}, {1, 2, true, true}, {1, 3, false, true}};
    assert_int_equal(job_states(&two), 4);
    for (size_t i = 0; i < 4; i++) {
        struct job_state s = job_state(&two, i);
        assert_true(s.subject == of[i].subject && s.look == of[i].look &&
                    s.new_subject == of[i].new_subject && s.new_look == of[i].new_look);
    }
    const struct job film = {.what = JOB_GRIDS, .n = 4, .subjects = 3};
    for (size_t i = 0; i < 3; i++) {
        struct job_state s = job_state(&film, i);
        assert_true(s.subject == i && s.look == 3 && s.new_subject && s.new_look == (i == 0));
    }
    struct job alone = {.what = JOB_GRIDS, .n = 1, .subjects = 1, .starter = true};
    assert_int_equal(job_states(&alone), 1);
    assert_true(job_state(&alone, 0).look == 1 && job_state(&alone, 0).new_look);
    alone = (struct job){.what = JOB_SCENE, .n = 1, .subjects = 1};
    assert_int_equal(job_states(&alone), 1);
    assert_true(job_state(&alone, 0).new_subject && !job_state(&alone, 0).new_look);
}

static struct spec starter(uint32_t w, uint32_t h)
{
    struct buf text = {0};
    struct spec s = {0};
    char err[ERR_BYTES];
    buf_append(&text, "# before\n", 9);
    if (!job_starter(a, w, h, &text, err) ||
        spec_read("starter", (const char *)text.data, text.len, &s, err) != 0)
        fail_msg("%s", err);
    buf_free(&text);
    return s;
}

static void test_starter(void **state)
{
    (void)state;
    struct buf none_yet = {0};
    char err[ERR_BYTES];
    struct spec s = starter(0, 0), small = starter(90, 60);
    assert_true(s.w == 1200 && s.h == 800 && s.backed);
    assert_true(small.w == 90 && small.h == 60);
    assert_int_equal(s.n_knots, small.n_knots);
    spec_free(&s);
    spec_free(&small);
    assert_false(job_starter(x, 0, 0, &none_yet, err));
    assert_non_null(strstr(err, "x.spec:1: "));
}

/* ---- the worker ----------------------------------------------------------------------------- */

static void test_words(void **state)
{
    (void)state;
    static const char *const of[] = {"", " ", "-a 16", " -d\t8  -f 250 ", "a"};
    static const size_t want[] = {0, 0, 2, 4, 1};
    size_t n;
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        char **words = job_words(of[i], &n);
        assert_int_equal(n, want[i]);
        assert_null(words[n]);
        if (n == 4) assert_string_equal(words[3], "250");
        free(words);
    }
}

static const char *checked(enum job_what what, const char *options)
{
    static char err[ERR_BYTES];
    size_t n;
    const struct job j = {.what = what};
    char **words = job_words(options, &n);
    bool good = job_words_check(&j, options, words, err);
    free(words);
    return good ? NULL : err;
}

static void test_options(void **state)
{
    (void)state;
    assert_null(checked(JOB_SCENE, "-a 16:.1 -d 8 foo"));
    assert_string_equal(
        checked(JOB_SCENE, "-d 3 -s 8x8"), "-d 3 -s 8x8: expected the size with -s before -W");
    assert_string_equal(checked(JOB_GRIDS, "-j3"), "-j3: expected the slots with -j before -W");
    assert_null(checked(JOB_POV, "-w -cf 250 +A0.3 Quality=9"));
    assert_string_equal(checked(JOB_POV, "+A0.3 x.ini"),
        "x.ini: expected options of povworker, +WORD or NAME=VALUE");
    assert_non_null(checked(JOB_POV, "-w 250"));
    assert_null(checked(JOB_BLEND, "-w frames=all samples=16"));
    assert_string_equal(
        checked(JOB_BLEND, "x.py"), "x.py: expected options of blendworker or NAME=VALUE");
}

static void test_frames(void **state)
{
    (void)state;
    struct job_frames f = {.n = 0};
    static const char *const taken[] = {"frame 60 40", "job=ab", "frame 6 4 9", "job=cd"};
    static const char *const not [] = {"job=ab", "frame 6", "frame 6 4 9 8", "frame 0 4",
        "frame 6 x", "frames 6 4", "rtworker: frame 6 4"};
    for (size_t i = 0; i < sizeof not / sizeof *not ; i++)
        assert_false(job_frames_take(&f, not [i]));
    for (size_t i = 0; i < 4; i++) assert_true(job_frames_take(&f, taken[i]));
    assert_false(job_frames_take(&f, "job=ef")); /* of no frame */
    assert_int_equal(f.n, 2);
    buf_append(&f.text, "", 1);
    assert_string_equal((char *)f.text.data, "frame 0 60 40 job=ab\nframe 9 6 4 job=cd\n");
    buf_free(&f.text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),
        cmocka_unit_test(test_own_kinds),
        cmocka_unit_test(test_views),
        cmocka_unit_test(test_binary_stl),
        cmocka_unit_test(test_together),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_states),
        cmocka_unit_test(test_starter),
        cmocka_unit_test(test_words),
        cmocka_unit_test(test_options),
        cmocka_unit_test(test_frames),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
