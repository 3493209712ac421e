/*
 * triangulate: polygons to triangles by ear clipping (G. H. Meisters, "Polygons have ears",
 * American Mathematical Monthly 82, 1975) in the plane of Newell's normal (I. Sutherland, R.
 * Sproull, R. Schumacker, "A characterization of ten hidden-surface algorithms", Computing Surveys
 * 6(1), 1974).
 *
 * A corner that is not an ear can become one only when a neighbour is clipped. So each corner is
 * tested once, and again after each such removal: at most 3 n tests. Straight corners are not
 * dropped; another ear includes them. (Dropping one would leave a T-junction between triangles.) If
 * edges cross, there may be corners left but no ear. Then one of them is removed anyway, so the
 * loop always ends.
 */
#include "scene/scene.h"
#include "scene/corners.h"

#define DESPAIR_LOOKS 64 /* corners tested for the least bad choice */

/* Without an ear: the next straight corner (no area lost), else a convex one, else any. */
static uint32_t least_evil(const struct corners *g, uint32_t from)
{
    uint32_t convex = CORNERS_NONE, i = from;
    for (int k = 0; k < DESPAIR_LOOKS; k++, i = g->c[i].next) {
        double t = corners_turn(g, i);
        if (t == 0) return i;
        if (t > 0 && convex == CORNERS_NONE) convex = i;
    }
    return convex != CORNERS_NONE ? convex : from;
}

static uint32_t clip_ears(struct corners *g, uint32_t first, struct triangle *out)
{
    uint32_t n = 0, alive = 0; /* a corner that still exists */
    while (g->left > 2) {
        uint32_t i = corners_pop(g);
        bool any = i == CORNERS_NONE;
        if (any) i = least_evil(g, alive);
        double t = corners_turn(g, i);
        if (t > 0 && (any || corners_is_ear(g, i)))
            out[n++] = (struct triangle){{first + g->c[i].prev, first + i, first + g->c[i].next}};
        else if (!any && (t != 0 || !corners_is_empty(g, i))) continue;
        alive = g->c[i].next;
        corners_remove(g, i);
    }
    return n;
}

static uint32_t triangulate_polygon(
    const struct vec3 *v, uint32_t first, uint32_t n, struct triangle *out)
{
    struct corners g;
    if (!corners_init(&g, v, n)) return 0;
    uint32_t triangles = clip_ears(&g, first, out);
    corners_free(&g);
    return triangles;
}

static uint32_t triangulate_patch(
    const struct vec3 *v, uint32_t first, uint32_t n, struct triangle *out)
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
    if (p->kind == PRIM_PATCH || (p->kind == PRIM_POLYGON && p->poly.count == 3))
        return triangulate_patch(v, p->poly.first, p->poly.count, out);
    if (p->kind == PRIM_POLYGON) return triangulate_polygon(v, p->poly.first, p->poly.count, out);
    return 0;
}
