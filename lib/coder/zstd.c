/* Packing with libzstd. */
#include "coder/coder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#define LEVEL 1
#define SAMPLE_BYTES (256 << 10)
#define WORDS_WORTH .95 /* words are worth it if they have at most this share of the bytes */
#define SPEED_PIXELS (32 << 10)

bool coder_there(void) { return true; }

/* Made when first needed, and kept: a context takes more time to make than a small body to pack. */
static ZSTD_CCtx *packer(void)
{
    static _Thread_local ZSTD_CCtx *c;
    if (!c) c = ZSTD_createCCtx();
    if (!c) die(ST_SYSTEM, "out of memory");
    return c;
}

static ZSTD_DCtx *unpacker(void)
{
    static _Thread_local ZSTD_DCtx *c;
    if (!c) c = ZSTD_createDCtx();
    if (!c) die(ST_SYSTEM, "out of memory");
    return c;
}

/* Room for the arrangement of a block. */
static unsigned char *scratch(void)
{
    static _Thread_local unsigned char *block;
    if (!block) block = xmalloc(CODER_BLOCK, 1);
    return block;
}

bool coder_pack(struct buf *b, enum coder_form form, const unsigned char *p, size_t n)
{
    ZSTD_CCtx *c = packer();
    unsigned char *block = scratch();
    const size_t before = buf_size(b);
    ZSTD_CCtx_reset(c, ZSTD_reset_session_only);
    ZSTD_CCtx_setParameter(c, ZSTD_c_compressionLevel, LEVEL);
    ZSTD_CCtx_setPledgedSrcSize(c, n);
    bool good = n > 0;
    for (size_t at = 0, step; good && at < n; at += step) {
        step = n - at < CODER_BLOCK ? n - at : CODER_BLOCK;
        coder_arrange(block, form, p + at, step);
        ZSTD_inBuffer in = {block, step, 0};
        const ZSTD_EndDirective end = at + step == n ? ZSTD_e_end : ZSTD_e_continue;
        size_t left = 1;
        while (good && (in.pos < in.size || (end == ZSTD_e_end && left))) {
            size_t room = ZSTD_compressBound(step);
            ZSTD_outBuffer out = {buf_reserve(b, room), room, 0};
            left = ZSTD_compressStream2(c, &out, &in, end);
            b->len += out.pos;
            good = !ZSTD_isError(left) && buf_size(b) - before < n;
        }
    }
    good = good && (buf_size(b) - before) * CODER_RATIO_MAX >= n;
    if (!good) b->len = b->off + before;
    return good;
}

bool coder_unpack(
    unsigned char *out, size_t plain, enum coder_form form, const unsigned char *p, size_t n)
{
    if (plain / CODER_RATIO_MAX > n || n >= plain) return false;
    size_t got = ZSTD_decompressDCtx(unpacker(), out, plain, p, n);
    if (ZSTD_isError(got) || got != plain) return false;
    for (size_t at = 0, step; form != CODER_BYTES && at < plain; at += step) {
        unsigned char *block = scratch();
        step = plain - at < CODER_BLOCK ? plain - at : CODER_BLOCK;
        memcpy(block, out + at, step);
        coder_restore(out + at, form, block, step);
    }
    return true;
}

enum coder_form coder_form_of(const unsigned char *p, size_t n)
{
    size_t sample = n < SAMPLE_BYTES ? n : SAMPLE_BYTES, size[2];
    p += (n - sample) / 2 / 4 * 4;
    for (int words = 0; words < 2; words++) {
        struct buf b = {0};
        bool packed = coder_pack(&b, words ? CODER_WORDS : CODER_BYTES, p, sample);
        size[words] = packed ? buf_size(&b) : sample;
        buf_free(&b);
    }
    return (double)size[1] < WORDS_WORTH * (double)size[0] ? CODER_WORDS : CODER_BYTES;
}

double coder_speed(void)
{
    float *rgba = xmalloc((size_t)SPEED_PIXELS * 4, sizeof *rgba);
    struct buf b = {0};
    for (int i = 0; i < 4 * SPEED_PIXELS; i++) /* smooth light, with noise */
        rgba[i] = i % 4 == 3 ? 1 : (float)(sin(i * .001) + 1.1 + .01 * rng_unit(1, (uint64_t)i));
    const size_t n = (size_t)SPEED_PIXELS * CODER_PIXEL_BYTES;
    int64_t begin_us = now_us();
    coder_pack(&b, CODER_PIXELS, (const unsigned char *)rgba, n);
    int64_t us = now_us() - begin_us;
    free(rgba);
    buf_free(&b);
    return (double)n / (double)(us > 0 ? us : 1);
}
