/*
 * corners: the corners of a polygon in its plane, linked in a ring that loses corner after corner,
 * and the question whether a corner is an ear. Private to lib/scene.
 */
#ifndef STORMRING_CORNERS_H
#define STORMRING_CORNERS_H

#include "base/base.h"
#include "scene/points.h"

#define CORNERS_STACK 256 /* corners that need no memory from the heap */
#define CORNERS_NONE UINT32_MAX

struct corner {
    double x, y;
    uint32_t prev, next;
    bool blunt; /* reflex or straight: may lie in an ear, and is none; once not so, never again */
    bool gone;
    bool queued; /* waits to be looked at */
    bool later;  /* its turn in the queue was put off: a neighbour has just gone */
};

struct corners {
    struct corner *c;
    uint32_t n, left;     /* corners at first, and now */
    double width, height; /* of the whole */
    struct points blunt;  /* the blunt corners by place, so that an ear asks only those near it */
    uint32_t *queue;      /* circular, room for n */
    uint32_t queue_at, queue_n;
    uint64_t patience; /* so many corners that coincide with one of an ear's may still be asked */
    struct corner stack_c[CORNERS_STACK];
    struct point stack_p[CORNERS_STACK];
    struct points_node stack_n[2 * CORNERS_STACK / POINTS_LEAF];
    uint32_t stack_u[2 * CORNERS_STACK];
};

/*
 * The ring of a polygon, counterclockwise in its plane; every corner is queued, in order from the
 * second. False, and nothing to free, when the polygon has no area.
 */
bool corners_init(struct corners *g, const struct vec3 *v, uint32_t n);
void corners_free(struct corners *g);
/*
 * Twice the area of the corner's triangle: positive when convex; 0 when that is within its
 * rounding error.
 */
double corners_turn(const struct corners *g, uint32_t i);
/* Of a convex corner: no other corner lies in its triangle. */
bool corners_is_ear(struct corners *g, uint32_t i);
/*
 * Of a straight corner: it repeats a neighbour's place, or is the tip of an edge that goes
 * there and back.
 */
bool corners_is_empty(const struct corners *g, uint32_t i);
/* Takes corner i out. Its neighbours are queued, behind all that wait. */
void corners_remove(struct corners *g, uint32_t i);
/* The next corner to look at, or CORNERS_NONE. */
uint32_t corners_pop(struct corners *g);

#endif
