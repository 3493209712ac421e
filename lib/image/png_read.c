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
    unsigned char *rgba; /* a row of a palette's colours */
    double curve;        /* of the samples; CURVE_UNSTATED: no chunk states it */
    bool coded;          /* a cICP states it, which goes before all others */
    bool profile;        /* an iCCP states it, which is not read */
    bool clear;          /* a chunk states alpha */
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

/* Converts every kind to RGB or RGBA of 8 or 16 bits, but palettes to an index a byte: libpng would
 * make black of an index beyond the palette. */
static void unify(struct reader *r)
{
    if (png_get_color_type(r->png, r->info) == PNG_COLOR_TYPE_PALETTE) {
        png_set_packing(r->png);
        r->rgba = xcalloc(png_get_image_width(r->png, r->info), 4);
        return;
    }
    png_set_expand(r->png); /* grey below 8 bits, tRNS */
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
    bool alpha = png_get_color_type(r->png, r->info) & PNG_COLOR_MASK_ALPHA;
    if (r->clear && !alpha && !png_get_valid(r->png, r->info, PNG_INFO_tRNS))
        png_error(r->png, "a tRNS chunk that does not fit");
    if (!r->coded &&
        png_get_valid(r->png, r->info, PNG_INFO_sRGB)) /* also by a profile that libpng knows */
        r->curve = CURVE_SRGB;
    bool deep = png_get_bit_depth(r->png, r->info) == 16;
    if (r->curve == CURVE_UNSTATED && deep && r->profile) {
        image_fail(r->err, "16 bits whose curve only a profile states, expected sRGB or gAMA");
        png_longjmp(r->png, 1);
    }
    if (r->curve == CURVE_UNSTATED && !sampler_curve(r->part, deep, &r->curve, r->err))
        png_longjmp(r->png, 1);
    sampler_init(&r->sampler, deep ? 65535 : 255, r->curve);
    unify(r);
    image_init(r->im, w, h);
}

/* The colours of a row of indices, as RGBA. */
static const unsigned char *look_up(struct reader *r, const unsigned char *index)
{
    png_colorp colour = NULL;
    png_bytep alpha = NULL;
    int n = 0, n_alpha = 0;
    png_get_PLTE(r->png, r->info, &colour, &n);
    png_get_tRNS(r->png, r->info, &alpha, &n_alpha, NULL);
    for (uint32_t x = 0; x < r->im->w; x++) {
        const int i = index[x];
        if (i >= n) png_error(r->png, "a pixel whose colour is not in the palette");
        r->rgba[4 * x] = colour[i].red;
        r->rgba[4 * x + 1] = colour[i].green;
        r->rgba[4 * x + 2] = colour[i].blue;
        r->rgba[4 * x + 3] = i < n_alpha ? alpha[i] : 255;
    }
    return r->rgba;
}

static void read_pixels(struct reader *r)
{
    int passes = png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    size_t row = png_get_rowbytes(r->png, r->info), stride = passes > 1 ? row : 0;
    int channels = r->rgba ? 4 : png_get_channels(r->png, r->info);
    uint32_t w = r->im->w, h = r->im->h;
    r->rows = xcalloc(passes > 1 ? h : 1, row);
    for (int pass = 0; pass < passes; pass++)
        for (uint32_t y = 0; y < h; y++) {
            unsigned char *at = r->rows + y * stride;
            png_read_row(r->png, at, NULL);
            if (pass == passes - 1 && image_wants(r->part, r->im, y))
                sampler_row(&r->sampler, r->rgba ? look_up(r, at) : at, channels, w,
                    r->im->rgba + (size_t)4 * w * y);
        }
    png_read_end(r->png, NULL);
}

/* Whether a chunk of this name is at p. */
static bool is_chunk(const unsigned char *p, const char *name) { return !memcmp(p + 4, name, 4); }

/* Where the last chunk ends, if all chunks are complete; otherwise 0. It is checked because libpng
 * allocates a chunk's declared length before reading it, regardless of its limits. */
static size_t chunks_end(const unsigned char *p, size_t n)
{
    size_t at = SIGNATURE;
    while (n >= AROUND && at <= n - AROUND) {
        uint32_t data = png_get_uint_32(p + at);
        if (data > n - AROUND - at) return 0;
        at += AROUND + data;
        if (is_chunk(p + at - data - AROUND, "IEND")) return at;
    }
    return 0;
}

/* The curve that a cICP states, by ITU-T H.273, for RGB of the full range. False with a message if
 * it is another. */
static bool take_code(struct reader *r, const unsigned char *p, size_t n, double *curve)
{
    static const char why[] = "PNG with cICP of another curve, expected sRGB or linear light";
    const int code = n == 4 && p[2] == 0 && p[3] == 1 ? p[1] : -1;
    const double is = code == 13 ? CURVE_SRGB : 1.0;
    const bool other = r->coded && *curve != is;
    if ((code != 13 && code != 8) || other) return image_fail(r->err, why) == 0;
    *curve = is;
    return r->coded = true;
}

static bool states_curve(const unsigned char *p)
{
    return is_chunk(p, "cICP") || is_chunk(p, "sRGB") || is_chunk(p, "gAMA") || is_chunk(p, "iCCP");
}

/*
 * Finds the chunks that state what samples mean: cICP, or else sRGB, or else gAMA, which is 100000
 * times the exponent from light to sample, and tRNS. libpng leaves out those that contradict other
 * chunks, such as a damaged profile. False with a message if a gAMA is no exponent, or one stands
 * behind the pixels.
 */
static bool find_statements(struct reader *r)
{
    const unsigned char *p = r->p;
    bool srgb = false, pixels = false;
    double coded = CURVE_UNSTATED;
    r->curve = CURVE_UNSTATED;
    for (size_t at = SIGNATURE, data; at < r->n; at += AROUND + data) {
        data = png_get_uint_32(p + at);
        srgb |= is_chunk(p + at, "sRGB");
        r->clear |= is_chunk(p + at, "tRNS");
        r->profile |= is_chunk(p + at, "iCCP");
        pixels |= is_chunk(p + at, "IDAT");
        if (pixels && states_curve(p + at))
            return image_fail(r->err, "damaged PNG: %.4s behind its pixels, expected it before",
                       (const char *)p + at + 4) == 0;
        if (is_chunk(p + at, "cICP") && !take_code(r, p + at + 8, data, &coded)) return false;
        if (!is_chunk(p + at, "gAMA")) continue;
        uint32_t gamma = data == 4 ? png_get_uint_32(p + at + 8) : 0;
        const double curve = gamma == PNG_GAMMA_LINEAR ? 1.0 : 1.0 * PNG_GAMMA_LINEAR / gamma;
        bool other = r->curve != CURVE_UNSTATED && r->curve != curve;
        if (gamma == 0 || gamma > PNG_UINT_31_MAX || other)
            return image_fail(r->err, "damaged PNG: gAMA, expected one, above 0") == 0;
        r->curve = curve;
    }
    if (srgb) r->curve = CURVE_SRGB;
    if (r->coded) r->curve = coded;
    return true;
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
    int failed = find_statements(&r) && reader_init(&r) ? guarded(&r) : -1;
    png_destroy_read_struct(&r.png, &r.info, NULL);
    sampler_free(&r.sampler);
    free(r.rows);
    free(r.rgba);
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
