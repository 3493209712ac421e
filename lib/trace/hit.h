/*
 * hit: which lanes of a block a ray hits, and where. In double, by the same operations per lane at
 * every width. Each hit lies in the box of its item except for rounding, as boxes and filters
 * expect.
 */
#ifndef STORMRING_TRACE_HIT_H
#define STORMRING_TRACE_HIT_H

/* A node has eight children, a block four lanes. */
#ifndef SIMD_MOST
#define SIMD_MOST 32
#endif
#include "simd/simd.h"
#include "trace/trace_int.h"

#define ALWAYS_INLINE inline __attribute__((always_inline))

/*
 * Each of these functions returns the lanes of a block that are hit at t_min < t <= t_max, and the
 * first t of each. *twice (may be NULL): the lanes hit a second time within these bounds.
 */

static ALWAYS_INLINE unsigned hit_tri4(
    const struct tri4 *b, const struct ray *r, double t_max, double t_out[LANES])
{
    unsigned mask = 0;
    vd ox = vd_set(r->o.x), oy = vd_set(r->o.y), oz = vd_set(r->o.z);
    vd dx = vd_set(r->d.x), dy = vd_set(r->d.y), dz = vd_set(r->d.z);
    for (int i = 0; i < LANES; i += VD) {
        vd nx = vd_aligned(b->n[0] + i), ny = vd_aligned(b->n[1] + i), nz = vd_aligned(b->n[2] + i);
        vd num = vd_aligned(b->d + i) - (nx * ox + ny * oy + nz * oz);
        vd t = num / (nx * dx + ny * dy + nz * dz);
        vd px = ox + t * dx, py = oy + t * dy, pz = oz + t * dz;
        vd u = vd_aligned(b->u[0] + i) * px + vd_aligned(b->u[1] + i) * py +
               vd_aligned(b->u[2] + i) * pz + vd_aligned(b->du + i);
        vd v = vd_aligned(b->v[0] + i) * px + vd_aligned(b->v[1] + i) * py +
               vd_aligned(b->v[2] + i) * pz + vd_aligned(b->dv + i);
        vl in = vd_le(vd_set(0), u) & vd_le(vd_set(0), v) & vd_le(u + v, vd_set(1));
        vl far = vd_lt(vd_aligned(b->err + i) + vd_set(r->err), vd_abs(num));
        vl when = vd_lt(vd_set(r->t_min), t) & vd_le(t, vd_set(t_max));
        vd_store_aligned(t_out + i, t);
        mask |= vl_signs(in & far & when) << i;
    }
    return mask;
}

/*
 * E. Haines, J. Gunther, T. Akenine-Moller, "Precision improvements for ray/sphere intersection",
 * Ray Tracing Gems ch. 7, 2019: the discriminant from the centre's distance to the ray, the smaller
 * root from the product of both. If a ray starts on the sphere, within error bounds, only the other
 * root counts.
 */
static ALWAYS_INLINE unsigned hit_sphere4(const struct sphere4 *s, const struct ray *r,
    double t_max, double t_out[LANES], unsigned *twice)
{
    unsigned mask = 0;
    vd ox = vd_set(r->o.x), oy = vd_set(r->o.y), oz = vd_set(r->o.z);
    vd dx = vd_set(r->d.x), dy = vd_set(r->d.y), dz = vd_set(r->d.z);
    if (twice) *twice = 0;
    for (int i = 0; i < LANES; i += VD) {
        vd radius = vd_aligned(s->r + i), zero = vd_set(0);
        vd fx = vd_aligned(s->c[0] + i) - ox, fy = vd_aligned(s->c[1] + i) - oy;
        vd fz = vd_aligned(s->c[2] + i) - oz;
        vd b = fx * dx + fy * dy + fz * dz;
        vd gx = fx - b * dx, gy = fy - b * dy, gz = fz - b * dz;
        vd r2 = radius * radius, disc = r2 - (gx * gx + gy * gy + gz * gz);
        vl hit = vd_le(zero, disc);
        if (!vl_signs(hit)) continue;
        vd c = fx * fx + fy * fy + fz * fz - r2;
        vd root = vd_sqrt(disc);
        vl positive = vd_lt(zero, b);
        vd q = b + vd_choose(positive, root, zero - root);
        vl on = vd_le(vd_abs(c), (radius + radius) * (vd_aligned(s->err + i) + vd_set(r->err)));
        vd p = c / q;
        vd near = vd_choose(positive, p, q), far = vd_choose(positive, q, p);
        /* On the surface p is the root near 0, so only the other root q counts. */
        near = vd_choose(on, zero, near);
        far = vd_choose(on, q, far);
        vl enters = vd_lt(vd_set(r->t_min), near);
        vd t = vd_choose(enters, near, far), limit = vd_set(t_max);
        vd_store_aligned(t_out + i, t);
        hit &= vd_lt(vd_set(r->t_min), t) & vd_le(t, limit);
        mask |= vl_signs(hit) << i;
        if (twice) *twice |= vl_signs(hit & enters & vd_le(far, limit)) << i;
    }
    return mask;
}

/* True if s + t e is at most `most` long, apart from rounding. */
static ALWAYS_INLINE vl cone_within(vd sx, vd sy, vd sz, vd t, vd ex, vd ey, vd ez, vd most)
{
    vd x = sx + t * ex, y = sy + t * ey, z = sz + t * ez;
    return vd_le(x * x + y * y + z * z, most * most * vd_set(1 + 0x1p-30));
}

/* Of a steeper cone the rounding of a height moves a hit far beside it. Some boxes and filters
 * contain such a hit and others do not, so it counts only within the greatest radius. */
#define STEEP 0x1p20

/*
 * The quadratic a t^2 + 2 b t + c in coordinates along and across the axis. Its origin is the ray's
 * point nearest to the middle of the cone, because the coefficients are smallest there.
 */
static ALWAYS_INLINE unsigned hit_cone4(
    const struct cone4 *s, const struct ray *r, double t_max, double t_out[LANES], unsigned *twice)
{
    unsigned mask = 0;
    vd ox = vd_set(r->o.x), oy = vd_set(r->o.y), oz = vd_set(r->o.z);
    vd dx = vd_set(r->d.x), dy = vd_set(r->d.y), dz = vd_set(r->d.z);
    if (twice) *twice = 0;
    for (int i = 0; i < LANES; i += VD) {
        vd ax = vd_aligned(s->a[0] + i), ay = vd_aligned(s->a[1] + i), az = vd_aligned(s->a[2] + i);
        vd h = vd_aligned(s->h + i), k = vd_aligned(s->k + i), half = vd_set(0.5) * h,
           zero = vd_set(0);
        /* q is relative to the middle of the axis; m is the radius there. */
        vd m = vd_aligned(s->r + i) + k * half;
        vd qx = ox - (vd_aligned(s->b[0] + i) + half * ax);
        vd qy = oy - (vd_aligned(s->b[1] + i) + half * ay);
        vd qz = oz - (vd_aligned(s->b[2] + i) + half * az);
        vd z0 = qx * ax + qy * ay + qz * az;   /* height of the origin */
        vd rise = dx * ax + dy * ay + dz * az; /* height per unit of t */
        vd ex = dx - rise * ax, ey = dy - rise * ay, ez = dz - rise * az;
        vd shift = zero - (qx * dx + qy * dy + qz * dz);
        vd sx = qx + shift * dx, sy = qy + shift * dy, sz = qz + shift * dz;
        vd z = sx * ax + sy * ay + sz * az;
        sx = sx - z * ax, sy = sy - z * ay, sz = sz - z * az;
        vd w = m + k * z, slope = k * rise;
        vd a = ex * ex + ey * ey + ez * ez - slope * slope;
        vd b = sx * ex + sy * ey + sz * ez - w * slope;
        vd c = sx * sx + sy * sy + sz * sz - w * w;
        vd disc = b * b - a * c;
        vl hit = vd_le(zero, disc);
        if (!vl_signs(hit)) continue;
        vd root = vd_sqrt(disc);
        vd q = zero - (b + vd_choose(vd_lt(b, zero), zero - root, root));
        vd t1 = q / a + shift, t2 = c / q + shift; /* infinite if there is only one root */
        /* If the ray starts on the surface, only its other root counts. */
        vd rx = qx - z0 * ax, ry = qy - z0 * ay, rz = qz - z0 * az, w0 = m + k * z0;
        vd err = vd_aligned(s->err + i) + vd_set(r->err), width = vd_abs(w0);
        vd c0 = rx * rx + ry * ry + rz * rz - w0 * w0;
        vl on = vd_le(vd_abs(c0), err * (width + width + err) * (vd_set(1) + vd_abs(k)));
        vd other = vd_set(-2) * (rx * ex + ry * ey + rz * ez - w0 * slope) / a;
        t1 = vd_choose(on, other, t1);
        t2 = vd_choose(on, vd_set(-1), t2);
        vd h1 = z0 + t1 * rise, h2 = z0 + t2 * rise, limit = vd_set(t_max);
        vl ok1 = vd_lt(vd_set(r->t_min), t1) & vd_le(t1, limit) & vd_le(vd_abs(h1), half);
        vl ok2 = vd_lt(vd_set(r->t_min), t2) & vd_le(t2, limit) & vd_le(vd_abs(h2), half);
        vl steep = vd_lt(vd_set(STEEP), vd_abs(k));
        if (vl_signs(steep)) {
            vd most = m + vd_abs(k) * half + err;
            ok1 &= ~steep | cone_within(sx, sy, sz, t1 - shift, ex, ey, ez, most);
            ok2 &= ~steep | cone_within(sx, sy, sz, t2 - shift, ex, ey, ez, most);
        }
        vd t = vd_choose(ok1 & ok2, vd_choose(vd_lt(t1, t2), t1, t2), vd_choose(ok1, t1, t2));
        vd_store_aligned(t_out + i, t);
        unsigned ok = vl_signs(ok1) | vl_signs(ok2);
        mask |= (vl_signs(hit) & ok) << i;
        if (twice) *twice |= (vl_signs(hit) & vl_signs(ok1) & vl_signs(ok2)) << i;
    }
    return mask;
}

static ALWAYS_INLINE unsigned hit_block(const struct bvh *b, enum item_kind kind, uint32_t i,
    const struct ray *r, double t_max, double t[LANES], const uint32_t **items, unsigned *twice)
{
    switch (kind) {
    case ITEM_TRIANGLE: {
        const struct tri4 *p = (const struct tri4 *)b->blocks[ITEM_TRIANGLE] + i;
        *items = p->item;
        if (twice) *twice = 0;
        return hit_tri4(p, r, t_max, t);
    }
    case ITEM_SPHERE: {
        const struct sphere4 *p = (const struct sphere4 *)b->blocks[ITEM_SPHERE] + i;
        *items = p->item;
        return hit_sphere4(p, r, t_max, t, twice);
    }
    case ITEM_CONE: break;
    }
    const struct cone4 *p = (const struct cone4 *)b->blocks[ITEM_CONE] + i;
    *items = p->item;
    return hit_cone4(p, r, t_max, t, twice);
}

#endif
