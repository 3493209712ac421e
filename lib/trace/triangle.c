/*
 * triangle: one triangle of a polygon or patch, two-sided, with its own plane.
 *
 * Stored as three planes, as in J. Havel, A. Herout, "Yet faster ray-triangle intersection (using
 * SSE4)", IEEE TVCG 16(3), 2010: the triangle's own plane and two planes whose values are
 * barycentric coordinates. Differs in using double, in dividing at once, and in a margin that makes
 * neighbours overlap by a rounding error instead of leaving a crack. A ray that starts on the
 * plane, within the error bounds of both, does not hit the triangle.
 */
#include "trace/triangle.h"

static struct vec3 corner(const struct scene *s, const struct item *it, int i)
{
    return s->vertices[it->vertex[i]];
}

/* The library's fmin and fmax are slower: they are function calls that handle NaN. */
static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

static double largest(struct vec3 p) { return larger(fabs(p.x), larger(fabs(p.y), fabs(p.z))); }

static void put(double to[3][LANES], int lane, struct vec3 v)
{
    to[0][lane] = v.x;
    to[1][lane] = v.y;
    to[2][lane] = v.z;
}

/* Normal to the plane, as long as twice the triangle's area. */
static inline struct vec3 area_normal(const struct scene *s, const struct item *it)
{
    struct vec3 a = corner(s, it, 0), e1 = v3_sub(corner(s, it, 1), a);
    return v3_cross(e1, v3_sub(corner(s, it, 2), a));
}

static bool has_surface(const struct scene *s, const struct item *it)
{
    struct vec3 n = area_normal(s, it);
    double squared = v3_dot(n, n);
    return squared > 0 && isfinite(squared);
}

static void fill(const struct scene *s, const struct item *it, double reach, void *block, int lane)
{
    struct triangle4 *b = block;
    struct vec3 a = corner(s, it, 0), e1 = v3_sub(corner(s, it, 1), a);
    struct vec3 e2 = v3_sub(corner(s, it, 2), a), cross = v3_cross(e1, e2);
    double area2 = v3_len(cross);
    struct vec3 n = v3_scale(cross, 1 / area2);
    struct vec3 u = v3_scale(v3_cross(e2, n), 1 / area2), v = v3_scale(v3_cross(n, e1), 1 / area2);
    double d = v3_dot(n, a), off = 0, far = largest(a);
    for (int i = 1; i < 3; i++) {
        off = larger(off, fabs(v3_dot(n, corner(s, it, i)) - d));
        far = larger(far, largest(corner(s, it, i)));
    }
    /* A computed hit is off by rounding by at most `margin`. In units of u that is margin over the
     * triangle's height. */
    double margin = ERR_UNIT * 4 * reach;
    double mu = smaller(margin * v3_len(u), 0.125), mv = smaller(margin * v3_len(v), 0.125);
    double mw = smaller(margin * v3_len(v3_add(u, v)), 0.125), k = 1 / (1 + mu + mv + mw);
    put(b->n, lane, n);
    b->d[lane] = d;
    put(b->u, lane, v3_scale(u, k));
    b->du[lane] = (mu - v3_dot(u, a)) * k;
    put(b->v, lane, v3_scale(v, k));
    b->dv[lane] = (mv - v3_dot(v, a)) * k;
    b->err[lane] = 2 * off + ERR_UNIT * far;
}

static void clear(void *block, int lane)
{
    struct triangle4 *b = block;
    put(b->n, lane, v3(0, 0, 0)); /* never hit: |n.o - d| > err is false */
    put(b->u, lane, v3(0, 0, 0));
    put(b->v, lane, v3(0, 0, 0));
    b->d[lane] = b->du[lane] = b->dv[lane] = b->err[lane] = 0;
    b->item[lane] = NO_ITEM;
}

static void bounds(const struct scene *s, const struct item *it, struct vec3 *lo, struct vec3 *hi)
{
    struct vec3 a = corner(s, it, 0), b = corner(s, it, 1), c = corner(s, it, 2);
    *lo = v3(smaller(a.x, smaller(b.x, c.x)), smaller(a.y, smaller(b.y, c.y)),
        smaller(a.z, smaller(b.z, c.z)));
    *hi = v3(larger(a.x, larger(b.x, c.x)), larger(a.y, larger(b.y, c.y)),
        larger(a.z, larger(b.z, c.z)));
}

static void extent(
    const struct scene *s, const struct item *it, struct vec3 n, double *lo, double *hi)
{
    double a = v3_dot(n, corner(s, it, 0)), b = v3_dot(n, corner(s, it, 1));
    double c = v3_dot(n, corner(s, it, 2));
    *lo = smaller(a, smaller(b, c));
    *hi = larger(a, larger(b, c));
}

/* Barycentric mean of the corners' normals. */
static struct vec3 smooth_normal(
    const struct scene *s, const struct item *it, struct vec3 p, struct vec3 flat)
{
    struct vec3 a = corner(s, it, 0), e1 = v3_sub(corner(s, it, 1), a);
    struct vec3 e2 = v3_sub(corner(s, it, 2), a), cross = v3_cross(e1, e2), q = v3_sub(p, a);
    double area = v3_dot(cross, cross);
    double u = v3_dot(v3_cross(q, e2), cross) / area, v = v3_dot(v3_cross(e1, q), cross) / area;
    const struct vec3 *n = s->normals;
    struct vec3 m = v3_scale(n[it->vertex[0]], 1 - u - v);
    m = v3_mad(v3_mad(m, n[it->vertex[1]], u), n[it->vertex[2]], v);
    double len = v3_len(m);
    return len > 1e-12 ? v3_scale(m, 1 / len) : flat; /* opposite normals cancel: flat */
}

static struct vec3 normal(const struct scene *s, const struct item *it, struct vec3 *p)
{
    struct vec3 cross = area_normal(s, it), n = v3_scale(cross, 1 / v3_len(cross));
    return it->smooth ? smooth_normal(s, it, *p, n) : n;
}

const struct shape trace_triangle = {
    .prim = PRIM_POLYGON,
    .block_size = sizeof(struct triangle4),
    .items_at = offsetof(struct triangle4, item),
    .has_surface = has_surface,
    .fill = fill,
    .clear = clear,
    .bounds = bounds,
    .extent = extent,
    .normal = normal,
};
