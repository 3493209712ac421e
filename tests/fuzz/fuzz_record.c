/*
 * Whatever the bytes and however they are cut up: the decoder hands out the same records, every
 * byte belongs to a record or was counted as skipped, what it accepts is in range, and a record
 * passed on is read again as it was. The first two bytes of an input say how it is fed; see `make
 * fuzz`.
 */
#include "mend.h"
#include "wire/wire.h"

#include <stdlib.h>
#include <string.h>

/* ---- one input -------------------------------------------------------------------------- */

static void check_frag(const struct record *r)
{
    const struct lattice *at = &r->task.at;
    MUST(lattice_count(at) >= 1 && lattice_count(at) <= WIRE_FRAG_PIXELS_MAX);
    MUST(r->body_len == lattice_count(at) * WIRE_PIXEL_BYTES);
    float *rgba = xmalloc(r->body_len, 1);
    rec_pixels(r, rgba);
    struct buf b = {0};
    wire_frag(&b, &r->task, at, "0", rgba);
    const unsigned char *end = buf_data(&b) + buf_size(&b);
    MUST(memcmp(end - 1 - r->body_len, r->body, r->body_len) == 0 && end[-1] == '\n');
    buf_free(&b);
    free(rgba);
}

static void check_forward(const struct record *r, bool upward)
{
    struct buf b = {0};
    struct decoder d = {.upward = upward, .coded = r->kind == REC_CODE};
    struct record again;
    static const char *const drop[] = {"w", NULL};
    wire_forward(&b, r, drop, "w=12.3");
    wire_feed(&d, buf_data(&b), buf_size(&b));
    wire_end(&d);
    if (r->line_len + sizeof " w=12.3" + WIRE_SEAL_BYTES > WIRE_LINE_MAX) {
        wire_next(&d, &again);
    } else {
        char w[8];
        MUST(wire_next(&d, &again) == WIRE_RECORD);
        MUST(again.kind == r->kind && again.body_len == r->body_len);
        MUST(memcmp(again.body, r->body, r->body_len) == 0);
        MUST(memcmp(&again.task, &r->task, sizeof r->task) == 0);
        MUST(again.frame_w == r->frame_w && again.frame_h == r->frame_h);
        MUST(rec_str(&again, "w", w, sizeof w) && strcmp(w, "12.3") == 0);
        MUST(wire_next(&d, &again) == WIRE_MORE && d.bad == 0);
    }
    buf_free(&b);
    wire_free(&d);
}

/* Whatever can be packed comes out as it was, with its line. */
static void check_packed(const struct record *r, bool upward)
{
    struct buf b = {0};
    struct decoder d = {.upward = upward, .coded = true};
    struct record again;
    size_t n;
    if (rec_key(r, "crc", &n) && wire_pack(&b, r)) {
        MUST(buf_size(&b) < rec_size(r) + sizeof " plain=2147483647 words=4");
        wire_feed(&d, buf_data(&b), buf_size(&b));
        wire_end(&d);
        MUST(wire_next(&d, &again) == WIRE_RECORD);
        MUST(again.line_len == r->line_len && !memcmp(again.line, r->line, r->line_len));
        MUST(again.body_len == r->body_len && !memcmp(again.body, r->body, r->body_len));
        MUST(wire_next(&d, &again) == WIRE_MORE && d.bad == 0);
    }
    buf_free(&b);
    wire_free(&d);
}

static void check_ring(const struct record *r)
{
    struct rec_ring m, same;
    struct buf b = {0};
    struct decoder d = {0};
    struct record again;
    MUST(rec_ring(r, &m));
    MUST(m.peer < WIRE_SLOTS_MAX && m.next < WIRE_SLOTS_MAX && m.n <= WIRE_SLOTS_MAX);
    MUST(r->kind != REC_RING || (m.me >= 0 && m.me < m.n));
    MUST(r->kind == REC_RING || r->kind == REC_ASK || m.peer >= 0);
    wire_ring(&b, r->kind, &r->task, &m);
    wire_feed(&d, buf_data(&b), buf_size(&b));
    MUST(wire_next(&d, &again) == WIRE_RECORD && again.kind == r->kind && rec_ring(&again, &same));
    MUST(memcmp(&again.task, &r->task, sizeof r->task) == 0);
    MUST(r->kind == REC_RING || same.peer == m.peer);
    buf_free(&b);
    wire_free(&d);
}

/* A record about a slot names it, and alive has a time in range. */
static void check_slots(const struct record *r)
{
    double within_s = 0;
    if (r->kind == REC_UP || r->kind == REC_GONE || r->kind == REC_DRAIN) {
        size_t n;
        MUST(rec_key(r, "w", &n));
    }
    if (r->kind == REC_LEAVE) MUST(r->task.to >= 0);
    if (r->kind == REC_ALIVE)
        MUST(rec_real(r, "within", WIRE_WITHIN_LEAST, WIRE_WITHIN_MOST, &within_s));
}

static void check_record(const struct record *r, bool upward)
{
    MUST(r->kind < REC_KINDS && r->line_len < WIRE_LINE_MAX);
    MUST(strncmp(r->line, rec_name(r->kind), strlen(rec_name(r->kind))) == 0);
    MUST(r->task.to >= -1);
    if (upward)
        MUST(r->kind != REC_SCENE && r->kind != REC_GRID && r->kind != REC_SPEC &&
             r->kind != REC_VIEW && r->kind != REC_FILES);
    if (r->kind == REC_FRAME)
        MUST(r->frame_w - 1 < FRAME_SIDE_MAX && r->frame_h - 1 < FRAME_SIDE_MAX);
    if (r->kind == REC_FRAG) check_frag(r);
    if (r->kind >= REC_RING && r->kind <= REC_CRASHED) check_ring(r);
    check_slots(r);
    check_packed(r, upward);
    check_forward(r, upward);
}

struct tally {
    uint64_t records, bytes, bad, hash;
};

static void drain(struct decoder *d, struct tally *t, bool check)
{
    struct record r;
    for (enum wire_result got; (got = wire_next(d, &r)) != WIRE_MORE;) {
        if (got == WIRE_BAD) {
            MUST(strstr(d->why, ", expected "));
            t->bad++;
            continue;
        }
        if (check) check_record(&r, d->upward);
        t->records++;
        t->bytes += d->span;
        MUST(d->span == rec_size(&r) || d->coded);
        t->hash = hash64(hash64(t->hash, r.line, r.line_len), r.body, r.body_len);
    }
}

/* Pieces of at most `most` bytes, 0: all at once. */
static struct tally decode(const uint8_t *data, size_t size, size_t most, uint8_t how, bool check)
{
    struct decoder d = {.upward = how & 1, .coded = how & 2};
    struct tally t = {.hash = HASH64_INIT};
    for (size_t at = 0, k = 0; at < size; k++) {
        size_t some = most ? 1 + rng_u64(most, k) % most : size;
        if (some > size - at) some = size - at;
        wire_feed(&d, data + at, some);
        drain(&d, &t, check);
        at += some;
    }
    wire_end(&d);
    drain(&d, &t, check);
    MUST(buf_size(&d.in) == 0);
    MUST(t.bytes + d.skipped == size && t.bad == d.bad);
    wire_free(&d);
    return t;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < 2) return 0;
    size_t most = (size_t)1 + data[1];
    struct tally whole = decode(data + 2, size - 2, 0, data[0], true);
    struct tally pieces = decode(data + 2, size - 2, most, data[0], false);
    MUST(whole.records == pieces.records && whole.hash == pieces.hash && whole.bad == pieces.bad);
    return 0;
}
