/*
 * Seeded faults in logs: flipped bits, cuts, holes, records that changed places or came again. A
 * picture that is called good afterwards, or when a run has gone on with it, is the same picture.
 * FAULTS=20000 FIRST=SEED make it a campaign; a failing seed is printed as a command.
 */
#include "log/log.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#define W 8
#define H 6
#define FRAMES 3
#define RECORDS_MOST 256

static float shade(uint32_t frame, uint64_t p, int c)
{
    return c == 3 ? 1 : (float)(frame * 1000 + p) + (float)c / 4;
}

static struct buf good;
static size_t at[RECORDS_MOST + 1]; /* where records begin, and the end */
static size_t n_records;

static void put_row(struct buf *b, uint32_t frame, uint32_t y, const char *job)
{
    float rgba[4 * W];
    struct task t = {.frame = frame, .id = y, .at = {0, y, W, 1, 1, 1}, .to = -1};
    for (int i = 0; i < 4 * W; i++) rgba[i] = shade(frame, y * W + (uint32_t)i / 4, i % 4);
    wire_done(b, &t, 5, 6);
    wire_frag(b, &t, &t.at, job, rgba);
}

/* Three pictures by two runs: the first ends within the second picture, the second run early. */
static void make_log(void)
{
    for (int run = 0; run < 2; run++) {
        wire_hello(&good, "fan", "00ff", 1, 0, 2);
        for (uint32_t f = 0; f < FRAMES; f++) {
            char job[24];
            const struct frame_size size = {.frame = f, .w = W, .h = H};
            snprintf(job, sizeof job, "0123456789abcde%u", f);
            wire_job(&good, &size, job, "with=rtworker w=0 host=:");
            wire_job(&good, &size, job, "with=rtworker w=1 host=render1");
            for (uint32_t y = 0; y < H; y++)
                if (run ? (f == 2 && y == 1) || (f == 1 && y > 2) : f == 0 || (f == 1 && y < 4))
                    put_row(&good, f, y, job);
        }
        if (run) wire_bye(&good, "");
    }
    struct decoder d = {.upward = true};
    struct record r;
    size_t end = 0;
    wire_feed(&d, buf_data(&good), buf_size(&good));
    while (wire_next(&d, &r) == WIRE_RECORD && n_records < RECORDS_MOST) {
        at[n_records++] = end;
        end += rec_size(&r);
    }
    at[n_records] = end;
    wire_free(&d);
    assert_int_equal(end, buf_size(&good));
}

static void put_record(struct buf *b, size_t i)
{
    buf_append(b, buf_data(&good) + at[i], at[i + 1] - at[i]);
}

/* The log with one fault of this seed. */
static const char *hurt(struct buf *b, uint64_t seed)
{
    static const char *const kinds[] = {"a flipped bit", "a bit of a number", "two bits", "a cut",
        "a hole", "two records that changed places", "a record that came again"};
    uint64_t kind = rng_u64(seed, 0) % 14, n = buf_size(&good);
    size_t i = rng_u64(seed, 1) % n_records, j = rng_u64(seed, 2) % n_records;
    if (kind > 6) kind = 1;
    if (kind < 5) buf_append(b, buf_data(&good), n);
    uint64_t bits[2] = {rng_u64(seed, 3) % (8 * n), rng_u64(seed, 4) % (8 * n)};
    if (kind == 1) { /* where it hurts: in a frag's place */
        while (*(buf_data(&good) + at[i] + 1) != 'r' || at[i + 1] - at[i] < 4 * W * 4)
            i = (i + 1) % n_records;
        bits[0] = 8 * (at[i] + 9 + rng_u64(seed, 3) % 3) + rng_u64(seed, 4) % 4;
    }
    if (kind < 3) b->data[bits[0] / 8] ^= (unsigned char)(1 << bits[0] % 8);
    if (kind == 2) b->data[bits[1] / 8] ^= (unsigned char)(1 << bits[1] % 8);
    if (kind == 3) b->len = bits[0] / 8;
    if (kind == 4) {
        uint64_t from = bits[0] / 8, most = n - from, some = 1 + rng_u64(seed, 5) % 200;
        if (some > most) some = most;
        memmove(b->data + from, b->data + from + some, n - from - some);
        b->len -= some;
    }
    for (size_t k = 0; kind == 5 && k < n_records; k++) put_record(b, k == i ? j : k == j ? i : k);
    for (size_t k = 0; kind == 6 && k < n_records; k++) {
        put_record(b, k);
        if (k == j) put_record(b, i);
    }
    return kinds[kind];
}

static bool take(struct intake *in, const struct buf *b)
{
    struct decoder d = {.upward = true};
    struct record r;
    char why[160];
    bool ours = true;
    wire_feed(&d, buf_data(b), buf_size(b));
    wire_end(&d);
    for (enum wire_result got; ours && (got = wire_next(&d, &r)) != WIRE_MORE;) {
        if (got != WIRE_RECORD) continue;
        ours = rec_ours(&r, why);
        if (r.kind == REC_FRAME) intake_frame(in, &r);
        else if (ours) intake_record(in, &r);
    }
    wire_free(&d);
    return ours;
}

/* A run that goes on with what is there renders the rows that lack pixels. False: it is refused. */
static bool resume(struct intake *in)
{
    struct buf run = {0};
    wire_hello(&run, "fan", "00ff", 1, 0, 2);
    for (uint32_t k = 0; k < FRAMES; k++) {
        const struct frame_size size = {.frame = k, .w = W, .h = H};
        char job[24];
        snprintf(job, sizeof job, "0123456789abcde%u", k);
        const struct assembly_frame *f = assembly_find(&in->parts, k);
        bool another = f && (f->have.w != W || f->have.h != H || strcmp(f->job, job) != 0);
        struct coverage have = {0};
        wire_job(&run, &size, job, "with=rtworker w=0 host=:");
        if (f && !another) assembly_coverage(f, &have);
        for (uint32_t y = 0; y < H && !another; y++) {
            struct lattice row = {0, y, W, 1, 1, 1};
            if (!have.bits || coverage_trim(&have, &row)) put_row(&run, k, y, job);
        }
        coverage_free(&have);
        if (another) buf_free(&run);
        if (another) return false;
    }
    bool ours = take(in, &run);
    buf_free(&run);
    return ours;
}

/* Is every picture that is called good the right one? */
static void judge(const struct intake *in, uint64_t seed, const char *what)
{
    if (in->parts.differing || intake_orphaned(in)) return; /* status 1 */
    for (uint32_t k = 0; k < in->parts.n_frames; k++) {
        const struct assembly_frame *f = in->parts.frames[k];
        if (!coverage_full(&f->have)) continue; /* likewise */
        bool same = f->number < FRAMES && f->have.w == W && f->have.h == H;
        same = same && f->job[15] == (char)('0' + f->number);
        const struct image_rows rows = assembly_rows(f);
        for (uint64_t i = 0; same && i < (uint64_t)4 * W * H; i++)
            same = rows.row(&rows, (uint32_t)(i / 4 / W))[i % (4 * W)] ==
                   shade(f->number, i / 4, (int)(i % 4));
        if (!same)
            fail_msg("another picture after %s, to repeat: FAULTS=1 FIRST=%" PRIu64
                     " build/unit/test_faults",
                what, seed);
    }
}

static uint64_t number_of(const char *name, uint64_t usual)
{
    int64_t n = (int64_t)usual;
    const char *s = getenv(name);
    if (s && !parse_int(s, 0, INT64_MAX, &n)) fail_msg("%s=%s: expected a number", name, s);
    return (uint64_t)n;
}

static void test_faults(void **state)
{
    (void)state;
    uint64_t first = number_of("FIRST", 1), end = first + number_of("FAULTS", 2000);
    make_log();
    for (uint64_t seed = first; seed < end; seed++) {
        struct buf b = {0};
        buf_append(&b, buf_data(&good), buf_size(&good)); /* hurt looks for lines in it */
        b.len = 0;
        const char *what = hurt(&b, seed);
        struct intake in;
        intake_init(&in, true);
        bool taken = take(&in, &b) && (seed % 2 || resume(&in));
        if (taken || seed % 2) judge(&in, seed, what); /* else status 2 */
        intake_free(&in);
        buf_free(&b);
    }
    buf_free(&good);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_faults)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
