/*
 * hither: finds primitives that hither may hide: those that reach into the pyramid between the eye
 * and the hither plane. A convex primitive that lies wholly outside one of the pyramid's planes
 * does not reach into it.
 */
#include "scene/prim.h"

static void make_pyramid(const struct view *v, struct pyramid *y)
{
    struct vec3 dir = v3_unit(v3_sub(v->at, v->from));
    struct vec3 right = v3_unit(v3_cross(dir, v3_unit(v->up))), up = v3_cross(right, dir);
    double tan_y = tan(v->angle_deg * (M_PI / 360)), tan_x = tan_y * v->res_x / v->res_y;
    struct vec3 side[4] = {right, v3_scale(right, -1), up, v3_scale(up, -1)};
    for (int i = 0; i < 4; i++) {
        y->normal[i] = v3_unit(v3_mad(side[i], dir, -(i < 2 ? tan_x : tan_y)));
        y->offset[i] = 0;
        struct vec3 edge = v3_mad(dir, right, i & 1 ? tan_x : -tan_x);
        y->corner[1 + i] = v3_scale(v3_mad(edge, up, i & 2 ? tan_y : -tan_y), v->hither);
    }
    y->normal[4] = dir;
    y->offset[4] = v->hither;
    y->normal[5] = v3_scale(dir, -1); /* redundant, but rejects objects behind the eye */
    y->offset[5] = 0;
    y->corner[0] = v3(0, 0, 0);
    y->eye = v->from;
}

bool scene_hither_clips(const struct scene *s, uint32_t *which)
{
    struct pyramid y;
    if (!(s->view.hither > 0)) return false;
    make_pyramid(&s->view, &y);
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *p = &s->prims[i];
        *which = i;
        if (scene_prims[p->kind]->reaches(&y, s, p)) return true;
    }
    return false;
}
