/*
 * sah: a binary hierarchy by the surface area heuristic (J. Goldsmith, J. Salmon, "Automatic
 * creation of object hierarchies for ray tracing", IEEE CG&A 7(5), 1987; binned as in I. Wald, "On
 * fast construction of SAH-based bounding volume hierarchies", RT 2007). One pass bins along all
 * three axes. The tree is the same on every host: comparisons and plain float arithmetic, and no
 * order that depends on addresses.
 */
#define SIMD_MOST 16 /* a reference has four floats for each bound */
#include "simd/simd.h"
#include "trace/trace_int.h"

#include <float.h>

#define BINS 16
/* For at most FEW refs: clearing and sweeping the bins takes most of the time there. */
#define BINS_FEW 8
#define FEW 64
#define SAH_DEPTH 64   /* deeper nodes are halved: the depth is at most SAH_DEPTH + log2 n */
#define COST_NODE 0.4f /* of one binary step, relative to a block of four items; measured */

struct box {
    _Alignas(16) float lo[4];
    float hi[4]; /* the fourth lane is unused */
};

struct bin {
    struct box box;
    uint32_t count;
};

struct split {
    float cost;
    int axis; /* -1: no split found */
    int bin;  /* the last bin of the left side */
};

struct builder {
    struct bnode *nodes;
    struct ref *refs;
    uint32_t n_nodes;
};

static struct box box_empty(void)
{
    return (struct box){{FLT_MAX, FLT_MAX, FLT_MAX, 0}, {-FLT_MAX, -FLT_MAX, -FLT_MAX, 0}};
}

/* lo and hi: three floats, 16-byte aligned, followed by at least one more readable float. */
static inline void box_grow(struct box *b, const float *lo, const float *hi)
{
    for (int i = 0; i < 3; i += VF) {
        vf_store_aligned(b->lo + i, vf_min(vf_aligned(lo + i), vf_aligned(b->lo + i)));
        vf_store_aligned(b->hi + i, vf_max(vf_aligned(hi + i), vf_aligned(b->hi + i)));
    }
}

/* Half the surface area. */
static float box_area(const struct box *b)
{
    float x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
    return x < 0 ? 0 : x * y + y * z + z * x;
}

/* Twice the centre. */
static inline void centre(const struct ref *r, float c[4])
{
    for (int i = 0; i < 3; i += VF)
        vf_store_aligned(c + i, vf_aligned(r->lo + i) + vf_aligned(r->hi + i));
}

/* Assigns a centre to a bin along each axis. Counting and partitioning use the same function. */
struct binning {
    _Alignas(16) float lo[4];
    float scale[4];
    int bins;
};
static inline void bins_of(const struct binning *g, const struct ref *r, int32_t bin[4])
{
    for (int i = 0; i < 3; i += VF) {
        vf c = vf_aligned(r->lo + i) + vf_aligned(r->hi + i) - vf_aligned(g->lo + i);
        c = vf_min(c * vf_aligned(g->scale + i), vf_set((float)(g->bins - 1)));
        vi whole = __builtin_convertvector(c, vi);
        memcpy(bin + i, &whole, sizeof whole);
    }
}

static float blocks(uint32_t n) { return (float)((n + LANES - 1) / LANES); }

static void sweep(const struct bin bins[BINS], int n_bins, int axis, struct split *best)
{
    float right[BINS];
    struct box b = box_empty();
    uint32_t n = 0;
    for (int i = n_bins - 1; i > 0; i--) {
        box_grow(&b, bins[i].box.lo, bins[i].box.hi);
        n += bins[i].count;
        right[i] = n ? box_area(&b) * blocks(n) : FLT_MAX;
    }
    b = box_empty();
    n = 0;
    for (int i = 0; i < n_bins - 1; i++) {
        box_grow(&b, bins[i].box.lo, bins[i].box.hi);
        n += bins[i].count;
        if (!n || right[i + 1] == FLT_MAX) continue;
        float cost = box_area(&b) * blocks(n) + right[i + 1];
        if (cost < best->cost) *best = (struct split){cost, axis, i};
    }
}

static struct split find_split(const struct ref *r, uint32_t n, const struct binning *g)
{
    struct bin bins[3][BINS];
    struct split best = {FLT_MAX, -1, 0};
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < g->bins; i++) bins[a][i] = (struct bin){box_empty(), 0};
    for (uint32_t i = 0; i < n; i++) {
        int32_t k[4];
        bins_of(g, &r[i], k);
        for (int a = 0; a < 3; a++) {
            box_grow(&bins[a][k[a]].box, r[i].lo, r[i].hi);
            bins[a][k[a]].count++;
        }
    }
    for (int a = 0; a < 3; a++)
        if (g->scale[a] > 0) sweep(bins[a], g->bins, a, &best);
    return best;
}

static void swap_refs(struct ref *a, struct ref *b)
{
    struct ref t = *a;
    *a = *b;
    *b = t;
}

static uint32_t part_by_bin(
    struct ref *r, uint32_t n, const struct binning *g, const struct split *s)
{
    uint32_t i = 0, j = n;
    while (i < j) {
        int32_t k[4];
        bins_of(g, &r[i], k);
        if (k[s->axis] <= s->bin) i++;
        else swap_refs(&r[i], &r[--j]);
    }
    return i;
}

/* Moves refs of the first ref's kind to the front. Returns their number. */
static uint32_t part_by_kind(struct ref *r, uint32_t n)
{
    uint32_t i = 1, j = n, kind = r[0].kind;
    while (i < j) {
        if (r[i].kind == kind) i++;
        else swap_refs(&r[i], &r[--j]);
    }
    return i;
}

static uint32_t make_node(struct builder *b, const struct box *box, uint32_t first, uint32_t n)
{
    uint32_t k = b->n_nodes++;
    struct bnode *node = &b->nodes[k];
    for (int i = 0; i < 3; i++) {
        node->lo[i] = box->lo[i];
        node->hi[i] = box->hi[i];
    }
    node->left = first;
    node->right = NO_CHILD;
    node->count = n;
    return k;
}

/* Returns the number of refs that go left; 0: the refs stay together as a leaf. */
static uint32_t divide(
    struct ref *r, uint32_t n, const struct box *box, const struct box *centres, int depth)
{
    if (n == 1) return 0;
    struct binning g = {{0}, {0}, n > FEW ? BINS : BINS_FEW};
    for (int i = 0; i < 3; i++) {
        float extent = centres->hi[i] - centres->lo[i];
        g.lo[i] = centres->lo[i];
        g.scale[i] = extent > 0 ? (float)g.bins * (1 - 0x1p-20f) / extent : 0;
        if (!(g.scale[i] < FLT_MAX)) g.scale[i] = 0; /* nearly flat: do not split along this axis */
    }
    struct split s = {FLT_MAX, -1, 0};
    if (depth < SAH_DEPTH) s = find_split(r, n, &g);
    float area = box_area(box);
    if (n <= LANES * LEAF_BLOCKS_MAX) {
        uint32_t same = part_by_kind(r, n);
        if (s.axis < 0 || area * blocks(n) <= area * COST_NODE + s.cost) return same < n ? same : 0;
    }
    return s.axis >= 0 ? part_by_bin(r, n, &g, &s) : n / 2;
}

static uint32_t build(struct builder *b, uint32_t first, uint32_t n, int depth)
{
    struct ref *r = b->refs + first;
    struct box box = box_empty(), centres = box_empty();
    for (uint32_t i = 0; i < n; i++) {
        _Alignas(16) float c[4];
        centre(&r[i], c);
        box_grow(&box, r[i].lo, r[i].hi);
        box_grow(&centres, c, c);
    }
    uint32_t k = make_node(b, &box, first, n);
    uint32_t left = divide(r, n, &box, &centres, depth);
    if (left) {
        uint32_t l = build(b, first, left, depth + 1);
        uint32_t right = build(b, first + left, n - left, depth + 1);
        b->nodes[k].left = l;
        b->nodes[k].right = right;
    }
    return k;
}

uint32_t sah_build(struct bnode *nodes, struct ref *refs, uint32_t n)
{
    struct builder b = {nodes, refs, 0};
    build(&b, 0, n, 0);
    return b.n_nodes;
}
