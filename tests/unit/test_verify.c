/*
 * verify: runs in files. A host computes a pixel of a number that its kind decides; checks are
 * answers to the tasks that verify gives out. The results are known by hand.
 */
#include "verify/verify.h"

#include <errno.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#define JOB "0123456789abcdef"
#define W 12
#define H 8
#define FRAMES 2
#define SLOTS 6
#define CHECKS 3
#define HUNG (-1)

/* A case: what each slot is (0: honest, HUNG, else the number of its lie), and its host. */
struct crew {
    int32_t slots;
    const char *host[SLOTS];
    int kind[SLOTS];
};
static const struct crew three = {3, {"a", "b", "c"}, {0, 0, 0}};

/* ---- files ----------------------------------------------------------------------------------- */

struct file {
    struct buf b;
    char path[4096];
};

/* Begins a run on these slots; without `hosts` its frame records name none. */
static void begin(struct file *f, const struct crew *c, bool hosts)
{
    const struct frame_size size[] = {{.w = W, .h = H}, {.frame = 1, .w = W, .h = H}};
    char stamp[64];
    wire_hello(&f->b, "fan", "00ff", 1, 0, c->slots);
    for (int k = 0; k < c->slots * FRAMES; k++) {
        int slot = k / FRAMES;
        snprintf(stamp, sizeof stamp, hosts ? "w=%d host=%s" : "w=%d", slot, c->host[slot]);
        wire_job(&f->b, &size[k % FRAMES], JOB, stamp);
    }
}

/* A fragment with these pixels, as fan stamps it. */
static void put_pixels(struct file *f, const struct task *t, int32_t slot, const float *pixels)
{
    struct buf sent = {0};
    struct record r;
    char stamp[16];
    wire_frag(&sent, t, &t->at, JOB, pixels);
    struct decoder d = wire_over(sent.data, sent.len);
    snprintf(stamp, sizeof stamp, "w=%d", slot);
    assert_int_equal(wire_next(&d, &r), WIRE_RECORD);
    wire_forward(&f->b, &r, NULL, stamp);
    buf_free(&sent);
}

/* A liar is wrong in its first pixel. */
static void put(struct file *f, const struct task *t, int32_t slot, int kind)
{
    static float pixels[4 * W * H];
    for (uint64_t i = 0; i < 4 * lattice_count(&t->at); i++)
        pixels[i] = (float)(lattice_pixel(&t->at, W, i / 4) * 4 + i % 4) / 1024;
    pixels[0] += (float)kind;
    if (kind != HUNG) put_pixels(f, t, slot, pixels);
}

static void save(struct file *f)
{
    const char *base = getenv("TMPDIR");
    snprintf(f->path, sizeof f->path, "%s/stormring-verify-XXXXXX", base ? base : "/tmp");
    int fd = mkstemp(f->path);
    assert_true(fd >= 0);
    assert_int_equal(write_full(fd, buf_data(&f->b), buf_size(&f->b)), 0);
    close(fd);
    buf_free(&f->b);
}

/* Rows, tiles, runs that wrap, or every third pixel: each slot has one in turn. */
#define CUTS 4
static void make_log(struct file *log, const struct crew *c, int cut)
{
    static const struct cut kinds[CUTS] = {{.unit = CUT_ROW}, {.unit = CUT_TILE, .w = 5, .h = 3},
        {.unit = CUT_RUN, .w = 17}, {.unit = CUT_SCATTER, .w = 3, .h = 1}};
    begin(log, c, true);
    for (uint32_t f = 0; f < FRAMES; f++)
        for (uint32_t id = 0; id < cut_count(&kinds[cut], W, H); id++) {
            struct task t = cut_task(&kinds[cut], W, H, id);
            int32_t slot = (int32_t)(id + f) % c->slots;
            t.frame = f;
            put(log, &t, slot, c->kind[slot] == HUNG ? 0 : c->kind[slot]);
        }
    save(log);
}

/* Reads the log and the first checks, on the hosts of c. */
static int reads(struct verify *v, const struct crew *c, double fraction, uint64_t seed,
    struct file *log, struct file *check, int checks)
{
    char *files[CHECKS + 2] = {log->path}, why[LOG_WHY];
    const char *name;
    for (int k = 0; k < checks; k++) files[k + 1] = check[k].path;
    verify_init(v, seed, fraction, c->host, c->slots);
    return verify_read(v, files, &name, why);
}

static void read_all(struct verify *v, const struct crew *c, double fraction, uint64_t seed,
    struct file *log, struct file *check, int checks)
{
    assert_int_equal(reads(v, c, fraction, seed, log, check, checks), 0);
}

static struct task task_of(const struct verify *v, uint32_t i)
{
    const struct verify_piece *p = &v->piece[i];
    return (struct task){.frame = p->frame, .id = i, .at = p->at, .to = verify_next(v, p)};
}

/* The slots deliver what they are asked for. Returns the number of tasks. */
static int make_check(struct file *check, const struct verify *v, const struct crew *c)
{
    int asked = 0;
    begin(check, c, true);
    for (uint32_t i = 0; i < v->n; i++) {
        const struct task t = task_of(v, i);
        if (t.to < 0) continue;
        put(check, &t, t.to, c->kind[t.to]);
        asked++;
    }
    save(check);
    return asked;
}

struct outcome {
    uint32_t pieces, different, unchecked;
    uint64_t seen;
    int named[SLOTS], unsure[SLOTS]; /* pieces in which it is wrong; or may be */
    int rounds;                      /* in which something was asked */
};

static struct outcome outcome_of(const struct verify *v)
{
    struct outcome o = {.pieces = v->n, .seen = v->seen};
    for (uint32_t i = 0; i < v->n; i++) {
        const struct verify_piece *p = &v->piece[i];
        enum verify_verdict verdict = verify_judge(p);
        o.unchecked += verdict == VERIFY_UNCHECKED;
        o.different += verdict == VERIFY_DIFFERENT;
        for (uint32_t k = 0; k < p->n && verdict == VERIFY_DIFFERENT; k++) {
            bool known, named = verify_named(p, k, &known);
            if (named && p->by[k].slot >= 0) (known ? o.named : o.unsure)[p->by[k].slot]++;
        }
    }
    return o;
}

/* `now`: the hosts when the picture is complete. */
static struct outcome verify_on(struct file *log, const struct crew *now, uint64_t seed)
{
    static struct file check[CHECKS];
    struct verify v;
    int rounds = 0;
    for (int k = 0; k < CHECKS; k++) {
        read_all(&v, now, 1, seed, log, check, k);
        rounds += make_check(&check[k], &v, now) > 0;
        verify_free(&v);
    }
    read_all(&v, now, 1, seed, log, check, CHECKS);
    struct outcome o = outcome_of(&v);
    o.rounds = rounds;
    verify_free(&v);
    for (int k = 0; k < CHECKS; k++) unlink(check[k].path);
    return o;
}

static struct outcome verify(const struct crew *c, int cut, uint64_t seed)
{
    static struct file log;
    make_log(&log, c, cut);
    struct outcome o = verify_on(&log, c, seed);
    unlink(log.path);
    return o;
}

/* ---- runs ------------------------------------------------------------------------------------ */

#define SEEDS 20

static void test_honest(void **state)
{
    (void)state;
    for (int cut = 0; cut < CUTS; cut++)
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            struct outcome o = verify(&three, cut, seed);
            assert_true(o.pieces && o.pieces == o.seen);
            assert_int_equal(o.different + o.unchecked, 0);
            assert_int_equal(o.rounds, 1);
        }
}

static void test_liar(void **state)
{
    (void)state;
    const struct crew c = {4, {"a", "b", "c", "d"}, {0, 5, 0, 0}};
    for (int cut = 0; cut < CUTS; cut++)
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            struct outcome o = verify(&c, cut, seed);
            assert_int_equal(o.unchecked, 0);
            assert_true(o.different * 4 >= o.pieces - 4);
            assert_true(o.named[1] > 0);
            assert_in_range(o.rounds, 2, 3);
            for (int k = 0; k < 4; k++) {
                assert_int_equal(o.unsure[k], 0);
                assert_true(k == 1 || !o.named[k]);
            }
        }
}

/* Of three, one more tells nothing where all differ; of four, the fourth does. */
static void test_two_liars(void **state)
{
    (void)state;
    const struct crew of_three = {3, {"a", "b", "c"}, {0, 5, 7}};
    const struct crew of_four = {4, {"a", "b", "c", "d"}, {0, 5, 7, 0}};
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct outcome o = verify(&of_three, 0, seed);
        assert_int_equal(o.different, o.pieces);
        assert_int_equal(o.named[0] + o.named[1] + o.named[2], 0);
        o = verify(&of_four, 0, seed);
        assert_int_equal(o.unchecked, 0);
        assert_true(o.named[1] > 0 && o.named[2] > 0);
        assert_int_equal(o.named[0] + o.named[3], 0);
        for (int k = 0; k < 4; k++) assert_int_equal(o.unsure[k], 0);
    }
}

/* One hangs when it shall check: the others check what they computed, and what it had computed. */
static void test_hung(void **state)
{
    (void)state;
    const struct crew c = {3, {"a", "b", "c"}, {0, HUNG, 0}};
    for (int cut = 0; cut < CUTS; cut++)
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            struct outcome o = verify(&c, cut, seed);
            assert_int_equal(o.different + o.unchecked, 0);
            assert_in_range(o.rounds, cut < 3 ? 2 : 1, 2); /* six pieces: perhaps none is for it */
        }
}

/* Of two: what the other one computed. It is asked once. */
static void test_hung_of_two(void **state)
{
    (void)state;
    const struct crew c = {2, {"a", "b"}, {0, HUNG}};
    struct outcome o = verify(&c, 0, 3);
    assert_int_equal(o.different, 0);
    assert_int_equal(o.unchecked, o.pieces / 2);
    assert_int_equal(o.rounds, 1);
}

/* Slots of one host do not check each other, where there is another host. */
static void test_places(void **state)
{
    (void)state;
    const struct crew c = {4, {"a", "a", "b", "b"}, {5, 5, 0, 0}};
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct outcome o = verify(&c, 0, seed);
        assert_int_equal(o.different, o.pieces);
        assert_int_equal(o.named[0] + o.named[1] + o.named[2] + o.named[3], 0);
        assert_true(o.unsure[0] + o.unsure[1] > 0 && o.unsure[2] + o.unsure[3] > 0);
    }
}

static const struct task row = {.at = {0, 0, W, 1, 1, 1}};

/* The same pixels twice in the log, by two slots: each is a piece, and both are checked. */
static void test_twice_in_log(void **state)
{
    (void)state;
    const struct task part = {.id = 1, .at = {3, 0, 5, 1, 1, 1}};
    struct file log = {0};
    begin(&log, &three, true);
    put(&log, &row, 0, 0);
    put(&log, &row, 0, 0);
    put(&log, &part, 1, 0);
    save(&log);
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct outcome o = verify_on(&log, &three, seed);
        assert_int_equal(o.pieces, 3);
        assert_int_equal(o.different + o.unchecked, 0);
    }
    unlink(log.path);
}

/* A lie in any one value is found, and so is one that moves values to other places. */
static void test_every_value_counts(void **state)
{
    (void)state;
    const uint32_t lies = 4 * W * 4 * W;
    struct file log = {0}, check = {0};
    struct verify v;
    float pixels[4 * W];
    begin(&log, &three, true);
    begin(&check, &three, true);
    for (uint32_t i = 0; i < lies; i++) {
        const uint32_t one = i / (4 * W), other = i % (4 * W);
        struct task t = row;
        t.id = i;
        put(&log, &t, 0, 0);
        for (int k = 0; k < 4 * W; k++) pixels[k] = (float)k / 1024;
        pixels[one] = other == one ? .5f : (float)other / 1024;
        if (other != one) pixels[other] = (float)one / 1024;
        put_pixels(&check, &t, 1, pixels);
    }
    save(&log);
    save(&check);
    read_all(&v, &three, 1, 0, &log, &check, 1);
    assert_int_equal(v.n, lies);
    for (uint32_t i = 0; i < lies; i++)
        assert_int_equal(verify_judge(&v.piece[i]), VERIFY_DIFFERENT);
    verify_free(&v);
    unlink(log.path);
    unlink(check.path);
}

/* Of checks only whole pieces count, of known slots; a frame that the log does not declare is not
 * chosen, and neither is a fragment outside of its frame. */
static void test_foreign(void **state)
{
    (void)state;
    struct task odd[5] = {row, row, row, row, row};
    struct file log = {0}, check = {0};
    struct verify v;
    odd[0].frame = 7;
    odd[1].at.w = W * H + 1;
    odd[2].at.w = W / 2;
    odd[3].id = 1;
    odd[4].frame = 1;
    begin(&log, &three, true);
    begin(&check, &three, true);
    put_pixels(&log, &odd[0], 0, (float[4 * W]){0});
    put_pixels(&log, &odd[1], 0, (float[4 * (W * H + 1)]){0});
    put(&log, &row, 0, 0);
    for (int i = 0; i < 5; i++)
        if (i != 1) put(&check, &odd[i], 1, 5);
    put(&check, &row, 3, 5);
    save(&log);
    save(&check);
    read_all(&v, &three, 1, 0, &log, &check, 1);
    assert_int_equal(v.n, 1);
    assert_int_equal(v.seen, 3);
    assert_int_equal(v.piece[0].n, 1);
    verify_free(&v);
    unlink(log.path);
    unlink(check.path);
}

/* ---- one piece, and what each place says of it, by hand -------------------------------------- */

/* Results of places "a" to "d" in turn, as letters: equal ones agree; '.': it said nothing; '?'
 * before all: the first one is of an unknown slot. Names them: a bit each, negative if unsure. */
static int named(const char *said, enum verify_verdict verdict)
{
    struct verify_result by[SLOTS];
    struct verify_piece p = {.by = by};
    bool known = false;
    int mask = 0;
    int32_t place = *said == '?' ? -1 : 0;
    for (said += place < 0; *said; said++, place++)
        if (*said != '.')
            by[p.n++] = (struct verify_result){place, place, 0, (uint64_t)(unsigned char)*said};
    assert_int_equal(verify_judge(&p), verdict);
    for (uint32_t i = 0; i < p.n && verdict == VERIFY_DIFFERENT; i++)
        mask |= verify_named(&p, i, &known) << i;
    return known ? mask : -mask;
}

static void test_votes(void **state)
{
    (void)state;
    assert_int_equal(named("x", VERIFY_UNCHECKED), 0);
    assert_int_equal(named("xx", VERIFY_AGREED), 0);
    assert_int_equal(named("xy", VERIFY_DIFFERENT), -3);
    assert_int_equal(named("xyx", VERIFY_DIFFERENT), 2);
    assert_int_equal(named("yxx", VERIFY_DIFFERENT), 1);
    assert_int_equal(named("xyz", VERIFY_DIFFERENT), -7);
    assert_int_equal(named("xyzx", VERIFY_DIFFERENT), 6);
    assert_int_equal(named("xyxy", VERIFY_DIFFERENT), -15);
    assert_int_equal(named("xxxy", VERIFY_DIFFERENT), 8);
    /* A slot of an earlier run may have been the liar itself: it is no second witness. */
    assert_int_equal(named("?xx", VERIFY_AGREED), 0);
    assert_int_equal(named("?xy", VERIFY_DIFFERENT), -3);
    assert_int_equal(named("?xxy", VERIFY_DIFFERENT), -7);
    assert_int_equal(named("?xxyy", VERIFY_DIFFERENT), 3);
}

/* Two slots of one host are one witness; a slot that contradicts itself is wrong once. */
static void test_one_witness(void **state)
{
    (void)state;
    struct file log = {0}, check = {0};
    const struct crew c = {4, {"a", "a", "b", "c"}, {0}};
    struct verify v;
    begin(&log, &c, true);
    begin(&check, &c, true);
    put(&log, &row, 0, 5);
    put(&check, &row, 1, 5);
    save(&log);
    save(&check);
    read_all(&v, &c, 1, 0, &log, &check, 1);
    assert_int_equal(verify_judge(&v.piece[0]), VERIFY_UNCHECKED);
    verify_free(&v);
    for (int again = 0; again < 2; again++) {
        unlink(check.path);
        begin(&check, &c, true);
        put(&check, &row, 1, 5);
        put(&check, &row, 2, 0);
        put(&check, &row, 2, 0);
        if (again) put(&check, &row, 2, 7);
        if (again) put(&check, &row, 3, 0);
        save(&check);
        read_all(&v, &c, 1, 0, &log, &check, 1);
        assert_int_equal(v.piece[0].n, again ? 5 : 3);
        const struct outcome o = outcome_of(&v);
        for (int k = 0; k < 3; k++) assert_int_equal((again ? o.named : o.unsure)[k], 1);
        assert_int_equal(o.named[3] + o.unsure[3], 0);
        assert_int_equal(verify_next(&v, &v.piece[0]), again ? -1 : 3);
        verify_free(&v);
    }
    unlink(log.path);
    unlink(check.path);
}

/* ---- the slot to ask ------------------------------------------------------------------------- */

/* The place that failed last is asked if there is no other; one that is mute is not. */
static void test_next(void **state)
{
    (void)state;
    struct verify v;
    struct file log = {0};
    begin(&log, &three, true);
    put(&log, &row, 0, 0);
    save(&log);
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        read_all(&v, &three, 1, seed, &log, NULL, 0);
        assert_in_range(verify_next(&v, &v.piece[0]), 1, 2);
        v.piece[0].failed = 1;
        assert_int_equal(verify_next(&v, &v.piece[0]), 2);
        v.place[2].mute = true;
        assert_int_equal(verify_next(&v, &v.piece[0]), 1);
        v.place[1].mute = true;
        assert_int_equal(verify_next(&v, &v.piece[0]), -1);
        verify_free(&v);
    }
    unlink(log.path);
}

/* A host that delivered nine times as much as another one is asked far more often. */
static void test_share(void **state)
{
    (void)state;
    struct file log = {0};
    struct verify v;
    int asked[3] = {0};
    begin(&log, &three, true);
    for (uint32_t i = 0; i < 1000; i++) {
        struct task t = row;
        t.id = i;
        put(&log, &t, i % 2 ? 0 : i % 20 ? 1 : 2, 0);
    }
    save(&log);
    read_all(&v, &three, 1, 0, &log, NULL, 0);
    for (uint32_t i = 0; i < v.n; i++) asked[verify_next(&v, &v.piece[i])]++;
    assert_true(asked[0] > 400 && asked[1] > 400 && asked[2] > 20 && asked[2] < 100);
    verify_free(&v);
    unlink(log.path);
}

/* A host that delivered something may have lost the rest: it is asked again, but not for the same
 * if there is another one. */
static void test_lost(void **state)
{
    (void)state;
    static struct file log, check;
    struct verify v;
    make_log(&log, &three, 0);
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        bool first = true;
        read_all(&v, &three, 1, seed, &log, NULL, 0);
        begin(&check, &three, true);
        for (uint32_t i = 0; i < v.n; i++) {
            const struct task t = task_of(&v, i);
            if (t.to != 1 || first) put(&check, &t, t.to, 0);
            first = first && t.to != 1;
        }
        save(&check);
        verify_free(&v);
        read_all(&v, &three, 1, seed, &log, &check, 1);
        assert_false(v.place[0].mute || v.place[1].mute || v.place[2].mute);
        for (uint32_t i = 0; i < v.n; i++) {
            const struct verify_piece *p = &v.piece[i];
            assert_int_equal(p->failed >= 0, verify_judge(p) == VERIFY_UNCHECKED);
            if (p->failed < 0) continue;
            assert_int_equal(p->failed, 1);
            assert_int_equal(verify_next(&v, p), 2 - p->by[0].place);
        }
        verify_free(&v);
        unlink(check.path);
    }
    unlink(log.path);
}

/* The seed alone decides which pieces are chosen and which slots are asked. */
static void test_seeds(void **state)
{
    (void)state;
    static struct file log;
    struct verify a, b;
    uint32_t chosen = 0, others = 0;
    double expected = 0;
    make_log(&log, &three, 2);
    for (uint64_t seed = 0; seed < 200; seed++) {
        read_all(&a, &three, .25, seed, &log, NULL, 0);
        read_all(&b, &three, .25, seed, &log, NULL, 0);
        assert_int_equal(a.n, b.n);
        for (uint32_t i = 0; i < a.n; i++) {
            assert_memory_equal(&a.piece[i].at, &b.piece[i].at, sizeof a.piece[i].at);
            int32_t slot = verify_next(&a, &a.piece[i]);
            assert_int_equal(slot, verify_next(&b, &b.piece[i]));
            assert_int_not_equal(slot, a.piece[i].by[0].slot);
        }
        verify_free(&b);
        read_all(&b, &three, .25, seed + 1, &log, NULL, 0);
        others += a.n != b.n || (a.n && memcmp(&a.piece[0].at, &b.piece[0].at, sizeof a.piece->at));
        chosen += a.n;
        expected += .25 * (double)a.seen;
        verify_free(&a);
        verify_free(&b);
    }
    /* Four standard deviations. */
    double off = chosen - expected;
    assert_true(off * off < 16 * .75 * expected);
    assert_true(others > 100);
    unlink(log.path);
}

/* The pieces of a frame are a list, in the order of the log. */
static void test_frames(void **state)
{
    (void)state;
    static struct file log;
    struct verify v;
    uint32_t n = 0;
    make_log(&log, &three, 0);
    read_all(&v, &three, 1, 0, &log, NULL, 0);
    for (size_t k = 0; k < FRAMES; k++) {
        const struct verify_frame *f = frames_extra(&v.frames, &v.frames.at[k]);
        assert_string_equal(f->job, JOB);
        uint32_t y = 0;
        for (uint32_t i = f->first; i; i = v.piece[i - 1].next, n++, y++) {
            assert_int_equal(v.piece[i - 1].frame, k);
            assert_int_equal(v.piece[i - 1].at.y, y);
        }
    }
    assert_int_equal(n, v.n);
    verify_free(&v);
    unlink(log.path);
}

/* ---- earlier runs, hosts that have come and gone --------------------------------------------- */

static void described(const struct verify *v, uint32_t piece, const char *expected)
{
    struct buf b = {0};
    verify_describe(v, &v->piece[piece], &b);
    buf_append(&b, "", 1);
    assert_string_equal((const char *)buf_data(&b), expected);
    buf_free(&b);
}

/* Of a log of two runs the slots of the first one have a host only if a record names it. */
static void test_earlier(void **state)
{
    (void)state;
    for (int hosts = 0; hosts < 2; hosts++) {
        struct file log = {0}, check = {0};
        struct verify v;
        struct task t = row;
        begin(&log, &three, hosts);
        put(&log, &row, 1, 5);
        begin(&log, &three, hosts);
        t.at.y = t.id = 1;
        put(&log, &t, 1, 5);
        save(&log);
        begin(&check, &three, true);
        for (int k = 0; k < 2; k++) put(&check, &row, 2 * k, 0), put(&check, &t, 2 * k, 0);
        save(&check);
        read_all(&v, &three, 1, 7, &log, &check, 1);
        assert_int_equal(v.piece[0].by[0].slot, -1);
        assert_int_equal(v.piece[0].by[0].place, hosts ? 1 : -1);
        assert_int_equal(v.piece[1].by[0].slot, 1);
        assert_int_equal(v.piece[1].by[0].place, 1);
        described(&v, 0,
            hosts ? "frame 0 at 0,0: host b in an earlier run computed other pixels than two other "
                    "hosts"
                  : "frame 0 at 0,0: a slot of an earlier run computed other pixels than two other "
                    "hosts");
        described(
            &v, 1, "frame 0 at 0,1: slot 1 (host b) computed other pixels than two other hosts");
        verify_free(&v);
        unlink(log.path);
        unlink(check.path);
    }
}

/* Slots of the log were on hosts a, b and c; now slot 0 is on c and the others on d. */
static void test_joined(void **state)
{
    (void)state;
    const struct crew then = {3, {"a", "b", "c"}, {0, 0, 5}}, now = {3, {"c", "d", "d"}, {0}};
    static struct file log, check;
    struct verify v;
    make_log(&log, &then, 0);
    read_all(&v, &now, 1, 7, &log, NULL, 0);
    for (uint32_t i = 0; i < v.n; i++) {
        const struct verify_piece *p = &v.piece[i];
        assert_string_equal(v.host[p->by[0].place], then.host[p->by[0].slot]);
        int32_t slot = verify_next(&v, p);
        assert_true(p->by[0].slot == 2 ? slot > 0 : slot >= 0); /* c does not check itself */
    }
    begin(&check, &now, true);
    for (uint32_t i = 0; i < v.n; i++) {
        const struct task t = task_of(&v, i);
        put(&check, &t, i == 2 ? 1 : t.to, 0);
    }
    save(&check);
    verify_free(&v);
    read_all(&v, &now, 1, 7, &log, &check, 1);
    const struct outcome o = outcome_of(&v);
    assert_int_equal(o.unchecked, 0);
    assert_int_equal(o.different, 5); /* those of c, each with a host d */
    described(
        &v, 2, "frame 0 at 0,2: slot 2 (host c) and slot 1 (host d) computed different pixels");
    verify_free(&v);
    unlink(log.path);
    unlink(check.path);
}

/* Slots check each other if the run and the checks had one host, not if a second one has left. */
static void test_only_host(void **state)
{
    (void)state;
    const struct crew only = {3, {"a", "a", "a"}, {0}}, two = {3, {"a", "a", "b"}, {0}};
    static struct file log;
    struct verify v;
    for (int left = 0; left < 2; left++) {
        make_log(&log, left ? &two : &only, 0);
        read_all(&v, &only, 1, 7, &log, NULL, 0);
        assert_int_equal(v.several, left);
        for (uint32_t i = 0; i < v.n; i++)
            assert_int_equal(
                verify_next(&v, &v.piece[i]) >= 0, !left || v.piece[i].by[0].slot == 2);
        verify_free(&v);
        unlink(log.path);
    }
}

static void test_errors(void **state)
{
    (void)state;
    static struct file log, check;
    struct verify v;
    make_log(&log, &three, 0);
    snprintf(check.path, sizeof check.path, "/nonexistent");
    assert_int_equal(reads(&v, &three, 1, 0, &log, &check, 1), -1);
    assert_int_equal(errno, ENOENT);
    verify_free(&v);
    unlink(log.path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_honest), cmocka_unit_test(test_liar),
        cmocka_unit_test(test_two_liars), cmocka_unit_test(test_hung),
        cmocka_unit_test(test_hung_of_two), cmocka_unit_test(test_places),
        cmocka_unit_test(test_twice_in_log), cmocka_unit_test(test_every_value_counts),
        cmocka_unit_test(test_foreign), cmocka_unit_test(test_votes),
        cmocka_unit_test(test_one_witness), cmocka_unit_test(test_next),
        cmocka_unit_test(test_share), cmocka_unit_test(test_lost), cmocka_unit_test(test_seeds),
        cmocka_unit_test(test_frames), cmocka_unit_test(test_earlier),
        cmocka_unit_test(test_joined), cmocka_unit_test(test_only_host),
        cmocka_unit_test(test_errors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
