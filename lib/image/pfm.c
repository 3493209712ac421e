/*
 * pfm: portable float maps (P. Debevec, "HDRI and image-based lighting", SIGGRAPH course, 2003):
 * "PF" colour or "Pf" grey, bottom row first. The sign of the third number gives the byte order;
 * its magnitude is ignored.
 */
#include "image/codecs.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static float float_of(const unsigned char *p, bool little)
{
    uint32_t u = 0;
    for (int i = 0; i < 4; i++) u = u << 8 | p[little ? 3 - i : i];
    float x;
    memcpy(&x, &u, sizeof x);
    return x;
}

static void float_put(unsigned char *p, float x)
{
    uint32_t u;
    memcpy(&u, &x, sizeof u);
    for (int i = 0; i < 4; i++) p[i] = (unsigned char)(u >> (8 * i));
}

/* Reads the next word of the header, cut at size. Moves *at past it and one blank. */
static bool word(const unsigned char *p, size_t n, size_t *at, char *out, size_t size)
{
    size_t k = 0;
    while (*at < n && strchr(" \t\r\n", p[*at]) && p[*at]) ++*at;
    while (*at < n && k + 1 < size && p[*at] > ' ') out[k++] = (char)p[(*at)++];
    out[k] = '\0';
    return k > 0 && *at < n && strchr(" \t\r\n", p[(*at)++]);
}

int pfm_decode(const unsigned char *p, size_t n, const struct image_part *part, struct image *im,
    char err[IMAGE_ERR])
{
    char w[24], h[24], scale[64];
    int64_t width, height;
    double order = 0;
    size_t at = 2, floats = p[1] == 'F' ? 3 : 1;
    if (!word(p, n, &at, w, sizeof w) || !word(p, n, &at, h, sizeof h) ||
        !word(p, n, &at, scale, sizeof scale) || !parse_int(w, 1, FRAME_SIDE_MAX, &width) ||
        !parse_int(h, 1, FRAME_SIDE_MAX, &height) || !parse_real(scale, -1e30, 1e30, &order) ||
        order == 0)
        return image_fail(err,
            "damaged PFM header, expected sides from 1 to %d and a scale that is not 0",
            FRAME_SIDE_MAX);
    if (!image_size_ok((uint64_t)width, (uint64_t)height, err)) return -1;
    size_t pixels = (size_t)(width * height);
    if (n - at != pixels * floats * 4)
        return image_fail(err, "%zu bytes of pixels, expected %zu", n - at, pixels * floats * 4);
    image_init(im, (uint32_t)width, (uint32_t)height);
    for (size_t i = 0; i < pixels; i++) {
        size_t y = (size_t)height - 1 - i / (size_t)width, x = i % (size_t)width;
        if (!image_wants(part, im, (uint32_t)y)) continue;
        float *to = im->rgba + 4 * (y * (size_t)width + x);
        for (size_t c = 0; c < 3; c++)
            to[c] = float_of(p + at + 4 * (i * floats + (floats == 3 ? c : 0)), order < 0);
        to[3] = 1;
    }
    return 0;
}

int pfm_encode(FILE *f, const struct image_rows *rows)
{
    size_t row = (size_t)rows->w * 12;
    unsigned char *out = xmalloc(row, 1);
    fprintf(f, "PF\n%u %u\n-1.0\n", rows->w, rows->h);
    bool ok = true;
    for (uint32_t y = rows->h; y-- > 0 && ok;) {
        const float *from = rows->row(rows, y);
        for (size_t x = 0; from && x < rows->w; x++)
            for (size_t c = 0; c < 3; c++) float_put(out + 12 * x + 4 * c, from[4 * x + c]);
        ok = from && fwrite(out, 1, row, f) == row;
    }
    int why = errno;
    free(out);
    errno = why;
    return ok ? 0 : -1;
}
