/*
 * worker_states: the state of a renderer by generation, without a stream. The parts are texts: a
 * value counts how often it was read and freed, and so does what is built of them. So a value that
 * is freed twice, too early or never is seen.
 */
#include "worker/worker.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#define W 4
#define H 3

struct text {
    char s[16];
};
struct built {
    char s[2 * sizeof(struct text)];
    uint32_t w, h;
};

static int parts, builts, reads, builds; /* parts and builts: alive */

static int text_of(const void *options, const char *name, unsigned char *bytes, size_t n,
    void *value, char err[WORKER_ERR])
{
    struct text *t = value;
    assert_ptr_equal(options, &builds);
    assert_int_equal(t->s[0], 0);
    reads++;
    if (!n || bytes[0] == '?') {
        err_set(err, "%s: is wrong", name);
        return -1;
    }
    memcpy(t->s, bytes, n);
    parts++;
    return 0;
}

static void free_text(void *value)
{
    assert_string_not_equal(((struct text *)value)->s, "freed");
    memcpy(((struct text *)value)->s, "freed", 6);
    parts--;
}

static double needs(const unsigned char *start, size_t n, size_t bytes)
{
    return start && n ? (double)bytes + start[0] : 0;
}

static void *build(const void *options, void *const value[])
{
    struct built *b = xcalloc(1, sizeof *b);
    const struct text *grid = value[0], *spec = value[1];
    assert_ptr_equal(options, &builds);
    snprintf(b->s, sizeof b->s, "%s+%s", grid->s, spec->s);
    builds++;
    builts++;
    return b;
}

static void free_built(void *built)
{
    free(built);
    builts--;
}

static void frame(void *built, uint32_t w, uint32_t h)
{
    struct built *b = built;
    b->w = w;
    b->h = h;
}

/* The first letter of the grid and of the specification, and the size. */
static void render(void *built, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    const struct built *b = built;
    assert_true(at->x == 0 && n0 == 0 && n == 1);
    rgba[0] = (float)b->s[0];
    rgba[1] = (float)strchr(b->s, '+')[1];
    rgba[2] = (float)b->w;
    rgba[3] = (float)b->h;
}

static void selftest(float *rgba, uint32_t *n)
{
    assert_true(*n > 1);
    *n = 1;
    rgba[0] = 7;
}

static const struct worker_renderer renderer = {
    .program = "texts",
    .part = {{REC_GRID, false, sizeof(struct text), text_of, free_text, needs},
        {REC_SPEC, false, sizeof(struct text), text_of, free_text, NULL}},
    .n_parts = 2,
    .build = build,
    .free = free_built,
    .frame = frame,
    .render = render,
    .selftest = selftest,
};
static const struct worker_words words = {"texts 1", "texts,-x"};

static struct worker_states *begin(void)
{
    parts = builts = reads = builds = 0;
    return worker_states_new(&renderer, &builds, &words);
}

static void end(struct worker_states *s)
{
    worker_states_free(s);
    assert_int_equal(parts, 0);
    assert_int_equal(builts, 0);
}

static int take(struct worker_states *s, uint32_t generation, enum rec_kind kind, const char *text,
    char err[WORKER_ERR])
{
    struct buf b = {0};
    buf_append(&b, text, strlen(text));
    int failed = worker_states_ops(s).state(s, generation, kind, b.data, buf_size(&b), err);
    buf_free(&b); /* nothing points there */
    return failed;
}

static void give(struct worker_states *s, uint32_t generation, enum rec_kind kind, const char *text)
{
    char err[WORKER_ERR] = "";
    if (take(s, generation, kind, text, err) != 0) fail_msg("%s", err);
}

static void refuses(struct worker_states *s, uint32_t generation, enum rec_kind kind,
    const char *text, const char *why)
{
    char err[WORKER_ERR] = "";
    assert_int_equal(take(s, generation, kind, text, err), -1);
    assert_string_equal(err, why);
}

static void drop(struct worker_states *s, uint32_t generation)
{
    worker_states_ops(s).drop(s, generation);
}

struct job {
    char text[WIRE_JOB];
};

/* A task of this generation is rendered from these two. Returns its job. */
static struct job renders(struct worker_states *s, uint32_t generation, const char *letters)
{
    char err[WORKER_ERR] = "";
    float rgba[4];
    struct worker_ops ops = worker_states_ops(s);
    const struct frame_size f = {.generation = generation, .w = W, .h = H};
    if (ops.ready(s, &f, err) != 0) fail_msg("%s", err);
    ops.render(s, &(struct lattice){0, 0, 1, 1, 1, 1}, 0, 1, rgba);
    assert_true(rgba[0] == (float)letters[0] && rgba[1] == (float)letters[1]);
    assert_true(rgba[2] == W && rgba[3] == H);
    struct job job;
    ops.job(s, job.text);
    return job;
}

static void lacks(struct worker_states *s, uint32_t generation, const char *why)
{
    char err[WORKER_ERR] = "";
    const struct frame_size f = {.generation = generation, .w = W, .h = H};
    assert_int_equal(worker_states_ops(s).ready(s, &f, err), -1);
    assert_string_equal(err, why);
}

/* A lost task is rendered again after later state has come. Generations share what was not
 * replaced, and it is freed with the last of them. */
static void test_generations(void **state)
{
    (void)state;
    struct worker_states *s = begin();
    give(s, 0, REC_GRID, "a");
    give(s, 0, REC_SPEC, "x");
    struct job first = renders(s, 0, "ax");
    give(s, 1, REC_SPEC, "y");
    struct job second = renders(s, 1, "ay");
    assert_string_not_equal(first.text, second.text);
    assert_string_equal(renders(s, 0, "ax").text, first.text);
    assert_int_equal(builds, 2);
    assert_int_equal(parts, 3);
    give(s, 2, REC_GRID, "b");
    renders(s, 2, "by");
    assert_string_equal(renders(s, 1, "ay").text, second.text);
    drop(s, 0);
    assert_int_equal(parts, 3); /* a is shared by 1 */
    assert_int_equal(builts, 2);
    assert_string_equal(renders(s, 1, "ay").text, second.text);
    drop(s, 1);
    assert_int_equal(parts, 2);
    renders(s, 2, "by");
    lacks(s, 1, "no grid, expected a `grid` record before the first task");
    drop(s, 1);
    assert_int_equal(builds, 3);
    end(s);
}

/* Within a generation a record replaces the one of its kind, which is freed before the new one is
 * read; what was built from it goes too. */
static int at_most;
static int read_alone(const void *options, const char *name, unsigned char *bytes, size_t n,
    void *value, char err[WORKER_ERR])
{
    assert_true(parts <= at_most && builts == 0);
    return text_of(options, name, bytes, n, value, err);
}

static void test_replaced(void **state)
{
    (void)state;
    struct worker_renderer alone = renderer;
    alone.part[0].read = read_alone;
    parts = builts = reads = builds = 0;
    struct worker_states *s = worker_states_new(&alone, &builds, &words);
    at_most = 0;
    give(s, 0, REC_GRID, "a");
    give(s, 0, REC_GRID, "b");
    give(s, 0, REC_SPEC, "x");
    renders(s, 0, "bx");
    renders(s, 0, "bx");
    assert_int_equal(builds, 1);
    at_most = 1;
    give(s, 0, REC_GRID, "c");
    renders(s, 0, "cx");
    assert_int_equal(builds, 2);
    assert_int_equal(parts, 2);
    end(s);
}

/* A part that does not fit is refused with all generations that share it, until one replaces it. */
static void test_unfit(void **state)
{
    (void)state;
    struct worker_states *s = begin();
    char err[WORKER_ERR] = "out of memory";
    const struct worker_ops ops = worker_states_ops(s);
    const unsigned char start[] = "!";
    give(s, 0, REC_GRID, "a");
    give(s, 0, REC_SPEC, "x");
    assert_int_equal(ops.state(s, 1, REC_GRID, NULL, 9, err), 0);
    give(s, 2, REC_SPEC, "y");
    for (uint32_t g = 1; g < 3; g++) {
        const struct frame_size f = {.generation = g, .w = W, .h = H};
        memset(err, 0, sizeof err);
        assert_int_equal(ops.ready(s, &f, err), WORKER_REFUSED);
        assert_string_equal(err, "grid: out of memory");
    }
    renders(s, 0, "ax");
    drop(s, 0);
    assert_int_equal(parts, 2); /* x and y */
    give(s, 3, REC_GRID, "b");
    renders(s, 3, "by");
    assert_true(ops.needs(s, REC_GRID, start, 1, 9) == 9 + '!');
    assert_true(
        ops.needs(s, REC_GRID, NULL, 0, 9) == 0 && ops.needs(s, REC_SPEC, start, 1, 9) == 0);
    end(s);
}

/* After GENERATIONS the places are used again, even if no drop came. */
static void test_many(void **state)
{
    (void)state;
    struct worker_states *s = begin();
    char text[2] = "a";
    give(s, 0, REC_SPEC, "x");
    for (uint32_t i = 0; i < 3 * GENERATIONS; i++) {
        text[0] = (char)('a' + i % 26);
        give(s, i, REC_GRID, text);
        renders(s, i, (char[]){text[0], 'x', 0});
        assert_int_equal(parts, 1 + (i < GENERATIONS ? i + 1 : GENERATIONS));
    }
    text[0] = (char)('a' + (2 * GENERATIONS) % 26);
    renders(s, 2 * GENERATIONS, (char[]){text[0], 'x', 0});
    end(s);
}

static void test_refused(void **state)
{
    (void)state;
    struct worker_states *s = begin();
    lacks(s, 0, "no grid, expected a `grid` record before the first task");
    give(s, 0, REC_GRID, "a");
    lacks(s, 0, "no spec, expected a `spec` record before the first task");
    refuses(s, 0, REC_SCENE, "a", "record `scene`, expected `grid` or `spec`");
    refuses(s, 0, REC_SPEC, "?", "spec: is wrong");
    refuses(s, 0, REC_GRID, "?", "grid: is wrong");
    assert_int_equal(parts, 0); /* the wrong one replaced the good one */
    assert_int_equal(reads, 3);
    end(s);
}

static void with_file(const char *text, struct worker_states *s, int k)
{
    char path[] = "/tmp/test_worker.XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0 && write_full(fd, text, strlen(text)) == 0);
    close(fd);
    worker_states_load(s, k, path);
    unlink(path);
}

static struct job file_job(const struct worker_states *s, uint32_t w, uint32_t h)
{
    struct job job;
    worker_states_job(s, w, h, job.text);
    return job;
}

/* A file is the same state as a record, and has the same job. */
static void test_files(void **state)
{
    (void)state;
    struct worker_states *records = begin();
    give(records, 0, REC_GRID, "a");
    give(records, 0, REC_SPEC, "x");
    struct job job = renders(records, 0, "ax");
    end(records);
    struct worker_states *s = begin();
    with_file("a", s, 0);
    refuses(s, 0, REC_GRID, "b", "record `grid`, expected `spec`");
    give(s, 0, REC_SPEC, "x");
    assert_string_equal(renders(s, 0, "ax").text, job.text);
    give(s, 1, REC_SPEC, "y");
    renders(s, 1, "ay");
    drop(s, 0);
    assert_int_equal(parts, 2);
    end(s);
    s = begin();
    with_file("a", s, 0);
    with_file("y", s, 1);
    with_file("x", s, 1);
    refuses(s, 0, REC_SPEC, "y",
        "record `spec`, expected no state records, because all state is in files");
    assert_string_equal(((const struct text *)worker_states_value(s, 0))->s, "a");
    assert_string_equal(((const struct text *)worker_states_value(s, 1))->s, "x");
    assert_string_equal(file_job(s, W, H).text, job.text);
    assert_int_equal(builds, 0);
    assert_string_equal(((struct built *)worker_states_built(s, W, H))->s, "a+x");
    end(s);
}

/* The job is a hash of the options' words, of all parts and of the size; in this form, or logs of
 * earlier runs could not be resumed. */
static struct job job_of(const void *grid, size_t n, const char *spec)
{
    char text[200], hash[2][SHA256_TEXT];
    struct job job;
    sha256(grid, n, hash[0]);
    sha256(spec, strlen(spec), hash[1]);
    int len = snprintf(text, sizeof text, "texts 1 %dx%d grid=%s spec=%s", W, H, hash[0], hash[1]);
    sha256(text, (size_t)len, hash[0]);
    snprintf(job.text, sizeof job.text, "%.32s", hash[0]);
    return job;
}

static void test_job(void **state)
{
    (void)state;
    struct worker_states *s = begin();
    with_file("a", s, 0);
    with_file("x", s, 1);
    struct job job = file_job(s, W, H);
    assert_string_equal(job.text, job_of("a", 1, "x").text);
    assert_string_not_equal(job.text, file_job(s, H, W).text);
    assert_string_equal(renders(s, 0, "ax").text, job.text);
    assert_string_equal(worker_states_ops(s).with(s), "texts,-x");
    assert_string_equal(worker_states_ops(s).program, "texts");
    end(s);
    s = begin();
    with_file("x", s, 0);
    with_file("a", s, 1);
    assert_string_not_equal(file_job(s, W, H).text, job.text);
    float rgba[8];
    uint32_t room = 2;
    worker_states_ops(s).selftest(s, rgba, &room);
    assert_true(room == 1 && rgba[0] == 7);
    end(s);
}

/* A file that changes after it was read: its job and its value are those of the old bytes. */
static char changed[] = "/tmp/test_worker.XXXXXX";
static bool truncated;
static int read_changed(const void *options, const char *name, unsigned char *bytes, size_t n,
    void *value, char err[WORKER_ERR])
{
    int fd = open(changed, O_WRONLY | (truncated ? O_TRUNC : 0));
    assert_true(fd >= 0);
    for (size_t i = 0; i < n && !truncated; i += 8) assert_int_equal(write(fd, "new new ", 8), 8);
    close(fd);
    for (size_t i = 0; i < n; i++) assert_int_equal(bytes[i], "old "[i % 4]);
    return text_of(options, name, bytes, 4, value, err);
}

static void test_changed_file(void **state)
{
    (void)state;
    struct worker_renderer changes = renderer;
    changes.part[0].read = read_changed;
    struct buf old = {0};
    for (int i = 0; i < 1 << 16; i++) buf_append(&old, "old ", 4);
    parts = builts = reads = builds = 0;
    close(mkstemp(changed));
    for (int i = 0; i < 2; i++) {
        truncated = i;
        unlink(changed); /* what was read is not replaced */
        assert_int_equal(outfile_put(changed, old.data, old.len), 0);
        struct worker_states *s = worker_states_new(&changes, &builds, &words);
        worker_states_load(s, 0, changed);
        with_file("x", s, 1);
        assert_string_equal(file_job(s, W, H).text, job_of(old.data, old.len, "x").text);
        struct buf new = {0};
        assert_int_equal(read_file(changed, &new), 0);
        assert_true(truncated ? !new.len : new.len == old.len &&new.data[0] == 'n');
        buf_free(&new);
        end(s);
    }
    unlink(changed);
    buf_free(&old);
}

/* Adds runs until the power is known, or all are added. Returns the number that was needed. */
static int power_of(struct worker_power *p, int n, const int64_t us[][2])
{
    *p = (struct worker_power){0};
    int i = 0;
    while (i < n && !(i && worker_power_known(p))) {
        worker_power_add(p, us[i][0], us[i][1]);
        i++;
    }
    return i;
}

static void test_power(void **state)
{
    (void)state;
    const double all = (double)INFINITY;
    struct worker_power p;
    /* The first run loads pages. The processor is taken away in the third. */
    static const int64_t busy[][2] = {
        {1700, 1700}, {550, 560}, {600, 9440}, {500, 500}, {500, 500}, {500, 500}, {1, 1}};
    assert_int_equal(power_of(&p, 7, busy), 6); /* 4350 us of CPU time, and not yet 20 ms */
    assert_true(worker_power_best(&p, all) == 4 && worker_power_best(&p, 8) == 4);
    assert_true(fabs(worker_power_least(&p, all) - 2000. / 2300) < 1e-9);
    /* A quota of a quarter of a processor is not seen in a short test. */
    assert_true(worker_power_best(&p, .25) == 1);
    static const int64_t calm[][2] = {{700, 700}, {500, 500}, {500, 500}, {500, 500}, {500, 500},
        {500, 500}, {500, 500}, {500, 500}, {1, 1}};
    assert_int_equal(power_of(&p, 9, calm), 8);
    assert_true(worker_power_least(&p, all) == 4 && worker_power_least(&p, .25) == 1);
    /* It takes its time where others take the processor, or the machine is slow. */
    static const int64_t crowded[][2] = {{900, 9000}, {600, 12000}, {700, 700}, {1, 1}};
    assert_int_equal(power_of(&p, 4, crowded), 3);
    static const int64_t slow[][2] = {{40000, 50000}, {1, 1}};
    assert_int_equal(power_of(&p, 2, slow), 1);
    assert_true(worker_power_best(&p, all) == .05 && worker_power_least(&p, all) == .04);
    /* A clock that counts in ticks of 4 ms. */
    static const int64_t ticks[][2] = {{0, 900}, {4000, 800}, {0, 1000}, {0, 900}, {0, 800}};
    power_of(&p, 5, ticks);
    assert_true(worker_power_best(&p, all) == 2.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_power),
        cmocka_unit_test(test_generations),
        cmocka_unit_test(test_replaced),
        cmocka_unit_test(test_unfit),
        cmocka_unit_test(test_many),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_job),
        cmocka_unit_test(test_changed_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
