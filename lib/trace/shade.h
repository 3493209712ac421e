/*
 * shade: shading of many points by vectors, one point a lane. Each lane has the bits that the
 * scalar functions compute (light.c, math.c), at every width.
 */
#ifndef STORMRING_TRACE_SHADE_H
#define STORMRING_TRACE_SHADE_H

#include "trace/trace_int.h"

/* Points that are shaded together; see struct hit_point and struct surface. Lanes up to the next
 * multiple of the vectors' length hold any numbers. */
struct shade_points {
    double p[3][WAVE_RAYS], n[3][WAVE_RAYS], mirrored[3][WAVE_RAYS], err[WAVE_RAYS];
    double colour_kd[3][WAVE_RAYS], ks[WAVE_RAYS], shine[WAVE_RAYS];
    bool all; /* those too that a lamp they face adds nothing to: SPD counts them */
};

/* The light of one lamp: its direction and distance, and what it brings if nothing is between. */
struct shade_light {
    double d[3][WAVE_RAYS], distance[WAVE_RAYS], light[3][WAVE_RAYS];
};

/* The functions of one instruction set. All return the same bits. */
struct shaders {
    /* light_from for n points. Sets the lanes of the returned bits; the others hold any numbers. */
    uint64_t (*light)(
        const struct shade_points *at, unsigned n, const struct light *l, struct shade_light *to);
    /* trace_pow for n numbers. */
    void (*pow)(const double *x, const double *y, unsigned n, double *to);
    /* The eye rays through points (x, y) of the frame, in pixels. */
    void (*eye_rays)(const struct camera *c, double hither, const double *x, const double *y,
        unsigned n, struct ray *r);
};
const struct shaders *trace_shaders_sse2(void);
/* NULL if this build or this machine lacks the instruction set. */
const struct shaders *trace_shaders_avx2(void);

#endif
