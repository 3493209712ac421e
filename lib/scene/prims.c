/* prims: the table of kinds of primitives, and what others ask of any kind. */
#include "scene/prim.h"

#define ROW(KIND, name) [PRIM_##KIND] = &scene_##name,
const struct prim_row *const scene_prims[PRIM_KINDS] = {SCENE_PRIMS(ROW)};

void scene_prim_bounds(
    const struct scene *s, const struct prim *p, struct vec3 *lo, struct vec3 *hi)
{
    *lo = v3(HUGE_VAL, HUGE_VAL, HUGE_VAL);
    *hi = v3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL);
    scene_prims[p->kind]->bounds(s, p, lo, hi);
}

void scene_put_prim(struct nff_out *o, const struct scene *s, const struct prim *p)
{
    scene_prims[p->kind]->write(o, s, p);
}

const char *scene_sample(enum prim_kind kind) { return scene_prims[kind]->sample; }
