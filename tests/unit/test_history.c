/* What a log tells: runs, slots, whose pixels counted; and pixels found again. */
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "history/history.h"

#define JOB "0123456789abcdef"

static void line(struct buf *b, const char *text)
{
    size_t at = buf_size(b);
    buf_printf(b, "%s", text);
    wire_seal(b, at);
}

static void frag_of(
    const char *job, struct buf *b, uint32_t id, struct lattice at, int w, float value)
{
    float rgba[4 * 64];
    struct task t = {.id = id, .at = at, .to = -1};
    struct buf one = {0};
    for (uint64_t i = 0; i < 4 * lattice_count(&at); i++)
        rgba[i] = i % 4 == 3 ? 1 : value + (float)i;
    wire_frag(&one, &t, &at, job, rgba);
    struct decoder d = wire_over(one.data, one.len);
    struct record r;
    char stamp[16];
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    snprintf(stamp, sizeof stamp, "w=%d", w);
    wire_forward(b, &r, NULL, stamp);
    buf_free(&one);
}

static void frag(struct buf *b, uint32_t id, struct lattice at, int w, float value)
{
    frag_of(JOB, b, id, at, w, value);
}

/* Of slot w, or w.inner. */
static void done(struct buf *b, uint32_t id, int w, int inner)
{
    char text[80], behind[24] = "";
    if (inner) snprintf(behind, sizeof behind, ".%d", inner);
    snprintf(text, sizeof text, "done 0 %u cpu_us=1 w=%d%s", id, w, behind);
    line(b, text);
}

static struct lattice row(uint32_t y) { return (struct lattice){0, y, 8, 1, 1, 1}; }

/* Through a pipe, as any log that is read. */
static struct history read_log(const struct buf *b)
{
    struct history l = {0};
    int p[2];
    assert_int_equal(pipe(p), 0);
    assert_int_equal(write_full(p[1], buf_data(b), buf_size(b)), 0);
    close(p[1]);
    assert_int_equal(history_read(&l, p[0]), 0);
    close(p[0]);
    return l;
}

static void the_first_pixels_count(void **state)
{
    (void)state;
    struct buf b = {0};
    line(&b, "hello deal 0.1 format=4 selftest=1 slots=3");
    line(&b, "frame 0 8 4 job=" JOB " with=rtworker w=0");
    line(&b, "frame 0 8 4 job=" JOB " w=1");
    line(&b, "done 0 0 cpu_us=10 wall_us=11 w=0 recv_us=100");
    line(&b, "done 0 0 cpu_us=20 wall_us=21 w=1 recv_us=110 try=2");
    frag(&b, 0, row(0), 1, 1);
    frag(&b, 0, row(0), 0, 1);
    line(&b, "done 0 1 cpu_us=5 w=0 recv_us=120");
    struct history l = read_log(&b);
    assert_int_equal(l.n_runs, 1);
    assert_int_equal(l.runs[0].slots, 3);
    assert_int_equal(l.n_slots, 2);
    assert_int_equal(l.n_dones, 3);
    assert_true(history_wasted(&l, &l.dones[0]));
    assert_false(history_wasted(&l, &l.dones[1]));
    assert_true(history_wasted(&l, &l.dones[2])); /* its pixels never came */
    assert_int_equal(l.dones[1].try, 2);
    assert_int_equal(l.dones[0].sent, 8);
    assert_int_equal(l.dones[0].pixels, 0);
    assert_int_equal(l.dones[2].wall_us, 5);
    assert_int_equal(l.n_frags, 2);
    assert_string_equal(history_frame_of(&l, 0)->with, "rtworker");
    assert_null(history_frame_of(&l, 1));
    history_free(&l);
    buf_free(&b);
}

static void a_hello_begins_a_run(void **state)
{
    (void)state;
    struct buf b = {0};
    line(&b, "hello deal 0.1 format=4 selftest=1 slots=2"); /* nothing came of this one */
    line(&b, "hello deal 0.1 format=4 selftest=1 slots=2");
    line(&b, "done 0 0 cpu_us=1 w=0");
    line(&b, "done 0 1 cpu_us=1 w=0");
    line(&b, "hello fan 0.1 format=4 selftest=1 slots=5");
    line(&b, "done 0 1 cpu_us=1 w=0");
    line(&b, "hello fan 0.1 format=4 selftest=1 slots=9");
    struct history l = read_log(&b);
    assert_int_equal(l.n_runs, 2);
    assert_int_equal(l.runs[0].slots, 2);
    assert_int_equal(l.runs[1].slots, 5);
    assert_int_equal(l.dones[1].run, 0);
    assert_int_equal(l.dones[2].run, 1);
    assert_false(history_wasted(&l, &l.dones[1])); /* no pixels at all: the first of a key */
    assert_true(history_wasted(&l, &l.dones[2]));
    history_free(&l);
    buf_free(&b);
}

static void another_job_is_nobodys(void **state)
{
    (void)state;
    struct buf b = {0};
    line(&b, "frame 0 8 4 job=" JOB " w=0");
    line(&b, "frame 0 8 4 job=fedcba9876543210 w=1");
    line(&b, "done 0 0 cpu_us=1 w=1");
    line(&b, "done 0 1 cpu_us=1 w=0");
    frag_of("fedcba9876543210", &b, 0, row(0), 1, 1);
    frag(&b, 1, row(0), 0, 2);
    line(&b, "frame 0 8 4 job=" JOB " w=1");
    line(&b, "done 0 2 cpu_us=1 w=1");
    frag(&b, 2, row(1), 1, 2);
    struct history l = read_log(&b);
    assert_true(history_wasted(&l, &l.dones[0]));
    assert_false(history_wasted(&l, &l.dones[1]));
    assert_false(history_wasted(&l, &l.dones[2]));
    history_free(&l);
    buf_free(&b);
}

static void logs_of_other_pixels_are_not_the_same(void **state)
{
    (void)state;
    struct buf b = {0};
    line(&b, "frame 0 8 4 job=" JOB " w=0");
    line(&b, "done 0 0 cpu_us=1 w=0");
    frag(&b, 0, (struct lattice){0, 0, 8, 2, 1, 1}, 0, 1); /* two rows of one task */
    struct history whole = read_log(&b);
    assert_int_equal(whole.dones[0].pixels, 16);
    line(&b, "done 0 1 cpu_us=1 w=0");
    line(&b, "done 0 2 cpu_us=1 w=0");
    frag(&b, 1, (struct lattice){0, 2, 4, 1, 2, 1}, 0, 1);
    frag(&b, 2, (struct lattice){1, 2, 4, 1, 2, 1}, 0, 1);
    struct history split = read_log(&b);
    assert_int_equal(split.dones[2].pixels, 4);
    char err[HISTORY_ERR];
    assert_false(history_same(&whole, &split, err));
    assert_non_null(strstr(err, "16 pixels, expected 24"));
    assert_true(history_same(&split, &split, err));
    history_free(&whole);
    history_free(&split);
    buf_free(&b);
}

static void pixels_are_found_again(void **state)
{
    (void)state;
    struct buf b = {0};
    line(&b, "frame 0 8 4 job=" JOB " w=0");
    for (uint32_t y = 0; y < 4; y++) {
        done(&b, y, 0, 0);
        frag(&b, y, row(3 - y), 0, (float)(100 * y));
    }
    struct history l = {0};
    history_read_bytes(&l, b.data, b.len);
    const struct history_frame *f = history_frame_of(&l, 0);
    struct lattice want = row(2), spread = {3, 1, 1, 2, 1, 1};
    struct history_frag *whole = history_frag_at(&l, f, &want);
    assert_non_null(whole);
    assert_int_equal(whole->done, 1);
    assert_true(history_frag_intact(whole));
    assert_null(history_frag_at(&l, f, &spread));
    for (uint64_t i = 0; i < 2; i++) {
        struct history_place at = history_place_of(&l, f, lattice_pixel(&spread, 8, i));
        float rgba[4];
        wire_pixels(l.frags[at.frag].body + at.n * WIRE_PIXEL_BYTES, 1, rgba);
        assert_int_equal(l.frags[at.frag].done, 2 - i);
        assert_true(rgba[2] == (float)(100 * (2 - i) + 14));
    }
    history_free(&l);
    buf_free(&b);
}

/* Wherever a log is hurt, no more is lost than what was hurt. */
static void damage_costs_itself(void **state)
{
    (void)state;
    struct buf b = {0};
    line(&b, "frame 0 8 4 job=" JOB " w=0");
    for (uint32_t y = 0; y < 4; y++) {
        done(&b, y, 0, 0);
        frag(&b, y, row(y), 0, (float)y);
    }
    size_t torn = b.len - 60; /* in the last body; another run follows */
    struct buf log = {0};
    buf_append(&log, b.data, torn);
    buf_append(&log, b.data, b.len);
    struct history l = {0};
    history_read_bytes(&l, log.data, log.len);
    assert_int_equal(l.bad, 1);
    assert_int_equal(l.n_frags, 7);
    assert_int_equal(history_frame_of(&l, 0)->have.done, 32);
    for (size_t i = 0; i < l.n_frags; i++) assert_true(history_frag_intact(&l.frags[i]));
    b.data[b.len - 2] ^= 1; /* a bit in a body: the framing holds, the sum does not */
    history_read_bytes(&l, b.data, b.len);
    assert_int_equal(l.n_frags, 4);
    assert_true(history_frag_intact(&l.frags[2]));
    assert_false(history_frag_intact(&l.frags[3]));
    history_free(&l);
    buf_free(&log);
    buf_free(&b);
}

static void many_slots_keep_their_names(void **state)
{
    (void)state;
    enum { SLOTS = 3000 };
    struct buf b = {0};
    for (int round = 0; round < 2; round++)
        for (int k = 0; k < SLOTS; k++) done(&b, (uint32_t)(round * SLOTS + k), k % 7, k);
    struct history l = {0};
    history_read_bytes(&l, b.data, b.len);
    assert_int_equal(l.n_slots, SLOTS);
    for (int i = 0; i < 2 * SLOTS; i++) {
        char name[24];
        if (i % SLOTS) snprintf(name, sizeof name, "%d.%d", i % SLOTS % 7, i % SLOTS);
        else snprintf(name, sizeof name, "0");
        assert_int_equal(l.dones[i].slot, i % SLOTS);
        assert_string_equal(l.slots[i % SLOTS].name, name);
    }
    history_free(&l);
    buf_free(&b);
}

/* A worker sends pixels of a long task before it is done; those of another slot or run stay without
 * a cost. */
static void pixels_before_their_done(void **state)
{
    (void)state;
    struct buf b = {0};
    struct history l = {0};
    line(&b, "hello fan 0.1 format=4 selftest=1 slots=2");
    line(&b, "frame 0 8 4 job=" JOB);
    frag(&b, 0, row(3), 0, 1);
    line(&b, "hello fan 0.1 format=4 selftest=1 slots=2");
    frag(&b, 0, row(0), 0, 1);
    frag(&b, 0, row(1), 0, 1);
    frag(&b, 0, row(1), 1, 1);
    line(&b, "done 0 0 cpu_us=24 w=0");
    frag(&b, 0, row(2), 0, 1);
    line(&b, "done 0 0 cpu_us=8 w=0");
    unsigned char *log = xmalloc(buf_size(&b), 1);
    memcpy(log, buf_data(&b), buf_size(&b));
    history_read_bytes(&l, log, buf_size(&b));
    assert_int_equal(l.n_dones, 2);
    assert_int_equal(l.dones[0].sent, 24);
    assert_int_equal(l.dones[0].pixels, 24);
    assert_int_equal(l.dones[1].sent, 0);
    static const int done_of[] = {HISTORY_UNKNOWN, 0, 0, HISTORY_UNKNOWN, 0};
    for (int i = 0; i < 5; i++) assert_int_equal(l.frags[i].done, done_of[i]);
    history_free(&l);
    free(log);
    buf_free(&b);
}

/* ---- replaying ------------------------------------------------------------------------------- */

/* Row y of an 8 x 4 frame, by task y of 80 (y + 1) us; row 3 without its cost. */
static void put_costs(struct buf *b)
{
    line(b, "frame 0 8 4 job=" JOB " w=0");
    for (uint32_t y = 0; y < 4; y++) {
        char text[80];
        snprintf(text, sizeof text, "done 0 %u cpu_us=%u w=0", y, 80 * (y + 1));
        if (y < 3) line(b, text);
        frag(b, y, row(y), 0, (float)(100 * y));
    }
}

static void a_task_costs_what_its_pixels_cost(void **state)
{
    (void)state;
    struct buf b = {0};
    struct history l = {0};
    struct history_found found;
    char err[HISTORY_ERR];
    float rgba[4 * 8];
    put_costs(&b);
    history_read_bytes(&l, b.data, b.len);
    const struct history_frame *f = history_frame_of(&l, 0);
    struct lattice whole = row(1), spread = {6, 0, 4, 1, 1, 1}, column = {3, 0, 1, 3, 1, 1};
    assert_true(history_find(&l, f, &whole, &found, err));
    assert_non_null(found.whole);
    assert_true(found.cpu_us == 160);
    history_pixels(&l, f, &found, 5, 3, rgba);
    for (int i = 0; i < 3; i++) assert_true(rgba[4 * i] == (float)(100 + 4 * (5 + i)));
    assert_true(history_find(&l, f, &spread, &found, err)); /* two of row 0, two of row 1 */
    assert_null(found.whole);
    assert_true(found.cpu_us == 10 + 10 + 20 + 20);
    history_pixels(&l, f, &found, 1, 2, rgba);
    assert_true(rgba[0] == 4 * 7 && rgba[4] == 100);
    assert_true(history_find(&l, f, &column, &found, err));
    assert_true(found.cpu_us == 10 + 20 + 30);
    history_free(&l);
    buf_free(&b);
}

static void not_found(struct history *l, struct lattice at, const char *words)
{
    struct history_found found;
    char err[HISTORY_ERR];
    assert_false(history_find(l, history_frame_of(l, 0), &at, &found, err));
    assert_non_null(strstr(err, words));
    assert_non_null(strstr(err, "expected"));
}

static void pixels_that_cannot_be_used_are_named(void **state)
{
    (void)state;
    struct buf b = {0};
    struct history l = {0};
    put_costs(&b);
    history_read_bytes(&l, b.data, b.len);
    not_found(&l, row(3), "frame 0: pixel 0,3 has no CPU time");
    not_found(&l, (struct lattice){2, 2, 1, 2, 1, 1}, "pixel 2,3 has no CPU");
    b.data[l.frags[1].body - b.data] ^= 1;
    history_read_bytes(&l, b.data, b.len);
    not_found(&l, row(1), "pixel 0,1 is damaged");
    not_found(&l, (struct lattice){5, 0, 1, 2, 1, 1}, "pixel 5,1 is damaged");
    history_free(&l);
    buf_consume(&b, buf_size(&b));
    line(&b, "frame 0 8 4 job=" JOB " w=0");
    done(&b, 0, 0, 0);
    frag(&b, 0, row(0), 0, 1);
    history_read_bytes(&l, b.data, b.len);
    not_found(&l, (struct lattice){7, 0, 2, 1, 1, 1}, "pixel 0,1 is missing");
    history_free(&l);
    buf_free(&b);
}

static void only_some_logs_can_be_replayed(void **state)
{
    (void)state;
    char err[HISTORY_ERR];
    struct buf b = {0};
    struct history l = {0};
    assert_false(history_replayable(&l, err));
    assert_non_null(strstr(err, "no task"));
    line(&b, "frame 0 8 4 job=" JOB " w=0");
    done(&b, 0, 0, 0);
    history_read_bytes(&l, b.data, b.len); /* no pixels */
    assert_false(history_replayable(&l, err));
    history_free(&l);
    frag(&b, 0, row(0), 0, 1);
    history_read_bytes(&l, b.data, b.len);
    assert_true(history_replayable(&l, err));
    history_free(&l);
    buf_free(&b);
}

static void a_log_in_memory(void **state)
{
    (void)state;
    char path[] = "/tmp/stormring-history-XXXXXX";
    struct buf b = {0};
    struct history_file file;
    int fd = mkstemp(path), p[2];
    assert_true(fd >= 0);
    assert_int_equal(history_open(&file, path), 0); /* empty */
    history_close(&file);
    put_costs(&b);
    assert_int_equal(write_full(fd, b.data, b.len), 0);
    assert_int_equal(history_open(&file, path), 0);
    assert_true(file.mapped && file.n == b.len);
    assert_memory_equal(file.bytes, b.data, b.len);
    history_close(&file);
    unlink(path);
    assert_int_equal(history_open(&file, path), -1);
    assert_int_equal(errno, ENOENT);
    assert_int_equal(history_open(&file, "/tmp"), -2);
    assert_int_equal(errno, EISDIR);
    assert_int_equal(pipe(p), 0);
    assert_int_equal(write_full(p[1], "hello x 1 format=9\n", 19), 0);
    close(p[1]);
    snprintf(path, sizeof path, "/dev/fd/%d", p[0]);
    assert_int_equal(history_open(&file, path), 0);
    assert_true(!file.mapped && file.n == 19);
    history_close(&file);
    close(p[0]);
    close(fd);
    buf_free(&b);
}

static void save(const char *path, const struct buf *b)
{
    int fd = open(path, O_WRONLY | O_TRUNC);
    assert_true(fd >= 0);
    assert_int_equal(write_full(fd, buf_data(b), buf_size(b)), 0);
    close(fd);
}

/* One number is another task in another run. Pixels that came twice cost what the first ones did;
 * those without a cost get the mean. */
static void costs_of_two_runs(void **state)
{
    (void)state;
    char path[] = "/tmp/stormring-history-XXXXXX", err[HISTORY_ERR];
    struct buf b = {0};
    struct history_costs c;
    close(mkstemp(path));
    for (int run = 0; run < 2; run++) {
        line(&b, "hello fan 0.1 format=4 selftest=1 slots=2");
        line(&b, "frame 0 8 4 job=" JOB);
        line(&b, run ? "done 0 0 cpu_us=72 w=0" : "done 0 0 cpu_us=8 w=0");
        frag(&b, 0, row((uint32_t)run), 0, 1);
    }
    line(&b, "done 0 1 cpu_us=800 w=1");
    frag(&b, 1, row(1), 1, 1);
    frag(&b, 2, row(2), 1, 1);
    line(&b, "frame 1 8 4 job=" JOB " w=-");
    line(&b, "done 1 0 cpu_us=800 w=-");
    wire_frag(&b, &(struct task){.frame = 1, .at = row(3)}, &(struct lattice){0, 3, 8, 1, 1, 1},
        JOB, (float[32]){0});
    save(path, &b);
    assert_true(history_costs_read(path, &c, err));
    assert_int_equal(c.w, 8);
    assert_int_equal(c.h, 4);
    for (int p = 0; p < 32; p++) assert_true(c.us[p] == (p < 8 ? 1 : p < 16 ? 9 : 5));
    history_costs_free(&c);
    buf_consume(&b, buf_size(&b));
    line(&b, "frame 0 8 4 job=" JOB);
    frag(&b, 0, row(0), 0, 1);
    save(path, &b);
    assert_true(history_costs_read(path, &c, err));
    assert_null(c.us); /* no pixel has a cost */
    buf_consume(&b, buf_size(&b));
    line(&b, "hello x 1 format=9");
    save(path, &b);
    assert_false(history_costs_read(path, &c, err));
    assert_non_null(strstr(err, "format 9"));
    unlink(path);
    assert_false(history_costs_read(path, &c, err));
    assert_string_equal(err, strerror(ENOENT));
    buf_free(&b);
}

/* A picture of another size takes the costs of the same places. */
static void costs_of_tasks(void **state)
{
    (void)state;
    double us[] = {1, 2, 3, 4}, all[20] = {0};
    const struct history_costs c = {.w = 2, .h = 2, .us = us};
    const struct lattice whole = {0, 1, 4, 1, 1, 1}, scattered = {1, 2, 4, 1, 2, 1};
    assert_true(history_cost_of(&c, &whole, 4, 4) == 1 + 1 + 2 + 2);
    assert_true(history_cost_of(&c, &whole, 4, 2) == 3 + 3 + 4 + 4);
    history_costs_put(&c, &scattered, 4, 5, all); /* pixels 9, 11, 13, 15 */
    for (int p = 0; p < 20; p++) {
        bool there = p >= 9 && p <= 15 && p % 2;
        assert_true(all[p] == (there ? (p - 7) / 2 : 0));
    }
}

/* The first task of a run counts from the run's begin, later ones for themselves. */
static void the_longest_task(void **state)
{
    (void)state;
    struct buf b = {0};
    line(&b, "hello fan 0.1 format=4 selftest=1 slots=1");
    line(&b, "done 0 0 cpu_us=1 wall_us=900 recv_us=30");
    line(&b, "done 0 1 cpu_us=1 wall_us=40 recv_us=900");
    line(&b, "done 0 2 cpu_us=1 wall_us=400000000000000000 recv_us=5000"); /* a lie */
    line(&b, "hello fan 0.1 format=4 selftest=1 slots=1");
    line(&b, "done 0 3 cpu_us=1 wall_us=900 recv_us=50");
    struct history l = read_log(&b);
    assert_int_equal(history_longest_us(&l, 1000), 50);
    assert_int_equal(history_longest_us(&l, 10000), 5000);
    history_free(&l);
    assert_int_equal(history_longest_us(&l, 1000), 0);
    buf_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_pixels_count),
        cmocka_unit_test(a_hello_begins_a_run),
        cmocka_unit_test(another_job_is_nobodys),
        cmocka_unit_test(logs_of_other_pixels_are_not_the_same),
        cmocka_unit_test(pixels_are_found_again),
        cmocka_unit_test(damage_costs_itself),
        cmocka_unit_test(many_slots_keep_their_names),
        cmocka_unit_test(a_task_costs_what_its_pixels_cost),
        cmocka_unit_test(pixels_that_cannot_be_used_are_named),
        cmocka_unit_test(only_some_logs_can_be_replayed),
        cmocka_unit_test(a_log_in_memory),
        cmocka_unit_test(costs_of_two_runs),
        cmocka_unit_test(pixels_before_their_done),
        cmocka_unit_test(costs_of_tasks),
        cmocka_unit_test(the_longest_task),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
