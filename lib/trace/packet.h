/*
 * packet: up to PACKET rays traverse the hierarchy together. Each node is first tested against the
 * bounds of all rays (interval arithmetic, as in S. Boulos, I. Wald, P. Shirley, "Geometric and
 * arithmetic culling methods for entire ray packets", 2006). Each child is tested against every ray
 * when it leaves the stack. If only one ray remains, it continues alone (C. Benthin, I. Wald, S.
 * Woop, M. Ernst, W. Mark, "Combining single and packet-ray tracing for arbitrary ray distributions
 * on the Intel MIC architecture", IEEE TVCG 18(9), 2012). Box tests are conservative and blocks are
 * tested ray by ray, so the hits equal those of single rays.
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

struct packet {
    _Alignas(32) float o[3][PACKET];
    _Alignas(32) float inv[3][PACKET];
    _Alignas(32) float limit[PACKET]; /* no hit beyond this t matters; -1: the ray is finished */
    float pad[3];
    /* Bounds over all rays: padded origins, and reciprocal slopes. */
    float o_lo[3], o_hi[3], inv_lo[3], inv_hi[3];
    bool mixed[3]; /* slopes of both signs: this axis does not cull */
    float limit_max;
    const struct ray *const *ray;
};

/* d: the directions along axis, PACKET of them. p->o is already set. */
static ALWAYS_INLINE void packet_axis(struct packet *p, int axis, const float *d, float slack)
{
    vf o_lo = vf_set(FLT_MAX), o_hi = vf_set(FLT_MAX), lo = vf_set(FLT_MAX), hi = vf_set(FLT_MAX);
    for (int i = 0; i < PACKET; i += VF) { /* upper bounds are kept as negated lower bounds */
        vf o = vf_aligned(p->o[axis] + i), dir = vf_aligned(d + i);
        vf inv = vf_set(1) / vf_copysign(vf_max(vf_abs(dir), vf_set(TINY)), dir);
        vf_store_aligned(p->inv[axis] + i, inv);
        o_lo = vf_min(o_lo, o), o_hi = vf_min(o_hi, -o);
        lo = vf_min(lo, inv), hi = vf_min(hi, -inv);
    }
    float first = vf_least(o_lo), last = -vf_least(o_hi);
    p->pad[axis] = pad_of(fabsf(first) > fabsf(last) ? first : last, slack);
    p->o_lo[axis] = first - p->pad[axis];
    p->o_hi[axis] = last + p->pad[axis];
    p->inv_lo[axis] = vf_least(lo);
    p->inv_hi[axis] = -vf_least(hi);
    p->mixed[axis] = p->inv_lo[axis] < 0 && p->inv_hi[axis] > 0;
}

static void packet_init(
    struct packet *p, const struct bvh *b, const struct ray *const *r, unsigned n)
{
    _Alignas(32) float d[3][PACKET];
    p->limit_max = -1;
    for (unsigned i = 0; i < PACKET; i++) {
        const struct ray *a =
            r[i < n ? i : 0]; /* unused places repeat the first ray, with limit -1 */
        p->limit[i] = i < n ? t_above(a->t_max) : -1;
        p->limit_max = p->limit[i] > p->limit_max ? p->limit[i] : p->limit_max;
        p->o[0][i] = (float)a->o.x, d[0][i] = (float)a->d.x;
        p->o[1][i] = (float)a->o.y, d[1][i] = (float)a->d.y;
        p->o[2][i] = (float)a->o.z, d[2][i] = (float)a->d.z;
    }
    for (int axis = 0; axis < 3; axis++) packet_axis(p, axis, d[axis], b->slack);
    p->ray = r;
}

/* Extracts ray i for traversal alone. */
static inline void packet_box_ray(const struct packet *p, int i, struct box_ray *w)
{
    for (int a = 0; a < 3; a++) box_ray_axis(w, a, p->o[a][i], p->pad[a], p->inv[a][i]);
}

/* The children that a ray of the packet may enter, and lower bounds on the entry distances. */
static ALWAYS_INLINE unsigned bound_boxes(
    const struct node8 *n, const struct packet *p, float t_near[WIDTH])
{
    unsigned mask = 0;
    for (int i = 0; i < WIDTH; i += VF) {
        vf near = vf_set(0), far = vf_set(p->limit_max);
        for (int a = 0; a < 3; a++) {
            if (p->mixed[a]) continue;
            vf lo = vf_aligned(n->lo[a] + i) - vf_set(p->o_hi[a]);
            vf hi = vf_aligned(n->hi[a] + i) - vf_set(p->o_lo[a]);
            vf small = vf_set(p->inv_lo[a]), large = vf_set(p->inv_hi[a]);
            bool down = p->inv_hi[a] < 0;
            vf in = down ? hi : lo, out = down ? lo : hi;
            near = vf_max(near, vf_min(in * small, in * large));
            far = vf_min(far, vf_max(out * small, out * large));
        }
        vf_store_aligned(t_near + i, near);
        mask |= vi_signs(near <= far * vf_set(T_ROUNDING)) << i;
    }
    return mask & n->used; /* if all axes are mixed, no test rejects the unused children */
}

/* The rays that enter child k of n before their limit. */
static ALWAYS_INLINE unsigned rays_in_box(const struct node8 *n, int k, const struct packet *p)
{
    vf lo[3], hi[3];
    unsigned mask = 0;
    for (int a = 0; a < 3; a++) {
        lo[a] = vf_set(n->lo[a][k] - p->pad[a]);
        hi[a] = vf_set(n->hi[a][k] + p->pad[a]);
    }
    for (int i = 0; i < PACKET; i += VF) {
        vf near = vf_set(0), far = vf_aligned(p->limit + i);
        for (int a = 0; a < 3; a++) {
            vf o = vf_aligned(p->o[a] + i), inv = vf_aligned(p->inv[a] + i);
            vf t0 = (lo[a] - o) * inv, t1 = (hi[a] - o) * inv;
            near = vf_max(near, vf_min(t0, t1));
            far = vf_min(far, vf_max(t0, t1));
        }
        mask |= vi_signs(near <= far * vf_set(T_ROUNDING)) << i;
    }
    return mask;
}

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

static inline void update_limit(struct packet *p)
{
    float max = -1;
    for (int i = 0; i < PACKET; i++) max = p->limit[i] > max ? p->limit[i] : max;
    p->limit_max = max;
}

static void closest_alone(
    const struct bvh *b, uint32_t child, const struct packet *p, int i, struct hit *h)
{
    struct box_ray w;
    packet_box_ray(p, i, &w);
    closest_below(b, child, &w, p->ray[i], h);
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
    for (;;) {
        _Alignas(32) float t_near[WIDTH];
        unsigned mask = bound_boxes(&b->nodes[node], &p, t_near);
        push_turns(node, mask, t_near, stack, &top);
        for (;;) { /* until an inner node that at least two rays enter */
            if (top == 0) return;
            struct turn t = stack[--top];
            if (t.t > p.limit_max * T_ROUNDING) continue;
            unsigned rays = rays_in_box(&b->nodes[t.node], (int)t.k, &p);
            uint32_t child = b->nodes[t.node].child[t.k];
            if (!rays) continue;
            bool alone = !(rays & (rays - 1));
            if (!(child & LEAF) && !alone) {
                node = child;
                break;
            }
            while (rays) {
                int i = take_bit(&rays);
                if (child & LEAF) closest_in_leaf(b, child, r[i], h[i]);
                else closest_alone(b, child, &p, i, h[i]);
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
            unsigned rays = rays_in_box(&b->nodes[t.node], (int)t.k, &p);
            uint32_t child = b->nodes[t.node].child[t.k];
            if (!rays) continue;
            bool alone = !(rays & (rays - 1));
            if (!(child & LEAF) && !alone) {
                node = child;
                break;
            }
            while (rays) {
                int i = take_bit(&rays);
                bool stop = child & LEAF ? blocked_in_leaf(b, child, r[i], transmits, &c[i])
                                         : blocked_alone(b, child, &p, i, transmits, &c[i]);
                if (!stop) continue;
                done |= 1u << i;
                p.limit[i] = -1;
            }
            if (done == (1u << n) - 1) return done;
        }
    }
}

#endif
