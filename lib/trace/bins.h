/*
 * bins: references in bins along three axes, the best plane between two bins, and the partition by
 * that plane. Private to sah.c.
 */
#ifndef STORMRING_BINS_H
#define STORMRING_BINS_H

#define SIMD_MOST 16 /* a vector is a bound of a box */
#include "simd/simd.h"
#include "trace/sah.h"

#include <float.h>

#define BLOCK_BITS 2 /* LANES is 4 */
#define BINS 16
/* For at most SOME refs: clearing and sweeping the bins takes most of the time there. */
#define BINS_SOME 8
#define SOME 64
#define SAMPLE 2048 /* refs are enough to choose a plane */
#define STEP_MOST 15
#define TWICE 256 /* refs that are worth two sets of bins */

struct vbox {
    vf lo, hi;
};

struct bounds {
    struct vbox box, centres;
};

struct bins {
    struct vbox box[3][BINS];
    _Alignas(16) int32_t count[BINS][4]; /* by axis; the fourth is unused */
};

struct choice {
    float cost;
    int axis; /* -1: no split found */
    int bin;  /* the last bin of the left side */
};

/* Assigns a centre to a bin along each axis. Counting and partitioning use the same function. */
struct binning {
    vf lo, scale;
    int bins;
    uint32_t step; /* every step-th ref is counted */
};

/* ---- boxes ---------------------------------------------------------------------------------- */

SIMD_INLINE struct vbox empty(void) { return (struct vbox){vf_set(FLT_MAX), vf_set(-FLT_MAX)}; }
SIMD_INLINE struct vbox join(struct vbox a, struct vbox b)
{
    return (struct vbox){vf_min(a.lo, b.lo), vf_max(a.hi, b.hi)};
}
SIMD_INLINE struct vbox of_ref(const struct ref *r)
{
    return (struct vbox){vf_aligned(r->lo), vf_aligned(r->hi)};
}
/* Twice the centre. The fourth lane is 0: integers taken for floats are slow. */
SIMD_INLINE vf centre(struct vbox b)
{
    const vi three = {-1, -1, -1, 0};
    return (vf)((vi)b.lo & three) + (vf)((vi)b.hi & three);
}
SIMD_INLINE struct vbox of_point(vf p) { return (struct vbox){p, p}; }
SIMD_INLINE struct box stored(struct vbox b)
{
    struct box s;
    vf_store_aligned(s.lo, b.lo);
    vf_store_aligned(s.hi, b.hi);
    return s;
}
SIMD_INLINE struct vbox loaded(const struct box *b)
{
    return (struct vbox){vf_aligned(b->lo), vf_aligned(b->hi)};
}
SIMD_INLINE float area(struct vbox b)
{
    vf d = b.hi - b.lo;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

/* The areas of four boxes, in lanes. */
SIMD_INLINE vf areas(struct vbox a, struct vbox b, struct vbox c, struct vbox d)
{
    a.hi -= a.lo, b.hi -= b.lo, c.hi -= c.lo, d.hi -= d.lo;
    vf ab = __builtin_shufflevector(a.hi, b.hi, 0, 4, 1, 5);
    vf cd = __builtin_shufflevector(c.hi, d.hi, 0, 4, 1, 5);
    vf x = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    vf y = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    ab = __builtin_shufflevector(a.hi, b.hi, 2, 6, 2, 6);
    cd = __builtin_shufflevector(c.hi, d.hi, 2, 6, 2, 6);
    vf z = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    return x * y + y * z + z * x;
}

static inline float blocks(uint32_t n) { return (float)((n + LANES - 1) / LANES); }

/* ---- the best plane between bins ------------------------------------------------------------ */

SIMD_INLINE vi bins_of(const struct binning *g, vf c)
{
    return __builtin_convertvector(
        vf_min((c - g->lo) * g->scale, vf_set((float)(g->bins - 1))), vi);
}

static inline void bins_clear(struct bins *b, int n)
{
    memset(b->count, 0, (size_t)n * sizeof *b->count);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < n; i++) b->box[a][i] = empty();
}

SIMD_INLINE void bin_ref(struct bins *b, int axis, int k, struct vbox box)
{
    struct vbox *to = &b->box[axis][k];
    *to = join(*to, box);
    b->count[k][axis]++;
}

SIMD_INLINE void bins_ref(struct bins *b, const struct binning *g, const struct ref *r)
{
    struct vbox box = of_ref(r);
    vi k = bins_of(g, centre(box));
    bin_ref(b, 0, k[0], box);
    bin_ref(b, 1, k[1], box);
    bin_ref(b, 2, k[2], box);
}

/* Adds every step-th ref. They go to b and c in turn, which may be the same. Neighbours are often
 * in one bin: with two sets, an add need not wait for the last store. */
static inline void bins_add(struct bins *b, struct bins *c, const struct binning *g,
    const struct ref *r, uint32_t n, uint32_t step)
{
    uint32_t i = 0;
    for (; i + step < n; i += 2 * step) {
        bins_ref(b, g, &r[i]);
        bins_ref(c, g, &r[i + step]);
    }
    if (i < n) bins_ref(b, g, &r[i]);
}

static inline void bins_join(struct bins *b, const struct bins *c, int n)
{
    for (int i = 0; i < n; i++)
        for (int a = 0; a < 3; a++) {
            b->box[a][i] = join(b->box[a][i], c->box[a][i]);
            b->count[i][a] += c->count[i][a];
        }
}

static inline void bins_all(
    struct bins *b, const struct binning *g, const struct ref *r, uint32_t n)
{
    bins_clear(b, g->bins);
    if (n < TWICE) {
        bins_add(b, b, g, r, n, g->step);
        return;
    }
    struct bins other;
    bins_clear(&other, g->bins);
    bins_add(b, &other, g, r, n, g->step);
    bins_join(b, &other, g->bins);
}

/* Boxes and counts from one end of the bins on, of all axes: of one in each lane. */
struct swept {
    struct vbox x, y, z;
    vi n;
};

SIMD_INLINE struct swept swept_none(void) { return (struct swept){empty(), empty(), empty(), {0}}; }

SIMD_INLINE void sweep(struct swept *s, const struct bins *bins, int i)
{
    s->x = join(s->x, bins->box[0][i]);
    s->y = join(s->y, bins->box[1][i]);
    s->z = join(s->z, bins->box[2][i]);
    s->n += *(const vi *)bins->count[i];
}

/* Area times blocks. */
SIMD_INLINE vf swept_cost(const struct swept *s)
{
    return areas(s->x, s->y, s->z, s->z) *
           __builtin_convertvector((s->n + (LANES - 1)) >> BLOCK_BITS, vf);
}

static inline struct choice choose(const struct bins *bins, const struct binning *g)
{
    vf right[BINS], least = vf_set(FLT_MAX);
    vi at = {0};
    struct swept s = swept_none();
    for (int i = g->bins - 1; i > 0; i--) {
        sweep(&s, bins, i);
        right[i] = vf_choose(s.n > 0, swept_cost(&s), vf_set(FLT_MAX));
    }
    s = swept_none();
    for (int i = 0; i < g->bins - 1; i++) {
        sweep(&s, bins, i);
        vf cost = swept_cost(&s) + right[i + 1];
        vi better = (s.n > 0) & (cost < least);
        least = vf_choose(better, cost, least);
        at = (better & i) | (~better & at);
    }
    struct choice best = {FLT_MAX, -1, 0};
    for (int a = 0; a < 3; a++)
        if (g->scale[a] > 0 && least[a] < best.cost) best = (struct choice){least[a], a, at[a]};
    return best;
}

static inline struct binning binning_of(const struct span *s)
{
    struct binning g = {vf_aligned(s->centres.lo), {0}, s->n > SOME ? BINS : BINS_SOME, 1};
    /* Odd, because scenes repeat in powers of two. */
    uint32_t step = s->n / SAMPLE;
    g.step = (step < STEP_MOST ? step : STEP_MOST) | 1;
    for (int i = 0; i < 3; i++) {
        float extent = s->centres.hi[i] - s->centres.lo[i];
        g.scale[i] = extent > 0 ? (float)g.bins * (1 - 0x1p-20f) / extent : 0;
        if (!(g.scale[i] < FLT_MAX)) g.scale[i] = 0; /* nearly flat: do not split along this axis */
    }
    return g;
}

/* ---- partitioning --------------------------------------------------------------------------- */

struct parted {
    uint32_t left;
    struct bounds side[2];
};

static inline void bounds_add(struct bounds *b, const struct ref *r)
{
    struct vbox box = of_ref(r);
    b->box = join(b->box, box);
    b->centres = join(b->centres, of_point(centre(box)));
}

SIMD_INLINE struct bounds bounds_join(struct bounds a, struct bounds b)
{
    return (struct bounds){join(a.box, b.box), join(a.centres, b.centres)};
}

static inline struct bounds bounds_none(void) { return (struct bounds){empty(), empty()}; }

/* The bounds of n refs. */
static inline struct bounds bounds_of(const struct ref *r, uint32_t n)
{
    struct bounds a = bounds_none(), b = a; /* two, so that neither waits for the other */
    for (uint32_t i = 0; i + 1 < n; i += 2) {
        bounds_add(&a, &r[i]);
        bounds_add(&b, &r[i + 1]);
    }
    if (n % 2) bounds_add(&a, &r[n - 1]);
    return bounds_join(a, b);
}

/* Without a branch that depends on the references: every one changes places with the first of the
 * right side, and the left side grows by 0 or 1 (N. Lomuto's scheme). */
static inline struct parted part(
    struct ref *r, uint32_t n, const struct binning *g, const struct choice *s)
{
    uint32_t k = 0;
    int axis = s->axis;
    float lo = g->lo[axis], scale = g->scale[axis], last = (float)(g->bins - 1);
    for (uint32_t i = 0; i < n; i++) {
        struct vbox box = of_ref(&r[i]), other = of_ref(&r[k]);
        float at = (r[i].lo[axis] + r[i].hi[axis] - lo) * scale; /* as bins_of computes it */
        int bin = (int)(at < last ? at : last);
        vf_store_aligned(r[i].lo, other.lo);
        vf_store_aligned(r[i].hi, other.hi);
        vf_store_aligned(r[k].lo, box.lo);
        vf_store_aligned(r[k].hi, box.hi);
        k += bin <= s->bin;
    }
    return (struct parted){k, {bounds_of(r, k), bounds_of(r + k, n - k)}};
}

#endif
