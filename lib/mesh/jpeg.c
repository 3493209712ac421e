/*
 * jpeg: reads untrusted JPEG from memory, through libjpeg. Errors come by longjmp, as in
 * image/png_read.c: what is to be released is in struct reader, which the jump does not touch.
 */
#include "mesh/picture.h"

#include <setjmp.h>
#include <stdlib.h>
/* It needs FILE, which base.h brings. */
#include <jpeglib.h>

#define SCANS_MAX 200 /* of a progressive picture; encoders write about ten */

struct reader {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
    jmp_buf jump;
    unsigned char *row;
    struct image *im;
    char *err;
};

static _Noreturn void refuse(struct reader *r, const char *what)
{
    snprintf(r->err, IMAGE_ERR, "damaged JPEG: %s, expected a whole one", what);
    longjmp(r->jump, 1);
}
static _Noreturn void on_error(j_common_ptr jpeg)
{
    char text[JMSG_LENGTH_MAX];
    jpeg->err->format_message(jpeg, text);
    refuse(jpeg->client_data, text);
}
/* Its warnings are about damage, such as an early end, which it fills with grey. */
static void on_message(j_common_ptr jpeg, int level)
{
    if (level < 0) on_error(jpeg);
}
static void on_progress(j_common_ptr jpeg)
{
    struct reader *r = jpeg->client_data;
    if (r->jpeg.input_scan_number > SCANS_MAX) refuse(r, "more than 200 scans");
}

static void read_all(struct reader *r, const unsigned char *p, size_t n)
{
    struct jpeg_decompress_struct *j = &r->jpeg;
    jpeg_create_decompress(j);
    r->progress.progress_monitor = on_progress;
    j->progress = &r->progress;
    jpeg_mem_src(j, p, (unsigned long)n);
    jpeg_read_header(j, TRUE);
    if ((uint64_t)j->image_width * j->image_height > MESH_PICTURE_PX_MAX)
        refuse(r, "more than 67108864 pixels");
    j->out_color_space = JCS_RGB;
    jpeg_start_decompress(j);
    image_init(r->im, j->output_width, j->output_height);
    r->row = xmalloc(j->output_width, 3);
    while (j->output_scanline < j->output_height) {
        float *out = r->im->rgba + (size_t)4 * j->output_width * j->output_scanline;
        jpeg_read_scanlines(j, &r->row, 1);
        for (size_t x = 0; x < j->output_width; x++) {
            for (size_t c = 0; c < 3; c++) out[4 * x + c] = srgb_decode8(r->row[3 * x + c]);
            out[4 * x + 3] = 1;
        }
    }
    jpeg_finish_decompress(j);
}

static bool attempt(struct reader *r, const unsigned char *p, size_t n)
{
    if (setjmp(r->jump)) return false;
    read_all(r, p, n);
    return true;
}

bool mesh_jpeg_decode(const unsigned char *p, size_t n, struct image *im, char err[IMAGE_ERR])
{
    struct reader *r = xcalloc(1, sizeof *r);
    *im = (struct image){0};
    r->im = im, r->err = err;
    r->jpeg.err = jpeg_std_error(&r->errors);
    r->errors.error_exit = on_error;
    r->errors.emit_message = on_message;
    r->jpeg.client_data = r;
    const bool ok = attempt(r, p, n);
    if (!ok) image_free(im);
    jpeg_destroy_decompress(&r->jpeg);
    free(r->row);
    free(r);
    return ok;
}
