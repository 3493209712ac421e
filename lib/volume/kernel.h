/*
 * kernel: cell.c and the exact moments for VD cells at a time, at the vector width of the including
 * file (volume_sse2.c, volume_avx2.c, volume_avx512.c).
 */
#include "volume/batch.h"
#include "volume/simd.h"
#include "volume/stream_ray.h"

/* Local coordinates at t, clamped to the cell against rounding. */
SIMD_INLINE vd local(const struct batch *b, int a, uint32_t j, vd t)
{
    vd u = (b->o[a] + t * b->d[a] - vd_load(b->plane[a] + j)) * vd_load(b->inv[a] + j);
    return vd_min(vd_max(u, vd_set(0)), vd_set(1));
}

static void batch_cubics(struct batch *b)
{
    for (uint32_t j = 0; j < b->n; j += VD) {
        vd t0 = vd_load(b->t0 + j), t1 = vd_load(b->t1 + j);
        vd x = local(b, 0, j, t0), y = local(b, 1, j, t0), z = local(b, 2, j, t0);
        vd dx = local(b, 0, j, t1) - x, dy = local(b, 1, j, t1) - y, dz = local(b, 2, j, t1) - z;
        vd o = vd_widen(b->corner[0] + j), fx = vd_widen(b->corner[1] + j) - o;
        vd fy = vd_widen(b->corner[2] + j) - o, sxy = vd_widen(b->corner[3] + j) - o;
        vd fz = vd_widen(b->corner[4] + j) - o, sxz = vd_widen(b->corner[5] + j) - o;
        vd syz = vd_widen(b->corner[6] + j) - o, sxyz = vd_widen(b->corner[7] + j) - o;
        vd fxy = sxy - fx - fy, fxz = sxz - fx - fz, fyz = syz - fy - fz;
        vd fxyz = sxyz - sxy - syz - fxz + fy;
        vd xy = fxy + fxyz * z, xz = fxz + fxyz * y, yz = fyz + fxyz * x;
        vd by_y = fy + fxy * x, by_z = fz + fxz * x + y * yz;
        vd p0 = fx * x + y * by_y + z * by_z;
        vd p1 = dx * (fx + fxy * y + z * xz) + dy * (by_y + z * yz) + dz * by_z;
        vd p2 = dx * (dy * xy + dz * xz) + dy * dz * yz;
        vd p3 = dx * dy * dz * fxyz;
        vd b1 = p0 + p1 * (1.0 / 3), b2 = b1 + (p1 + p2) * (1.0 / 3), b3 = p0 + p1 + p2 + p3;
        vd_store(b->p[0] + j, p0);
        vd_store(b->p[1] + j, p1);
        vd_store(b->p[2] + j, p2);
        vd_store(b->p[3] + j, p3);
        vd_store(b->lo + j, o + vd_min(vd_min(p0, b1), vd_min(b2, b3)));
        vd_store(b->hi + j, o + vd_max(vd_max(p0, b1), vd_max(b2, b3)));
    }
}

static void batch_moments(struct batch *b)
{
    for (uint32_t j = 0; j < b->n; j += VD) {
        vd q0 = vd_load(b->p[0] + j) - (vd_load(b->from + j) - vd_widen(b->corner[0] + j));
        vd q1 = vd_load(b->p[1] + j), q2 = vd_load(b->p[2] + j), q3 = vd_load(b->p[3] + j);
        vd k0 = vd_load(b->k0 + j), k1 = vd_load(b->k1 + j);
        vd one = q0 + q1 * (1.0 / 2) + q2 * (1.0 / 3) + q3 * (1.0 / 4);
        vd two = q0 * (q0 + q1) + (q1 * q1 + 2 * q0 * q2) * (1.0 / 3) +
                 (q0 * q3 + q1 * q2) * (1.0 / 2) + (q2 * q2 + 2 * q1 * q3) * (1.0 / 5) +
                 q2 * q3 * (1.0 / 3) + q3 * q3 * (1.0 / 7);
        vd k = k0 + k1 * one, mean = (k0 * one + k1 * two) / k;
        vd depth = k * (vd_load(b->t1 + j) - vd_load(b->t0 + j));
        vd range = vd_load(b->hi + j) - vd_load(b->lo + j);
        vd_store(b->depth + j, depth);
        vd_store(b->through + j, vd_exp(-depth));
        vd_store(b->error + j, vd_load(b->slope + j) * range * depth * COVARIANCE);
        for (int c = 0; c < 3; c++)
            vd_store(b->rgb[c] + j, vd_load(b->rgb0[c] + j) + vd_load(b->rgb1[c] + j) * mean);
    }
}

static const struct kernel table = {batch_cubics, batch_moments, rays};
