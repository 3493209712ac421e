/*
 * view: from pixels to rays, as in NFF. The angle spans the frame's top edge to its bottom edge,
 * pixels are square, x grows along direction x up, row 0 is on top; a ray goes through the middle
 * of its pixel.
 */
#include "volume/volume_int.h"

#define HALF_DEGREE_RAD (3.14159265358979323846 / 360)

/* By the Taylor series of sine and cosine at a/8 (below 0.2), then three doublings of the angle:
 * a C library's own differs in the last bit from host to host. */
static double tangent(double a)
{
    double x = a / 8, z = x * x, s = 1, c = 1;
    for (int k = 8; k >= 1; k--) {
        s = 1 - s * z / ((2 * k) * (2 * k + 1));
        c = 1 - c * z / ((2 * k - 1) * (2 * k));
    }
    s *= x;
    for (int i = 0; i < 3; i++) {
        double twice = 2 * s * c;
        c = c * c - s * s;
        s = twice;
    }
    return s / c;
}

static struct vec3 vec(const double a[3]) { return v3(a[0], a[1], a[2]); }

/* Some unit vector across d. */
static struct vec3 across(struct vec3 d)
{
    return v3_unit(v3_cross(d, fabs(d.x) < 0.6 ? v3(1, 0, 0) : v3(0, 1, 0)));
}

void view_init(struct view *c, const struct spec *s)
{
    struct vec3 forward = v3_unit(v3_sub(vec(s->at), vec(s->from)));
    struct vec3 right = v3_cross(forward, v3_unit(vec(s->up)));
    /* Looking straight along `up` leaves the roll open: any will do, but always the same. */
    right = v3_len(right) > 1e-12 ? v3_unit(right) : across(forward);
    double half = tangent(s->angle * HALF_DEGREE_RAD);
    c->eye = vec(s->from);
    c->forward = forward;
    c->right = v3_scale(right, half);
    c->up = v3_scale(v3_cross(right, forward), half);
    c->w = s->w;
    c->h = s->h;
}

struct vec3 view_direction(const struct view *c, uint64_t p)
{
    double x = (double)(p % c->w) + 0.5, y = (double)(p / c->w) + 0.5;
    double sx = (2 * x - c->w) / c->h, sy = (c->h - 2 * y) / c->h;
    return v3_unit(v3_mad(v3_mad(c->forward, c->right, sx), c->up, sy));
}
