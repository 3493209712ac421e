/* cone: what prim.h asks of a cone or cylinder. */
#include "scene/prim.h"

static bool read(struct reader *r)
{
    struct vec3 base, apex;
    double r0, r1;
    if (!reader_point(r, "cone's base", &base) ||
        !reader_real(r, "cone's base radius", -COORDINATE_MAX, COORDINATE_MAX, &r0) ||
        !reader_point(r, "cone's apex", &apex) ||
        !reader_real(r, "cone's apex radius", -COORDINATE_MAX, COORDINATE_MAX, &r1))
        return false;
    if ((r0 < 0 && r1 > 0) || (r0 > 0 && r1 < 0))
        return reader_fail(r, "cone's radii are %g and %g, expected one sign", r0, r1);
    if (fmax(fabs(r0), fabs(r1)) < LENGTH_MIN)
        return reader_fail(r, "cone's radii are both 0, expected one of at least %g", LENGTH_MIN);
    if (v3_len(v3_sub(apex, base)) < LENGTH_MIN)
        return reader_fail(r, "cone's base and apex are the same point, expected two");
    struct prim *p = reader_add_prim(r, PRIM_CONE);
    p->cone.base = base, p->cone.apex = apex;
    p->cone.base_radius = fabs(r0), p->cone.apex_radius = fabs(r1);
    return true;
}

void nff_put_cone(
    struct nff_out *o, struct vec3 base, double base_radius, struct vec3 apex, double apex_radius)
{
    nff_put_vec(o, "c ", base);
    fprintf(o->f, " %.*g", o->digits, base_radius);
    nff_put_vec(o, " ", apex);
    fprintf(o->f, " %.*g\n", o->digits, apex_radius);
}

static void write(struct nff_out *o, const struct scene *s, const struct prim *p)
{
    (void)s;
    nff_put_cone(o, p->cone.base, p->cone.base_radius, p->cone.apex, p->cone.apex_radius);
}

/*
 * A disc of radius r and unit normal a extends r times the sine of the angle between a and an axis,
 * along that axis.
 */
static struct vec3 disc_reach(struct vec3 a, double r)
{
    return v3(r * hypot(a.y, a.z), r * hypot(a.x, a.z), r * hypot(a.x, a.y));
}

static void bounds(const struct scene *s, const struct prim *p, struct vec3 *lo, struct vec3 *hi)
{
    struct vec3 axis = v3_unit(v3_sub(p->cone.apex, p->cone.base));
    (void)s;
    scene_include_about(lo, hi, p->cone.base, disc_reach(axis, p->cone.base_radius));
    scene_include_about(lo, hi, p->cone.apex, disc_reach(axis, p->cone.apex_radius));
}

/* Extent of a disc with unit normal `axis` along the unit vector n, from its center. */
static double disc_depth(struct vec3 n, struct vec3 axis, double radius)
{
    return radius * v3_len(v3_cross(n, axis));
}

static bool reaches(const struct pyramid *y, const struct scene *s, const struct prim *p)
{
    (void)s;
    struct vec3 base = v3_sub(p->cone.base, y->eye), apex = v3_sub(p->cone.apex, y->eye);
    struct vec3 axis = v3_unit(v3_sub(apex, base));
    for (int k = 0; k < PYRAMID_PLANES; k++) {
        struct vec3 n = y->normal[k];
        if (v3_dot(n, base) - disc_depth(n, axis, p->cone.base_radius) > y->offset[k] &&
            v3_dot(n, apex) - disc_depth(n, axis, p->cone.apex_radius) > y->offset[k])
            return false;
    }
    return true;
}

static void put_pov(struct pov *o, const struct prim *p)
{
    double r0 = p->cone.base_radius * o->scale, r1 = p->cone.apex_radius * o->scale;
    bool cylinder = p->cone.base_radius == p->cone.apex_radius;
    pov_point(o, cylinder ? "cylinder { " : "cone { ", p->cone.base);
    if (!cylinder) pov_real(o, ",", r0);
    pov_point(o, ",", p->cone.apex);
    pov_real(o, ",", r1);
    fputs(" open", o->f);
    pov_material(o, p->material);
}

static bool pov_takes(const struct prim *p, double scale)
{
    struct vec3 base = v3_scale(p->cone.base, scale), apex = v3_scale(p->cone.apex, scale);
    return v3_len(v3_sub(apex, base)) >= POV_CONE_MIN;
}

const struct prim_row scene_cone = {
    .word = "c",
    .sample = "f .3 .4 1 .9 .1 5 0 0\nc -1.4 .8 0 .5 -1.4 .8 1.2 .2\n",
    .read = read,
    .write = write,
    .bounds = bounds,
    .reaches = reaches,
    .pov = put_pov,
    .pov_takes = pov_takes,
};
