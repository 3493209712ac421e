/*
 * png_read: reads untrusted PNG from memory, through libpng.
 *
 * libpng reports errors by longjmp. All resources to release are in struct reader, which the jump
 * does not touch. The work is done in functions below the one that calls setjmp, so no local
 * variable is read after a jump.
 */
#include "image/codecs.h"

#include <png.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Memory limit for any one chunk in libpng, besides the pixels. */
#define CHUNK_BYTES_MAX (1 << 22)
#define CHUNKS_MAX 1000
/* Deflate's maximum compression ratio. */
#define DEFLATE_RATIO_MAX 1032
/* Bytes before the chunks; bytes around the data of each: length, type, checksum. */
enum { SIGNATURE = 8, AROUND = 12 };

struct reader {
    png_structp png;
    png_infop info;
    const unsigned char *p;
    size_t n;
    unsigned char *rows; /* one row, or all rows if interlaced */
    struct sampler sampler;
    const struct image_part *part;
    struct image *im;
    char *err;
};

static _Noreturn void on_error(png_structp png, png_const_charp text)
{
    struct reader *r = png_get_error_ptr(png);
    image_fail(r->err, "damaged PNG: %s, expected a whole one", text);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text;
}

static void take(png_structp png, png_bytep to, size_t n)
{
    struct reader *r = png_get_io_ptr(png);
    if (n > r->n) png_error(png, "it ends too early");
    memcpy(to, r->p, n);
    r->p += n;
    r->n -= n;
}

/* The samples' transfer curve: from the sRGB chunk, the gAMA chunk, or the default in image.h. */
static double curve_of(const struct reader *r, int depth)
{
    png_fixed_point gamma; /* 100000 times the exponent from light to sample */
    if (png_get_valid(r->png, r->info, PNG_INFO_sRGB)) return CURVE_SRGB;
    if (!png_get_gAMA_fixed(r->png, r->info, &gamma) || gamma <= 0)
        return depth == 16 ? 1.0 : CURVE_SRGB;
    if (depth < 16 && gamma >= 45450 && gamma <= 45460) return CURVE_SRGB;
    return gamma == 100000 ? 1.0 : 100000.0 / gamma;
}

/* Converts every kind to RGB or RGBA of 8 or 16 bits. */
static void unify(struct reader *r)
{
    png_set_expand(r->png); /* palettes, grey below 8 bits, tRNS */
    png_set_gray_to_rgb(r->png);
}

static void read_header(struct reader *r)
{
    png_read_info(r->png, r->info);
    uint32_t w = png_get_image_width(r->png, r->info), h = png_get_image_height(r->png, r->info);
    char why[IMAGE_ERR];
    if (!image_size_ok(w, h, why)) png_error(r->png, why);
    size_t row = png_get_rowbytes(r->png, r->info);
    if (row * h / DEFLATE_RATIO_MAX > r->n)
        png_error(r->png, "it is too short for the size it declares");
    int depth = png_get_bit_depth(r->png, r->info);
    sampler_init(&r->sampler, depth == 16 ? 65535 : 255, curve_of(r, depth));
    unify(r);
    image_init(r->im, w, h);
}

static void read_pixels(struct reader *r)
{
    int passes = png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    size_t row = png_get_rowbytes(r->png, r->info), stride = passes > 1 ? row : 0;
    int channels = png_get_channels(r->png, r->info);
    uint32_t w = r->im->w, h = r->im->h;
    r->rows = xcalloc(passes > 1 ? h : 1, row);
    for (int pass = 0; pass < passes; pass++)
        for (uint32_t y = 0; y < h; y++) {
            unsigned char *at = r->rows + y * stride;
            png_read_row(r->png, at, NULL);
            if (pass == passes - 1 && image_wants(r->part, r->im, y))
                sampler_row(&r->sampler, at, channels, w, r->im->rgba + (size_t)4 * w * y);
        }
    png_read_end(r->png, NULL);
}

/* Where the last chunk ends, if all chunks are complete; otherwise 0. It is checked because libpng
 * allocates a chunk's declared length before reading it, regardless of its limits. */
static size_t chunks_end(const unsigned char *p, size_t n)
{
    size_t at = SIGNATURE;
    while (n >= AROUND && at <= n - AROUND) {
        uint32_t data = png_get_uint_32(p + at);
        if (data > n - AROUND - at) return 0;
        at += AROUND + data;
        if (memcmp(p + at - data - AROUND + 4, "IEND", 4) == 0) return at;
    }
    return 0;
}

/* The chunks are complete. */
static bool sums_right(const unsigned char *p, size_t end)
{
    for (size_t at = SIGNATURE, data; at < end; at += AROUND + data) {
        data = png_get_uint_32(p + at);
        uLong sum = crc32_z(0, p + at + 4, 4 + data);
        if (sum != png_get_uint_32(p + at + 8 + data)) return false;
    }
    return true;
}

static void set_limits(struct reader *r)
{
    png_set_read_fn(r->png, r, take);
    /* By default a damaged gAMA chunk is left out, and samples then stand for other light. */
    png_set_crc_action(r->png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_user_limits(r->png, FRAME_SIDE_MAX, FRAME_SIDE_MAX);
    png_set_chunk_malloc_max(r->png, CHUNK_BYTES_MAX);
    png_set_chunk_cache_max(r->png, CHUNKS_MAX);
}

static int guarded(struct reader *r)
{
    if (setjmp(png_jmpbuf(r->png))) return -1;
    set_limits(r);
    read_header(r);
    read_pixels(r);
    return 0;
}

static int guarded_header(struct reader *r)
{
    if (setjmp(png_jmpbuf(r->png))) return -1;
    set_limits(r);
    png_read_info(r->png, r->info);
    return 0;
}

static bool reader_init(struct reader *r)
{
    r->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, r, on_error, on_warning);
    if (r->png) r->info = png_create_info_struct(r->png);
    return r->info || image_fail(r->err, "out of memory in libpng") == 0;
}

int png_decode(const unsigned char *p, size_t n, const struct image_part *part, struct image *im,
    char err[IMAGE_ERR])
{
    size_t end = chunks_end(p, n);
    if (!end) return image_fail(err, "damaged PNG: it ends within a chunk, expected a whole one");
    if (end != n) return image_fail(err, "%zu bytes behind the PNG, expected one picture", n - end);
    struct reader r = {.p = p, .n = n, .part = part, .im = im, .err = err};
    int failed = reader_init(&r) ? guarded(&r) : -1;
    png_destroy_read_struct(&r.png, &r.info, NULL);
    sampler_free(&r.sampler);
    free(r.rows);
    if (failed) image_free(im);
    return failed;
}

int png_inspect(const unsigned char *p, size_t *n, uint32_t *w, uint32_t *h, char err[IMAGE_ERR])
{
    if (*n < SIGNATURE || png_sig_cmp(p, 0, SIGNATURE) != 0)
        return image_fail(err, "not a PNG, expected one");
    size_t end = chunks_end(p, *n);
    if (!end) return image_fail(err, "damaged PNG: it ends within a chunk, expected a whole one");
    if (!sums_right(p, end))
        return image_fail(err, "damaged PNG: the sum of a chunk is wrong, expected a whole one");
    struct reader r = {.p = p, .n = *n = end, .err = err};
    int failed = reader_init(&r) ? guarded_header(&r) : -1;
    if (!failed) {
        *w = png_get_image_width(r.png, r.info);
        *h = png_get_image_height(r.png, r.info);
    }
    png_destroy_read_struct(&r.png, &r.info, NULL);
    return failed;
}
