/*
 * PNG: what is written holds what it should and nothing that varies; files of every kind mean what
 * they should; damage is refused and leaks nothing.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <png.h>
#include <zlib.h>

#include "image/codecs.h"

struct bytes {
    char *p;
    size_t n;
};

static struct bytes encoded(const struct image *im, int bits, const char *job)
{
    struct bytes b = {0};
    FILE *f = open_memstream(&b.p, &b.n);
    assert_non_null(f);
    assert_int_equal(image_write(f, im, IMAGE_PNG, bits, job), 0);
    fclose(f);
    return b;
}

static int decoded(struct bytes b, struct image *im, char err[IMAGE_ERR])
{
    return image_decode((const unsigned char *)b.p, b.n, im, err);
}

static void refuse(const char *p, size_t n, const char *why)
{
    char err[IMAGE_ERR] = "";
    struct bytes b = {malloc(n ? n : 1), n}; /* exactly so long: one byte too far is a finding */
    assert_non_null(b.p);
    memcpy(b.p, p, n);
    struct image im;
    assert_int_equal(decoded(b, &im, err), -1);
    assert_null(im.rgba);
    if (!strstr(err, why)) fail_msg("\"%s\" does not say \"%s\"", err, why);
    free(b.p);
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
    image_init(&im, 4, 4);
    for (size_t i = 0; i < 16; i++) im.rgba[4 * i + 3] = 1;
    struct bytes a = encoded(&im, 8, "cafe"), b = encoded(&im, 16, NULL);
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
    struct bytes again = encoded(&im, 8, "cafe");
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
    int colours; /* of the palette; 0: one for each index */
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
    struct bytes b = {0};
    FILE *f = open_memstream(&b.p, &b.n);
    assert_non_null(f);
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
    if (k->type == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette, k->colours ? k->colours : 1 << k->depth);
    if (k->trns) png_set_tRNS(png, info, alphas, 1 << k->depth, &key);
    if (k->gamma > 0) png_set_gAMA_fixed(png, info, k->gamma);
    if (k->gamma < 0) png_set_sRGB(png, info, 0);
    png_set_check_for_invalid_index(png, -1);
    png_write_info(png, info);
    unsigned char rows[4][64], *at[4];
    for (uint32_t y = 0; y < 4; y++) pack_row(k, y, at[y] = rows[y]);
    png_write_image(png, at);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(f);
    return b;
}

static double srgb_light(double v)
{
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

/* What sample v of `max` means, by the rules of image.h. */
static double light(const struct kind *k, uint32_t v, uint32_t max)
{
    double x = (double)v / max;
    bool srgb = k->gamma < 0 || (k->depth < 16 && k->gamma == 0);
    if (srgb) return srgb_light(x);
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
                        &(struct kind){types[t][0], types[t][d], variant >> 1, gammas[g], trns, 0});
                }
}

/* ---- damage ------------------------------------------------------------------------------ */

/* Cut at every byte, and with every byte changed: it is refused. */
static void test_damaged_png(void **state)
{
    (void)state;
    char err[IMAGE_ERR];
    const struct kind kinds[] = {{PNG_COLOR_TYPE_RGB, 8, 0, -1, false, 0},
        {PNG_COLOR_TYPE_PALETTE, 4, 1, 45455, true, 0},
        {PNG_COLOR_TYPE_RGB_ALPHA, 16, 1, 0, false, 0}};
    for (size_t k = 0; k < 3; k++) {
        struct bytes b = make_png(&kinds[k]);
        struct image im;
        for (size_t n = 0; n < b.n; n++) refuse(b.p, n, ", expected");
        for (size_t i = 0; i < b.n; i++) {
            b.p[i] ^= 0x55;
            if (decoded(b, &im, err) == 0) fail_msg("kind %zu: byte %zu was changed", k, i);
            assert_null(im.rgba);
            b.p[i] ^= 0x55;
        }
        free(b.p);
    }
}

#define BEHIND_IHDR 33U
/* Puts a chunk of at most 5 bytes at a place. */
static void insert_at(struct bytes *b, size_t place, const char *name, const char *data, unsigned n)
{
    unsigned char chunk[17] = {0, 0, 0, (unsigned char)n};
    memcpy(chunk + 4, name, 4);
    memcpy(chunk + 8, data, n);
    png_save_uint_32(chunk + 8 + n, (png_uint_32)crc32(0, chunk + 4, 4 + n));
    b->p = realloc(b->p, b->n + sizeof chunk);
    assert_non_null(b->p);
    memmove(b->p + place + 12 + n, b->p + place, b->n - place);
    memcpy(b->p + place, chunk, 12 + n);
    b->n += 12 + n;
}

static void insert(struct bytes *b, const char *name, const char *data, unsigned n)
{
    insert_at(b, BEHIND_IHDR, name, data, n);
}

/* A cICP goes before other chunks. */
static void test_curve_by_code(void **state)
{
    (void)state;
    static const struct {
        int stated, meant;
        const char *code;
    } table[] = {{-1, 100000, "\1\10\0\1"}, {100000, -1, "\1\15\0\1"}, {0, -1, "\14\15\0\1"}};
    for (int depth = 8; depth <= 16; depth += 8)
        for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
            struct kind k = {PNG_COLOR_TYPE_RGB, depth, 0, table[i].meant, false, 0};
            struct bytes meant = make_png(&k);
            k.gamma = table[i].stated;
            struct bytes b = make_png(&k);
            insert(&b, "cICP", table[i].code, 4);
            struct image x, y;
            char err[IMAGE_ERR];
            assert_int_equal(decoded(meant, &x, err), 0);
            assert_int_equal(decoded(b, &y, err), 0);
            assert_memory_equal(x.rgba, y.rgba, (size_t)x.w * x.h * 4 * sizeof *x.rgba);
            image_free(&x);
            image_free(&y);
            free(meant.p);
            free(b.p);
        }
}

/* What libpng leaves out, or makes black: it would change the light of samples. */
static void test_statements_that_libpng_leaves_out(void **state)
{
    (void)state;
    for (int interlace = 0; interlace < 2; interlace++)
        for (int depth = 2; depth <= 8; depth *= 2) { /* the samples have every index of 2 bits */
            struct bytes b =
                make_png(&(struct kind){PNG_COLOR_TYPE_PALETTE, depth, interlace, 0, false, 3});
            refuse(b.p, b.n, "a pixel whose colour is not in the palette");
            free(b.p);
        }
    static const struct {
        const char *name, *data;
        unsigned n;
        const char *why;
    } bad[] = {{"gAMA", "\0\0\0\0", 4, "gAMA"}, {"gAMA", "\x80\0\0\0", 4, "gAMA"},
        {"gAMA", "\0\x01\x86", 3, "gAMA"}, {"tRNS", "\1\2\3\4\5", 5, "tRNS"},
        {"cICP", "\11\20\0\1", 4, "cICP"}, {"cICP", "\1\15\0\0", 4, "cICP"},
        {"cICP", "\1\15\1\1", 4, "cICP"}, {"iCCP", "x\0\0\0\0", 5, "profile"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const char first = bad[i].name[0];
        struct bytes b = make_png(&(struct kind){PNG_COLOR_TYPE_RGB, first == 'i' ? 16 : 8, 0,
            first == 'g' || first == 'i' ? 0 : 100000, false, 0});
        insert(&b, bad[i].name, bad[i].data, bad[i].n);
        refuse(b.p, b.n, bad[i].why);
        free(b.p);
    }
}

/* Chunks that state the curve stand before the pixels, and a cICP does not contradict another. */
static void test_statements_out_of_place(void **state)
{
    (void)state;
    static const char *const late[] = {"gAMA", "sRGB", "cICP", "iCCP"};
    for (size_t i = 0; i < sizeof late / sizeof *late; i++) {
        struct bytes b = make_png(&(struct kind){PNG_COLOR_TYPE_RGB, 8, 0, 0, false, 0});
        insert_at(&b, b.n - 12, late[i], "\0\1\x86\xa0", 4);
        refuse(b.p, b.n, "behind its pixels");
        free(b.p);
    }
    struct bytes b = make_png(&(struct kind){PNG_COLOR_TYPE_RGB, 8, 0, 0, false, 0});
    insert(&b, "cICP", "\1\15\0\1", 4);
    insert(&b, "cICP", "\1\10\0\1", 4);
    refuse(b.p, b.n, "cICP");
    free(b.p);
}

/* What libpng leaves out without a loss: a tRNS where pixels have alpha, and a gAMA said twice. */
static void test_statements_without_a_meaning(void **state)
{
    (void)state;
    static const unsigned char gamma[] = "\0\0\0\4gAMA\0\1\x86\xa0\x31\xe8\x96\x5f",
                               clear[] = "\0\0\0\1tRNS\7\xee\x7d\x5c\xb3";
    struct image im;
    char err[IMAGE_ERR];
    for (int i = 0; i < 2; i++) {
        struct bytes b = make_png(&(struct kind){
            i ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, 8, 0, i ? 0 : 100000, false, 0});
        unsigned char chunk[16];
        const size_t n = i ? 13 : 16, place = 33;
        memcpy(chunk, i ? clear : gamma, n);
        png_save_uint_32(chunk + n - 4, (png_uint_32)crc32(0, chunk + 4, (unsigned)n - 8));
        b.p = realloc(b.p, b.n + n);
        assert_non_null(b.p);
        memmove(b.p + place + n, b.p + place, b.n - place);
        memcpy(b.p + place, chunk, n);
        b.n += n;
        if (decoded(b, &im, err) != 0) fail_msg("%s", err);
        image_free(&im);
        free(b.p);
    }
}

/* Decodes pixel 1, a grey one, for a caller with this rule; below 0: it is refused, and says so. */
static double grey(struct bytes b, enum image_deep deep)
{
    char err[IMAGE_ERR] = "";
    struct image im;
    const struct image_part part = {.deep = deep};
    if (image_decode_part((const unsigned char *)b.p, b.n, &part, &im, err) == 0) {
        double v = (double)im.rgba[4];
        image_free(&im);
        return v;
    }
    assert_non_null(strstr(err, "16 bits that do not state their curve, expected option -g"));
    assert_null(im.rgba);
    return -1;
}

static void assert_near(double a, double b) { assert_true(fabs(a - b) < 1e-6); }

/* A caller may know what 16 bits hold if the file does not state it, or refuse them. */
static void test_unstated_curves(void **state)
{
    (void)state;
    static const int gammas[] = {0, -1, 100000, 45455};
    for (int depth = 8; depth <= 16; depth += 8)
        for (size_t g = 0; g < 4; g++) {
            const struct kind k = {PNG_COLOR_TYPE_GRAY, depth, 0, gammas[g], false, 0};
            struct bytes b = make_png(&k);
            const uint32_t v = sample(&k, 1, 0), max = (1u << depth) - 1;
            const bool open = depth == 16 && k.gamma == 0;
            const double stated = light(&k, v, max), srgb = srgb_light((double)v / max);
            assert_near(grey(b, IMAGE_DEEP_LINEAR), stated);
            assert_near(grey(b, IMAGE_DEEP_SRGB), open ? srgb : stated);
            assert_near(grey(b, IMAGE_DEEP_REFUSED), open ? -1 : stated);
            free(b.p);
        }
    char deep[] = "P5 2 1 65535\n\0\0\x80\0", low[] = "P5 2 1 255\n\0\x80";
    const struct bytes d = {deep, sizeof deep - 1}, l = {low, sizeof low - 1};
    assert_near(grey(d, IMAGE_DEEP_LINEAR), 32768. / 65535);
    assert_near(grey(d, IMAGE_DEEP_SRGB), srgb_light(32768. / 65535));
    assert_near(grey(d, IMAGE_DEEP_REFUSED), -1);
    assert_near(grey(l, IMAGE_DEEP_REFUSED), srgb_light(128. / 255));
}

/* png_inspect of a copy: it may look at no byte behind. */
static int inspected(const char *p, size_t *n, const char *why)
{
    char err[IMAGE_ERR] = "";
    uint32_t w = 0, h = 0;
    unsigned char *copy = malloc(*n + 1);
    assert_non_null(copy);
    memcpy(copy, p, *n);
    int failed = png_inspect(copy, n, &w, &h, err);
    if (failed && !strstr(err, why)) fail_msg("\"%s\" does not say \"%s\"", err, why);
    assert_true(failed || (w == 5 && h == 4));
    free(copy);
    return failed;
}

/* A header that promises far more than the file can hold is refused before memory is taken. */
static void test_png_bomb(void **state)
{
    (void)state;
    struct bytes b = make_png(&(struct kind){PNG_COLOR_TYPE_RGB, 8, 0, 0, false, 0});
    static const uint32_t sides[][2] = {
        {400, 400}, {16384, 16384}, {65535, 65535}, {70000, 1}, {0, 1}};
    static const char *const why[] = {
        "too short", "too short", "pixels, expected", ", expected", ", expected"};
    for (int s = 0; s < 5; s++) {
        unsigned char *ihdr = (unsigned char *)b.p + 12;
        for (int i = 0; i < 8; i++)
            ihdr[4 + i] = (unsigned char)(sides[s][i / 4] >> (24 - 8 * (i % 4)));
        uint32_t crc = (uint32_t)crc32(crc32(0, NULL, 0), ihdr, 17);
        for (int i = 0; i < 4; i++) ihdr[17 + i] = (unsigned char)(crc >> (24 - 8 * i));
        refuse(b.p, b.n, why[s]);
        if (s >= 3) assert_int_equal(inspected(b.p, &(size_t){b.n}, ", expected"), -1);
    }
    free(b.p);
}

/* Pages that hold PNGs look at all of their bytes, and at no pixel. */
static void test_png_inspect(void **state)
{
    (void)state;
    static const char ppm[] = "P6 1 1 255\n123";
    struct bytes b = make_png(&(struct kind){PNG_COLOR_TYPE_RGB, 8, 0, -1, false, 0});
    size_t n = b.n + 5, whole = b.n;
    char *longer = calloc(1, n);
    assert_non_null(longer);
    memcpy(longer, b.p, b.n);
    assert_int_equal(inspected(longer, &n, ""), 0);
    assert_int_equal(n, whole); /* what is behind does not count */
    free(longer);
    for (n = 0; n < whole; n++) assert_int_equal(inspected(b.p, &(size_t){n}, ", expected"), -1);
    for (size_t i = 0; i < whole; i++) {
        b.p[i] ^= 0x55;
        if (inspected(b.p, &(size_t){whole}, ", expected") == 0)
            fail_msg("byte %zu was changed", i);
        b.p[i] ^= 0x55;
    }
    b.p[whole - 13] ^= 1; /* the sum of the pixels */
    assert_int_equal(inspected(b.p, &(size_t){whole}, "the sum of a chunk is wrong"), -1);
    assert_int_equal(inspected(ppm, &(size_t){sizeof ppm - 1}, "not a PNG"), -1);
    free(b.p);
}

/* Black pixels: few bytes of file hold many. */
static void test_png_of_few_bytes(void **state)
{
    (void)state;
    char err[IMAGE_ERR] = "";
    struct image im;
    image_init(&im, 400, 400);
    for (size_t i = 0; i < 400 * 400; i++) im.rgba[4 * i + 3] = 1;
    struct bytes b = encoded(&im, 8, NULL);
    image_free(&im);
    assert_true(b.n * 100 < 3 * 400 * 400);
    assert_int_equal(decoded(b, &im, err), 0);
    image_free(&im);
    free(b.p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_png_chunks),
        cmocka_unit_test(test_png_of_every_kind),
        cmocka_unit_test(test_damaged_png),
        cmocka_unit_test(test_curve_by_code),
        cmocka_unit_test(test_statements_that_libpng_leaves_out),
        cmocka_unit_test(test_statements_out_of_place),
        cmocka_unit_test(test_statements_without_a_meaning),
        cmocka_unit_test(test_unstated_curves),
        cmocka_unit_test(test_png_bomb),
        cmocka_unit_test(test_png_inspect),
        cmocka_unit_test(test_png_of_few_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
