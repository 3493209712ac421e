/* scene: frees a scene; what bounds of primitives are made of. */
#include "scene/prim.h"

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

void scene_include(struct vec3 *lo, struct vec3 *hi, struct vec3 a, struct vec3 b)
{
    *lo = v3(fmin(lo->x, a.x), fmin(lo->y, a.y), fmin(lo->z, a.z));
    *hi = v3(fmax(hi->x, b.x), fmax(hi->y, b.y), fmax(hi->z, b.z));
}

void scene_include_about(struct vec3 *lo, struct vec3 *hi, struct vec3 c, struct vec3 e)
{
    e = v3(e.x + WIDEN * (fabs(c.x) + e.x), e.y + WIDEN * (fabs(c.y) + e.y),
        e.z + WIDEN * (fabs(c.z) + e.z));
    scene_include(lo, hi, v3_sub(c, e), v3_add(c, e));
}
