/* corners: projection, orientation and ear test of a polygon's corners. */
#include "scene/corners.h"
#include "scene/reader.h"

#include <stdlib.h>

/* Bound on the rounding error of cross2, relative to the sum of its two products' magnitudes
 * (J. R. Shewchuk, "Adaptive precision floating-point arithmetic ...", 1997: (3 + 16 eps) eps). */
#define CROSS_ERROR 3.4e-16
#define PATIENCE (UINT64_C(1) << 31) /* tests of coinciding corners: about 20 s */

/*
 * Twice the area of a b c, positive if counterclockwise. 0 if it is within its rounding error.
 */
static double cross2(const struct corner *a, const struct corner *b, const struct corner *c)
{
    double l = (b->x - a->x) * (c->y - a->y), r = (b->y - a->y) * (c->x - a->x);
    return fabs(l - r) <= CROSS_ERROR * (fabs(l) + fabs(r)) ? 0 : l - r;
}

double corners_turn(const struct corners *g, uint32_t i)
{
    const struct corner *b = &g->c[i];
    return cross2(&g->c[b->prev], b, &g->c[b->next]);
}

bool corners_is_empty(const struct corners *g, uint32_t i)
{
    const struct corner *b = &g->c[i], *a = &g->c[b->prev], *c = &g->c[b->next];
    return (a->x - b->x) * (c->x - b->x) + (a->y - b->y) * (c->y - b->y) >= 0;
}

/* ---- ears ----------------------------------------------------------------------------- */

static bool same_place(const struct corner *a, const struct corner *b)
{
    return a->x == b->x && a->y == b->y;
}

/* True if p lies strictly between the two edges that meet at corner b (a before it, c after). */
static bool in_wedge(
    const struct corner *a, const struct corner *b, const struct corner *c, const struct corner *p)
{
    return cross2(a, b, p) > 0 && cross2(b, c, p) > 0;
}

/*
 * True if q, a corner other than a, b and c, prevents the ear a b c. A corner may coincide with a
 * corner of the ear (a bridge joins a hole to the outline). Then q prevents the ear only if one of
 * its own edges leads into the ear.
 */
static bool spoils(const struct corners *g, const struct corner *a, const struct corner *b,
    const struct corner *c, const struct corner *q)
{
    const struct corner *p = &g->c[q->prev], *n = &g->c[q->next];
    if (same_place(q, b)) return in_wedge(a, b, c, p) || in_wedge(a, b, c, n);
    if (same_place(q, a)) return in_wedge(c, a, b, p) || in_wedge(c, a, b, n);
    if (same_place(q, c)) return in_wedge(b, c, a, p) || in_wedge(b, c, a, n);
    return cross2(a, b, q) >= 0 && cross2(b, c, q) >= 0 && cross2(c, a, q) >= 0;
}

struct ear {
    struct corners *g;
    const struct corner *a, *b, *c;
};

static bool spoils_ear(void *ctx, uint32_t i)
{
    const struct ear *e = ctx;
    const struct corner *q = &e->g->c[i], *a = e->a, *b = e->b, *c = e->c;
    if (q == a || q == b || q == c) return false;
    /* Coinciding corners are tested one by one. After PATIENCE tests they all count as spoiling,
     * because the tests would take hours. */
    if (same_place(q, a) || same_place(q, b) || same_place(q, c)) {
        if (!e->g->patience) return true;
        e->g->patience--;
    }
    return spoils(e->g, a, b, c, q);
}

bool corners_is_ear(struct corners *g, uint32_t i)
{
    const struct corner *b = &g->c[i], *a = &g->c[b->prev], *c = &g->c[b->next];
    const struct points_triangle t = {{a->x, b->x, c->x}, {a->y, b->y, c->y}, g->width, g->height};
    return !points_any(&g->blunt, &t, spoils_ear, &(struct ear){g, a, b, c});
}

/* ---- the queue ------------------------------------------------------------------------ */

static void push(struct corners *g, uint32_t i)
{
    g->queue[(g->queue_at + g->queue_n++) % g->n] = i;
    g->c[i].queued = true;
}

uint32_t corners_pop(struct corners *g)
{
    while (g->queue_n) {
        uint32_t i = g->queue[g->queue_at];
        struct corner *c = &g->c[i];
        g->queue_at = (g->queue_at + 1) % g->n;
        g->queue_n--;
        c->queued = false;
        if (c->gone) continue;
        if (!c->later) return i;
        c->later = false;
        push(g, i);
    }
    return CORNERS_NONE;
}

/* Marks corner i as not blunt, or as removed. */
static void sharpen(struct corners *g, uint32_t i)
{
    if (g->c[i].blunt) points_remove(&g->blunt, i);
    g->c[i].blunt = false;
}

static void put_off(struct corners *g, uint32_t i)
{
    struct corner *c = &g->c[i];
    if (c->blunt && corners_turn(g, i) > 0) sharpen(g, i);
    if (c->queued) c->later = true;
    else push(g, i);
}

void corners_remove(struct corners *g, uint32_t i)
{
    struct corner *b = &g->c[i];
    g->c[b->prev].next = b->next;
    g->c[b->next].prev = b->prev;
    b->gone = true;
    sharpen(g, i);
    g->left--;
    put_off(g, b->prev);
    put_off(g, b->next);
}

/* ---- making one ----------------------------------------------------------------------- */

static struct vec3 newell(const struct vec3 *v, uint32_t n)
{
    struct vec3 sum = v3(0, 0, 0);
    /* Relative to the first vertex, which keeps the normal accurate far from the origin. */
    for (uint32_t i = 1; i + 1 < n; i++)
        sum = v3_add(sum, v3_cross(v3_sub(v[i], v[0]), v3_sub(v[i + 1], v[0])));
    return sum;
}

struct vec3 scene_newell_unit(const struct vec3 *v, uint32_t n)
{
    struct vec3 sum = newell(v, n);
    double len = v3_len(sum);
    return len > 0 ? v3_scale(sum, 1 / len) : v3(0, 0, 1);
}

/*
 * Projects along the normal's largest component, mirrored if needed so that the polygon is
 * counterclockwise. The coordinates are used as read, so nothing is rounded before the orientation
 * tests.
 */
static void project(struct corners *g, const struct vec3 *v, struct vec3 normal)
{
    double ax = fabs(normal.x), ay = fabs(normal.y), az = fabs(normal.z);
    for (uint32_t i = 0; i < g->n; i++) {
        struct corner *c = &g->c[i];
        bool flip;
        if (az >= ax && az >= ay) c->x = v[i].x, c->y = v[i].y, flip = normal.z < 0;
        else if (ax >= ay) c->x = v[i].y, c->y = v[i].z, flip = normal.x < 0;
        else c->x = v[i].z, c->y = v[i].x, flip = normal.y < 0;
        if (flip) c->x = -c->x;
        c->prev = (i ? i : g->n) - 1;
        c->next = i + 1 < g->n ? i + 1 : 0;
        c->gone = c->later = false;
    }
}

static void gather_blunt(struct corners *g)
{
    double x0 = HUGE_VAL, y0 = HUGE_VAL, x1 = -HUGE_VAL, y1 = -HUGE_VAL;
    for (uint32_t i = 0; i < g->n; i++) {
        struct corner *c = &g->c[i];
        x0 = fmin(x0, c->x), x1 = fmax(x1, c->x);
        y0 = fmin(y0, c->y), y1 = fmax(y1, c->y);
        c->blunt = corners_turn(g, i) <= 0;
        if (c->blunt) g->blunt.at[g->blunt.n++] = (struct plane_point){c->x, c->y, i};
    }
    g->width = x1 - x0;
    g->height = y1 - y0;
    points_build(&g->blunt);
}

bool corners_init(struct corners *g, const struct vec3 *v, uint32_t n)
{
    struct vec3 normal = newell(v, n);
    if (normal.x == 0 && normal.y == 0 && normal.z == 0) return false;
    g->n = g->left = n;
    g->patience = PATIENCE;
    g->queue_at = g->queue_n = 0;
    g->c = g->stack_c;
    g->queue = g->stack_u;
    g->blunt = (struct points){.at = g->stack_p, .node = g->stack_n};
    if (n > CORNERS_STACK) {
        g->c = xmalloc(n, sizeof *g->c);
        g->queue = xmalloc(n, 2 * sizeof *g->queue);
        g->blunt.at = xmalloc(n, sizeof *g->blunt.at);
        g->blunt.node = xmalloc(points_nodes(n), sizeof *g->blunt.node);
    }
    g->blunt.place = g->queue + n;
    project(g, v, normal);
    gather_blunt(g);
    for (uint32_t i = 0; i < n; i++) push(g, i + 1 < n ? i + 1 : 0);
    return true;
}

void corners_free(struct corners *g)
{
    if (g->c == g->stack_c) return;
    free(g->c);
    free(g->queue);
    free(g->blunt.at);
    free(g->blunt.node);
}
