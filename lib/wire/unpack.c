/*
 * Packed records: the same record with fewer bytes on the wire. Its line is that of the plain
 * record, except that bytes=N is the length of the packed body and plain=N that of the plain one.
 * The crc stays that of the plain body, so damage is found, even if it can be unpacked.
 *
 * A kept record is one of state without its body: kept=HASH names it, bytes=N is its length, and
 * its reader has it.
 */
#include "coder/coder.h"
#include "wire/wire_int.h"

#include <string.h>

static bool begins(const char *word, size_t len, const char *key)
{
    size_t n = strlen(key);
    return len >= n && memcmp(word, key, n) == 0;
}

void wire_put_line(struct buf *b, const struct record *r, const char *text)
{
    const char *at = r->line, *end = r->line + r->line_len;
    const size_t begin = buf_size(b);
    const bool sealed = rec_sealed(r);
    bool put = false;
    if (sealed) end -= WIRE_SEAL_BYTES;
    for (size_t len; at < end; at += len + 1) {
        const char *space = memchr(at, ' ', (size_t)(end - at));
        len = (size_t)((space ? space : end) - at);
        if (begins(at, len, "plain=") || begins(at, len, "words=")) continue;
        if (begins(at, len, "kept=")) continue;
        const bool bytes = begins(at, len, "bytes=");
        if (at != r->line) buf_append(b, " ", 1);
        buf_append(b, bytes && !put ? text : at, bytes && !put ? strlen(text) : len);
        put |= bytes;
    }
    if (sealed) wire_seal(b, begin);
    else buf_append(b, "\n", 1);
}

bool wire_fail(char why[WIRE_WHY], const char *what, const char *expected)
{
    snprintf(why, WIRE_WHY, "%s, expected %s", what, expected);
    return false;
}

bool rec_kept(const struct record *r) { return r->body_len && !r->wire_len; }

bool wire_lengths(struct record *r, const struct decoder *d, char why[WIRE_WHY])
{
    int64_t n, plain, words;
    size_t len;
    if (!rec_int(r, "bytes", 0, WIRE_STATE_MAX, &n))
        return wire_fail(why, "no body", "bytes=N in range");
    r->body_len = r->wire_len = (size_t)n;
    if (rec_key(r, "kept", &len)) {
        if (!d->kept || !n || r->kind == REC_FRAG || r->kind == REC_CODE)
            return wire_fail(why, "a hash for a body", "bodies here");
        r->wire_len = 0;
        return rec_key(r, "crc", &len) ? true : wire_fail(why, "kept body without crc", "crc=C");
    }
    if (!rec_key(r, "plain", &len)) return true;
    if (!d->coded) return wire_fail(why, "packed body", "plain ones here");
    if (!rec_int(r, "plain", n + 1, n * CODER_RATIO_MAX, &plain) || plain > WIRE_STATE_MAX)
        return wire_fail(why, "packed body of another size", "plain=N, above bytes=N, in range");
    if (rec_key(r, "words", &len) && (r->kind == REC_FRAG || !rec_int(r, "words", 4, 4, &words)))
        return wire_fail(why, "words out of range", "words=4, in state");
    r->body_len = (size_t)plain;
    return rec_key(r, "crc", &len) ? true : wire_fail(why, "packed body without crc", "crc=C");
}

unsigned char *wire_body(struct decoder *d, const struct record *r)
{
    unsigned char *data = r->wire_len == r->body_len ? d->in.data : d->plain.data;
    return data + (r->body - data);
}

bool wire_unpack(struct decoder *d, struct record *r)
{
    char text[32], hash[SHA256_TEXT];
    struct buf *to = &d->plain;
    int64_t words;
    const bool kept = rec_kept(r);
    if (kept && !rec_str(r, "kept", hash, sizeof hash)) return false;
    enum coder_form form = r->kind == REC_FRAG                 ? CODER_PIXELS
                           : rec_int(r, "words", 4, 4, &words) ? CODER_WORDS
                                                               : CODER_BYTES;
    snprintf(text, sizeof text, "bytes=%zu", r->body_len);
    buf_consume(to, buf_size(to));
    wire_put_line(to, r, text);
    const size_t line = buf_size(to);
    if (kept) {
        if (!d->kept(hash, r->body_len, to)) return false;
        buf_append(to, "\n", 1);
    } else {
        unsigned char *body = buf_reserve(to, r->body_len + 1);
        if (!coder_unpack(body, r->body_len, form, r->body, r->wire_len)) return false;
        body[r->body_len] = '\n';
        to->len += r->body_len + 1;
    }
    r->line = (const char *)buf_data(to);
    r->line_len = line - 1;
    r->body = buf_data(to) + line;
    return true;
}
