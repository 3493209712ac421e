/*
 * verify: runs in memory. A host computes a pixel of a number that its kind decides; checks are
 * cut, copied and repeated as deal -e does it, and more often. The results are known by hand.
 * Some runs are in files.
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
#define MOST 4096 /* fragments of a file */
#define HUNG (-1)
#define LIES 1000 /* and more: in the first pixel of each fragment only, not in all */

struct frag {
    struct task t;
    int32_t slot;
};
struct file {
    struct frag at[MOST];
    size_t n;
};
/* A case: what each slot is (0: honest, HUNG, else the name of its lie), and on which host. */
struct crew {
    int32_t slots, places;
    int32_t place_of[SLOTS];
    int kind[SLOTS];
};

static const struct crew three = {3, 3, {0, 1, 2}, {0, 0, 0}};

static int32_t place(const struct crew *c, int32_t slot)
{
    return slot >= 0 && slot < c->slots ? c->place_of[slot] : -1;
}

static void pixels_of(const struct crew *c, const struct frag *f, float *out)
{
    int kind = f->slot < 0 ? 0 : c->kind[f->slot];
    for (uint64_t k = 0; k < lattice_count(&f->t.at); k++)
        for (uint32_t i = 0; i < 4; i++)
            out[4 * k + i] = (float)(lattice_pixel(&f->t.at, W, k) * 4 + i) / 1024;
    for (uint64_t k = 0; k < (kind >= LIES ? 1 : lattice_count(&f->t.at)); k++)
        if (kind > 0) out[4 * k] += (float)kind;
}

static void put(struct file *f, const struct task *t, struct lattice at, int32_t slot)
{
    assert_true(f->n < MOST);
    f->at[f->n] = (struct frag){*t, slot};
    f->at[f->n++].t.at = at;
}

static void frames(struct verify *v)
{
    for (uint32_t i = 0; i < FRAMES; i++) verify_frame(v, i, W, H, JOB);
}

/* Reads all as verify.h says it. */
static void read_all(struct verify *v, const struct crew *c, double fraction, uint64_t seed,
    const struct file *log, const struct file *check, int checks)
{
    static float pixels[4 * W * H];
    verify_init(v, seed, fraction, c->place_of, c->slots, c->places);
    frames(v);
    for (size_t i = 0; i < log->n; i++) verify_choose(v, &log->at[i].t);
    for (int k = 0; k < checks; k++)
        for (size_t i = 0; i < check[k].n; i++) verify_cut(v, &check[k].at[i].t);
    verify_split(v);
    for (size_t i = 0; i < log->n; i++) {
        pixels_of(c, &log->at[i], pixels);
        verify_first(v, &log->at[i].t, log->at[i].slot, place(c, log->at[i].slot), pixels);
    }
    for (int k = 0; k < checks; k++) {
        verify_begin(v);
        for (size_t i = 0; i < check[k].n; i++) {
            pixels_of(c, &check[k].at[i], pixels);
            const struct frag *g = &check[k].at[i];
            verify_again(v, &g->t, g->slot, place(c, g->slot), pixels);
        }
        verify_end(v);
    }
}

/* Rows, tiles, runs that wrap, or every third pixel: each slot has one in turn. */
static void make_log(struct file *log, const struct crew *c, int cut)
{
    static const struct cut kinds[] = {{.unit = CUT_ROW}, {.unit = CUT_TILE, .w = 5, .h = 3},
        {.unit = CUT_RUN, .w = 17}, {.unit = CUT_SCATTER, .w = 3, .h = 1}};
    log->n = 0;
    for (uint32_t f = 0; f < FRAMES; f++)
        for (uint32_t id = 0; id < cut_count(&kinds[cut], W, H); id++) {
            struct task t = cut_task(&kinds[cut], W, H, id);
            t.frame = f;
            put(log, &t, t.at, (int32_t)(id + f) % c->slots);
        }
}

/* What slot k delivers of t, in fragments that begin and end anywhere; some twice, some only here
 * and there. */
static void deliver(struct file *to, const struct task *t, int32_t k, uint64_t *seed)
{
    uint64_t count = lattice_count(&t->at);
    for (uint64_t at = 0; at < count;) {
        uint64_t n = 1 + rng_u64(9, (*seed)++) % (count - at);
        struct lattice sub = lattice_cut(&t->at, W, at, n);
        put(to, t, sub, k);
        if (rng_u64(9, (*seed)++) % 4 == 0) put(to, t, sub, k);
        at += lattice_count(&sub);
    }
}

/*
 * A round: the slot that is asked delivers; with `stolen`, as by deal -e, another one may instead
 * of it, or of a part, or as well; the whole and a piece of it may come from one slot.
 */
static void make_check(
    struct file *to, const struct verify *v, const struct crew *c, bool stolen, uint64_t *seed)
{
    uint32_t frame = 0, from = 0;
    struct task t;
    to->n = 0;
    while (frame < FRAMES) {
        if (!verify_request(v, frame, &from, &t)) {
            frame++;
            continue;
        }
        int32_t thief = (int32_t)(rng_u64(9, (*seed)++) % (uint64_t)c->slots);
        uint64_t way = stolen ? rng_u64(9, (*seed)++) % 4 : 3, count = lattice_count(&t.at);
        uint64_t half = 1 + rng_u64(9, (*seed)++) % count;
        if (c->kind[t.to] != HUNG && way) put(to, &t, lattice_cut(&t.at, W, 0, half), t.to);
        if (c->kind[t.to] != HUNG && way > 1) deliver(to, &t, t.to, seed);
        if (c->kind[thief] != HUNG && stolen) deliver(to, &t, thief, seed);
    }
}

struct outcome {
    struct verify_count count;
    uint32_t pieces, seen;
    int named[SLOTS], unsure[SLOTS]; /* parts in which it is wrong; or one of those that may be */
    int rounds;                      /* in which something was asked */
};

static struct outcome verify(
    const struct crew *c, const struct file *log, double fraction, uint64_t seed, bool stolen)
{
    static struct file check[3];
    struct outcome o = {0};
    struct verify v;
    uint64_t draws = seed << 32;
    for (int k = 0; k < 3; k++) {
        read_all(&v, c, fraction, seed, log, check, k);
        make_check(&check[k], &v, c, k == 0 && stolen, &draws);
        for (uint32_t i = 0; i < v.n && o.rounds == k; i++)
            o.rounds += verify_next(&v, &v.part[i]) >= 0;
        verify_free(&v);
    }
    read_all(&v, c, fraction, seed, log, check, 3);
    o.count = verify_counted(&v);
    o.pieces = v.pieces;
    o.seen = v.seen;
    for (uint32_t i = 0; i < v.n; i++) {
        if (verify_judge(&v.part[i]) != VERIFY_DIFFERENT) continue;
        for (uint32_t k = 0; k < v.part[i].n; k++) {
            bool known, named = verify_named(&v.part[i], k, &known);
            int32_t slot = verify_opinion(&v.part[i], k)->slot;
            if (named && slot >= 0) (known ? o.named : o.unsure)[slot]++;
        }
    }
    verify_free(&v);
    return o;
}

#define CUTS 4
#define SEEDS 20
static struct file the_log;

static void test_honest(void **state)
{
    (void)state;
    for (int cut = 0; cut < CUTS; cut++)
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            make_log(&the_log, &three, cut);
            struct outcome o = verify(&three, &the_log, 1, seed, true);
            assert_int_equal(o.pieces, o.seen);
            assert_int_equal(o.count.different, 0);
            assert_int_equal(o.count.unchecked, 0);
            assert_in_range(o.rounds, 1, 2);
            assert_int_equal(verify(&three, &the_log, 1, seed, false).rounds, 1);
        }
}

/* Each fragment of a liar is wrong in its first pixel, in the log and in checks. */
static void test_liar(void **state)
{
    (void)state;
    const struct crew c = {4, 4, {0, 1, 2, 3}, {0, LIES, 0, 0}};
    for (int cut = 0; cut < CUTS; cut++)
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            make_log(&the_log, &c, cut);
            struct outcome o = verify(&c, &the_log, 1, seed, true);
            assert_int_equal(o.count.unchecked, 0);
            assert_true(o.count.different * 4 >= o.pieces - 4);
            assert_true(o.named[1] > 0);
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
    const struct crew of_three = {3, 3, {0, 1, 2}, {0, 5, 7}};
    const struct crew of_four = {4, 4, {0, 1, 2, 3}, {0, 5, 7, 0}};
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        make_log(&the_log, &of_three, 0);
        struct outcome o = verify(&of_three, &the_log, 1, seed, false);
        assert_int_equal(o.count.different, o.pieces);
        assert_int_equal(o.named[0] + o.named[1] + o.named[2], 0);
        make_log(&the_log, &of_four, 0);
        o = verify(&of_four, &the_log, 1, seed, false);
        assert_int_equal(o.count.unchecked, 0);
        assert_true(o.named[1] > 0 && o.named[2] > 0);
        assert_int_equal(o.named[0] + o.named[3], 0);
        for (int k = 0; k < 4; k++) assert_int_equal(o.unsure[k], 0);
    }
}

/* One hangs when it shall check: the others check what they computed, and what it had computed. */
static void test_hung(void **state)
{
    (void)state;
    const struct crew c = {3, 3, {0, 1, 2}, {0, HUNG, 0}};
    for (int cut = 0; cut < CUTS; cut++)
        for (uint64_t seed = 0; seed < SEEDS; seed++)
            for (int stolen = 0; stolen < 2; stolen++) {
                make_log(&the_log, &c, cut);
                struct outcome o = verify(&c, &the_log, 1, seed, stolen);
                assert_int_equal(o.count.different, 0);
                assert_int_equal(o.count.unchecked, 0);
                assert_in_range(o.rounds, stolen ? 1 : 2, stolen ? 3 : 2);
            }
}

/* Of two: what the other one computed. It is not asked a third time. */
static void test_hung_of_two(void **state)
{
    (void)state;
    const struct crew c = {2, 2, {0, 1}, {0, HUNG}};
    make_log(&the_log, &c, 0);
    struct outcome o = verify(&c, &the_log, 1, 3, true);
    assert_int_equal(o.count.different, 0);
    assert_int_equal(o.count.unchecked, o.pieces / 2);
    assert_int_equal(o.rounds, 2);
}

/* A host that delivered nothing of what it was asked for is not asked for other pieces either. */
static void test_behind(void **state)
{
    (void)state;
    const struct crew c = {5, 5, {0, 1, 2, 3, 4}, {0, HUNG, HUNG, 0, 0}};
    static struct file check;
    struct verify v;
    uint64_t draws = 1;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        make_log(&the_log, &c, 0);
        read_all(&v, &c, 1, seed, &the_log, NULL, 0);
        make_check(&check, &v, &c, false, &draws);
        verify_free(&v);
        read_all(&v, &c, 1, seed, &the_log, &check, 1);
        uint32_t left = 0;
        for (uint32_t i = 0; i < v.n; i++) {
            int32_t slot = verify_next(&v, &v.part[i]);
            left += slot >= 0;
            for (int32_t k = 1; k <= 2; k++) assert_true(slot != k || !v.place[k].asked_px);
        }
        assert_true(left > 0);
        verify_free(&v);
    }
}

/* Slots of one host do not check each other, where there is another host. */
static void test_places(void **state)
{
    (void)state;
    const struct crew c = {4, 2, {0, 0, 1, 1}, {5, 5, 0, 0}};
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        make_log(&the_log, &c, 0);
        struct outcome o = verify(&c, &the_log, 1, seed, false);
        assert_int_equal(o.count.different, o.pieces);
        assert_int_equal(o.named[0] + o.named[1] + o.named[2] + o.named[3], 0);
        assert_true(o.unsure[0] + o.unsure[1] > 0 && o.unsure[2] + o.unsure[3] > 0);
    }
}

/* By hand: slot 1 sends a row, then its second half and its middle; slot 2 half of the row. */
static void test_parent_and_piece(void **state)
{
    (void)state;
    const struct task row = {.at = {0, 2, W, 1, 1, 1}};
    static struct file log, check;
    struct verify v;
    struct crew c = three;
    log.n = check.n = 0;
    put(&log, &row, row.at, 0);
    put(&check, &row, row.at, 1);
    put(&check, &row, lattice_cut(&row.at, W, 6, 6), 1);
    put(&check, &row, lattice_cut(&row.at, W, 4, 4), 1);
    put(&check, &row, lattice_cut(&row.at, W, 0, 6), 2);
    put(&check, &row, row.at, 1);
    read_all(&v, &c, 1, 0, &log, &check, 1);
    assert_int_equal(v.n, 4); /* 0-3 4-5 6-7 8-11 */
    for (uint32_t i = 0; i < v.n; i++) {
        assert_int_equal(verify_judge(&v.part[i]), VERIFY_AGREED);
        assert_int_equal(v.part[i].n, i < 2 ? 3 : 2);
    }
    verify_free(&v);
    c.kind[1] = LIES; /* wrong in pixels 0, 6 and 4, and then right as well */
    read_all(&v, &c, 1, 0, &log, &check, 1);
    static const uint32_t opinions[] = {3, 4, 3, 2};
    for (uint32_t i = 0; i < v.n; i++) {
        assert_int_equal(v.part[i].n, opinions[i]);
        assert_int_equal(verify_judge(&v.part[i]), i < 3 ? VERIFY_DIFFERENT : VERIFY_AGREED);
    }
    assert_int_equal(verify_counted(&v).different, 1);
    verify_free(&v);
}

/* Half of a piece does not check it; then the other half is asked for. */
static void test_half(void **state)
{
    (void)state;
    const struct task row = {.at = {0, 0, W, 1, 1, 1}};
    static struct file log, check;
    struct verify v;
    log.n = check.n = 0;
    put(&log, &row, row.at, 0);
    put(&check, &row, lattice_cut(&row.at, W, 0, 5), 1);
    put(&check, &row, lattice_cut(&row.at, W, 5, 7), 0);
    read_all(&v, &three, 1, 0, &log, &check, 1);
    assert_int_equal(verify_counted(&v).unchecked, 1);
    assert_int_equal(verify_next(&v, &v.part[0]), -1);
    assert_int_equal(v.part[1].at.x, 5);
    assert_int_equal(v.part[1].at.w, 7);
    assert_in_range(verify_next(&v, &v.part[1]), 1, 2);
    verify_free(&v);
}

/* The same pixels twice in the log, by two slots: each is a piece, and both are checked. */
static void test_twice_in_log(void **state)
{
    (void)state;
    const struct task row = {.at = {0, 0, W, 1, 1, 1}};
    static struct file log;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        log.n = 0;
        put(&log, &row, row.at, 0);
        put(&log, &row, row.at, 0);
        put(&log, &row, lattice_cut(&row.at, W, 3, 5), 1);
        struct outcome o = verify(&three, &log, 1, seed, true);
        assert_int_equal(o.pieces, 3);
        assert_int_equal(o.count.different + o.count.unchecked, 0);
    }
    struct verify v;
    read_all(&v, &three, 1, 0, &log, NULL, 0);
    for (uint32_t i = 0; i < v.n; i++)
        assert_int_equal(v.part[i].by[0].slot, v.part[i].piece == 2 ? 1 : 0);
    verify_free(&v);
}

/* ---- one row, and what each slot says of it, by hand ----------------------------------------- */

static const struct task one = {.at = {0, 0, W, 1, 1, 1}};

static void say(struct verify *v, int32_t slot, int lie)
{
    static float pixels[4 * W];
    for (size_t i = 0; i < 4 * W; i++) pixels[i] = (float)i;
    pixels[7] += (float)lie;
    int32_t at = slot < v->slots ? v->place_of[slot] : -1;
    if (!v->again) verify_first(v, &one, at < 0 ? -1 : slot, at, pixels);
    else verify_again(v, &one, slot, at, pixels);
}

static void start(struct verify *v, const int32_t *place_of, int32_t slots, int32_t places)
{
    verify_init(v, 0, 1, place_of, slots, places);
    frames(v);
    verify_choose(v, &one);
    verify_split(v);
}

/* A lie in any one value is found, and so is one that moves values to other places. */
static void test_every_value_counts(void **state)
{
    (void)state;
    static float pixels[4 * W];
    struct verify v;
    for (size_t lie = 0; lie < 4 * W; lie++)
        for (size_t other = lie; other < 4 * W; other += 1 + lie) {
            start(&v, three.place_of, 3, 3);
            say(&v, 0, 0);
            for (size_t i = 0; i < 4 * W; i++) pixels[i] = (float)i;
            pixels[lie] = other == lie ? .5f : (float)other;
            if (other != lie) pixels[other] = (float)lie;
            verify_again(&v, &one, 1, 1, pixels);
            assert_int_equal(verify_judge(&v.part[0]), VERIFY_DIFFERENT);
            verify_free(&v);
        }
}

/* The opinions that are named as wrong, a bit each; those of which one may be, negative. */
static int named(const struct verify *v)
{
    int mask = 0;
    bool known = false;
    for (uint32_t i = 0; i < v->part[0].n; i++) mask |= verify_named(&v->part[0], i, &known) << i;
    return known ? mask : -mask;
}

/* A slot of an earlier run may have been the liar itself: it is no second witness. */
static void test_no_witness(void **state)
{
    (void)state;
    struct verify v;
    start(&v, three.place_of, 3, 3);
    say(&v, 3, 5); /* not known either */
    say(&v, 1, 5);
    assert_int_equal(v.part[0].by[0].slot, -1);
    assert_int_equal(verify_judge(&v.part[0]), VERIFY_AGREED);
    say(&v, 0, 0);
    assert_int_equal(named(&v), -7);
    assert_int_equal(verify_next(&v, &v.part[0]), 2);
    say(&v, 2, 0);
    assert_int_equal(named(&v), 3);
    assert_int_equal(verify_next(&v, &v.part[0]), -1);
    verify_free(&v);
    start(&v, three.place_of, 3, 3);
    say(&v, 3, 5);
    say(&v, 1, 0); /* one alone shows nothing */
    assert_int_equal(named(&v), -3);
    verify_free(&v);
}

/* Two slots of one host are one witness. */
static void test_one_host(void **state)
{
    (void)state;
    static const int32_t place_of[] = {0, 0, 1, 2};
    struct verify v;
    start(&v, place_of, 4, 3);
    say(&v, 0, 5);
    say(&v, 1, 5);
    assert_int_equal(verify_judge(&v.part[0]), VERIFY_UNCHECKED);
    say(&v, 2, 0);
    assert_int_equal(named(&v), -7);
    assert_int_equal(verify_next(&v, &v.part[0]), 3);
    say(&v, 3, 0);
    assert_int_equal(named(&v), 3);
    verify_free(&v);
}

/* A slot that contradicts itself is wrong once; two against two is undecided. */
static void test_both_ways(void **state)
{
    (void)state;
    static const int32_t place_of[] = {0, 1, 2, 3};
    struct verify v;
    start(&v, place_of, 4, 4);
    say(&v, 0, 0);
    say(&v, 1, 0);
    say(&v, 1, 5);
    assert_int_equal(verify_judge(&v.part[0]), VERIFY_DIFFERENT);
    assert_int_equal(named(&v), 4);
    say(&v, 2, 5);
    assert_int_equal(named(&v), -15);
    verify_free(&v);
}

/* The order in which places are asked: one that delivered little comes before one that delivered
 * nothing, and one that failed at first before one that failed later. */
static void test_next(void **state)
{
    (void)state;
    struct verify v;
    for (int later = 0; later < 2; later++) {
        start(&v, three.place_of, 3, 3);
        say(&v, 0, 0);
        v.place[1] = v.place[2] = (struct verify_place){.asked_px = 10, .made_px = 5};
        v.place[1 + later].made_px = 1;
        assert_int_equal(verify_next(&v, &v.part[0]), 2 - later);
        v.place[2 - later].made_px = 0;
        assert_int_equal(verify_next(&v, &v.part[0]), 1 + later);
        v.place[1] = v.place[2] = (struct verify_place){0};
        v.part[0].failed[later] = 2;
        v.part[0].failed[!later] = 1;
        assert_int_equal(verify_next(&v, &v.part[0]), 2 - later);
        v.part[0].failed[0] = v.part[0].failed[1] = 2;
        assert_int_equal(verify_next(&v, &v.part[0]), 1);
        say(&v, 1, 5);
        assert_int_equal(verify_next(&v, &v.part[0]), -1);
        verify_free(&v);
    }
}

/* What a slot of an earlier run computed any host checks; and it is no witness against a host. */
static void test_earlier(void **state)
{
    (void)state;
    const struct crew c = {3, 3, {0, 1, 2}, {0, 5, 0}};
    make_log(&the_log, &c, 0);
    for (size_t i = 0; i < the_log.n; i++) the_log.at[i].slot = -1;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        struct outcome o = verify(&c, &the_log, 1, seed, false);
        assert_int_equal(o.count.unchecked, 0);
        assert_true(o.count.different > 0 && o.named[1] > 0);
        assert_int_equal(o.named[0] + o.named[2] + o.unsure[0] + o.unsure[2], 0);
    }
}

/* The seed alone decides which pieces are chosen and which slots are asked. */
static void test_seeds(void **state)
{
    (void)state;
    struct verify a, b;
    uint32_t chosen = 0, others = 0;
    make_log(&the_log, &three, 2);
    for (uint64_t seed = 0; seed < 200; seed++) {
        read_all(&a, &three, .25, seed, &the_log, NULL, 0);
        read_all(&b, &three, .25, seed, &the_log, NULL, 0);
        assert_int_equal(a.n, b.n);
        for (uint32_t i = 0; i < a.n; i++) {
            assert_int_equal(a.part[i].piece, b.part[i].piece);
            int32_t slot = verify_next(&a, &a.part[i]);
            assert_int_equal(slot, verify_next(&b, &b.part[i]));
            assert_int_not_equal(slot, a.part[i].by[0].slot);
        }
        verify_free(&b);
        read_all(&b, &three, .25, seed + 1, &the_log, NULL, 0);
        others += a.n != b.n || (a.n && a.part[0].piece != b.part[0].piece);
        chosen += a.pieces;
        verify_free(&a);
        verify_free(&b);
    }
    /* Four standard deviations. */
    double expected = .25 * 200 * (double)the_log.n, off = chosen - expected;
    assert_true(off * off < 16 * .75 * expected);
    assert_true(others > 100);
}

/* Fragments of frames and slots that there are none of, and pixels outside, count for nothing. */
static void test_foreign(void **state)
{
    (void)state;
    const struct task row = {.at = {0, 0, W, 1, 1, 1}};
    struct task odd[] = {row, row, row};
    static struct file log, check;
    struct verify v;
    odd[0].frame = 7;
    odd[1].at.w = W * H + 1;
    odd[2].at.y = 1; /* not in the log */
    log.n = check.n = 0;
    put(&log, &odd[0], odd[0].at, 0);
    put(&log, &row, row.at, 0);
    for (int i = 0; i < 3; i++) put(&check, &odd[i], odd[i].at, 1);
    verify_init(&v, 0, 1, three.place_of, 3, 3);
    frames(&v);
    static float pixels[4 * W * H];
    for (size_t i = 0; i < log.n; i++) verify_choose(&v, &log.at[i].t);
    for (size_t i = 0; i < check.n; i++) verify_cut(&v, &check.at[i].t);
    verify_split(&v);
    for (size_t i = 0; i < log.n; i++) verify_first(&v, &log.at[i].t, 0, 0, pixels);
    verify_begin(&v);
    for (size_t i = 0; i < check.n; i++) verify_again(&v, &check.at[i].t, 1, 1, pixels);
    verify_again(&v, &row, 3, -1, pixels);
    verify_again(&v, &row, -1, -1, pixels);
    verify_end(&v);
    assert_int_equal(v.n, 1);
    assert_int_equal(v.part[0].n, 1);
    verify_free(&v);
}

/* ---- requests, words, files ------------------------------------------------------------------ */

/* Each part that is to be computed is requested once, of the slot that is next. */
static uint32_t requests(const struct verify *v)
{
    uint32_t n = 0, expected = 0;
    for (uint32_t i = 0; i < v->n; i++) expected += verify_next(v, &v->part[i]) >= 0;
    for (uint32_t frame = 0; frame < FRAMES; frame++) {
        struct task t;
        for (uint32_t from = 0; verify_request(v, frame, &from, &t); n++) {
            assert_int_equal(t.frame, frame);
            assert_int_equal(from, t.id + 1);
            assert_int_equal(v->part[t.id].frame, frame);
            assert_memory_equal(&t.at, &v->part[t.id].at, sizeof t.at);
            assert_true(t.to >= 0 && t.to == verify_next(v, &v->part[t.id]));
        }
    }
    assert_int_equal(n, expected);
    return n;
}

/* Those of a slot that hangs are requested again, the others are settled. */
static void test_requests(void **state)
{
    (void)state;
    static const struct crew hung = {3, 3, {0, 1, 2}, {0, HUNG, 0}};
    static struct file check;
    struct verify v;
    uint64_t draws = 1;
    make_log(&the_log, &three, 0);
    read_all(&v, &hung, 1, 7, &the_log, NULL, 0);
    assert_int_equal(requests(&v), FRAMES * H);
    make_check(&check, &v, &hung, false, &draws);
    verify_free(&v);
    read_all(&v, &hung, 1, 7, &the_log, &check, 1);
    assert_in_range(requests(&v), 1, v.n - 1);
    verify_free(&v);
}

static const char *const abc[] = {"a", "b", "c"};

static void described(const struct verify *v, const char *expected)
{
    struct verify_hosts h;
    struct buf b = {0};
    verify_hosts_init(&h, abc, 3);
    verify_describe(&v->part[0], &h, &b);
    verify_hosts_free(&h);
    buf_append(&b, "", 1);
    assert_string_equal((const char *)buf_data(&b), expected);
    buf_free(&b);
}

static void test_describe(void **state)
{
    (void)state;
    struct verify v;
    start(&v, three.place_of, 3, 3);
    say(&v, 0, 0);
    say(&v, 1, 5);
    described(&v, "frame 0 at 0,0: slot 0 (host a) and slot 1 (host b) computed different pixels");
    say(&v, 2, 0);
    described(&v, "frame 0 at 0,0: slot 1 (host b) computed other pixels than two other hosts");
    verify_free(&v);
    start(&v, three.place_of, 3, 3);
    say(&v, 3, 5);
    say(&v, 0, 6);
    say(&v, 1, 0);
    say(&v, 2, 0);
    described(&v, "frame 0 at 0,0: a slot of an earlier run, slot 0 (host a) computed other pixels "
                  "than two other hosts");
    verify_free(&v);
}

/* A file of rows from .. to - 1 of frame 0; row y by slot (y + turn) mod 3; row `lie` is wrong. A
 * row alone comes in two halves. `host_of`: the host of each slot, or NULL. */
static char *write_rows_of(
    const char *const *host_of, uint32_t from, uint32_t to, uint32_t turn, uint32_t lie)
{
    static float pixels[4 * W];
    const struct frame_size size = {.w = W, .h = H};
    struct buf b = {0};
    struct record r;
    const char *base = getenv("TMPDIR");
    char *path = xmalloc(4096, 1), stamp[16];
    snprintf(path, 4096, "%s/stormring-verify-XXXXXX", base ? base : "/tmp");
    wire_hello(&b, "fan", "00ff", 1, 3);
    for (int k = 0; k < 3; k++) {
        snprintf(
            stamp, sizeof stamp, host_of ? "w=%d host=%s" : "w=%d", k, host_of ? host_of[k] : "");
        wire_job(&b, &size, JOB, stamp);
    }
    for (uint32_t y = from; y < to; y++) {
        struct task t = {.id = y, .at = {0, y, W, 1, 1, 1}, .to = -1};
        struct buf sent = {0};
        for (size_t i = 0; i < 4 * W; i++) pixels[i] = i % 4 == 3 ? 1 : (float)(y == lie);
        for (uint64_t n0 = 0, n = to - from == 1 ? W / 2 : W; n0 < W; n0 += n) {
            struct lattice at = lattice_cut(&t.at, W, n0, n);
            wire_frag(&sent, &t, &at, JOB, pixels);
        }
        struct decoder d = wire_over(sent.data, sent.len);
        snprintf(stamp, sizeof stamp, "w=%u", (y + turn) % 3);
        while (wire_next(&d, &r) == WIRE_RECORD) wire_forward(&b, &r, NULL, stamp);
        buf_free(&sent);
    }
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write_full(fd, buf_data(&b), buf_size(&b)), 0);
    close(fd);
    buf_free(&b);
    return path;
}

static char *write_rows(uint32_t from, uint32_t to, uint32_t turn, uint32_t lie)
{
    return write_rows_of(NULL, from, to, turn, lie);
}

/* The log and two rounds of checks: row 2 of the log is a lie. */
static void test_files(void **state)
{
    (void)state;
    struct verify v;
    struct verify_hosts h;
    char why[LOG_WHY];
    const char *name;
    char *files[] = {write_rows(0, H, 0, 2), write_rows(0, H, 1, H), write_rows(2, 3, 2, H), NULL};
    verify_hosts_init(&h, abc, 3);
    verify_init(&v, 7, 1, h.place_of, 3, h.places);
    assert_int_equal(verify_read(&v, &h, files, &name, why), 0);
    assert_int_equal(v.pieces, H);
    assert_int_equal(verify_counted(&v).different, 1);
    assert_int_equal(verify_counted(&v).unchecked, 0);
    assert_int_equal(v.n, H + 1);
    for (uint32_t half = 2; half < 4; half++) {
        assert_int_equal(v.part[half].at.w, W / 2);
        assert_int_equal(v.part[half].n, 3);
        assert_int_equal(v.part[half].by[0].slot, 2);
    }
    for (int k = 0; k < 3; k++) assert_true(v.place[k].asked_px);
    assert_int_equal(v.rounds, 2);
    const struct verify_frame *frame = frames_extra(&v.frames, &v.frames.at[0]);
    assert_string_equal(frame->job, JOB);
    verify_free(&v);
    verify_hosts_free(&h);
    unlink(files[2]);
    verify_hosts_init(&h, abc, 3);
    verify_init(&v, 7, 1, h.place_of, 3, h.places);
    assert_int_equal(verify_read(&v, &h, files, &name, why), -1); /* cannot be opened */
    assert_int_equal(errno, ENOENT);
    assert_ptr_equal(name, files[2]);
    verify_free(&v);
    verify_hosts_free(&h);
    for (int i = 0; i < 3; i++) {
        unlink(files[i]);
        free(files[i]);
    }
}

/* In a log of two runs the slots of the first one may have been on other hosts. */
static void test_earlier_runs(void **state)
{
    (void)state;
    struct verify v;
    struct verify_hosts h;
    char why[LOG_WHY];
    const char *name;
    char *files[] = {write_rows(0, 3, 0, H), NULL}, *second = write_rows(3, H, 0, H);
    struct buf b = {0};
    assert_int_equal(read_file(files[0], &b), 0);
    assert_int_equal(read_file(second, &b), 0);
    unlink(files[0]); /* what was read is not replaced */
    assert_int_equal(outfile_put(files[0], buf_data(&b), buf_size(&b)), 0);
    verify_hosts_init(&h, abc, 3);
    verify_init(&v, 7, 1, h.place_of, 3, h.places);
    assert_int_equal(verify_read(&v, &h, files, &name, why), 0);
    for (uint32_t y = 0; y < H; y++) {
        assert_int_equal(v.part[y].by[0].slot, y < 3 ? -1 : (int32_t)(y % 3));
        assert_int_equal(v.part[y].by[0].place, v.part[y].by[0].slot);
    }
    verify_free(&v);
    verify_hosts_free(&h);
    buf_free(&b);
    unlink(files[0]);
    unlink(second);
    free(files[0]);
    free(second);
}

/* Reads files[0] as the log and files[1], if there is one, as a check. */
static void read_two(struct verify *v, struct verify_hosts *h, const char *const *now,
    int32_t slots, char *const *files)
{
    char why[LOG_WHY];
    const char *name;
    verify_hosts_init(h, now, slots);
    verify_init(v, 7, 1, h->place_of, slots, h->places);
    assert_int_equal(verify_read(v, h, files, &name, why), 0);
}

/* Slots of the log were on hosts a, b and c; now slot 0 is on c and slot 1 on d. */
static void test_joined(void **state)
{
    (void)state;
    static const char *const now[] = {"c", "d", "d"};
    struct verify v;
    struct verify_hosts h;
    char *files[] = {write_rows_of(abc, 0, H, 0, 2), NULL, NULL};
    read_two(&v, &h, now, 3, files);
    for (uint32_t y = 0; y < H; y++) {
        assert_string_equal(verify_hosts_name(&h, v.part[y].by[0].place), abc[y % 3]);
        int32_t slot = verify_next(&v, &v.part[y]);
        assert_true(y % 3 == 2 ? slot > 0 : slot >= 0); /* c does not check itself */
    }
    verify_free(&v);
    verify_hosts_free(&h);
    files[1] = write_rows_of(now, 0, H, 2, H); /* row y by slot (y + 2) mod 3 */
    read_two(&v, &h, now, 3, files);
    assert_int_equal(verify_counted(&v).unchecked, 0); /* d d c d d c d d */
    assert_int_equal(verify_counted(&v).different, 1);
    struct buf b = {0};
    verify_describe(&v.part[2], &h, &b);
    buf_append(&b, "", 1);
    assert_string_equal((const char *)buf_data(&b),
        "frame 0 at 0,2: slot 2 (host c) and slot 1 (host d) computed different pixels");
    buf_free(&b);
    verify_free(&v);
    verify_hosts_free(&h);
    for (int i = 0; i < 2; i++) {
        unlink(files[i]);
        free(files[i]);
    }
}

/* Slots check each other if the run and the checks had one host, not if a second one has left. */
static void test_only_host(void **state)
{
    (void)state;
    static const char *const only[] = {"a", "a", "a"}, *const two[] = {"a", "a", "b"};
    struct verify v;
    struct verify_hosts h;
    for (int left = 0; left < 2; left++) {
        char *files[] = {write_rows_of(left ? two : only, 0, H, 0, H), NULL, NULL};
        read_two(&v, &h, only, 3, files);
        assert_int_equal(h.several, left);
        for (uint32_t y = 0; y < H; y++)
            assert_int_equal(verify_next(&v, &v.part[y]) >= 0, !left || y % 3 == 2);
        verify_free(&v);
        verify_hosts_free(&h);
        unlink(files[0]);
        free(files[0]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_honest), cmocka_unit_test(test_liar),
        cmocka_unit_test(test_two_liars), cmocka_unit_test(test_hung),
        cmocka_unit_test(test_hung_of_two), cmocka_unit_test(test_behind),
        cmocka_unit_test(test_places), cmocka_unit_test(test_parent_and_piece),
        cmocka_unit_test(test_half), cmocka_unit_test(test_twice_in_log),
        cmocka_unit_test(test_every_value_counts), cmocka_unit_test(test_no_witness),
        cmocka_unit_test(test_one_host), cmocka_unit_test(test_both_ways),
        cmocka_unit_test(test_next), cmocka_unit_test(test_earlier), cmocka_unit_test(test_seeds),
        cmocka_unit_test(test_foreign), cmocka_unit_test(test_requests),
        cmocka_unit_test(test_describe), cmocka_unit_test(test_files),
        cmocka_unit_test(test_earlier_runs), cmocka_unit_test(test_joined),
        cmocka_unit_test(test_only_host)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
