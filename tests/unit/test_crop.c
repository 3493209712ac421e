/* The words, pictures and pixels of commands that draw rectangles, and what remains of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crop/crop.h"
#include "scratch.h"

#ifndef PATIENCE_S // mutants/ need less, because some wait for ever
#define PATIENCE_S 1200
#endif
#define LONG "sleep 90" /* what a failing test may leave behind ends by itself */

/* A list of words, as main has them: not const. It is valid until the next call. */
static char **words_of(const char *const words[])
{
    static char *list[16];
    int n = 0;
    do memcpy(&list[n], &words[n], sizeof *list);
    while (words[n++]);
    return list;
}
#define WORDS(...) words_of((const char *const[]){__VA_ARGS__, NULL})

static char dir[SCRATCH_BYTES];
static const struct crop_place there = {.directory = dir};

/* ---- words ----------------------------------------------------------------------------------- */

static const struct crop_rect rect = {
    .frame = 7, .frame_w = 40, .frame_h = 30, .x = 4, .y = 5, .w = 6, .h = 2};

static void numbers_replace_words(void **state)
{
    (void)state;
    char **words = WORDS("{x},{y} {w}x{h}", "{x1},{y1}-{x2},{y2}", "{W}x{H}.{F}", "{{x}} {z} {x ",
        "{i}", "<{o}>", "");
    static const char *const expected[] = {
        "4,5 6x2", "5,6-10,7", "40x30.7", "{4} {z} {x ", "{i}", "<out.png>", ""};
    char **made = crop_words(words, &rect, NULL, "out.png");
    for (int i = 0; i < 7; i++) assert_string_equal(made[i], expected[i]);
    assert_null(made[7]);
    crop_words_free(made);
    made = crop_words(words, &rect, "main.pov", NULL);
    assert_string_equal(made[4], "main.pov");
    assert_string_equal(made[5], "<{o}>");
    crop_words_free(made);
}

static void words_that_are_used(void **state)
{
    (void)state;
    char **words = WORDS("draw", "{x1} {o", "{w}{i}");
    assert_true(crop_uses(words, "i"));
    assert_true(crop_uses(words, "x1"));
    assert_false(crop_uses(words, "x"));
    assert_false(crop_uses(words, "o"));
}

static void a_hash_of_words(void **state)
{
    (void)state;
    char hash[SHA256_TEXT], ab[SHA256_TEXT];
    sha256("a\0b", 4, ab);
    crop_words_hash(WORDS("a", "b"), hash);
    assert_string_equal(hash, ab);
    crop_words_hash(WORDS("ab"), hash);
    assert_string_not_equal(hash, ab);
}

/* ---- pixels ---------------------------------------------------------------------------------- */

/* A picture whose pixels have the numbers that those of the rectangle have in the frame. */
static struct image numbered(const struct crop_rect *at, bool whole)
{
    struct image im;
    uint32_t x0 = whole ? 0 : at->x, y0 = whole ? 0 : at->y;
    image_init(&im, whole ? at->frame_w : at->w, whole ? at->frame_h : at->h);
    for (uint32_t y = 0; y < im.h; y++)
        for (uint32_t x = 0; x < im.w; x++)
            im.rgba[4 * ((size_t)y * im.w + x)] = (float)((y + y0) * at->frame_w + x + x0);
    return im;
}

/* Rectangles, rows, runs that wrap, and sets of scattered pixels. */
static void a_rectangle_has_all_pixels(void **state)
{
    (void)state;
    enum { W = 40, H = 30 };
    static const struct lattice tasks[] = {{4, 5, 6, 2, 1, 1}, {0, 3, W, 2, 1, 1},
        {30, 2, 50, 1, 1, 1}, {0, 0, W, H, 1, 1}, {3, 1, 9, 7, 4, 3}, {39, 29, 1, 1, 1, 1},
        {12, 0, 1, H, 1, 1}, {35, 4, 3, 3, 4, 2}};
    for (size_t k = 0; k < sizeof tasks / sizeof *tasks; k++) {
        const struct lattice *t = &tasks[k];
        struct crop_rect at = crop_around(t, W, H);
        uint32_t left = W, top = H, right = 0, bottom = 0;
        assert_true(lattice_valid(t, W, H));
        for (uint64_t n = 0; n < lattice_count(t); n++) {
            uint32_t x = (uint32_t)(lattice_pixel(t, W, n) % W);
            uint32_t y = (uint32_t)(lattice_pixel(t, W, n) / W);
            left = x < left ? x : left, right = x > right ? x : right;
            top = y < top ? y : top, bottom = y > bottom ? y : bottom;
        }
        assert_true(at.frame_w == W && at.frame_h == H && at.frame == 0);
        assert_true(at.x == left && at.y == top);
        assert_true(at.x + at.w == right + 1 && at.y + at.h == bottom + 1);
        for (int whole = 0; whole < 2; whole++) {
            struct image im = numbered(&at, whole);
            uint64_t count = lattice_count(t), first = count / 3;
            float *rgba = xcalloc(count, 4 * sizeof *rgba);
            crop_pixels(&im, &at, t, 0, (uint32_t)first, rgba);
            crop_pixels(&im, &at, t, first, (uint32_t)(count - first), rgba + 4 * first);
            for (uint64_t n = 0; n < count; n++)
                assert_true(rgba[4 * n] == (float)lattice_pixel(t, W, n));
            free(rgba);
            image_free(&im);
        }
    }
}

/* ---- commands -------------------------------------------------------------------------------- */

static char said[4096]; /* what a command wrote on standard error */

/* Runs a line of shell, with its words after it, and keeps what it says. */
static int shell(const char *line, struct buf *out, size_t most, char err[CROP_ERR])
{
    char name[] = "said-XXXXXX";
    char **words = WORDS("sh", "-c", line);
    int file = mkstemp(name), kept = dup(STDERR_FILENO);
    assert_true(file >= 0 && kept >= 0 && dup2(file, STDERR_FILENO) >= 0);
    *err = '\0';
    int result = crop_run(words, &there, out, most, err);
    assert_true(dup2(kept, STDERR_FILENO) >= 0);
    ssize_t n = pread(file, said, sizeof said - 1, 0);
    said[n > 0 ? n : 0] = '\0';
    close(kept), close(file), unlink(name);
    return result;
}

static void output_is_kept_or_dropped(void **state)
{
    (void)state;
    char err[CROP_ERR];
    struct buf out = {0};
    assert_int_equal(shell("pwd; cat", &out, 1000, err), 0); /* standard input is empty */
    assert_int_equal(buf_size(&out), strlen(dir) + 1);
    assert_memory_equal(buf_data(&out), dir, strlen(dir));
    buf_free(&out);
    assert_int_equal(
        crop_run(WORDS("pwd"), &(struct crop_place){.directory = "/"}, &out, 1000, err), 0);
    assert_int_equal(buf_size(&out), 2);
    buf_free(&out);
    assert_int_equal(shell("head -c 3000 /dev/zero", NULL, 1000, err), 0);
    assert_int_equal(shell("head -c 1001 /dev/zero; " LONG, &out, 1000, err), -1);
    assert_non_null(strstr(err, "more than 1000 bytes"));
    buf_free(&out);
}

static void failures_have_a_reason(void **state)
{
    (void)state;
    char err[CROP_ERR];
    assert_int_equal(shell("exit 3", NULL, 9, err), -1);
    assert_string_equal(err, "sh: exit status 3, expected 0");
    assert_int_equal(shell("kill -9 $$", NULL, 9, err), -1);
    assert_non_null(strstr(err, "sh: ended by signal 9; killed (signal 9), as the kernel does"));
    char **none = WORDS("./no-such-command");
    assert_int_equal(crop_run(none, &there, NULL, 9, err), CROP_NOT_FOUND);
    assert_int_equal(shell("echo fine >&2", NULL, 9, err), 0);
    assert_string_equal(said, "");
    assert_int_equal(
        shell("seq 2000 | sed 's/.*/&\\r\\n/' >&2; " LONG " >/dev/null & exit 1", NULL, 9, err),
        -1);
    assert_string_equal(said, "sh: 1993\nsh: 1994\nsh: 1995\nsh: 1996\nsh: 1997\nsh: 1998\n"
                              "sh: 1999\nsh: 2000\n");
}

/* True if the other end of the pipe is closed before PATIENCE_S, after one byte. */
static bool closes(int fd)
{
    struct pollfd p = {fd, POLLIN, 0};
    char c;
    ssize_t n;
    do
        if (poll(&p, 1, PATIENCE_S * 1000) <= 0) return false;
    while ((n = read(fd, &c, 1)) > 0);
    return n == 0;
}

/* A process that a command has left behind ends with it; and with this process all that runs. */
static void nothing_remains(void **state)
{
    (void)state;
    char err[CROP_ERR];
    assert_int_equal(mkfifo("fifo", 0600), 0);
    int fd = open("fifo", O_RDONLY | O_NONBLOCK);
    assert_int_equal(shell("exec 9>fifo; printf x >&9; " LONG " 2>&9 &", NULL, 9, err), 0);
    assert_true(closes(fd));
    close(fd);

    /* The second time the command's parent is stopped, so it must outlive the worker. */
    for (int stops = 0; stops < 2; stops++) {
        fd = open("fifo", O_RDONLY | O_NONBLOCK);
        int held = open("fifo", O_WRONLY | O_CLOEXEC); /* so that the read below waits */
        pid_t pid = fork();
        if (pid == 0) {
            char **words = WORDS("sh", "-c", "exec 9>fifo; " LONG " & echo $PPID >&9; " LONG);
            crop_run(words, &there, NULL, 9, err);
            _exit(0);
        }
        struct pollfd p = {fd, POLLIN, 0};
        assert_int_equal(poll(&p, 1, PATIENCE_S * 1000), 1);
        char keeper[16] = "";
        assert_true(read(fd, keeper, sizeof keeper - 1) > 1);
        close(held);
        pid_t stopped = (pid_t)strtol(keeper, NULL, 10);
        if (stops) assert_int_equal(kill(stopped, SIGSTOP), 0);
        kill(pid, SIGKILL);
        waitpid(pid, NULL, 0);
        if (stops) kill(stopped, SIGCONT);
        assert_true(closes(fd));
        close(fd);
    }
    unlink("fifo");
}

/* ---- limits ---------------------------------------------------------------------------------- */

static bool opens(const char *name, int flags)
{
    int fd = open(name, flags | O_CLOEXEC, 0600);
    if (fd >= 0) close(fd);
    return fd >= 0;
}

/* What a process confined to "own" can do: NULL, or what it could not do and should, or the other
 * way round. Reading is free. */
static const char *confined(int version)
{
    static const char *const own[] = {"own", NULL};
    if (crop_confine(own, version) != 0) return "crop_confine";
    if (!opens("out/file", O_RDONLY)) return "read";
    if (!opens("/dev/null", O_WRONLY)) return "write to /dev/null";
    if (opens("out/file", O_WRONLY)) return "write outside";
    if (version >= 3 && opens("out/file", O_RDONLY | O_TRUNC)) return "open with O_TRUNC outside";
    if (opens("out/new", O_WRONLY | O_CREAT)) return "make a file outside";
    if (version >= 3 && truncate("out/file", 0) == 0) return "truncate outside";
    if (mkdir("out/d", 0700) == 0 || mkfifo("out/f", 0600) == 0) return "make more outside";
    if (symlink("x", "out/l") == 0 || link("out/file", "out/l") == 0) return "link outside";
    if (rename("out/file", "out/x") == 0 || unlink("out/file") == 0) return "remove outside";
    if (rmdir("out/dir") == 0) return "remove a directory outside";
    if (link("out/file", "own/l") == 0) return "link from outside";
    if (!opens("own/new", O_WRONLY | O_CREAT | O_TRUNC)) return "make a file";
    if (truncate("own/new", 0) != 0) return "truncate";
    if (mkdir("own/d", 0700) != 0 || symlink("../out/file", "own/l") != 0) return "make more";
    if (opens("own/l", O_WRONLY)) return "write outside by a link";
#ifdef _GNU_SOURCE
    if (mknod("own/null", S_IFCHR | 0600, makedev(1, 3)) == 0) return "make a device";
#endif
    if ((rename("own/new", "own/d/new") == 0) != (version >= 2)) return "rename across";
    if (rename("own/l", "own/new") != 0 || unlink("own/new") != 0) return "rename and remove";
    return NULL;
}

static void a_process_can_be_confined(void **state)
{
    (void)state;
    const int most = crop_landlock();
    static const char *const own[] = {"own", NULL};
    if (!most) assert_int_equal(crop_confine(own, 1), -1); /* the kernel has no Landlock */
    for (int version = 1; version <= most; version++) {
        assert_int_equal(mkdir("own", 0700) + mkdir("out", 0700) + mkdir("out/dir", 0700), 0);
        assert_true(opens("out/file", O_WRONLY | O_CREAT));
        pid_t pid = fork();
        if (pid == 0) {
            const char *wrong = confined(version);
            if (wrong) dprintf(STDERR_FILENO, "version %d: %s\n", version, wrong);
            _exit(wrong != NULL);
        }
        int status = -1;
        assert_int_equal(waitpid(pid, &status, 0), pid);
        assert_int_equal(status, 0);
        assert_int_equal(crop_remove("own") + crop_remove("out"), 0);
    }
}

/* ---- pictures -------------------------------------------------------------------------------- */

static int draw(const char *line, const struct crop_rect *at, char err[CROP_ERR])
{
    char **words = WORDS("sh", "-c", line);
    const struct crop_command c = {words, dir, dir, NULL, IMAGE_DEEP_REFUSED, false};
    struct image im;
    *err = '\0';
    int result = crop_draw(&c, at, &im, err);
    if (result == 0) image_free(&im);
    return result;
}

#define PGM(w, h) "printf 'P5 " #w " " #h " 255\\n'; head -c $((" #w " * " #h ")) /dev/zero"

static void pictures_have_the_right_size(void **state)
{
    (void)state;
    char err[CROP_ERR];
    assert_int_equal(draw(PGM(6, 2), &rect, err), 0);
    assert_int_equal(draw(PGM(40, 30), &rect, err), 0);
    assert_int_equal(draw(PGM(6, 30), &rect, err), -1);
    assert_string_equal(err, "a picture of 6x30, expected 6x2 or the whole frame, 40x30");
    assert_int_equal(draw(PGM(40, 2), &rect, err), -1);
    assert_int_equal(draw(PGM(2, 6), &rect, err), -1);
    assert_int_equal(draw("echo hello", &rect, err), -1);
    assert_non_null(strstr(err, "the command's standard output: "));
    assert_int_equal(draw("printf 'P5 6 2 511\\n'; head -c 24 /dev/zero", &rect, err), -1);
    assert_non_null(strstr(err, "16 bits that do not state their curve"));
    /* 12 bytes a pixel */
    const struct crop_rect large = {.frame_w = 600, .frame_h = 600, .w = 600, .h = 600};
    assert_int_equal(
        draw("printf 'PF\\n600 600\\n-1.0\\n'; head -c 4320000 /dev/zero", &large, err), 0);
}

/* Of a picture of the frame, all pixels of the rectangle are there. */
static void a_rectangle_of_the_frame(void **state)
{
    (void)state;
    char err[CROP_ERR];
    const char *line = "printf 'P5 40 30 255\\n'; head -c 1200 /dev/zero | tr '\\0' d";
    char **words = WORDS("sh", "-c", line);
    const struct crop_command c = {.words = words, .scratch = dir, .files = dir};
    struct image im;
    assert_int_equal(crop_draw(&c, &rect, &im, err), 0);
    for (uint32_t y = rect.y; y < rect.y + rect.h; y++)
        for (uint32_t x = rect.x; x < rect.x + rect.w; x++)
            assert_true(im.rgba[4 * (y * 40 + x)] == srgb_decode8('d'));
    image_free(&im);
}

#define NAN_AT "printf '\\000\\000\\300\\177'; "

/* Of a picture of the rectangle no pixel may be NaN; of one of the frame, none of the rectangle. */
static void no_pixel_is_nan(void **state)
{
    (void)state;
    static const char *const rows[][2] = {
        /* the last value of the rectangle's first row, of its last row, and the first value */
        {"6 2\\n-1\\n'; head -c 140 /dev/zero; " NAN_AT, "pixel 5,0 is NaN, expected numbers"},
        {"6 2\\n-1\\n'; head -c 68 /dev/zero; " NAN_AT "head -c 72 /dev/zero", "pixel 5,1 is NaN"},
        {"6 2\\n-1\\n'; head -c 72 /dev/zero; " NAN_AT "head -c 68 /dev/zero", "pixel 0,0 is NaN"},
        /* in the frame, at 9,6 and 4,5, at 10,6 and 3,6, and in the rows around */
        {"40 30\\n-1\\n'; head -c 11156 /dev/zero; " NAN_AT "head -c 3240 /dev/zero",
            "pixel 9,6 is NaN"},
        {"40 30\\n-1\\n'; head -c 11568 /dev/zero; " NAN_AT "head -c 2828 /dev/zero",
            "pixel 4,5 is NaN"},
        {"40 30\\n-1\\n'; head -c 11160 /dev/zero; " NAN_AT "head -c 3236 /dev/zero", NULL},
        {"40 30\\n-1\\n'; head -c 11084 /dev/zero; " NAN_AT "head -c 3312 /dev/zero", NULL},
        {"40 30\\n-1\\n'; head -c 10608 /dev/zero; " NAN_AT "head -c 3788 /dev/zero", NULL},
        {"40 30\\n-1\\n'; head -c 12048 /dev/zero; " NAN_AT "head -c 2348 /dev/zero", NULL},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char line[200], err[CROP_ERR];
        snprintf(line, sizeof line, "printf 'PF\\n%s", rows[i][0]);
        assert_int_equal(draw(line, &rect, err), rows[i][1] ? -1 : 0);
        if (rows[i][1]) assert_non_null(strstr(err, rows[i][1]));
    }
}

/* Its file is removed, also if the command fails. */
static void a_picture_in_a_file(void **state)
{
    (void)state;
    char err[CROP_ERR];
    assert_int_equal(draw("{ " PGM(6, 2) "; } >{o}; echo noise", &rect, err), 0);
    assert_int_equal(draw("echo no picture >{o}", &rect, err), -1);
    assert_non_null(strstr(err, "the file {o}: "));
    assert_int_equal(draw("mkfifo {o}", &rect, err), -1);
    assert_non_null(strstr(err, "the file {o}: is no regular file"));
    assert_int_equal(draw("truncate -s 3000000 {o}", &rect, err), -1);
    assert_non_null(strstr(err, "the file {o}: is too long"));
    assert_int_equal(draw("{ " PGM(6, 2) "; } >{o}; exit 1", &rect, err), -1);
    assert_int_equal(chdir("/"), 0);
    assert_int_equal(rmdir(dir), 0); /* it is empty */
    assert_int_equal(mkdir(dir, 0700), 0);
    assert_int_equal(chdir(dir), 0);
}

/* ---- directories ----------------------------------------------------------------------------- */

static void links_are_not_followed(void **state)
{
    (void)state;
    struct stat st;
    assert_int_equal(mkdir("out", 0700), 0);
    assert_int_equal(mkdir("out/kept", 0700), 0);
    assert_int_equal(chmod("out", 0500), 0);
    assert_int_equal(mkdir("in", 0700), 0);
    assert_int_equal(mkdir("in/sub", 0500), 0);
    assert_int_equal(symlink("../out", "in/link"), 0);
    assert_int_equal(symlink("in/sub", "in/loop"), 0);
    assert_int_equal(crop_remove("in"), 0);
    assert_int_equal(lstat("in", &st), -1);
    assert_int_equal(lstat("out", &st), 0);
    assert_int_equal(st.st_mode & 0777, 0500);
    assert_int_equal(chmod("out", 0700), 0);
    assert_int_equal(rmdir("out/kept"), 0);
    assert_int_equal(rmdir("out"), 0);
    errno = 0;
    assert_int_equal(crop_remove("in"), -1);
    assert_int_equal(errno, ENOENT);
}

static void put(const char *path, const char *text, mode_t mode)
{
    unlink(path); /* what was read is not replaced */
    assert_int_equal(outfile_put(path, text, strlen(text)), 0);
    assert_int_equal(chmod(path, mode), 0);
}

static void has(const char *directory, const char *name, const char *text, mode_t mode)
{
    char path[128];
    struct stat st;
    struct buf b = {0};
    snprintf(path, sizeof path, "%s/%s", directory, name);
    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 07777, mode);
    if (!text) return;
    assert_int_equal(read_file(path, &b), 0);
    assert_int_equal(buf_size(&b), strlen(text));
    assert_memory_equal(buf_data(&b), text, strlen(text));
    buf_free(&b);
}

/* A copy has the files and what is executable, for the user alone, and no links. */
static void a_copy_is_separate(void **state)
{
    (void)state;
    char name[64];
    static char large[300000];
    memset(large, 'x', sizeof large - 1);
    assert_int_equal(mkdir("files", 0700), 0);
    assert_int_equal(mkdir("files/sub", 0755), 0);
    put("files/plain", "text", 0444);
    put("files/sub/runs", large, 06755);
    put("files/empty", "", 0600);
    assert_int_equal(symlink("plain", "files/link"), 0);
    char *copy = crop_copy("./files");
    snprintf(name, sizeof name, "./files-%ld", (long)getpid());
    assert_string_equal(copy, name);
    has(copy, "plain", "text", 0600);
    has(copy, "sub", NULL, 0700);
    has(copy, "sub/runs", large, 0700);
    has(copy, "empty", "", 0600);
    snprintf(name, sizeof name, "./files-%ld/link", (long)getpid());
    struct stat st;
    assert_int_equal(lstat(name, &st), -1);
    snprintf(name, sizeof name, "./files-%ld/plain", (long)getpid());
    put(name, "changed", 0600);
    has("files", "plain", "text", 0444);

    /* It is there: a second one ends the program. */
    pid_t pid = fork();
    if (pid == 0) {
        close(STDERR_FILENO);
        snprintf(name, sizeof name, "files-%ld", (long)getpid());
        mkdir(name, 0700);
        crop_copy("files");
        _exit(0);
    }
    int status;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == ST_SYSTEM);

    /* The copies of all processes are removed, and nothing else. */
    static const char *const others[] = {"file-1", "files1", "files.1-1", "other-1"};
    for (int i = 0; i < 4; i++) assert_int_equal(mkdir(others[i], 0700), 0);
    assert_int_equal(mkdir("files-1", 0500), 0);
    crop_remove_copies("./files");
    assert_int_equal(access(copy, F_OK), -1);
    assert_int_equal(access("files-1", F_OK), -1);
    for (int i = 0; i < 4; i++) assert_int_equal(rmdir(others[i]), 0);
    assert_int_equal(crop_remove("files"), 0);
    free(copy);
}

/* A process that has made a directory is killed with its whole group: the directory goes too. */
static void a_directory_ends_with_its_process(void **state)
{
    (void)state;
    static const char *const places[] = {dir, "relative"};
    for (int k = 0; k < 2; k++) {
        int p[2];
        char name[4096];
        assert_int_equal(pipe(p), 0);
        pid_t pid = fork();
        if (pid == 0) {
            setpgid(0, 0);
            setenv("TMPDIR", places[k], 1);
            const char *made = crop_directory();
            char sub[5000];
            snprintf(sub, sizeof sub, "%s/sub", made);
            mkdir(sub, 0500);
            (void)!write(p[1], made, strlen(made));
            pause();
            _exit(0);
        }
        close(p[1]);
        ssize_t n = read(p[0], name, sizeof name - 1);
        assert_true(n > 0);
        name[n] = '\0';
        assert_memory_equal(name, k ? "/tmp/stormring-" : dir, k ? 15 : strlen(dir));
        assert_int_equal(access(name, F_OK), 0);
        assert_int_equal(kill(-pid, SIGKILL), 0);
        assert_int_equal(waitpid(pid, NULL, 0), pid);
        for (int i = 0; i < PATIENCE_S * 100 && access(name, F_OK) == 0; i++) poll(NULL, 0, 10);
        assert_int_equal(access(name, F_OK), -1);
        close(p[0]);
    }
}

static void too_long(int sig)
{
    (void)sig;
    fail_msg("the test has not ended after %d s", PATIENCE_S);
}

static int limited(void **state)
{
    (void)state;
    signal(SIGALRM, too_long);
    alarm(PATIENCE_S);
    return 0;
}

static int make_dir(void **state)
{
    (void)state;
    return !scratch_make(dir) || chdir(dir) != 0;
}

static int remove_dir(void **state)
{
    (void)state;
    return crop_remove(dir);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_replace_words),
        cmocka_unit_test(words_that_are_used),
        cmocka_unit_test(a_hash_of_words),
        cmocka_unit_test(a_rectangle_has_all_pixels),
        cmocka_unit_test_setup(output_is_kept_or_dropped, limited),
        cmocka_unit_test_setup(failures_have_a_reason, limited),
        cmocka_unit_test_setup(nothing_remains, limited),
        cmocka_unit_test(a_process_can_be_confined),
        cmocka_unit_test_setup(pictures_have_the_right_size, limited),
        cmocka_unit_test_setup(a_rectangle_of_the_frame, limited),
        cmocka_unit_test_setup(no_pixel_is_nan, limited),
        cmocka_unit_test_setup(a_picture_in_a_file, limited),
        cmocka_unit_test(links_are_not_followed),
        cmocka_unit_test_setup(a_copy_is_separate, limited),
        cmocka_unit_test_setup(a_directory_ends_with_its_process, limited),
    };
    return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
