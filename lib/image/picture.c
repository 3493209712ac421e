/* picture: pixel buffers and messages about them. */
#include "image/codecs.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void image_init(struct image *im, uint32_t w, uint32_t h)
{
    im->w = w;
    im->h = h;
    im->rgba = xcalloc((size_t)w * h, 4 * sizeof(float));
}

void image_free(struct image *im)
{
    free(im->rgba);
    *im = (struct image){0};
}

static bool opaque(const struct image *im)
{
    for (size_t i = 0, n = (size_t)im->w * im->h; i < n; i++)
        if (!(im->rgba[4 * i + 3] >= 1)) return false;
    return true;
}

static const float *row_of(const struct image_rows *rows, uint32_t y)
{
    return (const float *)rows->ctx + (size_t)4 * rows->w * y;
}

struct image_rows image_rows_of(const struct image *im)
{
    return (struct image_rows){im->w, im->h, opaque(im), row_of, im->rgba};
}

int image_fail(char err[IMAGE_ERR], const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(err, IMAGE_ERR, fmt, ap);
    va_end(ap);
    return -1;
}

bool image_size_ok(uint64_t w, uint64_t h, char err[IMAGE_ERR])
{
    if (w >= 1 && h >= 1 && w <= FRAME_SIDE_MAX && h <= FRAME_SIDE_MAX && w * h <= IMAGE_PIXELS_MAX)
        return true;
    image_fail(err, "%llux%llu pixels, expected sides from 1 to %d and at most %llu pixels",
        (unsigned long long)w, (unsigned long long)h, FRAME_SIDE_MAX,
        (unsigned long long)IMAGE_PIXELS_MAX);
    return false;
}
