/*
 * png_write: writes PNG through libpng. See png_read.c for errors and setjmp: state that must
 * survive a jump is in struct writer, and no local variable is read after one.
 *
 * Encoding is the serial end of every run, so speed counts more than the last percent of size.
 * Milliseconds and kilobytes for 512x512, gears and balls, including quantization (one core, zlib
 * 1.2.13, best of 7):
 *
 *              8 bits: level 1     level 6      16 bits, gears: level 1
 *     none      5.5 143  7.1 233    9.9 119     28.0 1095
 *     sub       6.5 179  7.8 258   17.9 153     17.5  630
 *     up        6.6 163  8.0 265   19.2 135     17.6  615
 *     paeth     7.6 169  9.4 268   19.3 143     21.2  658
 *     adaptive 10.4 166 11.9 265   23.1 140     26.5  650
 */
#include "image/codecs.h"

#include <errno.h>
#include <png.h>
#include <stdlib.h>
#include <zlib.h>

#define FILTER_8 PNG_FILTER_NONE
#define FILTER_16 PNG_FILTER_SUB
#define LEVEL 1

struct writer {
    png_structp png;
    png_infop info;
    FILE *f;
    const struct image_rows *rows;
    const char *job;
    struct quantizer quantizer;
    unsigned char *row;
    int err;
};

static _Noreturn void on_error(png_structp png, png_const_charp text)
{
    (void)text;
    struct writer *w = png_get_error_ptr(png);
    if (!w->err) w->err = EIO;
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text;
}

static void put(png_structp png, png_bytep from, size_t n)
{
    struct writer *w = png_get_io_ptr(png);
    if (fwrite(from, 1, n, w->f) == n) return;
    w->err = errno;
    png_error(png, "write");
}

/* The caller flushes f and checks the result. */
static void flush(png_structp png) { (void)png; }

static void write_header(struct writer *w)
{
    const struct quantizer *q = &w->quantizer;
    png_set_IHDR(w->png, w->info, w->rows->w, w->rows->h, q->bits,
        q->channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
        PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (q->bits == 8) png_set_sRGB(w->png, w->info, PNG_sRGB_INTENT_RELATIVE);
    else png_set_gAMA_fixed(w->png, w->info, PNG_GAMMA_LINEAR);
    if (w->job) {
        char key[] = "Job", *text = xstrdup(w->job);
        png_text chunk = {.compression = PNG_TEXT_COMPRESSION_NONE, .key = key, .text = text};
        png_set_text(w->png, w->info, &chunk, 1); /* copies */
        free(text);
    }
    png_write_info(w->png, w->info);
}

static void put_row(struct writer *w, uint32_t y)
{
    const float *rgba = w->rows->row(w->rows, y);
    if (!rgba) {
        w->err = errno;
        png_error(w->png, "read");
    }
    quantizer_row(&w->quantizer, rgba, w->rows->w, w->row);
    png_write_row(w->png, w->row);
}

static int guarded(struct writer *w)
{
    if (setjmp(png_jmpbuf(w->png))) return -1;
    png_set_write_fn(w->png, w, put, flush);
    png_set_user_limits(w->png, FRAME_SIDE_MAX, FRAME_SIDE_MAX);
    png_set_filter(w->png, PNG_FILTER_TYPE_BASE, w->quantizer.bits == 8 ? FILTER_8 : FILTER_16);
    png_set_compression_level(w->png, LEVEL);
    write_header(w);
    for (uint32_t y = 0; y < w->rows->h; y++) put_row(w, y);
    png_write_end(w->png, NULL);
    return 0;
}

int png_encode(FILE *f, const struct image_rows *rows, int bits, const char *job)
{
    struct writer w = {.f = f, .rows = rows, .job = job};
    quantizer_init(&w.quantizer, rows->opaque, bits);
    w.row = xmalloc(quantizer_row_bytes(&w.quantizer, rows->w), 1);
    w.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &w, on_error, on_warning);
    if (w.png) w.info = png_create_info_struct(w.png);
    if (!w.info) w.err = ENOMEM;
    int failed = w.info ? guarded(&w) : -1;
    png_destroy_write_struct(&w.png, &w.info);
    free(w.row);
    errno = w.err;
    return failed;
}
