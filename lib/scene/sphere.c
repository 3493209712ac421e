/* sphere: what prim.h asks of a sphere. */
#include "scene/prim.h"

static bool read(struct reader *r)
{
    struct vec3 center;
    double radius;
    if (!reader_point(r, "sphere's centre", &center) ||
        !reader_real(r, "sphere's radius", -COORDINATE_MAX, COORDINATE_MAX, &radius))
        return false;
    if (fabs(radius) < LENGTH_MIN)
        return reader_fail(r, "sphere's radius is %g, expected at least %g", radius, LENGTH_MIN);
    struct prim *p = reader_add_prim(r, PRIM_SPHERE);
    p->sphere.center = center;
    p->sphere.radius = fabs(radius);
    return true;
}

void nff_put_sphere(struct nff_out *o, struct vec3 center, double radius)
{
    nff_put_vec(o, "s ", center);
    fprintf(o->f, " %.*g\n", o->digits, radius);
}

static void write(struct nff_out *o, const struct scene *s, const struct prim *p)
{
    (void)s;
    nff_put_sphere(o, p->sphere.center, p->sphere.radius);
}

static void bounds(const struct scene *s, const struct prim *p, struct vec3 *lo, struct vec3 *hi)
{
    double r = p->sphere.radius;
    (void)s;
    scene_include_about(lo, hi, p->sphere.center, v3(r, r, r));
}

/* The sphere's surface reaches in unless all of it is outside or it contains the whole pyramid. */
static bool reaches(const struct pyramid *y, const struct scene *s, const struct prim *p)
{
    struct vec3 c = v3_sub(p->sphere.center, y->eye);
    double radius = p->sphere.radius;
    (void)s;
    for (int k = 0; k < PYRAMID_PLANES; k++)
        if (v3_dot(y->normal[k], c) - y->offset[k] > radius) return false;
    for (int i = 0; i < 5; i++)
        if (v3_len(v3_sub(y->corner[i], c)) >= radius) return true;
    return false;
}

static void put_pov(struct pov *o, const struct prim *p)
{
    pov_point(o, "sphere { ", p->sphere.center);
    pov_real(o, ",", p->sphere.radius * o->scale);
    pov_material(o, p->material);
}

const struct prim_row scene_sphere = {
    .word = "s",
    .sample = "f .9 .2 .2 .5 .5 30 0 0\ns 0 0 .8 .8\n",
    .read = read,
    .write = write,
    .bounds = bounds,
    .reaches = reaches,
    .pov = put_pov,
};
