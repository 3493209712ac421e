/*
 * blocks: the numbers of VTK's XML files. "VTK XML Formats", Kitware.
 *
 * A head of integers comes first. Unpacked: the number of bytes. Packed: the number of blocks, the
 * bytes of a block, those of the last one if it is shorter (or 0), and the packed bytes of each. In
 * base64 the head may end in padding, and the numbers begin a new group of four characters.
 */
#include "voxel/voxel_int.h"

#include <stdlib.h>
#include <string.h>

#define BLOCKS_MAX (UINT64_C(1) << 32)
#define BLOCK_MAX (UINT64_C(1) << 32) /* bytes */

static int digit(unsigned char c)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) : -1;
}

/* Appends at most `most` bytes and the rest of a group of four characters. Other characters end it;
 * blanks are passed over. */
static void decode_base64(const unsigned char *p, size_t n, uint64_t most, struct buf *out)
{
    uint32_t bits = 0;
    int have = 0, pads = 0;
    for (size_t i = 0; i < n && buf_size(out) < most; i++) {
        const int d = digit(p[i]);
        if (d < 0 && p[i] != '=') {
            if (!strchr(" \t\r\n", p[i]) || !p[i]) return;
            continue;
        }
        if (d >= 0 && pads) return;
        pads += d < 0;
        bits = bits << 6 | (d < 0 ? 0 : (uint32_t)d);
        if (++have < 4) continue;
        const unsigned char three[3] = {
            (unsigned char)(bits >> 16), (unsigned char)(bits >> 8), (unsigned char)bits};
        if (pads > 2) return;
        buf_append(out, three, (size_t)(3 - pads));
        bits = 0;
        have = pads = 0;
    }
}

/* The bytes of a source: as they are in the file, or out of base64. */
struct bytes {
    const struct voxel_source *s;
    const unsigned char *p;
    size_t n;
    struct buf own;
};

/* At least `most` bytes, or all. */
static void decode(struct bytes *b, uint64_t most)
{
    const struct voxel_source *s = b->s;
    if (!s->base64) {
        b->p = s->p, b->n = s->n;
        return;
    }
    buf_free(&b->own);
    decode_base64(s->p, s->n, most, &b->own);
    b->p = buf_data(&b->own), b->n = buf_size(&b->own);
}

/* Integer i of the head. */
static uint64_t head(const struct bytes *b, uint64_t i)
{
    const struct voxel_source *s = b->s;
    uint64_t u = 0;
    const unsigned char *p = b->p + i * s->word;
    for (int k = 0; k < s->word; k++) u |= (uint64_t)p[s->big ? s->word - 1 - k : k] << 8 * k;
    return u;
}

static bool fail_short(struct voxel *v)
{
    return voxel_fail(v, "the values of an array end before their time, or are no base64, expected "
                         "as many as its head announces");
}

static bool unpacked(struct voxel *v, struct bytes *b, uint64_t want, struct buf *out)
{
    const uint64_t word = b->s->word;
    decode(b, word);
    if (b->n < word) return fail_short(v);
    if (head(b, 0) != want)
        return voxel_fail(v, "an array of %llu bytes, expected %llu",
            (unsigned long long)head(b, 0), (unsigned long long)want);
    decode(b, word + want);
    if (b->n - word < want) return fail_short(v);
    buf_append(out, b->p + word, (size_t)want);
    return true;
}

/* Unpacks the blocks; the head is complete. */
static bool inflate_blocks(struct voxel *v, struct bytes *b, uint64_t want, struct buf *out)
{
    const uint64_t blocks = head(b, 0), size = head(b, 1), last = head(b, 2);
    uint64_t at = (3 + blocks) * b->s->word, sum = 0;
    for (uint64_t i = 0; i < blocks; i++) {
        const uint64_t packed = head(b, 3 + i);
        if (packed > b->s->n || sum + packed > b->s->n) return fail_short(v);
        sum += packed;
    }
    struct buf heads = b->own;
    const unsigned char *sizes = b->p;
    b->own = (struct buf){.data = NULL};
    decode(b, at + sum);
    bool good = b->n - at >= sum || fail_short(v);
    for (uint64_t i = 0; good && i < blocks; i++) {
        struct bytes h = {.s = b->s, .p = sizes};
        const uint64_t packed = head(&h, 3 + i), whole = i + 1 == blocks && last ? last : size;
        good = voxel_inflate(b->p + at, (size_t)packed, 0, whole, out) == whole ||
               voxel_fail(v, "block %llu of an array cannot be unpacked, expected %llu bytes",
                   (unsigned long long)i + 1, (unsigned long long)whole);
        at += packed;
    }
    buf_free(&heads);
    return good && (buf_size(out) >= want || fail_short(v));
}

static bool packed(struct voxel *v, struct bytes *b, uint64_t want, struct buf *out)
{
    const uint64_t word = b->s->word;
    decode(b, 3 * word);
    if (b->n < 3 * word) return fail_short(v);
    const uint64_t blocks = head(b, 0), size = head(b, 1), last = head(b, 2);
    /* The bounds keep the product below 2^64. */
    if (!blocks || blocks >= BLOCKS_MAX || size >= BLOCK_MAX || last > size ||
        blocks * size - (last ? size - last : 0) != want)
        return voxel_fail(v, "%llu blocks of %llu bytes, expected %llu bytes",
            (unsigned long long)blocks, (unsigned long long)size, (unsigned long long)want);
    if (blocks > b->s->n / word) return fail_short(v);
    decode(b, (3 + blocks) * word);
    return b->n < (3 + blocks) * word ? fail_short(v) : inflate_blocks(v, b, want, out);
}

bool voxel_blocks(struct voxel *v, const struct voxel_source *s, uint64_t want, struct buf *out)
{
    struct bytes b = {.s = s};
    const bool good = s->packed ? packed(v, &b, want, out) : unpacked(v, &b, want, out);
    buf_free(&b.own);
    return good;
}
