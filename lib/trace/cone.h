/* cone: blocks of cones, and the tests of a ray with a block (lanes.h). */
#ifndef STORMRING_TRACE_CONE_H
#define STORMRING_TRACE_CONE_H

#include "trace/lanes.h"

/* Axis a from base b; height z along it in [0, h]; radius r + k z. */
struct cone4 {
    _Alignas(32) double b[3][LANES], a[3][LANES], h[LANES], r[LANES], k[LANES], err[LANES];
    uint32_t item[LANES];
};

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

static inline bool on_cone4(const struct cone4 *s, int i, struct vec3 p, double point_err)
{
    double ax = s->a[0][i], ay = s->a[1][i], az = s->a[2][i], k = s->k[i], half = 0.5 * s->h[i];
    double qx = p.x - (s->b[0][i] + half * ax), qy = p.y - (s->b[1][i] + half * ay);
    double qz = p.z - (s->b[2][i] + half * az), z = qx * ax + qy * ay + qz * az;
    double rx = qx - z * ax, ry = qy - z * ay, rz = qz - z * az;
    double w = s->r[i] + k * half + k * z, width = fabs(w), err = s->err[i] + point_err;
    double c = rx * rx + ry * ry + rz * rz - w * w;
    return fabs(c) < err * (width + width + err) * (1 + fabs(k));
}

/*
 * A ray that hits the cone passes its axis within the greatest radius, and the middle of the axis
 * within the cone's extent. A ray that starts on the cone and leaves it does not hit it again if
 * both roots of the quadratic have one sign (a > 0 and b > 0 in hit_cone4).
 */
static ALWAYS_INLINE unsigned may_hit_cone4(const struct cone4 *s, const struct packet *p)
{
    _Alignas(32) float q[9][LANES];
    unsigned rays = 0;
    narrow(s->b, q, 9); /* b, a, h, r, k */
    for (int k = 0; k < LANES && s->item[k] != NO_ITEM; k++) {
        float half = 0.5f * q[6][k], r0 = q[7][k], slope = q[8][k], r1 = r0 + slope * q[6][k];
        float r = ((r0 > r1 ? r0 : r1) + 4 * p->pads) * (1 + 0x1p-20f);
        float steep = 1 + fabsf(slope), extent = half + r;
        vw ax = vw_set(q[3][k]), ay = vw_set(q[4][k]), az = vw_set(q[5][k]), m = vw_set(slope);
        for (int i = 0; i < PACKET; i += VW) {
            vw dx = vw_aligned(p->d[0] + i), dy = vw_aligned(p->d[1] + i);
            vw dz = vw_aligned(p->d[2] + i);
            /* q: from the middle of the axis; w: across the ray and the axis */
            vw qx = vw_aligned(p->o[0] + i) - vw_set(q[0][k] + half * q[3][k]);
            vw qy = vw_aligned(p->o[1] + i) - vw_set(q[1][k] + half * q[4][k]);
            vw qz = vw_aligned(p->o[2] + i) - vw_set(q[2][k] + half * q[5][k]);
            vw wx = dy * az - dz * ay, wy = dz * ax - dx * az, wz = dx * ay - dy * ax;
            vw along = qx * dx + qy * dy + qz * dz, ww = wx * wx + wy * wy + wz * wz;
            vw gap = vw_abs(qx * wx + qy * wy + qz * wz) - vw_set(8 * p->pads);
            gap = vw_max(gap, vw_set(0));
            vw g = vw_set(r * r) * (ww * vw_set(1 + 0x1p-9f) + vw_set(0x1p-32f)) - gap * gap;
            vw when = vw_min(vw_aligned(p->limit + i) + along, vw_set(0) - along);
            unsigned miss = vw_negative_bits(vw_min(g, when + vw_set(extent + 4 * p->pads)));
            unsigned start = vw_equal_bits(p->start + i, s->item[k]);
            if (start & ~miss) {
                vw z = qx * ax + qy * ay + qz * az, rise = dx * ax + dy * ay + dz * az;
                vw b = along - z * rise - (vw_set(r0 + slope * half) + m * z) * m * rise;
                vw most = m * (vw_abs(rise) + vw_set(0x1p-21f));
                vw a = ww * vw_set(1 - 0x1p-9f) - vw_set(0x1p-32f) -
                       most * most * vw_set(1 + 0x1p-20f);
                vw least = vw_min(a, b - vw_set(16 * p->pads * steep * steep));
                miss |= start & vw_negative_bits(vw_set(0) - least);
            }
            rays |= (~miss & ((1u << VW) - 1)) << i;
        }
    }
    return rays;
}

#endif
