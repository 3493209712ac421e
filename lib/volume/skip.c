/*
 * skip: marks the visible cells. A cell is visible if no corner is missing and the map absorbs
 * between its lowest and highest corner, or an iso-surface has its value there, or it touches a
 * slice. A trilinear field stays within the range of its corners, so skipped cells are exactly
 * transparent. The overlap of a brick is visible only if there are sheets. Threads take layers of
 * blocks.
 */
#define SIMD_MOST 16 /* bytes: a vector is no wider than a block */
#include "simd/simd.h"
#include "volume/volume_int.h"

#include <stdlib.h>

/* Values that are seen, as floats: a cell is visible if it has one of from .. to. */
struct seen {
    float from, to;
};

struct skip {
    struct volume *v;
    struct seen *seen;
    uint32_t n_seen;
    double *range; /* of each layer of blocks: the greatest range of a visible cell */
};

/* The least float that is not below x, and the greatest that is not above. */
static float float_above(double x)
{
    float f = (float)x;
    return (double)f < x ? nextafterf(f, HUGE_VALF) : f;
}
static float float_below(double x) { return -float_above(-x); }

static void find_seen(struct skip *s)
{
    const struct map *m = &s->v->map;
    const struct spec *spec = s->v->spec;
    s->seen = xcalloc(m->n + spec->n_isos + 1, sizeof *s->seen);
    for (uint32_t i = 0; i < m->n; i++) {
        const struct map_span *p = &m->span[i];
        if (p->transparent) continue;
        if (i > 0 && !p[-1].transparent) s->seen[s->n_seen - 1].to = float_below(p->hi);
        else s->seen[s->n_seen++] = (struct seen){float_above(p->lo), float_below(p->hi)};
    }
    for (size_t i = 0; i < spec->n_isos; i++)
        s->seen[s->n_seen++] =
            (struct seen){float_above(spec->iso[i].s), float_below(spec->iso[i].s)};
}

/* The ranges of the values at VF columns of 4 rows; NaN if a value is missing. */
SIMD_INLINE void column(vf a, vf b, vf c, vf d, vf *lo, vf *hi)
{
    vf missing = a * 0 + b * 0 + c * 0 + d * 0; /* 0 or NaN */
    *lo = vf_min(vf_min(a, b), vf_min(c, d)) + missing;
    *hi = vf_max(vf_max(a, b), vf_max(c, d)) + missing;
}
static void columns(
    const float *at, ptrdiff_t row, ptrdiff_t layer, uint32_t n, float *lo, float *hi)
{
    const float *p[4] = {at, at + row, at + layer, at + row + layer};
    vf low, high;
    uint32_t i = 0;
    for (; i + VF <= n; i += VF) {
        column(vf_load(p[0] + i), vf_load(p[1] + i), vf_load(p[2] + i), vf_load(p[3] + i), &low,
            &high);
        vf_store(lo + i, low);
        vf_store(hi + i, high);
    }
    for (; i < n; i++) { /* not beyond the grid */
        column(vf_set(p[0][i]), vf_set(p[1][i]), vf_set(p[2][i]), vf_set(p[3][i]), &low, &high);
        lo[i] = low[0];
        hi[i] = high[0];
    }
}

/* Some layers of cells, which one thread marks. */
struct layers {
    const struct skip *skip;
    struct volume *v;
    size_t first, last; /* bytes of v->live that other threads may write too */
    vf range;
};

static void set_live(const struct layers *l, size_t byte, unsigned bits)
{
    if (byte > l->first && byte < l->last) l->v->live[byte] |= (uint8_t)bits;
    else if (bits) __atomic_fetch_or(&l->v->live[byte], (uint8_t)bits, __ATOMIC_RELAXED);
}

/* Marks those of `mask` of the cells `at`, at + 1, ... in memory. i: the first of them. */
static void set_cells(struct layers *l, size_t at, int32_t x, const int32_t i[3], unsigned mask)
{
    struct volume *v = l->v;
    const int step = v->stride[0] < 0 ? -1 : 1;
    const int32_t ends[2] = {__builtin_ctz(mask), 31 - __builtin_clz(mask)};
    for (unsigned bits = mask << (at & 7), byte = 0; bits >> 8 * byte; byte++)
        set_live(l, (at >> 3) + byte, bits >> 8 * byte & 255);
    for (int k = 0; k < 2; k++) /* VF <= BLOCK: they are in one block or two */
        v->block[block_index(v, (const int32_t[3]){i[0] + step * (x + ends[k]), i[1], i[2]})] = 1;
}

/* Narrows a row of cells to those that may be visible: all if there are sheets, or else those of
 * the brick itself. False if none are. i: the first of them; x, n: columns. */
static bool owned(const struct volume *v, const int32_t i[3], uint32_t *x, uint32_t *n)
{
    if (!v->brick || volume_has_sheets(v)) return true;
    const bool turned = v->stride[0] < 0;
    const uint32_t *own = v->own[0];
    *x = turned ? v->cells[0] - own[1] : own[0];
    *n = 1 + (turned ? v->cells[0] - own[0] : own[1]);
    return volume_owns(v, (const int32_t[3]){(int32_t)own[0], i[1], i[2]});
}

/* Which of the cells x, x + 1, ... of a row touch a slice? i: the first cell of the row. */
static unsigned sliced(const struct volume *v, const int32_t i[3], uint32_t x, uint32_t n)
{
    unsigned mask = 0;
    for (uint32_t k = 0; k < VF && x + k + 1 < n; k++) {
        const int32_t step = (int32_t)(x + k);
        const int32_t of[3] = {v->stride[0] < 0 ? i[0] - step : i[0] + step, i[1], i[2]};
        mask |= (unsigned)volume_is_sliced(v, of) << k;
    }
    return mask;
}

/* Marks a row of cells between n columns, starting with cell `at`. */
static void mark(struct layers *l, ptrdiff_t at, const float *lo, const float *hi, uint32_t n)
{
    _Static_assert(VF <= BLOCK, "see set_cells");
    int32_t i[3];
    cell_of_index(l->v, at, i);
    uint32_t x = 0;
    if (!owned(l->v, i, &x, &n)) return;
    for (; x + 1 < n; x += VF) {
        vf high = vf_max(vf_load(hi + x), vf_load(hi + x + 1));
        vf low = vf_min(vf_load(lo + x), vf_load(lo + x + 1));
        vi whole = vf_load(hi + x) + vf_load(hi + x + 1) < vf_set(HUGE_VALF), visible = {0};
        for (uint32_t k = 0; k < l->skip->n_seen; k++)
            visible |=
                (high >= vf_set(l->skip->seen[k].from)) & (low <= vf_set(l->skip->seen[k].to));
        visible &= whole;
        for (uint32_t k = n - 1 - x; k < VF; k++) visible[k] = 0; /* beyond the row */
        unsigned mask = vi_signs(visible);
        if (l->v->n_slices) mask |= vi_signs(whole) & sliced(l->v, i, x, n);
        if (n - 1 - x < VF) mask &= (1u << (n - 1 - x)) - 1;
        if (!mask) continue;
        l->range = vf_max(l->range, vf_choose(visible, high - low, vf_set(0)));
        set_cells(l, (size_t)at + x, (int32_t)x, i, mask);
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
    struct layers l = {.skip = s,
        .v = v,
        .first = (size_t)(z * v->layer) >> 3,
        .last = (size_t)(end * v->layer - 1) >> 3};
    float *lo = xcalloc(n + VF, sizeof *lo), *hi = xcalloc(n + VF, sizeof *hi);
    for (; z < end; z++)
        for (ptrdiff_t y = 0; y < (ptrdiff_t)v->cells[1]; y++) {
            const ptrdiff_t first = z * v->layer + y * v->row;
            columns(v->value + first, v->row, v->layer, n, lo, hi);
            mark(&l, first, lo, hi, n);
        }
    free(lo);
    free(hi);
    for (int i = 0; i < VF; i++) /* with fmax, gcc 12 for aarch64 ends in an internal error */
        if ((double)l.range[i] > s->range[k]) s->range[k] = (double)l.range[i];
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
    struct skip s = {.v = v, .range = xcalloc(v->blocks[2], sizeof *s.range)};
    find_seen(&s);
    struct parallel *p = parallel_new(v->o.threads);
    parallel_run(p, v->blocks[2], mark_layer, &s);
    parallel_free(p);
    for (uint32_t k = 0; k < v->blocks[2]; k++) v->range = fmax(v->range, s.range[k]);
    free(s.range);
    free(s.seen);
}
