/*
 * around: the media that contain the start of eye rays. The middle eye ray stands for all. These
 * are the transmitting spheres and cones that contain the eye. The larger comes first, because a
 * ray leaves the smaller one sooner. Polygons enclose nothing, as in the reference, whose meshes
 * have no inside.
 */
#include "trace/trace_int.h"

#include <string.h>

static double size_around_cone(const struct prim *q, struct vec3 p)
{
    struct vec3 axis = v3_sub(q->cone.apex, q->cone.base), up = v3_sub(p, q->cone.base);
    double r0 = fabs(q->cone.base_radius), r1 = fabs(q->cone.apex_radius);
    double z = v3_dot(up, axis) / v3_dot(axis, axis); /* 0 at the base, 1 at the apex */
    bool in = z > 0 && z < 1 && v3_len(v3_mad(up, axis, -z)) < r0 + (r1 - r0) * z;
    return in ? fmax(r0, r1) : 0;
}

/* Size of the primitive if it contains p, otherwise 0. */
static double size_around(const struct prim *q, struct vec3 p)
{
    double r;
    switch (q->kind) {
    case PRIM_SPHERE:
        r = fabs(q->sphere.radius);
        return v3_len(v3_sub(p, q->sphere.center)) < r ? r : 0;
    case PRIM_CONE: return size_around_cone(q, p);
    case PRIM_POLYGON:
    case PRIM_PATCH: break;
    }
    return 0;
}

void media_around(const struct tracer *t, struct vec3 p, struct media *in)
{
    const struct scene *s = t->scene;
    double size[MEDIA_MAX + 1]; /* the last element is spare: what is shifted into it is dropped */
    uint32_t id[MEDIA_MAX + 1], n = 0;
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *q = &s->prims[i];
        double d = t->surfaces[q->material].t > 0 ? size_around(q, p) : 0;
        uint32_t at = n;
        if (!(d > 0)) continue;
        for (; at > 0 && size[at - 1] < d; at--) size[at] = size[at - 1], id[at] = id[at - 1];
        size[at] = d;
        id[at] = s->n_materials + i;
        if (n < MEDIA_MAX) n++;
    }
    in->n = n;
    memcpy(in->id, id, n * sizeof id[0]);
}
