/* missing: the missing and the repeated pixels of frames. */
#include "image/image.h"

#include <inttypes.h>
#include <string.h>

#define RANGES_MAX 8 /* row ranges listed in full */

static bool row_complete(const struct coverage *c, uint32_t y)
{
    if (!c->bits) return c->done > 0; /* no fragment yet, or released complete */
    for (uint64_t p = (uint64_t)y * c->w, end = p + c->w; p < end; p++)
        if (!coverage_has(c, p)) return false;
    return true;
}

/* The next range of rows first .. last with missing pixels, from `y` on. False if there is none. */
static bool next_range(const struct coverage *c, uint32_t y, uint32_t *first, uint32_t *last)
{
    while (y < c->h && row_complete(c, y)) y++;
    if (y == c->h) return false;
    *first = *last = y;
    while (*last + 1 < c->h && !row_complete(c, *last + 1)) ++*last;
    return true;
}

static void put_ranges(const struct coverage *c, struct buf *b)
{
    uint32_t first, last, n = 0;
    bool more = next_range(c, 0, &first, &last);
    for (; more && n < RANGES_MAX; n++, more = next_range(c, last + 1, &first, &last)) {
        buf_printf(b, "%s%" PRIu32, n ? ", " : "", first);
        if (last > first) buf_printf(b, "-%" PRIu32, last);
    }
    buf_append(b, more ? ", ..." : "", more ? 6 : 1);
}

void assembly_missing_text(const struct assembly_frame *f, char out[ASSEMBLY_TEXT])
{
    const struct coverage *c = &f->have;
    uint64_t all = (uint64_t)c->w * c->h;
    struct buf ranges = {0};
    put_ranges(c, &ranges);
    const char *text = (const char *)buf_data(&ranges);
    snprintf(out, ASSEMBLY_TEXT, "%" PRIu64 " of %" PRIu64 " pixels missing: %s %s", all - c->done,
        all, strpbrk(text, ",-") ? "rows" : "row", text);
    buf_free(&ranges);
}

void assembly_coverage(const struct assembly_frame *f, struct coverage *copy)
{
    if (f->have.bits) {
        coverage_copy(copy, &f->have);
        return;
    }
    coverage_init(copy, f->have.w, f->have.h);
    if (!f->have.done) return;
    for (uint64_t p = 0; p < (uint64_t)copy->w * copy->h; p++) coverage_set(copy, p);
}

uint64_t assembly_again(const struct assembly *a)
{
    uint64_t again = 0;
    for (uint32_t i = 0; i < a->n_frames; i++) again += a->frames[i]->again;
    return again - a->differing;
}
