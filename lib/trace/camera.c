/*
 * camera: from pixels to eye rays. The angle spans the frame's top edge to its bottom edge,
 * pixels are square, x grows along direction x up, row 0 is on top.
 */
#include "trace/trace_int.h"

#define HALF_DEGREE_RAD (3.14159265358979323846 / 360)

/* Some unit vector across d. */
static struct vec3 across(struct vec3 d)
{
    struct vec3 axis = fabs(d.x) < 0.6 ? v3(1, 0, 0) : v3(0, 1, 0);
    return v3_unit(v3_cross(d, axis));
}

void camera_init(struct tracer *t)
{
    const struct view *v = &t->scene->view;
    struct vec3 forward = v3_unit(v3_sub(v->at, v->from));
    struct vec3 right = v3_cross(forward, v3_unit(v->up));
    /* Looking straight along `up` leaves the roll open: any will do, but always the same. */
    right = v3_len(right) > 1e-12 ? v3_unit(right) : across(forward);
    double tangent = trace_tan(v->angle_deg * HALF_DEGREE_RAD);
    t->camera.eye = v->from;
    t->camera.forward = forward;
    t->camera.right = v3_scale(right, tangent);
    t->camera.up = v3_scale(v3_cross(right, forward), tangent);
    t->camera.hither = v->hither;
    camera_frame(t, v->res_x, v->res_y);
}

void camera_frame(struct tracer *t, uint32_t w, uint32_t h)
{
    t->camera.w = w;
    t->camera.h = h;
}

void camera_ray(const struct tracer *t, double x, double y, struct ray *r)
{
    double sx = (2 * x - t->camera.w) / t->camera.h, sy = (t->camera.h - 2 * y) / t->camera.h;
    struct vec3 d = v3_mad(v3_mad(t->camera.forward, t->camera.right, sx), t->camera.up, sy);
    double len = v3_len(d);
    r->o = t->camera.eye;
    r->d = v3_scale(d, 1 / len);
    r->t_min = t->camera.hither * len; /* hither is a depth, along forward */
    r->t_max = HUGE_VAL;
    r->err = 0;
}
