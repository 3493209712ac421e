/* The estimate of the time left: runs in virtual time, with the row costs of real pictures. */
#include "eta/eta.h"
#include "image/image.h"
#include "wire/wire.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "eta_costs.h"

#define ROWS 512
#define W 512
#define SLOTS_MOST 32

struct run {
    const int *cost_us;
    int slots;
    double slowest; /* the speed of the last slot; that of the first is 1 */
    bool sample;    /* the order of partition -o sample */
};

/* At each share of the time of a run: the error of the estimate, in parts of the time left. */
struct errors {
    double at[3];
};
static const double shares[3] = {.1, .25, .5};

static double speed(const struct run *r, int k)
{
    return r->slots == 1 ? 1 : 1 - (1 - r->slowest) * k / (r->slots - 1);
}

struct done {
    uint32_t row;
    double end_s, cost_us;
};

static int by_end(const void *a, const void *b)
{
    const struct done *x = a, *y = b;
    return (x->end_s > y->end_s) - (x->end_s < y->end_s);
}

/* Each idle slot gets the next row. Returns the time of the run. */
static double schedule(const struct run *r, struct done d[ROWS])
{
    double free_s[SLOTS_MOST] = {0};
    struct cut cut = {.unit = CUT_ROW};
    struct cut_tasks tasks;
    struct task t;
    cut_tasks_begin(&tasks, &cut, W, ROWS, 0, NULL);
    if (r->sample) cut_tasks_sample(&tasks);
    for (int i = 0; cut_tasks_next(&tasks, &t); i++) {
        int k = 0;
        for (int j = 1; j < r->slots; j++)
            if (free_s[j] < free_s[k]) k = j;
        d[i].row = t.at.y;
        d[i].cost_us = r->cost_us[t.at.y] / speed(r, k);
        d[i].end_s = free_s[k] += d[i].cost_us * 1e-6;
    }
    cut_tasks_end(&tasks);
    qsort(d, ROWS, sizeof *d, by_end);
    return d[ROWS - 1].end_s;
}

static struct errors errors_of(const struct run *r)
{
    static struct done d[ROWS];
    static struct eta e;
    struct errors of = {{0}};
    int n = 0;
    double end_s = schedule(r, d);
    e = (struct eta){0};
    for (int i = 0; i < ROWS; i++) {
        for (; n < 3 && d[i].end_s > shares[n] * end_s; n++) {
            double t_s = shares[n] * end_s, left_s = end_s - t_s;
            of.at[n] = fabs(eta_left_s(&e, (double)i * W, (double)ROWS * W, t_s) / left_s - 1);
        }
        double y = (d[i].row + .5) / ROWS;
        eta_done(&e, 0, d[i].row, d[i].cost_us, d[i].end_s);
        eta_pixels(&e, 0, d[i].row, y, y, W);
    }
    assert_true(eta_left_s(&e, ROWS * W, ROWS * W, end_s) == 0);
    return of;
}

static const struct {
    const char *name;
    const int *cost_us;
} scenes[] = {
    {"gears", eta_gears}, {"balls", eta_balls}, {"tetra", eta_tetra}, {"mount", eta_mount}};
#define SCENES (sizeof scenes / sizeof *scenes)

static void at_most(const struct run *r, const char *scene, double most)
{
    struct errors of = errors_of(r);
    for (int k = 0; k < 3; k++)
        if (!(of.at[k] <= most))
            fail_msg("%s, %d slots, the slowest %g: off by %.3f at %g of the run, expected %g",
                scene, r->slots, r->slowest, of.at[k], shares[k], most);
}

static void a_sample_predicts_the_run(void **state)
{
    (void)state;
    for (size_t s = 0; s < SCENES; s++)
        for (int slots = 1; slots <= 8; slots *= 2) {
            at_most(&(struct run){scenes[s].cost_us, slots, 1, true}, scenes[s].name, .2);
            at_most(&(struct run){scenes[s].cost_us, slots, .5, true}, scenes[s].name, .2);
            at_most(&(struct run){scenes[s].cost_us, slots, .25, true}, scenes[s].name, .2);
        }
}

/* Without a sample the cost of the rest is unknown: the test above proves something. */
static void rows_in_order_do_not(void **state)
{
    (void)state;
    double worst = 0;
    for (size_t s = 0; s < SCENES; s++) {
        struct errors of = errors_of(&(struct run){scenes[s].cost_us, 2, 1, false});
        worst = fmax(worst, of.at[0]);
    }
    assert_true(worst > .3);
}

static void unknown_at_first(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    assert_true(eta_left_s(&e, 0, 100, 0) < 0);
    for (uint32_t i = 0; i < 3; i++) eta_done(&e, 0, i, 1e6, i), eta_pixels(&e, 0, i, 0, 0, 1);
    assert_true(eta_left_s(&e, 3, 100, 3) < 0);
    eta_done(&e, 0, 3, 1e6, 3), eta_pixels(&e, 0, 3, 0, 0, 1);
    assert_true(eta_left_s(&e, 4, 100, 3) == 96);
    assert_true(eta_left_s(&e, 4, 100, 5) == 94); /* time passes */
    assert_true(eta_left_s(&e, 100, 100, 5) == 0);
    assert_true(eta_left_s(&e, 4, 100, 1000) == 0);
}

static double sum(const double of[ETA_BANDS])
{
    double all = 0;
    for (int b = 0; b < ETA_BANDS; b++) all += of[b];
    return all;
}

static bool near(double x, double y) { return fabs(x - y) < 1e-9 * fmax(1, fabs(y)); }

static double row(double y) { return (y + .5) / ETA_BANDS; }

/* Costs and pixels count when both have come, once, in equal parts for the bands of a task. */
static void costs_belong_to_bands(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    eta_pixels(&e, 0, 7, row(2), row(3), 6);
    eta_pixels(&e, 0, 7, row(4), row(5), 6);
    assert_true(sum(e.px) == 0);
    eta_done(&e, 0, 7, 12, 0);
    for (int b = 0; b < ETA_BANDS; b++) {
        assert_true(near(e.px[b], b >= 2 && b <= 5 ? 3 : 0));
        assert_true(near(e.cost_us[b], b >= 2 && b <= 5 ? 3 : 0));
    }
    eta_pixels(&e, 0, 7, row(7), row(7), 2);
    assert_true(near(e.px[7], 2) && near(sum(e.cost_us), 12));
    eta_done(&e, 0, 8, 5, 0);
    assert_true(near(sum(e.px), 14) && near(sum(e.cost_us), 12));
    e = (struct eta){0};
    eta_done(&e, 0, 0, 64, 0);
    eta_pixels(&e, 0, 0, -1, 2, 64);
    for (int b = 0; b < ETA_BANDS; b++) assert_true(near(e.px[b], 1) && near(e.cost_us[b], 1));
}

/* Tasks that share a place of the table. */
static void tasks_do_not_mix(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    eta_done(&e, 0, 9, 1, 0);
    eta_pixels(&e, ETA_TASKS, 9, 0, 0, 1);
    eta_done(&e, 0, 5, 1, 0);
    eta_pixels(&e, 0, 5 + ETA_TASKS, 0, 0, 1);
    assert_true(sum(e.px) == 0 && sum(e.cost_us) == 0);
}

static void rows_above_cost_what_those_below_do(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    for (uint32_t i = 0; i < 4; i++)
        eta_done(&e, 0, i, 1e6, i), eta_pixels(&e, 0, i, row(32), row(32), 1);
    assert_true(near(eta_left_s(&e, 4, ETA_BANDS, 3), 60));
}

/* All slots are slow while the sample is rendered. A band costs as many seconds as are above it. */
static void a_slow_sample(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    double t_s = 0, left_s = 0;
    for (uint32_t i = 0; i < 32; i++) {
        uint32_t b = 2 * i + 1;
        eta_done(&e, 0, i, 3e6 * b, t_s += 3 * b);
        eta_pixels(&e, 0, i, row(b), row(b), 1);
    }
    assert_true(!e.known);
    for (uint32_t i = 0; i < 64; i++) { /* the upper bands, two tasks of a quarter of a row each */
        double cost_s = fmax(i / 2, 1) / 4;
        eta_done(&e, 0, 32 + i, 1e6 * cost_s, t_s += cost_s);
        eta_pixels(&e, 0, 32 + i, row(i / 2), row(i / 2), .25);
    }
    assert_true(e.known);
    for (int b = 0; b < ETA_BANDS; b++) left_s += fmax(b, 1) * (2 - b % 2 - (b < 32 ? .5 : 0));
    assert_true(near(eta_left_s(&e, 48, 128, t_s), left_s));
}

/* The middle first, and then the rest: that is no sample of the whole picture. */
static void half_a_picture_is_no_sample(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    for (uint32_t i = 0; i < 48; i++) {
        uint32_t b = i < 44 ? i + 10 : i - 44;
        eta_done(&e, 0, i, 1e6, i);
        eta_pixels(&e, 0, i, row(b), row(b), 1);
    }
    assert_true(!e.known);
}

/* Odd bands cost 3 s, even ones 1 s. The second forecast changes the work of the second pass. */
static void two_forecasts(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    double t_s = 0;
    for (uint32_t i = 0; i < 64; i++) {
        uint32_t b = i < 32 ? 2 * i + 1 : 2 * (i - 32);
        eta_done(&e, 0, i, i < 32 ? 3e6 : 1e6, t_s += i < 32 ? .125 : 1);
        eta_pixels(&e, 0, i, row(b), row(b), 1);
    }
    eta_done(&e, 0, 64, 1e6, t_s += 1);
    eta_pixels(&e, 0, 64, row(0), row(0), .5);
    /* The last half of the 37 s has 18 tasks of 1 s and half a row of 1 s. */
    assert_true(near(eta_left_s(&e, 64.5, 128, t_s), 127.5 * 19 / 18.5));
}

/* The slots become half as fast after a third of the time; most marks are dropped on the way. */
static void the_speed_is_that_of_late(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    for (uint32_t i = 0; i < 2000; i++) {
        eta_done(&e, 0, i, 1e6, i < 1000 ? i : 2 * (double)i - 1000);
        eta_pixels(&e, 0, i, row(i % ETA_BANDS), row(i % ETA_BANDS), 1);
    }
    assert_true(near(eta_left_s(&e, 2000, 4000, 2998), 4000));
    eta_begin(&e); /* another run, which is ten times as fast */
    assert_true(e.step_s == 0);
    for (uint32_t i = 0; i < 4; i++) {
        assert_true(eta_left_s(&e, 2000, 4000, 1) < 0);
        eta_done(&e, 0, 3000 + i, 1e6, i / 10.);
        eta_pixels(&e, 0, 3000 + i, row(i), row(i), 1);
    }
    assert_true(near(eta_left_s(&e, 2000, 4000, .3), 200));
    e = (struct eta){0};
    eta_done(&e, 0, 0, 1e6, -1); /* of an earlier run */
    eta_pixels(&e, 0, 0, row(0), row(0), 1);
    assert_true(e.work_us == 0 && e.n_done == 0 && e.n_marks == 0);
}

/* The records in b, of a frame of 64 rows or of an unknown one. */
static void take(struct eta *e, struct buf *b, uint32_t frame_h)
{
    struct decoder d = wire_over(b->data, b->len);
    struct record r;
    int n = 0;
    for (; wire_next(&d, &r) == WIRE_RECORD; n++) eta_record(e, &r, frame_h, 1);
    assert_true(n > 0);
    buf_free(b);
}

static void what_records_tell(void **state)
{
    (void)state;
    static struct eta e;
    static const float rgba[4 * 12];
    struct buf b = {0};
    struct task t = {.frame = 2, .id = 3, .at = {0, 8, 4, 3, 1, 16}, .to = -1};
    e = (struct eta){0};
    wire_done(&b, &t, 330, 900);
    wire_frag(&b, &t, &t.at, "0123456789abcdef", rgba);
    take(&e, &b, 64);
    for (int k = 0; k < ETA_BANDS; k++) { /* rows 8, 24 and 40 */
        assert_true(near(e.cost_us[k], k >= 8 && k <= 40 ? 10 : 0));
        assert_true(near(e.px[k], k >= 8 && k <= 40 ? 12. / 33 : 0));
    }
    const struct task other = {.frame = 2, .id = 4, .at = t.at, .to = -1};
    wire_done(&b, &other, 0, 5);
    wire_frag(&b, &other, &t.at, "0123456789abcdef", rgba);
    take(&e, &b, 64);
    assert_true(near(e.work_us, 335));
    wire_hello(&b, "fan", "0", 0, 0, 1);
    take(&e, &b, 64);
    assert_true(e.work_us == 0 && near(sum(e.cost_us), 335));
    e = (struct eta){0};
    wire_done(&b, &t, 330, 900);
    wire_frag(&b, &t, &t.at, "0123456789abcdef", rgba);
    take(&e, &b, 0);
    assert_true(sum(e.px) == 0);
}

/* A run of one task, row 2 of 6, of which the estimate is told. */
static void note_run(struct eta_progress *p, bool earlier)
{
    static const float rgba[4 * 8];
    const struct task t = {.id = 2, .at = {0, 2, 8, 1, 1, 1}, .to = -1};
    struct assembly parts;
    struct buf b = {0};
    struct record r;
    assembly_init(&parts, false, 1 << 20);
    assembly_declare(&parts, 0, 8, 6, "cafe");
    wire_frag(&b, &t, &t.at, "cafe", rgba);
    wire_done(&b, &t, 300, 0);
    struct decoder d = wire_over(b.data, b.len);
    while (wire_next(&d, &r) == WIRE_RECORD) eta_progress_note(p, &parts, &r, earlier);
    buf_free(&b);
    assembly_free(&parts);
}

static void what_a_run_tells(void **state)
{
    (void)state;
    static struct eta_progress off, now, earlier;
    const int band = (int)(2.5 / 6 * ETA_BANDS); /* in the middle of row 2 */
    note_run(&off, false);
    assert_true(off.eta.px[band] == 0);
    progress_start(&now.line, true);
    note_run(&now, false);
    assert_true(now.eta.px[band] > 0 && now.eta.cost_us[band] > 0);
    assert_true(now.eta.work_us == 300);
    progress_start(&earlier.line, true);
    note_run(&earlier, true);
    assert_true(earlier.eta.px[band] > 0);
    assert_true(earlier.eta.work_us == 0); /* says nothing of this run's speed */
}

static void show_line(void)
{
    struct progress p;
    progress_start(&p, true);
    progress_show(&p, 0, 0, -1);
    progress_show(&p, 0, 10, -1);
    p.next_us = 0;
    progress_show(&p, 1, 10, 899.7);
    if (progress_due(&p)) progress_show(&p, 2, 10, 5); /* too early */
    p.next_us = 0;
    progress_show(&p, 8, 10, 3605);
    progress_clear(&p);
    progress_start(&p, false);
    progress_show(&p, 5, 10, 5);
    progress_clear(&p);
}

static void the_line(void **state)
{
    (void)state;
    char said[4096] = {0};
    FILE *to = tmpfile();
    int err = dup(STDERR_FILENO);
    assert_true(to && err >= 0 && dup2(fileno(to), STDERR_FILENO) >= 0);
    prog_init("test");
    show_line();
    assert_true(dup2(err, STDERR_FILENO) >= 0 && close(err) == 0);
    rewind(to);
    assert_true(fread(said, 1, sizeof said - 1, to) > 0);
    fclose(to);
    assert_non_null(strstr(said, "\rtest:   0.0 %, ETA ?"));
    assert_non_null(strstr(said, "\rtest:  10.0 %, ETA 15:00"));
    assert_non_null(strstr(said, "\rtest:  80.0 %, ETA 1:00:05"));
    assert_null(strstr(said, "20.0"));
    assert_null(strstr(said, "50.0"));
    assert_null(strchr(said, '\n'));
    assert_int_equal(said[strlen(said) - 1], '\r');
}

/* The rows that an earlier run left out cost what that run says, at the speed of this one. */
static void a_resumed_run(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    for (uint32_t i = 0; i < 32; i++) {
        double y = (2 * i + .5) / ETA_BANDS;
        eta_done(&e, 0, i, 1e6 * (i + 1), -1);
        eta_pixels(&e, 0, i, y, y, 1);
    }
    eta_begin(&e);
    for (uint32_t i = 0; i < 4; i++) {
        double y = (2 * i + 1.5) / ETA_BANDS;
        eta_done(&e, 0, 100 + i, 1e6 * (i + 1.5), i);
        eta_pixels(&e, 0, 100 + i, y, y, 1);
    }
    /* rows 9, 11, ... 63 cost 5.5 s to 32 s; in the 3 seconds since the first task 10.5 s of work
     * were done */
    double work_s = 0;
    for (int i = 4; i < 31; i++) work_s += i + 1.5;
    double left_s = eta_left_s(&e, 36, 64, 3), speed = (2.5 + 3.5 + 4.5) / 3;
    assert_true(fabs(left_s - (work_s + 32) / speed) < 1e-9);
}

/* A stream of records that nothing holds to the truth. */
static void nonsense(void **state)
{
    (void)state;
    static struct eta e;
    e = (struct eta){0};
    for (uint32_t i = 0; i < 100000; i++) {
        uint64_t x = rng_u64(1, i);
        double y0 = (double)(x >> 40) / 1e3 - 4, y1 = (double)(x >> 20 & 0xffff) / 1e3 - 4;
        if (x & 1) eta_done(&e, (uint32_t)x, (uint32_t)(x >> 3 & 0xffff), (double)x, (double)i - 9);
        else eta_pixels(&e, (uint32_t)x, (uint32_t)(x >> 3 & 0xffff), y0, y1, (double)x);
        double left_s = eta_left_s(&e, (double)i, 1e9, (double)(x & 0xfffff));
        assert_true(left_s == -1 || left_s >= 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sample_predicts_the_run),
        cmocka_unit_test(rows_in_order_do_not),
        cmocka_unit_test(unknown_at_first),
        cmocka_unit_test(a_resumed_run),
        cmocka_unit_test(a_slow_sample),
        cmocka_unit_test(half_a_picture_is_no_sample),
        cmocka_unit_test(two_forecasts),
        cmocka_unit_test(costs_belong_to_bands),
        cmocka_unit_test(tasks_do_not_mix),
        cmocka_unit_test(rows_above_cost_what_those_below_do),
        cmocka_unit_test(the_speed_is_that_of_late),
        cmocka_unit_test(what_records_tell),
        cmocka_unit_test(what_a_run_tells),
        cmocka_unit_test(the_line),
        cmocka_unit_test(nonsense),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
