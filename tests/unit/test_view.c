/* A run in view, from small logs: files that change, figures, table, page, picture and trace. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include <sys/stat.h>
#include <unistd.h>

#include "image/image.h"
#include "view/view.h"
#include "scratch.h"

#define JOB "0123456789abcdef"
#define HELLO "hello deal 0.1 format=4 selftest=0 slots=2"

static char dir[SCRATCH_BYTES];

/* ---- logs ------------------------------------------------------------------------------------ */

/* Appends lines up to a NULL, each sealed. */
static void put_lines(struct buf *b, const char *const *line)
{
    for (; *line; line++) {
        size_t at = buf_size(b);
        buf_append(b, *line, strlen(*line));
        wire_seal(b, at);
    }
}
#define LINES(...) ((const char *const[]){__VA_ARGS__, NULL})

/* A task of a worker without a fan, with its pixels, all of one grey. */
static void put_task(
    struct buf *b, uint32_t frame, uint32_t id, struct lattice at, double s, float v)
{
    struct task t = {.frame = frame, .id = id, .at = at, .to = -1};
    float *rgba = xcalloc(lattice_count(&at), 4 * sizeof *rgba);
    for (size_t i = 0; i < 4 * lattice_count(&at); i++) rgba[i] = i % 4 == 3 ? 1 : v;
    wire_done(b, &t, (int64_t)(s * 1e6), (int64_t)(s * 1e6));
    wire_frag(b, &t, &at, JOB, rgba);
    free(rgba);
}

static void save(const char *name, const struct buf *b)
{
    FILE *f = fopen(name, "w");
    assert_non_null(f);
    assert_int_equal(fwrite(buf_data(b), 1, buf_size(b), f), buf_size(b));
    assert_int_equal(fclose(f), 0);
}

/* Opens a view of the log, which is freed. */
static void view(struct view_log *v, const char *name, struct buf *b)
{
    save(name, b);
    buf_free(b);
    view_open(v, name);
    assert_true(view_read(v));
}

static void ends(struct buf *b)
{
    buf_append(b, "", 1);
    assert_non_null(buf_data(b));
}
static const char *text(const struct buf *b) { return (const char *)buf_data(b); }

static void has(const struct buf *b, const char *part)
{
    if (!strstr(text(b), part)) fail_msg("no <%s> in:\n%s", part, text(b));
}
static void lacks(const struct buf *b, const char *part)
{
    if (strstr(text(b), part)) fail_msg("a <%s> in:\n%s", part, text(b));
}

/* ---- a log that grows ------------------------------------------------------------------------ */

static void a_log_that_changes(void **state)
{
    (void)state;
    struct view_log v;
    struct buf b = {0};
    view_open(&v, "grows");
    assert_false(view_read(&v));
    put_lines(&b, LINES("frame 0 8 2 job=" JOB));
    put_task(&b, 0, 0, (struct lattice){0, 0, 8, 1, 1, 1}, 1, 0);
    save("grows", &b);
    assert_true(view_read(&v));
    assert_int_equal(v.log.n_dones, 1);
    assert_false(view_whole(&v));
    put_task(&b, 0, 1, (struct lattice){0, 1, 8, 1, 1, 1}, 1, 0);
    save("grows", &b);
    v.heard_us = 0;
    assert_true(view_read(&v));
    assert_int_equal(v.log.n_dones, 2);
    assert_true(view_whole(&v));
    assert_false(view_ended(&v));
    assert_true(v.heard_us > 0);
    v.heard_us = 0;
    assert_true(view_read(&v));
    assert_int_equal(v.heard_us, 0); /* nothing came */
    put_lines(&b, LINES("bye"));
    save("grows", &b);
    assert_true(view_read(&v));
    assert_true(view_ended(&v));
    buf_free(&b);

    put_lines(&b, LINES("frame 0 8 2 job=" JOB)); /* the same file, with less in it */
    save("grows", &b);
    assert_true(view_read(&v));
    assert_int_equal(v.log.n_dones, 0);
    assert_false(view_whole(&v));
    put_task(&b, 0, 0, (struct lattice){0, 0, 8, 1, 1, 1}, 1, 0);
    put_task(&b, 0, 1, (struct lattice){0, 1, 8, 1, 1, 1}, 1, 0);
    save("other", &b); /* another file, with more in it */
    assert_int_equal(rename("other", "grows"), 0);
    assert_true(view_read(&v));
    assert_int_equal(v.log.n_dones, 2);
    buf_free(&b);
    view_close(&v);
    put_lines(&b, LINES(HELLO));
    view(&v, "empty", &b);
    assert_false(view_whole(&v)); /* no frame */
    view_close(&v);
}

/* ---- the figures ----------------------------------------------------------------------------- */

/* Slots come as 10, 0, 2 in the log; slot 0 is up in the first run only. */
static const char *const two_runs[] = {HELLO, "frame 0 8 8 job=" JOB " w=10 host=b recv_us=1000",
    "frame 0 8 8 job=" JOB " w=0 host=: recv_us=1000",
    "done 0 0 cpu_us=500000 wall_us=600000 w=10 recv_us=900000",
    "done 0 1 cpu_us=500000 wall_us=600000 w=0 recv_us=1000000", HELLO,
    "frame 0 8 8 job=" JOB " w=10 host=b recv_us=1000",
    "frame 0 8 8 job=" JOB " w=2 host=a recv_us=2000",
    "done 0 2 cpu_us=900000 wall_us=100000 w=10 recv_us=2000000",
    "gone w=2 why=silent lost=2 recv_us=2500000",
    "frame 0 8 8 job=" JOB " w=2 host=a recv_us=2600000",
    "done 0 3 cpu_us=300000 wall_us=300000 w=10 recv_us=4000000 try=2",
    "gone w=2 why=hung lost=1 recv_us=66000000", NULL};

static void figures_of_the_last_run(void **state)
{
    (void)state;
    struct view_log v;
    struct view_state s;
    struct buf b = {0};
    put_lines(&b, two_runs);
    view(&v, "runs", &b);
    v.heard_us = now_us() - 5000000;
    view_state(&v, &s);
    assert_true(s.now_s > 70.9 && s.now_s < 1000); /* the time goes on */
    assert_int_equal(s.total_px, 64);
    assert_int_equal(s.n_up, 1);
    assert_int_equal(s.slots[0].tasks, 2); /* 10 */
    assert_true(fabs(s.slots[0].busy_s - 1.2) < 1e-9);
    assert_true(fabs(s.slots[0].last_s - 4) < 1e-9);
    assert_int_equal(s.slots[1].tasks, 0); /* 0 */
    assert_true(s.slots[1].last_s < 0);
    assert_null(s.slots[1].done);
    assert_int_equal(s.slots[2].losses, 2); /* 2 */
    assert_string_equal(s.slots[2].event->why, "hung");
    free(s.slots);
    view_close(&v);
}

/* A lone worker: the rate is that of the last 30 s of 55. */
static void rates_are_of_late(void **state)
{
    (void)state;
    struct view_log v;
    struct view_state s;
    struct buf b = {0};
    put_lines(&b, LINES("frame 0 8 4 job=" JOB));
    put_task(&b, 0, 0, (struct lattice){0, 0, 8, 1, 1, 1}, 10, 0);
    put_task(&b, 0, 1, (struct lattice){0, 1, 8, 1, 1, 1}, 40, 0);
    put_task(&b, 0, 2, (struct lattice){0, 2, 4, 1, 1, 1}, 3, 0);
    put_task(&b, 0, 3, (struct lattice){4, 2, 2, 1, 1, 1}, 2, 0);
    put_lines(&b, LINES("bye"));
    view(&v, "lone", &b);
    v.heard_us = 0;
    view_state(&v, &s);
    assert_true(fabs(s.now_s - 55) < 1e-9); /* it has ended */
    assert_int_equal(s.done_px, 22);
    assert_true(fabs(s.slots[0].px_per_s - 14. / 30) < 1e-9);
    assert_true(s.left_s < 0);
    free(s.slots);
    view_close(&v);
}

/* ---- the table ------------------------------------------------------------------------------- */

static struct buf table(const struct view_log *v, int columns, int lines)
{
    struct buf out = {0};
    struct view_state s;
    view_state(v, &s);
    view_table(v, &s, columns, lines, "|\n", &out);
    free(s.slots);
    ends(&out);
    return out;
}

static void the_table(void **state)
{
    (void)state;
    struct view_log v;
    struct buf b = {0};
    put_lines(&b, two_runs);
    put_lines(&b, LINES("bye why=differ"));
    view(&v, "runs", &b);
    struct buf out = table(&v, 0, 0);
    assert_string_equal(text(&out),
        "0.0 % of 64 pixels, differ after 1:06|\n"
        "slot   host                 tasks    last task     px/s     idle|\n"
        "2      a                        0            -        -        -  hung|\n"
        "10     b                        2          0 3        0   70.0 %  up|\n"
        "lost at 0:03: slot 2 on a (silent) with 2 tasks|\n"
        "lost at 1:06: slot 2 on a (hung) with 1 task|\n");
    buf_free(&out);
    out = table(&v, 12, 5);
    assert_string_equal(text(&out), "0.0 % of 64 |\nslot   host |\n... and 2 mo|\nlost at 0:03|\n"
                                    "lost at 1:06|\n");
    buf_free(&out);
    out = table(&v, 12, 3);
    assert_string_equal(text(&out), "0.0 % of 64 |\nslot   host |\n... and 2 mo|\n");
    buf_free(&out);
    out = table(&v, 0, 6);
    has(&out, "idle|\n2 ");
    has(&out, "hung|\n10 ");
    has(&out, "up|\nlost at 0:03");
    buf_free(&out);
    view_close(&v);
}

/* Slots 0 and 3.1 hold others, which do their tasks. The losses of the first run do not count. */
static void slots_within_slots(void **state)
{
    (void)state;
    struct view_log v;
    struct buf b = {0};
    put_lines(
        &b, LINES(HELLO, "done 0 9 cpu_us=1 w=1 recv_us=1", "gone w=1 why=silent lost=1 recv_us=1",
                HELLO, "frame 0 8 8 job=" JOB " w=0 host=a-host-of-a-long-name recv_us=0",
                "frame 0 8 8 job=" JOB " w=3.1 host=: recv_us=0",
                "frame 0 8 8 job=" JOB " w=3 host=b recv_us=0",
                "frame 0 8 8 job=" JOB " w=30 recv_us=0",
                "done 0 0 cpu_us=100000 wall_us=100000 w=0.10 recv_us=100000",
                "done 0 1 cpu_us=100000 wall_us=100000 w=0.9 recv_us=100000",
                "done 0 2 cpu_us=100000 wall_us=100000 w=3.1.2.0 recv_us=200000",
                "gone w=0 why=silent lost=1 recv_us=300000",
                "frame 0 8 8 job=" JOB " w=0.9 recv_us=400000"));
    view(&v, "within", &b);
    struct buf out = table(&v, 0, 0);
    has(&out,
        "|\nslot   host                      tasks    last task     px/s     idle|\n"
        "0.9    a-host-of-a-long-name         1          0 1        0    0.0 %  up|\n"
        "0.10   a-host-of-a-long-name         1          0 0        0    0.0 %  silent|\n"
        "3.1.2.0 localhost                     1          0 2        0   50.0 %  up|\n"
        "30     -                             0            -        -        -  no task yet|\n"
        "lost at 0:00: slot 0 on a-host-of-a-long-name (silent) with 1 task|\n");
    lacks(&out, "slot 1 ");
    buf_free(&out);
    out = table(&v, 83, 0);
    has(&out, "\n0.9    a-host-of-a-long-n         1 ");
    buf_free(&out);
    out = table(&v, 60, 0);
    has(&out, "\n0.9    a-host-of-a-long         1 ");
    buf_free(&out);
    out = table(&v, 0, 5); /* of 4 slots and a loss */
    has(&out, "up|\n... and 3 more slots|\nlost at");
    buf_free(&out);
    view_close(&v);
}

/* Only the latest losses have lines; a slot without a host has none; damage is told. */
static void many_losses(void **state)
{
    (void)state;
    struct view_log v;
    struct buf b = {0};
    put_lines(&b, LINES(HELLO, "frame 0 8 8 job=" JOB, "done 0 0 cpu_us=1 w=0 recv_us=1"));
    for (int i = 0; i < 7; i++) {
        char line[80];
        snprintf(line, sizeof line, "gone w=%d why=%s lost=%d recv_us=%d000000", i % 3,
            i == 6 ? "left" : "hung", i == 6 ? 0 : i, i);
        put_lines(&b, LINES(line));
    }
    buf_append(&b, "done 0 1\n", 9); /* without its sum */
    put_lines(&b, LINES("bye"));
    view(&v, "losses", &b);
    struct buf out = table(&v, 0, 0);
    lacks(&out, "lost at 0:00");
    has(&out, "lost at 0:01: slot 1 on - (hung) with 1 task|");
    has(&out, "lost at 0:05: ");
    lacks(&out, "lost at 0:06");
    has(&out, "6 losses in all|");
    buf_free(&out);
    out = table(&v, 0, 10); /* of 3 lines above, 4 slots, 5 losses and their number */
    has(&out, "... and 4 more slots|\nlost at 0:01");
    has(&out, "6 losses in all|");
    has(&out, "|\n1 damaged place: ");
    buf_free(&out);
    view_close(&v);
}

static void numbers_are_short(void **state)
{
    (void)state;
    struct view_log v;
    struct buf b = {0};
    put_lines(&b, LINES("frame 0 4999 6 job=" JOB));
    put_task(&b, 0, 0, (struct lattice){0, 0, 4999, 6, 1, 1}, 30, 0);
    put_lines(&b, LINES("bye"));
    view(&v, "fast", &b);
    struct buf out = table(&v, 0, 0);
    has(&out, "100.0 % of 29994 pixels, ended after 0:30|\n");
    has(&out, "          0 0       1k    0.0 %  up|\n"); /* 999.8 */
    buf_free(&out);
    view_close(&v);
}

/* ---- the page -------------------------------------------------------------------------------- */

static struct buf page(const struct view_log *v, const char *png, double reload_s)
{
    struct buf out = {0}, picture = {0};
    struct account a;
    if (png) buf_append(&picture, png, strlen(png));
    account_make(&a, &v->log);
    view_page(v, &a, &picture, reload_s, &out);
    account_free(&a);
    buf_free(&picture);
    ends(&out);
    return out;
}

/* Two runs of a second: a unit is 2 ms. */
static void the_timeline(void **state)
{
    (void)state;
    struct view_log v;
    struct buf b = {0};
    put_lines(&b, LINES(HELLO, "frame 0 8 8 job=" JOB " w=0 host=: recv_us=0",
                      "frame 0 8 8 job=" JOB " w=1 host=there recv_us=0",
                      "done 0 0 cpu_us=100000 wall_us=100000 w=0 recv_us=100000",
                      "done 0 1 cpu_us=100000 wall_us=100000 w=0 recv_us=200200",
                      "done 0 2 cpu_us=100000 wall_us=100000 w=0 recv_us=400000",
                      "done 0 3 cpu_us=100000 wall_us=100000 w=1 recv_us=500000 try=2",
                      "gone w=1 why=<i>hung lost=2 recv_us=750000",
                      "done 0 2 cpu_us=1000 wall_us=1000 w=0 recv_us=1000000 try=2", HELLO,
                      "done 0 4 cpu_us=50 wall_us=50 w=0 recv_us=500000",
                      "gone w=1 why=left lost=0 recv_us=900000",
                      "done 0 5 cpu_us=200000 wall_us=200000 w=0 recv_us=1000000"));
    view(&v, "line", &b);
    struct buf out = page(&v, NULL, 0);
    has(&out, "<span>0 localhost</span><svg viewBox=\"0 0 1000 18\" preserveAspectRatio=\"none\">"
              "<path class=\"t\" d=\"M0.0 0h100.1v18h-100.1zM150.0 0h50.0v18h-50.0z"
              "M750.0 0h0.5v18h-0.5zM900.0 0h100.0v18h-100.0z\"/>"
              "<path class=\"w\" d=\"M499.5 0h0.5v18h-0.5z\"/></svg>");
    has(&out, "<span>1 there</span><svg viewBox=\"0 0 1000 18\" preserveAspectRatio=\"none\">"
              "<path class=\"a\" d=\"M200.0 0h50.0v18h-50.0z\"/><rect class=\"l\" x=\"375.0\" "
              "width=\"3\" height=\"18\"><title>lost: &lt;i&gt;hung, 2 tasks</title></rect></svg>");
    has(&out, "<p class=\"key\">2 s, all runs together: ");
    has(&out, "<pre>slot ");
    has(&out, "<progress max=\"64\" value=\"0\">");
    buf_free(&out);
    view_close(&v);
}

static void names_are_text(void **state)
{
    (void)state;
    static const char name[] = "<a href='x'>&\"\t.log";
    static const struct {
        const char *png, *base64;
    } cases[] = {{"M", "TQ=="}, {"Ma", "TWE="}, {"Man", "TWFu"}, {"\xfb\xef\xbf\xff", "+++//w=="}};
    struct view_log v;
    struct buf b = {0};
    put_lines(&b, LINES("frame 0 8 8 job=" JOB, "done 0 0 cpu_us=1 w=<b>"));
    view(&v, name, &b);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char expected[64];
        snprintf(
            expected, sizeof expected, "src=\"data:image/png;base64,%s\"></p>", cases[i].base64);
        struct buf out = page(&v, cases[i].png, i ? 1.5 : 0);
        has(&out, expected);
        has(&out, "<title>&lt;a href=&#39;x&#39;&gt;&amp;&quot;\xef\xbf\xbd.log</title>");
        has(&out, "<span>&lt;b&gt; </span>");
        lacks(&out, "<b>");
        if (i) has(&out, "<meta http-equiv=\"refresh\" content=\"2\">");
        else lacks(&out, "refresh");
        buf_free(&out);
    }
    view_close(&v);
}

/* More slots than lanes. */
static void lanes_are_few(void **state)
{
    (void)state;
    struct view_log v;
    struct buf b = {0};
    put_lines(&b, LINES("hello deal 0.1 format=4 selftest=0 slots=600",
                      "done 0 0 cpu_us=1 w=599 recv_us=1", "gone w=599 why=hung lost=1 recv_us=9"));
    view(&v, "wide", &b);
    struct buf out = page(&v, NULL, 0);
    has(&out, "<span>511 </span>");
    lacks(&out, "<span>512 </span>");
    has(&out, "<p>... and 88 more slots</p>");
    buf_free(&out);
    view_close(&v);
}

/* ---- the picture ----------------------------------------------------------------------------- */

/* Of 1031x3 pixels, 2x2 become one; columns are 1 and 0 in turn, the last one is .5. */
static void a_small_picture(void **state)
{
    (void)state;
    enum { W = 1031, H = 3 };
    struct buf b = {0}, png = {0};
    struct image im;
    char err[IMAGE_ERR];
    put_lines(&b, LINES("frame 0 1031 3 job=" JOB, "frame 7 1031 3 job=" JOB));
    put_task(&b, 7, 0, (struct lattice){0, 0, W, H, 1, 1}, 1, .1f); /* of the second frame */
    put_task(&b, 0, 0, (struct lattice){0, 0, W / 2, H, 2, 1}, 1, 1);
    put_task(&b, 0, 1, (struct lattice){1, 0, W / 2, H, 2, 1}, 1, 0);
    put_task(&b, 0, 2, (struct lattice){W - 1, 1, 1, 2, 1, 1}, 1, .5f); /* the first is missing */
    save("large", &b);
    buf_free(&b);
    view_picture("large", &png);
    assert_int_equal(image_decode(buf_data(&png), buf_size(&png), &im, err), 0);
    assert_int_equal(im.w, 516);
    assert_int_equal(im.h, 2);
    for (uint32_t p = 0; p < im.w * im.h; p++) {
        const float *px = im.rgba + 4 * (size_t)p;
        float alpha = p == 515 ? .5f : 1;
        if (!(fabsf(px[0] / alpha - .5f) < .01f && fabsf(px[3] - alpha) < .01f))
            fail_msg("pixel %u: %g %g", p, (double)px[0], (double)px[3]);
    }
    image_free(&im);
    buf_free(&png);
    put_lines(&b, LINES("frame 7 1031 3 job=" JOB));
    save("none", &b);
    buf_free(&b);
    view_picture("none", &png);
    assert_int_equal(buf_size(&png), 0);
}

/* ---- the trace ------------------------------------------------------------------------------- */

static struct buf trace(const struct view_log *v)
{
    struct buf out = {0};
    struct account a;
    account_make(&a, &v->log);
    view_trace(&a, &out);
    account_free(&a);
    ends(&out);
    return out;
}

/* A bar per `done`, those of the second run after the first. */
static void the_gantt(void **state)
{
    (void)state;
    struct view_log v;
    struct account a;
    struct buf b = {0}, out = {0};
    put_lines(&b, LINES(HELLO, "frame 0 8 8 job=" JOB " w=0 host=a recv_us=0",
                      "done 0 0 cpu_us=300000 wall_us=400000 w=0 recv_us=500000",
                      "done 0 0 cpu_us=100000 wall_us=100000 w=1 recv_us=600000", HELLO,
                      "done 0 1 cpu_us=200000 wall_us=200000 w=0 recv_us=400000"));
    view(&v, "bars", &b);
    account_make(&a, &v.log);
    view_gantt(&a, .5, "n", &out);
    buf_append(&out, "", 1);
    has(&out, "# x: time\n# y: slot\n# note: efficiency 0.500: at least 0.5 s, and it took 1 s, "
              "all runs together\n# lanes: 0 1\nexperiment\t");
    has(&out, "\nn\treal\ttask\t0.100000\ts\t0\t1\t1\t0\t0.500000\nn\treal\twasted\t");
    has(&out, "\nn\treal\ttask\t0.800000\ts\t0\t1\t3\t0\t1.000000\n");
    buf_free(&out);
    account_free(&a);
    view_close(&v);
}

static void the_trace(void **state)
{
    (void)state;
    struct view_log v;
    struct buf b = {0};
    put_lines(&b, two_runs);
    put_lines(&b, LINES("frame 0 8 8 job=" JOB " w=\"\\ host=b recv_us=66000001"));
    view(&v, "runs", &b);
    struct buf out = trace(&v);
    has(&out, "\"pid\":0,\"tid\":0,\"args\":{\"name\":\"the run\"}}");
    /* hosts: a, b, localhost; slots: "\, 0, 1, 2, 10 */
    has(&out, "\"process_name\",\"ph\":\"M\",\"pid\":1,\"tid\":0,\"args\":{\"name\":\"a\"}}");
    has(&out, "\"process_name\",\"ph\":\"M\",\"pid\":2,\"tid\":0,\"args\":{\"name\":\"b\"}}");
    has(&out, "\"pid\":2,\"tid\":1,\"args\":{\"name\":\"slot \\\"\\\\\"}}");
    has(&out, "\"pid\":2,\"tid\":5,\"args\":{\"name\":\"slot 10\"}}");
    has(&out,
        "\"process_name\",\"ph\":\"M\",\"pid\":3,\"tid\":0,\"args\":{\"name\":\"localhost\"}}");
    lacks(&out, "\"pid\":4");
    has(&out, "\"name\":\"task 0 0\",\"cat\":\"task\",\"ph\":\"X\",\"ts\":300000,\"dur\":600000,");
    has(&out, "\"ts\":4700000,\"dur\":300000,\"pid\":2,\"tid\":5,\"args\":{\"pixels\":0,"
              "\"cpu_us\":300000,\"try\":2,\"kind\":\"given again\"}}");
    has(&out, "\"name\":\"lost: silent\",\"cat\":\"slot\",\"ph\":\"i\",\"s\":\"t\",\"ts\":3500000,"
              "\"pid\":1,\"tid\":4,\"args\":{\"tasks_lost\":2}}");
    has(&out, "\"name\":\"ready\",");
    buf_free(&out);
    view_close(&v);
    /* A loss after the last task of its run is not in the next one. Two slots without times. */
    put_lines(
        &b, LINES("frame 0 8 8 job=" JOB " w=0", "done 0 0 cpu_us=1 wall_us=500000 w=0",
                "done 0 1 cpu_us=1 wall_us=100000 w=1", "gone w=1 why=silent lost=2 recv_us=900000",
                HELLO, "done 0 2 cpu_us=1 wall_us=100000 w=0"));
    view(&v, "late", &b);
    out = trace(&v);
    has(&out, "\"name\":\"lost: silent\",\"cat\":\"slot\",\"ph\":\"i\",\"s\":\"t\",\"ts\":500000,");
    has(&out, "\"ph\":\"C\",\"ts\":100000,\"pid\":0,\"args\":{\"done\":0}},\n"
              "{\"name\":\"pixels\",\"ph\":\"C\",\"ts\":500000,");
    buf_free(&out);
    out = page(&v, NULL, 0);
    has(&out, "<rect class=\"l\" x=\"833.3\"");
    buf_free(&out);
    view_close(&v);
}

/* A curve of few points, the last of which has all pixels. */
static void a_curve_has_few_points(void **state)
{
    (void)state;
    struct view_log v;
    struct buf b = {0};
    uint32_t n = 0;
    put_lines(&b, LINES("frame 0 50 50 job=" JOB));
    for (uint32_t i = 0; i < 2499; i++)
        put_task(&b, 0, i, (struct lattice){i % 50, i / 50, 1, 1, 1, 1}, 1e-3, 0);
    view(&v, "many", &b);
    struct buf out = trace(&v);
    for (const char *c = text(&out); (c = strstr(c, "\"name\":\"pixels\"")); c++) n++;
    assert_in_range(n, 500, 1000);
    has(&out, "\"ts\":2499000,\"pid\":0,\"args\":{\"done\":2499}}\n]}\n");
    buf_free(&out);
    view_close(&v);
}

static int make_dir(void **state)
{
    (void)state;
    return !scratch_make(dir) || chdir(dir) != 0;
}

static int remove_dir(void **state)
{
    (void)state;
    return system("rm -r ./* && rmdir \"$PWD\"");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_log_that_changes),
        cmocka_unit_test(figures_of_the_last_run),
        cmocka_unit_test(rates_are_of_late),
        cmocka_unit_test(the_table),
        cmocka_unit_test(slots_within_slots),
        cmocka_unit_test(many_losses),
        cmocka_unit_test(numbers_are_short),
        cmocka_unit_test(the_timeline),
        cmocka_unit_test(names_are_text),
        cmocka_unit_test(lanes_are_few),
        cmocka_unit_test(a_small_picture),
        cmocka_unit_test(the_gantt),
        cmocka_unit_test(the_trace),
        cmocka_unit_test(a_curve_has_few_points),
    };
    return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
