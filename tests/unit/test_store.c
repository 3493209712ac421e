/*
 * Frames that keep their pixels in a file. The pixels come back whole in whatever order they came,
 * also when few pages fit into memory; a full disk is reported; no file is left behind.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include "image/image.h"
#include "scratch.h"

#define ROOM (UINT64_C(1) << 30)
#define W 301
#define H 101
#define PIXELS ((uint64_t)W * H) /* 15 pages */

static char dir[SCRATCH_BYTES];

static float shade(uint64_t p, int c) { return c == 3 ? 1 : (float)p + (float)c / 4; }

/* An assembly with one frame, which has `pages` pages in memory. */
static struct assembly_frame *begin(struct assembly *a, uint32_t pages)
{
    assembly_init(a, true, ROOM);
    a->spill = (struct assembly_spill){.dir = dir, .above_px = PIXELS - 1, .pages = pages};
    assert_int_equal(assembly_declare(a, 0, W, H, "j"), ASSEMBLY_TAKEN);
    return assembly_find(a, 0);
}

static enum assembly_verdict put(
    struct assembly *a, uint16_t source, const struct lattice *at, float off)
{
    static float rgba[4 * PIXELS];
    for (uint64_t i = 0, n = lattice_count(at); i < n; i++)
        for (int c = 0; c < 4; c++)
            rgba[4 * i + (uint64_t)c] = shade(lattice_pixel(at, W, i), c) + (c == 0 ? off : 0);
    return assembly_commit(a, 0, "j", source, at, rgba);
}

/* All tasks of a cut, the ids in steps. */
static void put_all(struct assembly *a, const char *name, uint32_t step, uint16_t source, float off)
{
    struct cut cut;
    assert_true(cut_parse(name, &cut));
    if (cut.unit == CUT_SCATTER) cut.w = 7;
    uint32_t n = cut_count(&cut, W, H);
    for (uint32_t first = 0; first < step; first++)
        for (uint32_t id = first; id < n; id += step) {
            struct task t = cut_task(&cut, W, H, id);
            assert_int_equal(put(a, source, &t.at, off), ASSEMBLY_TAKEN);
        }
}

static void check_rows(const struct assembly_frame *f)
{
    const struct image_rows rows = assembly_rows(f);
    for (uint32_t k = 0; k < H; k++) {
        uint32_t y = k % 2 ? k : H - 1 - k; /* H is odd: each row once */
        const float *row = rows.row(&rows, y);
        assert_non_null(row);
        for (uint32_t i = 0; i < 4 * W; i++) {
            uint64_t p = (uint64_t)y * W + i / 4;
            float want = coverage_has(&f->have, p) ? shade(p, (int)(i % 4)) : 0;
            assert_true(row[i] == want);
        }
    }
}

static const char *const cuts[] = {"row", "tile:17x33", "run:1000", "run:4001", "scatter"};

static void test_any_cut_any_order(void **state)
{
    (void)state;
    for (uint32_t pages = 1; pages <= 16; pages += 5)
        for (int k = 0; k < 5; k++) {
            struct assembly a;
            struct assembly_frame *f = begin(&a, pages);
            put_all(&a, cuts[k], 13, 1, 0);
            assert_true(assembly_whole(&a));
            assert_true(assembly_rows(f).opaque);
            check_rows(f);
            put_all(&a, cuts[4 - k], 5, 2, 0);
            assert_int_equal(f->again, PIXELS);
            assert_int_equal(a.differing, 0);
            check_rows(f);
            assembly_free(&a);
        }
}

/* Each pixel is compared with the first, and both sources are named, also of pages in the file. */
static void test_differences(void **state)
{
    (void)state;
    for (int k = 0; k < 5; k++) {
        struct assembly a;
        struct assembly_frame *f = begin(&a, 2);
        const struct lattice upper = {0, 0, W, 50, 1, 1}, lower = {0, 50, W, H - 50, 1, 1};
        put(&a, 4, &lower, 0);
        put(&a, 3, &upper, 0);
        put_all(&a, cuts[k], 13, 9, 0.5f);
        assert_int_equal(a.differing, PIXELS);
        assert_int_equal(a.n_disputes, 2);
        for (int i = 0; i < 2; i++) {
            const struct assembly_dispute *d = &a.disputes[i];
            assert_true(d->first == 3 || d->first == 4);
            assert_int_equal(d->second, 9);
            assert_int_equal(d->pixels, d->first == 3 ? 50 * W : (H - 50) * W);
        }
        assert_int_not_equal(a.disputes[0].first, a.disputes[1].first);
        check_rows(f); /* the first ones stand */
        assembly_free(&a);
    }
}

/* A page that is in no file yet is transparent, whatever its place in memory held before. */
static void test_missing_is_transparent(void **state)
{
    (void)state;
    struct assembly a;
    struct assembly_frame *f = begin(&a, 2);
    const struct lattice last = {W - 1, H - 1, 1, 1, 1, 1}, top = {0, 0, W, 40, 1, 1};
    put(&a, 1, &top, 0);
    check_rows(f);
    put(&a, 1, &last, 0);
    check_rows(f);
    assert_false(assembly_rows(f).opaque);
    check_rows(f);
    assembly_free(&a);
}

/* The second row of a lattice may begin before the end of the first, in another page. */
static void test_back_and_forth(void **state)
{
    (void)state;
    struct assembly a;
    struct assembly_frame *f = begin(&a, 1);
    const struct lattice far = {0, 0, 100, 3, 200, 1};
    assert_int_equal(put(&a, 1, &far, 0), ASSEMBLY_TAKEN);
    assert_int_equal(f->have.done, 300);
    check_rows(f);
    assembly_free(&a);
}

static void test_opaque(void **state)
{
    (void)state;
    struct assembly a;
    struct assembly_frame *f = begin(&a, 2);
    const struct lattice first = {0, 0, 1, 1, 1, 1};
    const float clear[4] = {0, 0, 0, 0.5f};
    assembly_commit(&a, 0, "j", 1, &first, clear);
    put_all(&a, "row", 1, 1, 0);
    assert_true(assembly_whole(&a));
    assert_false(assembly_rows(f).opaque);
    assembly_free(&a);
}

/* Files of this process in `dir`, of which *fd is the last. */
static int open_files(int *fd)
{
    DIR *d = opendir("/proc/self/fd");
    assert_non_null(d);
    int n = 0;
    char target[256], path[512];
    for (struct dirent *e; (e = readdir(d)) != NULL;) {
        snprintf(path, sizeof path, "/proc/self/fd/%s", e->d_name);
        ssize_t k = readlink(path, target, sizeof target - 1);
        if (k < 0) continue;
        target[k] = '\0';
        if (strncmp(target, dir, strlen(dir)) != 0) continue;
        n++;
        *fd = (int)strtol(e->d_name, NULL, 10);
    }
    closedir(d);
    return n;
}

static bool dir_empty(void)
{
    bool empty = rmdir(dir) == 0;
    if (empty) assert_true(scratch_make(dir));
    return empty;
}

/* Only large frames have a file, without a name. It is closed when the next frame is released. */
static void test_files(void **state)
{
    (void)state;
    struct assembly a;
    int fd;
    const struct lattice all = {0, 0, W, H, 1, 1}, one = {0, 0, 1, 1, 1, 1};
    struct assembly_frame *f = begin(&a, 2);
    assert_int_equal(open_files(&fd), 0);
    put(&a, 1, &all, 0);
    assert_int_equal(open_files(&fd), 1);
    assert_true(dir_empty());
    assembly_release(&a, f);
    put(&a, 1, &one, 1);
    assert_int_equal(a.differing, 1); /* still compared */
    assembly_declare(&a, 1, 1, 1, "j");
    const float rgba[4] = {0, 0, 0, 1};
    assembly_commit(&a, 1, "j", 1, &one, rgba);
    assembly_release(&a, assembly_find(&a, 1));
    assert_int_equal(open_files(&fd), 0);
    assembly_free(&a);
    begin(&a, 2);
    a.spill.above_px = PIXELS;
    put(&a, 1, &all, 0);
    assert_int_equal(open_files(&fd), 0); /* in memory */
    assembly_free(&a);
}

static void limit_files(rlim_t bytes)
{
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = bytes ? bytes : limit.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

/* A file that cannot be made, has no room, or fails later: the verdict and errno. */
static void test_failures(void **state)
{
    (void)state;
    struct assembly a;
    int fd = -1;
    const struct lattice top = {0, 0, W, 1, 1, 1}, all = {0, 0, W, H, 1, 1};
    signal(SIGXFSZ, SIG_IGN);

    begin(&a, 2);
    a.spill.dir = "/nonexistent";
    assert_int_equal(put(&a, 1, &top, 0), ASSEMBLY_FAILED);
    assert_int_equal(a.error, ENOENT);
    assert_int_equal(a.refused[ASSEMBLY_FAILED], 1);
    assembly_free(&a);

    begin(&a, 2);
    limit_files(100000); /* of 552960 */
    assert_int_equal(put(&a, 1, &top, 0), ASSEMBLY_FAILED);
    limit_files(0);
    assert_int_equal(a.error, EFBIG);
    assert_int_equal(open_files(&fd), 0);
    assert_true(dir_empty());
    assembly_free(&a);

    begin(&a, 2); /* later: a page cannot be written */
    assert_int_equal(put(&a, 1, &top, 0), ASSEMBLY_TAKEN);
    assert_int_equal(open_files(&fd), 1);
    assert_int_equal(ftruncate(fd, 0), 0);
    limit_files(10000);
    assert_int_equal(put(&a, 1, &all, 0), ASSEMBLY_FAILED);
    limit_files(0);
    assert_int_equal(a.error, EFBIG);
    assembly_free(&a);

    struct assembly_frame *f = begin(&a, 2); /* a page cannot be read */
    assert_int_equal(put(&a, 1, &all, 0), ASSEMBLY_TAKEN);
    assert_int_equal(open_files(&fd), 1);
    check_rows(f);                             /* writes all pages */
    assert_int_equal(ftruncate(fd, 40000), 0); /* a page, and part of the second */
    const struct image_rows rows = assembly_rows(f);
    assert_non_null(rows.row(&rows, 0));
    errno = 0;
    assert_null(rows.row(&rows, 10));
    assert_int_equal(errno, EIO);
    assert_int_equal(put(&a, 2, &all, 0), ASSEMBLY_FAILED);
    assert_int_equal(a.error, EIO);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_any_cut_any_order),
        cmocka_unit_test(test_differences),
        cmocka_unit_test(test_missing_is_transparent),
        cmocka_unit_test(test_back_and_forth),
        cmocka_unit_test(test_opaque),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_failures),
    };
    if (!scratch_make(dir)) return 1;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    rmdir(dir);
    return failed;
}
