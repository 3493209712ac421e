/* camera: view and projection. */
#include "geometry/geometry.h"

#define HALF_DEGREE_RAD (3.14159265358979323846 / 360)

/* Taylor series of sine and cosine at a/8 (below 0.2), then three doublings of the angle. */
double portable_tan(double a)
{
    double x = a / 8, z = x * x, s = 1, c = 1;
    for (int k = 8; k >= 1; k--) {
        s = 1 - s * z / ((2 * k) * (2 * k + 1));
        c = 1 - c * z / ((2 * k - 1) * (2 * k));
    }
    s *= x;
    for (int i = 0; i < 3; i++) {
        double s2 = 2 * s * c;
        c = c * c - s * s;
        s = s2;
    }
    return s / c;
}

/* A unit vector perpendicular to d. */
static struct vec3 across(struct vec3 d)
{
    return v3_unit(v3_cross(d, fabs(d.x) < 0.6 ? v3(1, 0, 0) : v3(0, 1, 0)));
}

struct camera camera_new(struct vec3 from, struct vec3 at, struct vec3 up, double angle_deg)
{
    struct vec3 forward = v3_unit(v3_sub(at, from));
    struct vec3 right = v3_cross(forward, v3_unit(up));
    right = v3_len(right) > 1e-12 ? v3_unit(right) : across(forward);
    double half = portable_tan(angle_deg * HALF_DEGREE_RAD);
    return (struct camera){.eye = from,
        .forward = forward,
        .right = v3_scale(right, half),
        .up = v3_scale(v3_cross(right, forward), half)};
}
