/*
 * around: the media that contain the start of an eye ray, which is where hither ends. These are the
 * transmitting primitives that contain it. The larger comes first, because a ray leaves the smaller
 * one sooner. Polygons enclose nothing, as in the reference, whose meshes have no inside.
 */
#include "trace/trace_int.h"

#include <stdlib.h>

#define MARGIN .001 /* for rounding, of the sizes involved */

/* A primitive that may contain the start of an eye ray. */
struct enclosing {
    double size;
    uint32_t prim;
};

/* False if no eye ray of the frame starts in the primitive's box. All of them start on a rectangle
 * of the hither plane. */
static bool may_contain(const struct tracer *t, const struct prim *q)
{
    const struct camera *c = &t->camera;
    struct vec3 lo, hi, corner = v3_sub(camera_direction(c, 0, 0), c->forward);
    struct vec3 p = v3_mad(c->eye, c->forward, t->view.hither);
    scene_prim_bounds(t->scene, q, &lo, &hi);
    double r = t->view.hither * v3_len(corner);
    r += MARGIN * (r + v3_len(v3_sub(hi, lo)));
    return p.x >= lo.x - r && p.y >= lo.y - r && p.z >= lo.z - r && p.x <= hi.x + r &&
           p.y <= hi.y + r && p.z <= hi.z + r;
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
    uint32_t n = 0;
    for (uint32_t i = 0; t->transmits && i < s->n_prims; i++) {
        const struct prim *q = &s->prims[i];
        const struct shape *shape = trace_shapes[trace_kind_of(q)];
        if (!shape->contains || !(t->surfaces[q->material].t > 0)) continue;
        if (!may_contain(t, q)) continue;
        t->enclosing = xgrown(t->enclosing, n, sizeof *t->enclosing);
        t->enclosing[n++] = (struct enclosing){shape->size(q), i};
    }
    if (n) qsort(t->enclosing, n, sizeof *t->enclosing, larger_first);
    t->n_enclosing = n;
}

uint32_t media_around(const struct tracer *t, struct vec3 p, struct media *m)
{
    uint32_t list = 0;
    for (uint32_t i = 0; i < t->n_enclosing; i++) {
        uint32_t prim = t->enclosing[i].prim;
        const struct prim *q = &t->scene->prims[prim];
        if (trace_shapes[trace_kind_of(q)]->contains(q, p))
            list = media_add(m, t->scene->n_materials + prim, list);
    }
    return list;
}
