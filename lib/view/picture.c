/* A small PNG of the first picture of a log, which may be incomplete: see view.h. */
#include "image/image.h"
#include "log/log.h"
#include "view/view.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#define SIDE_MOST 1024

static void take(void *ctx, const struct record *r)
{
    struct intake *in = ctx;
    if (r->kind == REC_FRAME) intake_frame(in, r);
    else if (!in->parts.n_frames || r->task.frame == in->parts.frames[0]->number)
        intake_record(in, r);
}

static void encode(const struct image *im, const char *job, struct buf *png)
{
    char *bytes = NULL;
    size_t n = 0;
    FILE *f = open_memstream(&bytes, &n);
    if (!f) die(ST_SYSTEM, "a buffer for the picture:");
    if (image_write(f, im, IMAGE_PNG, 8, job) != 0 || fclose(f) != 0)
        die(ST_SYSTEM, "a buffer for the picture:");
    buf_append(png, bytes, n);
    free(bytes);
}

void view_picture(const char *path, struct buf *png)
{
    struct intake in = {0};
    const struct log_reader reader = {.record = take, .ctx = &in};
    char *dir = image_out_spill(&(struct image_out){0}, 0);
    intake_init(&in, true);
    in.parts.spill.dir = dir;
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    bool gone = fd < 0 && errno == ENOENT; /* since it was read */
    if (!gone && (fd < 0 || log_read(&in, fd, path, &reader) < 0)) die(ST_SYSTEM, "%s:", path);
    if (!gone) close(fd);
    errno = in.parts.error;
    if (errno)
        die(ST_SYSTEM, "%s: cannot keep the pixels, expected TMPDIR to name a directory:", dir);
    const struct assembly_frame *f = in.parts.n_frames ? in.parts.frames[0] : NULL;
    if (f && f->pixels) {
        struct image small;
        if (!assembly_small(f, SIDE_MOST, &small)) die(ST_SYSTEM, "the pixels of the picture:");
        encode(&small, f->job, png);
        image_free(&small);
    }
    intake_free(&in);
    free(dir);
}
