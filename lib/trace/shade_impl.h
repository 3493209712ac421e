/*
 * shade_impl: the functions of shade.h, at the vector width of the including file (shade_sse2.c,
 * shade_avx2.c). Operations and their order are those of light.c, math.c and pixel.c.
 */
#include "simd/simd.h"
#include "trace/math.h"
#include "trace/shade.h"

typedef uint64_t vu __attribute__((vector_size(SIMD_BYTES)));
/* Added to a double below 2^51, it leaves the nearest integer in the low bits. */
#define TO_INTEGER 0x1.8p52

/* log2 of normal numbers. */
SIMD_INLINE vd log2_of(vd x)
{
    vd one = vd_set(1);
    vu bits = (vu)x;
    vl exponent = (vl)(bits >> 52) - 1022;
    vd e = (vd)((vl)vd_set(TO_INTEGER) + exponent) - vd_set(TO_INTEGER);
    vd m = (vd)((bits & UINT64_C(0x000fffffffffffff)) | UINT64_C(0x3fe0000000000000));
    vl small = vd_lt(m, vd_set(LOG2_LOW));
    m = vd_choose(small, m * vd_set(2), m);
    e = vd_choose(small, e - one, e);
    vd s = (m - one) / (m + one), z = s * s;
    const double *c = trace_log2_terms;
    vd z2 = z * z, z4 = z2 * z2;
    vd p = (vd_set(c[0]) + vd_set(c[1]) * z) + (vd_set(c[2]) + vd_set(c[3]) * z) * z2 +
           ((vd_set(c[4]) + vd_set(c[5]) * z) + (vd_set(c[6]) + vd_set(c[7]) * z) * z2) * z4 +
           (vd_set(c[8]) + vd_set(c[9]) * z) * (z4 * z4);
    return e + vd_set(2 * LOG2_E) * (s + s * z * p);
}

/* 2^y for y <= 0. */
SIMD_INLINE vd exp2_of(vd y)
{
    vl normal = vd_lt(vd_set(EXP2_LEAST), y);
    y = vd_choose(normal, y, vd_set(0));
    /* y - 0.5 is below 0, so the next integer toward 0 is the next one above it. */
    vd half = y - vd_set(0.5), n = (half + vd_set(TO_INTEGER)) - vd_set(TO_INTEGER);
    n = vd_choose(vd_lt(n, half), n + vd_set(1), n);
    vd f = (y - n) * vd_set(LN_2);
    const double *c = trace_exp2_terms;
    vd f2 = f * f, f4 = f2 * f2;
    vd q =
        (vd_set(c[0]) + vd_set(c[1]) * f) + (vd_set(c[2]) + vd_set(c[3]) * f) * f2 +
        ((vd_set(c[4]) + vd_set(c[5]) * f) + (vd_set(c[6]) + vd_set(c[7]) * f) * f2) * f4 +
        ((vd_set(c[8]) + vd_set(c[9]) * f) + (vd_set(c[10]) + vd_set(c[11]) * f) * f2) * (f4 * f4);
    vd p = vd_set(1) + (f + f2 * q);
    vl whole = (vl)(n + vd_set(TO_INTEGER)) - (vl)vd_set(TO_INTEGER);
    vd scale = (vd)((vu)(whole + 1023) << 52);
    return vd_choose(normal, p * scale, vd_set(0));
}

SIMD_INLINE vd pow_of(vd x, vd y)
{
    vd power = exp2_of(y * log2_of(x));
    power = vd_choose(vd_lt(x, vd_set(POW_LEAST)), vd_set(0), power);
    return vd_choose(vd_le(vd_set(1), x), vd_set(1), power);
}

static void shade_pow(const double *x, const double *y, unsigned n, double *to)
{
    for (unsigned i = 0; i < n; i += VD) vd_store(to + i, pow_of(vd_load(x + i), vd_load(y + i)));
}

SIMD_INLINE vd dot(vd ax, vd ay, vd az, vd bx, vd by, vd bz) { return ax * bx + ay * by + az * bz; }

static uint64_t shade_light(
    const struct shade_points *at, unsigned n, const struct light *l, struct shade_light *out)
{
    uint64_t bits = 0;
    vd zero = vd_set(0);
    for (unsigned i = 0; i < n; i += VD) {
        vd nx = vd_load(at->n[0] + i), ny = vd_load(at->n[1] + i), nz = vd_load(at->n[2] + i);
        vd tx = vd_set(l->pos.x) - vd_load(at->p[0] + i);
        vd ty = vd_set(l->pos.y) - vd_load(at->p[1] + i);
        vd tz = vd_set(l->pos.z) - vd_load(at->p[2] + i);
        vd err = vd_load(at->err + i) + vd_set(ERR_UNIT) * (vd_abs(tx) + vd_abs(ty) + vd_abs(tz));
        vl lit = vd_lt(err, dot(nx, ny, nz, tx, ty, tz));
        if (!vl_signs(lit)) continue;
        vd distance = vd_sqrt(dot(tx, ty, tz, tx, ty, tz)), inv = vd_set(1) / distance;
        vd dx = tx * inv, dy = ty * inv, dz = tz * inv;
        vd n_l = dot(nx, ny, nz, dx, dy, dz);
        vd r_l = dot(vd_load(at->mirrored[0] + i), vd_load(at->mirrored[1] + i),
            vd_load(at->mirrored[2] + i), dx, dy, dz);
        vd ks = vd_load(at->ks + i), highlight = zero;
        vl shines = lit & vd_lt(zero, ks) & vd_lt(zero, r_l);
        if (vl_signs(shines))
            highlight = vd_choose(
                shines, ks * pow_of(vd_min(r_l, vd_set(1)), vd_load(at->shine + i)), highlight);
        vd r = vd_load(at->colour_kd[0] + i), g = vd_load(at->colour_kd[1] + i);
        vd b = vd_load(at->colour_kd[2] + i);
        if (!at->all)
            lit &= vd_lt(zero, vd_abs(r) + vd_abs(g) + vd_abs(b)) | vd_lt(zero, highlight);
        bits |= (uint64_t)vl_signs(lit) << i;
        vd_store(out->light[0] + i, vd_set(l->r) * (r * n_l + highlight));
        vd_store(out->light[1] + i, vd_set(l->g) * (g * n_l + highlight));
        vd_store(out->light[2] + i, vd_set(l->b) * (b * n_l + highlight));
        vd_store(out->distance + i, distance);
        vd_store(out->d[0] + i, dx), vd_store(out->d[1] + i, dy), vd_store(out->d[2] + i, dz);
    }
    return n < 64 ? bits & ((UINT64_C(1) << n) - 1) : bits;
}

static void shade_eye_rays(const struct camera *c, double hither, const double *x, const double *y,
    unsigned n, struct ray *r)
{
    vd w = vd_set((double)c->w), h = vd_set((double)c->h), two = vd_set(2);
    for (unsigned i = 0; i < n; i += VD) {
        _Alignas(SIMD_BYTES) double d[4][VD];
        vd sx = (two * vd_load(x + i) - w) / h, sy = (h - two * vd_load(y + i)) / h;
        vd dx = vd_set(c->forward.x) + vd_set(c->right.x) * sx + vd_set(c->up.x) * sy;
        vd dy = vd_set(c->forward.y) + vd_set(c->right.y) * sx + vd_set(c->up.y) * sy;
        vd dz = vd_set(c->forward.z) + vd_set(c->right.z) * sx + vd_set(c->up.z) * sy;
        vd len = vd_sqrt(dot(dx, dy, dz, dx, dy, dz)), inv = vd_set(1) / len;
        vd_store_aligned(d[0], dx * inv);
        vd_store_aligned(d[1], dy * inv);
        vd_store_aligned(d[2], dz * inv);
        vd_store_aligned(d[3], vd_set(hither) * len); /* hither is a depth along forward */
        for (unsigned k = 0; k < VD && i + k < n; k++)
            r[i + k] =
                (struct ray){c->eye, v3(d[0][k], d[1][k], d[2][k]), d[3][k], HUGE_VAL, 0, false, 0};
    }
}

static const struct shaders shaders = {shade_light, shade_pow, shade_eye_rays};
