/*
 * parts: functions that the scenes share. Private to lib/spd.
 *
 * Scenes must match the output of SPD's programs digit for digit. In that output, coordinates that
 * should be 0 are rounding errors like 1e-16. Therefore sums and products here follow SPD's order,
 * and unit vectors are divided, not scaled.
 */
#ifndef STORMRING_SPD_PARTS_H
#define STORMRING_SPD_PARTS_H

#include "spd/spd.h"

#define SPD_PI 3.141592653589793

/* Row-major; vectors are rows and multiply from the left. */
struct mat3 {
    struct vec3 row[3];
};

static inline struct vec3 spd_transform(struct vec3 v, const struct mat3 *m)
{
    const struct vec3 *r = m->row;
    return v3(v.x * r[0].x + v.y * r[1].x + v.z * r[2].x,
        v.x * r[0].y + v.y * r[1].y + v.z * r[2].y, v.x * r[0].z + v.y * r[1].z + v.z * r[2].z);
}
static inline struct vec3 spd_divide(struct vec3 v, double d)
{
    return v3(v.x / d, v.y / d, v.z / d);
}

/* Counterclockwise rotation about +z. */
struct mat3 spd_rotate_z(double angle);
/*
 * Writes the background, view and lights that begin every scene. The camera is tilted upward by
 * turn_deg degrees about its position.
 */
void spd_put_setting(
    struct nff_out *o, const struct view *v, double turn_deg, const struct vec3 *lights, size_t n);
/* Phong exponent of a highlight that falls to one half at this angle. At 0 it is 1e5, which means
 * no highlight. */
double spd_shine(double half_angle_deg);

#endif
