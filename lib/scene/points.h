/*
 * points: points of a plane that are taken away one by one, and the question whether one that is
 * left lies in a triangle and is such and such. A k-d tree (J. L. Bentley, "Multidimensional binary
 * search trees used for associative searching", Communications of the ACM 18(9), 1975): n points
 * are put in order in n log n steps, one is taken away in log n, and a triangle without points is
 * found to be so in the order of sqrt(n), however the points lie. Private to lib/scene.
 */
#ifndef STORMRING_SCENE_POINTS_H
#define STORMRING_SCENE_POINTS_H

#include "base/base.h"

#define POINTS_LEAF 8 /* points of a leaf, at most */

struct point {
    double x, y;
    uint32_t id;
};

struct points_node {
    double x0, y0, x1, y1; /* bounds of all that were below it */
    uint32_t left;         /* points that still are */
};

struct points {
    struct point *at;   /* in the tree's order; in each leaf, those that are left come first */
    uint32_t n, leaves; /* points at first; leaves, a power of two */
    uint32_t *place;    /* by id: where in `at` */
    struct points_node *node; /* 1: the root; below k: 2 k and 2 k + 1; from `leaves` on: leaves */
};

/* Nodes that n points need. */
uint32_t points_nodes(uint32_t n);
/* Puts p->at, of p->n points, in order. All memory is the caller's. */
void points_build(struct points *p);
/* Takes away the point of this id, which is there. */
void points_remove(struct points *p, uint32_t id);
/*
 * Whether `is` says yes to one of the points left in the triangle, which is counterclockwise; it
 * is asked about those within `slack` of an edge, too: of the rounding error of a cross product,
 * relative to the products of these extents of all coordinates. It may be asked about others.
 */
struct points_triangle {
    double x[3], y[3];
    double width, height; /* of what all coordinates in question span */
};
bool points_any(const struct points *p, const struct points_triangle *t,
    bool (*is)(void *ctx, uint32_t id), void *ctx);

#endif
