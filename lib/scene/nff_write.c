/*
 * nff_write: writes NFF in the layout of the SPD programs: one line per entity, and one line per
 * vertex of a polygon.
 */
#include "scene/prim.h"

void nff_put_vec(struct nff_out *o, const char *lead, struct vec3 v)
{
    int d = o->digits;
    fprintf(o->f, "%s%.*g %.*g %.*g", lead, d, v.x, d, v.y, d, v.z);
}

void nff_put_view_words(struct nff_out *o, const struct view *v)
{
    nff_put_vec(o, "from ", v->from);
    nff_put_vec(o, "\nat ", v->at);
    nff_put_vec(o, "\nup ", v->up);
    fprintf(o->f, "\nangle %.*g\nhither %.*g\n", o->digits, v->angle_deg, o->digits, v->hither);
    if (v->res_x) fprintf(o->f, "resolution %u %u\n", v->res_x, v->res_y);
}

void nff_put_view(struct nff_out *o, const struct view *v)
{
    fputs("v\n", o->f);
    nff_put_view_words(o, v);
}

void nff_put_background(struct nff_out *o, double r, double g, double b)
{
    nff_put_vec(o, "b ", v3(r, g, b));
    putc('\n', o->f);
}

void nff_put_light(struct nff_out *o, const struct light *l)
{
    nff_put_vec(o, "l ", l->pos);
    if (l->own_colour) nff_put_vec(o, " ", v3(l->r, l->g, l->b));
    putc('\n', o->f);
}

void nff_put_material(struct nff_out *o, const struct material *m)
{
    int d = o->digits;
    nff_put_vec(o, "f ", v3(m->r, m->g, m->b));
    fprintf(
        o->f, " %.*g %.*g %.*g %.*g %.*g\n", d, m->kd, d, m->ks, d, m->shine, d, m->t, d, m->ior);
}
