/*
 * slabs: the hierarchy of T. Kay, J. Kajiya, "Ray tracing complex scenes", SIGGRAPH 1986. A slab is
 * the space between two parallel planes. Each primitive, and each group of primitives, is bounded
 * by one slab of each of seven normals: along the axes, and along the diagonals of a cube. A group
 * is halved at the median of the centres, along x, y and z in turn, down to single primitives. A
 * heap holds the nodes that a ray enters, and the nearest leaves it first.
 *
 * Differs in: the planes are stored in float and widened, so that a test may report a volume that
 * the ray misses, but never misses one. A polygon or patch is tested by its triangles. Four items
 * share a block, as in the other hierarchy (trace_int.h), so the hits have the same bits.
 */
#ifndef STORMRING_TRACE_SLABS_H
#define STORMRING_TRACE_SLABS_H

#include "trace/trace_int.h"

#define SLABS 8 /* seven; the last repeats the first, to fill a vector */

/* The normals have length 1 or sqrt 3. */
extern const double slabs_normal[SLABS][3];

struct slabs_node {
    _Alignas(32) float lo[SLABS], hi[SLABS];
};

struct slabs_entry {
    float t;               /* where the ray enters the node */
    uint32_t node;         /* index into nodes */
    uint32_t first, count; /* the node's leaves */
};

/* The items of a primitive: n lanes of the blocks of their kind, from lane `first` on, counted
 * through all blocks. */
struct slabs_leaf {
    uint32_t kind, first, n;
};

struct slabs {
    /* 2n - 1, each followed by its left subtree, then its right one. Of a node of k leaves, k / 2
     * are in the left subtree. NULL: no hierarchy, or no item has a surface. */
    struct slabs_node *nodes;
    uint32_t n; /* leaves: primitives that have a surface */
    struct slabs_leaf *leaves;
    struct slabs_entry *heap; /* room for n: the nodes on the heap have different leaves */
};

#endif
