/*
 * log: what an intake makes of records, which runs a file can be continued by, and what it says of
 * others. Reading a log cut at every byte is in tests/30_gather.t and 65_restart.t.
 */
#include "log/log.h"

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#define W 8
#define H 6

static char path[] = "/tmp/stormring-log-XXXXXX";

/* Lines, each sealed; what has no newline at its end is put as it is. */
static void put_text(struct buf *b, const char *text)
{
    for (const char *nl; (nl = strchr(text, '\n')) != NULL; text = nl + 1) {
        size_t at = buf_size(b);
        buf_append(b, text, (size_t)(nl - text));
        wire_seal(b, at);
    }
    buf_append(b, text, strlen(text));
}

static void feed_text(struct decoder *d, const char *text)
{
    struct buf b = {0};
    put_text(&b, text);
    wire_feed(d, buf_data(&b), buf_size(&b));
    buf_free(&b);
}

/* Row y of frame number `frame`, as worker 0. */
static void put_row(struct buf *b, uint32_t frame, uint32_t y)
{
    float rgba[4 * W];
    struct task t = {.frame = frame, .id = y, .at = {0, y, W, 1, 1, 1}, .to = -1};
    for (int i = 0; i < 4 * W; i++) rgba[i] = i % 4 == 3 ? 1 : (float)y;
    wire_frag(b, &t, &t.at, "cafe", rgba);
}

static void write_log(const struct buf *b)
{
    int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    assert_true(fd >= 0);
    assert_int_equal(write_full(fd, buf_data(b), buf_size(b)), 0);
    close(fd);
}

/* A run of rows `from` .. `to` - 1. */
static void put_run(struct buf *b, const char *hello, const char *frame, uint32_t from, uint32_t to)
{
    put_text(b, hello);
    put_text(b, frame);
    for (uint32_t y = from; y < to; y++) put_row(b, 0, y);
}

static const char hello[] = "hello rtworker 0.1 format=4 selftest=00000000000000aa power=1\n";
static const char frame[] = "frame 0 8 6 job=cafe with=rtworker,-a4\n";

static void test_origin(void **state)
{
    (void)state;
    struct buf b = {0};
    struct log_file l;
    struct intake in;
    put_run(&b, hello, frame, 0, 2);
    put_text(
        &b, "hello rtworker 9 format=4 selftest=bb\nframe 0 8 6 job=cafe with=other\nbeat\ntorn");
    write_log(&b);
    assert_int_equal(log_open(&l, path), 0);
    assert_true(l.holds);
    assert_int_equal(log_survey(&l, &in), 0);
    assert_string_equal(in.origin.version, "0.1");
    assert_string_equal(in.origin.selftest, "00000000000000aa");
    assert_string_equal(in.origin.with, "rtworker -a4");
    assert_int_equal(in.bad, 1);
    assert_int_equal(in.skipped, 4);
    assert_int_equal(in.parts.done_px, 2 * W);
    assert_int_equal(assembly_find(&in.parts, 0)->next_id, 2);
    intake_free(&in);
    log_close(&l);
    buf_free(&b);
}

/* Text that a shell would take for more than words is not repeated. */
static void test_options_are_words(void **state)
{
    (void)state;
    static const char *const with[] = {"with=rtworker,-a16:0.02", "with=a;b", "with=$x", "with="};
    static const char *const want[] = {"rtworker -a16:0.02", "", "", ""};
    for (int i = 0; i < 4; i++) {
        struct intake in;
        struct decoder d = {.upward = true};
        struct record r;
        char line[80];
        intake_init(&in, false);
        snprintf(line, sizeof line, "frame 0 8 6 job=cafe w=3 %s\n", with[i]);
        feed_text(&d, line);
        assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
        assert_int_equal(intake_frame(&in, &r), ASSEMBLY_TAKEN);
        assert_string_equal(in.origin.with, want[i]);
        wire_free(&d);
        intake_free(&in);
    }
}

/* The frame that a record makes whole is told once. */
static void test_whole_once(void **state)
{
    (void)state;
    struct buf b = {0};
    struct decoder d = {.upward = true};
    struct record r;
    struct intake in;
    int told = 0;
    put_run(&b, hello, frame, 0, H);
    put_row(&b, 0, 0);
    put_text(&b, "task 0 9 0 0 1 1 1 1\nframe 1 8 6\n");
    intake_init(&in, true);
    wire_feed(&d, buf_data(&b), buf_size(&b));
    while (wire_next(&d, &r) == WIRE_RECORD) {
        struct assembly_frame *f = NULL;
        if (r.kind == REC_FRAME) intake_frame(&in, &r);
        else f = intake_record(&in, &r);
        if (!f) continue;
        told++;
        const struct image_rows rows = assembly_rows(f);
        assert_true(rows.row(&rows, H - 1)[4 * (W - 1)] == H - 1);
        assembly_release(&in.parts, f);
    }
    assert_int_equal(told, 1);
    assert_int_equal(in.unexpected, 2);
    assert_int_equal(in.parts.n_frames, 1);
    wire_free(&d);
    intake_free(&in);
    buf_free(&b);
}

/* What the log has of a frame. */
static int covered(const char *log, uint32_t number, struct coverage *have, char why[LOG_WHY])
{
    struct intake in;
    int failed = log_survey_path(log, &in, why);
    const struct assembly_frame *f = failed ? NULL : assembly_find(&in.parts, number);
    *have = (struct coverage){0};
    if (f) assembly_coverage(f, have);
    intake_free(&in);
    return failed;
}

static void test_coverage(void **state)
{
    (void)state;
    struct buf b = {0};
    struct coverage have;
    char why[LOG_WHY] = "";
    put_run(&b, hello, frame, 2, 4);
    write_log(&b);
    assert_int_equal(covered(path, 0, &have, why), 0);
    assert_int_equal(have.w, W);
    assert_int_equal(have.done, 2 * W);
    assert_false(coverage_has(&have, 2 * W - 1));
    assert_true(coverage_has(&have, 2 * W));
    coverage_free(&have);
    static const char *const none[] = {"/dev/null", "/nonexistent-log", "/tmp/stormring-log"};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(covered(none[i], 0, &have, why), 0);
        assert_null(have.bits);
    }
    assert_int_equal(covered(path, 7, &have, why), 0);
    assert_null(have.bits);
    assert_int_equal(covered("/", 0, &have, why), -1);
    /* Only an empty file becomes a log. */
    static const char *const text[] = {"", "h", "hello", "hello x", "hellx", "# a file\n", "\n",
        "hello x\n", "hello a b sum=00000000\n"};
    for (int i = 0; i < 9; i++) {
        buf_consume(&b, buf_size(&b));
        put_text(&b, text[i]);
        write_log(&b);
        assert_int_equal(covered(path, 0, &have, why), i > 0);
        assert_null(have.bits);
    }
    /* A whole frame was released while it was read: all of it is there. */
    buf_consume(&b, buf_size(&b));
    put_run(&b, hello, frame, 0, H);
    write_log(&b);
    assert_int_equal(covered(path, 0, &have, why), 0);
    assert_true(coverage_full(&have));
    coverage_free(&have);
    buf_free(&b);
}

/* A second opening is refused while the first lasts; appended bytes stay. */
static void test_lock(void **state)
{
    (void)state;
    struct log_file one, two;
    struct decoder d = {.upward = true};
    struct record r;
    unlink(path);
    assert_int_equal(log_open(&one, path), 0);
    assert_false(one.holds);
#ifdef _GNU_SOURCE /* test_os.c has other processes */
    assert_int_equal(log_open(&two, path), -1);
    assert_int_equal(errno, EWOULDBLOCK);
#endif
    feed_text(&d, hello);
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    log_append(&one, &r);
    assert_int_equal(log_flush(&one), 0);
    log_close(&one);
    assert_int_equal(log_open(&two, path), 0);
    assert_true(two.holds);
    log_close(&two);
    assert_int_equal(log_open(&two, "/dev/full"), 0);
    log_append(&two, &r);
    assert_int_equal(log_flush(&two), -1);
    assert_int_equal(errno, ENOSPC);
    assert_int_equal(two.fd, -1);
    log_append(&two, &r); /* into nothing */
    assert_int_equal(log_flush(&two), 0);
    log_close(&two);
    wire_free(&d);
}

static void ignore(void *ctx, const struct record *r) { (void)ctx, (void)r; }

/* The log above against a run that says otherwise; "" for a run that may go on. */
static void differs(const char *now_hello, const char *now_frame, const char *want)
{
    struct buf b = {0};
    struct log_run run;
    struct intake now;
    const struct log_reader reader = {ignore, NULL, NULL};
    struct decoder d = {.upward = true};
    struct record r;
    char why[LOG_WHY] = "";
    put_run(&b, hello, frame, 0, 2);
    write_log(&b);
    assert_int_equal(log_run_open(&run, path), 0);
    intake_init(&now, false);
    feed_text(&d, now_hello);
    feed_text(&d, now_frame);
    do {
        assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
        intake_note(&now, &r);
    } while (r.kind != REC_FRAME);
    assert_int_equal(log_run_confirm(&run, &now, &r, &reader, why), *want != 0);
    assert_true(strncmp(why, want, strlen(want)) == 0);
    log_run_close(&run);
    wire_free(&d);
    intake_free(&now);
    buf_free(&b);
}

static void test_continues(void **state)
{
    (void)state;
    const char *other = "frame 0 8 6 job=beef with=rtworker,-a4\n";
    differs(hello, frame, "");
    differs("", frame, "");
    differs("hello deal 0.2 format=4 selftest=00000000000000aa\n", frame, "");
    differs(hello, "frame 1 9 9 job=beef\n", "");
    differs(hello, "frame 0 8 7 job=beef with=rtworker,-d1\n", "has another size: frame 0 of 8x6");
    differs(hello, "frame 0 8 6 job=beef with=rtworker\n", "was rendered with other options");
    differs("hello deal 0.2 format=4 selftest=bb\n", other, "was rendered by another version: 0.1");
    differs("hello deal 0.1 format=4 selftest=bb\n", other, "was rendered by other arithmetic");
    differs("hello deal 0.2 format=4 selftest=bb\n", frame, "was rendered by another version");
    differs(hello, other, "is of another scene: frame 0 has job cafe, expected beef");
    differs("", "frame 0 8 6 job=beef\n", "is of another scene");
}

/* What a run that is kept counts: every record of its own, and of the log when that is trusted. */
struct kept {
    struct log_run k;
    struct intake in;
    struct log_reader reader;
    int refused;
    char why[LOG_WHY];
};

static void keep_record(void *ctx, const struct record *r)
{
    struct kept *kept = ctx;
    if (log_run_ignores(&kept->k, r)) return;
    if (r->kind == REC_FRAME) {
        int refused = log_run_confirm(&kept->k, &kept->in, r, &kept->reader, kept->why);
        if (refused) kept->refused = refused;
        if (refused) return;
        intake_frame(&kept->in, r);
    }
    log_run_append(&kept->k, r);
    if (r->kind == REC_FRAME) return;
    struct assembly_frame *whole = intake_record(&kept->in, r);
    if (whole) assembly_release(&kept->in.parts, whole);
}

/* A run of these records, appended to the log at `path`; what it counted stays in *kept. */
static void keep_run(struct kept *kept, const struct buf *run)
{
    struct decoder d = {.upward = true};
    struct record r;
    *kept = (struct kept){.reader = {keep_record, NULL, kept}};
    assert_int_equal(log_run_open(&kept->k, path), 0);
    intake_init(&kept->in, false);
    wire_feed(&d, buf_data(run), buf_size(run));
    while (wire_next(&d, &r) == WIRE_RECORD) keep_record(kept, &r);
    wire_free(&d);
}

static void end_run(struct kept *kept)
{
    assert_int_equal(log_run_flush(&kept->k), 0);
    intake_free(&kept->in);
    log_run_close(&kept->k);
}

static void log_is(const struct buf *want)
{
    struct buf got = {0};
    assert_int_equal(read_file(path, &got), 0);
    assert_int_equal(buf_size(&got), buf_size(want));
    assert_memory_equal(buf_data(&got), buf_data(want), buf_size(want));
    buf_free(&got);
}

static void test_kept_runs(void **state)
{
    (void)state;
    struct buf all = {0}, run = {0};
    struct kept kept;
    unlink(path);
    put_run(&run, hello, frame, 0, 2);
    put_text(&run, "beat\n"); /* the only record that is not kept */
    keep_run(&kept, &run);
    assert_true(kept.k.trusted);
    end_run(&kept);
    put_run(&all, hello, frame, 0, 2);
    log_is(&all);
    /* The same picture: the log's rows count, and the run is appended. */
    buf_consume(&run, buf_size(&run));
    put_run(&run, hello, frame, 1, 4);
    keep_run(&kept, &run);
    assert_true(kept.k.trusted);
    assert_int_equal(kept.in.parts.done_px, 4 * W);
    assert_int_equal(assembly_again(&kept.in.parts), W); /* row 1 */
    end_run(&kept);
    put_run(&all, hello, frame, 1, 4);
    log_is(&all);
    buf_free(&all);
    buf_free(&run);
}

static void test_kept_out(void **state)
{
    (void)state;
    struct buf all = {0}, run = {0};
    struct kept kept;
    /* No frame was announced: nothing is appended, and its pixels do not count. */
    put_run(&all, hello, frame, 0, 2);
    write_log(&all);
    put_row(&run, 0, 3);
    keep_run(&kept, &run);
    assert_false(kept.k.trusted);
    assert_int_equal(kept.in.parts.done_px, 0);
    end_run(&kept);
    log_is(&all);
    /* Another scene. */
    buf_consume(&run, buf_size(&run));
    put_run(&run, hello, "frame 0 8 6 job=beef with=rtworker,-a4\n", 0, 2);
    keep_run(&kept, &run);
    assert_int_equal(kept.refused, 1);
    assert_non_null(strstr(kept.why, "is of another scene"));
    assert_false(kept.k.trusted);
    end_run(&kept);
    log_is(&all);
    assert_int_equal(log_run_open(&kept.k, NULL), 0); /* no log at all */
    assert_true(kept.k.trusted);
    assert_int_equal(log_run_flush(&kept.k), 0);
    log_run_close(&kept.k);
    buf_free(&all);
    buf_free(&run);
}

static void test_refused(void **state)
{
    (void)state;
    struct intake in;
    struct decoder d = {.upward = true};
    struct record r;
    char text[LOG_DISPUTE_TEXT];
    intake_init(&in, false);
    feed_text(&d, "frame 0 8 6 job=cafe w=0\nframe 0 9 6 job=beef w=1 host=render1\n");
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    assert_int_equal(intake_frame(&in, &r), ASSEMBLY_TAKEN);
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    assert_int_equal(intake_frame(&in, &r), ASSEMBLY_FOREIGN);
    assert_string_equal(intake_refused_text(&in, &r, text),
        "frame 0: slot 1 on render1 (standard input) has job beef of 9x6, expected cafe of 8x6: "
        "its fragments are ignored");
    wire_free(&d);
    intake_free(&in);
}

/* The next record of d, as a run's and then as the log's. */
static void keep_next(struct log_run *k, struct decoder *d, const char *why)
{
    struct record r;
    assert_int_equal(wire_next(d, &r), WIRE_RECORD);
    log_run_append(k, &r);
    assert_string_equal(k->why, why);
}

static void test_bye(void **state)
{
    (void)state;
    struct decoder d = {.upward = true};
    struct log_run k;
    struct intake in;
    assert_int_equal(log_run_open(&k, NULL), 0);
    assert_string_equal(k.why, "");
    feed_text(&d, "bye why=other-jobs\nbeat\nbye\nbye why=method-failed\nbye why=x\n");
    keep_next(&k, &d, "other-jobs");
    keep_next(&k, &d, "other-jobs");
    keep_next(&k, &d, "");
    keep_next(&k, &d, "method-failed");
    k.rereading = true;
    keep_next(&k, &d, "method-failed");
    wire_free(&d);
    log_run_close(&k);
    intake_init(&in, false);
    assert_false(intake_report_bye(&in, "other-jobs", true)); /* no frame */
    assert_int_equal(assembly_declare(&in.parts, 0, W, H, "cafe"), ASSEMBLY_TAKEN);
    assert_true(intake_report_bye(&in, "other-jobs", true));
    assert_false(intake_report_bye(&in, "other-jobs", false));
    assert_false(intake_report_bye(&in, "method-failed", true));
    assert_false(intake_report_bye(&in, "", true));
    intake_free(&in);
}

static struct buf lacking;
static void lack(const void *p, size_t n) { buf_append(&lacking, p, n); }

static void test_missing(void **state)
{
    (void)state;
    struct buf b = {0};
    struct log_file l;
    struct intake in;
    put_run(&b, hello, frame, 0, 5);
    write_log(&b);
    assert_int_equal(log_open(&l, path), 0);
    assert_int_equal(log_survey(&l, &in), 0);
    intake_missing(in.parts.frames[0], lack);
    buf_append(&lacking, "", 1);
    assert_string_equal(
        (const char *)buf_data(&lacking), "frame 0 8 6 job=cafe\ntask 0 5 0 5 8 1 1 1\n");
    buf_free(&lacking);
    intake_free(&in);
    log_close(&l);
    buf_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_origin),
        cmocka_unit_test(test_options_are_words),
        cmocka_unit_test(test_whole_once),
        cmocka_unit_test(test_coverage),
        cmocka_unit_test(test_lock),
        cmocka_unit_test(test_continues),
        cmocka_unit_test(test_kept_runs),
        cmocka_unit_test(test_kept_out),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_bye),
        cmocka_unit_test(test_missing),
    };
    int fd = mkstemp(path);
    if (fd < 0) die(ST_SYSTEM, "%s:", path);
    close(fd);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(path);
    return failed;
}
