/*
 * points: points of a plane, which can be removed one by one, and a search: does a triangle contain
 * a remaining point with a given property? A k-d tree (J. L. Bentley, "Multidimensional binary
 * search trees used for associative searching", Communications of the ACM 18(9), 1975). Building
 * takes n log n steps, a removal log n, and a search of an empty triangle in the order of sqrt(n),
 * for any distribution of points. Private to lib/scene.
 */
#ifndef STORMRING_SCENE_POINTS_H
#define STORMRING_SCENE_POINTS_H

#include "base/base.h"

#define POINTS_LEAF 8 /* maximum number of points per leaf */

struct plane_point {
    double x, y;
    uint32_t id;
};

struct points_node {
    double x0, y0, x1, y1; /* bounds of all points that were below this node */
    uint32_t left;         /* points still below it */
};

struct points {
    struct plane_point *at;   /* in tree order; the remaining points of each leaf come first */
    uint32_t n, leaves;       /* number of points at the start; leaves, a power of two */
    uint32_t *place;          /* by id: index into `at` */
    struct points_node *node; /* 1: root; children of k: 2 k, 2 k + 1; from `leaves` on: leaves */
};

/* Number of nodes that n points need. */
uint32_t points_nodes(uint32_t n);
/* Builds the tree over p->at, of p->n points. The caller owns all memory. */
void points_build(struct points *p);
/* Removes the point with this id, which must exist. */
void points_remove(struct points *p, uint32_t id);
/*
 * A counterclockwise triangle. points_any returns true if `is` returns true for a remaining point
 * in the triangle. It also tests points that are within the rounding error of a cross product from
 * an edge, relative to the products of the extents below. It may test other points as well.
 */
struct points_triangle {
    double x[3], y[3];
    double width, height; /* extent of all coordinates involved */
};
bool points_any(const struct points *p, const struct points_triangle *t,
    bool (*is)(void *ctx, uint32_t id), void *ctx);

#endif
