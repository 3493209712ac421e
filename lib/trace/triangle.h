/* triangle: blocks of triangles, and the tests of a ray with a block (lanes.h). */
#ifndef STORMRING_TRACE_TRIANGLE_H
#define STORMRING_TRACE_TRIANGLE_H

#include "trace/lanes.h"

struct triangle4 {
    _Alignas(32) double n[3][LANES], d[LANES]; /* the plane: n.p = d, n of length 1 */
    /* Inside if u.p + du >= 0, v.p + dv >= 0 and their sum <= 1; a margin is included. */
    double u[3][LANES], du[LANES], v[3][LANES], dv[LANES];
    double err[LANES]; /* bound on the distance of the plane from its vertices */
    uint32_t item[LANES];
};

static ALWAYS_INLINE unsigned hit_triangle4(const struct triangle4 *b, const struct ray *r,
    double t_max, double t_out[LANES], unsigned *twice)
{
    unsigned mask = 0;
    if (twice) *twice = 0;
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

static inline bool on_triangle4(const struct triangle4 *b, int k, struct vec3 p, double err)
{
    double num = b->d[k] - (b->n[0][k] * p.x + b->n[1][k] * p.y + b->n[2][k] * p.z);
    return fabs(num) < b->err[k] + err;
}

/*
 * The test of hit_triangle4, multiplied by |n.d| so that nothing is divided: a grazing ray, whose t
 * is uncertain, has small values and so is accepted. A ray that starts on the triangle misses it:
 * its origin is off the plane by less than both error bounds.
 */
static ALWAYS_INLINE unsigned may_hit_triangle4(const struct triangle4 *t, const struct packet *p)
{
    _Alignas(32) float q[12][LANES];
    float(*n)[LANES] = q, (*u)[LANES] = q + 4, (*v)[LANES] = q + 8;
    const float *nd = q[3], *ud = q[7], *vd0 = q[11];
    unsigned rays = 0;
    narrow(t->n, q, 12); /* n, d, u, du, v, dv */
    vw margin_n = vw_set(5 * p->pads);
    for (int k = 0; k < LANES && t->item[k] != NO_ITEM; k++) {
        vw mu = vw_set(16 * p->pads * size_of(u, k) + 0x1p-22f);
        vw mv = vw_set(16 * p->pads * size_of(v, k) + 0x1p-22f);
        for (int i = 0; i < PACKET; i += VW) {
            vw ox = vw_aligned(p->o[0] + i), oy = vw_aligned(p->o[1] + i);
            vw oz = vw_aligned(p->o[2] + i);
            vw dx = vw_aligned(p->d[0] + i), dy = vw_aligned(p->d[1] + i);
            vw dz = vw_aligned(p->d[2] + i);
            vw den = dot3(n, k, dx, dy, dz), w = vw_abs(den);
            vw num = vw_flip(vw_set(nd[k]) - dot3(n, k, ox, oy, oz), den);
            vw uu = (dot3(u, k, ox, oy, oz) + vw_set(ud[k])) * w + dot3(u, k, dx, dy, dz) * num;
            vw vv = (dot3(v, k, ox, oy, oz) + vw_set(vd0[k])) * w + dot3(v, k, dx, dy, dz) * num;
            vw wide = w + vw_set(0x1p-20f);
            vw least = vw_min(vw_min(uu + mu, vv + mv), wide - uu - vv + mu + mv);
            vw when = vw_min(num, vw_aligned(p->limit + i) * wide - num) + margin_n;
            rays |= (~(vw_negative_bits(vw_min(least, when)) |
                         vw_equal_bits(p->start + i, t->item[k])) &
                        ((1u << VW) - 1))
                    << i;
        }
    }
    return rays;
}

#endif
