/*
 * The worker whose children render: which slot does a task, what happens when a child is lost, or
 * cannot be forked. The worker runs in a process of its own, between two pipes.
 */
#include "worker/worker.h"

#include <setjmp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#define SLOTS 4
#define TASKS 12
#define W 8 /* of the frame; a task is a row */

/* ---- a renderer whose pixels are their numbers -------------------------------------------------
 */

static int dies;                               /* the task that kills its child, once; -1: none */
static char died[] = "/tmp/test_forks.XXXXXX"; /* exists until it has */

static int state(void *ctx, uint32_t generation, enum rec_kind kind, unsigned char *body, size_t n,
    char err[WORKER_ERR])
{
    (void)ctx, (void)generation, (void)kind, (void)body, (void)n, (void)err;
    return 0;
}

static int ready(void *ctx, const struct frame_size *f, char err[WORKER_ERR])
{
    (void)ctx, (void)f, (void)err;
    return 0;
}

static void job(void *ctx, char text[WIRE_JOB])
{
    (void)ctx;
    snprintf(text, WIRE_JOB, "7");
}

static const char *with(void *ctx)
{
    (void)ctx;
    return "test";
}

static void render(void *ctx, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    (void)ctx;
    if ((int)at->y == dies && n0 + at->x > 0 && unlink(died) == 0) raise(SIGKILL);
    for (uint32_t i = 0; i < 4 * n; i++)
        rgba[i] = i % 4 < 3 ? (float)(at->y * W + at->x + n0 + i / 4) : 1;
}

static void selftest(void *ctx, float *rgba, uint32_t *n)
{
    (void)ctx;
    *n = 1;
    memset(rgba, 0, 4 * sizeof *rgba);
}

static const struct worker_ops ops = {
    .program = "test",
    .state = state,
    .ready = ready,
    .job = job,
    .with = with,
    .render = render,
    .selftest = selftest,
};

/* ---- a run -------------------------------------------------------------------------------------
 */

struct run {
    struct worker_options options;
    int files;  /* limit of open files; 0: as it is */
    int copies; /* a task goes to this number of slots, from its own number on */
    bool any;   /* tasks are for any slot */
    /* its outcome */
    int status;
    int done[SLOTS][TASKS], pixels[SLOTS][TASKS];
};

static pid_t start(const struct run *r, int to[2], int from[2])
{
    assert_true(pipe(to) == 0 && pipe(from) == 0);
    pid_t pid = fork();
    if (pid) return pid;
    alarm(1200);
    dup2(to[0], 0);
    dup2(from[1], 1);
    for (int fd = 3; fd < 64; fd++) close(fd);
    if (r->files) setrlimit(RLIMIT_NOFILE, &(struct rlimit){(rlim_t)r->files, (rlim_t)r->files});
    exit(worker_run(&ops, &r->options, NULL));
}

static void send(const struct run *r, int fd)
{
    struct buf b = {0};
    wire_state(&b, REC_SCENE, "x", 1);
    wire_frame(&b, 0, W, TASKS, "");
    for (uint32_t i = 0; i < TASKS; i++)
        for (int k = 0; k < r->copies; k++) {
            struct task t = {.id = i, .at = {0, i, W, 1, 1, 1}};
            t.to = r->any ? -1 : (int32_t)((i + (uint32_t)k) % SLOTS);
            wire_task(&b, &t);
        }
    assert_int_equal(write_full(fd, b.data, b.len), 0);
    buf_free(&b);
}

static void note(struct run *r, const struct record *rec)
{
    int32_t slot = rec_slot(rec);
    assert_int_not_equal(rec->kind, REC_FAIL);
    if (rec->kind != REC_DONE && rec->kind != REC_FRAG) return;
    assert_in_range(slot, 0, SLOTS - 1);
    assert_in_range(rec->task.id, 0, TASKS - 1);
    if (rec->kind == REC_DONE) r->done[slot][rec->task.id]++;
    if (rec->kind != REC_FRAG) return;
    float rgba[4 * W];
    uint32_t n = (uint32_t)lattice_count(&rec->task.at);
    assert_in_range(n, 1, W);
    wire_pixels(rec->body, n, rgba);
    for (uint32_t i = 0; i < n; i++)
        assert_true(rgba[4 * i] == (float)(rec->task.id * W + rec->task.at.x + i));
    r->pixels[slot][rec->task.id] += (int)n;
}

static int total(int n[SLOTS][TASKS])
{
    int sum = 0;
    for (int k = 0; k < SLOTS; k++)
        for (int i = 0; i < TASKS; i++) sum += n[k][i];
    return sum;
}

/* Each slot is asked for the pixels that it holds. */
static void flush(int fd)
{
    struct buf b = {0};
    for (int k = 0; k < SLOTS; k++) buf_printf(&b, "flush to=%d\n", k);
    assert_int_equal(write_full(fd, b.data, b.len), 0);
    buf_free(&b);
}

/* The input ends when all tasks are done and their pixels are here: the worker must not need its
 * end. */
static void run(struct run *r)
{
    int to[2], from[2];
    pid_t pid = start(r, to, from);
    close(to[0]);
    close(from[1]);
    send(r, to[1]);
    struct decoder d = {.upward = true};
    struct record rec;
    bool open = true, flushed = false;
    const int tasks = TASKS * r->copies;
    while (read_some(from[0], &d.in, 4096) > 0) {
        while (wire_next(&d, &rec) == WIRE_RECORD) note(r, &rec);
        if (r->options.concentrate && !flushed && total(r->done) >= tasks) {
            flush(to[1]);
            flushed = true;
        }
        if (open && total(r->done) >= tasks && total(r->pixels) >= W * tasks) {
            close(to[1]);
            open = false;
        }
    }
    if (open) close(to[1]);
    close(from[0]);
    wire_free(&d);
    assert_true(waitpid(pid, &r->status, 0) == pid && WIFEXITED(r->status));
    r->status = WEXITSTATUS(r->status);
}

/* Each task was done once by each slot that it is for, with all of its pixels. */
static void check(const struct run *r)
{
    assert_int_equal(r->status, ST_OK);
    for (int i = 0; i < TASKS; i++)
        for (int k = 0; k < SLOTS; k++) {
            bool its = (k - i % SLOTS + SLOTS) % SLOTS < r->copies;
            assert_int_equal(r->done[k][i], its);
            assert_int_equal(r->pixels[k][i], its ? W : 0);
        }
}

static struct run usual(void)
{
    dies = -1;
    return (struct run){.options = {.jobs = SLOTS}, .copies = 1};
}

/* ---- tests -------------------------------------------------------------------------------------
 */

static void test_slots(void **ctx)
{
    (void)ctx;
    for (int copies = 1; copies <= SLOTS; copies++) {
        struct run r = usual();
        r.copies = copies;
        run(&r);
        check(&r);
    }
}

static void test_any_slot(void **ctx)
{
    (void)ctx;
    struct run r = usual();
    r.any = true;
    run(&r);
    assert_int_equal(r.status, ST_OK);
    for (int i = 0; i < TASKS; i++) {
        int done = 0, pixels = 0;
        for (int k = 0; k < SLOTS; k++) done += r.done[k][i], pixels += r.pixels[k][i];
        assert_true(done == 1 && pixels == W);
    }
}

static void test_lost_child(void **ctx)
{
    (void)ctx;
    for (int concentrate = 0; concentrate < 2; concentrate++) {
        close(mkstemp(died));
        struct run r = usual();
        dies = 9;
        r.options.frag_pixels = 2; /* it has sent two pixels of task 9 */
        r.options.concentrate = concentrate;
        run(&r);
        check(&r);
        assert_int_equal(access(died, F_OK), -1);
        memcpy(died + sizeof died - 7, "XXXXXX", 6);
    }
}

/* Files for one to four children. */
static void test_few_files(void **ctx)
{
    (void)ctx;
    for (int files = 11; files <= 15; files++)
        for (int copies = 1; copies <= 3; copies++)
            for (int concentrate = 0; concentrate < 2; concentrate++) {
                struct run r = usual();
                r.files = files;
                r.copies = copies;
                r.options.concentrate = concentrate;
                run(&r);
                check(&r);
            }
}

static void test_no_files(void **ctx)
{
    (void)ctx;
    struct run r = usual();
    r.files = 6;
    run(&r);
    assert_int_equal(r.status, ST_SYSTEM);
    assert_int_equal(total(r.done), 0);
}

int main(void)
{
    signal(SIGPIPE, SIG_IGN);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slots),
        cmocka_unit_test(test_any_slot),
        cmocka_unit_test(test_lost_child),
        cmocka_unit_test(test_few_files),
        cmocka_unit_test(test_no_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
