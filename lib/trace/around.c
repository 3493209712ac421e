/*
 * around: the media that contain the start of an eye ray, which is where hither ends. These are the
 * transmitting spheres and cones that contain it. The larger comes first, because a ray leaves the
 * smaller one sooner. Polygons enclose nothing, as in the reference, whose meshes have no inside.
 */
#include "trace/trace_int.h"

#include <stdlib.h>

#define MARGIN 1.001 /* for rounding */

/* A primitive that may contain the start of an eye ray. */
struct enclosing {
    double size;
    uint32_t prim;
};

static bool in_cone(const struct prim *q, struct vec3 p)
{
    struct vec3 axis = v3_sub(q->cone.apex, q->cone.base), up = v3_sub(p, q->cone.base);
    double r0 = q->cone.base_radius, r1 = q->cone.apex_radius;
    double z = v3_dot(up, axis) / v3_dot(axis, axis); /* 0 at the base, 1 at the apex */
    return z > 0 && z < 1 && v3_len(v3_mad(up, axis, -z)) < r0 + (r1 - r0) * z;
}

static bool contains(const struct prim *q, struct vec3 p)
{
    if (q->kind == PRIM_CONE) return in_cone(q, p);
    return v3_len(v3_sub(p, q->sphere.center)) < q->sphere.radius;
}

/* 0 if the primitive encloses nothing. */
static double size_of(const struct prim *q)
{
    switch (q->kind) {
    case PRIM_SPHERE: return q->sphere.radius;
    case PRIM_CONE: return fmax(q->cone.base_radius, q->cone.apex_radius);
    case PRIM_POLYGON:
    case PRIM_PATCH: break;
    }
    return 0;
}

/* The radius of a sphere around the primitive, and its middle. */
static double extent(const struct prim *q, struct vec3 *middle)
{
    *middle = q->sphere.center;
    if (q->kind != PRIM_CONE) return q->sphere.radius;
    struct vec3 half = v3_scale(v3_sub(q->cone.apex, q->cone.base), .5);
    *middle = v3_add(q->cone.base, half);
    return v3_len(half) + size_of(q);
}

/* False if no eye ray of the frame starts in the primitive. All of them start on a rectangle of the
 * hither plane. */
static bool may_contain(const struct camera *c, double hither, const struct prim *q)
{
    struct vec3 middle, corner = v3_sub(camera_direction(c, 0, 0), c->forward);
    double r = MARGIN * extent(q, &middle);
    struct vec3 from = v3_sub(v3_mad(c->eye, c->forward, hither), middle);
    return fabs(v3_dot(from, c->forward)) <= r &&
           v3_len(from) <= r + MARGIN * hither * v3_len(corner);
}

static int larger_first(const void *a, const void *b)
{
    const struct enclosing *x = a, *y = b;
    if (x->size != y->size) return x->size < y->size ? 1 : -1;
    return x->prim < y->prim ? -1 : 1;
}

void media_list_enclosing(struct tracer *t)
{
    const struct scene *s = t->scene;
    uint32_t n = 0, cap = 0;
    for (uint32_t i = 0; t->transmits && i < s->n_prims; i++) {
        const struct prim *q = &s->prims[i];
        double size = t->surfaces[q->material].t > 0 ? size_of(q) : 0;
        if (!(size > 0) || !may_contain(&t->camera, s->view.hither, q)) continue;
        if (n == cap) {
            cap = cap ? 2 * cap : 8;
            t->enclosing = xrealloc(t->enclosing, cap, sizeof *t->enclosing);
        }
        t->enclosing[n++] = (struct enclosing){size, i};
    }
    if (n) qsort(t->enclosing, n, sizeof *t->enclosing, larger_first);
    t->n_enclosing = n;
}

uint32_t media_around(const struct tracer *t, struct vec3 p, struct media *m)
{
    uint32_t list = 0;
    for (uint32_t i = 0; i < t->n_enclosing; i++) {
        uint32_t prim = t->enclosing[i].prim;
        if (contains(&t->scene->prims[prim], p))
            list = media_add(m, t->scene->n_materials + prim, list);
    }
    return list;
}
