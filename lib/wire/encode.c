/* Encoding of records: each function appends one to a buffer. */
#include "coder/coder.h"
#include "wire/wire_int.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static void put_extra(struct buf *b, const char *extra)
{
    if (!extra || !*extra) return;
    buf_append(b, " ", 1);
    buf_append(b, extra, strlen(extra));
}

void wire_put_body(struct buf *b, const void *body, size_t n)
{
    buf_append(b, body, n);
    buf_append(b, "\n", 1);
}

/* All that follows the line of r. */
static void put_rest(struct buf *b, const struct record *r)
{
    if (r->has_body) wire_put_body(b, r->body, r->body_len);
}

void wire_frame(struct buf *b, uint32_t frame, uint32_t w, uint32_t h, const char *extra)
{
    buf_printf(b, "frame %" PRIu32 " %" PRIu32 " %" PRIu32, frame, w, h);
    put_extra(b, extra);
    buf_append(b, "\n", 1);
}

void wire_job(struct buf *b, const struct frame_size *f, const char *job, const char *extra)
{
    size_t at = buf_size(b);
    buf_printf(b, "frame %" PRIu32 " %" PRIu32 " %" PRIu32 " job=%s", f->frame, f->w, f->h, job);
    put_extra(b, extra);
    wire_seal(b, at);
}

void wire_hello(
    struct buf *b, const char *program, const char *selftest, double power, double least, int slots)
{
    size_t at = buf_size(b);
    buf_printf(b, "hello %s %s format=%d selftest=%s power=%.6g", program, STORMRING_VERSION,
        WIRE_FORMAT, selftest, power);
    if (least > 0) buf_printf(b, " least=%.6g", least);
    buf_printf(b, " slots=%d alive=1%s", slots, coder_there() ? " zstd=1" : "");
    wire_seal(b, at);
}

void wire_state(struct buf *b, enum rec_kind kind, const void *body, size_t n)
{
    buf_printf(b, "%s crc=%" PRIu32 " bytes=%zu\n", rec_name(kind), wire_crc(body, n), n);
    wire_put_body(b, body, n);
}

/* Hot for small tasks: printf would cost more than the rest of the record. */
static char *put_u32(char *at, uint32_t v)
{
    char digits[10];
    int n = 0;
    do digits[n++] = (char)('0' + v % 10);
    while (v /= 10);
    *at++ = ' ';
    while (n) *at++ = digits[--n];
    return at;
}

static void put_lattice(
    struct buf *b, const char *name, const struct task *t, const struct lattice *l)
{
    char text[128], *at = text;
    size_t n = strlen(name);
    memcpy(at, name, n);
    at += n;
    const uint32_t v[8] = {t->frame, t->id, l->x, l->y, l->w, l->h, l->sx, l->sy};
    for (int i = 0; i < 8; i++) at = put_u32(at, v[i]);
    buf_append(b, text, (size_t)(at - text));
}

void wire_task(struct buf *b, const struct task *t)
{
    put_lattice(b, "task", t, &t->at);
    if (t->to >= 0) buf_printf(b, " to=%" PRId32 "\n", t->to);
    else buf_append(b, "\n", 1);
}

void wire_give(struct buf *b, const struct task *t, const char *extra)
{
    size_t at = buf_size(b);
    put_lattice(b, "task", t, &t->at);
    if (t->to >= 0) buf_printf(b, " to=%" PRId32, t->to);
    put_extra(b, extra);
    wire_seal(b, at);
}

void wire_frag(struct buf *b, const struct task *t, const struct lattice *at, const char *job,
    const float *rgba)
{
    size_t n = (size_t)lattice_count(at) * 4, line = buf_size(b);
    put_lattice(b, "frag", t, at);
    /* The body comes first, because the line needs its crc. */
    size_t bytes = n * 4;
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    const float *body = rgba;
#else
    unsigned char *body = xmalloc(bytes, 1);
    for (size_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, rgba + i, 4);
        for (int k = 0; k < 4; k++) body[4 * i + (size_t)k] = (unsigned char)(bits >> (8 * k));
    }
#endif
    buf_printf(b, " job=%s ch=4 crc=%" PRIu32 " bytes=%zu", job, wire_crc(body, bytes), bytes);
    wire_seal(b, line);
    wire_put_body(b, body, bytes);
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
    free(body);
#endif
}

void wire_done(struct buf *b, const struct task *t, int64_t cpu_us_used, int64_t wall_us)
{
    size_t at = buf_size(b);
    buf_printf(b, "done %" PRIu32 " %" PRIu32 " cpu_us=%" PRId64 " wall_us=%" PRId64, t->frame,
        t->id, cpu_us_used, wall_us);
    wire_seal(b, at);
}

void wire_said(struct buf *b, const char *said)
{
    size_t n = strlen(said);
    if (n > WIRE_SAID - 1) n = WIRE_SAID - 1;
    if (n) buf_printf(b, " said=");
    for (size_t i = 0; i < n; i++) {
        unsigned char c = (unsigned char)said[i];
        buf_printf(b, c > ' ' && c < 127 && c != '%' ? "%c" : "%%%02X", c);
    }
}

void wire_failed(
    struct buf *b, const struct task *t, const char *why, const char *said, const char *extra)
{
    size_t at = buf_size(b);
    buf_printf(b, "fail %" PRIu32 " %" PRIu32 " why=%s", t->frame, t->id, why);
    wire_said(b, said);
    put_extra(b, extra);
    wire_seal(b, at);
}

void wire_plain(struct buf *b, enum rec_kind kind, const char *extra)
{
    size_t at = buf_size(b);
    buf_printf(b, "%s", rec_name(kind));
    put_extra(b, extra);
    wire_seal(b, at);
}

void wire_bye(struct buf *b, const char *why)
{
    char text[64];
    snprintf(text, sizeof text, "why=%s", why);
    wire_plain(b, REC_BYE, *why ? text : NULL);
}

static bool dropped(const char *const *drop, const char *word, size_t len)
{
    for (; drop && *drop; drop++) {
        size_t n = strlen(*drop);
        if (len > n && word[n] == '=' && memcmp(word, *drop, n) == 0) return true;
    }
    return false;
}

void wire_forward(struct buf *b, const struct record *r, const char *const *drop, const char *extra)
{
    const char *at = r->line, *end = r->line + r->line_len;
    size_t begin = buf_size(b);
    if (rec_sealed(r)) end -= WIRE_SEAL_BYTES;
    while (at < end) {
        const char *space = memchr(at, ' ', (size_t)(end - at));
        size_t len = (size_t)((space ? space : end) - at);
        if (!dropped(drop, at, len)) {
            if (at != r->line) buf_append(b, " ", 1);
            buf_append(b, at, len);
        }
        at += len + 1;
    }
    put_extra(b, extra);
    wire_seal(b, begin);
    put_rest(b, r);
}

void wire_copy(struct buf *b, const struct record *r)
{
    buf_append(b, r->line, r->line_len);
    buf_append(b, "\n", 1);
    put_rest(b, r);
}

void wire_ring(struct buf *b, enum rec_kind kind, const struct task *t, const struct rec_ring *m)
{
    bool none = kind == REC_NONE;
    size_t at = buf_size(b);
    buf_printf(b, "%s", rec_name(kind));
    if (kind == REC_GIVE) buf_printf(b, " %" PRIu32 " %" PRIu32, t->frame, t->id);
    if (kind == REC_RING)
        buf_printf(b, " me=%" PRId32 " n=%" PRId32 " rules=%s", m->me, m->n,
            m->published ? "published" : "default");
    else if (m->peer >= 0) buf_printf(b, " peer=%" PRId32, m->peer);
    if (kind == REC_ASK && m->takes > 0) buf_printf(b, " takes=%" PRId32, m->takes);
    if (none && m->idle) buf_printf(b, " idle=%d", m->idle);
    if ((none || kind == REC_HEIR) && m->next >= 0) buf_printf(b, " next=%" PRId32, m->next);
    if (t->to >= 0) buf_printf(b, " to=%" PRId32, t->to);
    wire_seal(b, at);
}
