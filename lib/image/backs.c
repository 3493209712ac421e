/* backs: pictures that are put over or under a picture while that is written; see image.h. */
#include "image/codecs.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

struct image_back {
    const char *name; /* or a pattern */
    bool numbered;
    struct buf bytes; /* of the file, if numbered: the next one is often equal */
    struct image im;
    bool opaque;
};

static bool is_opaque(const struct image *im)
{
    for (size_t p = 0, n = (size_t)im->w * im->h; p < n; p++)
        if (im->rgba[4 * p + 3] < 1) return false;
    return true;
}

static void put_under(float *top, const float *back, size_t n)
{
    for (; n > 0; n--, top += 4, back += 4) {
        float clear = 1 - top[3];
        if (clear <= 0) continue;
        for (int c = 0; c < 4; c++) top[c] += clear * back[c];
    }
}

static void note(const char *name) { input_add(name, "a backdrop"); }

void image_backs_add(struct image_backs *b, const char *name, bool numbered)
{
    char err[IMAGE_ERR];
    b->back = xrealloc(b->back, (size_t)b->n + 1, sizeof *b->back);
    struct image_back *k = &b->back[b->n++];
    *k = (struct image_back){.name = name, .numbered = numbered};
    if (numbered) image_name_each(name, note);
    else note(name);
    if (numbered) return;
    if (image_read(name, &k->im, err) != 0) die(ST_USAGE, "%s: %s", name, err);
    k->opaque = is_opaque(&k->im);
}

void image_backs_blend(struct image_backs *b, struct image *over)
{
    while (b->n) {
        struct image *im = &b->back[0].im;
        if (im->w != over->w || im->h != over->h) return;
        put_under(over->rgba, im->rgba, (size_t)im->w * im->h);
        image_free(im);
        memmove(b->back, b->back + 1, (size_t)--b->n * sizeof *b->back);
    }
}

void image_opt_back(int opt, const char *name, bool over, struct image_backs *b)
{
    if (image_name_check(name) == IMAGE_NAME_BAD)
        die(ST_USAGE, "-%c %s: bad pattern, expected one %%d or %%03d at most", opt, name);
    image_backs_add(b, name, strchr(name, '%') != NULL);
    if (!over) return;
    struct image_back *first = b->back + b->n_over++, last = b->back[b->n - 1];
    memmove(first + 1, first, (size_t)(b->n - b->n_over) * sizeof *first);
    *first = last;
}

void image_backs_free(struct image_backs *b)
{
    for (int i = 0; i < b->n; i++) {
        image_free(&b->back[i].im);
        buf_free(&b->back[i].bytes);
    }
    free(b->back);
    free(b->line);
    *b = (struct image_backs){.n = 0};
}

/* Reads the file for this picture, unless it has the bytes of the one before. */
static void load(struct image_back *k, uint32_t frame)
{
    char *name = image_name(k->name, frame), err[ERR_BYTES], why[IMAGE_ERR];
    struct buf bytes = {0};
    if (!load_file(name, &bytes, err)) die(ST_USAGE, "%s", err);
    bool same = buf_size(&bytes) == buf_size(&k->bytes) &&
                memcmp(buf_data(&bytes), buf_data(&k->bytes), buf_size(&bytes)) == 0;
    if (!same || !k->im.rgba) {
        image_free(&k->im);
        if (image_decode(buf_data(&bytes), buf_size(&bytes), &k->im, why) != 0)
            die(ST_USAGE, "%s: %s", name, why);
        k->opaque = is_opaque(&k->im);
    }
    buf_free(&k->bytes);
    k->bytes = bytes;
    free(name);
}

static const float *row(const struct image_rows *rows, uint32_t y)
{
    struct image_backs *b = rows->ctx;
    const float *picture = y < b->picture.h ? b->picture.row(&b->picture, y) : NULL;
    if (!picture && y < b->picture.h) return NULL;
    memset(b->line, 0, (size_t)rows->w * 4 * sizeof *b->line);
    for (int i = 0; i < b->n; i++) {
        const struct image *im = &b->back[i].im;
        const uint32_t top = rows->h - im->h;
        if (i == b->n_over && picture) put_under(b->line, picture, rows->w);
        if (y >= top) put_under(b->line, im->rgba + (size_t)(y - top) * im->w * 4, rows->w);
    }
    if (b->n == b->n_over && picture) put_under(b->line, picture, rows->w);
    return b->line;
}

struct image_rows image_backs_under(
    struct image_backs *b, uint32_t frame, const struct image_rows *over)
{
    struct image_rows all = {.w = over->w, .h = over->h, .row = row, .ctx = b};
    if (!b || !b->n) return *over;
    for (int i = 0; i < b->n; i++) {
        struct image_back *k = &b->back[i];
        if (k->numbered) load(k, frame);
        if (k->im.w != over->w)
            die(ST_USAGE,
                "%s has %" PRIu32 "x%" PRIu32 " pixels, expected a width of %" PRIu32
                ", as the picture with it",
                k->name, k->im.w, k->im.h, over->w);
        if (k->im.h > all.h) all.h = k->im.h;
    }
    all.opaque = over->opaque && over->h == all.h;
    for (int i = 0; i < b->n; i++) all.opaque |= b->back[i].opaque && b->back[i].im.h == all.h;
    b->picture = *over;
    b->line = xrealloc(b->line, (size_t)over->w * 4, sizeof *b->line);
    return all;
}
