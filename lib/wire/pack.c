/* Packing of records. */
#include "coder/coder.h"
#include "wire/wire_int.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define KEYS_MAX 48 /* bytes that a packed record's line may have more than a plain one's */

bool wire_pack(struct buf *to, const struct record *r)
{
    struct buf body = {0};
    char text[64];
    size_t n;
    if (!r->body_len || r->line_len + KEYS_MAX > WIRE_LINE_MAX) return false;
    if (rec_key(r, "plain", &n) || rec_key(r, "words", &n)) return false; /* of another meaning */
    enum coder_form form = r->kind == REC_FRAG ? CODER_PIXELS : coder_form_of(r->body, r->body_len);
    bool packed = coder_pack(&body, form, r->body, r->body_len);
    if (packed) {
        snprintf(text, sizeof text, "bytes=%zu plain=%zu%s", buf_size(&body), r->body_len,
            form == CODER_WORDS ? " words=4" : "");
        wire_put_line(to, r, text);
        wire_put_body(to, buf_data(&body), buf_size(&body));
    }
    buf_free(&body);
    return packed;
}

void wire_pack_last(struct buf *b, size_t at)
{
    struct decoder d = {.in = *b, .unsummed = true, .ended = true};
    struct record r;
    struct buf packed = {0};
    if (memcmp(buf_data(b) + at, "frag ", 5) != 0) return;
    d.in.off += at;
    if (wire_next(&d, &r) == WIRE_RECORD && wire_pack(&packed, &r)) {
        b->len = b->off + at;
        buf_append(b, buf_data(&packed), buf_size(&packed));
    }
    buf_free(&packed);
}

void wire_keep(struct buf *to, const struct record *r, const char *sha256)
{
    char text[SHA256_TEXT + 40];
    snprintf(text, sizeof text, "bytes=%zu kept=%s", r->body_len, sha256);
    wire_put_line(to, r, text);
    wire_put_body(to, "", 0);
}

void wire_probe(struct buf *b, size_t n, const char *extra)
{
    unsigned char *body = xmalloc(n ? n : 1, 1);
    for (size_t i = 0; i < n; i++) body[i] = (unsigned char)rng_u64(n, i);
    const size_t at = buf_size(b);
    buf_printf(b, "code crc=%" PRIu32 " bytes=%zu", wire_crc(body, n), n);
    if (extra && *extra) buf_printf(b, " %s", extra);
    wire_seal(b, at);
    wire_put_body(b, body, n);
    free(body);
}
