/*
 * lanes: what the files of shapes share (triangle.h, sphere.h, cone.h). Each has its block, struct
 * NAME4, and three tests of it, at the vector width of the including file:
 *
 *     hit_NAME4      The lanes that a ray hits at t_min < t <= t_max, and the first t of each.
 *                    *twice (may be NULL): the lanes hit a second time within these bounds. In
 *                    double, by the same operations per lane at every width. Each hit lies in the
 *                    box of its item except for rounding, as boxes and filters expect.
 *     on_NAME4       True if p, known up to err, lies on the surface of lane k. Uses the same
 *                    operations as hit_NAME4 uses for a ray's origin.
 *     may_hit_NAME4  The rays of a packet that may hit the block. All rays are tested against one
 *                    item at a time, in float. The tests are conservative: they accept each ray
 *                    that hit_NAME4 accepts, which then decides.
 *
 * Margins of may_hit_NAME4. Let e = 2^-24, the rounding of a float. P is the sum of the packet's
 * pads: at least 4e (|o| + 3 reach), |.| the sum of absolute coordinates. So P is more than twice
 * the error of a float point of a ray or an item. Each margin exceeds the sum of the errors of its
 * operands and operations. A NaN rejects nothing.
 *
 * Why on_NAME4: a shadow ray does not cross the surface that its own light lies on. If a lamp lies
 * on a surface, the hit is at the ray's end. Its t is off by d / |n.d|, where d is the error in the
 * distance between lamp and surface, and n.d is the slope of the ray to the surface. So no bound on
 * t alone holds for grazing rays. The lamp's distance from the surface decides instead, as the
 * origin's distance does at a ray's start. Let u = 2^-53, p the ray's origin, l its light, D their
 * distance. Rounding moves
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
#ifndef STORMRING_TRACE_LANES_H
#define STORMRING_TRACE_LANES_H

/* A node has eight children, a block four lanes. */
#ifndef SIMD_MOST
#define SIMD_MOST 32
#endif
#include "simd/simd.h"
#include "trace/trace_int.h"

#define ALWAYS_INLINE inline __attribute__((always_inline))

/* A ray, prepared for tests of boxes. */
struct box_ray {
    float near[3], far[3], inv[3];        /* origins for the near and far planes; 1/d */
    uint32_t near_plane[3], far_plane[3]; /* offsets of these planes in a node, in floats */
};

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

#endif
