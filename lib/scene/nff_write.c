/*
 * nff_write: writes NFF in the layout of the SPD programs: one line per entity, and one line per
 * vertex of a polygon.
 */
#include "scene/scene.h"

/* Writes lead, then "a b c". */
static void put_vec(struct nff_out *o, const char *lead, struct vec3 v)
{
    int d = o->digits;
    fprintf(o->f, "%s%.*g %.*g %.*g", lead, d, v.x, d, v.y, d, v.z);
}

void nff_put_view(struct nff_out *o, const struct view *v)
{
    put_vec(o, "v\nfrom ", v->from);
    put_vec(o, "\nat ", v->at);
    put_vec(o, "\nup ", v->up);
    fprintf(o->f, "\nangle %.*g\nhither %.*g\nresolution %u %u\n", o->digits, v->angle_deg,
        o->digits, v->hither, v->res_x, v->res_y);
}

void nff_put_background(struct nff_out *o, double r, double g, double b)
{
    put_vec(o, "b ", v3(r, g, b));
    putc('\n', o->f);
}

void nff_put_light(struct nff_out *o, const struct light *l)
{
    put_vec(o, "l ", l->pos);
    if (l->own_colour) put_vec(o, " ", v3(l->r, l->g, l->b));
    putc('\n', o->f);
}

void nff_put_material(struct nff_out *o, const struct material *m)
{
    int d = o->digits;
    put_vec(o, "f ", v3(m->r, m->g, m->b));
    fprintf(
        o->f, " %.*g %.*g %.*g %.*g %.*g\n", d, m->kd, d, m->ks, d, m->shine, d, m->t, d, m->ior);
}

void nff_put_sphere(struct nff_out *o, struct vec3 center, double radius)
{
    put_vec(o, "s ", center);
    fprintf(o->f, " %.*g\n", o->digits, radius);
}

void nff_put_cone(
    struct nff_out *o, struct vec3 base, double base_radius, struct vec3 apex, double apex_radius)
{
    put_vec(o, "c ", base);
    fprintf(o->f, " %.*g", o->digits, base_radius);
    put_vec(o, " ", apex);
    fprintf(o->f, " %.*g\n", o->digits, apex_radius);
}

void nff_put_polygon(
    struct nff_out *o, uint32_t n, const struct vec3 *v, const struct vec3 *normals)
{
    fprintf(o->f, "%s %u\n", normals ? "pp" : "p", n);
    for (uint32_t i = 0; i < n; i++) {
        put_vec(o, "", v[i]);
        if (normals) put_vec(o, " ", normals[i]);
        putc('\n', o->f);
    }
}
