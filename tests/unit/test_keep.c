/* Kept state: what was kept is found by its hash, and by nothing else; damage, links and other
 * users' directories are refused; what was used longest ago goes first. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "keep/keep.h"
#include "scratch.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static char directory[SCRATCH_BYTES];
static unsigned char bytes[3][KEEP_LEAST];
static char hash[3][SHA256_TEXT];

static int close_scratch(void **state)
{
    char command[SCRATCH_BYTES + 16];
    (void)state;
    snprintf(command, sizeof command, "rm -rf %s", directory);
    return *directory && (chdir("/") != 0 || system(command) != 0);
}

/* A new directory for the files of a test. */
static void begin(void)
{
    assert_int_equal(close_scratch(NULL), 0);
    assert_true(scratch_make(directory));
    assert_int_equal(chdir(directory), 0);
    setenv("XDG_CACHE_HOME", directory, 1);
    for (int i = 0; i < 3; i++) {
        for (size_t k = 0; k < KEEP_LEAST; k++)
            bytes[i][k] = (unsigned char)rng_u64((uint64_t)i, k);
        sha256(bytes[i], KEEP_LEAST, hash[i]);
    }
}

/* A path of the i-th file. */
static const char *file(int i)
{
    static char path[SCRATCH_BYTES];
    snprintf(path, sizeof path, "stormring/state/%s", hash[i]);
    return path;
}

static void keep(int i) { keep_write(bytes[i], KEEP_LEAST); }

static bool finds(int i)
{
    struct buf b = {0};
    buf_append(&b, "ab", 2);
    bool found = keep_read(hash[i], KEEP_LEAST, &b);
    assert_int_equal(buf_size(&b), 2 + (found ? KEEP_LEAST : 0));
    if (found) assert_memory_equal(buf_data(&b) + 2, bytes[i], KEEP_LEAST);
    buf_free(&b);
    return found;
}

/* The i-th file was used this number of seconds ago. */
static void used(int i, time_t s)
{
    struct timespec at[2];
    clock_gettime(CLOCK_REALTIME, &at[0]);
    at[0].tv_sec -= s;
    at[1] = at[0];
    assert_int_equal(utimensat(AT_FDCWD, file(i), at, 0), 0);
}

static void what_was_kept_is_found(void **state)
{
    (void)state;
    begin();
    struct stat st;
    char text[KEEP_LIST];
    struct buf b = {0};
    keep_list(text);
    assert_string_equal(text, "");
    assert_false(finds(0));
    assert_int_not_equal(access("stormring", F_OK), 0);
    keep(0);
    keep(1);
    assert_true(finds(0));
    assert_true(finds(1));
    assert_false(finds(2));
    assert_int_equal(stat(file(0), &st), 0);
    assert_int_equal(st.st_mode & 0777, 0600);
    assert_int_equal(stat("stormring/state", &st), 0);
    assert_int_equal(st.st_mode & 0777, 0700);
    used(1, 100);
    keep_list(text);
    assert_int_equal(strlen(text), 2 * KEEP_DIGITS + 1);
    assert_int_equal(strncmp(text, hash[0], KEEP_DIGITS), 0);
    assert_true(keep_names(text, hash[0]) && keep_names(text, hash[1]));
    assert_false(keep_names(text, hash[2]) || keep_names("", hash[0]) || keep_names(NULL, hash[0]));
    text[3] = '\0';
    assert_false(keep_names(text, hash[0]));
    assert_false(keep_read(hash[0], KEEP_LEAST - 1, &b)); /* of another length: it is removed */
    assert_false(finds(0));
    keep_write(bytes[2], KEEP_LEAST - 1);
    keep_list(text);
    assert_int_equal(strlen(text), KEEP_DIGITS);
    buf_free(&b);
}

/* A name that came over the wire leads to no other file. */
static void only_a_hash_is_a_name(void **state)
{
    (void)state;
    begin();
    struct buf b = {0};
    char upper[SHA256_TEXT];
    keep(0);
    assert_int_equal(rename(file(0), "stormring/state/x"), 0);
    assert_false(keep_read("x", KEEP_LEAST, &b));
    assert_int_equal(link("stormring/state/x", file(0)), 0);
    snprintf(upper, sizeof upper, "%s", hash[0]);
    upper[SHA256_TEXT - 2] = 'A';
    assert_false(keep_read(upper, KEEP_LEAST, &b));
    assert_false(keep_read("../state/x", KEEP_LEAST, &b));
    assert_false(keep_read("", KEEP_LEAST, &b));
    assert_int_equal(access("stormring/state/x", F_OK), 0);
    assert_true(finds(0));
    buf_free(&b);
}

static void damage_is_found(void **state)
{
    (void)state;
    begin();
    keep(0);
    int fd = open(file(0), O_WRONLY);
    const unsigned char other = bytes[0][KEEP_LEAST / 2] ^ 1;
    assert_int_equal(pwrite(fd, &other, 1, KEEP_LEAST / 2), 1);
    close(fd);
    assert_false(finds(0));
    assert_int_not_equal(access(file(0), F_OK), 0);
    keep(0);
    assert_true(finds(0));
    assert_int_equal(unlink(file(0)), 0);
    assert_int_equal(mkfifo(file(0), 0600), 0);
    assert_false(finds(0));
}

static void links_and_other_users_are_refused(void **state)
{
    (void)state;
    begin();
    struct stat st;
    keep(0);
    assert_int_equal(rename(file(0), "there"), 0);
    assert_int_equal(symlink("../../there", file(0)), 0);
    assert_false(finds(0));
    assert_int_equal(access("there", F_OK), 0);
    keep(1);
    assert_int_equal(rename("stormring/state", "stormring/other"), 0);
    assert_int_equal(symlink("other", "stormring/state"), 0);
    assert_false(finds(1));
    keep(2);
    assert_int_equal(unlink("stormring/state"), 0);
    assert_int_equal(rename("stormring/other", "stormring/state"), 0);
    assert_true(finds(1));
    assert_false(finds(2));
    assert_int_equal(chmod("stormring/state", 0755), 0);
    assert_true(finds(1));
    assert_int_equal(stat("stormring/state", &st), 0);
    assert_int_equal(st.st_mode & 0777, 0700);
    if (geteuid() != 0) return;
    assert_int_equal(chown("stormring/state", 1, 1), 0);
    assert_false(finds(1));
    assert_int_equal(chown("stormring/state", 0, 0), 0);
    assert_true(finds(1));
}

/* A large file without contents takes no room here. */
static void what_was_used_longest_ago_goes(void **state)
{
    (void)state;
    begin();
    char large[SCRATCH_BYTES];
    keep(0);
    keep(1);
    snprintf(large, sizeof large, "stormring/state/%.63s0", hash[2]);
    if (strcmp(large, file(2)) == 0) large[strlen(large) - 1] = '1';
    int fd = open(large, O_WRONLY | O_CREAT | O_EXCL, 0600);
    assert_int_equal(ftruncate(fd, KEEP_MOST - 2 * KEEP_LEAST), 0);
    close(fd);
    used(0, 1000);
    used(1, 2000);
    assert_true(finds(1)); /* it is used now */
    keep(2);
    assert_true(finds(1));
    assert_true(finds(2));
    assert_int_equal(access(large, F_OK), 0);
    assert_false(finds(0));
    assert_int_equal(open("stormring/state/new-1-1", O_WRONLY | O_CREAT, 0600) < 0, 0);
    struct timespec old[2] = {{0}};
    assert_int_equal(utimensat(AT_FDCWD, "stormring/state/new-1-1", old, 0), 0);
    keep(0);
    assert_int_not_equal(access("stormring/state/new-1-1", F_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_kept_is_found),
        cmocka_unit_test(only_a_hash_is_a_name),
        cmocka_unit_test(damage_is_found),
        cmocka_unit_test(links_and_other_users_are_refused),
        cmocka_unit_test(what_was_used_longest_ago_goes),
    };
    return cmocka_run_group_tests(tests, NULL, close_scratch);
}
