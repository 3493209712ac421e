/*
 * kernel: traverses the hierarchy and intersects blocks, at the vector width of the including file
 * (trace_sse2.c, trace_avx2.c). Box tests use float and are conservative: they may report a box
 * that the ray misses. Hits are decided in double, by the same operations per lane at every width.
 */
/* A node has eight children, a block four lanes. */
#ifndef SIMD_MOST
#define SIMD_MOST 32
#endif
#include "simd/simd.h"
#include "trace/ends.h"
#include "trace/trace_int.h"

#include <float.h>

#define ALWAYS_INLINE inline __attribute__((always_inline))

#define TINY 1e-18f /* replaces smaller slopes: slack / TINY is longer than any ray */
/* Exceeds the rounding error of a float slab test. */
#define T_ROUNDING (1 + 0x1p-20f)

/* A ray, prepared for tests of boxes. */
struct box_ray {
    float near[3], far[3], inv[3];        /* origins for the near and far planes; 1/d */
    uint32_t near_plane[3], far_plane[3]; /* offsets of these planes in a node, in floats */
};

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
 * Each of these functions returns the lanes of a block that are hit at t_min < t <= t_max, and the
 * first t of each. *twice (may be NULL): the lanes hit a second time within these bounds.
 */

static ALWAYS_INLINE unsigned hit_tri4(
    const struct tri4 *b, const struct ray *r, double t_max, double t_out[LANES])
{
    unsigned mask = 0;
    vd ox = vd_set(r->o.x), oy = vd_set(r->o.y), oz = vd_set(r->o.z);
    vd dx = vd_set(r->d.x), dy = vd_set(r->d.y), dz = vd_set(r->d.z);
    for (int i = 0; i < LANES; i += VD) {
        vd nx = vd_aligned(b->n[0] + i), ny = vd_aligned(b->n[1] + i), nz = vd_aligned(b->n[2] + i);
        vd num = vd_aligned(b->d + i) - (nx * ox + ny * oy + nz * oz);
        vd t = num / (nx * dx + ny * dy + nz * dz);
        vd px = ox + t * dx, py = oy + t * dy, pz = oz + t * dz;
        vd u = vd_aligned(b->u[0] + i) * px + vd_aligned(b->u[1] + i) * py +
               vd_aligned(b->u[2] + i) * pz + vd_aligned(b->du + i);
        vd v = vd_aligned(b->v[0] + i) * px + vd_aligned(b->v[1] + i) * py +
               vd_aligned(b->v[2] + i) * pz + vd_aligned(b->dv + i);
        vl in = vd_le(vd_set(0), u) & vd_le(vd_set(0), v) & vd_le(u + v, vd_set(1));
        vl far = vd_lt(vd_aligned(b->err + i) + vd_set(r->err), vd_abs(num));
        vl when = vd_lt(vd_set(r->t_min), t) & vd_le(t, vd_set(t_max));
        vd_store_aligned(t_out + i, t);
        mask |= vl_signs(in & far & when) << i;
    }
    return mask;
}

/*
 * E. Haines, J. Gunther, T. Akenine-Moller, "Precision improvements for ray/sphere intersection",
 * Ray Tracing Gems ch. 7, 2019: the discriminant from the centre's distance to the ray, the smaller
 * root from the product of both. If a ray starts on the sphere, within error bounds, only the other
 * root counts.
 */
static ALWAYS_INLINE unsigned hit_sphere4(const struct sphere4 *s, const struct ray *r,
    double t_max, double t_out[LANES], unsigned *twice)
{
    unsigned mask = 0;
    vd ox = vd_set(r->o.x), oy = vd_set(r->o.y), oz = vd_set(r->o.z);
    vd dx = vd_set(r->d.x), dy = vd_set(r->d.y), dz = vd_set(r->d.z);
    if (twice) *twice = 0;
    for (int i = 0; i < LANES; i += VD) {
        vd radius = vd_aligned(s->r + i), zero = vd_set(0);
        vd fx = vd_aligned(s->c[0] + i) - ox, fy = vd_aligned(s->c[1] + i) - oy;
        vd fz = vd_aligned(s->c[2] + i) - oz;
        vd b = fx * dx + fy * dy + fz * dz;
        vd gx = fx - b * dx, gy = fy - b * dy, gz = fz - b * dz;
        vd r2 = radius * radius, disc = r2 - (gx * gx + gy * gy + gz * gz);
        vl hit = vd_le(zero, disc);
        if (!vl_signs(hit)) continue;
        vd c = fx * fx + fy * fy + fz * fz - r2;
        vd root = vd_sqrt(disc);
        vl positive = vd_lt(zero, b);
        vd q = b + vd_choose(positive, root, zero - root);
        vl on = vd_le(vd_abs(c), (radius + radius) * (vd_aligned(s->err + i) + vd_set(r->err)));
        vd p = c / q;
        vd near = vd_choose(positive, p, q), far = vd_choose(positive, q, p);
        /* On the surface p is the root near 0, so only the other root q counts. */
        near = vd_choose(on, zero, near);
        far = vd_choose(on, q, far);
        vl enters = vd_lt(vd_set(r->t_min), near);
        vd t = vd_choose(enters, near, far), limit = vd_set(t_max);
        vd_store_aligned(t_out + i, t);
        hit &= vd_lt(vd_set(r->t_min), t) & vd_le(t, limit);
        mask |= vl_signs(hit) << i;
        if (twice) *twice |= vl_signs(hit & enters & vd_le(far, limit)) << i;
    }
    return mask;
}

/*
 * The quadratic a t^2 + 2 b t + c in coordinates along and across the axis. Its origin is the ray's
 * point nearest to the middle of the cone, because the coefficients are smallest there.
 */
static ALWAYS_INLINE unsigned hit_cone4(
    const struct cone4 *s, const struct ray *r, double t_max, double t_out[LANES], unsigned *twice)
{
    unsigned mask = 0;
    vd ox = vd_set(r->o.x), oy = vd_set(r->o.y), oz = vd_set(r->o.z);
    vd dx = vd_set(r->d.x), dy = vd_set(r->d.y), dz = vd_set(r->d.z);
    if (twice) *twice = 0;
    for (int i = 0; i < LANES; i += VD) {
        vd ax = vd_aligned(s->a[0] + i), ay = vd_aligned(s->a[1] + i), az = vd_aligned(s->a[2] + i);
        vd h = vd_aligned(s->h + i), k = vd_aligned(s->k + i), half = vd_set(0.5) * h,
           zero = vd_set(0);
        /* q is relative to the middle of the axis; m is the radius there. */
        vd m = vd_aligned(s->r + i) + k * half;
        vd qx = ox - (vd_aligned(s->b[0] + i) + half * ax);
        vd qy = oy - (vd_aligned(s->b[1] + i) + half * ay);
        vd qz = oz - (vd_aligned(s->b[2] + i) + half * az);
        vd z0 = qx * ax + qy * ay + qz * az;   /* height of the origin */
        vd rise = dx * ax + dy * ay + dz * az; /* height per unit of t */
        vd ex = dx - rise * ax, ey = dy - rise * ay, ez = dz - rise * az;
        vd shift = zero - (qx * dx + qy * dy + qz * dz);
        vd sx = qx + shift * dx, sy = qy + shift * dy, sz = qz + shift * dz;
        vd z = sx * ax + sy * ay + sz * az;
        sx = sx - z * ax, sy = sy - z * ay, sz = sz - z * az;
        vd w = m + k * z, slope = k * rise;
        vd a = ex * ex + ey * ey + ez * ez - slope * slope;
        vd b = sx * ex + sy * ey + sz * ez - w * slope;
        vd c = sx * sx + sy * sy + sz * sz - w * w;
        vd disc = b * b - a * c;
        vl hit = vd_le(zero, disc);
        if (!vl_signs(hit)) continue;
        vd root = vd_sqrt(disc);
        vd q = zero - (b + vd_choose(vd_lt(b, zero), zero - root, root));
        vd t1 = q / a + shift, t2 = c / q + shift; /* infinite if there is only one root */
        /* If the ray starts on the surface, only its other root counts. */
        vd rx = qx - z0 * ax, ry = qy - z0 * ay, rz = qz - z0 * az, w0 = m + k * z0;
        vd err = vd_aligned(s->err + i) + vd_set(r->err), width = vd_abs(w0);
        vd c0 = rx * rx + ry * ry + rz * rz - w0 * w0;
        vl on = vd_le(vd_abs(c0), err * (width + width + err) * (vd_set(1) + vd_abs(k)));
        vd other = vd_set(-2) * (rx * ex + ry * ey + rz * ez - w0 * slope) / a;
        t1 = vd_choose(on, other, t1);
        t2 = vd_choose(on, vd_set(-1), t2);
        vd h1 = z0 + t1 * rise, h2 = z0 + t2 * rise, limit = vd_set(t_max);
        vl ok1 = vd_lt(vd_set(r->t_min), t1) & vd_le(t1, limit) & vd_le(vd_abs(h1), half);
        vl ok2 = vd_lt(vd_set(r->t_min), t2) & vd_le(t2, limit) & vd_le(vd_abs(h2), half);
        vd t = vd_choose(ok1 & ok2, vd_choose(vd_lt(t1, t2), t1, t2), vd_choose(ok1, t1, t2));
        vd_store_aligned(t_out + i, t);
        unsigned ok = vl_signs(ok1) | vl_signs(ok2);
        mask |= (vl_signs(hit) & ok) << i;
        if (twice) *twice |= (vl_signs(hit) & vl_signs(ok1) & vl_signs(ok2)) << i;
    }
    return mask;
}

static ALWAYS_INLINE unsigned hit_block(const struct bvh *b, enum item_kind kind, uint32_t i,
    const struct ray *r, double t_max, double t[LANES], const uint32_t **items, unsigned *twice)
{
    if (kind == ITEM_TRIANGLE) {
        const struct tri4 *p = (const struct tri4 *)b->blocks[ITEM_TRIANGLE] + i;
        *items = p->item;
        if (twice) *twice = 0;
        return hit_tri4(p, r, t_max, t);
    }
    if (kind == ITEM_SPHERE) {
        const struct sphere4 *p = (const struct sphere4 *)b->blocks[ITEM_SPHERE] + i;
        *items = p->item;
        return hit_sphere4(p, r, t_max, t, twice);
    }
    const struct cone4 *p = (const struct cone4 *)b->blocks[ITEM_CONE] + i;
    *items = p->item;
    return hit_cone4(p, r, t_max, t, twice);
}

/*
 * How many times the ray crosses lane k of block i, given that it hits the lane `times` times. If
 * the light lies on that surface (ends.h), one of the hits is the ray's end. The reverse ray from
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
