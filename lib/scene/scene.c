/*
 * scene: frees a scene and computes the bounds of its primitives.
 */
#include "scene/scene.h"

#include <stdlib.h>

/*
 * Computed bounds are widened by this fraction of their magnitude: four roundings.
 */
#define WIDEN 0x1p-50

void scene_free(struct scene *s)
{
    free(s->lights);
    free(s->materials);
    free(s->prims);
    free(s->vertices);
    free(s->normals);
    *s = (struct scene){0};
}

static inline void include(struct vec3 *lo, struct vec3 *hi, struct vec3 a, struct vec3 b)
{
    *lo = v3(fmin(lo->x, a.x), fmin(lo->y, a.y), fmin(lo->z, a.z));
    *hi = v3(fmax(hi->x, b.x), fmax(hi->y, b.y), fmax(hi->z, b.z));
}

/* Includes c - e and c + e, slightly widened. */
static void include_about(struct vec3 *lo, struct vec3 *hi, struct vec3 c, struct vec3 e)
{
    e = v3(e.x + WIDEN * (fabs(c.x) + e.x), e.y + WIDEN * (fabs(c.y) + e.y),
        e.z + WIDEN * (fabs(c.z) + e.z));
    include(lo, hi, v3_sub(c, e), v3_add(c, e));
}

/*
 * A disc of radius r and unit normal a extends r times the sine of the angle between a and an axis,
 * along that axis.
 */
static struct vec3 disc_reach(struct vec3 a, double r)
{
    return v3(r * hypot(a.y, a.z), r * hypot(a.x, a.z), r * hypot(a.x, a.y));
}

void scene_prim_bounds(
    const struct scene *s, const struct prim *p, struct vec3 *lo, struct vec3 *hi)
{
    *lo = v3(HUGE_VAL, HUGE_VAL, HUGE_VAL);
    *hi = v3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL);
    switch (p->kind) {
    case PRIM_SPHERE: {
        double r = p->sphere.radius;
        include_about(lo, hi, p->sphere.center, v3(r, r, r));
        break;
    }
    case PRIM_CONE: {
        struct vec3 axis = v3_unit(v3_sub(p->cone.apex, p->cone.base));
        include_about(lo, hi, p->cone.base, disc_reach(axis, p->cone.base_radius));
        include_about(lo, hi, p->cone.apex, disc_reach(axis, p->cone.apex_radius));
        break;
    }
    case PRIM_POLYGON:
    case PRIM_PATCH:
        for (uint32_t i = 0; i < p->poly.count; i++) {
            struct vec3 v = s->vertices[p->poly.first + i];
            include(lo, hi, v, v);
        }
        break;
    }
}
