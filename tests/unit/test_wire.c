/*
 * wire: every record there and back; logs torn at every byte, garbage between records, flipped
 * bits, any way of feeding; what is refused; what is passed on; and what an enemy can make a reader
 * pay.
 */
#include "wire/wire.h"

#include <errno.h>
#include <inttypes.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

/* ---- helpers ---------------------------------------------------------------------------- */

static void feed_text(struct decoder *d, const char *text) { wire_feed(d, text, strlen(text)); }

/* One record and nothing else, or a failure. */
static void only(struct decoder *d, const struct buf *b, struct record *r)
{
    *d = (struct decoder){0};
    wire_feed(d, buf_data(b), buf_size(b));
    wire_end(d);
    if (wire_next(d, r) != WIRE_RECORD) fail_msg("refused: %s", d->why);
}

static void no_more(struct decoder *d)
{
    struct record r;
    assert_int_equal(wire_next(d, &r), WIRE_MORE);
    assert_int_equal(d->bad, 0);
    wire_free(d);
}

static void assert_word(const struct record *r, const char *key, const char *expected)
{
    char text[64];
    if (!expected) assert_false(rec_str(r, key, text, sizeof text));
    else assert_true(rec_str(r, key, text, sizeof text));
    if (expected) assert_string_equal(text, expected);
}

static const struct task some_task = {7, 4294967295u, {1, 2, 3, 2, 4, 5}, 12, 0};

#define JOB "0123456789abcdef"

/* Pixels with every kind of float from 0 to 1. */
static void some_pixels(float *rgba, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint32_t bits = (uint32_t)rng_u64(9, i) & 0x3f7fffff;
        memcpy(rgba + i, &bits, 4);
    }
}

/* A small log in which there is one of everything, ended by what must survive. */
static void some_log(struct buf *b)
{
    float rgba[16];
    some_pixels(rgba, 16);
    rgba[3] = 0;
    struct task t = {0, 1, {0, 1, 2, 2, 1, 1}, -1, 0};
    wire_hello(b, "rtworker", "00ff", 1.25, 0, 1);
    wire_job(b, &(struct frame_size){.w = 4, .h = 4}, JOB, "with=rtworker");
    wire_frag(b, &t, &t.at, JOB, rgba);
    wire_done(b, &t, 120, 130);
    wire_failed(b, &t, "failed", "no memory: 90% of 2 GB", "w=3");
    wire_plain(b, REC_BEAT, "w=3");
    wire_plain(b, REC_UP, "w=4 host=: power=1");
    wire_plain(b, REC_GONE, "w=4 why=exit-3");
    wire_plain(b, REC_DRAIN, "w=4");
    wire_plain(b, REC_NONE, "peer=4 idle=1 next=0");
    t.id = 2;
    wire_frag(b, &t, &t.at, JOB, rgba);
    wire_done(b, &t, 1, 2);
    wire_plain(b, REC_BYE, NULL);
}

/* Words of other machines are one word of a record, whatever they have, and are cut. */
static void words_come_as_they_were_said(void **state)
{
    (void)state;
    static const char *const words[] = {"", "disk full", "90% of \"2 GB\"", "50%20",
        "\x1b[31mred\n", "gr\xc3\xbc\xc3\x9f", "a=b c=d"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        struct decoder d = {.upward = true};
        struct record r;
        char said[WIRE_SAID], why[24];
        struct task t = {.frame = 3, .id = 4};
        wire_failed(&d.in, &t, "failed", words[i], NULL);
        assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
        assert_true(r.kind == REC_FAIL && r.task.frame == 3 && r.task.id == 4);
        assert_true(rec_str(&r, "why", why, sizeof why) && strcmp(why, "failed") == 0);
        rec_said(&r, said);
        assert_string_equal(said, words[i]);
        wire_free(&d);
    }
    char many[2 * WIRE_SAID] = "";
    memset(many, ' ', sizeof many - 1);
    struct decoder d = {.upward = true};
    struct record r;
    char said[WIRE_SAID];
    wire_failed(&d.in, &(struct task){0}, "failed", many, NULL);
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    rec_said(&r, said);
    assert_true(strlen(said) == WIRE_SAID - 1 && strspn(said, " ") == WIRE_SAID - 1);
    wire_free(&d);
}

/* What a stream holds: the records' bytes one after the other, each behind its length. */
struct seen {
    struct buf bytes;
    int records;
};

static void drain(struct decoder *d, struct seen *s)
{
    struct record r;
    for (enum wire_result got; (got = wire_next(d, &r)) != WIRE_MORE;) {
        if (got == WIRE_BAD) continue;
        buf_printf(&s->bytes, "[%zu+%zu]", r.line_len, r.body_len);
        buf_append(&s->bytes, r.line, r.line_len);
        buf_append(&s->bytes, r.body, r.body_len);
        s->records++;
    }
}

/* All of p[0..n), in pieces of `step` bytes (0: at random). */
static struct seen decode(struct decoder *d, const unsigned char *p, size_t n, size_t step)
{
    struct seen s = {0};
    for (size_t at = 0, k = 0; at < n; k++) {
        size_t some = step ? step : (size_t)(1 + rng_u64(n, k) % 90);
        if (some > n - at) some = n - at;
        unsigned char *piece = xmalloc(some, 1); /* so that a read past it is seen */
        memcpy(piece, p + at, some);
        wire_feed(d, piece, some);
        free(piece);
        drain(d, &s);
        at += some;
    }
    wire_end(d);
    drain(d, &s);
    assert_int_equal(buf_size(&d->in), 0);
    return s;
}

static void assert_same(const struct seen *a, const struct seen *b)
{
    assert_int_equal(a->records, b->records);
    assert_int_equal(buf_size(&a->bytes), buf_size(&b->bytes));
    assert_memory_equal(buf_data(&a->bytes), buf_data(&b->bytes), buf_size(&a->bytes));
}

/* ---- there and back --------------------------------------------------------------------- */

static void test_frame(void **state)
{
    (void)state;
    struct buf b = {0};
    struct decoder d;
    struct record r;
    wire_frame(&b, 4294967295u, 65535, 1, "job=00ff");
    assert_memory_equal(buf_data(&b), "frame 4294967295 65535 1 job=00ff\n", buf_size(&b));
    only(&d, &b, &r);
    assert_int_equal(r.kind, REC_FRAME);
    assert_int_equal(r.task.frame, 4294967295u);
    assert_true(r.frame_w == 65535 && r.frame_h == 1 && r.body_len == 0);
    assert_word(&r, "job", "00ff");
    no_more(&d);
    buf_free(&b);
}

static void test_state(void **state)
{
    (void)state;
    static const enum rec_kind kinds[] = {REC_SCENE, REC_GRID, REC_SPEC};
    static const char body[] = "v\nfrom 0 0 0\0task 0 0 0 0 1 1 1 1\n";
    for (int k = 0; k < 3; k++)
        for (size_t n = 0; n <= sizeof body; n += sizeof body) {
            struct buf b = {0};
            struct decoder d;
            struct record r;
            wire_state(&b, kinds[k], body, n);
            only(&d, &b, &r);
            assert_int_equal(r.kind, kinds[k]);
            assert_int_equal(r.body_len, n);
            assert_memory_equal(r.body, body, n);
            no_more(&d);
            buf_free(&b);
        }
}

static void assert_task(const struct task *a, const struct task *b)
{
    assert_true(a->frame == b->frame && a->id == b->id && a->to == b->to);
    assert_memory_equal(&a->at, &b->at, sizeof a->at);
}

static void test_task(void **state)
{
    (void)state;
    struct buf b = {0};
    struct decoder d;
    struct record r;
    struct task t = some_task;
    wire_task(&b, &t);
    assert_memory_equal(buf_data(&b), "task 7 4294967295 1 2 3 2 4 5 to=12\n", buf_size(&b));
    only(&d, &b, &r);
    assert_int_equal(r.kind, REC_TASK);
    assert_task(&r.task, &t);
    no_more(&d);
    buf_consume(&b, buf_size(&b));
    t.to = -1;
    wire_task(&b, &t);
    only(&d, &b, &r);
    assert_task(&r.task, &t);
    no_more(&d);
    buf_free(&b);
}

static void test_frag(void **state)
{
    (void)state;
    float rgba[24], back[24];
    struct buf b = {0};
    struct decoder d;
    struct record r;
    some_pixels(rgba, 24);
    wire_frag(&b, &some_task, &some_task.at, JOB, rgba);
    only(&d, &b, &r);
    assert_int_equal(r.kind, REC_FRAG);
    assert_true(r.task.frame == 7 && r.task.id == 4294967295u && r.task.to == -1);
    assert_memory_equal(&r.task.at, &some_task.at, sizeof r.task.at);
    assert_int_equal(r.body_len, 6 * WIRE_PIXEL_BYTES);
    rec_pixels(&r, back);
    assert_memory_equal(back, rgba, sizeof rgba);
    assert_word(&r, "ch", "4");
    /* Little-endian, whatever the host. */
    uint32_t bits;
    memcpy(&bits, rgba, 4);
    for (int k = 0; k < 4; k++) assert_int_equal(r.body[k], bits >> (8 * k) & 255);
    no_more(&d);
    buf_free(&b);
}

static void test_largest_frag(void **state)
{
    (void)state;
    struct task t = {.at = {0, 0, WIRE_FRAG_PIXELS_MAX, 1, 1, 1}};
    float *rgba = xcalloc((size_t)WIRE_FRAG_PIXELS_MAX + 1, 16);
    struct buf b = {0};
    struct decoder d = {0};
    struct record r;
    wire_frag(&b, &t, &t.at, JOB, rgba);
    only(&d, &b, &r);
    no_more(&d);
    buf_consume(&b, buf_size(&b));
    t.at.w++;
    wire_frag(&b, &t, &t.at, JOB, rgba);
    wire_feed(&d, buf_data(&b), buf_size(&b));
    assert_int_equal(wire_next(&d, &r), WIRE_BAD);
    assert_non_null(strstr(d.why, "at most 65536 pixels"));
    wire_free(&d);
    buf_free(&b);
    free(rgba);
}

static void test_done_and_plain(void **state)
{
    (void)state;
    struct buf b = {0};
    struct decoder d;
    struct record r;
    int64_t v;
    double x;
    wire_failed(&b, &some_task, "out-of-memory", "", "w=3");
    only(&d, &b, &r);
    assert_true(r.kind == REC_FAIL && r.task.frame == 7 && r.task.id == 4294967295u);
    assert_true(rec_is(&r, "why", "out-of-memory") && rec_slot(&r) == 3 && rec_sealed(&r));
    no_more(&d);
    buf_consume(&b, buf_size(&b));
    wire_done(&b, &some_task, 5, INT64_MAX);
    only(&d, &b, &r);
    assert_true(r.kind == REC_DONE && r.task.frame == 7 && r.task.id == 4294967295u);
    assert_true(rec_int(&r, "cpu_us", 0, 9, &v) && v == 5);
    assert_true(rec_int(&r, "wall_us", 0, INT64_MAX, &v) && v == INT64_MAX);
    assert_false(rec_int(&r, "cpu_us", 0, 4, &v));
    assert_false(rec_int(&r, "us", 0, 9, &v)); /* the end of a key is no key */
    no_more(&d);
    buf_consume(&b, buf_size(&b));
    wire_hello(&b, "rtworker", "abc", 1.347, .5, 1);
    only(&d, &b, &r);
    assert_true(r.kind == REC_HELLO && rec_real(&r, "power", 0, 10, &x) && x == 1.347);
    assert_false(rec_real(&r, "selftest", 0, 10, &x));
    assert_word(&r, "selftest", "abc");
    assert_word(&r, "none", NULL);
    char small[4];
    assert_false(rec_str(&r, "selftest", small, 3)); /* no room for its end */
    assert_true(rec_str(&r, "selftest", small, 4));
    no_more(&d);
    static const enum rec_kind plain[] = {REC_FLUSH, REC_BEAT, REC_BYE};
    for (int k = 0; k < 3; k++) {
        buf_consume(&b, buf_size(&b));
        wire_plain(&b, plain[k], k == 1 ? "" : NULL);
        only(&d, &b, &r);
        assert_int_equal(r.kind, plain[k]);
        assert_int_equal(r.line_len, strlen(rec_name(plain[k])));
        no_more(&d);
    }
    buf_free(&b);
}

/* ---- passing on ------------------------------------------------------------------------- */

/* It is this line, and sealed if that is more than a word. */
static void assert_unsealed(const struct buf *b, const char *expected)
{
    size_t n = strcspn(expected, "\n");
    bool seal = memchr(expected, ' ', n);
    size_t at = seal ? n + WIRE_SEAL_BYTES : n;
    assert_int_equal(buf_size(b), strlen(expected) + at - n);
    assert_memory_equal(buf_data(b), expected, n);
    if (seal) assert_memory_equal(buf_data(b) + n, " sum=", 5);
    assert_memory_equal(buf_data(b) + at, expected + n, strlen(expected) - n);
}

static void check_forward(
    const char *line, const char *const *drop, const char *extra, const char *expected)
{
    struct decoder d = {0};
    struct record r;
    struct buf b = {0};
    feed_text(&d, line);
    wire_end(&d);
    if (wire_next(&d, &r) != WIRE_RECORD) fail_msg("refused: %s", d.why);
    wire_forward(&b, &r, drop, extra);
    assert_unsealed(&b, expected);
    buf_free(&b);
    wire_free(&d);
}

static void assert_ring(
    enum rec_kind kind, const struct rec_ring *m, int32_t to, const char *expected)
{
    struct buf b = {0};
    struct decoder d;
    struct record r;
    struct rec_ring got;
    struct task t = some_task;
    t.to = to;
    wire_ring(&b, kind, &t, m);
    assert_unsealed(&b, expected);
    only(&d, &b, &r);
    assert_true(r.kind == kind && r.task.to == to && rec_ring(&r, &got));
    assert_true(got.peer == m->peer && got.next == m->next && got.me == m->me && got.n == m->n);
    assert_true(got.takes == m->takes);
    assert_true(got.idle == m->idle && got.published == m->published);
    if (kind == REC_GIVE) assert_true(r.task.frame == some_task.frame && r.task.id == some_task.id);
    no_more(&d);
    buf_free(&b);
}

static void test_ring(void **state)
{
    (void)state;
    const struct rec_ring nobody = {.peer = -1, .next = -1, .me = -1, .n = -1};
    struct rec_ring place = nobody, m = nobody;
    place.me = 1048575;
    place.n = 1048576;
    assert_ring(REC_RING, &place, 3, "ring me=1048575 n=1048576 rules=default to=3\n");
    place.published = true;
    assert_ring(REC_RING, &place, -1, "ring me=1048575 n=1048576 rules=published\n");
    assert_ring(REC_ASK, &m, -1, "ask\n");
    m.peer = 1048575;
    assert_ring(REC_ASK, &m, 0, "ask peer=1048575 to=0\n");
    m.takes = 1000000;
    assert_ring(REC_ASK, &m, 0, "ask peer=1048575 takes=1000000 to=0\n");
    m.takes = 0;
    assert_ring(REC_GIVE, &m, -1, "give 7 4294967295 peer=1048575\n");
    assert_ring(REC_CRASHED, &m, -1, "crashed peer=1048575\n");
    assert_ring(REC_NONE, &m, 2147483647, "none peer=1048575 to=2147483647\n");
    m.next = 0;
    assert_ring(REC_HEIR, &m, 5, "heir peer=1048575 next=0 to=5\n");
    m.idle = true;
    assert_ring(REC_NONE, &m, -1, "none peer=1048575 idle=1 next=0\n");
}

static void test_forward(void **state)
{
    (void)state;
    static const char *const drop[] = {"w", "to", NULL};
    check_forward("beat\n", NULL, NULL, "beat\n");
    check_forward("beat\n", drop, "w=2", "beat w=2\n");
    check_forward("done 0 1 colour=red w=9 cpu_us=4 ww=1 x=w=2\n", drop, "w=3.9",
        "done 0 1 colour=red cpu_us=4 ww=1 x=w=2 w=3.9\n");
    check_forward("task 0 1 0 0 1 1 1 1 to=4\n", drop, NULL, "task 0 1 0 0 1 1 1 1\n");
    check_forward("scene new=1 bytes=3\nabc\n", drop, "w=1", "scene new=1 bytes=3 w=1\nabc\n");
    check_forward("beat w=1 w=2\n", drop, NULL, "beat\n");
    check_forward("beat empty=\n", drop, NULL, "beat empty=\n");
    check_forward("beat w=3 sum=c52c795e\n", drop, NULL, "beat\n");
    check_forward("beat w=3 sum=c52c795e\n", NULL, "x=1", "beat w=3 x=1\n");
}

/* ---- what is refused -------------------------------------------------------------------- */

static void test_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {"\n", "tasks 0 0 0 0 1 1 1 1\n", "Task 0 0 0 0 1 1 1 1\n",
        "task\n", "task 0 0 0 0 1 1 1\n", "task 0 0 0 0 1 1 1 1 1\n", "task 0 0 0 0 1 1 1 x\n",
        "task -1 0 0 0 1 1 1 1\n", "task 0 4294967296 0 0 1 1 1 1\n", "task 0 0 65536 0 1 1 1 1\n",
        "task 0 0 0 0 0 1 1 1\n", "task 0 0 0 0 1 0 1 1\n", "task 0 0 0 0 1 1 0 1\n",
        "task 0 0 0 0 1 1 1 0\n", "task 0 0 0 0 1 65536 1 1\n", "task  0 0 0 0 1 1 1 1\n",
        "task 0 0 0 0 1 1 1 1 \n", "task 0 0 0 0 1 1 1 1 to\n", "task 0 0 0 0 1 1 1 1 =1\n",
        "task 0 0 0 0 1 1 1 1 to=-1\n", "task 0 0 0 0 1 1 1 1 to=x\n",
        "task 0 0 0 0 1 1 1 1 to=2147483648\n", "task 0 0 0 0 1 1 1 1 bytes=0\n",
        "task 0 0 0 0 1 1 1 1\r\n", "task\t0 0 0 0 1 1 1 1\n",
        "task 00000000000000000000 0 0 0 1 1 1 1\n", "frame 0 0 1\n", "frame 0 1 65536\n",
        "frame 0 1\n", "scene\n", "scene bytes=\n", "scene bytes=-1\n", "scene bytes=2147483648\n",
        "scene bytes=1 crc=x\nA\n", "scene bytes=1 crc=4294967296\nA\n", "scene bytes=1 crc=5\nA\n",
        "scene bytes=3\nab", "scene bytes=3\nabc", "scene bytes=3\nabcbeat\n", "scene bytes=0\n",
        "frag 0 0 0 0 1 1 1 1 ch=4 bytes=16\n0123456789abcdef\n",
        "frag 0 0 0 0 1 1 1 1 ch=3 crc=0 bytes=16\n0123456789abcdef\n",
        "frag 0 0 0 0 1 1 1 1 ch=4 crc=0 bytes=15\n0123456789abcde\n",
        "frag 0 0 0 0 65537 1 1 1 ch=4 crc=0 bytes=1048592\n",
        "frag 0 0 0 0 4294967295 65535 1 1 ch=4\n", "beat w=3 sum=c52c795f\n",
        "beat w=3 sum=C52C795E\n", "beat w=3 sum=zzzzzzzz\n", "hello\n", "hello rtworker\n",
        "hello rtworker x=1\n", "beat 3\n", "beat w\n", "beat \303\244=1\n", "beat", "flush",
        "up\n", "gone why=x\n", "up host=: power=1\n", "task 0 0 0 0 1 1 1 1 peer=-1\n",
        "task 0 0 0 0 1 1 1 1 peer=1048576\n", "ask 3\n", "ask peer=\n", "ask peer=1048576\n",
        "give 0 1\n", "give 0 peer=1\n", "give 0 4294967296 peer=1\n", "give 0 1 peer=x\n",
        "none\n", "none peer=0 idle=2\n", "none peer=0 next=-1\n", "crashed\n",
        "crashed peer=1 bytes=0\n", "heir next=1\n", "ring n=1 rules=default\n",
        "ring me=0 rules=default\n", "ring me=0 n=0 rules=default\n",
        "ring me=1 n=1 rules=default\n", "ring me=0 n=1048577 rules=default\n",
        "ring me=0 n=1 rules=old\n", "ring me=0 n=1\n", "drain\n", "drain to=1\n",
        "drain w=0 bytes=0\n", "leave\n", "leave w=1\n", "leave to=-1\n", "joins 1\n", "alive\n",
        "alive within=.4\n", "alive within=1e9\n", "alive within=x\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct decoder d = {0};
        struct record r;
        feed_text(&d, bad[i]);
        wire_end(&d);
        if (wire_next(&d, &r) != WIRE_BAD) fail_msg("taken: %s", bad[i]);
        assert_non_null(strstr(d.why, ", expected "));
        assert_int_equal(d.bad, 1);
        wire_free(&d);
    }
}

/* Reading what workers say, a state record is refused before its body is waited for. */
static void test_upward(void **state)
{
    (void)state;
    struct decoder d = {.upward = true};
    struct record r;
    feed_text(&d, "scene bytes=2147483647\nbeat\n");
    assert_int_equal(wire_next(&d, &r), WIRE_BAD);
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    assert_int_equal(r.kind, REC_BEAT);
    wire_free(&d);
}

static void test_line_length(void **state)
{
    (void)state;
    char line[WIRE_LINE_MAX + 2];
    for (size_t n = WIRE_LINE_MAX - 1; n <= WIRE_LINE_MAX + 1; n++) { /* with its newline */
        struct decoder d = {0};
        struct record r;
        memset(line, 'x', sizeof line);
        memcpy(line, "beat k=", 7);
        line[n - 1] = '\n';
        wire_feed(&d, line, n);
        assert_int_equal(wire_next(&d, &r), n <= WIRE_LINE_MAX ? WIRE_RECORD : WIRE_BAD);
        wire_free(&d);
    }
}

/* ---- losing and finding ----------------------------------------------------------------- */

static void test_any_feeding(void **state)
{
    (void)state;
    struct buf log = {0};
    some_log(&log);
    struct decoder d = {0};
    struct seen whole = decode(&d, buf_data(&log), buf_size(&log), buf_size(&log));
    assert_int_equal(whole.records, 13);
    assert_int_equal(d.skipped, 0);
    wire_free(&d);
    for (size_t step = 0; step < 70; step++) {
        struct seen s = decode(&d, buf_data(&log), buf_size(&log), step);
        assert_same(&s, &whole);
        assert_int_equal(d.bad, 0);
        buf_free(&s.bytes);
        wire_free(&d);
    }
    buf_free(&whole.bytes);
    buf_free(&log);
}

/* The records that begin in [from, to) of a good log and end by then, as a seen; *left: bytes of
 * a last part. */
static struct seen records_of(const struct buf *log, size_t from, size_t to)
{
    struct decoder d = {0};
    struct seen s = {0};
    struct record r;
    size_t at = 0;
    wire_feed(&d, buf_data(log), buf_size(log));
    while (wire_next(&d, &r) == WIRE_RECORD) {
        size_t end = at + rec_size(&r);
        if (at >= from && end <= to) {
            buf_printf(&s.bytes, "[%zu+%zu]", r.line_len, r.body_len);
            buf_append(&s.bytes, r.line, r.line_len);
            buf_append(&s.bytes, r.body, r.body_len);
            s.records++;
        }
        at = end;
    }
    wire_free(&d);
    return s;
}

/* A log that ends at any byte, as after a crash, and is then appended to: all but the torn
 * record is there. */
static void test_torn_at_every_byte(void **state)
{
    (void)state;
    struct buf log = {0};
    some_log(&log);
    struct seen again = records_of(&log, 0, SIZE_MAX);
    for (size_t cut = 0; cut <= buf_size(&log); cut++)
        for (size_t step = 0; step <= 1; step++) {
            struct decoder d = {0};
            struct buf torn = {0};
            struct seen expected = records_of(&log, 0, cut);
            size_t good = buf_size(&expected.bytes);
            buf_append(&torn, buf_data(&log), cut);
            struct seen head = decode(&d, buf_data(&torn), cut, step);
            assert_same(&head, &expected);
            assert_true(d.bad <= 1);
            assert_true((d.skipped > 0) == (d.bad > 0));
            wire_free(&d);
            buf_append(&torn, buf_data(&log), buf_size(&log));
            struct seen both = decode(&d, buf_data(&torn), buf_size(&torn), step);
            /* The head of the torn one and the line after it may make one bad line of two; a torn
             * `hello` says no more than the first record does. */
            assert_true(d.bad <= 1);
            assert_true(both.records >= expected.records + again.records - 1);
            assert_memory_equal(buf_data(&both.bytes), buf_data(&expected.bytes), good);
            size_t tail = buf_size(&log) / 2;
            assert_memory_equal(buf_data(&both.bytes) + buf_size(&both.bytes) - tail,
                buf_data(&again.bytes) + buf_size(&again.bytes) - tail, tail);
            buf_free(&head.bytes);
            buf_free(&both.bytes);
            buf_free(&expected.bytes);
            buf_free(&torn);
            wire_free(&d);
        }
    buf_free(&again.bytes);
    buf_free(&log);
}

/* The first bytes are missing: all records that are whole are found. */
static void test_begun_at_every_byte(void **state)
{
    (void)state;
    struct buf log = {0};
    some_log(&log);
    for (size_t from = 0; from <= buf_size(&log); from++) {
        struct decoder d = {0};
        struct seen expected = records_of(&log, from, SIZE_MAX);
        struct seen s = decode(&d, buf_data(&log) + from, buf_size(&log) - from, from & 1);
        /* The rest of a hello's line holds no record; that of another may by chance: here it
         * does not. */
        assert_same(&s, &expected);
        assert_true(d.bad <= 1);
        buf_free(&expected.bytes);
        buf_free(&s.bytes);
        wire_free(&d);
    }
    buf_free(&log);
}

/* Any bit of a frag flipped: it is lost, and all that follows is there. */
static void test_every_bit_flipped(void **state)
{
    (void)state;
    float rgba[8];
    struct buf b = {0};
    struct task t = {0, 1, {0, 1, 2, 1, 1, 1}, -1, 0};
    some_pixels(rgba, 8);
    wire_frag(&b, &t, &t.at, JOB, rgba);
    size_t n = buf_size(&b);
    wire_done(&b, &t, 1, 2);
    wire_plain(&b, REC_BYE, NULL);
    for (size_t bit = 0; bit < 8 * n; bit++) {
        struct decoder d = {.upward = true};
        b.data[b.off + bit / 8] ^= (unsigned char)(1 << bit % 8);
        struct seen s = decode(&d, buf_data(&b), buf_size(&b), bit & 1);
        assert_true(s.records == 2 && d.bad == 1 && d.skipped == n);
        wire_free(&d);
        buf_free(&s.bytes);
        b.data[b.off + bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
    buf_free(&b);
}

/* Two bits of any sealed line: as above. */
static void test_sealed_lines(void **state)
{
    (void)state;
    struct buf log = {0};
    struct decoder d = {.upward = true};
    struct record r;
    some_log(&log);
    wire_feed(&d, buf_data(&log), buf_size(&log));
    while (wire_next(&d, &r) == WIRE_RECORD) {
        assert_true(rec_sealed(&r) || r.line_len == strlen(rec_name(r.kind)));
        for (uint64_t k = 0; k < 200 && rec_sealed(&r); k++) {
            struct decoder one = {.upward = true};
            struct record got;
            char line[WIRE_LINE_MAX];
            memcpy(line, r.line, r.line_len);
            line[r.line_len] = '\n';
            size_t bits = 8 * r.line_len, at[2] = {rng_u64(r.line_len, 2 * k) % bits};
            at[1] = (at[0] + 1 + rng_u64(r.line_len, 2 * k + 1) % (bits - 1)) % bits;
            for (int i = 0; i < 2; i++) line[at[i] / 8] ^= (char)(1 << at[i] % 8);
            wire_feed(&one, line, r.line_len + 1);
            wire_end(&one);
            bool hello = wire_next(&one, &got) == WIRE_RECORD && got.kind == REC_HELLO;
            /* A hello may have none, and says something else then only in three bits. */
            assert_true(hello ? !rec_sealed(&got) : one.bad == 1);
            wire_free(&one);
        }
    }
    wire_free(&d);
    buf_free(&log);
}

/* Only workers' lines must be sealed: tasks written by hand have no sums. */
static void test_seal_is_asked_for(void **state)
{
    (void)state;
    static const char text[] = "done 0 1 cpu_us=1 wall_us=1\nhello x 1 format=9 selftest=0\nbeat\n";
    for (int upward = 0; upward <= 1; upward++) {
        struct decoder d = {.upward = upward};
        struct record r;
        char why[160] = "";
        feed_text(&d, text);
        assert_int_equal(wire_next(&d, &r), upward ? WIRE_BAD : WIRE_RECORD);
        if (upward) assert_non_null(strstr(d.why, "no sum, expected sum="));
        assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
        assert_false(rec_ours(&r, why));
        assert_string_equal(
            why, "is of format 9, expected 4: use programs of one version, or begin a new log");
        assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
        assert_true(rec_ours(&r, why));
        wire_free(&d);
    }
    struct decoder d = {.upward = true};
    struct record r;
    char why[160];
    feed_text(&d, "hello rtworker 0.1 selftest=00ff\n");
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    assert_false(rec_ours(&r, why));
    assert_string_equal(
        why, "is of format 1, expected 4: use programs of one version, or begin a new log");
    wire_free(&d);
}

/* A frag that is no light is bad as a whole, whatever its body looks like. */
static void test_light(void **state)
{
    (void)state;
    const struct {
        float value;
        int channel;
        bool good;
    } cases[] = {{0, 0, true}, {-0.0f, 1, true}, {1e-45f, 2, true}, {3.4028235e38f, 0, true},
        {1, 3, true}, {-0.0f, 3, true}, {1.0000001f, 3, false}, {-1e-45f, 3, false},
        {-1e-45f, 0, false}, {-1, 1, false}, {INFINITY, 2, false}, {-INFINITY, 0, false},
        {INFINITY, 3, false}, {NAN, 0, false}, {-NAN, 1, false}, {NAN, 3, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (size_t at = 0; at < 3; at++) {
            float rgba[12];
            struct task t = {.at = {0, 0, 3, 1, 1, 1}};
            struct buf b = {0};
            struct decoder d = {.upward = true};
            struct record r;
            some_pixels(rgba, 12);
            rgba[4 * at + (size_t)cases[i].channel] = cases[i].value;
            wire_frag(&b, &t, &t.at, JOB, rgba);
            size_t n = buf_size(&b);
            wire_plain(&b, REC_BEAT, NULL);
            wire_feed(&d, buf_data(&b), buf_size(&b));
            assert_int_equal(wire_next(&d, &r), cases[i].good ? WIRE_RECORD : WIRE_BAD);
            if (!cases[i].good) assert_non_null(strstr(d.why, "bad pixels"));
            assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
            assert_int_equal(r.kind, REC_BEAT);
            assert_int_equal(d.skipped, cases[i].good ? 0 : n);
            wire_free(&d);
            buf_free(&b);
        }
}

static void test_garbage_between(void **state)
{
    (void)state;
    struct buf log = {0}, dirty = {0};
    some_log(&log);
    struct seen expected = records_of(&log, 0, SIZE_MAX);
    struct decoder d = {0};
    struct record r;
    size_t garbage = 0;
    int gaps = 0;
    wire_feed(&d, buf_data(&log), buf_size(&log));
    for (; wire_next(&d, &r) == WIRE_RECORD; gaps++) {
        size_t n = 1 + (size_t)(rng_u64(3, (uint64_t)gaps) % 5000);
        for (size_t i = 0; i < n; i++) {
            unsigned char byte = (unsigned char)rng_u64(4, garbage++);
            buf_append(&dirty, &byte, 1);
        }
        buf_append(&dirty, "\n", 1);
        garbage++;
        wire_copy(&dirty, &r);
    }
    wire_free(&d);
    for (size_t step = 0; step < 3; step++) {
        struct seen s = decode(&d, buf_data(&dirty), buf_size(&dirty), step);
        assert_same(&s, &expected);
        assert_int_equal(d.bad, gaps);
        assert_int_equal(d.skipped, garbage);
        buf_free(&s.bytes);
        wire_free(&d);
    }
    buf_free(&log);
    buf_free(&dirty);
    buf_free(&expected.bytes);
}

/* Each loss is told once, with the reason of the first record lost. */
static void test_told_once(void **state)
{
    (void)state;
    struct decoder d = {0};
    struct record r;
    feed_text(&d, "nonsense\nfrag 0 0 0 0 1 1 1 1 ch=4 crc=1 bytes=16\n0123456789abcdef\nbeat\n"
                  "more nonsense\nbye\n");
    assert_int_equal(wire_next(&d, &r), WIRE_BAD);
    assert_non_null(strstr(d.why, "unknown record"));
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    assert_int_equal(r.kind, REC_BEAT);
    assert_non_null(strstr(d.why, "unknown record"));
    assert_int_equal(wire_next(&d, &r), WIRE_BAD);
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    assert_int_equal(r.kind, REC_BYE);
    assert_int_equal(d.bad, 2);
    assert_int_equal(wire_next(&d, &r), WIRE_MORE);
    wire_free(&d);
}

/* ---- enemies ---------------------------------------------------------------------------- */

/*
 * Bytes that ask for as much work as possible are refused at less than a microsecond each (about
 * 0.05 here; nested heads would cost 4 without their budget). CPU time, so that a busy machine does
 * not matter.
 */
static void check_cost(const char *unit, size_t total)
{
    struct decoder d = {.upward = true};
    struct record r;
    size_t n = strlen(unit);
    int64_t begin = cpu_us();
    for (size_t at = 0; at < total; at += n) {
        wire_feed(&d, unit, n);
        if (at % 65536 >= n) continue;
        while (wire_next(&d, &r) != WIRE_MORE)
            ;
    }
    wire_end(&d);
    while (wire_next(&d, &r) != WIRE_MORE)
        ;
    int64_t spent = cpu_us() - begin;
    if (spent > (int64_t)total) fail_msg("%" PRId64 " us for \"%s\"", spent, unit);
    assert_true(d.in.cap <= 8 << 20);
    wire_free(&d);
}

static void test_enemies(void **state)
{
    (void)state;
    check_cost("up ", 1 << 18);
    check_cost("frag 0 0 0 0 65536 1 1 1 ch=4 crc=0 bytes=1048576\n", 4 << 20);
    check_cost("frag 0 0 0 0 256 1 1 1 ch=4 crc=0 bytes=4096\n", 1 << 20);
    check_cost("frag 0 0 0 0 65536 1 1 1 ch=4 crc=0 bytes=1048576\nbeat\n", 4 << 20);
    check_cost("uuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuuu", 1 << 18);
    check_cost("beat a=1 beat a=1 beat a=1 beat a=1 ", 1 << 18);
    check_cost("ring me=0 n=1 rules=none\n", 1 << 18);
    check_cost("scene bytes=2147483647\n", 1 << 20);
}

/* A stream of state ('s' a spec, 'g' a grid) and frames ('f'): the generation of the last frame. */
static uint32_t last_of(const char *stream)
{
    struct generations g = {0};
    struct frame_size f = {0};
    for (; *stream; stream++) {
        if (*stream == 'f') generation_frame(&g, &f);
        else generation_state(&g, *stream == 's' ? REC_SPEC : REC_GRID, 1);
    }
    return f.generation;
}

static void test_generations(void **state)
{
    (void)state;
    assert_int_equal(last_of("gsf"), 0);
    assert_int_equal(last_of("fgs"), 0); /* before all state: of the first */
    assert_int_equal(last_of("gfs"), 0);
    assert_int_equal(last_of("gsff"), 0);
    assert_int_equal(last_of("gsfsf"), 1);
    assert_int_equal(last_of("gsfgsf"), 1); /* two records, one state */
    assert_int_equal(last_of("gsfggssf"), 1);
    assert_int_equal(last_of("gsfgfsf"), 2);
    assert_int_equal(last_of("gsfsfgffsf"), 3);
    struct generations g = {.now = 0, .oldest = UINT32_MAX};
    const struct frame_size before = {.generation = UINT32_MAX},
                            older = {.generation = UINT32_MAX - 1};
    assert_true(generation_lives(&g, &before)); /* the count may wrap */
    assert_false(generation_lives(&g, &older));
}

/* How many generations live after n views of a grid of this many bytes. */
static uint32_t lives(uint32_t n, size_t grid, size_t spec, bool keeps)
{
    struct generations g = {.keeps = keeps};
    struct frame_size f = {0};
    generation_state(&g, REC_GRID, grid);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t oldest = generation_oldest(&g, REC_SPEC, spec);
        generation_state(&g, REC_SPEC, spec);
        assert_int_equal(g.oldest, oldest);
        generation_frame(&g, &f);
    }
    return g.now - g.oldest + 1;
}

static void test_generations_that_live(void **state)
{
    (void)state;
    assert_int_equal(lives(1, 100, 100, false), 1);
    assert_int_equal(lives(3, 100, 100, false), 3);
    assert_int_equal(lives(200, 100, 100, false), GENERATIONS);
    /* the grid once */
    assert_int_equal(lives(200, STATE_BYTES - GENERATIONS * 100, 100, false), GENERATIONS);
    assert_int_equal(lives(100, STATE_BYTES - 400, 100, false), 4);
    assert_int_equal(lives(100, STATE_BYTES, 100, false), 2);
    assert_int_equal(lives(200, STATE_BYTES, 100, true), GENERATIONS);
    assert_int_equal(lives(100, 0, STATE_BYTES, false), 2); /* two in any case */
    assert_int_equal(lives(100, 0, STATE_BYTES / 3, false), 3);
}

static void test_awaited(void **state)
{
    (void)state;
    size_t bytes;
    struct decoder d = {0};
    struct record r;
    static const char stream[] = "frame 0 1 1\ngrid bytes=3\nabc\nspec bytes=0\n\n";
    size_t body = strlen("frame 0 1 1\ngrid bytes=3\n");
    for (size_t i = 0; i < sizeof stream - 1; i++) {
        bool within = i >= body && i < body + 4;
        assert_int_equal(wire_awaited(&d, &bytes), within ? REC_GRID : REC_KINDS);
        wire_feed(&d, stream + i, 1);
        while (wire_next(&d, &r) == WIRE_RECORD) continue;
    }
    wire_free(&d);
    feed_text(&d, "frag 0 0 0 0 1 1 1 1 job=0 ch=4 crc=1 bytes=16\nx"); /* is no state */
    assert_int_equal(wire_next(&d, &r), WIRE_MORE);
    assert_int_equal(wire_awaited(&d, &bytes), REC_KINDS);
    wire_free(&d);
    d = (struct decoder){.upward = true};
    wire_feed(&d, stream, body);
    while (wire_next(&d, &r) != WIRE_MORE) continue;
    assert_int_equal(wire_awaited(&d, &bytes), REC_KINDS);
    wire_free(&d);
}

/* All cuts of the stream into two reads: each record comes, without the bodies of grids. */
static void test_dropped(void **state)
{
    (void)state;
    static const char stream[] =
        "frame 0 1 1\ngrid bytes=9\ntask 1 2\n\nspec bytes=2\nab\ngrid bytes=0 x=y\n\nflush\n";
    static const enum rec_kind kinds[] = {REC_FRAME, REC_GRID, REC_SPEC, REC_GRID, REC_FLUSH};
    for (size_t cut = 0; cut < sizeof stream - 1; cut++) {
        struct decoder d = {0};
        struct record r;
        size_t bytes, most = 0;
        int k = 0;
        bool dropped = false;
        for (size_t i = 0; i < sizeof stream - 1; i++) {
            wire_feed(&d, stream + i, 1);
            if (i < cut) continue;
            while (wire_next(&d, &r) == WIRE_RECORD) {
                assert_int_equal(r.kind, kinds[k++]);
                if (k == 2) assert_true(r.body_len == 9 && !r.body == dropped);
                if (k == 3) assert_memory_equal(r.body, "ab", 2);
                assert_int_equal(wire_awaited(&d, &bytes), REC_KINDS); /* this one is held */
            }
            if (k == 1 && wire_awaited(&d, &bytes) == REC_GRID) {
                wire_drop(&d);
                dropped = true;
                assert_int_equal(bytes, 9);
            }
            if (dropped && k == 1 && buf_size(&d.in) > most) most = buf_size(&d.in);
        }
        assert_int_equal(k, 5);
        if (cut == 0) assert_true(dropped && most <= sizeof "grid bytes=9\n");
        wire_free(&d);
    }
    struct decoder d = {0};
    struct record r;
    feed_text(&d, "grid bytes=9\nabc");
    assert_int_equal(wire_next(&d, &r), WIRE_MORE);
    wire_drop(&d);
    feed_text(&d, "defghi\nflush\ngrid bytes=9\nabc"); /* more than the rest */
    assert_true(wire_next(&d, &r) == WIRE_RECORD && r.kind == REC_GRID && !r.body);
    assert_true(wire_next(&d, &r) == WIRE_RECORD && r.kind == REC_FLUSH);
    assert_int_equal(wire_next(&d, &r), WIRE_MORE);
    wire_drop(&d);
    wire_end(&d);
    assert_int_equal(wire_next(&d, &r), WIRE_BAD);
    assert_non_null(strstr(d.why, "cut off"));
    wire_free(&d);
}

static void count_record(void *ctx, const struct record *r)
{
    int *n = ctx;
    assert_true(r->kind < REC_KINDS);
    ++*n;
}

/* Reads this text through a pipe; *n: records that came. */
static int read_piped(const char *text, int *n, char why[WIRE_WHY])
{
    int p[2];
    *n = 0;
    assert_int_equal(pipe(p), 0);
    assert_int_equal(write_full(p[1], text, strlen(text)), 0);
    close(p[1]);
    int result = wire_read(p[0], count_record, n, why);
    close(p[0]);
    return result;
}

static void test_read(void **state)
{
    (void)state;
    char why[WIRE_WHY] = "";
    int n;
    assert_int_equal(read_piped("", &n, why), 0);
    assert_int_equal(n, 0);
    assert_int_equal(
        read_piped("frame 0 2 1\ntask 0 0 0 0 2 1 1 1\nspec bytes=3\nabc\n", &n, why), 0);
    assert_int_equal(n, 3);
    assert_string_equal(why, "");
    assert_int_equal(read_piped("frame 0 2 1\nnonsense\nframe 1 2 1\n", &n, why), 1);
    assert_int_equal(n, 1);
    assert_non_null(strstr(why, "expected"));
    assert_int_equal(read_piped("frame 0 2 1\nframe 1 2", &n, why), 1); /* cut off */
    assert_int_equal(n, 1);
    errno = 0;
    assert_int_equal(wire_read(-1, count_record, &n, why), -1);
    assert_int_equal(errno, EBADF);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_come_as_they_were_said),
        cmocka_unit_test(test_generations),
        cmocka_unit_test(test_generations_that_live),
        cmocka_unit_test(test_awaited),
        cmocka_unit_test(test_dropped),
        cmocka_unit_test(test_frame),
        cmocka_unit_test(test_state),
        cmocka_unit_test(test_task),
        cmocka_unit_test(test_frag),
        cmocka_unit_test(test_largest_frag),
        cmocka_unit_test(test_done_and_plain),
        cmocka_unit_test(test_ring),
        cmocka_unit_test(test_forward),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_upward),
        cmocka_unit_test(test_line_length),
        cmocka_unit_test(test_any_feeding),
        cmocka_unit_test(test_torn_at_every_byte),
        cmocka_unit_test(test_begun_at_every_byte),
        cmocka_unit_test(test_every_bit_flipped),
        cmocka_unit_test(test_sealed_lines),
        cmocka_unit_test(test_seal_is_asked_for),
        cmocka_unit_test(test_light),
        cmocka_unit_test(test_garbage_between),
        cmocka_unit_test(test_told_once),
        cmocka_unit_test(test_enemies),
        cmocka_unit_test(test_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
