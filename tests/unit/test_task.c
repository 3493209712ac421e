/*
 * task: the lattice on every small frame against counting by hand; the cuts of a frame; what
 * coverage says is missing; the tables. "By hand" is positions(), which knows nothing but the
 * formula in task.h.
 */
#include "task/task.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define SIDE 5 /* the largest frame that is tried with every lattice in it */

/* The pixels of l in order, by the formula alone; as many as there are. */
static size_t positions(const struct lattice *l, uint32_t frame_w, uint64_t *at)
{
    size_t n = 0;
    for (uint64_t j = 0; j < l->h; j++)
        for (uint64_t i = 0; i < l->w; i++)
            at[n++] = (uint64_t)l->y * frame_w + l->x + i * l->sx + j * l->sy * frame_w;
    return n;
}

/* Calls act with every lattice whose numbers are up to the frame's (and one more), in every
 * frame. */
static void each_lattice(
    void (*act)(const struct lattice *l, uint32_t frame_w, uint32_t frame_h), uint32_t side)
{
    struct lattice l;
    for (uint32_t fw = 1; fw <= side; fw++)
        for (uint32_t fh = 1; fh <= side - 1; fh++)
            for (l.x = 0; l.x <= fw; l.x++)
                for (l.y = 0; l.y <= fh; l.y++)
                    for (l.w = 0; l.w <= fw * fh + 1; l.w++)
                        for (l.h = 0; l.h <= fh + 1; l.h++)
                            for (l.sx = 0; l.sx <= fw * fh + 1; l.sx++)
                                for (l.sy = 0; l.sy <= fh + 1; l.sy++) act(&l, fw, fh);
}

static bool valid_by_hand(const struct lattice *l, uint32_t fw, uint32_t fh)
{
    uint64_t at[(SIDE * SIDE + 1) * (SIDE + 1)];
    if (!l->w || !l->h || !l->sx || !l->sy || l->x >= fw || l->y >= fh) return false;
    if (l->sx > fw * fh || l->sy > fh) return false;
    size_t n = positions(l, fw, at);
    if (n > (size_t)fw * fh) return false;
    for (size_t i = 0; i < n; i++)
        if (at[i] >= (uint64_t)fw * fh) return false;
    return true;
}

static void check_valid(const struct lattice *l, uint32_t fw, uint32_t fh)
{
    if (lattice_valid(l, fw, fh) != valid_by_hand(l, fw, fh))
        fail_msg("%ux%u: %u %u %u %u %u %u", fw, fh, l->x, l->y, l->w, l->h, l->sx, l->sy);
}

static void test_valid(void **state)
{
    (void)state;
    each_lattice(check_valid, SIDE);
}

static void test_valid_extremes(void **state)
{
    (void)state;
    const uint32_t most = UINT32_MAX, side = FRAME_SIDE_MAX;
    assert_true(lattice_valid(&(struct lattice){0, 0, side, side, 1, 1}, side, side));
    assert_true(lattice_valid(&(struct lattice){0, 0, side * side, 1, 1, 1}, side, side));
    assert_true(
        lattice_valid(&(struct lattice){side - 1, side - 1, 1, 1, side * side, 1}, side, side));
    assert_false(lattice_valid(&(struct lattice){1, 0, side * side, 1, 1, 1}, side, side));
    assert_false(lattice_valid(&(struct lattice){most, most, most, most, most, most}, side, side));
    assert_false(lattice_valid(&(struct lattice){0, 0, most, most, 1, 1}, side, side));
    assert_false(lattice_valid(&(struct lattice){0, 0, 2, 2, most, most}, side, side));
    assert_false(lattice_valid(&(struct lattice){0, 0, 1, 1, 1, 1}, side + 1, 1));
    assert_false(lattice_valid(&(struct lattice){0, 0, 1, 1, 1, 1}, 0, 1));
}

/* No pixel twice: what partition makes, and what a piece's place can be told of. */
static bool distinct(const uint64_t *at, size_t n)
{
    uint64_t seen = 0;
    for (size_t i = 0; i < n; i++) {
        if (seen >> at[i] & 1) return false;
        seen |= UINT64_C(1) << at[i];
    }
    return true;
}

/* Cutting from 0 in steps of every length: the same pixels in the same order, and each piece is
 * found. */
static void check_cut(const struct lattice *l, uint32_t fw, uint32_t fh)
{
    uint64_t all[SIDE * SIDE], piece[SIDE * SIDE];
    if (!lattice_valid(l, fw, fh)) return;
    size_t n = positions(l, fw, all);
    bool unique = distinct(all, n);
    for (size_t i = 0; i < n; i++) assert_int_equal(lattice_pixel(l, fw, i), all[i]);
    for (uint64_t most = 1; most <= n + 1; most++)
        for (uint64_t n0 = 0; n0 < n;) {
            struct lattice cut = lattice_cut(l, fw, n0, most);
            if (!lattice_valid(&cut, fw, fh)) fail_msg("an invalid piece");
            size_t k = positions(&cut, fw, piece);
            assert_true(k >= 1 && k <= most && n0 + k <= n);
            assert_memory_equal(piece, all + n0, k * sizeof *piece);
            if (unique) assert_int_equal(lattice_offset(l, fw, &cut), n0);
            n0 += k;
        }
}

static void test_cut(void **state)
{
    (void)state;
    each_lattice(check_cut, SIDE - 1);
}

/* A piece that starts anywhere, as a worker that was interrupted would go on. */
static void check_cut_anywhere(const struct lattice *l, uint32_t fw, uint32_t fh)
{
    uint64_t all[SIDE * SIDE], piece[SIDE * SIDE];
    if (!lattice_valid(l, fw, fh)) return;
    size_t n = positions(l, fw, all);
    for (uint64_t n0 = 0; n0 < n; n0++) {
        struct lattice cut = lattice_cut(l, fw, n0, n);
        size_t k = positions(&cut, fw, piece);
        assert_true(k >= 1 && n0 + k <= n);
        assert_memory_equal(piece, all + n0, k * sizeof *piece);
    }
}

static void test_cut_anywhere(void **state)
{
    (void)state;
    each_lattice(check_cut_anywhere, SIDE - 1);
}

/* Whatever a worker claims to be a piece of a task: an offset is given only where the pixels are
 * those. */
static struct lattice whole;
static uint64_t of_whole[SIDE * SIDE];
static size_t n_whole;

static void check_claim(const struct lattice *l, uint32_t fw, uint32_t fh)
{
    uint64_t piece[SIDE * SIDE];
    if (fw != 3 || fh != 3 || !lattice_valid(l, fw, fh)) return;
    int64_t n0 = lattice_offset(&whole, fw, l);
    if (n0 < 0) return;
    size_t k = positions(l, fw, piece);
    assert_true((size_t)n0 + k <= n_whole);
    assert_memory_equal(piece, of_whole + n0, k * sizeof *piece);
}

static void check_claims(const struct lattice *l, uint32_t fw, uint32_t fh)
{
    if (fw != 3 || fh != 3 || !lattice_valid(l, fw, fh)) return;
    whole = *l;
    n_whole = positions(l, fw, of_whole);
    struct lattice sub;
    sub.sx = l->sx;
    sub.sy = l->sy;
    for (sub.x = 0; sub.x < fw; sub.x++)
        for (sub.y = 0; sub.y < fh; sub.y++)
            for (sub.w = 1; sub.w <= fw * fh; sub.w++)
                for (sub.h = 1; sub.h <= fh; sub.h++) check_claim(&sub, fw, fh);
}

static void test_false_claims(void **state)
{
    (void)state;
    each_lattice(check_claims, 4);
    struct lattice row = {0, 1, 3, 1, 1, 1}, other = {0, 1, 3, 1, 2, 1}, above = {0, 0, 3, 1, 1, 1};
    assert_int_equal(lattice_offset(&row, 3, &row), 0);
    assert_int_equal(lattice_offset(&row, 3, &other), -1);
    assert_int_equal(lattice_offset(&row, 3, &above), -1);
}

/* ---- cutting frames --------------------------------------------------------------------- */

/* The tasks of a cut name each pixel of the frame once. */
static void check_cover(const struct cut *cut, uint32_t fw, uint32_t fh)
{
    struct coverage c;
    uint64_t at[64 * 64];
    coverage_init(&c, fw, fh);
    uint32_t count = cut_count(cut, fw, fh);
    for (uint32_t id = 0; id < count; id++) {
        struct task t = cut_task(cut, fw, fh, id);
        assert_true(t.id == id && t.frame == 0 && t.to == -1);
        if (!lattice_valid(&t.at, fw, fh)) fail_msg("%ux%u: task %u is outside", fw, fh, id);
        size_t n = positions(&t.at, fw, at);
        for (size_t i = 0; i < n; i++) assert_true(coverage_set(&c, at[i]));
    }
    assert_true(coverage_full(&c));
    coverage_free(&c);
}

static void test_cut_kinds(void **state)
{
    (void)state;
    for (uint32_t fw = 1; fw <= 9; fw++)
        for (uint32_t fh = 1; fh <= 9; fh++) {
            check_cover(&(struct cut){.unit = CUT_ROW, .w = 0, .h = 1}, fw, fh);
            for (uint32_t w = 1; w <= fw * fh + 2; w++) {
                check_cover(&(struct cut){.unit = CUT_RUN, .w = w, .h = 1}, fw, fh);
                check_cover(&(struct cut){.unit = CUT_SCATTER, .w = w, .h = 1}, fw, fh);
                for (uint32_t h = 1; h <= fh + 2; h++)
                    if (w <= fw + 2)
                        check_cover(&(struct cut){.unit = CUT_TILE, .w = w, .h = h}, fw, fh);
            }
        }
    check_cover(&(struct cut){.unit = CUT_RUN, .w = 250, .h = 1}, 64, 64);
    assert_int_equal(
        cut_count(&(struct cut){.unit = CUT_TILE, .w = 1, .h = 1}, FRAME_SIDE_MAX, FRAME_SIDE_MAX),
        UINT32_C(65535) * 65535);
    struct task last = cut_task(
        &(struct cut){.unit = CUT_RUN, .w = UINT32_MAX, .h = 1}, FRAME_SIDE_MAX, FRAME_SIDE_MAX, 0);
    assert_true(lattice_valid(&last.at, FRAME_SIDE_MAX, FRAME_SIDE_MAX));
}

/* Tasks a slot, but fine ones no longer than a row, coarse ones no shorter than asked. The longer
 * sides of tiles are halved until there are enough. */
static void test_runs(void **state)
{
    (void)state;
    static const struct {
        const char *cut;
        uint32_t fw, fh;
        int slots;
        uint32_t count, first;
    } cases[] = {
        {"fine", 512, 512, 14, 2115, 124},       /* 262144 / 2100 */
        {"fine", 512, 512, 2, 512, 512},         /* 873 pixels are more than a row */
        {"fine", 3, 4, 100, 12, 1},              /* a pixel at least */
        {"fine:30", 512, 512, 17, 512, 512},     /* 514 pixels */
        {"fine:30", 512, 512, 18, 541, 485},     /* 262144 / 540 */
        {"coarse:250", 512, 512, 2, 301, 873},   /* longer than asked */
        {"coarse:250", 512, 512, 14, 1049, 250}, /* as asked */
        {"coarse:250", 10, 10, 1000000, 1, 100}, /* all there is */
        {"coarse:1", FRAME_SIDE_MAX, FRAME_SIDE_MAX, 1, 151, 28632241},
        {"tile:64x16:30", 512, 512, 8, 256, 1024},  /* as asked: 240 are enough */
        {"tile:64x16:30", 512, 512, 9, 512, 512},   /* 32x16 */
        {"tile:64x16:30", 512, 512, 35, 2048, 128}, /* 16x16 is not enough for 1050: 16x8 */
        {"tile:5x3:1000000", 7, 5, 1000000, 35, 1}, /* a pixel at least */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct cut cut;
        assert_true(cut_parse(cases[i].cut, &cut) && cut_follows_slots(&cut));
        cut_suit(&cut, cases[i].fw, cases[i].fh, cases[i].slots);
        assert_int_equal(cut_count(&cut, cases[i].fw, cases[i].fh), cases[i].count);
        struct task first = cut_task(&cut, cases[i].fw, cases[i].fh, 0);
        assert_int_equal(lattice_count(&first.at), cases[i].first);
        if (cases[i].fw <= 512) check_cover(&cut, cases[i].fw, cases[i].fh);
    }
}

/* Chunks never grow from one batch to the next, and cover every frame. */
static void test_chunks(void **state)
{
    (void)state;
    static const double power[] = {1, .442, 1.347, 2};
    for (uint32_t fw = 1; fw <= 6; fw++)
        for (uint32_t fh = 1; fh <= 12; fh++)
            for (uint32_t w = 0; w <= fw * fh + 2; w++)
                for (int slots = 1; slots <= 4; slots++) {
                    struct cut guided = {.unit = CUT_GUIDED, .w = w};
                    struct cut factoring = {.unit = CUT_FACTORING, .w = w}, weighted = factoring;
                    cut_chunks(&guided, fw, fh, NULL, slots);
                    cut_chunks(&factoring, fw, fh, NULL, slots);
                    cut_chunks(&weighted, fw, fh, power, slots);
                    check_cover(&guided, fw, fh);
                    check_cover(&factoring, fw, fh);
                    check_cover(&weighted, fw, fh);
                    for (uint32_t i = 2; i < guided.n; i++)
                        assert_true(guided.ends[i] - guided.ends[i - 1] <=
                                    guided.ends[i - 1] - guided.ends[i - 2]);
                    cut_free(&guided);
                    cut_free(&factoring);
                    cut_free(&weighted);
                }
    struct cut large = {.unit = CUT_FACTORING, .w = 1};
    cut_chunks(&large, FRAME_SIDE_MAX, FRAME_SIDE_MAX, NULL, 1000);
    assert_int_equal(large.ends[large.n - 1], UINT32_C(65535) * 65535);
    assert_int_equal(large.ends[0], (UINT32_C(65535) * 65535 + 1999) / 2000);
    struct task last = cut_task(&large, FRAME_SIDE_MAX, FRAME_SIDE_MAX, large.n - 1);
    assert_true(lattice_valid(&last.at, FRAME_SIDE_MAX, FRAME_SIDE_MAX));
    cut_free(&large);
}

static void test_cut_parse(void **state)
{
    (void)state;
    static const char *const bad[] = {"", "rows", "row:2", "tile", "tile:", "tile:0x1", "tile:4",
        "tile:4x4:", "tile:4x4:0", "tile:4x4:2:2", "fine:", "fine:0", "fine:1000001", "coarse",
        "coarse:0", "run:0", "run:", "run:-1", "run:4294967296", "scatter:3", "Row", "run:1x1",
        "guided:", "guided:0", "guided:x", "guide", "factoring:0", "factoring5"};
    struct cut c;
    assert_true(cut_parse("row", &c) && c.unit == CUT_ROW);
    assert_true(cut_parse("scatter", &c) && c.unit == CUT_SCATTER);
    assert_true(cut_parse("tile:32x16", &c) && c.unit == CUT_TILE && c.w == 32 && c.h == 16);
    assert_true(cut_parse("run:250", &c) && c.unit == CUT_RUN && c.w == 250);
    assert_true(cut_parse("fine", &c) && c.unit == CUT_FINE);
    assert_true(cut_parse("coarse:250", &c) && c.unit == CUT_COARSE && c.w == 250);
    assert_true(cut_parse("guided", &c) && c.unit == CUT_GUIDED && c.w == 0);
    assert_true(cut_parse("factoring:16", &c) && c.unit == CUT_FACTORING && c.w == 16);
    assert_true(cut_parse("run:4294967295", &c) && c.w == UINT32_MAX);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (cut_parse(bad[i], &c)) fail_msg("\"%s\" was taken", bad[i]);
}

/* ---- coverage --------------------------------------------------------------------------- */

/* Takes what is missing until nothing is: each missing pixel once. Returns the number of
 * lattices. */
static int check_missing(const struct coverage *c)
{
    struct coverage taken, named;
    struct lattice l;
    uint64_t at[64 * 64], p = 0;
    int lattices = 0;
    coverage_copy(&taken, c);
    coverage_init(&named, c->w, c->h);
    for (; coverage_missing(&taken, &p, &l); lattices++) {
        assert_true(lattice_valid(&l, c->w, c->h));
        size_t n = positions(&l, c->w, at);
        for (size_t i = 0; i < n; i++) {
            assert_false(coverage_has(c, at[i]));
            assert_true(coverage_set(&named, at[i]));
        }
    }
    assert_int_equal(named.done + c->done, (uint64_t)c->w * c->h);
    assert_true(coverage_full(&taken));
    assert_false(coverage_missing(&taken, &p, &l));
    coverage_free(&taken);
    coverage_free(&named);
    return lattices;
}

static void test_missing_of_every_small_frame(void **state)
{
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {1, 7}, {7, 1}, {3, 3}, {4, 3}, {3, 4}, {2, 6}};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        uint32_t w = sizes[s][0], h = sizes[s][1];
        for (uint32_t bits = 0; bits < UINT32_C(1) << (w * h); bits++) {
            struct coverage c;
            coverage_init(&c, w, h);
            for (uint32_t p = 0; p < w * h; p++)
                if (bits >> p & 1) coverage_set(&c, p);
            check_missing(&c);
            coverage_free(&c);
        }
    }
}

static void test_missing_at_random(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 300; seed++) {
        struct coverage c;
        uint32_t w = (uint32_t)(1 + rng_u64(seed, 0) % 64),
                 h = (uint32_t)(1 + rng_u64(seed, 1) % 64);
        double share = rng_unit(seed, 2);
        coverage_init(&c, w, h);
        for (uint32_t p = 0; p < w * h; p++)
            if (rng_unit(seed, 3 + p) < share) coverage_set(&c, p);
        check_missing(&c);
        coverage_free(&c);
    }
}

/* What a lost worker leaves, in as few tasks as it had. */
static void test_missing_share_of_a_worker(void **state)
{
    (void)state;
    static const struct {
        struct cut cut;
        int tasks;
    } cases[] = {{{.unit = CUT_ROW}, 16}, {{.unit = CUT_SCATTER, .w = 4}, 1}};
    for (size_t k = 0; k < 2; k++) {
        struct coverage c;
        uint64_t at[64 * 64];
        coverage_init(&c, 64, 64);
        uint32_t count = cut_count(&cases[k].cut, 64, 64);
        for (uint32_t id = 0; id < count; id++) {
            struct task t = cut_task(&cases[k].cut, 64, 64, id);
            size_t n = positions(&t.at, 64, at);
            for (size_t i = 0; i < n && id % 4 != 2; i++) coverage_set(&c, at[i]);
        }
        assert_int_equal(check_missing(&c), cases[k].tasks);
        coverage_free(&c);
    }
    struct coverage none;
    coverage_init(&none, 64, 48);
    assert_int_equal(check_missing(&none), 48); /* rows */
    coverage_free(&none);
}

/* ---- tables ----------------------------------------------------------------------------- */

static void test_frames(void **state)
{
    (void)state;
    struct frames f = {0};
    assert_null(frames_find(&f, 0));
    for (uint32_t i = 0; i < 100; i++) frames_set(&f, i * 7, i + 1, 2);
    frames_set(&f, 21, 99, 98);
    assert_int_equal(f.n, 100);
    assert_int_equal(frames_find(&f, 21)->w, 99);
    assert_int_equal(frames_find(&f, 693)->w, 100);
    assert_null(frames_find(&f, 1));
    frames_free(&f);
    assert_null(frames_find(&f, 21));
}

/* The payload of a frame. Its alignment is that of its widest member. */
struct own_frame {
    uint64_t mark;
    uint8_t tail;
};

static uint64_t mark_of(const struct frames *f, uint32_t frame)
{
    const struct own_frame *own = frames_extra(f, frames_find(f, frame));
    assert_int_equal(own->tail, (uint8_t)own->mark);
    return own->mark;
}

/* A payload stays with its frame, wherever later frames are inserted; a new size zeroes it. */
static void test_frame_payloads(void **state)
{
    (void)state;
    enum { N = 97 };
    struct frames f;
    frames_init(&f, sizeof(struct own_frame));
    for (uint32_t i = 0; i < N; i++) {
        uint32_t frame = i * 29 % N; /* in no order */
        struct own_frame *own = frames_extra(&f, frames_set(&f, frame, 1, 1));
        assert_int_equal((uintptr_t)own % _Alignof(struct own_frame), 0);
        assert_true(!own->mark && !own->tail);
        own->mark = UINT64_C(1000000000000) + frame;
        own->tail = (uint8_t)own->mark;
        for (uint32_t k = 0; k <= i; k++)
            assert_int_equal(mark_of(&f, k * 29 % N), UINT64_C(1000000000000) + k * 29 % N);
    }
    frames_set(&f, 13, 5, 6);
    assert_int_equal(mark_of(&f, 13), 0);
    assert_int_equal(mark_of(&f, 12), UINT64_C(1000000000012));
    assert_int_equal(mark_of(&f, 14), UINT64_C(1000000000014));
    frames_free(&f);
    assert_int_equal(mark_of(&f, frames_set(&f, 13, 5, 6)->frame), 0); /* it has payloads still */
    frames_free(&f);
}

enum { KEYS = 400 };

static struct task key(uint64_t k)
{
    return (struct task){
        .frame = (uint32_t)(k % 3), .id = (uint32_t)(k / 3), .at = {0, 0, 4, 1, 1, 1}, .to = -1};
}

/* Random additions and removals against an array. */
static void test_table(void **state)
{
    (void)state;
    struct task_table t = {0};
    int32_t where[KEYS], live = 0;
    for (int k = 0; k < KEYS; k++) where[k] = -1;
    assert_int_equal(tasks_find(&t, 0, 0), -1);
    for (uint64_t step = 0; step < 20000; step++) {
        uint64_t k = rng_u64(5, step) % KEYS;
        struct task task = key(k);
        assert_int_equal(tasks_find(&t, task.frame, task.id), where[k]);
        if (where[k] >= 0) {
            tasks_remove(&t, where[k]);
            where[k] = -1;
            live--;
        } else {
            where[k] = tasks_add(&t, &task, 4);
            live++;
        }
        assert_int_equal(t.count, live);
    }
    int32_t cap = t.cap;
    for (uint64_t k = 0; k < KEYS; k++) {
        struct task task = key(k);
        assert_int_equal(tasks_find(&t, task.frame, task.id), where[k]);
        if (where[k] < 0) continue;
        assert_true(t.at[where[k]].live && t.at[where[k]].task.id == task.id);
        tasks_remove(&t, where[k]);
    }
    for (uint64_t k = 0; k < (uint64_t)cap; k++) { /* memory is reused */
        struct task task = key(k);
        tasks_add(&t, &task, 4);
    }
    assert_int_equal(t.cap, cap);
    tasks_free(&t);
    assert_int_equal(tasks_find(&t, 0, 0), -1);
}

/* The payload of a task; all of its bytes matter. */
struct own_task {
    int64_t key;
    int32_t list[2];
};

/* Random additions and removals: each live task has its payload, through growth and its
 * neighbours' removal; an added one begins with zeros, wherever it is. */
static void test_payloads(void **state)
{
    (void)state;
    struct task_table t;
    bool live[KEYS] = {0};
    tasks_init(&t, sizeof(struct own_task));
    for (uint64_t step = 0; step < 20000; step++) {
        uint64_t k = rng_u64(6, step) % KEYS;
        struct task task = key(k);
        int32_t i = tasks_find(&t, task.frame, task.id);
        assert_int_equal(i >= 0, live[k]);
        if (!live[k]) {
            i = tasks_add(&t, &task, 4);
            const struct own_task zero = {0};
            struct own_task *own = tasks_extra(&t, i);
            assert_int_equal((uintptr_t)own % _Alignof(struct own_task), 0);
            assert_memory_equal(own, &zero, sizeof zero);
            *own = (struct own_task){.key = -(int64_t)k, .list = {(int32_t)k, -1}};
        } else {
            const struct own_task want = {.key = -(int64_t)k, .list = {(int32_t)k, -1}};
            assert_memory_equal(tasks_extra(&t, i), &want, sizeof want);
            tasks_remove(&t, i);
        }
        live[k] = !live[k];
    }
    tasks_free(&t);
    struct task task = key(1);
    struct own_task *own = tasks_extra(&t, tasks_add(&t, &task, 4)); /* it has payloads still */
    assert_int_equal(own->key, 0);
    tasks_free(&t);
}

/* A payload is as long as its struct, whatever that is: the last byte of each is the owner's. */
static void test_payload_sizes(void **state)
{
    (void)state;
    for (size_t size = 0; size <= 40; size++) {
        struct task_table t;
        tasks_init(&t, size);
        for (uint64_t k = 0; k < 130; k++) {
            struct task task = key(k);
            int32_t i = tasks_add(&t, &task, 4);
            if (size) memset(tasks_extra(&t, i), (int)k + 1, size);
        }
        for (uint64_t k = 0; k < 130; k++) {
            struct task task = key(k);
            const unsigned char *own =
                size ? tasks_extra(&t, tasks_find(&t, task.frame, task.id)) : NULL;
            for (size_t b = 0; b < size; b++) assert_int_equal(own[b], k + 1);
        }
        assert_int_equal(t.extra.at != NULL, size > 0); /* none costs no memory */
        tasks_free(&t);
        assert_int_equal(t.extra.size, size);
    }
}

static void assert_list(const struct task_table *t, const struct task_list *l, const char *ids)
{
    char got[32];
    size_t n = 0;
    for (int32_t i = l->head; i >= 0; i = t->at[i].next) got[n++] = (char)('0' + t->at[i].task.id);
    got[n] = '\0';
    assert_string_equal(got, ids);
    assert_int_equal(l->count, n);
    for (int32_t i = l->tail; i >= 0; i = t->at[i].prev) n--;
    assert_int_equal(n, 0);
}

static void test_lists(void **state)
{
    (void)state;
    struct task_table t = {0};
    struct task_list l = TASK_LIST_EMPTY, m = TASK_LIST_EMPTY;
    int32_t i[5];
    for (uint32_t k = 0; k < 5; k++) {
        struct task task = {.id = k, .at = {0, 0, 1, 1, 1, 1}};
        i[k] = tasks_add(&t, &task, 1);
    }
    list_push_back(&t, &l, i[0]);
    list_push_back(&t, &l, i[1]);
    list_push_front(&t, &l, i[2]);
    list_push_back(&t, &m, i[3]);
    list_push_front(&t, &m, i[4]);
    assert_list(&t, &l, "201");
    assert_list(&t, &m, "43");
    list_remove(&t, &l, i[0]);
    assert_list(&t, &l, "21");
    list_push_back(&t, &m, i[0]);
    list_remove(&t, &l, i[2]);
    assert_list(&t, &l, "1");
    list_remove(&t, &l, i[1]);
    assert_list(&t, &l, "");
    list_push_front(&t, &l, i[1]);
    assert_list(&t, &l, "1");
    assert_list(&t, &m, "430");
    tasks_free(&t);
}

static void test_deliver(void **state)
{
    (void)state;
    struct task_table t = {0};
    struct task task = {.at = {0, 2, 8, 1, 1, 1}, .to = -1};
    int32_t i = tasks_add(&t, &task, 8);
    struct lattice first = {0, 2, 3, 1, 1, 1}, next = {3, 2, 3, 1, 1, 1}, last = {6, 2, 2, 1, 1, 1};
    struct lattice over = {6, 2, 3, 1, 1, 1}, elsewhere = {0, 1, 3, 1, 1, 1},
                   overlap = {2, 2, 3, 1, 1, 1};
    assert_false(tasks_deliver(&t, i, &next)); /* a gap */
    assert_true(tasks_deliver(&t, i, &first));
    assert_true(tasks_deliver(&t, i, &first)); /* again */
    assert_int_equal(t.at[i].delivered, 3);
    assert_false(tasks_deliver(&t, i, &last));
    assert_true(tasks_deliver(&t, i, &overlap));
    assert_int_equal(t.at[i].delivered, 5);
    assert_true(tasks_deliver(&t, i, &first));
    assert_int_equal(t.at[i].delivered, 5);
    assert_true(tasks_deliver(&t, i, &next));
    assert_false(tasks_deliver(&t, i, &over));
    assert_false(tasks_deliver(&t, i, &elsewhere));
    assert_false(tasks_whole(&t, i));
    assert_true(tasks_deliver(&t, i, &last));
    assert_true(tasks_whole(&t, i));
    assert_true(tasks_deliver(&t, i, &task.at));
    assert_false(
        tasks_deliver(&t, i, &(struct lattice){0, 3, 3, 1, 1, 1})); /* would go on after it */
    assert_true(tasks_whole(&t, i));
    /* two rows of 20 pixels, which overlap in a frame of width 10 */
    task = (struct task){.id = 1, .at = {0, 0, 20, 2, 1, 1}, .to = -1};
    i = tasks_add(&t, &task, 10);
    for (uint64_t n0 = 0; n0 < 40; n0 += 10) {
        struct lattice piece = lattice_cut(&task.at, 10, n0, 10);
        assert_true(tasks_deliver(&t, i, &piece));
        assert_int_equal(t.at[i].delivered, n0 + 10);
    }
    tasks_free(&t);
}

/* Every lattice of every small frame, with every beginning of it there: what is left of it is its
 * end, at whole rows where it has several, and begins with the first that is missing. */
static void trim_each(const struct lattice *l, uint32_t frame_w, uint32_t frame_h)
{
    uint64_t all[SIDE * SIDE + SIDE], rest[SIDE * SIDE + SIDE];
    if (!lattice_valid(l, frame_w, frame_h)) return;
    size_t n = positions(l, frame_w, all);
    struct coverage c;
    coverage_init(&c, frame_w, frame_h);
    for (size_t k = 0; k <= n; k++) {
        struct lattice at = *l;
        size_t first = 0;
        while (first < n && coverage_has(&c, all[first])) first++;
        assert_int_equal(coverage_trim(&c, &at), first < n);
        if (l->h > 1) first -= first % l->w;
        if (first < n) {
            assert_int_equal(positions(&at, frame_w, rest), n - first);
            assert_memory_equal(rest, all + first, (n - first) * sizeof *rest);
        } else {
            assert_memory_equal(&at, l, sizeof at);
        }
        if (k < n) coverage_set(&c, all[k]);
    }
    coverage_free(&c);
}

static void test_trim(void **state)
{
    (void)state;
    each_lattice(trim_each, 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_valid),
        cmocka_unit_test(test_valid_extremes),
        cmocka_unit_test(test_cut),
        cmocka_unit_test(test_cut_anywhere),
        cmocka_unit_test(test_false_claims),
        cmocka_unit_test(test_cut_kinds),
        cmocka_unit_test(test_runs),
        cmocka_unit_test(test_chunks),
        cmocka_unit_test(test_cut_parse),
        cmocka_unit_test(test_missing_of_every_small_frame),
        cmocka_unit_test(test_missing_at_random),
        cmocka_unit_test(test_missing_share_of_a_worker),
        cmocka_unit_test(test_trim),
        cmocka_unit_test(test_frames),
        cmocka_unit_test(test_frame_payloads),
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_payloads),
        cmocka_unit_test(test_payload_sizes),
        cmocka_unit_test(test_lists),
        cmocka_unit_test(test_deliver),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
