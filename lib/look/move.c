/* Moves of a camera: how the view follows the pointer. */
#include "look/look.h"

/* Half the frame's height at distance 1. */
static double half(const struct look_camera *c) { return portable_tan(c->angle_deg * M_PI / 360); }

/* v turned by an angle round the unit vector (O. Rodrigues, 1840). */
static struct vec3 turned(struct vec3 v, struct vec3 axis, double angle)
{
    const double c = cos(angle), s = sin(angle);
    struct vec3 to = v3_mad(v3_scale(v, c), v3_cross(axis, v), s);
    return v3_mad(to, axis, v3_dot(axis, v) * (1 - c));
}

/* Unit vectors to the right and up in the picture. */
static void frame_of(const struct look_camera *c, struct vec3 *right, struct vec3 *up)
{
    const struct camera k = camera_new(c->from, c->at, c->up, c->angle_deg);
    *right = v3_unit(k.right);
    *up = v3_unit(k.up);
}

struct look_camera look_turn(struct look_camera c, double dx, double dy)
{
    struct vec3 right, up;
    const double way = hypot(dx, dy);
    if (!(way > 0)) return c;
    frame_of(&c, &right, &up);
    /* The axis is in the picture, across the way of the pointer. */
    const struct vec3 axis = v3_unit(v3_mad(v3_scale(up, dx / way), right, dy / way));
    const struct vec3 eye = turned(v3_sub(c.from, c.at), axis, -way * M_PI);
    c.from = v3_add(c.at, eye);
    c.up = v3_unit(turned(up, axis, -way * M_PI));
    return c;
}

/* Moves both by parts of the frame's height where `at` is. */
static struct look_camera shifted(struct look_camera c, double dx, double dy)
{
    struct vec3 right, up;
    frame_of(&c, &right, &up);
    const double height = 2 * half(&c) * v3_len(v3_sub(c.at, c.from));
    const struct vec3 by = v3_mad(v3_scale(right, dx * height), up, -dy * height);
    c.from = v3_add(c.from, by);
    c.at = v3_add(c.at, by);
    return c;
}

struct look_camera look_move(struct look_camera c, double dx, double dy)
{
    return shifted(c, -dx, -dy);
}

struct look_camera look_zoom(struct look_camera c, double times)
{
    c.from = v3_mad(c.at, v3_sub(c.from, c.at), times);
    return c;
}

struct look_camera look_centre(struct look_camera c, double dx, double dy)
{
    return shifted(c, dx, dy);
}
