/*
 * volume_cases: what the tests of single rays share, beside volume_scenes.h. For cmocka.
 */
#ifndef VOLUME_CASES_H
#define VOLUME_CASES_H

#include "volume_scenes.h"

/* A ray straight down. */
static const double above[3] = {2.3, 1.6, 20}, below[3] = {2.3, 1.6, 0};

static inline void near(double got, double expected, double e)
{
    if (!(fabs(got - expected) <= e)) fail_msg("%.9g, expected %.9g", got, expected);
}

/* Fields: z itself; a constant; noise at nodes an eighth apart, in steps of 1/64. */
static inline double of_z(double x, double y, double z) { return 0 * (x + y) + z; }
static inline double seven(double x, double y, double z) { return 7 + 0 * (x + y + z); }
static inline double rough(double x, double y, double z)
{
    uint64_t node = (uint64_t)(x * 8 + 1000) * 1000003 + (uint64_t)(y * 8 + 1000) * 1009;
    return floor(10 * 64 * rng_unit(3, node + (uint64_t)(z * 8 + 1000))) / 64;
}

static inline double absorbed(double depth) { return 1 - exp(-depth); }

#endif
