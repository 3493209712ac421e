/*
 * packet: up to PACKET rays traverse the hierarchy together. Each node is first tested against the
 * bounds of all rays (interval arithmetic, as in S. Boulos, I. Wald, P. Shirley, "Geometric and
 * arithmetic culling methods for entire ray packets", 2006). Each child is tested against every ray
 * when it leaves the stack. If few rays remain, each continues alone (C. Benthin, I. Wald, S.
 * Woop, M. Ernst, W. Mark, "Combining single and packet-ray tracing for arbitrary ray distributions
 * on the Intel MIC architecture", IEEE TVCG 18(9), 2012). Box tests are conservative, and so is
 * the filter of leaves (may_hit_block); what remains is tested ray by ray. So the hits equal those
 * of single rays.
 */
#ifndef STORMRING_TRACE_PACKET_H
#define STORMRING_TRACE_PACKET_H

#include "trace/kernel.h"

/* Magnitude of a, sign of b. */
static inline vf vf_copysign(vf a, vf b) { return (vf)(((vi)a & INT32_MAX) | ((vi)b & INT32_MIN)); }

/* The least lane. */
static inline float vf_least(vf a)
{
#if VF == 8
    a = vf_min(a, __builtin_shufflevector(a, a, 4, 5, 6, 7, 0, 1, 2, 3));
    a = vf_min(a, __builtin_shufflevector(a, a, 2, 3, 0, 1, 6, 7, 4, 5));
#elif VF == 4
    a = vf_min(a, __builtin_shufflevector(a, a, 2, 3, 0, 1));
#endif
    return a[0] < a[1] ? a[0] : a[1];
}

/*
 * Sets what follows from p->o and p->d. A box between planes lo and hi is entered and left at
 * (lo - (o + pad)) inv and (hi - (o - pad)) inv, or the reverse if inv < 0. Both are computed as
 * plane * inv - o * inv: this shifts the planes by rounding errors of o and of the plane, which the
 * pad covers.
 */
static ALWAYS_INLINE void packet_axis(struct packet *p, int axis, float slack)
{
    vf o_lo = vf_set(FLT_MAX), o_hi = vf_set(FLT_MAX), lo = vf_set(FLT_MAX), hi = vf_set(FLT_MAX);
    for (int i = 0; i < PACKET; i += VF) { /* upper bounds are kept as negated lower bounds */
        vf o = vf_aligned(p->o[axis] + i), dir = vf_aligned(p->d[axis] + i);
        vf inv = vf_set(1) / vf_copysign(vf_max(vf_abs(dir), vf_set(TINY)), dir);
        vf_store_aligned(p->inv[axis] + i, inv);
        o_lo = vf_min(o_lo, o), o_hi = vf_min(o_hi, -o);
        lo = vf_min(lo, inv), hi = vf_min(hi, -inv);
    }
    float first = vf_least(o_lo), last = -vf_least(o_hi), least = vf_least(lo),
          most = -vf_least(hi);
    float pad = pad_of(fabsf(first) > fabsf(last) ? first : last, slack);
    for (int i = 0; i < PACKET; i += VF) {
        vf o = vf_aligned(p->o[axis] + i), inv = vf_aligned(p->inv[axis] + i);
        vf_store_aligned(p->from[axis] + i, (o + vf_set(pad)) * inv);
        vf_store_aligned(p->from[axis + 3] + i, (o - vf_set(pad)) * inv);
    }
    p->pad[axis] = pad;
    box_ray_axis(&p->all, axis, 0, 0, most < 0 ? -1 : 1);
    if (least < 0 && most > 0) { /* slopes of both signs: this axis does not cull */
        p->mixed++;
        p->all.near[axis] = 1e30f, p->all.far[axis] = -1e30f;
        p->all.inv[axis] = p->far_inv[axis] = 1;
    } else if (most < 0) {
        p->all.near[axis] = first - pad, p->all.far[axis] = last + pad;
        p->all.inv[axis] = most, p->far_inv[axis] = least;
    } else {
        p->all.near[axis] = last + pad, p->all.far[axis] = first - pad;
        p->all.inv[axis] = least, p->far_inv[axis] = most;
    }
}

static inline void update_limit(struct packet *p)
{
    vf least = -vf_aligned(p->limit);
    for (int i = VF; i < PACKET; i += VF) least = vf_min(least, -vf_aligned(p->limit + i));
    p->limit_max = -vf_least(least);
}

static void packet_init(
    struct packet *p, const struct bvh *b, const struct ray *const *r, unsigned n)
{
    for (unsigned i = 0; i < PACKET; i++) {
        const struct ray *a =
            r[i < n ? i : 0]; /* unused places repeat the first ray, with limit -1 */
        p->limit[i] = i < n ? t_above(a->t_max) : -1;
        p->start[i] = a->start - 1;
        p->o[0][i] = (float)a->o.x, p->d[0][i] = (float)a->d.x;
        p->o[1][i] = (float)a->o.y, p->d[1][i] = (float)a->d.y;
        p->o[2][i] = (float)a->o.z, p->d[2][i] = (float)a->d.z;
    }
    p->mixed = 0;
    for (int axis = 0; axis < 3; axis++) packet_axis(p, axis, b->slack);
    p->pads = p->pad[0] + p->pad[1] + p->pad[2];
    update_limit(p);
    p->ray = r;
}

/* Extracts ray i for traversal alone. */
static inline void packet_box_ray(const struct packet *p, int i, struct box_ray *w)
{
    for (int a = 0; a < 3; a++) box_ray_axis(w, a, p->o[a][i], p->pad[a], p->inv[a][i]);
}

/* The children that a ray of the packet may enter, and lower bounds on the entry distances. A
 * distance is bounded by the nearest origin and, if it is positive, by the least slope. If it is
 * negative, so is the bound. */
static ALWAYS_INLINE unsigned bound_boxes(
    const struct node8 *n, const struct packet *p, float t_near[WIDTH])
{
    return meet_boxes(n, &p->all, p->far_inv, p->limit_max, t_near);
}

/* The distances at which VW rays from i on pass a plane: `plane` is its offset in the node. */
static ALWAYS_INLINE vw pass_plane(
    const struct packet *p, const float *planes, int axis, uint32_t plane, int i)
{
    const float *from = p->from[plane / WIDTH] + i, *inv = p->inv[axis] + i;
    return vw_mul_sub(vw_set(planes[plane]), vw_aligned(inv), vw_aligned(from));
}

/* The rays that enter child k of n before their limit. */
static ALWAYS_INLINE unsigned rays_in_box(const struct node8 *n, uint32_t k, const struct packet *p)
{
    const float *planes = (const float *)n + k; /* lo and hi are its first members */
    unsigned mask = 0;
    for (int i = 0; i < PACKET; i += VW) {
        vw near, far, limit = vw_aligned(p->limit + i);
        if (!p->mixed) {
            const uint32_t *in = p->all.near_plane, *out = p->all.far_plane;
            vw x0 = pass_plane(p, planes, 0, in[0], i), x1 = pass_plane(p, planes, 0, out[0], i);
            vw y0 = pass_plane(p, planes, 1, in[1], i), y1 = pass_plane(p, planes, 1, out[1], i);
            vw z0 = pass_plane(p, planes, 2, in[2], i), z1 = pass_plane(p, planes, 2, out[2], i);
            near = vw_max(vw_max(x0, y0), vw_max(z0, vw_set(0)));
            far = vw_min(vw_min(x1, y1), vw_min(z1, limit));
        } else {
            enum { LO, HI = 3 * WIDTH };
            vw x0 = pass_plane(p, planes, 0, LO, i), x1 = pass_plane(p, planes, 0, HI, i);
            vw y0 = pass_plane(p, planes, 1, LO + WIDTH, i);
            vw y1 = pass_plane(p, planes, 1, HI + WIDTH, i);
            vw z0 = pass_plane(p, planes, 2, LO + 2 * WIDTH, i);
            vw z1 = pass_plane(p, planes, 2, HI + 2 * WIDTH, i);
            near =
                vw_max(vw_max(vw_min(x0, x1), vw_min(y0, y1)), vw_max(vw_min(z0, z1), vw_set(0)));
            far = vw_min(vw_min(vw_max(x0, x1), vw_max(y0, y1)), vw_min(vw_max(z0, z1), limit));
        }
        mask |= vw_le_bits(near, far * vw_set(T_ROUNDING)) << i;
    }
    return mask;
}

/* So few rays continue alone; measured. */
#define ALONE_MAX 5
/* Rays with slopes of both signs along this many axes are traced alone. */
#define MIXED_MAX 3

/* A child that waits on the stack: number k of a node. */
struct turn {
    uint32_t node, k;
    float t;
};

/* Pushes the children in mask, farthest first. */
static inline void push_turns(
    uint32_t node, unsigned mask, const float t_near[WIDTH], struct turn *stack, uint32_t *top)
{
    uint32_t bottom = *top;
    while (mask) {
        uint32_t i = (uint32_t)take_bit(&mask), k = (*top)++;
        struct turn next = {node, i, t_near[i]};
        for (; k > bottom && stack[k - 1].t < next.t; k--) stack[k] = stack[k - 1];
        stack[k] = next;
    }
}

static void closest_alone(
    const struct bvh *b, uint32_t child, const struct packet *p, int i, struct hit *h)
{
    struct box_ray w;
    packet_box_ray(p, i, &w);
    closest_below(b, child, &w, p->ray[i], h);
}

#define FILTER_MIN 3 /* fewer rays are not filtered */

static ALWAYS_INLINE void closest_in_leaf_packet(
    const struct bvh *b, uint32_t leaf, struct packet *p, unsigned rays, struct hit *const *h)
{
    uint32_t first = leaf_first(leaf), n = leaf_count(leaf);
    bool filter = __builtin_popcount(rays) >= FILTER_MIN;
    for (uint32_t i = 0; i < n; i++) {
        unsigned hits = filter ? rays & may_hit_block(b, leaf_kind(leaf), first + i, p) : rays;
        while (hits) {
            int k = take_bit(&hits);
            closest_in_block(b, leaf_kind(leaf), first + i, p->ray[k], h[k]);
            p->limit[k] = t_above(h[k]->t);
        }
    }
}

static void closest_packet(
    const struct bvh *b, const struct ray *const *r, unsigned n, struct hit *const *h)
{
    struct packet p;
    struct turn stack[STACK_MAX];
    uint32_t top = 0, node = 0;
    for (unsigned i = 0; i < n; i++) *h[i] = (struct hit){r[i]->t_max, NO_ITEM};
    if (!b->nodes) return;
    packet_init(&p, b, r, n);
    if (p.mixed >= MIXED_MAX) {
        for (unsigned i = 0; i < n; i++) closest_alone(b, 0, &p, (int)i, h[i]);
        return;
    }
    for (;;) {
        _Alignas(32) float t_near[WIDTH];
        unsigned mask = bound_boxes(&b->nodes[node], &p, t_near);
        push_turns(node, mask, t_near, stack, &top);
        for (;;) { /* until an inner node that more than ALONE_MAX rays enter */
            if (top == 0) return;
            struct turn t = stack[--top];
            if (t.t > p.limit_max * T_ROUNDING) continue;
            unsigned rays = rays_in_box(&b->nodes[t.node], t.k, &p);
            uint32_t child = b->nodes[t.node].child[t.k];
            if (!rays) continue;
            bool alone = __builtin_popcount(rays) <= ALONE_MAX;
            if (!(child & LEAF) && !alone) {
                node = child;
                break;
            }
            if (child & LEAF) {
                closest_in_leaf_packet(b, child, &p, rays, h);
                rays = 0;
            }
            while (rays) {
                int i = take_bit(&rays);
                closest_alone(b, child, &p, i, h[i]);
                p.limit[i] = t_above(h[i]->t);
            }
            update_limit(&p);
        }
    }
}

static bool blocked_alone(const struct bvh *b, uint32_t child, const struct packet *p, int i,
    const uint8_t *transmits, struct crossings *c)
{
    struct box_ray w;
    packet_box_ray(p, i, &w);
    return blocked_below(b, child, &w, p->ray[i], transmits, c);
}

static ALWAYS_INLINE unsigned blocked_in_leaf_packet(const struct bvh *b, uint32_t leaf,
    struct packet *p, unsigned rays, const uint8_t *transmits, struct crossings *c)
{
    uint32_t first = leaf_first(leaf), n = leaf_count(leaf);
    unsigned done = 0;
    bool filter = __builtin_popcount(rays) >= FILTER_MIN;
    for (uint32_t i = 0; i < n && rays; i++) {
        unsigned hits = filter ? rays & may_hit_block(b, leaf_kind(leaf), first + i, p) : rays;
        while (hits) {
            int k = take_bit(&hits);
            if (!blocked_in_block(b, leaf_kind(leaf), first + i, p->ray[k], transmits, &c[k]))
                continue;
            done |= 1u << k;
            rays &= ~(1u << k);
            p->limit[k] = -1;
        }
    }
    return done;
}

/* Bit i: ray i is blocked. Otherwise c[i] holds its crossings. */
static unsigned blocked_packet(const struct bvh *b, const struct ray *const *r, unsigned n,
    const uint8_t *transmits, struct crossings *c)
{
    struct packet p;
    struct turn stack[STACK_MAX];
    uint32_t top = 0, node = 0;
    unsigned done = 0;
    if (!b->nodes) return 0;
    packet_init(&p, b, r, n);
    for (;;) {
        _Alignas(32) float t_near[WIDTH];
        unsigned mask = bound_boxes(&b->nodes[node], &p, t_near);
        while (mask) {
            uint32_t k = (uint32_t)take_bit(&mask);
            stack[top++] = (struct turn){node, k, t_near[k]};
        }
        for (;;) {
            if (top == 0) return done;
            struct turn t = stack[--top];
            unsigned rays = rays_in_box(&b->nodes[t.node], t.k, &p);
            uint32_t child = b->nodes[t.node].child[t.k];
            if (!rays) continue;
            bool alone = __builtin_popcount(rays) <= ALONE_MAX;
            if (!(child & LEAF) && !alone) {
                node = child;
                break;
            }
            if (child & LEAF) {
                done |= blocked_in_leaf_packet(b, child, &p, rays, transmits, c);
                rays = 0;
            }
            while (rays) {
                int i = take_bit(&rays);
                if (!blocked_alone(b, child, &p, i, transmits, &c[i])) continue;
                done |= 1u << i;
                p.limit[i] = -1;
            }
            if (done == (1u << n) - 1) return done;
        }
    }
}

#endif
