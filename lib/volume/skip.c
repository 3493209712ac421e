/*
 * skip: marks the visible cells. A cell is visible if no corner is missing and, between its lowest
 * and highest corner, the map absorbs or an iso-surface has its value. A trilinear field stays
 * within the range of its corners, so skipped cells are exactly transparent. Threads take layers of
 * blocks.
 */
#include "volume/volume_int.h"

#include <stdlib.h>

/* The range of the values at column i of 4 rows; NaN if a value is missing. */
static void columns(
    const float *at, ptrdiff_t row, ptrdiff_t layer, uint32_t n, float *lo, float *hi)
{
    for (uint32_t i = 0; i < n; i++) {
        float a = at[i], b = at[i + row], c = at[i + layer], d = at[i + row + layer];
        float low = a < b ? a : b, high = a > b ? a : b;
        low = c < low ? c : low, high = c > high ? c : high;
        low = d < low ? d : low, high = d > high ? d : high;
        float missing = (a - a) + (b - b) + (c - c) + (d - d); /* 0 or NaN */
        lo[i] = low + missing;
        hi[i] = high + missing;
    }
}

static bool seen(const struct volume *v, double lo, double hi)
{
    for (size_t i = 0; i < v->spec->n_isos; i++) {
        double s = v->spec->iso[i].s;
        if (lo <= s && s <= hi) return true;
    }
    return map_absorbs(&v->map, lo, hi);
}

struct skip {
    struct volume *v;
    double *range; /* of each layer of blocks: the greatest range of a visible cell */
};

/* Some layers of cells, which one thread marks. */
struct layers {
    struct volume *v;
    size_t first, last; /* bytes of v->live that other threads may write too */
    double range;
};

static void set_live(const struct layers *l, size_t at)
{
    uint8_t *byte = &l->v->live[at >> 3], bit = (uint8_t)(1u << (at & 7));
    if (at >> 3 > l->first && at >> 3 < l->last) *byte |= bit;
    else __atomic_fetch_or(byte, bit, __ATOMIC_RELAXED);
}

/* Marks a row of cells between n columns, starting with cell `at`. */
static void mark(struct layers *l, ptrdiff_t at, const float *lo, const float *hi, uint32_t n)
{
    struct volume *v = l->v;
    int32_t i[3];
    cell_of_index(v, at, i);
    for (uint32_t x = 1; x < n; x++, at++, i[0] += v->stride[0] < 0 ? -1 : 1) {
        if (!(hi[x - 1] + hi[x] < HUGE_VALF)) continue;
        double low = (double)(lo[x - 1] < lo[x] ? lo[x - 1] : lo[x]);
        double high = (double)(hi[x - 1] > hi[x] ? hi[x - 1] : hi[x]);
        if (!seen(v, low, high)) continue;
        l->range = fmax(l->range, high - low);
        set_live(l, (size_t)at);
        v->block[block_index(v, i)] = 1;
    }
}

/* Layer k of blocks, along the view's axis. */
static void mark_layer(void *ctx, uint32_t k)
{
    const struct skip *s = ctx;
    struct volume *v = s->v;
    const uint32_t n = v->cells[0] + 1, cells = v->cells[2];
    uint32_t z = k << BLOCK_SHIFT, end = cells - z < BLOCK ? cells : z + BLOCK;
    if (v->stride[2] < 0) {
        uint32_t begin = cells - end;
        end = cells - z;
        z = begin;
    }
    struct layers l = {
        .v = v, .first = (size_t)(z * v->layer) >> 3, .last = (size_t)(end * v->layer - 1) >> 3};
    float *lo = xmalloc(n, sizeof *lo), *hi = xmalloc(n, sizeof *hi);
    for (; z < end; z++)
        for (ptrdiff_t y = 0; y < (ptrdiff_t)v->cells[1]; y++) {
            const ptrdiff_t first = z * v->layer + y * v->row;
            columns(v->value + first, v->row, v->layer, n, lo, hi);
            mark(&l, first, lo, hi, n);
        }
    free(lo);
    free(hi);
    s->range[k] = l.range;
}

void skip_init(struct volume *v)
{
    size_t n_blocks = 1, n_nodes = 1;
    for (int a = 0; a < 3; a++) {
        v->blocks[a] = ((v->cells[a] - 1) >> BLOCK_SHIFT) + 1;
        n_blocks *= v->blocks[a];
        n_nodes *= v->cells[a] + 1;
    }
    v->live = xcalloc(n_nodes / 8 + 8, 1);
    v->block = xcalloc(n_blocks, 1);
    struct skip s = {v, xcalloc(v->blocks[2], sizeof *s.range)};
    struct parallel *p = parallel_new(v->o.threads);
    parallel_run(p, v->blocks[2], mark_layer, &s);
    parallel_free(p);
    for (uint32_t k = 0; k < v->blocks[2]; k++) v->range = fmax(v->range, s.range[k]);
    free(s.range);
}
