/* Curves, codecs and names: what is written is read again; what is damaged is refused and leaks
 * nothing. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>
#include <png.h>
#include <zlib.h>

#include "image/codecs.h"

/* ---- curves ----------------------------------------------------------------------------- */

static long double decode_exact(long double v)
{
    return v <= 0.04045L ? v / 12.92L : powl((v + 0.055L) / 1.055L, 2.4L);
}

/* Between codes k-1 and k lies decode((k - 1/2) / 255); the floats next to it must fall on its
 * two sides. */
static void test_encode8_is_nearest(void **state)
{
    (void)state;
    for (int k = 1; k < 256; k++) {
        long double edge = decode_exact((k - 0.5L) / 255);
        float above = (float)edge;
        if ((long double)above < edge) above = nextafterf(above, 1);
        assert_int_equal(srgb_encode8(above), k);
        assert_int_equal(srgb_encode8(nextafterf(above, 0)), k - 1);
    }
    for (int k = 0; k < 256; k++) {
        assert_int_equal(srgb_encode8(srgb_decode8((uint8_t)k)), k);
        assert_true(srgb_decode8((uint8_t)k) == (float)decode_exact(k / 255.0L));
    }
    assert_int_equal(srgb_encode8(-1), 0);
    assert_int_equal(srgb_encode8(NAN), 0);
    assert_int_equal(srgb_encode8(INFINITY), 255);
}

static void image_of(struct image *im, const float *rgba, uint32_t w, uint32_t h)
{
    image_init(im, w, h);
    memcpy(im->rgba, rgba, (size_t)w * h * 4 * sizeof *rgba);
}

/* The fast way of whole rows gives what srgb_encode8 gives: at every threshold, and along all
 * of [0,1]. */
static void test_rows_encode_the_same(void **state)
{
    (void)state;
    static const float opaque[4] = {0, 0, 0, 1};
    struct image im;
    image_of(&im, opaque, 1, 1);
    struct quantizer q;
    quantizer_init(&q, &im, 8);
    image_free(&im);
    unsigned char out[3];
    for (uint32_t bits = 0; bits <= 0x3f800000; bits += 977) {
        float x[4] = {0, 0, 0, 1};
        memcpy(x, &bits, sizeof bits);
        quantizer_row(&q, x, 1, out);
        assert_int_equal(out[0], srgb_encode8(x[0]));
    }
    for (int k = 1; k < 256; k++) {
        float x[4] = {
            q.threshold[k], nextafterf(q.threshold[k], 0), nextafterf(q.threshold[k], 1), 1};
        quantizer_row(&q, x, 1, out);
        for (int c = 0; c < 3; c++) assert_int_equal(out[c], srgb_encode8(x[c]));
    }
    const float odd[4] = {-INFINITY, NAN, INFINITY, 1};
    quantizer_row(&q, odd, 1, out);
    assert_int_equal(out[0], 0);
    assert_int_equal(out[1], 0);
    assert_int_equal(out[2], 255);
}

/* ---- round trips ------------------------------------------------------------------------ */

struct bytes {
    char *p;
    size_t n;
};

static struct bytes encoded(
    const struct image *im, enum image_format format, int bits, const char *job)
{
    struct bytes b;
    FILE *f = open_memstream(&b.p, &b.n);
    assert_non_null(f);
    assert_int_equal(image_write(f, im, format, bits, job), 0);
    fclose(f);
    return b;
}

static int decoded(struct bytes b, struct image *im, char err[IMAGE_ERR])
{
    return image_decode((const unsigned char *)b.p, b.n, im, err);
}

/* A picture of which every sample is what a file of `bits` can hold. */
static void fill(struct image *im, uint32_t w, uint32_t h, int bits, bool transparent)
{
    image_init(im, w, h);
    for (uint64_t i = 0; i < (uint64_t)w * h; i++) {
        float *p = im->rgba + 4 * i;
        uint32_t a = !transparent ? 65535 : i % 3 == 0 ? 65535 : 0;
        for (uint64_t c = 0; c < 3; c++) {
            uint64_t r = rng_u64(7, 4 * i + c);
            float v = bits == 8 ? srgb_decode8((uint8_t)r) : (float)((double)(r & 65535) / 65535);
            p[c] = a ? v : 0;
        }
        p[3] = a ? 1 : 0;
    }
}

static void round_trip(enum image_format format, int bits, bool transparent)
{
    char err[IMAGE_ERR] = "";
    struct image a, b;
    fill(&a, 37, 11, bits, transparent);
    struct bytes file = encoded(&a, format, bits, "0123");
    if (decoded(file, &b, err) != 0) fail_msg("%s", err);
    assert_int_equal(b.w, 37);
    assert_int_equal(b.h, 11);
    assert_memory_equal(a.rgba, b.rgba, sizeof(float) * 4 * 37 * 11);
    image_free(&a);
    image_free(&b);
    free(file.p);
}

static void test_round_trips(void **state)
{
    (void)state;
    for (int bits = 8; bits <= 16; bits += 8)
        for (int transparent = 0; transparent < 2; transparent++) {
            round_trip(IMAGE_PNG, bits, transparent);
            round_trip(IMAGE_PAM, bits, transparent);
        }
    round_trip(IMAGE_PFM, 16, false);
}

/* Half transparent: the file has the colour itself, the picture again the premultiplied one. */
static void test_alpha_is_not_premultiplied_in_files(void **state)
{
    (void)state;
    char err[IMAGE_ERR];
    const float half[4] = {.25f, .125f, 0, .5f};
    struct image a, b;
    image_of(&a, half, 1, 1);
    struct bytes file = encoded(&a, IMAGE_PAM, 16, NULL);
    const unsigned char *px = (const unsigned char *)file.p + file.n - 8;
    assert_int_equal(px[0] << 8 | px[1], 32768);
    assert_int_equal(px[6] << 8 | px[7], 32768);
    assert_int_equal(decoded(file, &b, err), 0);
    for (int c = 0; c < 4; c++) assert_true(fabsf(b.rgba[c] - half[c]) < 1e-4f);
    image_free(&a);
    image_free(&b);
    free(file.p);
}

static const unsigned char *chunk(struct bytes b, const char *name, uint32_t *n)
{
    for (size_t at = 8; at + 12 <= b.n;) {
        const unsigned char *p = (const unsigned char *)b.p + at;
        *n = (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
        if (memcmp(p + 4, name, 4) == 0) return p + 8;
        at += *n + 12;
    }
    return NULL;
}

static void test_png_chunks(void **state)
{
    (void)state;
    struct image im;
    uint32_t n;
    fill(&im, 4, 4, 8, false);
    struct bytes a = encoded(&im, IMAGE_PNG, 8, "cafe"), b = encoded(&im, IMAGE_PNG, 16, NULL);
    const unsigned char *text = chunk(a, "tEXt", &n);
    assert_non_null(text);
    assert_int_equal(n, 8);
    assert_memory_equal(text, "Job\0cafe", 8);
    assert_non_null(chunk(a, "sRGB", &n));
    assert_null(chunk(a, "tIME", &n));
    assert_int_equal(chunk(a, "IHDR", &n)[9], PNG_COLOR_TYPE_RGB);
    assert_memory_equal(chunk(b, "gAMA", &n), "\x00\x01\x86\xa0", 4);
    assert_null(chunk(b, "sRGB", &n));
    assert_null(chunk(b, "tEXt", &n));
    struct bytes again = encoded(&im, IMAGE_PNG, 8, "cafe");
    assert_int_equal(a.n, again.n);
    assert_memory_equal(a.p, again.p, a.n);
    free(a.p);
    free(b.p);
    free(again.p);
    image_free(&im);
}

/* ---- PNGs of every kind ----------------------------------------------------------------- */

struct kind {
    int type, depth, interlace;
    int gamma; /* gAMA, 0 none, -1 an sRGB chunk */
    bool trns;
};

static void put_bytes(png_structp png, png_bytep p, size_t n)
{
    fwrite(p, 1, n, png_get_io_ptr(png));
}
static void no_flush(png_structp png) { (void)png; }

/* 5x4 samples: sample s of pixel i is (i * 7 + s * 3) spread over the range of the depth. */
static uint32_t sample(const struct kind *k, uint32_t i, uint32_t s)
{
    uint32_t v = i * 7 + s * 3;
    return k->depth == 16 ? v * 1001 & 65535
                          : v * (k->depth == 8 ? 11 : 1) & ((1u << k->depth) - 1);
}

static int channels_of(int type)
{
    return type == PNG_COLOR_TYPE_RGB          ? 3
           : type == PNG_COLOR_TYPE_RGB_ALPHA  ? 4
           : type == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                                               : 1;
}

static void pack_row(const struct kind *k, uint32_t y, unsigned char row[64])
{
    int n = channels_of(k->type);
    memset(row, 0, 64);
    for (int s = 0; s < 5 * n; s++) {
        uint32_t v = sample(k, y * 5 + (uint32_t)(s / n), (uint32_t)(s % n));
        if (k->depth == 16) {
            row[2 * s] = (unsigned char)(v >> 8);
            row[2 * s + 1] = (unsigned char)v;
        } else {
            int bit = s * k->depth;
            row[bit / 8] = (unsigned char)(row[bit / 8] | v << (8 - k->depth - bit % 8));
        }
    }
}

static struct bytes make_png(const struct kind *k)
{
    struct bytes b;
    FILE *f = open_memstream(&b.p, &b.n);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    assert_int_equal(setjmp(png_jmpbuf(png)), 0);
    png_set_write_fn(png, f, put_bytes, no_flush);
    png_set_IHDR(png, info, 5, 4, k->depth, k->type, k->interlace, 0, 0);
    png_color palette[256];
    png_byte alphas[256];
    for (int i = 0; i < 256; i++) {
        palette[i] = (png_color){(png_byte)i, (png_byte)(255 - i), (png_byte)(i * 3)};
        alphas[i] = (png_byte)(i % 2 ? 255 : 0);
    }
    png_color_16 key = {.gray = (png_uint_16)sample(k, 0, 0),
        .red = (png_uint_16)sample(k, 0, 0),
        .green = (png_uint_16)sample(k, 0, 1),
        .blue = (png_uint_16)sample(k, 0, 2)};
    if (k->type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 1 << k->depth);
    if (k->trns) png_set_tRNS(png, info, alphas, 1 << k->depth, &key);
    if (k->gamma > 0) png_set_gAMA_fixed(png, info, k->gamma);
    if (k->gamma < 0) png_set_sRGB(png, info, 0);
    png_write_info(png, info);
    unsigned char rows[4][64], *at[4];
    for (uint32_t y = 0; y < 4; y++) pack_row(k, y, at[y] = rows[y]);
    png_write_image(png, at);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(f);
    return b;
}

/* What sample v of `max` means, by the rules of image.h. */
static double light(const struct kind *k, uint32_t v, uint32_t max)
{
    double x = (double)v / max;
    bool srgb = k->gamma < 0 || (k->depth < 16 && (k->gamma == 0 || k->gamma == 45455));
    if (srgb) return (double)decode_exact((long double)x);
    return k->gamma == 0 || k->gamma == 100000 ? x : pow(x, 1e5 / k->gamma);
}

static void expected_pixel(const struct kind *k, uint32_t i, double out[4])
{
    uint32_t v[4], max = (1u << k->depth) - 1;
    int n = channels_of(k->type), colours = n < 3 ? 1 : 3;
    for (int s = 0; s < n; s++) v[s] = sample(k, i, (uint32_t)s);
    out[3] = n == 2 || n == 4 ? (double)v[n - 1] / max : 1;
    if (k->type == PNG_COLOR_TYPE_PALETTE) {
        uint32_t index = v[0];
        if (k->trns) out[3] = index % 2;
        uint32_t rgb[3] = {index, 255 - index, index * 3 & 255};
        for (int c = 0; c < 3; c++) out[c] = light(k, rgb[c], 255) * out[3];
        return;
    }
    if (k->trns) {
        bool keyed = true;
        for (int c = 0; c < colours; c++) keyed = keyed && v[c] == sample(k, 0, (uint32_t)c);
        if (keyed) out[3] = 0;
    }
    for (int c = 0; c < 3; c++) out[c] = light(k, v[colours == 1 ? 0 : c], max) * out[3];
}

static void check_kind(const struct kind *k)
{
    char err[IMAGE_ERR] = "";
    struct bytes b = make_png(k);
    struct image im;
    if (decoded(b, &im, err) != 0) fail_msg("type %d depth %d: %s", k->type, k->depth, err);
    for (uint32_t i = 0; i < 20; i++) {
        double want[4];
        expected_pixel(k, i, want);
        for (int c = 0; c < 4; c++)
            if (!(fabs((double)im.rgba[4 * i + (uint32_t)c] - want[c]) < 1e-6))
                fail_msg(
                    "type %d depth %d interlace %d gamma %d trns %d: pixel %u.%d is %g, not %g",
                    k->type, k->depth, k->interlace, k->gamma, k->trns, i, c,
                    (double)im.rgba[4 * i + (uint32_t)c], want[c]);
    }
    image_free(&im);
    free(b.p);
}

static void test_png_of_every_kind(void **state)
{
    (void)state;
    static const int types[][6] = {{PNG_COLOR_TYPE_GRAY, 1, 2, 4, 8, 16},
        {PNG_COLOR_TYPE_RGB, 8, 16}, {PNG_COLOR_TYPE_PALETTE, 1, 2, 4, 8},
        {PNG_COLOR_TYPE_GRAY_ALPHA, 8, 16}, {PNG_COLOR_TYPE_RGB_ALPHA, 8, 16}};
    static const int gammas[] = {0, -1, 100000, 45455, 55556};
    for (size_t t = 0; t < 5; t++)
        for (size_t d = 1; d < 6 && types[t][d]; d++)
            for (size_t g = 0; g < 5; g++)
                for (int variant = 0; variant < 4; variant++) {
                    bool trns = variant & 1 && !(types[t][0] & PNG_COLOR_MASK_ALPHA);
                    check_kind(
                        &(struct kind){types[t][0], types[t][d], variant >> 1, gammas[g], trns});
                }
}

/* ---- Netpbm and float maps -------------------------------------------------------------- */

static struct bytes literal(const char *text, size_t n)
{
    struct bytes b = {malloc(n ? n : 1), n};
    assert_non_null(b.p);
    memcpy(b.p, text, n);
    return b;
}

static void refuse(const char *text, size_t n, const char *why)
{
    char err[IMAGE_ERR] = "";
    struct bytes b = literal(text, n); /* exactly so long: one byte too far is a finding */
    struct image im;
    assert_int_equal(decoded(b, &im, err), -1);
    assert_null(im.rgba);
    if (!strstr(err, why)) fail_msg("\"%s\" does not say \"%s\"", err, why);
    free(b.p);
}
#define REFUSE(text, why) refuse(text, sizeof text - 1, why)

static void accept(const char *text, size_t n, const float want[4])
{
    char err[IMAGE_ERR] = "";
    struct bytes b = literal(text, n);
    struct image im;
    if (decoded(b, &im, err) != 0) fail_msg("%s", err);
    for (int c = 0; c < 4; c++) assert_true(fabsf(im.rgba[c] - want[c]) < 1e-6f);
    image_free(&im);
    free(b.p);
}
#define ACCEPT(text, ...) accept(text, sizeof text - 1, (const float[4]){__VA_ARGS__})

static void test_netpbm(void **state)
{
    (void)state;
    ACCEPT("P6\n# a comment\n1 1\n# another\n255\n\xff\x80\x00", 1, 0.2158605f, 0, 1);
    ACCEPT("P6 1 1 65535\n\xff\xff\x80\x00\x00\x00", 1, 0.50000763f, 0, 1);
    ACCEPT("P5 1 1 1\n\x01", 1, 1, 1, 1);
    ACCEPT("P7\nDEPTH 2\nHEIGHT 1\nMAXVAL 255\nWIDTH 1\nTUPLTYPE GRAYSCALE_ALPHA\nENDHDR\n\xff\x33",
        .2f, .2f, .2f, .2f);
    REFUSE("", "empty");
    REFUSE("P", "no picture format");
    REFUSE("P3\n1 1\n255\n1 1 1\n", "no picture format");
    REFUSE("GIF89a", "no picture format");
    REFUSE("P6", "header");
    REFUSE("P6\n1 1\n255", "header");
    REFUSE("P6\n0 1\n255\n", "header");
    REFUSE("P6\n65536 1\n255\n", "header");
    REFUSE("P6\n1 1\n65536\n\1\1\1", "header");
    REFUSE("P6\n-1 1\n255\n\1\1\1", "header");
    REFUSE("P6\n65535 65535\n255\n\1\1\1", "pixels, expected sides");
    REFUSE("P6\n1 1\n255\n\1\1", "2 bytes of pixels, expected 3");
    REFUSE("P6\n1 1\n255\n\1\1\1\1", "4 bytes of pixels, expected 3");
    REFUSE("P6\n1 1\n7\n\1\1\x08", "above the maximum");
    REFUSE("P7\nWIDTH 1\nHEIGHT 1\nDEPTH 5\nMAXVAL 255\nENDHDR\n12345", "header");
    REFUSE("P7\nWIDTH 1\nHEIGHT 1\nMAXVAL 255\nENDHDR\n123", "header");
    REFUSE("P7\nWIDTH 1\nHEIGHT 1\nDEPTH 3\nMAXVAL 255\n", "header");
}

static void test_float_maps(void **state)
{
    (void)state;
    ACCEPT("PF\n1 1\n-1.0\n\0\0\x80?\0\0\0?\0\0\0\0", 1, .5f, 0, 1);
    ACCEPT("PF\n1 1\n1\n?\x80\0\0?\0\0\0\0\0\0\0", 1, .5f, 0, 1);
    ACCEPT("Pf\n1 2\n-1\n\0\0\0?\0\0\x80?", 1, 1, 1, 1); /* bottom row first */
    REFUSE("PF", "header");
    REFUSE("PF\n1 1\n0\n\0\0\0\0\0\0\0\0\0\0\0\0", "header");
    REFUSE("PF\n1 1\nnan\n\0\0\0\0\0\0\0\0\0\0\0\0", "header");
    REFUSE("PF\n1 1\n-1.0", "header");
    REFUSE("PF\n1 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0", "11 bytes of pixels, expected 12");
    REFUSE("PF\n65535 65535\n-1.0\n", "pixels, expected sides");
}

/* ---- damage ------------------------------------------------------------------------------ */

/* Cut at every byte, and with every byte changed: an answer, no crash, no leak (under the
 * sanitizers). */
static void test_damaged_png(void **state)
{
    (void)state;
    char err[IMAGE_ERR];
    const struct kind kinds[] = {{PNG_COLOR_TYPE_RGB, 8, 0, -1, false},
        {PNG_COLOR_TYPE_PALETTE, 4, 1, 45455, true}, {PNG_COLOR_TYPE_RGB_ALPHA, 16, 1, 0, false}};
    for (size_t k = 0; k < 3; k++) {
        struct bytes b = make_png(&kinds[k]);
        struct image im;
        for (size_t n = 0; n < b.n; n++) refuse(b.p, n, ", expected");
        for (size_t i = 0; i < b.n; i++) {
            b.p[i] ^= 0x55;
            if (decoded(b, &im, err) == 0) image_free(&im);
            else assert_null(im.rgba);
            b.p[i] ^= 0x55;
        }
        free(b.p);
    }
}

/* A header that promises far more than the file can hold is refused before memory is taken. */
static void test_png_bomb(void **state)
{
    (void)state;
    struct bytes b = make_png(&(struct kind){PNG_COLOR_TYPE_RGB, 8, 0, 0, false});
    static const uint32_t sides[][2] = {{16384, 16384}, {65535, 65535}, {70000, 1}, {0, 1}};
    static const char *const why[] = {"too short", "pixels, expected", ", expected", ", expected"};
    for (int s = 0; s < 4; s++) {
        unsigned char *ihdr = (unsigned char *)b.p + 12;
        for (int i = 0; i < 8; i++)
            ihdr[4 + i] = (unsigned char)(sides[s][i / 4] >> (24 - 8 * (i % 4)));
        uint32_t crc = (uint32_t)crc32(crc32(0, NULL, 0), ihdr, 17);
        for (int i = 0; i < 4; i++) ihdr[17 + i] = (unsigned char)(crc >> (24 - 8 * i));
        refuse(b.p, b.n, why[s]);
    }
    free(b.p);
}

static void test_write_errors_are_reported(void **state)
{
    (void)state;
    struct image im;
    fill(&im, 200, 200, 16, false);
    for (int format = IMAGE_PNG; format <= IMAGE_PFM; format++) {
        FILE *f = fopen("/dev/full", "w");
        assert_non_null(f);
        errno = 0;
        int failed = image_write(f, &im, (enum image_format)format, 16, NULL);
        assert_true(failed || fflush(f) != 0);
        assert_int_equal(errno, ENOSPC);
        fclose(f);
    }
    assert_int_equal(image_save("/nonexistent/a.png", &im, IMAGE_PNG, 8, NULL), -1);
    assert_int_equal(errno, ENOENT);
    image_free(&im);
}

/* ---- names ------------------------------------------------------------------------------- */

static void check_name(const char *pattern, uint32_t frame, const char *want)
{
    char *name = image_name(pattern, frame);
    assert_string_equal(name, want);
    free(name);
}

static void test_names(void **state)
{
    (void)state;
    enum image_format f;
    assert_true(image_format_of("a/b.PNG", &f) && f == IMAGE_PNG);
    assert_true(image_format_of("b.pam", &f) && f == IMAGE_PAM);
    assert_true(image_format_of("b.x.pfm", &f) && f == IMAGE_PFM);
    static const char *const no_format[] = {"", ".png", "a/.png", "png", "a.jpg", "a.png/"};
    for (int i = 0; i < 6; i++) assert_false(image_format_of(no_format[i], &f));
    assert_int_equal(image_name_check("a.png"), IMAGE_NAME_SINGLE);
    assert_int_equal(image_name_check("100%%.png"), IMAGE_NAME_SINGLE);
    assert_int_equal(image_name_check("%03d%%.png"), IMAGE_NAME_NUMBERED);
    static const char *const bad[] = {
        "%", "%s.png", "%d%d.png", "%100d", "%ld", "%-3d", "%3", "%n"};
    for (int i = 0; i < 8; i++) assert_int_equal(image_name_check(bad[i]), IMAGE_NAME_BAD);
    check_name("f%03d.png", 7, "f007.png");
    check_name("f%3d.png", 7, "f  7.png");
    check_name("%d-100%%.png", 4294967295u, "4294967295-100%.png");
    check_name("%02d", 12345, "12345");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_encode8_is_nearest),
        cmocka_unit_test(test_rows_encode_the_same),
        cmocka_unit_test(test_round_trips),
        cmocka_unit_test(test_alpha_is_not_premultiplied_in_files),
        cmocka_unit_test(test_png_chunks),
        cmocka_unit_test(test_png_of_every_kind),
        cmocka_unit_test(test_netpbm),
        cmocka_unit_test(test_float_maps),
        cmocka_unit_test(test_damaged_png),
        cmocka_unit_test(test_png_bomb),
        cmocka_unit_test(test_write_errors_are_reported),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
