/* Archives: what is packed comes out again, the same bytes always; and hostile ones are refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "files/files.h"

#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

static char directory[64]; /* the current one, with in/ and out/ */

static int make_directory(void **state)
{
    (void)state;
    snprintf(directory, sizeof directory, "/tmp/test_files.XXXXXX");
    return !mkdtemp(directory) || chdir(directory) != 0 || mkdir("in", 0700) != 0 ||
           mkdir("in/sub", 0700) != 0 || mkdir("out", 0700) != 0;
}

static void remove_all(const char *path)
{
    char command[128];
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
    assert_true(files_pack(names, 4, &a, err));
    assert_int_equal(chmod("in/empty", 0640), 0);
    sleep(1); /* another time of change */
    write_file("in/scene.pov", "scene");
    assert_true(files_pack(names, 4, &again, err));
    assert_int_equal(buf_size(&a), buf_size(&again));
    assert_memory_equal(buf_data(&a), buf_data(&again), buf_size(&a));
    assert_true(files_unpack(buf_data(&a), buf_size(&a), "out", &first, err));
    assert_string_equal(first, "scene.pov");
    assert_file("out/scene.pov", "scene");
    assert_file("out/sub/a b.inc", "included\n");
    assert_file("out/empty", "");
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
    char outside[128];
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

/* Appends an entry as tar(5) describes the ustar format. */
static void put_entry(
    struct buf *b, const char *name, char type, const char *link, size_t size, const char *text)
{
    unsigned char header[512] = {0};
    char field[13];
    unsigned sum = 0;
    memcpy(header, name, strlen(name));
    memcpy(header + 100, "0000644\0000000000\0000000000", 24);
    snprintf(field, sizeof field, "%011zo", size);
    memcpy(header + 124, field, 12);
    memcpy(header + 136, "00000000000", 12);
    memset(header + 148, ' ', 8);
    header[156] = (unsigned char)type;
    memcpy(header + 157, link, strlen(link));
    memcpy(header + 257, "ustar\00000", 8);
    for (int i = 0; i < 512; i++) sum += header[i];
    snprintf(field, sizeof field, "%06o", sum);
    memcpy(header + 148, field, 7);
    buf_append(b, header, sizeof header);
    size_t n = strlen(text), padded = (n + 511) / 512 * 512;
    buf_append(b, text, n);
    for (; n < padded; n++) buf_append(b, "", 1);
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
    /* A sparse file of 8 GiB in an archive of 2 KiB. */
    static const char map[] = "22 GNU.sparse.major=1\n22 GNU.sparse.minor=0\n"
                              "33 GNU.sparse.realsize=8589934592\n";
    put_entry(&b, "header", 'x', "", strlen(map), map);
    put_entry(&b, "sparse", '0', "", 512, "0\n");
    put_end(&b);
    assert_false(files_unpack(buf_data(&b), buf_size(&b), "out", &first, err));
    buf_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(comes_out_again),
        cmocka_unit_test(refuses_to_pack),
        cmocka_unit_test(refuses_to_unpack),
        cmocka_unit_test(refuses_other_bytes),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
