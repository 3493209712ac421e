/*
 * filter: which rays of a packet may hit an item of a block. All rays are tested against one item
 * at a time, in float. The tests are conservative: they accept each ray that the tests in double
 * accept (hit.h), which then decide.
 *
 * Let e = 2^-24, the rounding of a float. P is the sum of the packet's pads: at least
 * 4e (|o| + 3 reach), |.| the sum of absolute coordinates. So P is more than twice the error of a
 * float point of a ray or an item. Each margin below exceeds the sum of the errors of its operands
 * and operations. A NaN rejects nothing.
 */
#ifndef STORMRING_TRACE_FILTER_H
#define STORMRING_TRACE_FILTER_H

#include "trace/kernel.h"

struct packet {
    _Alignas(64) float o[3][PACKET];
    _Alignas(64) float d[3][PACKET];
    _Alignas(64) float inv[3][PACKET];   /* 1 / d */
    _Alignas(64) float from[6][PACKET];  /* by axis: (o + pad) / d, then (o - pad) / d */
    _Alignas(64) float limit[PACKET];    /* no hit beyond this t matters; -1: the ray is finished */
    _Alignas(64) uint32_t start[PACKET]; /* the item that the ray starts on, or NO_ITEM */
    float pad[3], pads;                  /* pads: their sum */
    struct box_ray all; /* bounds over all rays: padded origins, least and greatest slopes */
    float far_inv[3];
    int mixed; /* axes with slopes of both signs: they do not cull */
    float limit_max;
    const struct ray *const *ray;
};

/* The nearest floats of `rows` rows of lanes. */
static ALWAYS_INLINE void narrow(const double (*from)[LANES], float (*to)[LANES], int rows)
{
    for (int i = 0; i < rows; i++)
        for (int k = 0; k < LANES; k++) to[i][k] = (float)from[i][k];
}

static ALWAYS_INLINE vw dot3(float (*a)[LANES], int k, vw x, vw y, vw z)
{
    return vw_set(a[0][k]) * x + vw_set(a[1][k]) * y + vw_set(a[2][k]) * z;
}

static ALWAYS_INLINE float size_of(float (*a)[LANES], int k)
{
    return fabsf(a[0][k]) + fabsf(a[1][k]) + fabsf(a[2][k]);
}

/*
 * The test of hit_tri4, multiplied by |n.d| so that nothing is divided: a grazing ray, whose t is
 * uncertain, has small values and so is accepted. A ray that starts on the triangle misses it:
 * its origin is off the plane by less than both error bounds.
 */
static ALWAYS_INLINE unsigned may_hit_tri4(const struct tri4 *t, const struct packet *p)
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

/* The rays of the packet that may hit block i. */
static ALWAYS_INLINE unsigned may_hit_block(
    const struct bvh *b, enum item_kind kind, uint32_t i, const struct packet *p)
{
    switch (kind) {
    case ITEM_TRIANGLE: return may_hit_tri4((const struct tri4 *)b->blocks[kind] + i, p);
    case ITEM_SPHERE: return may_hit_sphere4((const struct sphere4 *)b->blocks[kind] + i, p);
    case ITEM_CONE: break;
    }
    return may_hit_cone4((const struct cone4 *)b->blocks[kind] + i, p);
}

#endif
