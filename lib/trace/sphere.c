/* sphere: two-sided. The sign of the radius is ignored. The intersection is in sphere.h. */
#include "trace/sphere.h"

static bool has_surface(const struct scene *s, const struct item *it)
{
    return fabs(s->prims[it->prim].sphere.radius) > 0;
}

static void fill(const struct scene *s, const struct item *it, double reach, void *block, int lane)
{
    struct sphere4 *b = block;
    const struct prim *p = &s->prims[it->prim];
    struct vec3 c = p->sphere.center;
    double r = fabs(p->sphere.radius);
    (void)reach;
    b->c[0][lane] = c.x;
    b->c[1][lane] = c.y;
    b->c[2][lane] = c.z;
    b->r[lane] = r;
    b->err[lane] = ERR_UNIT * (fabs(c.x) + fabs(c.y) + fabs(c.z) + r);
}

static void clear(void *block, int lane)
{
    struct sphere4 *b = block;
    b->c[0][lane] = b->c[1][lane] = b->c[2][lane] = 0;
    b->r[lane] = (double)NAN; /* never hit: no comparison with it holds; a radius of 0 can be hit */
    b->err[lane] = 0;
    b->item[lane] = NO_ITEM;
}

static void bounds(const struct scene *s, const struct item *it, struct vec3 *lo, struct vec3 *hi)
{
    const struct prim *p = &s->prims[it->prim];
    struct vec3 c = p->sphere.center;
    double r = fabs(p->sphere.radius);
    *lo = v3(c.x - r, c.y - r, c.z - r);
    *hi = v3(c.x + r, c.y + r, c.z + r);
}

static void extent(
    const struct scene *s, const struct item *it, struct vec3 n, double *lo, double *hi)
{
    const struct prim *p = &s->prims[it->prim];
    double c = v3_dot(n, p->sphere.center), r = fabs(p->sphere.radius) * v3_len(n);
    *lo = c - r;
    *hi = c + r;
}

static struct vec3 normal(const struct scene *s, const struct item *it, struct vec3 *p)
{
    const struct prim *q = &s->prims[it->prim];
    struct vec3 n = v3_sub(*p, q->sphere.center);
    double len = v3_len(n); /* 0: the sphere is smaller than the rounding of its place */
    n = len > 0 ? v3_scale(n, 1 / len) : v3(0, 0, 1);
    *p = v3_mad(q->sphere.center, n, fabs(q->sphere.radius));
    return n;
}

static bool contains(const struct prim *q, struct vec3 p)
{
    return v3_len(v3_sub(p, q->sphere.center)) < q->sphere.radius;
}

static double size(const struct prim *q) { return q->sphere.radius; }

const struct shape trace_sphere = {
    .prim = PRIM_SPHERE,
    .block_size = sizeof(struct sphere4),
    .items_at = offsetof(struct sphere4, item),
    .has_surface = has_surface,
    .fill = fill,
    .clear = clear,
    .bounds = bounds,
    .extent = extent,
    .normal = normal,
    .contains = contains,
    .size = size,
};
