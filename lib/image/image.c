/* image: reads and writes picture files; chooses the codec. */
#include "image/codecs.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/* Upper bound on the length of an accepted file: incompressible 16-bit RGBA, and headers. */
#define FILE_BYTES_MAX ((size_t)IMAGE_PIXELS_MAX * 12 + (1 << 20))

bool image_format_of(const char *path, enum image_format *format)
{
    static const char suffix[][5] = {
        [IMAGE_PNG] = ".png", [IMAGE_PAM] = ".pam", [IMAGE_PFM] = ".pfm"};
    size_t n = strlen(path);
    for (int i = 0; i < 3; i++)
        if (n > 4 && path[n - 5] != '/' && strcasecmp(path + n - 4, suffix[i]) == 0) {
            *format = (enum image_format)i;
            return true;
        }
    return false;
}

int image_decode(const unsigned char *p, size_t n, struct image *im, char err[IMAGE_ERR])
{
    const struct image_part all = {0};
    return image_decode_part(p, n, &all, im, err);
}

int image_decode_part(const unsigned char *p, size_t n, const struct image_part *part,
    struct image *im, char err[IMAGE_ERR])
{
    *im = (struct image){0};
    if (n == 0) return image_fail(err, "empty, expected a PNG, PAM, PPM, PGM or PFM picture");
    if (n >= 4 && memcmp(p, "\211PNG", 4) == 0) return png_decode(p, n, part, im, err);
    if (n >= 2 && p[0] == 'P' && strchr("567", p[1]) && p[1])
        return pnm_decode(p, n, part, im, err);
    if (n >= 2 && p[0] == 'P' && (p[1] == 'F' || p[1] == 'f'))
        return pfm_decode(p, n, part, im, err);
    return image_fail(err, "unknown picture format, expected PNG, PAM, PFM, or binary PPM or PGM");
}

/* Reads the whole file, if it has at most `most` bytes. */
static int slurp(const char *path, size_t most, struct buf *b, char err[IMAGE_ERR])
{
    int fd = input_open(path);
    if (fd < 0) return image_fail(err, "%s, expected a picture", strerror(errno));
    ptrdiff_t k;
    while ((k = read_some(fd, b, 1 << 18)) > 0)
        if (buf_size(b) > most) break;
    int why = errno;
    if (fd != STDIN_FILENO) close(fd);
    if (k < 0) return image_fail(err, "%s, expected a picture", strerror(why));
    if (k > 0) return image_fail(err, "more than %zu bytes, expected a picture", most);
    return 0;
}

int image_read(const char *path, struct image *im, char err[IMAGE_ERR])
{
    struct buf b = {0};
    *im = (struct image){0};
    int failed = slurp(path, FILE_BYTES_MAX, &b, err);
    if (!failed) failed = image_decode(buf_data(&b), buf_size(&b), im, err);
    buf_free(&b);
    return failed;
}

int image_load_png(
    const char *path, size_t most, struct buf *b, uint32_t *w, uint32_t *h, char err[IMAGE_ERR])
{
    *b = (struct buf){0};
    int failed = slurp(path, most, b, err);
    size_t n = buf_size(b);
    if (!failed) failed = png_inspect(buf_data(b), &n, w, h, err);
    if (failed) buf_free(b);
    else b->len = b->off + n;
    return failed;
}

int image_write_rows(
    FILE *f, const struct image_rows *rows, enum image_format format, int bits, const char *job)
{
    switch (format) {
    case IMAGE_PNG: return png_encode(f, rows, bits, job);
    case IMAGE_PAM: return pam_encode(f, rows, bits);
    case IMAGE_PFM: return pfm_encode(f, rows);
    }
    errno = EINVAL;
    return -1;
}

int image_write(
    FILE *f, const struct image *im, enum image_format format, int bits, const char *job)
{
    const struct image_rows rows = image_rows_of(im);
    return image_write_rows(f, &rows, format, bits, job);
}

int image_save(
    const char *path, const struct image *im, enum image_format format, int bits, const char *job)
{
    const struct image_rows rows = image_rows_of(im);
    return image_save_rows(path, &rows, format, bits, job);
}

int image_save_rows(const char *path, const struct image_rows *rows, enum image_format format,
    int bits, const char *job)
{
    struct outfile out;
    if (outfile_open(&out, path) != 0) return -1;
    if (image_write_rows(out.f, rows, format, bits, job) == 0) return outfile_commit(&out);
    int why = errno;
    outfile_discard(&out);
    errno = why;
    return -1;
}
