/* Curves, codecs and names: round trips; damaged files are refused and leak
 * nothing. */
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "image/codecs.h"
#include "scratch.h"

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
    struct quantizer q;
    quantizer_init(&q, true, 8);
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
/* Of a picture of the size of the frame only rows are decoded; of another one, all. */
static void test_parts(void **state)
{
    (void)state;
    const struct image_part part = {.w = 5, .h = 6, .first = 2, .end = 4},
                            other = {.w = 6, .h = 5, .first = 2, .end = 4};
    for (int format = 0; format < 3; format++) {
        struct image im, all, some;
        char err[IMAGE_ERR];
        fill(&im, 5, 6, 8, false);
        struct bytes b = encoded(&im, (enum image_format)format, 8, NULL);
        const unsigned char *p = (const unsigned char *)b.p;
        assert_int_equal(image_decode_part(p, b.n, &other, &all, err), 0);
        assert_int_equal(image_decode_part(p, b.n, &part, &some, err), 0);
        assert_true(some.w == 5 && some.h == 6);
        assert_memory_equal(all.rgba, im.rgba, sizeof(float) * 4 * 5 * 6);
        for (int i = 0; i < 4 * 5 * 6; i++)
            assert_true(some.rgba[i] == (i / 20 == 2 || i / 20 == 3 ? im.rgba[i] : 0));
        image_free(&im);
        image_free(&all);
        image_free(&some);
        free(b.p);
    }
}

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
#define REFUSE(text, why) refuse(text, sizeof(text) - 1, why)

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
#define ACCEPT(text, ...) accept(text, sizeof(text) - 1, (const float[4]){__VA_ARGS__})

static void test_netpbm(void **state)
{
    (void)state;
    ACCEPT("P6\n# a comment\n1 1\n# another\n255\n\xff\x80\x00", 1, 0.2158605f, 0, 1);
    ACCEPT("P6 1 1 65535\n\xff\xff\x80\x00\x00\x00", 1, 0.50000763f, 0, 1);
    ACCEPT("P5 1 1 1\n\x01", 1, 1, 1, 1);
    ACCEPT("P7\nDEPTH 2\nHEIGHT 1\nMAXVAL 255\nWIDTH 1\nTUPLTYPE GRAYSCALE_ALPHA\nENDHDR\n\xff\x33",
        .2f, .2f, .2f, .2f);
    REFUSE("", "empty");
    REFUSE("P", "unknown picture format");
    REFUSE("P3\n1 1\n255\n1 1 1\n", "unknown picture format");
    REFUSE("GIF89a", "unknown picture format");
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
    REFUSE("P7\nHEIGHT 1\nDEPTH 3\nMAXVAL 255\nENDHDR\n123", "header");
    REFUSE("P7\nWIDTH 1\nDEPTH 3\nMAXVAL 255\nENDHDR\n123", "header");
    REFUSE("P7\nWIDTH 1\nHEIGHT 1\nDEPTH 3\nENDHDR\n123", "header");
    REFUSE("P7\nWIDTH 1\nHEIGHT 1\nDEPTH 4\nMAXVAL 255\nTUPLTYPE CMYK\nENDHDR\n1234", "header");
    REFUSE("P7\nWIDTH 65536\nHEIGHT 1\nDEPTH 1\nMAXVAL 255\nENDHDR\n1", "header");
    REFUSE("P7\nWIDTH 1\nHEIGHT 65536\nDEPTH 1\nMAXVAL 255\nENDHDR\n1", "header");
    REFUSE("P7\nWIDTH 1\nHEIGHT 1\nDEPTH 1\nMAXVAL 65536\nENDHDR\n1", "header");
    REFUSE("P7\nWIDTH 1\nHEIGHT 1\nDEPTH 1\nLENGTH 1\nMAXVAL 255\nENDHDR\n1", "header");
    REFUSE("P5 1 65536 255\n1", "header");
    REFUSE("P5 1 1 0\n1", "header");
    /* As many pixels as a picture may have, and a row more. */
    REFUSE("P5 16384 16384 255\n1", "1 bytes of pixels, expected 268435456");
    REFUSE("P5 16384 16385 255\n1", "pixels, expected sides");
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
    REFUSE("PF\n1 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0\0\0", "13 bytes of pixels, expected 12");
    REFUSE("PF\n0 1\n-1.0\n", "header");
    REFUSE("PF\n1 0\n-1.0\n", "header");
    REFUSE("PF\n65536 1\n-1.0\n", "header");
    REFUSE("PF\n1 65536\n-1.0\n", "header");
    REFUSE("PF\n65535 65535\n-1.0\n", "pixels, expected sides");
}

/* libpng would allocate the 2 GB that the chunk after the header declares. */
static void test_chunks_that_do_not_fit(void **state)
{
    (void)state;
    const float white[4] = {1, 1, 1, 1};
    struct image im;
    image_of(&im, white, 1, 1);
    struct bytes file = encoded(&im, IMAGE_PNG, 8, NULL);
    image_free(&im);
    for (size_t n = 8; n < file.n; n++) refuse(file.p, n, "it ends within a chunk");
    memcpy(file.p + 33, "\x7f\xff\xff\xfftEXt", 8);
    refuse(file.p, file.n, "it ends within a chunk");
    memcpy(file.p + 33, "\xff\xff\xff\xfftEXt", 8);
    refuse(file.p, file.n, "it ends within a chunk");
    free(file.p);
}

/* A file as long as the limit is read, a longer one is not. Bytes behind a PNG are left out. */
static void test_files_have_a_limit(void **state)
{
    (void)state;
    char path[SCRATCH_BYTES + 16], dir[SCRATCH_BYTES], err[IMAGE_ERR];
    struct image im;
    struct buf b;
    uint32_t w, h;
    fill(&im, 3, 2, 8, false);
    struct bytes file = encoded(&im, IMAGE_PNG, 8, NULL);
    image_free(&im);
    assert_true(scratch_make(dir));
    snprintf(path, sizeof path, "%s/file", dir);
    int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    assert_true(fd >= 0 && write_full(fd, file.p, file.n) == 0);
    assert_int_equal(image_load_png(path, file.n, &b, &w, &h, err), 0);
    assert_true(w == 3 && h == 2 && buf_size(&b) == file.n);
    buf_free(&b);
    assert_int_equal(image_load_png(path, file.n - 1, &b, &w, &h, err), -1);
    assert_non_null(strstr(err, "bytes, expected a picture"));
    assert_int_equal(write_full(fd, "more", 4), 0);
    assert_int_equal(image_load_png(path, 1000, &b, &w, &h, err), 0);
    assert_int_equal(buf_size(&b), file.n);
    buf_free(&b);
    assert_int_equal(image_read(path, &im, err), -1);
    assert_non_null(strstr(err, "4 bytes behind the PNG"));
    close(fd);
    unlink(path);
    assert_int_equal(rmdir(dir), 0);
    free(file.p);
}

/* ---- errors of writing ---------------------------------------------------------------- */

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

static const float *torn(const struct image_rows *rows, uint32_t y)
{
    if (y != 2) return rows->ctx;
    errno = EIO;
    return NULL;
}

/* A row that cannot be read: no format is written, and no file is left. */
static void test_rows_that_cannot_be_read(void **state)
{
    (void)state;
    static const char *const names[] = {"a.png", "a.pam", "a.pfm"};
    char dir[SCRATCH_BYTES], path[SCRATCH_BYTES + 16];
    float row[4 * 8] = {0};
    const struct image_rows rows = {8, 4, false, torn, row};
    assert_true(scratch_make(dir));
    for (int format = IMAGE_PNG; format <= IMAGE_PFM; format++) {
        snprintf(path, sizeof path, "%s/%s", dir, names[format]);
        errno = 0;
        assert_int_equal(image_save_rows(path, &rows, (enum image_format)format, 8, NULL), -1);
        assert_int_equal(errno, EIO);
    }
    assert_int_equal(rmdir(dir), 0); /* empty */
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

/* Names are made, files written, and what cannot be written is said. */
static void test_out(void **state)
{
    (void)state;
    struct image_out o = {.pattern = "/tmp/stormring-out-%02d.pam", .bits = 8}, std = {.bits = 8};
    struct image im, back;
    char err[IMAGE_ERR];
    image_out_check(&o);
    image_out_check(&std);
    assert_true(o.format == IMAGE_PAM && o.naming == IMAGE_NAME_NUMBERED);
    assert_true(std.format == IMAGE_PNG && std.naming == IMAGE_NAME_SINGLE);
    char *name = image_out_name(&o, 7), *none = image_out_name(&std, 7);
    assert_string_equal(name, "/tmp/stormring-out-07.pam");
    assert_string_equal(none, "standard output");
    image_init(&im, 3, 2);
    for (int i = 0; i < 24; i++) im.rgba[i] = 1;
    const struct image_rows rows = image_rows_of(&im);
    assert_int_equal(image_out_put(&o, 0, name, &rows, NULL), 0);
    assert_int_equal(image_read(name, &back, err), 0);
    assert_true(back.w == 3 && back.h == 2 && back.rgba[23] == 1);
    assert_int_equal(image_out_put(&o, 0, "/nonexistent/x.pam", &rows, NULL), -1);
    unlink(name);
    image_free(&im);
    image_free(&back);
    free(name);
    free(none);
    assert_int_equal(image_opt_bits('k', "8"), 8);
    assert_int_equal(image_opt_bits('k', "16"), 16);
}

static void spills(const char *pattern, const char *chosen, const char *directory)
{
    const struct image_out o = {.pattern = pattern};
    assert_int_equal(chosen ? setenv("TMPDIR", chosen, 1) : unsetenv("TMPDIR"), 0);
    char *dir = image_out_spill(&o, 7);
    assert_string_equal(dir, directory);
    free(dir);
}

static void test_spill(void **state)
{
    (void)state;
    char *before = getenv("TMPDIR") ? xstrdup(getenv("TMPDIR")) : NULL;
    spills("a/b%d.png", "/large", "/large");
    spills("a/b%d.png", "", "a");
    spills("a/b%d.png", NULL, "a");
    spills("a/%d/b.png", NULL, "a/7");
    spills("/b.png", NULL, "/");
    spills("b.png", NULL, ".");
    spills(NULL, "/large", "/large");
    spills(NULL, NULL, "/var/tmp");
    if (before) setenv("TMPDIR", before, 1);
    free(before);
}

/* The file of a pattern is read later. */
static void test_opt_back(void **state)
{
    (void)state;
    struct image_backs backs = {.n = 0};
    image_opt_back('b', "/nonexistent/%03d.png", false, &backs);
    assert_int_equal(backs.n, 1);
    image_backs_free(&backs);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_encode8_is_nearest),
        cmocka_unit_test(test_rows_encode_the_same),
        cmocka_unit_test(test_round_trips),
        cmocka_unit_test(test_parts),
        cmocka_unit_test(test_alpha_is_not_premultiplied_in_files),
        cmocka_unit_test(test_netpbm),
        cmocka_unit_test(test_float_maps),
        cmocka_unit_test(test_chunks_that_do_not_fit),
        cmocka_unit_test(test_files_have_a_limit),
        cmocka_unit_test(test_write_errors_are_reported),
        cmocka_unit_test(test_rows_that_cannot_be_read),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_out),
        cmocka_unit_test(test_spill),
        cmocka_unit_test(test_opt_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
