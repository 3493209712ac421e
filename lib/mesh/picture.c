/* picture: reads pictures of textures, and reduces large ones by means of squares of texels. */
#include "mesh/picture.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool fail(char err[IMAGE_ERR], const char *what)
{
    snprintf(err, IMAGE_ERR, "%s", what);
    return false;
}

/* The mean of k x k pixels for each, fewer at the right and bottom edges. */
static void reduce(struct image *im, uint32_t k)
{
    const uint32_t w = (im->w + k - 1) / k, h = (im->h + k - 1) / k;
    struct image out;
    image_init(&out, w, h);
    for (uint32_t y = 0; y < im->h; y++)
        for (uint32_t x = 0; x < im->w; x++)
            for (size_t c = 0; c < 4; c++)
                out.rgba[4 * ((size_t)(y / k) * w + x / k) + c] +=
                    im->rgba[4 * ((size_t)y * im->w + x) + c];
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++) {
            const uint32_t across = x + 1 < w ? k : im->w - x * k;
            const uint32_t along = y + 1 < h ? k : im->h - y * k;
            const float n = (float)across * (float)along;
            for (size_t c = 0; c < 4; c++) out.rgba[4 * ((size_t)y * w + x) + c] /= n;
        }
    image_free(im);
    *im = out;
}

static bool is_jpeg(const unsigned char *p, size_t n)
{
    return n >= 3 && p[0] == 0xff && p[1] == 0xd8 && p[2] == 0xff;
}

/* False with a message if the header of a PNG declares too many pixels. */
static bool is_png_small(const unsigned char *p, size_t n, char err[IMAGE_ERR])
{
    uint32_t w, h;
    if (n < 8 || memcmp(p, "\211PNG\r\n\032\n", 8) != 0) return true;
    if (png_inspect(p, &n, &w, &h, err) != 0) return false;
    return (uint64_t)w * h <= MESH_PICTURE_PX_MAX || fail(err, "more than 67108864 pixels");
}

bool mesh_picture_decode(const unsigned char *p, size_t n, struct image *im, char err[IMAGE_ERR])
{
    if (!is_png_small(p, n, err)) return false;
    if (is_jpeg(p, n) ? !mesh_jpeg_decode(p, n, im, err) : image_decode(p, n, im, err) != 0)
        return false;
    const uint32_t side = im->w > im->h ? im->w : im->h;
    const uint32_t k = (side + MESH_PICTURE_SIDE - 1) / MESH_PICTURE_SIDE;
    if (k > 1) reduce(im, k);
    return true;
}

bool mesh_picture_read(const char *path, struct image *im, char err[IMAGE_ERR])
{
    struct buf b = {0};
    struct stat st;
    if (stat(path, &st) != 0) return fail(err, strerror(errno));
    if (!S_ISREG(st.st_mode)) return fail(err, "is no file, expected a picture");
    const bool ok = read_file(path, &b) == 0
                        ? mesh_picture_decode(buf_data(&b), buf_size(&b), im, err)
                        : fail(err, strerror(errno));
    buf_free(&b);
    return ok;
}

bool mesh_picture_embedded(const struct aiTexture *t, struct image *im, char err[IMAGE_ERR])
{
    if (!t->pcData || !t->mWidth) return fail(err, "is empty, expected a picture");
    if (!t->mHeight) return mesh_picture_decode((const void *)t->pcData, t->mWidth, im, err);
    if ((uint64_t)t->mWidth * t->mHeight > MESH_PICTURE_PX_MAX)
        return fail(err, "more than 67108864 pixels");
    image_init(im, t->mWidth, t->mHeight);
    for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
        const struct aiTexel *from = &t->pcData[i];
        const float a = from->a / 255.F;
        im->rgba[4 * i] = srgb_decode8(from->r) * a;
        im->rgba[4 * i + 1] = srgb_decode8(from->g) * a;
        im->rgba[4 * i + 2] = srgb_decode8(from->b) * a;
        im->rgba[4 * i + 3] = a;
    }
    return true;
}
