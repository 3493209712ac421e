/* Programs for hosts that have none: which are sent, and what the script does on such a host. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "hosts/hosts_int.h"
#include "scratch.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

static char dir[SCRATCH_BYTES]; /* the current one */

static void put(const char *path, const char *text, mode_t mode)
{
    unlink(path); /* what was read is not replaced */
    assert_int_equal(outfile_put(path, text, strlen(text)), 0);
    assert_int_equal(chmod(path, mode), 0);
}

static void run(const char *command) { assert_int_equal(system(command), 0); }

/* ---- on the host ----------------------------------------------------------------------------- */

/* It shows its rights and words, and what of its standard input is left. */
static const char worker[] = "#!/bin/sh\n"
                             "[ \"$1\" = --version ] && exit\n"
                             "echo \"ran $(umask), $1, $2\"\n"
                             "cat\n";
#define RAN "ran 0022, it's, a  b\n"
#define REST "task 0 0\n"

static struct hosts_program program;
static const struct hosts_sent sent = {&program, 1};
static char out[8192]; /* what the host has printed */

/* Runs the script in this environment, with these bytes and REST as its standard input. */
static void arrive(const char *environment, const char *bytes)
{
    char word[] = "worker", quote[] = "it's", blanks[] = "a  b", via[2 * SCRATCH_BYTES];
    char *words[] = {word, quote, blanks, NULL};
    snprintf(via, sizeof via, "env -i PATH=\"%s/tools:$PATH\" %s sh -c %%c", dir, environment);
    const struct host h = {.name = word, .via = via, .sent = &sent};
    char **argv = host_argv(&h, words);
    int fd = open("in", O_RDWR | O_CREAT | O_TRUNC, 0600);
    assert_true(fd >= 0 && write_full(fd, bytes, strlen(bytes)) == 0);
    assert_true(write_full(fd, REST, strlen(REST)) == 0 && lseek(fd, 0, SEEK_SET) == 0);
    pid_t pid = fork();
    if (pid == 0) {
        int to = open("out", O_RDWR | O_CREAT | O_TRUNC, 0600);
        umask(022);
        if (dup2(fd, STDIN_FILENO) >= 0 && dup2(to, STDOUT_FILENO) >= 0) execvp(argv[0], argv);
        _exit(9);
    }
    int status;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    close(fd);
    host_argv_free(argv);
    struct buf b = {0};
    assert_int_equal(read_file("out", &b), 0);
    snprintf(out, sizeof out, "%.*s", (int)buf_size(&b), (const char *)buf_data(&b));
    buf_free(&b);
    assert_true(WIFEXITED(status));
}

static void said(const char *text)
{
    if (!strstr(out, text)) fail_msg("\"%s\" does not say \"%s\"", out, text);
}

/* The program ran with its words and the caller's rights, and what was sent behind it came. */
static void ran(bool needed)
{
    char text[128];
    snprintf(text, sizeof text, "\nstormring-send need %s\n", program.sha256);
    assert_int_equal(strstr(out, text) != NULL, needed);
    said(RAN REST);
}

static void refused(const char *why)
{
    said("\nstormring-send no ");
    said(why);
    assert_null(strstr(out, "ran "));
}

static void has_mode(const char *path, mode_t mode)
{
    struct stat st;
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 07777, mode);
}

/* cache/stormring/HASH, or the worker in it */
static const char *cached(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "cache/stormring/%s%s", program.sha256, name);
    return path;
}

#define CACHE "XDG_CACHE_HOME=\"$PWD/cache\""

static void a_program_is_sent_once(void **state)
{
    (void)state;
    assert_int_equal(mkdir("cache", 0755), 0);
    assert_int_equal(mkdir("cache/stormring", 0777), 0);
    arrive(CACHE, worker);
    ran(true);
    has_mode("cache/stormring", 0700); /* for its user alone, also if it was there before */
    has_mode(cached(""), 0700);
    has_mode(cached("/worker"), 0700);
    arrive(CACHE, "");
    ran(false);
    /* As long as before, but damaged: it does not run. */
    FILE *f = fopen(cached("/worker"), "r+e");
    assert_non_null(f);
    assert_int_equal(fseek(f, -2, SEEK_END), 0);
    assert_true(fputc('x', f) == 'x' && fclose(f) == 0);
    arrive(CACHE, worker);
    ran(true);
    run("test \"$(ls cache/stormring/*)\" = worker && rm -r cache");
}

static void what_arrives_damaged_does_not_run(void **state)
{
    (void)state;
    char bytes[sizeof worker];
    snprintf(bytes, sizeof bytes, "%s", worker);
    bytes[sizeof worker - 2] = ' ';
    arrive(CACHE, bytes);
    refused("worker is damaged on arrival");
    run("test -z \"$(find cache ! -type d)\" && rm -r cache");
}

static void a_place_that_is_taken_is_refused(void **state)
{
    (void)state;
    assert_int_equal(mkdir("cache", 0755), 0);
    assert_int_equal(mkdir("cache/stormring", 0755), 0);
    assert_int_equal(mkdir(cached(""), 0755), 0);
    assert_int_equal(mkdir(cached("/worker"), 0755), 0);
    arrive(CACHE, worker);
    refused("/worker: is no file");
    run("rm -r cache");
    arrive("XDG_CACHE_HOME=\"$PWD/a:b\"", worker);
    refused("/a:b/stormring: expected a directory without a colon");
    run("rm -r a:b");
}

static char place[64]; /* in /tmp */

static int leave_tmp(void **state)
{
    (void)state;
    char command[sizeof place + 32];
    snprintf(command, sizeof command, "rm -rf '%s' tools/id", place);
    return system(command);
}

/* The place in /tmp is named after the user; here after this test. */
static void a_link_in_tmp_is_refused(void **state)
{
    (void)state;
    char fake[64];
    const char *user = strrchr(dir, '/') + 1;
    snprintf(fake, sizeof fake, "#!/bin/sh\necho %.30s\n", user);
    snprintf(place, sizeof place, "/tmp/stormring-%.30s", user);
    put("tools/id", fake, 0700);
    assert_int_equal(symlink(dir, place), 0);
    arrive("", worker);
    refused(": is a link");
    assert_int_equal(unlink(place), 0);
    arrive("", worker);
    ran(true);
    has_mode(place, 0700);
}

static void another_machine_is_refused(void **state)
{
    (void)state;
    struct utsname here;
    char expected[256];
    assert_int_equal(uname(&here), 0);
    snprintf(expected, sizeof expected, "it is %s vax, expected %s %s", here.sysname, here.sysname,
        here.machine);
    snprintf(out, sizeof out, "#!/bin/sh\necho %s vax\n", here.sysname);
    put("tools/uname", out, 0700);
    arrive(CACHE, worker);
    refused(expected);
    assert_int_equal(access("cache", F_OK), -1);
    assert_int_equal(unlink("tools/uname"), 0);
}

/* ---- what is sent ---------------------------------------------------------------------------- */

/* Prints what hosts_send finds for these words, beside this program, and for which hosts. */
static int show_sent(char *const words[])
{
    struct host at[] = {{.send = true}, {.send = false}};
    struct hosts hosts = {.at = at, .n = 2};
    struct hosts_sent found = {0};
    char err[HOSTS_ERR];
    if (!hosts_send(&hosts, &found, words, err)) return printf("%s\n", err) < 0;
    printf("%s%s", at[0].sent == &found ? "a" : "", at[1].sent ? "b" : "");
    for (size_t i = 0; i < found.n; i++) printf(" %s", found.at[i].name);
    printf("\n");
    hosts_sent_free(&found);
    return 0;
}

/* Runs it with these words of a command. */
static void send_words(const char *words)
{
    char command[1024];
    snprintf(command, sizeof command, "bin/test_send --sent %s >out", words);
    run(command);
    struct buf b = {0};
    assert_int_equal(read_file("out", &b), 0);
    snprintf(out, sizeof out, "%.*s", (int)buf_size(&b), (const char *)buf_data(&b));
    buf_free(&b);
}

static void static_programs_are_sent_and_nothing_else(void **state)
{
    (void)state;
    char self[64];
    snprintf(self, sizeof self, "mkdir bin && cp /proc/%ld/exe bin/test_send", (long)getpid());
    run(self);
    run("mkdir -p lib/stormring/sub && cd lib/stormring && touch deal worker sub/tool Tool ../x");
    send_words("worker -j 2 worker sub/tool ../x Tool '' none deal /bin/sh");
    assert_string_equal(out, "a worker deal\n");
    send_words("sh -c true");
    said("send=auto: no word of `sh ...` is a static program in");
    run("cd lib/stormring && touch $(seq 40)");
    send_words("$(seq 40)");
    assert_non_null(strstr(out, " 31 32\n")); /* at most HOSTS_SENT_MOST */
    run("rm -r bin lib");
}

/* A host asks by hash, and the whole hash counts. */
static void a_hash_names_a_program(void **state)
{
    (void)state;
    char other[SHA256_TEXT];
    memcpy(other, program.sha256, sizeof other);
    assert_ptr_equal(hosts_program(&sent, other), &program);
    other[SHA256_TEXT - 2] = other[SHA256_TEXT - 2] == '0' ? '1' : '0';
    assert_null(hosts_program(&sent, other));
    other[SHA256_TEXT - 2] = '\0';
    assert_null(hosts_program(&sent, other));
    assert_null(hosts_program(&sent, ""));
    assert_null(hosts_program(NULL, program.sha256));
}

static int make_dir(void **state)
{
    (void)state;
    static char name[] = "worker";
    program.name = name;
    buf_append(&program.bytes, worker, sizeof worker - 1);
    sha256(worker, sizeof worker - 1, program.sha256);
    return !scratch_make(dir) || chdir(dir) != 0 || mkdir("tools", 0700) != 0;
}

static int remove_dir(void **state)
{
    (void)state;
    char command[SCRATCH_BYTES + 16];
    buf_free(&program.bytes);
    snprintf(command, sizeof command, "rm -r '%s'", dir);
    return system(command);
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "--sent") == 0) return show_sent(argv + 2);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_program_is_sent_once),
        cmocka_unit_test(what_arrives_damaged_does_not_run),
        cmocka_unit_test(a_place_that_is_taken_is_refused),
        cmocka_unit_test_teardown(a_link_in_tmp_is_refused, leave_tmp),
        cmocka_unit_test(another_machine_is_refused),
        cmocka_unit_test(static_programs_are_sent_and_nothing_else),
        cmocka_unit_test(a_hash_names_a_program),
    };
    return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
