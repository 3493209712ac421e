/*
 * Polygons to triangles: ear clipping (G. H. Meisters, "Polygons have ears", American Mathematical Monthly 82,
 * 1975) on the projection along the largest component of Newell's normal (I. Sutherland, R. Sproull,
 * R. Schumacker, "A characterization of ten hidden-surface algorithms", Computing Surveys 6(1), 1974), which keeps the
 * coordinates as they are read: no rounding before the orientation tests.
 *
 * Only reflex vertices can spoil an ear, so only they are looked at. Every round removes one vertex, whatever the
 * polygon: where no ear is left (edges that cross) the next convex vertex is cut off as if it were one. A vertex
 * that coincides with an ear's corner (holes joined to the outline by a bridge) spoils it only where one of
 * its own edges leads into the ear.
 */
#include "scene/scene.h"
#include "scene/reader.h"

#include <stdlib.h>
#include <string.h>

#define STACK_CORNERS 256 /* larger polygons take memory from the heap */
/* Bound on the rounding error of cross2, relative to the sum of its two products' magnitudes
 * (J. R. Shewchuk, "Adaptive precision floating-point arithmetic ...", 1997: (3 + 16 eps) eps). */
#define CROSS_ERROR 3.4e-16

struct corner {
    double x, y;
    uint32_t prev, next;
    bool reflex; /* or straight: anything that is no convex corner */
    bool gone;
};

struct ring {
    struct corner *c;
    uint32_t left;      /* corners not removed */
    uint32_t *reflex;   /* those that were reflex at the start, and may be still */
    uint32_t n_reflex;
};

static struct vec3 newell(const struct vec3 *v, uint32_t n)
{
    struct vec3 sum = v3(0, 0, 0);
    /* Relative to the first vertex: a polygon far from the origin keeps its normal. */
    for (uint32_t i = 1; i + 1 < n; i++)
        sum = v3_add(sum, v3_cross(v3_sub(v[i], v[0]), v3_sub(v[i + 1], v[0])));
    return sum;
}

struct vec3 newell_unit(const struct vec3 *v, uint32_t n)
{
    struct vec3 sum = newell(v, n);
    double len = v3_len(sum);
    return len > 0 ? v3_scale(sum, 1 / len) : v3(0, 0, 1);
}

/* Twice the area of a b c, positive when counterclockwise; 0 when that is within its rounding error. */
static double cross2(const struct corner *a, const struct corner *b, const struct corner *c)
{
    double l = (b->x - a->x) * (c->y - a->y), r = (b->y - a->y) * (c->x - a->x);
    return fabs(l - r) <= CROSS_ERROR * (fabs(l) + fabs(r)) ? 0 : l - r;
}

static bool same_place(const struct corner *a, const struct corner *b)
{
    return a->x == b->x && a->y == b->y;
}

/* Whether p lies strictly between the two edges of the ear that meet at corner b (a before it, c after). */
static bool in_wedge(
    const struct corner *a, const struct corner *b, const struct corner *c, const struct corner *p)
{
    return cross2(a, b, p) > 0 && cross2(b, c, p) > 0;
}

/* Whether q, which is none of the ear's corners, spoils the ear a b c. */
static bool spoils(const struct ring *g, const struct corner *a, const struct corner *b,
    const struct corner *c, const struct corner *q)
{
    const struct corner *p = &g->c[q->prev], *n = &g->c[q->next];
    if (same_place(q, b)) return in_wedge(a, b, c, p) || in_wedge(a, b, c, n);
    if (same_place(q, a)) return in_wedge(c, a, b, p) || in_wedge(c, a, b, n);
    if (same_place(q, c)) return in_wedge(b, c, a, p) || in_wedge(b, c, a, n);
    return cross2(a, b, q) >= 0 && cross2(b, c, q) >= 0 && cross2(c, a, q) >= 0;
}

static bool is_ear(struct ring *g, uint32_t i)
{
    const struct corner *b = &g->c[i], *a = &g->c[b->prev], *c = &g->c[b->next];
    double x0 = fmin(fmin(a->x, b->x), c->x), x1 = fmax(fmax(a->x, b->x), c->x);
    double y0 = fmin(fmin(a->y, b->y), c->y), y1 = fmax(fmax(a->y, b->y), c->y);
    for (uint32_t k = 0; k < g->n_reflex;) {
        uint32_t j = g->reflex[k];
        const struct corner *q = &g->c[j];
        if (q->gone || !q->reflex) { /* a corner never becomes reflex again: forget it */
            g->reflex[k] = g->reflex[--g->n_reflex];
            continue;
        }
        k++;
        if (q->x < x0 || q->x > x1 || q->y < y0 || q->y > y1) continue;
        if (q != a && q != b && q != c && spoils(g, a, b, c, q)) return false;
    }
    return true;
}

static double turn(const struct ring *g, uint32_t i)
{
    const struct corner *b = &g->c[i];
    return cross2(&g->c[b->prev], b, &g->c[b->next]);
}

static void cut_off(struct ring *g, uint32_t i)
{
    struct corner *b = &g->c[i];
    g->c[b->prev].next = b->next;
    g->c[b->next].prev = b->prev;
    b->gone = true;
    g->left--;
    g->c[b->prev].reflex = turn(g, b->prev) <= 0;
    g->c[b->next].reflex = turn(g, b->next) <= 0;
}

/* The ring of p's corners, counterclockwise in its plane; false when the polygon has no area. */
static bool project(const struct vec3 *v, uint32_t n, struct ring *g)
{
    struct vec3 normal = newell(v, n);
    double ax = fabs(normal.x), ay = fabs(normal.y), az = fabs(normal.z);
    for (uint32_t i = 0; i < n; i++) {
        struct corner *c = &g->c[i];
        bool flip;
        if (az >= ax && az >= ay)
            c->x = v[i].x, c->y = v[i].y, flip = normal.z < 0;
        else if (ax >= ay)
            c->x = v[i].y, c->y = v[i].z, flip = normal.x < 0;
        else
            c->x = v[i].z, c->y = v[i].x, flip = normal.y < 0;
        if (flip) c->x = -c->x;
        c->prev = (i ? i : n) - 1;
        c->next = i + 1 < n ? i + 1 : 0;
        c->gone = false;
    }
    g->left = n;
    g->n_reflex = 0;
    for (uint32_t i = 0; i < n; i++) {
        g->c[i].reflex = turn(g, i) <= 0;
        if (g->c[i].reflex) g->reflex[g->n_reflex++] = i;
    }
    return ax > 0 || ay > 0 || az > 0;
}

/* Clips every second ear on the way round, which keeps the triangles fatter than a fan's. */
static uint32_t clip_ears(struct ring *g, uint32_t first, struct triangle *out)
{
    uint32_t n = 0, passed = 0; /* corners passed since one was removed */
    for (uint32_t i = 1, next; g->left > 2; i = next) {
        double t = turn(g, i);
        next = g->c[i].next;
        bool nothing = t == 0 || passed >= 2 * g->left; /* straight, or no corner is convex */
        if (!nothing && (t < 0 || (passed < g->left && !is_ear(g, i)))) {
            passed++;
            continue;
        }
        if (!nothing) {
            out[n++] = (struct triangle){{first + g->c[i].prev, first + i, first + next}};
            next = g->c[next].next;
        }
        cut_off(g, i);
        passed = 0;
    }
    return n;
}

static uint32_t triangulate_polygon(const struct vec3 *v, uint32_t first, uint32_t n, struct triangle *out)
{
    struct corner corners[STACK_CORNERS];
    uint32_t reflex[STACK_CORNERS];
    struct ring g = {.c = corners, .reflex = reflex};
    bool heap = n > STACK_CORNERS;
    if (heap) {
        g.c = xmalloc(n, sizeof *g.c);
        g.reflex = xmalloc(n, sizeof *g.reflex);
    }
    uint32_t triangles = project(v, n, &g) ? clip_ears(&g, first, out) : 0;
    if (heap) {
        free(g.c);
        free(g.reflex);
    }
    return triangles;
}

static uint32_t triangulate_patch(const struct vec3 *v, uint32_t first, uint32_t n, struct triangle *out)
{
    uint32_t triangles = 0;
    for (uint32_t i = 1; i + 1 < n; i++) {
        struct vec3 area = v3_cross(v3_sub(v[i], v[0]), v3_sub(v[i + 1], v[0]));
        if (v3_dot(area, area) > 0)
            out[triangles++] = (struct triangle){{first, first + i, first + i + 1}};
    }
    return triangles;
}

uint32_t scene_triangulate(const struct scene *s, const struct prim *p, struct triangle *out)
{
    const struct vec3 *v = s->vertices + p->poly.first;
    if (p->kind == PRIM_PATCH) return triangulate_patch(v, p->poly.first, p->poly.count, out);
    if (p->kind == PRIM_POLYGON) return triangulate_polygon(v, p->poly.first, p->poly.count, out);
    return 0;
}
