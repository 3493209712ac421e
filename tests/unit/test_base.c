/* base: numbers, memory, buffers, files, messages, clocks, chance. What exits is tried in a
 * child. */
#include "base/base.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <setjmp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

/* ---- what exits ------------------------------------------------------------------------- */

static char said[4096]; /* by the child, on stdout and stderr */

/* Runs act in a child whose stdout goes to `out` (NULL: into said, with stderr); its exit
 * status. */
static int in_child(void (*act)(void), const char *out)
{
    int fd[2], status;
    assert_int_equal(pipe(fd), 0);
    fflush(stdout);
    pid_t pid = fork();
    if (pid == 0) {
        int to = out ? open(out, O_WRONLY) : fd[1];
        dup2(fd[1], STDERR_FILENO);
        dup2(to, STDOUT_FILENO);
        close(fd[0]);
        close(fd[1]);
        act();
        _exit(99);
    }
    close(fd[1]);
    struct buf b = {0};
    while (read_some(fd[0], &b, 512) > 0)
        ;
    snprintf(said, sizeof said, "%.*s", (int)buf_size(&b), (const char *)buf_data(&b));
    buf_free(&b);
    close(fd[0]);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static void warn_twice(void)
{
    prog_init("/some/where/prog");
    warn("plain %d", 7);
    errno = ENOENT;
    warn("%s:", "file");
    exit(0);
}
static void die_of_disk(void)
{
    errno = EIO;
    die(ST_SYSTEM, "disk:");
}
static void ask_usage(void) { usage(ST_OK, "[-h]"); }
static void wrong_usage(void) { usage(ST_USAGE, "[-h]"); }
static void print_and_close(void)
{
    printf("something\n");
    close_stdout();
    exit(ST_OK);
}
static void print_much_and_close(void)
{
    for (int i = 0; i < 100000; i++) printf("something\n"); /* fails long before the end */
    fflush(stdout);
    errno = 0;
    close_stdout();
    exit(ST_OK);
}
static void bad_int(void) { opt_int('n', "5x", 1, 9); }
static void bad_real(void) { opt_real('t', "2", 0, 1); }
static void product_overflow(void) { xmalloc(SIZE_MAX / 2, 3); }
static void too_much(void) { xcalloc((size_t)PTRDIFF_MAX, 1); }

static void test_exits(void **state)
{
    (void)state;
    assert_int_equal(in_child(warn_twice, NULL), 0);
    assert_string_equal(said, "prog: plain 7\nprog: file: No such file or directory\n");
    assert_int_equal(in_child(die_of_disk, NULL), ST_SYSTEM);
    assert_non_null(strstr(said, "disk: Input/output error\n"));
    assert_int_equal(in_child(ask_usage, NULL), ST_OK);
    assert_non_null(strstr(said, "usage: "));
    assert_int_equal(in_child(ask_usage, "/dev/null"), ST_OK);
    assert_string_equal(said, "");
    assert_int_equal(in_child(wrong_usage, "/dev/null"), ST_USAGE);
    assert_non_null(strstr(said, "usage: "));
    assert_int_equal(in_child(ask_usage, "/dev/full"), ST_SYSTEM);
}

static void test_stdout_lost(void **state)
{
    (void)state;
    assert_int_equal(in_child(print_and_close, "/dev/null"), ST_OK);
    assert_int_equal(in_child(print_and_close, "/dev/full"), ST_SYSTEM);
    assert_non_null(strstr(said, "standard output: No space left on device"));
    assert_int_equal(in_child(print_much_and_close, "/dev/full"), ST_SYSTEM);
    assert_non_null(strstr(said, "standard output:"));
    assert_null(strstr(said, "Success"));
}

static void test_options(void **state)
{
    (void)state;
    assert_int_equal(opt_int('n', "9", 1, 9), 9);
    assert_true(opt_real('t', ".5", 0, 1) == .5);
    assert_int_equal(in_child(bad_int, NULL), ST_USAGE);
    assert_non_null(strstr(said, "-n 5x: expected an integer from 1 to 9"));
    assert_int_equal(in_child(bad_real, NULL), ST_USAGE);
    assert_non_null(strstr(said, "-t 2: expected a number from 0 to 1"));
}

/* ---- numbers ---------------------------------------------------------------------------- */

static void test_parse_int(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int64_t v;
    } good[] = {{"0", 0}, {"-0", 0}, {"007", 7}, {"-12", -12}, {"9223372036854775807", INT64_MAX},
        {"-9223372036854775808", INT64_MIN}};
    static const char *const bad[] = {"", "-", "+1", " 1", "1 ", "1\n", "0x10", "1e3", "1.0", "--1",
        "9223372036854775808", "-9223372036854775809", "99999999999999999999999", "one"};
    int64_t v;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        assert_true(parse_int(good[i].text, INT64_MIN, INT64_MAX, &v));
        assert_int_equal(v, good[i].v);
    }
    v = 42;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (parse_int(bad[i], INT64_MIN, INT64_MAX, &v)) fail_msg("\"%s\" was taken", bad[i]);
    assert_false(parse_int("4", 5, 9, &v));
    assert_false(parse_int("10", 5, 9, &v));
    assert_int_equal(v, 42);
}

static void test_parse_real(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double v;
    } good[] = {{"0", 0}, {"-0", 0}, {"1e5", 1e5}, {".5", .5}, {"5.", 5}, {"+2.5E-1", .25},
        {"1e-400", 0}, {"1e308", 1e308}};
    static const char *const bad[] = {"", ".", "-", "e5", "1e", "1e+", "nan", "inf", "-inf", "NAN",
        "1e999", "-1e999", "0x1p3", " 1", "1 ", "1,5", "1..2", "1-2"};
    double v;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        if (!parse_real(good[i].text, -1e308, 1e308, &v)) fail_msg("\"%s\"", good[i].text);
        assert_true(v == good[i].v);
    }
    v = 42;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (parse_real(bad[i], -HUGE_VAL, HUGE_VAL, &v)) fail_msg("\"%s\" was taken", bad[i]);
    assert_false(parse_real("1.0001", 0, 1, &v));
    assert_false(parse_real("-1e-9", 0, 1, &v));
    assert_true(v == 42);
}

static void test_parse_size(void **state)
{
    (void)state;
    static const char *const bad[] = {"", "x", "1x", "x1", "0x1", "1x0", "-1x2", "1x-2", "1x1x1",
        "1X1", "65536x1", "1x65536", " 1x1", "1x1 ", "1.5x2",
        "00000000000000000000000000000000001x1"};
    int w = 0, h = 0;
    assert_true(parse_size("512x384", 65535, &w, &h));
    assert_true(w == 512 && h == 384);
    assert_true(parse_size("1x65535", 65535, &w, &h));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (parse_size(bad[i], 65535, &w, &h)) fail_msg("\"%s\" was taken", bad[i]);
    assert_true(w == 1 && h == 65535);
}

/* ---- memory ----------------------------------------------------------------------------- */

static void test_allocators(void **state)
{
    (void)state;
    assert_int_equal(in_child(product_overflow, NULL), ST_SYSTEM);
    assert_int_equal(in_child(too_much, NULL), ST_SYSTEM);
    assert_non_null(strstr(said, "out of memory"));
    void *none = xmalloc(0, 8);
    assert_non_null(none);
    for (size_t n = 0; n < 200; n += 7) {
        char *p = xaligned(n, 1);
        assert_int_equal((uintptr_t)p % 64, 0);
        memset(p, 1, n);
        free(p);
    }
    char *p = xcalloc(100, 1);
    for (int i = 0; i < 100; i++) assert_int_equal(p[i], 0);
    p = xrealloc(p, 1000, 1);
    char *s = xstrdup("text");
    assert_string_equal(s, "text");
    free(s);
    free(p);
    free(none);
}

/* A queue of bytes 0, 1, 2, ...: whatever is appended and consumed, they come out in order. */
static void test_buffer(void **state)
{
    (void)state;
    struct buf b = {0};
    uint32_t in = 0, out = 0;
    assert_int_equal(buf_size(&b), 0);
    buf_consume(&b, 0);
    for (uint64_t k = 0; k < 20000; k++) {
        unsigned char bytes[700];
        size_t n = rng_u64(1, k) % (k % 100 < 50 ? 700 : 60);
        for (size_t i = 0; i < n; i++) bytes[i] = (unsigned char)in++;
        buf_append(&b, bytes, n);
        size_t most = rng_u64(2, k) % (k % 100 < 50 ? 60 : 700);
        size_t take = most < buf_size(&b) ? most : buf_size(&b);
        for (size_t i = 0; i < take; i++) assert_int_equal(buf_data(&b)[i], (unsigned char)out++);
        buf_consume(&b, take);
        assert_int_equal(buf_size(&b), in - out);
        assert_true(b.off <= b.len && b.len <= b.cap);
    }
    buf_consume(&b, buf_size(&b));
    buf_free(&b);
    for (int k = 0; k < 100000; k++) { /* a short queue stays short */
        buf_append(&b, "0123456789", 10);
        if (k > 3) buf_consume(&b, 10);
    }
    assert_true(b.cap <= 256);
    buf_free(&b);
}

static void test_buf_printf(void **state)
{
    (void)state;
    struct buf b = {0};
    char longest[3000];
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    buf_printf(&b, "%d-", 12);
    buf_printf(&b, "%s", longest);
    for (int n = 120; n < 140; n++) buf_printf(&b, "%*d", n, 7); /* around the first guess */
    size_t size = 3 + 2999;
    for (size_t n = 120; n < 140; n++) size += n;
    assert_int_equal(buf_size(&b), size);
    assert_memory_equal(buf_data(&b), "12-xxx", 6);
    buf_free(&b);
}

/* What the shell makes of it is the word again. */
static void test_quote(void **state)
{
    (void)state;
    static const char *const words[][2] = {{"plain.nff", "plain.nff"}, {"", ""}, {"a b", "a b"},
        {"it's", "it's"}, {"'", "'"}, {"$HOME `id` \\ \"q\" *", "$HOME `id` \\ \"q\" *"},
        {"-rf", "./-rf"}, {"-a b", "./-a b"}, {"~", "~"}, {"#x", "#x"}, {"a\nb", "a\nb"},
        {"a;b&c|d>e", "a;b&c|d>e"}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        struct buf b = {0}, got = {0};
        buf_printf(&b, "printf %%s ");
        buf_quote(&b, words[i][0]);
        buf_append(&b, "", 1);
        FILE *f = popen((const char *)buf_data(&b), "r");
        assert_non_null(f);
        assert_true(read_some(fileno(f), &got, 200) >= 0);
        assert_int_equal(pclose(f), 0);
        assert_int_equal(buf_size(&got), strlen(words[i][1]));
        assert_memory_equal(buf_data(&got), words[i][1], strlen(words[i][1]));
        buf_free(&b);
        buf_free(&got);
    }
}

/* ---- files ------------------------------------------------------------------------------ */

static char folder[] = "/tmp/stormring-test-XXXXXX";
static char path[64];

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder)) return -1;
    snprintf(path, sizeof path, "%s/file", folder);
    return 0;
}
static int remove_folder(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(folder); /* fails where something was left behind */
}

static void assert_content(const char *text)
{
    char got[64]; /* read_file would note an input */
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    got[fread(got, 1, sizeof got - 1, f)] = '\0';
    fclose(f);
    assert_string_equal(got, text);
}

static void test_outfile(void **state)
{
    (void)state;
    struct outfile o;
    struct stat st;
    mode_t mask = umask(027);
    assert_int_equal(outfile_open(&o, path), 0);
    fprintf(o.f, "first");
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(outfile_commit(&o), 0);
    assert_content("first");
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0640);
    umask(mask);

    assert_int_equal(outfile_open(&o, path), 0);
    fprintf(o.f, "second");
    outfile_discard(&o);
    assert_content("first");
    assert_int_equal(outfile_open(&o, path), 0);
    fprintf(o.f, "third");
    assert_int_equal(outfile_commit(&o), 0);
    assert_content("third");
}

static void test_outfile_link(void **state)
{
    (void)state;
    struct stat st;
    char link[sizeof path + 5];
    snprintf(link, sizeof link, "%s.link", path);
    assert_int_equal(outfile_put(path, "old", 3), 0);
    assert_int_equal(symlink(path, link), 0);
    assert_int_equal(outfile_check(link), 0);
    assert_int_equal(outfile_put(link, "new", 3), 0);
    assert_content("new");
    assert_int_equal(lstat(link, &st), 0);
    assert_true(S_ISLNK(st.st_mode));
    /* a relative link to a file that does not exist yet */
    assert_int_equal(unlink(link) | unlink(path), 0);
    assert_int_equal(symlink(strrchr(path, '/') + 1, link), 0);
    assert_int_equal(outfile_put(link, "third", 5), 0);
    assert_content("third");
    assert_true(lstat(link, &st) == 0 && S_ISLNK(st.st_mode));
    assert_int_equal(unlink(link), 0);
}

/* Two files are open when the signal comes. */
/* An output that is a name of an open descriptor goes where that is. */
static void test_outfile_descriptor(void **state)
{
    (void)state;
    char link[sizeof path + 5], name[64];
    snprintf(link, sizeof link, "%s.link", path);
    static const char *const names[] = {
        "/dev/fd/%d", "/proc/self/fd/%d", "/proc/thread-self/fd/%d"};
    for (size_t i = 0; i < 2 * sizeof names / sizeof *names; i++) {
        int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
        assert_true(fd >= 0);
        assert_int_equal(write_full(fd, "before ", 7), 0);
        snprintf(name, sizeof name, names[i / 2], fd);
        if (i % 2) assert_int_equal(symlink(name, link), 0);
        assert_int_equal(outfile_check(i % 2 ? link : name), 0);
        assert_int_equal(outfile_put(i % 2 ? link : name, "new", 3), 0);
        assert_int_equal(write_full(fd, " after", 6), 0);
        close(fd);
        assert_content("before new after");
        if (i % 2) assert_int_equal(unlink(link), 0);
    }
}

static const char *output;
static void open_output(void)
{
    struct outfile o;
    _exit(outfile_open(&o, output) == 0 ? ST_OK : ST_SYSTEM);
}

/* No output replaces what was read, by any name. */
static void test_inputs(void **state)
{
    (void)state;
    char soft[sizeof path + 5], hard[sizeof path + 5], other[sizeof path + 6];
    struct buf b = {0};
    snprintf(soft, sizeof soft, "%s.link", path);
    snprintf(hard, sizeof hard, "%s.hard", path);
    snprintf(other, sizeof other, "%s.other", path);
    assert_int_equal(outfile_put(path, "input", 5), 0);
    assert_int_equal(outfile_put(other, "other", 5), 0);
    assert_null(input_is(path));
    assert_int_equal(read_file(path, &b), 0);
    assert_int_equal(symlink(path, soft), 0);
    assert_int_equal(link(path, hard), 0);
    for (int i = 0; i < 3; i++) {
        const char *name = i == 0 ? path : i == 1 ? soft : hard;
        assert_string_equal(input_is(name), "an input");
        output = name;
        assert_int_equal(in_child(open_output, NULL), ST_USAGE);
        assert_non_null(strstr(said, "is also an input, expected another file"));
    }
    assert_null(input_is(other));
    assert_null(input_is("/dev/null"));
    input_add(other, "the log");
    input_add(other, "an input");
    assert_string_equal(input_is(other), "the log");
    /* A file of the input's name and another one with its inode are no inputs. */
    assert_int_equal(rename(other, path), 0);
    assert_null(input_is(hard));
    assert_int_equal(unlink(soft), 0);
    assert_int_equal(unlink(hard), 0);
    for (int i = 0; i < 1000; i++) { /* the table grows */
        snprintf(other, sizeof other, "%s.%d", path, i % 10);
        assert_int_equal(outfile_put(other, "x", 1), 0);
        input_add(other, "an input");
        assert_non_null(input_is(other));
        assert_int_equal(unlink(other), 0);
    }
    buf_free(&b);
}

static void test_outfile_signal(void **state)
{
    (void)state;
    static const int signals[] = {SIGHUP, SIGINT, SIGTERM};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        int status, pipe_to[2];
        char name[2][64] = {{0}};
        assert_int_equal(pipe(pipe_to), 0);
        pid_t pid = fork();
        if (pid == 0) {
            struct outfile o[2];
            signal(signals[i], SIG_DFL); /* a shell may have told its children to ignore it */
            for (int k = 0; k < 2; k++) {
                outfile_open(&o[k], path);
                snprintf(name[k], sizeof name[k], "%s", o[k].temporary);
            }
            if (write(pipe_to[1], name, sizeof name) == (ssize_t)sizeof name) raise(signals[i]);
            _exit(0);
        }
        assert_int_equal(read(pipe_to[0], name, sizeof name), sizeof name);
        assert_int_equal(waitpid(pid, &status, 0), pid);
        assert_true(WIFSIGNALED(status) && WTERMSIG(status) == signals[i]);
        for (int k = 0; k < 2; k++) {
            assert_int_equal(strncmp(name[k], path, strlen(path)), 0);
            assert_int_equal(access(name[k], F_OK), -1);
        }
        close(pipe_to[0]), close(pipe_to[1]);
    }
    /* Afterwards the signals do what they did. */
    struct sigaction now;
    struct outfile o;
    signal(SIGTERM, SIG_DFL);
    assert_int_equal(outfile_open(&o, path), 0);
    outfile_discard(&o);
    assert_int_equal(sigaction(SIGTERM, NULL, &now), 0);
    assert_true(now.sa_handler == SIG_DFL);
}

/* exit() removes them too, but not that of a child. */
static void test_outfile_exit(void **state)
{
    (void)state;
    int status, pipe_to[2];
    char name[64] = {0};
    assert_int_equal(pipe(pipe_to), 0);
    pid_t pid = fork();
    if (pid == 0) {
        struct outfile o;
        outfile_open(&o, path);
        pid_t child = fork();
        if (child == 0) exit(0);
        waitpid(child, NULL, 0);
        bool there = access(o.temporary, F_OK) == 0;
        snprintf(name, sizeof name, "%s", o.temporary);
        exit(there && write(pipe_to[1], name, sizeof name) == (ssize_t)sizeof name ? 7 : 0);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 7);
    assert_int_equal(read(pipe_to[0], name, sizeof name), sizeof name);
    assert_int_equal(access(name, F_OK), -1);
    close(pipe_to[0]), close(pipe_to[1]);
}

static void test_outfile_fails(void **state)
{
    (void)state;
    struct outfile o;
    assert_int_equal(outfile_open(&o, "/dev/full"), 0);
    fprintf(o.f, "lost");
    assert_int_equal(outfile_commit(&o), -1);
    assert_int_equal(errno, ENOSPC);
    assert_int_equal(access("/dev/full", F_OK), 0);
    assert_int_equal(outfile_open(&o, "/nonexistent/file"), -1);
    assert_int_equal(errno, ENOENT);
    assert_int_equal(outfile_check(path), 0);
    assert_int_equal(outfile_check("file"), 0);
    assert_int_equal(outfile_check("/nonexistent/file"), -1);
    assert_int_equal(outfile_check("/tmp"), -1);
    assert_int_equal(errno, EISDIR);
    char longest[NAME_MAX + 1];
    memset(longest, 'x', NAME_MAX);
    longest[NAME_MAX] = '\0';
    assert_int_equal(outfile_check(longest), -1);
    assert_int_equal(errno, ENAMETOOLONG);
    longest[NAME_MAX - 7] = '\0';
    assert_int_equal(outfile_check(longest), 0);
    assert_int_equal(outfile_check("/nonexistent-%d/file"), 0);
    struct buf b = {0};
    assert_int_equal(read_file("/nonexistent/file", &b), -1);
    assert_int_equal(errno, ENOENT);
}

static void test_read_open(void **state)
{
    (void)state;
    const char *std = "-", *name = "/dev/null";
    assert_int_equal(read_open(&std), STDIN_FILENO);
    assert_string_equal(std, "standard input");
    int fd = read_open(&name);
    assert_true(fd > STDERR_FILENO && fcntl(fd, F_GETFD) == FD_CLOEXEC);
    assert_string_equal(name, "/dev/null");
    close(fd);
}

static void test_write_full(void **state)
{
    (void)state;
    static char much[1 << 20];
    int fd[2], status;
    assert_int_equal(pipe(fd), 0);
    pid_t pid = fork();
    if (pid == 0) { /* a reader in small steps */
        size_t n = 0;
        char some[1000];
        close(fd[1]);
        for (ssize_t k; (k = read(fd[0], some, sizeof some)) > 0;) n += (size_t)k;
        _exit(n == sizeof much ? 0 : 1);
    }
    close(fd[0]);
    assert_int_equal(write_full(fd[1], much, sizeof much), 0);
    close(fd[1]);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(status, 0);
    assert_int_equal(write_full(-1, "x", 1), -1);
    assert_int_equal(errno, EBADF);
}

/* ---- the rest --------------------------------------------------------------------------- */

static void test_clocks(void **state)
{
    (void)state;
    int64_t wall = now_us(), cpu = cpu_us();
    while (cpu_us() - cpu < 2000)
        ;
    assert_true(now_us() - wall >= 1900);
}

static void test_chance(void **state)
{
    (void)state;
    double sum = 0, squares = 0;
    int n = 100000;
    for (int i = 0; i < n; i++) {
        double u = rng_unit(7, (uint64_t)i);
        assert_true(u >= 0 && u < 1);
        sum += u;
        squares += u * u;
    }
    assert_true(fabs(sum / n - 1. / 2) < 0.005);
    assert_true(fabs(squares / n - 1. / 3) < 0.005);
    assert_true(rng_u64(1, 2) == rng_u64(1, 2));
    assert_true(rng_u64(1, 2) != rng_u64(2, 1));
}

/* By libxxhash 0.8.1 (Y. Collet). The bytes end in each way: in steps of 32, 8, 4 and 1. */
static void test_hash(void **state)
{
    (void)state;
    static const struct {
        size_t n;
        uint64_t seed, hash;
    } want[] = {
        {0, UINT64_C(0x0), UINT64_C(0xef46db3751d8e999)},
        {1, UINT64_C(0x0), UINT64_C(0x50ff15a81340970f)},
        {3, UINT64_C(0x1), UINT64_C(0xb76454898bdf031a)},
        {4, UINT64_C(0x0), UINT64_C(0x44660f2f3ceb9ea7)},
        {7, UINT64_C(0x0), UINT64_C(0xdecb0785a46e4099)},
        {8, UINT64_C(0x9), UINT64_C(0xc7c3e072feb83bee)},
        {13, UINT64_C(0x0), UINT64_C(0xc0c201103541d088)},
        {31, UINT64_C(0x0), UINT64_C(0x40ac04d6fbe5056b)},
        {32, UINT64_C(0x0), UINT64_C(0xd52b1688ab9bc2b5)},
        {33, UINT64_C(0x5), UINT64_C(0x0d9429f991ca92e4)},
        {63, UINT64_C(0x0), UINT64_C(0x088b4640a04ae0aa)},
        {64, UINT64_C(0x8000000000000000), UINT64_C(0x48ae8f8e38df8fbd)},
        {100, UINT64_C(0x0), UINT64_C(0x5f8e0f12ded2abd5)},
        {200, UINT64_C(0xffffffffffffffff), UINT64_C(0x1b21cca7cb9127ee)},
    };
    unsigned char bytes[200];
    for (int i = 0; i < 200; i++) bytes[i] = (unsigned char)(i * 73 + 5);
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++)
        assert_true(hash64(want[i].seed, bytes, want[i].n) == want[i].hash);
    for (uint32_t n = 0; n <= 50; n++) { /* as bytes, from the least significant one of each */
        uint32_t words[50];
        for (uint32_t i = 0; i < n; i++)
            words[i] = bytes[4 * i] | (uint32_t)bytes[4 * i + 1] << 8 |
                       (uint32_t)bytes[4 * i + 2] << 16 | (uint32_t)bytes[4 * i + 3] << 24;
        assert_true(hash64_u32(n, words, n) == hash64(n, bytes, 4 * (size_t)n));
    }
    assert_true(HASH64_INIT == 0); /* logs hold hashes */
}

/* FIPS 180-4 has no examples; these are those of NIST, and lengths around a block's end. */
static void test_sha256(void **state)
{
    (void)state;
    static const struct {
        const char *text, *hash;
    } known[] = {
        {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
        {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
        {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
    };
    static const struct {
        size_t length;
        const char *hash;
    } of_a[] = {
        {55, "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318"},
        {56, "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a"},
        {63, "7d3e74a05d7db15bce4ad9ec0658ea98e3f06eeecf16b4c6fff2da457ddc2f34"},
        {64, "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb"},
        {65, "635361c48bb9eab14198e76ea8ab7f1a41685d6ad62aa9146d301d4f17eb0ae0"},
        {119, "31eba51c313a5c08226adf18d4a359cfdfd8d2e816b13f4af952f7ea6584dcfb"},
        {120, "2f3d335432c70b580af0e8e1b3674a7c020d683aa5f73aaaedfdc55af904c21c"},
        {128, "6836cf13bac400e9105071cd6af47084dfacad4e5e302c94bfed24e013afb73e"},
    };
    char text[SHA256_TEXT];
    unsigned char a[130];
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        sha256(known[i].text, strlen(known[i].text), text);
        assert_string_equal(text, known[i].hash);
    }
    memset(a, 'a', sizeof a);
    for (size_t i = 0; i < sizeof of_a / sizeof *of_a; i++) {
        sha256(a, of_a[i].length, text);
        assert_string_equal(text, of_a[i].hash);
    }
    /* With and without the processor's instructions, at any address. */
    unsigned char bytes[1000];
    char plain[SHA256_TEXT];
    for (size_t i = 0; i < sizeof bytes; i++) bytes[i] = (unsigned char)rng_u64(1, i);
    for (size_t n = 0; n < sizeof bytes - 64; n++) {
        sha256(bytes + n % 64, n, text);
        sha256_plain(bytes + n % 64, n, plain);
        assert_string_equal(text, plain);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exits),
        cmocka_unit_test(test_stdout_lost),
        cmocka_unit_test(test_options),
        cmocka_unit_test(test_parse_int),
        cmocka_unit_test(test_parse_real),
        cmocka_unit_test(test_parse_size),
        cmocka_unit_test(test_allocators),
        cmocka_unit_test(test_buffer),
        cmocka_unit_test(test_buf_printf),
        cmocka_unit_test(test_quote),
        cmocka_unit_test(test_outfile),
        cmocka_unit_test(test_outfile_link),
        cmocka_unit_test(test_outfile_descriptor),
        cmocka_unit_test(test_inputs),
        cmocka_unit_test(test_outfile_signal),
        cmocka_unit_test(test_outfile_exit),
        cmocka_unit_test(test_outfile_fails),
        cmocka_unit_test(test_read_open),
        cmocka_unit_test(test_write_full),
        cmocka_unit_test(test_clocks),
        cmocka_unit_test(test_chance),
        cmocka_unit_test(test_hash),
        cmocka_unit_test(test_sha256),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
