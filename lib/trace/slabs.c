/*
 * slabs: traverses the hierarchy of slabs.h, or tests every item where there is no hierarchy. Also
 * counts the tests of bounding volumes and of items, which it can do for all hierarchies. Traces
 * rays one by one, with the vectors that every machine has.
 */
#define COUNT_BOXES(b, node) ((b)->tests->boxes += (unsigned)__builtin_popcount((node)->used))
#define COUNT_ITEMS(b, items) ((b)->tests->items += lanes_used(items))
#include "trace/trace_int.h"

static inline unsigned lanes_used(const uint32_t item[LANES])
{
    unsigned n = 0;
    for (int i = 0; i < LANES; i++) n += item[i] != NO_ITEM;
    return n;
}

#define SIMD_MOST 16
#include "trace/kernel.h"
#include "trace/slabs.h"

/* A ray, prepared for tests of slabs. */
struct slabs_ray {
    _Alignas(32) float lo[SLABS], hi[SLABS]; /* n.o for the planes at lo and hi, widened */
    _Alignas(32) float inv[SLABS];           /* 1 / n.d */
};

static void slabs_ray_init(struct slabs_ray *w, const struct bvh *b, const struct ray *r)
{
    for (int i = 0; i < SLABS; i++) {
        const double *a = slabs_normal[i];
        struct vec3 n = v3(a[0], a[1], a[2]);
        /* A diagonal plane moves by up to three times the error of a coordinate. */
        float o = (float)v3_dot(n, r->o), pad = pad_of(o, 3 * b->slack);
        w->lo[i] = o + pad;
        w->hi[i] = o - pad;
        w->inv[i] = slope(v3_dot(n, r->d));
    }
}

/* True if the ray enters the node before limit; *t: where. */
static inline bool enters(
    const struct slabs_node *n, const struct slabs_ray *w, float limit, float *t)
{
    vf near = vf_set(0), far = vf_set(limit);
    for (int i = 0; i < SLABS; i += VF) {
        vf inv = vf_aligned(w->inv + i);
        vf a = (vf_aligned(n->lo + i) - vf_aligned(w->lo + i)) * inv;
        vf b = (vf_aligned(n->hi + i) - vf_aligned(w->hi + i)) * inv;
        near = vf_max(near, vf_min(a, b));
        far = vf_min(far, vf_max(a, b));
    }
    float in = near[0], out = far[0];
    for (int i = 1; i < VF; i++) {
        in = near[i] > in ? near[i] : in;
        out = far[i] < out ? far[i] : out;
    }
    *t = in;
    return in <= out * T_ROUNDING;
}

/* ---- the heap: the nearest node first ------------------------------------------------------ */

struct walk {
    struct slabs_ray ray;
    const struct bvh *b;
    uint32_t n; /* entries on the heap */
};

static void push_entered(struct walk *w, struct slabs_entry e, float limit)
{
    const struct slabs *s = w->b->slabs;
    w->b->tests->boxes++;
    if (!enters(&s->nodes[e.node], &w->ray, limit, &e.t)) return;
    uint32_t i = w->n++;
    for (; i > 0 && s->heap[(i - 1) / 2].t > e.t; i = (i - 1) / 2)
        s->heap[i] = s->heap[(i - 1) / 2];
    s->heap[i] = e;
}

static struct slabs_entry pop_nearest(struct walk *w)
{
    struct slabs_entry *heap = w->b->slabs->heap, first = heap[0], last = heap[--w->n];
    uint32_t i = 0;
    for (uint32_t k = 1; k < w->n; k = 2 * i + 1) {
        if (k + 1 < w->n && heap[k + 1].t < heap[k].t) k++;
        if (heap[k].t >= last.t) break;
        heap[i] = heap[k];
        i = k;
    }
    heap[i] = last;
    return first;
}

static void walk_start(struct walk *w, const struct bvh *b, const struct ray *r, float limit)
{
    w->b = b;
    w->n = 0;
    slabs_ray_init(&w->ray, b, r);
    push_entered(w, (struct slabs_entry){0, 0, 0, b->slabs->n}, limit);
}

/* The next leaf that the ray enters before limit. NULL: none is left. */
static const struct slabs_leaf *walk_next(struct walk *w, float limit)
{
    while (w->n) {
        struct slabs_entry e = pop_nearest(w);
        uint32_t half = e.count / 2;
        if (e.t > limit * T_ROUNDING) return NULL;
        if (e.count == 1) return &w->b->slabs->leaves[e.first];
        push_entered(w, (struct slabs_entry){0, e.node + 1, e.first, half}, limit);
        push_entered(
            w, (struct slabs_entry){0, e.node + 2 * half, e.first + half, e.count - half}, limit);
    }
    return NULL;
}

/* ---- tests of primitives -------------------------------------------------------------------- */

/* One block of a leaf, and the lanes that the ray hits. */
struct block_hits {
    uint32_t block;
    unsigned mask, twice;
    const uint32_t *items;
    _Alignas(32) double t[LANES];
};

/* Tests the block that holds the items from lane `at` of leaf l on. Returns the end of these. */
static uint32_t hit_part(const struct bvh *b, const struct slabs_leaf *l, uint32_t at,
    const struct ray *r, double t_max, struct block_hits *h)
{
    uint32_t left = l->first + l->n - at, from = at % LANES;
    uint32_t n = left < LANES - from ? left : LANES - from;
    h->block = at / LANES;
    h->mask = hit_block(b, (enum item_kind)l->kind, h->block, r, t_max, h->t, &h->items, &h->twice);
    h->mask &= ((1u << n) - 1) << from;
    b->tests->items += n;
    return at + n;
}

static void slabs_closest(const struct bvh *b, const struct ray *r, struct hit *h)
{
    struct walk w;
    struct block_hits p;
    const struct slabs_leaf *l;
    walk_start(&w, b, r, t_above(h->t));
    while ((l = walk_next(&w, t_above(h->t))))
        for (uint32_t at = l->first; at < l->first + l->n;) {
            at = hit_part(b, l, at, r, h->t, &p);
            while (p.mask) {
                int k = take_bit(&p.mask);
                if (p.t[k] < h->t || (p.t[k] == h->t && p.items[k] < h->item))
                    *h = (struct hit){p.t[k], p.items[k]};
            }
        }
}

static bool leaf_blocks(const struct bvh *b, const struct slabs_leaf *l, const struct ray *r,
    const uint8_t *transmits, struct crossings *c)
{
    struct block_hits p;
    for (uint32_t at = l->first; at < l->first + l->n;) {
        at = hit_part(b, l, at, r, r->t_max, &p);
        while (p.mask) {
            int k = take_bit(&p.mask);
            unsigned times = 1 + (p.twice >> k & 1);
            if (r->to_surface) times = crossed(b, (enum item_kind)l->kind, p.block, k, r, times);
            if (times && (!transmits || !transmits[p.items[k]])) return true;
            for (; times; times--) crossings_add(c, p.items[k]);
        }
    }
    return false;
}

static bool slabs_blocked(
    const struct bvh *b, const struct ray *r, const uint8_t *transmits, struct crossings *c)
{
    struct walk w;
    const struct slabs_leaf *l;
    float limit = t_above(r->t_max);
    walk_start(&w, b, r, limit);
    while ((l = walk_next(&w, limit)))
        if (leaf_blocks(b, l, r, transmits, c)) return true;
    return false;
}

/* ---- the kernels: whatever the hierarchy --------------------------------------------------- */

static void any_closest(const struct bvh *b, const struct ray *r, struct hit *h)
{
    b->tests->rays++;
    *h = (struct hit){r->t_max, NO_ITEM};
    if (!b->slabs) closest(b, r, h);
    else if (b->slabs->nodes) slabs_closest(b, r, h);
    else
        for (uint32_t kind = 0; kind < ITEM_KINDS; kind++)
            for (uint32_t i = 0; i < b->n_blocks[kind]; i++)
                closest_in_leaf(b, leaf_of(kind, 1, i), r, h);
}

static bool any_blocked(
    const struct bvh *b, const struct ray *r, const uint8_t *transmits, struct crossings *c)
{
    b->tests->rays++;
    if (!b->slabs) return blocked(b, r, transmits, c);
    if (b->slabs->nodes) return slabs_blocked(b, r, transmits, c);
    for (uint32_t kind = 0; kind < ITEM_KINDS; kind++)
        for (uint32_t i = 0; i < b->n_blocks[kind]; i++)
            if (blocked_in_leaf(b, leaf_of(kind, 1, i), r, transmits, c)) return true;
    return false;
}

static void any_closest_packet(
    const struct bvh *b, const struct ray *const *r, unsigned n, struct hit *const *h)
{
    for (unsigned i = 0; i < n; i++) any_closest(b, r[i], h[i]);
}

static unsigned any_blocked_packet(const struct bvh *b, const struct ray *const *r, unsigned n,
    const uint8_t *transmits, struct crossings *c)
{
    unsigned mask = 0;
    for (unsigned i = 0; i < n; i++) mask |= (unsigned)any_blocked(b, r[i], transmits, &c[i]) << i;
    return mask;
}

const struct kernels *slabs_kernels(void)
{
    static const struct kernels table = {
        "slabs", any_closest, any_blocked, any_closest_packet, any_blocked_packet};
    return &table;
}
