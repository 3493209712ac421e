/*
 * corners: the corners of a polygon in its plane, as a linked ring that shrinks corner by corner,
 * and the ear test. Private to lib/scene.
 */
#ifndef STORMRING_CORNERS_H
#define STORMRING_CORNERS_H

#include "geometry/geometry.h"
#include "scene/points.h"

#define CORNERS_STACK 256 /* more corners are stored on the heap */
#define CORNERS_NONE UINT32_MAX

struct corner {
    double x, y;
    uint32_t prev, next;
    bool blunt; /* reflex or straight: may lie in an ear, is not an ear; never becomes true again */
    bool gone;
    bool queued; /* waits in the queue */
    bool later;  /* moves to the end of the queue once, because a neighbour was removed */
};

struct corners {
    struct corner *c;
    uint32_t n, left;     /* number of corners at the start, and now */
    double width, height; /* extent of all corners */
    struct points blunt;  /* blunt corners by place: the ear test checks only nearby ones */
    uint32_t *queue;      /* circular, room for n */
    uint32_t queue_at, queue_n;
    uint64_t patience; /* remaining tests of corners that coincide with a corner of the ear */
    struct corner stack_c[CORNERS_STACK];
    struct plane_point stack_p[CORNERS_STACK];
    struct points_node stack_n[2 * CORNERS_STACK / POINTS_LEAF];
    uint32_t stack_u[2 * CORNERS_STACK];
};

/*
 * Builds the ring of a polygon, counterclockwise in its plane. Queues every corner, in order from
 * the second. False if the polygon has no area; then there is nothing to free.
 */
bool corners_init(struct corners *g, const struct vec3 *v, uint32_t n);
void corners_free(struct corners *g);
/*
 * Twice the area of the corner's triangle, positive if convex. 0 if the area is within its rounding
 * error.
 */
double corners_turn(const struct corners *g, uint32_t i);
/* For a convex corner: true if no other corner lies in its triangle. */
bool corners_is_ear(struct corners *g, uint32_t i);
/*
 * For a straight corner: true if it coincides with a neighbour or is the tip of an edge that runs
 * back on itself.
 */
bool corners_is_empty(const struct corners *g, uint32_t i);
/* Removes corner i. Its neighbours go to the end of the queue. */
void corners_remove(struct corners *g, uint32_t i);
/* The next corner to test, or CORNERS_NONE. */
uint32_t corners_pop(struct corners *g);

#endif
