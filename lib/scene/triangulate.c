/*
 * Polygons to triangles: ear clipping (G. H. Meisters, "Polygons have ears", American Mathematical
 * Monthly 82, 1975) in the plane that Newell's normal gives (I. Sutherland, R. Sproull, R.
 * Schumacker, "A characterization of ten hidden-surface algorithms", Computing Surveys 6(1),
 * 1974).
 *
 * A corner that is no ear can become one only when a neighbour is clipped, so each is looked at
 * once, and again whenever that happens: at most 3 n looks. A straight corner is not dropped:
 * another ear takes it along (dropped, it would leave a T where triangles meet). Edges that cross
 * may leave corners but no ear; then one of them goes all the same, so it always ends.
 */
#include "scene/scene.h"
#include "scene/corners.h"

#define DESPAIR_LOOKS 64 /* corners looked at for the best of a bad lot */

/* Where there is no ear: the next straight corner, which costs nothing, or convex one, or any. */
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
    uint32_t n = 0, alive = 0; /* a corner that is still there */
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
