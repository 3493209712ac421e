/*
 * bvh: the hierarchy of eight children per node (H. Dammertz, J. Hanika, A. Keller, "Shallow
 * bounding volume hierarchies for fast SIMD ray tracing of incoherent rays", EGSR 2008; I. Wald, C.
 * Benthin, S. Boulos, "Getting rid of packets", RT 2008). Leaves are cut into blocks of items.
 *
 * Nodes are made from the root down, without a binary hierarchy in memory: a node opens the child
 * of largest surface until it has eight. Below the top, each subtree of at most a 64th of the
 * references is a task, and threads take tasks. The nodes of a task follow one another, as do its
 * blocks, in the order of tasks. So the hierarchy does not depend on the number of threads.
 */
#include "os/os.h"
#include "trace/sah.h"
#include "trace/shapes.h"
#include "trace/trace_int.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#define TASKS 64        /* about that many */
#define TASK_LEAST 1024 /* refs */
#define REFILL 1024     /* blocks that a thread takes */
#define LEAF_REFS_MAX (LANES * LEAF_BLOCKS_MAX)
/* Of a ref that begins a leaf: the number of refs is above its kind. */
#define KIND_BITS 8
#define KIND_MASK ((1U << KIND_BITS) - 1)

/*
 * A subtree, or the top of the tree. Until all tasks are done, a child in its nodes is a node of
 * the same task, or LEAF | the leaf's first ref.
 */
struct subtree {
    struct span span;
    uint32_t parent, lane;  /* where the top refers to it */
    struct node8 *nodes;    /* the first is its root */
    uint32_t n_nodes, room; /* room: of the top, which grows */
    uint32_t first_node;    /* in the finished hierarchy */
    uint32_t n_blocks[ITEM_KINDS], first_block[ITEM_KINDS];
};

struct making {
    struct bvh *b;
    struct ref *refs;
    const struct scene *scene;
    const struct item *items;
    double reach;
    struct parallel *parallel;
    uint32_t most;       /* refs of a task */
    struct node8 *nodes; /* room for the nodes of all tasks, most of it never touched */
    struct subtree top, *tasks;
    uint32_t n_tasks;
};

/* ---- nodes ---------------------------------------------------------------------------------- */

static uint32_t mark_leaf(struct making *m, const struct span *s)
{
    m->refs[s->first].kind |= s->n << KIND_BITS;
    return LEAF | s->first;
}

static uint32_t add_task(struct making *m, const struct span *s, uint32_t parent, uint32_t lane)
{
    m->tasks = xgrown(m->tasks, m->n_tasks, sizeof *m->tasks);
    m->tasks[m->n_tasks++] = (struct subtree){.span = *s, .parent = parent, .lane = lane};
    return NO_CHILD;
}

static uint32_t add_node(struct making *m, struct subtree *t)
{
    if (t == &m->top && t->n_nodes == t->room) {
        struct node8 *old = t->nodes;
        t->room = t->room ? 2 * t->room : TASKS;
        t->nodes = xaligned(t->room, sizeof *t->nodes);
        if (old) memcpy(t->nodes, old, t->n_nodes * sizeof *old);
        free(old);
    }
    return t->n_nodes++;
}

/* Opens the child of largest surface until there are WIDTH. Returns the number of children. */
static int open_children(
    struct making *m, struct parallel *p, struct span child[WIDTH], bool leaf[WIDTH], int n)
{
    while (n < WIDTH) {
        int best = -1;
        float largest = -1;
        for (int i = 0; i < n; i++)
            if (!leaf[i] && sah_area(&child[i].box) > largest) {
                largest = sah_area(&child[i].box);
                best = i;
            }
        if (best < 0) break;
        struct span half[2];
        if (!sah_split(m->refs, &child[best], half, p)) {
            leaf[best] = true;
            continue;
        }
        child[best] = half[0];
        child[n++] = half[1];
    }
    return n;
}

/* A task splits at least once: it has a root. */
static bool is_task(const struct making *m, const struct span *s)
{
    return s->n <= m->most && s->n > LEAF_REFS_MAX;
}

/* Makes the node above the first n children, which may be leaves. */
static uint32_t make_node(struct making *m, struct subtree *t, struct span child[WIDTH], int n)
{
    bool leaf[WIDTH] = {false};
    struct parallel *p = t == &m->top ? m->parallel : NULL;
    uint32_t k = add_node(m, t);
    n = open_children(m, p, child, leaf, n);
    struct node8 *node = &t->nodes[k];
    memset(node, 0, sizeof *node);
    node->used = (1u << n) - 1;
    for (int i = 0; i < WIDTH; i++) {
        for (int a = 0; a < 3; a++) {
            node->lo[a][i] = i < n ? child[i].box.lo[a] : INFINITY;
            node->hi[a][i] = i < n ? child[i].box.hi[a] : -INFINITY;
        }
        node->child[i] = NO_CHILD;
    }
    for (int i = 0; i < n; i++) {
        struct span half[WIDTH];
        bool task = t == &m->top && is_task(m, &child[i]);
        if (!leaf[i] && !task) leaf[i] = !sah_split(m->refs, &child[i], half, p);
        t->nodes[k].child[i] = leaf[i] ? mark_leaf(m, &child[i])
                               : task  ? add_task(m, &child[i], k, (uint32_t)i)
                                       : make_node(m, t, half, 2);
    }
    return k;
}

/* Counts the blocks of each kind that the leaves of a task need. */
static void count_blocks(const struct making *m, struct subtree *t)
{
    for (uint32_t k = 0; k < t->n_nodes; k++)
        for (int i = 0; i < WIDTH; i++) {
            uint32_t c = t->nodes[k].child[i];
            if (!(t->nodes[k].used >> i & 1) || !(c & LEAF) || c == NO_CHILD) continue;
            uint32_t kind = m->refs[c & ~LEAF].kind;
            t->n_blocks[kind & KIND_MASK] += ((kind >> KIND_BITS) + LANES - 1) / LANES;
        }
}

static void run_task(void *ctx, uint32_t i)
{
    struct making *m = ctx;
    struct subtree *t = &m->tasks[i];
    struct span child[WIDTH] = {t->span};
    t->nodes = m->nodes + t->span.first; /* n refs have at most n nodes */
    make_node(m, t, child, 1);
    count_blocks(m, t);
}

/* ---- leaves --------------------------------------------------------------------------------- */

static void fill_block(
    const struct making *m, uint32_t kind, void *block, const struct ref *r, uint32_t n)
{
    const struct shape *shape = trace_shapes[kind];
    for (uint32_t lane = 0; lane < LANES; lane++) {
        shape->clear(block, (int)lane);
        if (lane >= n) continue;
        shape->fill(m->scene, &m->items[r[lane].item], m->reach, block, (int)lane);
        block_items(kind, block)[lane] = r[lane].item;
    }
}

/* Fills the blocks of a leaf, the next of their kind. Returns the child that refers to them. */
static uint32_t make_leaf(const struct making *m, uint32_t next[ITEM_KINDS], const struct ref *r)
{
    uint32_t kind = r->kind & KIND_MASK, n = r->kind >> KIND_BITS;
    uint32_t first = next[kind], n_blocks = (n + LANES - 1) / LANES;
    size_t size = trace_shapes[kind]->block_size;
    for (uint32_t i = 0; i < n_blocks; i++) {
        uint32_t left = n - i * LANES;
        fill_block(m, kind, (char *)m->b->blocks[kind] + (first + i) * size, r + i * LANES,
            left < LANES ? left : LANES);
    }
    next[kind] += n_blocks;
    return leaf_of(kind, n_blocks, first);
}

static void make_leaves(const struct making *m, const struct subtree *t)
{
    uint32_t next[ITEM_KINDS];
    memcpy(next, t->first_block, sizeof next);
    for (uint32_t k = 0; k < t->n_nodes; k++) {
        struct node8 *node = &m->b->nodes[t->first_node + k];
        for (int i = 0; i < WIDTH; i++)
            if (node->used >> i & 1 && node->child[i] & LEAF)
                node->child[i] = make_leaf(m, next, &m->refs[node->child[i] & ~LEAF]);
    }
}

static void fill_task(void *ctx, uint32_t i)
{
    struct making *m = ctx;
    struct subtree *t = &m->tasks[i];
    for (int k = 0; k < ITEM_KINDS; k++) {
        uint32_t end = i + 1 < m->n_tasks ? t[1].first_block[k] : m->b->n_blocks[k];
        size_t size = trace_shapes[k]->block_size, at = t->first_block[k] * size;
        if (end * size > at) os_populate((char *)m->b->blocks[k] + at, end * size - at);
    }
    make_leaves(m, t);
    os_discard(m->refs + t->span.first, t->span.n * sizeof *m->refs);
}

/* ---- the hierarchy -------------------------------------------------------------------------- */

/* Copies the nodes of a task to where they stay. */
static void move_task(void *ctx, uint32_t i)
{
    struct making *m = ctx;
    struct subtree *t = &m->tasks[i];
    struct node8 *to = m->b->nodes + t->first_node;
    memcpy(to, t->nodes, t->n_nodes * sizeof *to);
    for (uint32_t k = 0; k < t->n_nodes; k++)
        for (int c = 0; c < WIDTH; c++)
            if (!(to[k].child[c] & LEAF)) to[k].child[c] += t->first_node;
}

/* Numbers the nodes and blocks of the tasks, and allocates them. */
static void number(struct making *m)
{
    struct bvh *b = m->b;
    b->n_nodes = m->top.n_nodes;
    count_blocks(m, &m->top);
    memcpy(b->n_blocks, m->top.n_blocks, sizeof b->n_blocks);
    for (uint32_t i = 0; i < m->n_tasks; i++) {
        struct subtree *t = &m->tasks[i];
        t->first_node = b->n_nodes;
        b->n_nodes += t->n_nodes;
        if (m->top.n_nodes) m->top.nodes[t->parent].child[t->lane] = t->first_node;
        for (int k = 0; k < ITEM_KINDS; k++) {
            t->first_block[k] = b->n_blocks[k];
            b->n_blocks[k] += t->n_blocks[k];
        }
    }
    b->nodes = xaligned(b->n_nodes, sizeof *b->nodes);
    os_large_pages(b->nodes, b->n_nodes * sizeof *b->nodes);
    if (m->top.n_nodes) memcpy(b->nodes, m->top.nodes, m->top.n_nodes * sizeof *b->nodes);
    for (int k = 0; k < ITEM_KINDS; k++)
        if (b->n_blocks[k] > LEAF_FIRST_MASK) die(ST_SYSTEM, "too many primitives");
}

void bvh_build(struct bvh *b, struct ref *refs, uint32_t n, const struct scene *s,
    const struct item *items, double reach, struct parallel *p)
{
    memset(b, 0, sizeof *b);
    if (n == 0) return;
    struct making m = {b, refs, s, items, reach, p, .most = n / TASKS};
    if (m.most < TASK_LEAST) m.most = TASK_LEAST;
    struct span child[WIDTH] = {sah_all(refs, n, p)};
    if (is_task(&m, child)) add_task(&m, child, 0, 0);
    else make_node(&m, &m.top, child, 1);
    m.nodes = xaligned(n, sizeof *m.nodes);
    parallel_run(p, m.n_tasks, run_task, &m);
    number(&m);
    parallel_run(p, m.n_tasks, move_task, &m);
    free(m.nodes);
    for (int k = 0; k < ITEM_KINDS; k++) {
        const size_t size = trace_shapes[k]->block_size;
        if (!b->n_blocks[k]) continue;
        b->blocks[k] = xaligned(b->n_blocks[k], size);
        os_large_pages(b->blocks[k], b->n_blocks[k] * size);
    }
    make_leaves(&m, &m.top);
    parallel_run(p, m.n_tasks, fill_task, &m);
    free(m.top.nodes);
    free(m.tasks);
    b->slack = (float)(reach * 0x1p-22);
}

/* ---- another reach -------------------------------------------------------------------------- */

struct refill {
    const struct bvh *b;
    const struct scene *scene;
    const struct item *items;
    double reach;
    uint32_t kind;
};

static void refill_part(void *ctx, uint32_t part)
{
    const struct refill *f = ctx;
    const struct shape *shape = trace_shapes[f->kind];
    uint32_t at = part * REFILL, end = at + REFILL;
    if (end > f->b->n_blocks[f->kind]) end = f->b->n_blocks[f->kind];
    for (; at < end; at++) {
        void *block = (char *)f->b->blocks[f->kind] + at * shape->block_size;
        const uint32_t *item = block_items(f->kind, block);
        for (int k = 0; k < LANES; k++)
            if (item[k] != NO_ITEM) shape->fill(f->scene, &f->items[item[k]], f->reach, block, k);
    }
}

void bvh_reach(struct bvh *b, const struct scene *s, const struct item *items, double reach,
    struct parallel *p)
{
    for (uint32_t kind = 0; kind < ITEM_KINDS; kind++) {
        struct refill f = {b, s, items, reach, kind};
        parallel_run(p, (b->n_blocks[kind] + REFILL - 1) / REFILL, refill_part, &f);
    }
    b->slack = (float)(reach * 0x1p-22);
}

/* ---- points on surfaces --------------------------------------------------------------------- */

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
