/*
 * task: the pixel lattice. A task names pixels of one frame; the same six numbers serve rows,
 * tiles, runs that wrap at the row's end, and scattered sets.
 *
 *     pixels p = y*FW + x + i*sx + j*sy*FW,  0 <= i < w, 0 <= j < h,  FW the frame's width
 *
 * Pixel n of a task is (i, j) = (n mod w, n div w); p numbers the frame row by row from 0, top left.
 */
#ifndef STORMRING_TASK_H
#define STORMRING_TASK_H

#include "base/base.h"

#define FRAME_SIDE_MAX 65535 /* pixels: p and counts of pixels fit in 32 bits unsigned */

struct lattice {
    uint32_t x, y, w, h, sx, sy;
};

struct task {
    uint32_t frame, id; /* the key; id counts from 0 in each frame */
    struct lattice at;
    int32_t to; /* preassigned slot, -1 none */
};

static inline uint64_t lattice_count(const struct lattice *l) { return (uint64_t)l->w * l->h; }
static inline uint64_t lattice_pixel(const struct lattice *l, uint32_t frame_w, uint64_t n)
{
    return (uint64_t)(l->y + n / l->w * l->sy) * frame_w + l->x + n % l->w * l->sx;
}
/* Every number in range and every pixel inside a frame of w x h. */
bool lattice_valid(const struct lattice *l, uint32_t frame_w, uint32_t frame_h);
/*
 * The lattice of pixels n0 .. of l, in order, at most `most` (> 0) of them: part of one row, or whole rows.
 * Cutting from 0 by the returned counts visits every pixel once.
 */
struct lattice lattice_cut(const struct lattice *l, uint32_t frame_w, uint64_t n0, uint64_t most);
/* n such that sub is pixels n .. n + count of l as lattice_cut makes them; -1 if it is not. */
int64_t lattice_offset(const struct lattice *l, uint32_t frame_w, const struct lattice *sub);

/* How a frame is cut into tasks. */
enum cut_unit { CUT_ROW, CUT_TILE, CUT_RUN, CUT_SCATTER };
struct cut {
    enum cut_unit unit;
    uint32_t w, h; /* tile: its sides; run: w pixels; scatter: w sets */
};
/* "row", "tile:WxH", "run:N", "scatter" (the caller sets w); false when it is none of them. */
bool cut_parse(const char *s, struct cut *cut);
uint32_t cut_count(const struct cut *cut, uint32_t frame_w, uint32_t frame_h);
/* Task number id (< cut_count) of frame 0, unassigned. */
struct task cut_task(const struct cut *cut, uint32_t frame_w, uint32_t frame_h, uint32_t id);

/* Which pixels of a frame are there. */
struct coverage {
    uint32_t w, h;
    uint64_t done; /* pixels set */
    uint64_t *bits;
};

void coverage_init(struct coverage *c, uint32_t w, uint32_t h);
void coverage_free(struct coverage *c);
static inline bool coverage_has(const struct coverage *c, uint64_t p)
{
    return c->bits[p >> 6] >> (p & 63) & 1;
}
/* True when p was not there before. */
static inline bool coverage_set(struct coverage *c, uint64_t p)
{
    uint64_t bit = UINT64_C(1) << (p & 63), *word = &c->bits[p >> 6];
    if (*word & bit) return false;
    *word |= bit;
    c->done++;
    return true;
}
static inline bool coverage_full(const struct coverage *c)
{
    return c->done == (uint64_t)c->w * c->h;
}
/*
 * The next lattice of pixels that are missing, starting at or after *p; advances *p; false when there are none.
 * Whole and partial rows come as one lattice each, what a scattered worker left as one strided lattice.
 * Calling it until false names each missing pixel once: it marks them in `taken`, a coverage the caller
 * made as a copy of c.
 */
bool coverage_missing(struct coverage *taken, uint64_t *p, struct lattice *out);
void coverage_copy(struct coverage *to, const struct coverage *from);

#endif
