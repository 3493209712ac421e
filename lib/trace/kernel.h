/*
 * kernel: traverses the hierarchy, at the vector width of the including file (trace_sse2.c,
 * trace_avx2.c, trace_avx512.c). Box tests use float and are conservative: they may report a box
 * that the ray misses. Hits are decided in double (lanes.h). tests/unit/test_trace_twin.c has the
 * same search in a few lines, without vectors.
 */
#include "trace/shapes.h"

#include <float.h>

#define TINY 1e-18f /* replaces smaller slopes: slack / TINY is longer than any ray */
/* Exceeds the rounding error of a float slab test. */
#define T_ROUNDING (1 + 0x1p-20f)

static inline void box_ray_axis(struct box_ray *w, int axis, float o, float pad, float inv)
{
    uint32_t lo = (uint32_t)axis * WIDTH, hi = lo + 3 * WIDTH;
    bool down = inv < 0;
    w->near_plane[axis] = down ? hi : lo;
    w->far_plane[axis] = down ? lo : hi;
    w->inv[axis] = inv;
    w->near[axis] = down ? o - pad : o + pad;
    w->far[axis] = down ? o + pad : o - pad;
}

static inline float slope(double d)
{
    float f = (float)d;
    return 1 / copysignf(fabsf(f) > TINY ? fabsf(f) : TINY, f);
}
static inline float pad_of(float o, float slack) { return fabsf(o) * 0x1p-22f + slack; }

static inline void box_ray_init(struct box_ray *w, const struct bvh *b, const struct ray *r)
{
    float x = (float)r->o.x, y = (float)r->o.y, z = (float)r->o.z;
    box_ray_axis(w, 0, x, pad_of(x, b->slack), slope(r->d.x));
    box_ray_axis(w, 1, y, pad_of(y, b->slack), slope(r->d.y));
    box_ray_axis(w, 2, z, pad_of(z, b->slack), slope(r->d.z));
}

/* Rounds up: t and all smaller doubles are below the result. */
static inline float t_above(double t) { return t < 1e37 ? (float)t * T_ROUNDING : INFINITY; }

/* The children that the ray enters before t_max, and the entry distances. far_inv: w->inv, or other
 * slopes for the far planes. */
static ALWAYS_INLINE unsigned meet_boxes(const struct node8 *n, const struct box_ray *w,
    const float far_inv[3], float t_max, float t_near[WIDTH])
{
    const float *planes = (const float *)n; /* lo and hi are the node's first members */
    const float *x0 = planes + w->near_plane[0], *x1 = planes + w->far_plane[0];
    const float *y0 = planes + w->near_plane[1], *y1 = planes + w->far_plane[1];
    const float *z0 = planes + w->near_plane[2], *z1 = planes + w->far_plane[2];
    vf ix = vf_set(w->inv[0]), iy = vf_set(w->inv[1]), iz = vf_set(w->inv[2]);
    vf jx = vf_set(far_inv[0]), jy = vf_set(far_inv[1]), jz = vf_set(far_inv[2]);
    unsigned mask = 0;
    for (int i = 0; i < WIDTH; i += VF) {
        vf ax = (vf_aligned(x0 + i) - vf_set(w->near[0])) * ix;
        vf ay = (vf_aligned(y0 + i) - vf_set(w->near[1])) * iy;
        vf az = (vf_aligned(z0 + i) - vf_set(w->near[2])) * iz;
        vf bx = (vf_aligned(x1 + i) - vf_set(w->far[0])) * jx;
        vf by = (vf_aligned(y1 + i) - vf_set(w->far[1])) * jy;
        vf bz = (vf_aligned(z1 + i) - vf_set(w->far[2])) * jz;
        vf a = vf_max(vf_max(ax, ay), vf_max(az, vf_set(0)));
        vf b = vf_min(vf_min(bx, by), vf_min(bz, vf_set(t_max)));
        vf_store_aligned(t_near + i, a);
        mask |= vi_signs(a <= b * vf_set(T_ROUNDING)) << i;
    }
    return mask;
}

static ALWAYS_INLINE unsigned hit_boxes(
    const struct node8 *n, const struct box_ray *w, float t_max, float t_near[WIDTH])
{
    return meet_boxes(n, w, w->inv, t_max, t_near);
}

/*
 * How many times the ray crosses lane k of block i, given that it hits the lane `times` times. If
 * the light lies on that surface (lanes.h), one of the hits is the ray's end. The reverse ray from
 * the light then finds the other crossing, unless the ray also starts on the surface.
 */
static inline unsigned crossed(const struct bvh *b, enum item_kind kind, uint32_t i, int k,
    const struct ray *r, unsigned times)
{
    _Alignas(32) double t[LANES];
    double far = fabs(r->o.x) + fabs(r->o.y) + fabs(r->o.z) + r->t_max;
    const uint32_t *items;
    struct ray back = {
        v3_mad(r->o, r->d, r->t_max), v3_scale(r->d, -1), 0, r->t_max, ERR_UNIT * far, false, 0};
    if (!on_surface(b, kind, i, k, back.o, back.err)) return times;
    if (on_surface(b, kind, i, k, r->o, r->err)) return 0;
    return hit_block(b, kind, i, &back, r->t_max, t, &items, NULL) >> k & 1;
}

static inline int take_bit(unsigned *mask)
{
    int i = __builtin_ctz(*mask);
    *mask &= *mask - 1;
    return i;
}

static ALWAYS_INLINE void closest_in_block(
    const struct bvh *b, enum item_kind kind, uint32_t i, const struct ray *r, struct hit *h)
{
    _Alignas(32) double t[LANES];
    const uint32_t *items;
    unsigned mask = hit_block(b, kind, i, r, h->t, t, &items, NULL);
    COUNT_ITEMS(b, items);
    while (mask) {
        int k = take_bit(&mask);
        if (t[k] < h->t || (t[k] == h->t && items[k] < h->item)) *h = (struct hit){t[k], items[k]};
    }
}

static ALWAYS_INLINE void closest_in_leaf(
    const struct bvh *b, uint32_t leaf, const struct ray *r, struct hit *h)
{
    uint32_t first = leaf_first(leaf), n = leaf_count(leaf);
    for (uint32_t i = 0; i < n; i++) closest_in_block(b, leaf_kind(leaf), first + i, r, h);
}

struct todo {
    uint32_t child;
    float t;
};

/* Pushes all children in mask except the nearest, farthest first. Returns the nearest. */
static inline uint32_t push_children(const struct node8 *n, unsigned mask,
    const float t_near[WIDTH], struct todo *stack, uint32_t *top)
{
    int i = take_bit(&mask);
    struct todo best = {n->child[i], t_near[i]};
    uint32_t bottom = *top;
    while (mask) {
        i = take_bit(&mask);
        struct todo next = {n->child[i], t_near[i]};
        if (next.t < best.t) {
            struct todo swap = best;
            best = next;
            next = swap;
        }
        uint32_t k = (*top)++;
        for (; k > bottom && stack[k - 1].t < next.t; k--) stack[k] = stack[k - 1];
        stack[k] = next;
    }
    return best.child;
}

/* Traverses child cur. *h is the nearest hit so far. */
static void closest_below(
    const struct bvh *b, uint32_t cur, const struct box_ray *w, const struct ray *r, struct hit *h)
{
    struct todo stack[STACK_MAX];
    uint32_t top = 0;
    float limit = t_above(h->t);
    for (;;) {
        while (!(cur & LEAF)) {
            _Alignas(32) float t_near[WIDTH];
            unsigned mask = hit_boxes(&b->nodes[cur], w, limit, t_near);
            COUNT_BOXES(b, &b->nodes[cur]);
            if (!mask) goto pop;
            cur = push_children(&b->nodes[cur], mask, t_near, stack, &top);
        }
        closest_in_leaf(b, cur, r, h);
        limit = t_above(h->t);
    pop:
        do {
            if (top == 0) return;
            cur = stack[--top].child;
        } while (stack[top].t > limit * T_ROUNDING);
    }
}

static void closest(const struct bvh *b, const struct ray *r, struct hit *h)
{
    struct box_ray w;
    *h = (struct hit){r->t_max, NO_ITEM};
    if (!b->nodes) return;
    box_ray_init(&w, b, r);
    closest_below(b, 0, &w, r, h);
}

/* True if the ray hits an opaque item of block i. */
static ALWAYS_INLINE bool blocked_in_block(const struct bvh *b, enum item_kind kind, uint32_t i,
    const struct ray *r, const uint8_t *transmits, struct crossings *c)
{
    _Alignas(32) double t[LANES];
    const uint32_t *items;
    unsigned twice, mask = hit_block(b, kind, i, r, r->t_max, t, &items, &twice);
    COUNT_ITEMS(b, items);
    while (mask) {
        int k = take_bit(&mask);
        unsigned times = 1 + (twice >> k & 1);
        if (r->to_surface) times = crossed(b, kind, i, k, r, times);
        if (times && (!transmits || !transmits[items[k]])) return true;
        for (; times; times--) crossings_add(c, items[k]);
    }
    return false;
}

/* True if the ray hits an opaque item of the leaf. */
static ALWAYS_INLINE bool blocked_in_leaf(const struct bvh *b, uint32_t leaf, const struct ray *r,
    const uint8_t *transmits, struct crossings *c)
{
    uint32_t first = leaf_first(leaf), n = leaf_count(leaf);
    for (uint32_t i = 0; i < n; i++)
        if (blocked_in_block(b, leaf_kind(leaf), first + i, r, transmits, c)) return true;
    return false;
}

static bool blocked_below(const struct bvh *b, uint32_t cur, const struct box_ray *w,
    const struct ray *r, const uint8_t *transmits, struct crossings *c)
{
    uint32_t stack[STACK_MAX], top = 0;
    float limit = t_above(r->t_max);
    for (;;) {
        while (!(cur & LEAF)) {
            _Alignas(32) float t_near[WIDTH];
            const struct node8 *n = &b->nodes[cur];
            unsigned mask = hit_boxes(n, w, limit, t_near);
            COUNT_BOXES(b, n);
            if (!mask) goto pop;
            cur = n->child[take_bit(&mask)];
            while (mask) stack[top++] = n->child[take_bit(&mask)];
        }
        if (blocked_in_leaf(b, cur, r, transmits, c)) return true;
    pop:
        if (top == 0) return false;
        cur = stack[--top];
    }
}

static bool blocked(
    const struct bvh *b, const struct ray *r, const uint8_t *transmits, struct crossings *c)
{
    struct box_ray w;
    if (!b->nodes) return false;
    box_ray_init(&w, b, r);
    return blocked_below(b, 0, &w, r, transmits, c);
}
