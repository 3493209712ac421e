/*
 * geometry: vectors of three numbers, and the camera that turns pixels into rays. Small structures,
 * passed by value. Nothing here fails or allocates.
 */
#ifndef STORMRING_GEOMETRY_H
#define STORMRING_GEOMETRY_H

#include <math.h>
#include <stdint.h>

#ifndef M_PI /* POSIX has it as an extension */
#define M_PI 3.14159265358979323846
#endif

/* ---- vectors -------------------------------------------------------------------------- */

struct vec3 {
    double x, y, z;
};

static inline struct vec3 v3(double x, double y, double z) { return (struct vec3){x, y, z}; }
static inline struct vec3 v3_of(const double a[3]) { return v3(a[0], a[1], a[2]); }
static inline struct vec3 v3_add(struct vec3 a, struct vec3 b)
{
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline struct vec3 v3_sub(struct vec3 a, struct vec3 b)
{
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline struct vec3 v3_scale(struct vec3 a, double s)
{
    return v3(a.x * s, a.y * s, a.z * s);
}
/* a + s b */
static inline struct vec3 v3_mad(struct vec3 a, struct vec3 b, double s)
{
    return v3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}
static inline double v3_dot(struct vec3 a, struct vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct vec3 v3_cross(struct vec3 a, struct vec3 b)
{
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double v3_len(struct vec3 a) { return sqrt(v3_dot(a, a)); }
static inline struct vec3 v3_unit(struct vec3 a) { return v3_scale(a, 1 / v3_len(a)); }

/* ---- camera --------------------------------------------------------------------------- */

/*
 * Converts pixels to rays as in NFF (E. Haines, "A Proposal for Standard Graphics Environments",
 * IEEE Computer Graphics and Applications 7, 1987): the angle is the vertical field of view, pixels
 * are square, x grows along forward x up, row 0 is on top. The same bits on every host.
 */
struct camera {
    struct vec3 eye, forward, right, up; /* right, up: half the frame's height at distance 1 */
    uint32_t w, h;                       /* frame size in pixels; the caller sets it */
};

/* angle_deg in (0, 180); at differs from from. If `up` is parallel to the view, the roll is
 * arbitrary but always the same. */
struct camera camera_new(struct vec3 from, struct vec3 at, struct vec3 up, double angle_deg);
/* Vector from the eye to the frame's point (x, y), in pixels from the top left corner, on the plane
 * at distance 1 along forward. */
static inline struct vec3 camera_direction(const struct camera *c, double x, double y)
{
    double sx = (2 * x - c->w) / c->h, sy = (c->h - 2 * y) / c->h;
    return v3_mad(v3_mad(c->forward, c->right, sx), c->up, sy);
}

/* angle in [0, pi/2). A C library's tan may differ in the last bit between hosts. */
double portable_tan(double angle);

#endif
