/*
 * ends: tests whether a point lies on a surface. A shadow ray does not cross the surface that its
 * own light lies on.
 *
 * If a lamp lies on a surface, the hit is at the ray's end. Its t is off by d / |n.d|, where d is
 * the error in the distance between lamp and surface, and n.d is the slope of the ray to the
 * surface. So no bound on t alone holds for grazing rays. The lamp's distance from the surface
 * decides instead, as the origin's distance does at a ray's start. Let u = 2^-53, p the ray's
 * origin, l its light, D their distance, |.| the sum of absolute coordinates. Rounding moves
 *
 *     the lamp as it was read         by u |l|
 *     l - p, its length, the direction by 4 u D, and so p + D d by u |l| + 6 u D in all,
 *     the vertices, centre or axis    by u times their coordinates, and the value of the surface
 *     equation at a point             by 6 u times these and the coordinates of the point,
 *
 * and |l| <= |p| + D sqrt 3. The sum is below 16 u (|p| + D) for the lamp and 16 u times the
 * surface's coordinates. ERR_UNIT is 32 u. In units of 2^-48 of the coordinates: a lamp at a
 * distance of 1 or more behind a surface is shaded by it; a nearer lamp lies on it.
 */
#ifndef STORMRING_TRACE_ENDS_H
#define STORMRING_TRACE_ENDS_H

#include "trace/trace_int.h"

/* True if p, known up to err, lies on the surface of lane k of a block. Uses the same operations as
 * the hit functions use for a ray's origin. */
static inline bool on_tri(const struct tri4 *b, int k, struct vec3 p, double err)
{
    double num = b->d[k] - (b->n[0][k] * p.x + b->n[1][k] * p.y + b->n[2][k] * p.z);
    return fabs(num) < b->err[k] + err;
}

static inline bool on_sphere(const struct sphere4 *s, int k, struct vec3 p, double err)
{
    double fx = s->c[0][k] - p.x, fy = s->c[1][k] - p.y, fz = s->c[2][k] - p.z, r = s->r[k];
    return fabs(fx * fx + fy * fy + fz * fz - r * r) < (r + r) * (s->err[k] + err);
}

static inline bool on_cone(const struct cone4 *s, int i, struct vec3 p, double point_err)
{
    double ax = s->a[0][i], ay = s->a[1][i], az = s->a[2][i], k = s->k[i], half = 0.5 * s->h[i];
    double qx = p.x - (s->b[0][i] + half * ax), qy = p.y - (s->b[1][i] + half * ay);
    double qz = p.z - (s->b[2][i] + half * az), z = qx * ax + qy * ay + qz * az;
    double rx = qx - z * ax, ry = qy - z * ay, rz = qz - z * az;
    double w = s->r[i] + k * half + k * z, width = fabs(w), err = s->err[i] + point_err;
    double c = rx * rx + ry * ry + rz * rz - w * w;
    return fabs(c) < err * (width + width + err) * (1 + fabs(k));
}

static inline bool on_surface(
    const struct bvh *b, enum item_kind kind, uint32_t i, int k, struct vec3 p, double err)
{
    switch (kind) {
    case ITEM_TRIANGLE: return on_tri((const struct tri4 *)b->blocks[kind] + i, k, p, err);
    case ITEM_SPHERE: return on_sphere((const struct sphere4 *)b->blocks[kind] + i, k, p, err);
    case ITEM_CONE: break;
    }
    return on_cone((const struct cone4 *)b->blocks[kind] + i, k, p, err);
}

#endif
