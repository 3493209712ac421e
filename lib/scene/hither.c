/*
 * hither: finds primitives that hither may hide: those that reach into the pyramid between the eye
 * and the hither plane. A convex primitive that lies wholly outside one of the pyramid's planes
 * does not reach into it. Polygons are tested triangle by triangle and clipped plane by plane (I.
 * Sutherland, G. Hodgman, "Reentrant polygon clipping", CACM 17(1), 1974). Clipping is exact, which
 * matters because floors often pass close to the eye, outside the picture.
 */
#include "scene/scene.h"

#include <stdlib.h>

enum { PLANES = 6, CLIPPED_MAX = 3 + PLANES };

/* Inside: dot(normal, p) <= offset. p is relative to the eye; normals have unit length. */
struct pyramid {
    struct vec3 normal[PLANES];
    double offset[PLANES];
    struct vec3 corner[5]; /* the eye and the four corners on the hither plane */
    struct vec3 eye;
};

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

static bool triangle_reaches(const struct pyramid *y, const struct vec3 t[3])
{
    struct vec3 a[CLIPPED_MAX + 1], b[CLIPPED_MAX + 1];
    int n = 3;
    for (int i = 0; i < 3; i++) a[i] = v3_sub(t[i], y->eye);
    for (int k = 0; k < PLANES && n; k++) {
        int m = 0;
        for (int i = 0; i < n; i++) {
            struct vec3 p = a[i], q = a[(i + 1) % n];
            double dp = v3_dot(y->normal[k], p) - y->offset[k];
            double dq = v3_dot(y->normal[k], q) - y->offset[k];
            if (dp <= 0) b[m++] = p;
            if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0))
                b[m++] = v3_mad(p, v3_sub(q, p), dp / (dp - dq));
        }
        for (int i = 0; i < m; i++) a[i] = b[i];
        n = m;
    }
    return n > 0;
}

/* The sphere's surface reaches in unless all of it is outside or it contains the whole pyramid. */
static bool sphere_reaches(const struct pyramid *y, struct vec3 center, double radius)
{
    struct vec3 c = v3_sub(center, y->eye);
    for (int k = 0; k < PLANES; k++)
        if (v3_dot(y->normal[k], c) - y->offset[k] > radius) return false;
    for (int i = 0; i < 5; i++)
        if (v3_len(v3_sub(y->corner[i], c)) >= radius) return true;
    return false;
}

/* Extent of a disc with unit normal `axis` along the unit vector n, from its center. */
static double disc_depth(struct vec3 n, struct vec3 axis, double radius)
{
    return radius * v3_len(v3_cross(n, axis));
}

static bool cone_reaches(const struct pyramid *y, const struct prim *p)
{
    struct vec3 base = v3_sub(p->cone.base, y->eye), apex = v3_sub(p->cone.apex, y->eye);
    struct vec3 axis = v3_unit(v3_sub(apex, base));
    for (int k = 0; k < PLANES; k++) {
        struct vec3 n = y->normal[k];
        if (v3_dot(n, base) - disc_depth(n, axis, p->cone.base_radius) > y->offset[k] &&
            v3_dot(n, apex) - disc_depth(n, axis, p->cone.apex_radius) > y->offset[k])
            return false;
    }
    return true;
}

static bool polygon_reaches(
    const struct pyramid *y, const struct scene *s, const struct prim *p, struct triangle *room)
{
    uint32_t n = scene_triangulate(s, p, room);
    for (uint32_t i = 0; i < n; i++) {
        struct vec3 t[3];
        for (int k = 0; k < 3; k++) t[k] = s->vertices[room[i].v[k]];
        if (triangle_reaches(y, t)) return true;
    }
    return false;
}

static uint32_t largest_polygon(const struct scene *s)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < s->n_prims; i++)
        if (prim_is_poly(&s->prims[i]) && s->prims[i].poly.count > most)
            most = s->prims[i].poly.count;
    return most;
}

bool scene_hither_clips(const struct scene *s, uint32_t *which)
{
    struct pyramid y;
    if (!(s->view.hither > 0)) return false;
    make_pyramid(&s->view, &y);
    struct triangle *room = xmalloc(largest_polygon(s), sizeof *room);
    bool reaches = false;
    for (uint32_t i = 0; i < s->n_prims && !reaches; i++) {
        const struct prim *p = &s->prims[i];
        switch (p->kind) {
        case PRIM_SPHERE: reaches = sphere_reaches(&y, p->sphere.center, p->sphere.radius); break;
        case PRIM_CONE: reaches = cone_reaches(&y, p); break;
        case PRIM_POLYGON:
        case PRIM_PATCH: reaches = polygon_reaches(&y, s, p, room); break;
        }
        *which = i;
    }
    free(room);
    return reaches;
}
