/*
 * Decoding of records: bytes in, records out. The grammar is one table. A record is lost if it
 * breaks the grammar, or if its sum or crc is wrong. The search for the next good record then
 * starts at the byte after its first.
 */
#include "wire/wire_int.h"

#include <stdlib.h>
#include <string.h>

/* Limits on checking bodies in vain: CRC_FREE bytes, plus CRC_FACTOR per byte skipped. */
#define CRC_FACTOR 64
#define CRC_FREE (64 * (uint64_t)WIRE_FRAG_PIXELS_MAX * WIRE_PIXEL_BYTES)

#define PLAIN_KEPT (2 << 20) /* bytes of memory kept for the next packed record */
#define KIND_MAX 7           /* letters in the name of a record */

enum args { ARGS_NONE, ARGS_KEY, ARGS_FRAME, ARGS_TASK, ARGS_HELLO };

static const struct grammar {
    const char *name;
    enum args args;
    bool body;
} grammar[REC_KINDS] = {
    [REC_FRAME] = {"frame", ARGS_FRAME, false},
    [REC_SCENE] = {"scene", ARGS_NONE, true},
    [REC_GRID] = {"grid", ARGS_NONE, true},
    [REC_SPEC] = {"spec", ARGS_NONE, true},
    [REC_VIEW] = {"view", ARGS_NONE, true},
    [REC_FILES] = {"files", ARGS_NONE, true},
    [REC_TASK] = {"task", ARGS_TASK, false},
    [REC_FLUSH] = {"flush", ARGS_NONE, false},
    [REC_HELLO] = {"hello", ARGS_HELLO, false},
    [REC_FRAG] = {"frag", ARGS_TASK, true},
    [REC_DONE] = {"done", ARGS_KEY, false},
    [REC_FAIL] = {"fail", ARGS_KEY, false},
    [REC_BEAT] = {"beat", ARGS_NONE, false},
    [REC_BYE] = {"bye", ARGS_NONE, false},
    [REC_UP] = {"up", ARGS_NONE, false},
    [REC_GONE] = {"gone", ARGS_NONE, false},
    [REC_CODE] = {"code", ARGS_NONE, false},
    [REC_RING] = {"ring", ARGS_NONE, false},
    [REC_HEIR] = {"heir", ARGS_NONE, false},
    [REC_ASK] = {"ask", ARGS_NONE, false},
    [REC_NONE] = {"none", ARGS_NONE, false},
    [REC_GIVE] = {"give", ARGS_KEY, false},
    [REC_CRASHED] = {"crashed", ARGS_NONE, false},
    [REC_JOINS] = {"joins", ARGS_NONE, false},
    [REC_LEAVE] = {"leave", ARGS_NONE, false},
    [REC_DRAIN] = {"drain", ARGS_NONE, false},
    [REC_ALIVE] = {"alive", ARGS_NONE, false},
};

const char *rec_name(enum rec_kind kind) { return grammar[kind].name; }

size_t rec_size(const struct record *r)
{
    return r->line_len + 1 + (r->has_body ? r->body_len + 1 : 0);
}

/* The kind whose name is the first word of at[0..n), or REC_KINDS. */
static enum rec_kind kind_of(const char *at, size_t n)
{
    for (int k = 0; k < REC_KINDS; k++) {
        if (*at != *grammar[k].name) continue;
        size_t len = strlen(grammar[k].name);
        if (n > len && memcmp(at, grammar[k].name, len) == 0 && (at[len] == ' ' || at[len] == '\n'))
            return (enum rec_kind)k;
    }
    return REC_KINDS;
}

/* A cursor over the words of a line. */
struct words {
    const char *at, *end;
};

static bool next_word(struct words *w, const char **word, size_t *len)
{
    if (w->at >= w->end) return false;
    const char *space = memchr(w->at, ' ', (size_t)(w->end - w->at));
    const char *stop = space ? space : w->end;
    *word = w->at;
    *len = (size_t)(stop - w->at);
    w->at = space ? space + 1 : w->end;
    return *len > 0;
}

static bool decimal(const char *s, size_t n, uint64_t min, uint64_t max, uint64_t *out)
{
    uint64_t v = 0;
    if (!n || n > 19) return false;
    for (size_t i = 0; i < n; i++) {
        if (s[i] < '0' || s[i] > '9') return false;
        v = v * 10 + (uint64_t)(s[i] - '0');
    }
    if (v < min || v > max) return false;
    *out = v;
    return true;
}

static bool next_number(struct words *w, uint64_t min, uint64_t max, uint32_t *out)
{
    const char *word;
    size_t len;
    uint64_t v;
    if (!next_word(w, &word, &len) || !decimal(word, len, min, max, &v)) return false;
    *out = (uint32_t)v;
    return true;
}

static bool parse_frame(struct words *w, struct record *r)
{
    return next_number(w, 0, UINT32_MAX, &r->task.frame) &&
           next_number(w, 1, FRAME_SIDE_MAX, &r->frame_w) &&
           next_number(w, 1, FRAME_SIDE_MAX, &r->frame_h);
}

static bool parse_key(struct words *w, struct record *r)
{
    return next_number(w, 0, UINT32_MAX, &r->task.frame) &&
           next_number(w, 0, UINT32_MAX, &r->task.id);
}

static bool parse_task(struct words *w, struct record *r)
{
    struct lattice *at = &r->task.at;
    return parse_key(w, r) && next_number(w, 0, FRAME_SIDE_MAX, &at->x) &&
           next_number(w, 0, FRAME_SIDE_MAX, &at->y) && next_number(w, 1, UINT32_MAX, &at->w) &&
           next_number(w, 1, FRAME_SIDE_MAX, &at->h) && next_number(w, 1, UINT32_MAX, &at->sx) &&
           next_number(w, 1, FRAME_SIDE_MAX, &at->sy);
}

static bool parse_hello(struct words *w)
{
    const char *word;
    size_t len;
    for (int i = 0; i < 2; i++)
        if (!next_word(w, &word, &len) || memchr(word, '=', len)) return false;
    return true;
}

/* The rest must be key=value. */
static bool keys_valid(struct words w)
{
    while (w.at < w.end) {
        const char *word;
        size_t len;
        if (!next_word(&w, &word, &len) || !memchr(word, '=', len) || *word == '=') return false;
    }
    return w.end == w.at && w.end[-1] != ' ';
}

static bool printable(const char *s, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (s[i] < 0x20 || s[i] > 0x7e) return false;
    return true;
}

static bool has_key(const struct record *r, const char *key)
{
    size_t len;
    return rec_key(r, key, &len) != NULL;
}

static bool parse_body(struct record *r, const struct decoder *d, char why[160])
{
    int64_t n = 0, crc;
    /* The answer to a probe has a body, the probe has none. */
    r->has_body = grammar[r->kind].body || (r->kind == REC_CODE && d->upward);
    if (!r->has_body) return has_key(r, "bytes") ? wire_fail(why, "a body", "none here") : true;
    if (!wire_lengths(r, d, why)) return false;
    if (r->kind == REC_CODE && r->body_len > WIRE_PROBE_MAX)
        return wire_fail(why, "code of another size", "at most 1048576 bytes");
    if (has_key(r, "crc") && !rec_int(r, "crc", 0, UINT32_MAX, &crc))
        return wire_fail(why, "crc out of range", "crc=C in 32 bits");
    if (r->kind != REC_FRAG) return true;
    uint64_t pixels = lattice_count(&r->task.at);
    if (pixels > WIRE_FRAG_PIXELS_MAX || r->body_len != pixels * WIRE_PIXEL_BYTES)
        return wire_fail(why, "frag of another size", "bytes=16*W*H, at most 65536 pixels");
    if (!rec_int(r, "ch", 4, 4, &n)) return wire_fail(why, "frag without ch=4", "RGBA float32");
    if (!has_key(r, "crc")) return wire_fail(why, "frag without crc", "crc=C");
    if (!has_key(r, "job")) return wire_fail(why, "frag without job", "job=HASH");
    return true;
}

static bool parse_line(
    const struct decoder *d, const char *line, size_t len, struct record *r, char why[160])
{
    *r = (struct record){.line = line, .line_len = len, .task.to = -1};
    r->kind = kind_of(line, len + 1);
    if (r->kind == REC_KINDS) return wire_fail(why, "unknown record", "task, frame, frag, ...");
    bool refused = grammar[r->kind].body ? r->kind != REC_FRAG : r->kind == REC_CODE && !d->coded;
    if (d->upward && refused)
        return wire_fail(why, grammar[r->kind].name, "a record that workers send");
    if (!printable(line, len)) return wire_fail(why, "unprintable byte", "a line of ASCII text");
    size_t skip = strlen(grammar[r->kind].name);
    struct words w = {line + (len > skip ? skip + 1 : skip), line + len};
    bool ok = true;
    switch (grammar[r->kind].args) {
    case ARGS_KEY: ok = parse_key(&w, r); break;
    case ARGS_FRAME: ok = parse_frame(&w, r); break;
    case ARGS_TASK: ok = parse_task(&w, r); break;
    case ARGS_HELLO: ok = parse_hello(&w); break;
    case ARGS_NONE: break;
    }
    if (!ok)
        return wire_fail(why, grammar[r->kind].name, "its numbers in range (stormring-task(5))");
    if (!keys_valid(w)) return wire_fail(why, grammar[r->kind].name, "key=value after its numbers");
    int64_t to = -1, peer;
    struct rec_ring ring;
    if (has_key(r, "to") && !rec_int(r, "to", 0, INT32_MAX, &to))
        return wire_fail(why, "no such slot", "to=K in range");
    r->task.to = (int32_t)to;
    if (r->kind == REC_TASK && has_key(r, "peer") &&
        !rec_int(r, "peer", 0, WIRE_SLOTS_MAX - 1, &peer))
        return wire_fail(why, "no such node", "peer=J in range");
    if (r->kind >= REC_RING && r->kind <= REC_CRASHED && !rec_ring(r, &ring))
        return wire_fail(why, grammar[r->kind].name, "its keys in range (stormring-task(5))");
    bool of_slot = r->kind == REC_UP || r->kind == REC_GONE || r->kind == REC_DRAIN;
    if (of_slot && !has_key(r, "w")) return wire_fail(why, grammar[r->kind].name, "w=K");
    double within_s;
    if (r->kind == REC_ALIVE &&
        !rec_real(r, "within", WIRE_WITHIN_LEAST, WIRE_WITHIN_MOST, &within_s))
        return wire_fail(why, "no such time", "within=S in range");
    if (r->kind == REC_LEAVE && r->task.to < 0)
        return wire_fail(why, grammar[r->kind].name, "to=K");
    return parse_body(r, d, why) && wire_check_seal(r, d->upward, why);
}

static bool check_body(struct decoder *d, const struct record *r, char why[160])
{
    int64_t crc;
    if (d->unsummed || !rec_int(r, "crc", 0, UINT32_MAX, &crc)) return true;
    if (wire_crc(r->body, r->body_len) != crc)
        return wire_fail(why, "crc differs", "the bytes that were sent");
    if (r->kind != REC_FRAG || wire_light(r->body, r->body_len)) return true;
    d->extent = d->span;
    return wire_fail(why, "bad pixels", "finite numbers >= 0, and alpha of at most 1");
}

void wire_feed(struct decoder *d, const void *p, size_t n) { buf_append(&d->in, p, n); }

struct decoder wire_over(unsigned char *p, size_t n)
{
    return (struct decoder){.in = {.data = p, .len = n}, .ended = true};
}

void wire_end(struct decoder *d) { d->ended = true; }

void wire_free(struct decoder *d)
{
    buf_free(&d->in);
    buf_free(&d->plain);
    *d = (struct decoder){0};
}

/* Drops bytes up to one where a record may begin. True if there is one. */
static bool seek_record(struct decoder *d)
{
    const char *data = (const char *)buf_data(&d->in);
    size_t n = buf_size(&d->in), o = 0;
    struct record r;
    char why[160];
    bool found = false;
    for (; o < n; o++) {
        size_t left = n - o;
        if (!strchr("abcdfghjlnrstu", data[o]) || !data[o]) continue;
        bool named = kind_of(data + o, left) != REC_KINDS;
        if (!named && left > KIND_MAX) continue;
        size_t span = left < WIRE_LINE_MAX ? left : WIRE_LINE_MAX;
        const char *nl = memchr(data + o, '\n', span);
        if (!nl && left < WIRE_LINE_MAX && !d->ended) break; /* it may be cut off here */
        if (named && nl && parse_line(d, data + o, (size_t)(nl - data) - o, &r, why)) {
            found = true;
            break;
        }
    }
    d->skipped += o;
    buf_consume(&d->in, o);
    return found;
}

/*
 * The record at the front of the buffer is bad. Steps over its first byte, or over all of it if
 * only its pixels are wrong. An attacker can nest heads so that every few bytes need a long crc. A
 * stream that has caused too much of that loses the whole record.
 */
static void lose(struct decoder *d, const struct record *r)
{
    size_t step = d->extent ? d->extent : 1;
    d->extent = 0;
    if (r->body && step == 1) {
        d->checked += r->body_len;
        if (d->checked > CRC_FREE + CRC_FACTOR * d->skipped) step = d->span;
    }
    if (!d->lost) d->bad++;
    d->lost = true;
    d->skipped += step;
    buf_consume(&d->in, step);
}

/* Forgets what has come of the body behind the line in front, of `head` bytes. True if that was the
 * rest: then the line alone is the record. */
static bool drop_body(struct decoder *d, size_t head)
{
    unsigned char *body = d->in.data + d->in.off + head;
    size_t here = buf_size(&d->in) - head, due = d->span - head - d->dropped;
    size_t n = here < due ? here : due;
    memmove(body, body + n, here - n);
    d->in.len -= n;
    d->dropped += n;
    return n == due;
}

/* Decodes the front of the buffer. */
static enum wire_result look(struct decoder *d, struct record *r, char why[160])
{
    const char *line = (const char *)buf_data(&d->in);
    size_t n = buf_size(&d->in);
    *r = (struct record){.line = line};
    if (!n) return WIRE_MORE;
    const char *nl = memchr(line, '\n', n < WIRE_LINE_MAX ? n : WIRE_LINE_MAX);
    if (!nl) {
        if (n < WIRE_LINE_MAX && !d->ended) return WIRE_MORE;
        wire_fail(
            why, "no end of line", d->ended ? "a whole record" : "lines of at most 1024 bytes");
        return WIRE_BAD;
    }
    size_t len = (size_t)(nl - line);
    if (!parse_line(d, line, len, r, why)) return WIRE_BAD;
    d->span = len + 1 + (r->has_body ? r->wire_len + 1 : 0);
    if (d->drops) {
        if (drop_body(d, len + 1)) {
            d->span = len + 1;
            return WIRE_RECORD;
        }
        if (!d->ended) return WIRE_MORE;
        d->drops = false;
        wire_fail(why, "cut off", "bytes=N bytes and a newline");
        return WIRE_BAD;
    }
    if (n < d->span) {
        if (!d->ended) return WIRE_MORE;
        wire_fail(why, "cut off", "bytes=N bytes and a newline");
        return WIRE_BAD;
    }
    if (line[d->span - 1] != '\n') {
        wire_fail(why, "no newline after the body", "bytes=N bytes and a newline (format 4)");
        return WIRE_BAD;
    }
    if (rec_kept(r) && d->room && !d->room(d->room_ctx, r->body_len)) return WIRE_RECORD;
    r->body = (const unsigned char *)nl + 1;
    if (r->wire_len != r->body_len && !wire_unpack(d, r)) {
        if (rec_kept(r)) wire_fail(why, "no body with this hash", "one that was kept");
        else wire_fail(why, "packed body differs", "the bytes that were sent");
        return WIRE_BAD;
    }
    return check_body(d, r, why) ? WIRE_RECORD : WIRE_BAD;
}

enum rec_kind wire_awaited(struct decoder *d, size_t *bytes)
{
    struct record r;
    char why[sizeof d->why];
    bool awaits = !d->lost && look(d, &r, why) == WIRE_MORE && r.body_len && r.kind != REC_FRAG;
    *bytes = awaits ? r.body_len : 0;
    return awaits ? r.kind : REC_KINDS;
}

enum wire_result wire_next(struct decoder *d, struct record *r)
{
    char why[sizeof d->why];
    if (d->consumed) d->drops = false, d->dropped = 0;
    buf_consume(&d->in, d->consumed);
    d->consumed = 0;
    if (d->plain.cap > PLAIN_KEPT) buf_free(&d->plain);
    for (;;) {
        if (d->lost && !seek_record(d)) return WIRE_MORE;
        enum wire_result result = look(d, r, why);
        if (result == WIRE_MORE) return result;
        bool known = d->lost; /* this loss was reported */
        if (result == WIRE_RECORD) {
            d->lost = false;
            d->consumed = d->span;
            return result;
        }
        lose(d, r);
        if (known) continue;
        memcpy(d->why, why, sizeof why);
        return result;
    }
}
