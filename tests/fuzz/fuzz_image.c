/*
 * Whatever the bytes: image_decode returns a picture or a message. A picture's size is within the
 * limits, and small ones are written in every format and read again. png_inspect finds the size
 * that image_decode finds.
 */
#include "image/codecs.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MUST(x)                                                                                    \
    do {                                                                                           \
        if (!(x)) fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #x), abort();   \
    } while (0)

static void check_again(const struct image *im, enum image_format format, int bits)
{
    char *p, err[IMAGE_ERR];
    size_t n;
    struct image again;
    FILE *f = open_memstream(&p, &n);
    MUST(f && image_write(f, im, format, bits, "0") == 0 && fclose(f) == 0);
    MUST(image_decode((const unsigned char *)p, n, &again, err) == 0);
    MUST(again.w == im->w && again.h == im->h);
    image_free(&again);
    free(p);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct image im;
    char err[IMAGE_ERR] = "";
    size_t n = size;
    uint32_t w = 0, h = 0;
    bool whole = png_inspect(data, &n, &w, &h, err) == 0;
    MUST(whole ? w >= 1 && h >= 1 && n <= size : strstr(err, ", expected") != NULL);
    if (image_decode(data, size, &im, err) != 0) {
        MUST(!im.rgba && strstr(err, ", expected"));
        return 0;
    }
    MUST(!whole || (im.w == w && im.h == h));
    MUST(im.w >= 1 && im.h >= 1 && (uint64_t)im.w * im.h <= IMAGE_PIXELS_MAX);
    if ((uint64_t)im.w * im.h <= 4096) {
        check_again(&im, IMAGE_PNG, 8);
        check_again(&im, IMAGE_PNG, 16);
        check_again(&im, IMAGE_PAM, 8);
        check_again(&im, IMAGE_PFM, 16);
    }
    image_free(&im);
    return 0;
}
