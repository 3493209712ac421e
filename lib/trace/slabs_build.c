/* slabs_build: builds the hierarchy of slabs.h, and the blocks of its items. */
#include "trace/slabs.h"

#include <stdlib.h>
#include <string.h>

const double slabs_normal[SLABS][3] = {
    {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}, {1, -1, 1}, {1, 0, 0}};

struct build {
    struct slabs *slabs;
    const struct ref *refs; /* in the order of primitives */
    uint32_t n_refs;
    struct ref *leaves; /* a primitive each: a box, and in place of an item the first ref */
    const struct scene *scene;
    const struct item *items;
    double reach;
};

/* The end of the refs of the primitive that ref i belongs to. */
static uint32_t end_of(const struct build *b, uint32_t i)
{
    uint32_t prim = b->items[b->refs[i].item].prim;
    while (++i < b->n_refs && b->items[b->refs[i].item].prim == prim) {
    }
    return i;
}

/* By centre, then by number: the order is the same on every host. */
static bool before(const struct ref *a, const struct ref *b, int axis)
{
    float x = a->lo[axis] + a->hi[axis], y = b->lo[axis] + b->hi[axis];
    return x < y || (x == y && a->item < b->item);
}

static void swap_refs(struct ref *a, struct ref *b)
{
    struct ref t = *a;
    *a = *b;
    *b = t;
}

/* Moves the k smallest refs to the front (C. A. R. Hoare, "Algorithm 65: Find", CACM 4(7), 1961).
 * Random pivots, so that no scene takes long. */
static void select_front(struct ref *r, uint32_t n, uint32_t k, int axis)
{
    uint32_t lo = 0, hi = n;
    while (hi - lo > 1) {
        uint32_t at = lo;
        swap_refs(&r[lo + rng_u64(lo, hi) % (hi - lo)], &r[hi - 1]);
        for (uint32_t i = lo; i + 1 < hi; i++)
            if (before(&r[i], &r[hi - 1], axis)) swap_refs(&r[i], &r[at++]);
        swap_refs(&r[at], &r[hi - 1]);
        if (k <= at) hi = at;
        else lo = at + 1;
    }
}

static void bound_leaf(const struct build *b, uint32_t first, struct slabs_node *node)
{
    uint32_t end = end_of(b, first);
    for (int i = 0; i < SLABS; i++) {
        const double *n = slabs_normal[i];
        double lo = HUGE_VAL, hi = -HUGE_VAL;
        for (uint32_t k = first; k < end; k++) {
            const struct ref *r = &b->refs[k];
            double l, h;
            trace_shapes[r->kind]->extent(
                b->scene, &b->items[r->item], v3(n[0], n[1], n[2]), &l, &h);
            lo = l < lo ? l : lo;
            hi = h > hi ? h : hi;
        }
        node->lo[i] = (float)lo;
        node->hi[i] = (float)hi;
    }
}

/* Makes the node at index `node` of the leaves first .. first + n. */
static void build(const struct build *b, uint32_t node, uint32_t first, uint32_t n, int axis)
{
    struct slabs_node *to = &b->slabs->nodes[node];
    if (n == 1) {
        bound_leaf(b, b->leaves[first].item, to);
        return;
    }
    uint32_t half = n / 2, left = node + 1, right = node + 2 * half;
    select_front(b->leaves + first, n, half, axis);
    build(b, left, first, half, (axis + 1) % 3);
    build(b, right, first + half, n - half, (axis + 1) % 3);
    const struct slabs_node *l = &b->slabs->nodes[left], *r = &b->slabs->nodes[right];
    for (int i = 0; i < SLABS; i++) {
        to->lo[i] = l->lo[i] < r->lo[i] ? l->lo[i] : r->lo[i];
        to->hi[i] = l->hi[i] > r->hi[i] ? l->hi[i] : r->hi[i];
    }
}

/* Joins the refs of each primitive to one: a box around them, and the index of the first. */
static uint32_t join_refs(const struct build *b, uint32_t n_refs)
{
    uint32_t n = 0;
    for (uint32_t i = 0, end; i < n_refs; i = end) {
        struct ref *leaf = &b->leaves[n++];
        end = end_of(b, i);
        *leaf = b->refs[i];
        leaf->item = i;
        for (uint32_t k = i; k < end; k++)
            for (int a = 0; a < 3; a++) {
                const struct ref *r = &b->refs[k];
                leaf->lo[a] = r->lo[a] < leaf->lo[a] ? r->lo[a] : leaf->lo[a];
                leaf->hi[a] = r->hi[a] > leaf->hi[a] ? r->hi[a] : leaf->hi[a];
            }
    }
    return n;
}

static void put_item(const struct build *b, struct bvh *to, const struct ref *r, uint32_t at)
{
    const struct shape *shape = trace_shapes[r->kind];
    uint32_t lane = at % LANES;
    void *block = (char *)to->blocks[r->kind] + at / LANES * shape->block_size;
    for (int k = 0; lane == 0 && k < LANES; k++) shape->clear(block, k);
    shape->fill(b->scene, &b->items[r->item], b->reach, block, (int)lane);
    block_items(r->kind, block)[lane] = r->item;
}

/* Puts the items into blocks, in the order of the leaves. */
static void fill_blocks(const struct build *b, struct bvh *to)
{
    uint32_t count[ITEM_KINDS] = {0};
    for (uint32_t i = 0; i < b->n_refs; i++) count[b->refs[i].kind]++;
    for (int k = 0; k < ITEM_KINDS; k++) {
        to->n_blocks[k] = (count[k] + LANES - 1) / LANES;
        if (count[k]) to->blocks[k] = xaligned(to->n_blocks[k], trace_shapes[k]->block_size);
        count[k] = 0;
    }
    for (uint32_t i = 0; i < b->slabs->n; i++) {
        uint32_t from = b->leaves[i].item, end = end_of(b, from), kind = b->leaves[i].kind;
        b->slabs->leaves[i] = (struct slabs_leaf){kind, count[kind], end - from};
        for (uint32_t k = from; k < end; k++) put_item(b, to, &b->refs[k], count[kind]++);
    }
}

void slabs_build(struct bvh *b, const struct ref *refs, uint32_t n, const struct scene *s,
    const struct item *items, double reach, bool hierarchy)
{
    struct slabs *slabs = xcalloc(1, sizeof *slabs);
    struct build with = {slabs, refs, n, xaligned(n, sizeof *refs), s, items, reach};
    memset(b, 0, sizeof *b);
    b->slabs = slabs;
    b->slack = (float)(reach * 0x1p-22);
    slabs->n = join_refs(&with, n);
    slabs->leaves = xmalloc(slabs->n, sizeof *slabs->leaves);
    if (hierarchy && n) {
        slabs->nodes = xaligned((size_t)2 * slabs->n - 1, sizeof *slabs->nodes);
        slabs->heap = xmalloc(slabs->n, sizeof *slabs->heap);
        build(&with, 0, 0, slabs->n, 0);
    }
    fill_blocks(&with, b);
    free(with.leaves);
}

uint64_t slabs_bytes(const struct slabs *s)
{
    uint64_t n = s->n;
    if (!s->nodes) return 0;
    return (2 * n - 1) * sizeof *s->nodes + n * (sizeof *s->leaves + sizeof *s->heap);
}

void slabs_free(struct slabs *s)
{
    if (!s) return;
    free(s->nodes);
    free(s->leaves);
    free(s->heap);
    free(s);
}
