/*
 * cone: the open mantle of a cone or cylinder, two-sided. The signs of the radii are ignored. The
 * intersection is in cone.h. A cone whose ends coincide has no mantle.
 */
#include "trace/cone.h"

struct frame {
    struct vec3 base, axis;
    double h, r, k; /* radius r + k z at height z in [0, h] */
};

static bool frame_of(const struct scene *s, const struct item *it, struct frame *f)
{
    const struct prim *p = &s->prims[it->prim];
    struct vec3 along = v3_sub(p->cone.apex, p->cone.base);
    double r0 = fabs(p->cone.base_radius), r1 = fabs(p->cone.apex_radius);
    f->h = v3_len(along);
    if (!(f->h > 0) || (r0 == 0 && r1 == 0)) return false;
    f->base = p->cone.base;
    f->axis = v3_scale(along, 1 / f->h);
    f->r = r0;
    f->k = (r1 - r0) / f->h;
    return isfinite(f->k) && isfinite(1 / f->h);
}

static bool has_surface(const struct scene *s, const struct item *it)
{
    struct frame f;
    return frame_of(s, it, &f);
}

static void fill(const struct scene *s, const struct item *it, double reach, void *block, int lane)
{
    struct cone4 *b = block;
    struct frame f;
    (void)reach;
    frame_of(s, it, &f);
    const double base[3] = {f.base.x, f.base.y, f.base.z}, axis[3] = {f.axis.x, f.axis.y, f.axis.z};
    for (int i = 0; i < 3; i++) {
        b->b[i][lane] = base[i];
        b->a[i][lane] = axis[i];
    }
    b->h[lane] = f.h;
    b->r[lane] = f.r;
    b->k[lane] = f.k;
    b->err[lane] =
        ERR_UNIT * (fabs(f.base.x) + fabs(f.base.y) + fabs(f.base.z) + f.h + f.r + fabs(f.k * f.h));
}

static void clear(void *block, int lane)
{
    struct cone4 *b = block;
    for (int i = 0; i < 3; i++) b->b[i][lane] = b->a[i][lane] = 0;
    b->h[lane] = -1; /* no height is within [0, -1] */
    b->r[lane] = b->k[lane] = b->err[lane] = 0;
    b->item[lane] = NO_ITEM;
}

/* The box around the two end circles. A circle of radius r perpendicular to the unit axis a extends
 * r sqrt(1 - a_i^2) along axis i. */
static void bounds(const struct scene *s, const struct item *it, struct vec3 *lo, struct vec3 *hi)
{
    const struct prim *p = &s->prims[it->prim];
    struct vec3 b = p->cone.base, e = p->cone.apex, along = v3_sub(e, b);
    double len2 = v3_dot(along, along), r0 = fabs(p->cone.base_radius),
           r1 = fabs(p->cone.apex_radius);
    double sx = 1, sy = 1, sz = 1;
    if (len2 > 0) {
        sx = sqrt(fmax(0, (along.y * along.y + along.z * along.z) / len2));
        sy = sqrt(fmax(0, (along.z * along.z + along.x * along.x) / len2));
        sz = sqrt(fmax(0, (along.x * along.x + along.y * along.y) / len2));
    }
    *lo = v3(fmin(b.x - r0 * sx, e.x - r1 * sx), fmin(b.y - r0 * sy, e.y - r1 * sy),
        fmin(b.z - r0 * sz, e.z - r1 * sz));
    *hi = v3(fmax(b.x + r0 * sx, e.x + r1 * sx), fmax(b.y + r0 * sy, e.y + r1 * sy),
        fmax(b.z + r0 * sz, e.z + r1 * sz));
}

static void extent(
    const struct scene *s, const struct item *it, struct vec3 n, double *lo, double *hi)
{
    const struct prim *p = &s->prims[it->prim];
    struct vec3 b = p->cone.base, e = p->cone.apex, along = v3_sub(e, b);
    double across = v3_len(v3_cross(n, along)) / v3_len(along); /* of a circle of radius 1 */
    double r0 = fabs(p->cone.base_radius) * across, r1 = fabs(p->cone.apex_radius) * across;
    *lo = fmin(v3_dot(n, b) - r0, v3_dot(n, e) - r1);
    *hi = fmax(v3_dot(n, b) + r0, v3_dot(n, e) + r1);
}

static struct vec3 normal(const struct scene *s, const struct item *it, struct vec3 *p)
{
    struct frame f;
    frame_of(s, it, &f);
    struct vec3 q = v3_sub(*p, f.base);
    double z = v3_dot(q, f.axis), len;
    struct vec3 radial = v3_mad(q, f.axis, -z);
    len = v3_len(radial);
    if (!(len > 0)) return f.axis; /* the tip */
    radial = v3_scale(radial, 1 / len);
    *p = v3_mad(v3_mad(f.base, f.axis, z), radial, f.r + f.k * z);
    return v3_unit(v3_mad(radial, f.axis, -f.k));
}

static bool contains(const struct prim *q, struct vec3 p)
{
    struct vec3 axis = v3_sub(q->cone.apex, q->cone.base), up = v3_sub(p, q->cone.base);
    double r0 = q->cone.base_radius, r1 = q->cone.apex_radius;
    double z = v3_dot(up, axis) / v3_dot(axis, axis); /* 0 at the base, 1 at the apex */
    return z > 0 && z < 1 && v3_len(v3_mad(up, axis, -z)) < r0 + (r1 - r0) * z;
}

static double size(const struct prim *q) { return fmax(q->cone.base_radius, q->cone.apex_radius); }

const struct shape trace_cone = {
    .prim = PRIM_CONE,
    .block_size = sizeof(struct cone4),
    .items_at = offsetof(struct cone4, item),
    .has_surface = has_surface,
    .fill = fill,
    .clear = clear,
    .bounds = bounds,
    .extent = extent,
    .normal = normal,
    .contains = contains,
    .size = size,
};
