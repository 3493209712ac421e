/* sphere: blocks of spheres, and the tests of a ray with a block (lanes.h). */
#ifndef STORMRING_TRACE_SPHERE_H
#define STORMRING_TRACE_SPHERE_H

#include "trace/lanes.h"

struct sphere4 {
    _Alignas(32) double c[3][LANES], r[LANES], err[LANES];
    uint32_t item[LANES];
};

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

static inline bool on_sphere4(const struct sphere4 *s, int k, struct vec3 p, double err)
{
    double fx = s->c[0][k] - p.x, fy = s->c[1][k] - p.y, fz = s->c[2][k] - p.z, r = s->r[k];
    return fabs(fx * fx + fy * fy + fz * fz - r * r) < (r + r) * (s->err[k] + err);
}

/* A ray that starts on the sphere hits it only if it goes inward: b > 0. */
static ALWAYS_INLINE unsigned may_hit_sphere4(const struct sphere4 *s, const struct packet *p)
{
    _Alignas(32) float q[4][LANES];
    unsigned rays = 0;
    narrow(s->c, q, 4); /* c, r */
    vw margin = vw_set(2 * p->pads);
    for (int k = 0; k < LANES && s->item[k] != NO_ITEM; k++) {
        float r = (q[3][k] + 4 * p->pads) * (1 + 0x1p-20f);
        for (int i = 0; i < PACKET; i += VW) {
            vw dx = vw_aligned(p->d[0] + i), dy = vw_aligned(p->d[1] + i);
            vw dz = vw_aligned(p->d[2] + i);
            vw fx = vw_set(q[0][k]) - vw_aligned(p->o[0] + i);
            vw fy = vw_set(q[1][k]) - vw_aligned(p->o[1] + i);
            vw fz = vw_set(q[2][k]) - vw_aligned(p->o[2] + i);
            vw b = fx * dx + fy * dy + fz * dz;
            vw gx = fx - b * dx, gy = fy - b * dy, gz = fz - b * dz;
            vw g = vw_set(r * r) - (gx * gx + gy * gy + gz * gz);
            vw when = vw_min(b, vw_aligned(p->limit + i) - b) + vw_set(r) + margin;
            unsigned miss = vw_negative_bits(vw_min(g, when));
            unsigned out = vw_equal_bits(p->start + i, s->item[k]) & vw_negative_bits(b + margin);
            rays |= (~(miss | out) & ((1u << VW) - 1)) << i;
        }
    }
    return rays;
}

#endif
