/* picture: the pixels of a task from the picture that a command has drawn. */
#include "crop/crop.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* No picture of this size has more bytes: float RGB or incompressible 16-bit RGBA, and headers. */
static size_t bytes_most(uint32_t w, uint32_t h) { return (size_t)w * h * 16 + (1 << 20); }

/* Appends the file {o}. A device or FIFO might never end. */
static int read_output(const char *path, size_t most, struct buf *bytes, char err[CROP_ERR])
{
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat st;
    const char *odd = NULL;
    if (fd < 0 || fstat(fd, &st) != 0) odd = strerror(errno);
    else if (!S_ISREG(st.st_mode)) odd = "is no regular file";
    ptrdiff_t k = 1;
    while (!odd && k > 0) {
        if ((k = read_some(fd, bytes, 1 << 18)) < 0) odd = strerror(errno);
        else if (buf_size(bytes) > most) odd = "is too long";
    }
    if (fd >= 0) close(fd);
    return odd ? err_set(err, "the file {o}: %s, expected a picture", odd) - 1 : 0;
}

/* Index of the first value of the rectangle that is NaN; `all` if there is none. The picture is the
 * rectangle or the frame. */
static size_t find_nan(const struct crop_rect *at, const struct image *im, size_t all)
{
    const bool whole = im->w != at->w || im->h != at->h;
    for (uint32_t y = 0; y < at->h; y++) {
        const size_t begin = whole ? ((size_t)at->y + y) * im->w + at->x : (size_t)y * im->w;
        for (size_t i = 4 * begin; i < 4 * (begin + at->w); i++)
            if (isnan(im->rgba[i])) return i;
    }
    return all;
}

/* Decodes the bytes, and checks the size and the values. `from` is what they come from. */
static int picture_of(const struct crop_rect *at, const char *from, const struct buf *bytes,
    enum image_deep deep, struct image *picture, char err[CROP_ERR])
{
    const struct image_part part = {at->frame_w, at->frame_h, at->y, at->y + at->h, deep};
    char why[IMAGE_ERR];
    if (image_decode_part(buf_data(bytes), buf_size(bytes), &part, picture, why) != 0) {
        err_set(err, "%s: %s", from, why);
        return -1;
    }
    const uint32_t w = picture->w, h = picture->h;
    const size_t all = (size_t)w * h * 4;
    size_t nan = all;
    const bool fits = (w == at->w && h == at->h) || (w == at->frame_w && h == at->frame_h);
    if (fits && (nan = find_nan(at, picture, all)) == all) return 0;
    image_free(picture);
    if (fits)
        err_set(err, "%s: pixel %zu,%zu is NaN, expected numbers", from, nan / 4 % w, nan / 4 / w);
    else
        err_set(err, "a picture of %ux%u, expected %ux%u or the whole frame, %ux%u", w, h, at->w,
            at->h, at->frame_w, at->frame_h);
    return -1;
}

int crop_draw(const struct crop_command *c, const struct crop_rect *at, struct image *picture,
    char err[CROP_ERR])
{
    char own[4000], path[4096];
    struct buf bytes = {0};
    bool file = crop_uses(c->words, "o");
    /* A new one for each task: something of the last one may be there still. */
    snprintf(own, sizeof own, "%s/task-XXXXXX", c->scratch);
    if (!mkdtemp(own)) return err_set(err, "%s: %s", own, strerror(errno)) - 1;
    /* The suffix makes no difference here; some programs take it for the format. */
    snprintf(path, sizeof path, "%s/out.png", own);
    char **words = crop_words(c->words, at, c->first, path);
    size_t most = bytes_most(at->frame_w, at->frame_h);
    const struct crop_place place = {c->files, c->confined ? own : NULL};
    int failed = crop_run(words, &place, file ? NULL : &bytes, most, err);
    if (!failed && file) failed = read_output(path, most, &bytes, err);
    const char *from = file ? "the file {o}" : "the command's standard output";
    if (!failed) failed = picture_of(at, from, &bytes, c->deep, picture, err);
    crop_remove(own);
    crop_words_free(words);
    buf_free(&bytes);
    return failed;
}

struct crop_rect crop_around(const struct lattice *at, uint32_t frame_w, uint32_t frame_h)
{
    uint32_t left = frame_w, top = frame_h, right = 0, bottom = 0;
    for (uint64_t n = 0, count = lattice_count(at); n < count; n++) {
        uint64_t p = lattice_pixel(at, frame_w, n);
        uint32_t x = (uint32_t)(p % frame_w), y = (uint32_t)(p / frame_w);
        if (x < left) left = x;
        if (x > right) right = x;
        if (y < top) top = y;
        if (y > bottom) bottom = y;
    }
    return (struct crop_rect){0, frame_w, frame_h, left, top, right - left + 1, bottom - top + 1};
}

void crop_pixels(const struct image *picture, const struct crop_rect *rect,
    const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    bool whole = picture->w == rect->frame_w && picture->h == rect->frame_h;
    uint32_t left = whole ? 0 : rect->x, top = whole ? 0 : rect->y;
    for (uint64_t i = n0; i < n0 + n; i++, rgba += 4) {
        uint64_t p = lattice_pixel(at, rect->frame_w, i);
        uint64_t x = p % rect->frame_w - left, y = p / rect->frame_w - top;
        memcpy(rgba, picture->rgba + 4 * (y * picture->w + x), 4 * sizeof *rgba);
    }
}
