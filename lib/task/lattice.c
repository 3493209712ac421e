/* Geometry of the pixel lattice: validity, cutting in order, and finding a piece again. */
#include "task/task.h"

bool lattice_valid(const struct lattice *l, uint32_t frame_w, uint32_t frame_h)
{
    if (!frame_w || !frame_h || frame_w > FRAME_SIDE_MAX || frame_h > FRAME_SIDE_MAX) return false;
    uint64_t pixels = (uint64_t)frame_w * frame_h;
    if (l->x >= frame_w || l->y >= frame_h || !l->w || !l->h || !l->sx || !l->sy) return false;
    /* Each factor first, so that the sum below cannot overflow. */
    if (l->w > pixels || l->h > frame_h || l->sx > pixels || l->sy > frame_h) return false;
    uint64_t last = (uint64_t)l->y * frame_w + l->x + (uint64_t)(l->w - 1) * l->sx +
                    (uint64_t)(l->h - 1) * l->sy * frame_w;
    return last < pixels && lattice_count(l) <= pixels;
}

struct lattice lattice_cut(const struct lattice *l, uint32_t frame_w, uint64_t n0, uint64_t most)
{
    uint64_t i = n0 % l->w, j = n0 / l->w;
    uint64_t start = lattice_pixel(l, frame_w, n0);
    struct lattice out = *l;
    out.x = (uint32_t)(start % frame_w);
    out.y = (uint32_t)(start / frame_w);
    if (i || most < l->w) {
        uint64_t rest = l->w - i;
        out.w = (uint32_t)(most < rest ? most : rest);
        out.h = 1;
    } else {
        uint64_t rows = most / l->w, left = l->h - j;
        out.h = (uint32_t)(rows < left ? rows : left);
    }
    return out;
}

int64_t lattice_offset(const struct lattice *l, uint32_t frame_w, const struct lattice *sub)
{
    if (sub->sx != l->sx || sub->sy != l->sy) return -1;
    int64_t first = (int64_t)l->y * frame_w + l->x;
    int64_t delta = (int64_t)sub->y * frame_w + sub->x - first;
    if (delta < 0) return -1;
    /* The candidate rows: the step between rows may be less than a row is long (runs that wrap). */
    int64_t step = (int64_t)l->sy * frame_w;
    int64_t j = delta / step;
    for (; j >= 0; j--) {
        int64_t rest = delta - j * step;
        if (rest / l->sx >= l->w) return -1;
        if (rest % l->sx) continue;
        int64_t n0 = j * (int64_t)l->w + rest / l->sx;
        struct lattice cut = lattice_cut(l, frame_w, (uint64_t)n0, lattice_count(sub));
        if (j < l->h && cut.w == sub->w && cut.h == sub->h) return n0;
    }
    return -1;
}
