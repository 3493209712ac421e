/*
 * parts: what the scenes have in common. Private to lib/spd.
 *
 * Scenes are to come out digit for digit as SPD's programs write them, whose coordinates that
 * ought to be 0 are rounding errors like 1e-16: sums and products here are in SPD's order, and
 * unit vectors are divided, not scaled.
 */
#ifndef STORMRING_SPD_PARTS_H
#define STORMRING_SPD_PARTS_H

#include "spd/spd.h"

#define SPD_PI 3.141592653589793

/* Rows; vectors are rows and stand on the left. */
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

/* Counterclockwise about +z. */
struct mat3 spd_rotate_z(double angle);
/*
 * Background, view and lights, which all scenes begin with; the camera turned upward by so many
 * degrees, about its place.
 */
void spd_put_setting(
    struct nff_out *o, const struct view *v, double turn_deg, const struct vec3 *lights, size_t n);
/* Phong's exponent of a highlight that falls to one half at this angle; 1e5 at 0 means none. */
double spd_shine(double half_angle_deg);

#endif
