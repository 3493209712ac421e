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
