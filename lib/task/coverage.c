/* The pixels of a frame that are present; the missing ones as tasks. */
#include "task/task.h"

#include <stdlib.h>
#include <string.h>

static size_t words(const struct coverage *c) { return ((uint64_t)c->w * c->h + 63) / 64; }

void coverage_init(struct coverage *c, uint32_t w, uint32_t h)
{
    *c = (struct coverage){.w = w, .h = h};
    c->bits = xcalloc(words(c), sizeof *c->bits);
}

void coverage_free(struct coverage *c)
{
    free(c->bits);
    *c = (struct coverage){0};
}

void coverage_copy(struct coverage *to, const struct coverage *from)
{
    coverage_init(to, from->w, from->h);
    to->done = from->done;
    memcpy(to->bits, from->bits, words(from) * sizeof *from->bits);
}

static uint64_t next_missing(const struct coverage *c, uint64_t p, uint64_t end)
{
    while (p < end) {
        if ((p & 63) == 0 && c->bits[p >> 6] == UINT64_MAX) p += 64;
        else if (coverage_has(c, p)) p++;
        else return p;
    }
    return end;
}

/* Counts missing pixels p, p + stride, ... below end, up to the first that is present. */
static uint64_t missing_run(const struct coverage *c, uint64_t p, uint64_t stride, uint64_t end)
{
    uint64_t n = 0;
    for (; p < end && !coverage_has(c, p); p += stride) n++;
    return n;
}

bool coverage_missing(struct coverage *taken, uint64_t *p, struct lattice *out)
{
    uint64_t pixels = (uint64_t)taken->w * taken->h;
    uint64_t first = next_missing(taken, *p, pixels);
    *p = first;
    if (first == pixels) return false;
    /* If neighbours are missing: the rest of the row. If not, the gap to the next missing pixel
     * is the stride of a scattered set, which continues over the frame. */
    uint64_t second = next_missing(taken, first + 1, pixels);
    uint64_t stride = second < pixels ? second - first : 1;
    uint64_t row_end = (first / taken->w + 1) * taken->w;
    uint64_t n = missing_run(taken, first, stride, stride == 1 ? row_end : pixels);
    *out = (struct lattice){(uint32_t)(first % taken->w), (uint32_t)(first / taken->w), (uint32_t)n,
        1, (uint32_t)stride, 1};
    for (uint64_t i = 0; i < n; i++) coverage_set(taken, first + i * stride);
    return true;
}

bool coverage_trim(const struct coverage *c, struct lattice *at)
{
    uint64_t n = lattice_count(at), first = 0;
    while (first < n && coverage_has(c, lattice_pixel(at, c->w, first))) first++;
    if (first == n) return false;
    if (at->h > 1) first -= first % at->w;
    if (first) *at = lattice_cut(at, c->w, first, n - first);
    return true;
}
