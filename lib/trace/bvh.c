/*
 * bvh: the binary hierarchy collapsed to eight children per node (H. Dammertz, J. Hanika, A.
 * Keller, "Shallow bounding volume hierarchies for fast SIMD ray tracing of incoherent rays", EGSR
 * 2008; I. Wald, C. Benthin, S. Boulos, "Getting rid of packets", RT 2008). Leaves are cut into
 * blocks of items.
 */
#include "trace/ends.h"
#include "trace/trace_int.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

struct collapse {
    struct bvh *b;
    const struct bnode *bin;
    const struct ref *refs;
    const struct scene *scene;
    const struct item *items;
    double reach;
};

static float area(const struct bnode *n)
{
    float x = n->hi[0] - n->lo[0], y = n->hi[1] - n->lo[1], z = n->hi[2] - n->lo[2];
    return x * y + y * z + z * x;
}

static bool is_leaf(const struct bnode *n) { return n->right == NO_CHILD; }

static void fill_block(
    struct collapse *c, uint32_t kind, void *block, const struct ref *r, uint32_t n)
{
    const struct shape *shape = trace_shapes[kind];
    for (uint32_t lane = 0; lane < LANES; lane++) {
        shape->clear(block, (int)lane);
        if (lane >= n) continue;
        shape->fill(c->scene, &c->items[r[lane].item], c->reach, block, (int)lane);
        block_items(kind, block)[lane] = r[lane].item;
    }
}

static uint32_t make_leaf(struct collapse *c, const struct bnode *leaf)
{
    const struct ref *r = c->refs + leaf->left;
    uint32_t kind = r->kind, first = c->b->n_blocks[kind], n = (leaf->count + LANES - 1) / LANES;
    size_t size = trace_shapes[kind]->block_size;
    if (first + n > LEAF_FIRST_MASK) die(ST_SYSTEM, "too many primitives");
    for (uint32_t i = 0; i < n; i++) {
        uint32_t left = leaf->count - i * LANES;
        fill_block(c, kind, (char *)c->b->blocks[kind] + (first + i) * size, r + i * LANES,
            left < LANES ? left : LANES);
    }
    c->b->n_blocks[kind] += n;
    return leaf_of(kind, n, first);
}

/* Finds up to eight descendants of bin[root]: opens the node with the largest surface until there
 * are eight. Returns their number. */
static int gather(const struct bnode *bin, uint32_t root, uint32_t out[WIDTH])
{
    int n = 1;
    out[0] = root;
    while (n < WIDTH) {
        int best = -1;
        float largest = -1;
        for (int i = 0; i < n; i++)
            if (!is_leaf(&bin[out[i]]) && area(&bin[out[i]]) > largest) {
                largest = area(&bin[out[i]]);
                best = i;
            }
        if (best < 0) break;
        uint32_t open = out[best];
        out[best] = bin[open].left;
        out[n++] = bin[open].right;
    }
    return n;
}

static uint32_t make_node(struct collapse *c, uint32_t root)
{
    uint32_t child[WIDTH], k = c->b->n_nodes++;
    int n = gather(c->bin, root, child);
    c->b->nodes[k].used = (1u << n) - 1;
    for (int i = 0; i < WIDTH; i++) {
        struct node8 *node = &c->b->nodes[k];
        for (int a = 0; a < 3; a++) {
            node->lo[a][i] = i < n ? c->bin[child[i]].lo[a] : INFINITY;
            node->hi[a][i] = i < n ? c->bin[child[i]].hi[a] : -INFINITY;
        }
        if (i >= n) node->child[i] = NO_CHILD;
        else if (is_leaf(&c->bin[child[i]])) node->child[i] = make_leaf(c, &c->bin[child[i]]);
        else node->child[i] = make_node(c, child[i]);
    }
    return k;
}

/* Counts the blocks of each kind that the leaves need. */
static void count_blocks(
    const struct bnode *bin, uint32_t n, const struct ref *refs, uint32_t count[])
{
    for (uint32_t i = 0; i < n; i++)
        if (is_leaf(&bin[i])) count[refs[bin[i].left].kind] += (bin[i].count + LANES - 1) / LANES;
}

void bvh_build(struct bvh *b, struct ref *refs, uint32_t n, const struct scene *s,
    const struct item *items, double reach)
{
    memset(b, 0, sizeof *b);
    if (n == 0) return;
    struct bnode *bin = xmalloc((size_t)2 * n, sizeof *bin);
    uint32_t n_bin = sah_build(bin, refs, n), count[ITEM_KINDS] = {0};
    count_blocks(bin, n_bin, refs, count);
    for (int k = 0; k < ITEM_KINDS; k++)
        if (count[k]) b->blocks[k] = xaligned(count[k], trace_shapes[k]->block_size);
    b->nodes = xaligned(n_bin / 2 + 1, sizeof *b->nodes);
    struct collapse c = {b, bin, refs, s, items, reach};
    make_node(&c, 0);
    free(bin);
    b->slack = (float)(reach * 0x1p-22);
}

struct point {
    const struct scene *scene;
    const struct item *items;
    struct vec3 p;
    double err;
};

/* The slack covers the rounding of lo and hi to float. */
static bool within(struct vec3 p, struct vec3 lo, struct vec3 hi, float slack)
{
    double s = (double)slack;
    return lo.x - s <= p.x && p.x <= hi.x + s && lo.y - s <= p.y && p.y <= hi.y + s &&
           lo.z - s <= p.z && p.z <= hi.z + s;
}

/* Tests the item's own bounds, so that the answer does not depend on the hierarchy. */
static bool lane_holds(
    const struct bvh *b, enum item_kind kind, uint32_t at, int k, const struct point *a)
{
    const struct shape *shape = trace_shapes[kind];
    uint32_t item = block_items(kind, (char *)b->blocks[kind] + at * shape->block_size)[k];
    struct vec3 lo, hi;
    if (item == NO_ITEM || !on_surface(b, kind, at, k, a->p, a->err)) return false;
    shape->bounds(a->scene, &a->items[item], &lo, &hi);
    return within(a->p, lo, hi, b->slack);
}

static bool blocks_hold(
    const struct bvh *b, enum item_kind kind, uint32_t first, uint32_t n, const struct point *a)
{
    for (uint32_t i = first; i < first + n; i++)
        for (int k = 0; k < LANES; k++)
            if (lane_holds(b, kind, i, k, a)) return true;
    return false;
}

static bool below_holds(const struct bvh *b, uint32_t child, const struct point *a)
{
    if (child & LEAF)
        return blocks_hold(b, leaf_kind(child), leaf_first(child), leaf_count(child), a);
    const struct node8 *n = &b->nodes[child];
    for (int i = 0; i < WIDTH; i++) {
        struct vec3 lo = v3((double)n->lo[0][i], (double)n->lo[1][i], (double)n->lo[2][i]);
        struct vec3 hi = v3((double)n->hi[0][i], (double)n->hi[1][i], (double)n->hi[2][i]);
        bool in = (n->used >> i & 1) && within(a->p, lo, hi, 2 * b->slack);
        if (in && below_holds(b, n->child[i], a)) return true;
    }
    return false;
}

bool bvh_holds(
    const struct bvh *b, const struct scene *s, const struct item *items, struct vec3 p, double err)
{
    const struct point a = {s, items, p, err};
    if (b->nodes) return below_holds(b, 0, &a);
    for (int kind = 0; kind < ITEM_KINDS; kind++)
        if (blocks_hold(b, (enum item_kind)kind, 0, b->n_blocks[kind], &a)) return true;
    return false;
}

void bvh_free(struct bvh *b)
{
    free(b->nodes);
    slabs_free(b->slabs);
    for (int k = 0; k < ITEM_KINDS; k++) free(b->blocks[k]);
    memset(b, 0, sizeof *b);
}
