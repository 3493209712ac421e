/* Archives: what is packed comes out again, the same bytes always; and hostile ones are refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "files/files.h"
#include "scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static char directory[SCRATCH_BYTES]; /* the current one, with in/ and out/ */

static int make_directory(void **state)
{
    (void)state;
    return !scratch_make(directory) || chdir(directory) != 0 || mkdir("in", 0700) != 0 ||
           mkdir("in/sub", 0700) != 0 || mkdir("out", 0700) != 0;
}

static void remove_all(const char *path)
{
    char command[SCRATCH_BYTES + 16];
    snprintf(command, sizeof command, "rm -rf %s", path);
    assert_int_equal(system(command), 0);
}

static int remove_directory(void **state)
{
    (void)state;
    remove_all(directory);
    return chdir("/");
}

static void write_file(const char *path, const char *text)
{
    unlink(path); /* what was read is not replaced */
    assert_int_equal(outfile_put(path, text, strlen(text)), 0);
}

static void assert_file(const char *path, const char *text)
{
    struct buf b = {0};
    assert_int_equal(read_file(path, &b), 0);
    assert_int_equal(buf_size(&b), strlen(text));
    assert_memory_equal(buf_data(&b), text, strlen(text));
    buf_free(&b);
}

/* For the user alone, and what is executable stays so. */
static void assert_mode(const char *path, mode_t mode)
{
    struct stat st;
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 07777, mode);
}

/* ---- packing -------------------------------------------------------------------------------- */

static void comes_out_again(void **state)
{
    (void)state;
    char scene[] = "./in/scene.pov", included[] = "in//sub/a b.inc", empty[] = "in/empty";
    char twice[] = "in/./sub/a b.inc";
    char *names[] = {scene, included, empty, twice}, *first, err[ERR_BYTES];
    struct buf a = {0}, again = {0};
    write_file("in/scene.pov", "scene");
    write_file("in/sub/a b.inc", "included\n");
    write_file("in/empty", "");
    assert_int_equal(chmod("in/sub/a b.inc", 0744), 0);
    assert_true(files_pack(names, 4, &a, err));
    assert_int_equal(chmod("in/empty", 0640), 0);
    assert_int_equal(utimensat(AT_FDCWD, "in/empty", (struct timespec[2]){{0}}, 0), 0);
    assert_true(files_pack(names, 4, &again, err));
    assert_int_equal(buf_size(&a), buf_size(&again));
    assert_memory_equal(buf_data(&a), buf_data(&again), buf_size(&a));
    assert_true(files_unpack(buf_data(&a), buf_size(&a), "out", &first, err));
    assert_string_equal(first, "scene.pov");
    assert_file("out/scene.pov", "scene");
    assert_file("out/sub/a b.inc", "included\n");
    assert_file("out/empty", "");
    assert_mode("out/scene.pov", 0600);
    assert_mode("out/sub/a b.inc", 0700);
    assert_mode("out/sub", 0700);
    free(first);
    /* A second time the files are there: nothing is written over them. */
    assert_false(files_unpack(buf_data(&a), buf_size(&a), "out", &first, err));
    assert_non_null(strstr(err, strerror(EEXIST)));
    assert_null(first);
    buf_free(&a);
    buf_free(&again);
}

/* Files that are not packed together; second NULL: one file. */
static void refused(const char *one, const char *second, const char *why)
{
    char *names[] = {xstrdup(one), second ? xstrdup(second) : NULL};
    struct buf a = {0};
    char err[ERR_BYTES];
    assert_false(files_pack(names, second ? 2 : 1, &a, err));
    if (!strstr(err, why)) print_error("%s, expected %s\n", err, why);
    assert_non_null(strstr(err, why));
    buf_free(&a);
    free(names[0]);
    free(names[1]);
}

static void refuses_to_pack(void **state)
{
    (void)state;
    char outside[SCRATCH_BYTES + 16];
    snprintf(outside, sizeof outside, "%s/in/scene", directory);
    write_file("in/scene", "");
    write_file("beside", "");
    refused("in/scene", "beside", "beside: expected a file below in/");
    refused("in/scene", "in/../beside", "in/../beside: expected a file below in/");
    refused("in/scene", outside, "expected a file below in/");
    refused("beside", outside, "expected a file below ./");
    refused("in/none", NULL, "in/none: No such file");
    refused("in", NULL, "in: is no regular file");
    refused("in/", NULL, "in/: ");
    refused("/dev/null", NULL, "/dev/null: is no regular file");
    refused("", NULL, "expected a file below");
}

/* ---- unpacking ------------------------------------------------------------------------------ */

static const char *mode = "0000644"; /* of the next entries */

/* Appends an entry as tar(5) describes the ustar format. A sparse one, 'S', has `size` bytes, and a
 * hole in front of the last one that makes it `real` long. */
static void put_real(struct buf *b, const char *name, char type, const char *link, size_t size,
    const char *text, unsigned long real)
{
    unsigned char header[512] = {0};
    char field[64];
    unsigned sum = 0;
    memcpy(header, name, strlen(name));
    memcpy(header + 100, mode, 8);
    memcpy(header + 108, "0000000\0000000000", 16);
    snprintf(field, sizeof field, "%011zo", size);
    memcpy(header + 124, field, 12);
    memcpy(header + 136, "00000000000", 12);
    memset(header + 148, ' ', 8);
    header[156] = (unsigned char)type;
    memcpy(header + 157, link, strlen(link));
    memcpy(header + 257, type == 'S' ? "ustar  \0" : "ustar\00000", 8);
    if (type == 'S') {
        snprintf(field, sizeof field, "%011lo %011o ", real - 1, 1);
        memcpy(header + 386, field, 24);
        snprintf(field, sizeof field, "%011lo", real);
        memcpy(header + 483, field, 12);
    }
    for (int i = 0; i < 512; i++) sum += header[i];
    snprintf(field, sizeof field, "%06o", sum);
    memcpy(header + 148, field, 7);
    buf_append(b, header, sizeof header);
    size_t n = strlen(text), padded = (n + 511) / 512 * 512;
    buf_append(b, text, n);
    for (; n < padded; n++) buf_append(b, "", 1);
}

static void put_entry(
    struct buf *b, const char *name, char type, const char *link, size_t size, const char *text)
{
    put_real(b, name, type, link, size, text, size);
}

static void put_end(struct buf *b)
{
    static const unsigned char zeros[1024];
    buf_append(b, zeros, sizeof zeros);
}

/* An archive of this entry, behind a good one, is refused. */
static void hostile(
    const char *name, char type, const char *link, size_t size, const char *text, const char *why)
{
    struct buf b = {0};
    char err[ERR_BYTES], *first;
    put_entry(&b, "good", '0', "", 2, "ok");
    put_entry(&b, name, type, link, size, text);
    put_end(&b);
    remove_all("out");
    assert_int_equal(mkdir("out", 0700), 0);
    assert_false(files_unpack(buf_data(&b), buf_size(&b), "out", &first, err));
    if (!strstr(err, why)) print_error("%s %c: %s, expected %s\n", name, type, err, why);
    assert_non_null(strstr(err, why));
    assert_null(first);
    buf_free(&b);
}

static void refuses_to_unpack(void **state)
{
    (void)state;
    hostile("/etc/x", '0', "", 1, "x", "below its directory");
    hostile("../x", '0', "", 1, "x", "below its directory");
    hostile("a/../../x", '0', "", 1, "x", "below its directory");
    hostile("a/..", '0', "", 1, "x", "below its directory");
    hostile("./x", '0', "", 1, "x", "below its directory");
    hostile("a//x", '0', "", 1, "x", "below its directory");
    hostile("escape\033[2J", '0', "", 1, "x", "no control characters");
    hostile("line\n", '0', "", 1, "x", "no control characters");
    hostile("link", '2', "/etc/passwd", 0, "", "no regular file");
    hostile("link", '1', "good", 0, "", "no regular file");
    hostile("link", '1', "good", 1, "x", "no regular file");
    hostile("device", '3', "", 0, "", "no regular file");
    hostile("device", '4', "", 0, "", "no regular file");
    hostile("pipe", '6', "", 0, "", "no regular file");
    hostile("directory/", '5', "", 0, "", "below its directory");
    hostile("directory", '5', "", 0, "", "no regular file");
    hostile("good", '0', "", 1, "x", strerror(EEXIST));
    hostile("good/x", '0', "", 1, "x", strerror(ENOTDIR));
    hostile("long", '0', "", 100000, "x", "archive: ");
    /* A pax header names the next file. */
    hostile("header", 'x', "", 19, "19 path=../outside\n", "archive: ");
    assert_int_equal(access("outside", F_OK), -1);
    assert_int_equal(access("x", F_OK), -1);
}

static void refuses_other_bytes(void **state)
{
    (void)state;
    char err[ERR_BYTES], *first;
    struct buf b = {0};
    remove_all("out");
    assert_int_equal(mkdir("out", 0700), 0);
    assert_false(files_unpack((const unsigned char *)"", 0, "out", &first, err));
    assert_false(files_unpack((const unsigned char *)"no archive", 10, "out", &first, err));
    put_end(&b);
    assert_false(files_unpack(buf_data(&b), buf_size(&b), "out", &first, err));
    buf_free(&b);
    put_entry(&b, "header", 'x', "", 19, "19 path=../outside\n");
    put_entry(&b, "name", '0', "", 1, "x");
    put_end(&b);
    assert_false(files_unpack(buf_data(&b), buf_size(&b), "out", &first, err));
    assert_non_null(strstr(err, "below its directory"));
    buf_free(&b);
}

/* Unpacks what was put into b, and frees it. */
static bool unpacked(struct buf *b, char err[ERR_BYTES])
{
    char *first;
    remove_all("out");
    assert_int_equal(mkdir("out", 0700), 0);
    put_end(b);
    bool good = files_unpack(buf_data(b), buf_size(b), "out", &first, err);
    free(first);
    buf_free(b);
    return good;
}

/* Sparse files of archives of 2 to 3 KiB. Code that writes them meets a limit soon. */
static void is_no_larger_than_its_archive(void **state)
{
    (void)state;
    static const char longer[] = "archive: its files are longer than itself";
    static const char map[] = "22 GNU.sparse.major=1\n22 GNU.sparse.minor=0\n"
                              "34 GNU.sparse.realsize=8589934592\n";
    static const char where[] = "1\n8589934591\n1\n";
    char err[ERR_BYTES], data[514];
    struct buf b = {0};
    struct rlimit before, limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    limit = before;
    memset(data, ' ', sizeof data - 1);
    data[513] = '\0';
    limit.rlim_cur = 1 << 20;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    put_real(&b, "hole-in-front", 'S', "", 1, "x", 8UL << 30);
    assert_false(unpacked(&b, err));
    assert_string_equal(err, longer);
    put_entry(&b, "header", 'x', "", strlen(map), map);
    memcpy(data, where, sizeof where - 1);
    put_entry(&b, "described-by-pax", '0', "", 513, data);
    assert_false(unpacked(&b, err));
    assert_string_equal(err, longer);
    /* Each is shorter than the archive, both are longer. */
    put_real(&b, "one", 'S', "", 1, "x", 2000);
    put_real(&b, "two", 'S', "", 1, "x", 2000);
    assert_false(unpacked(&b, err));
    assert_string_equal(err, longer);
    put_real(&b, "one", 'S', "", 1, "x", 1500);
    put_real(&b, "two", 'S', "", 1, "x", 1500);
    assert_true(unpacked(&b, err));
    signal(SIGXFSZ, handler);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
}

/* Whatever bits an archive states: the user's alone. */
static void gives_no_other_rights(void **state)
{
    (void)state;
    char err[ERR_BYTES];
    struct buf b = {0};
    mode = "0006777";
    put_entry(&b, "runs", '0', "", 1, "x");
    mode = "0006666";
    put_entry(&b, "sub/plain", '0', "", 1, "x");
    mode = "0000644";
    assert_true(unpacked(&b, err));
    assert_mode("out/runs", 0700);
    assert_mode("out/sub/plain", 0600);
    assert_mode("out/sub", 0700);
}

static void names_have_limits(void **state)
{
    (void)state;
    char err[ERR_BYTES], name[1026];
    memset(name, 'n', sizeof name);
    name[1024] = '\0';
    assert_true(files_name_check(name, err));
    assert_true(files_name_check("...", err) && files_name_check(".a/..b/c..", err));
    name[1024] = 'n', name[1025] = '\0';
    assert_false(files_name_check(name, err));
    assert_non_null(strstr(err, "1025 bytes, expected 1 to 1024"));
    static const char *const bad[] = {"", ".", "..", "/", "a/", "a/.", "\177", "\037", "a\tb"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(files_name_check(bad[i], err));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(comes_out_again),
        cmocka_unit_test(refuses_to_pack),
        cmocka_unit_test(refuses_to_unpack),
        cmocka_unit_test(refuses_other_bytes),
        cmocka_unit_test(is_no_larger_than_its_archive),
        cmocka_unit_test(gives_no_other_rights),
        cmocka_unit_test(names_have_limits),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
