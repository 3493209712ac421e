/*
 * pov: writes a scene for POV-Ray 3.7. POV-Ray's documentation leaves much open, so each mapping
 * below was checked by rendering.
 *
 *   - The camera is given by location, direction, right and up: look_at and angle follow other
 *     conventions. Its aspect is the picture's own, for any size that povray renders.
 *   - POV-Ray scales diffuse light by 1 - transmit, but not highlights and reflection. `phong` is
 *     Phong's own model (`specular` is Blinn's).
 *   - The surface does not colour `transmit`, neither along a ray nor in its shadow; `filter`
 *     would be coloured.
 *   - All polygons of one material form one mesh: POV-Ray counts entering and leaving glass per
 *     object.
 *   - Each object has its own interior: a shared interior would join two glass objects into one.
 */
#include "scene/prim.h"

#include <stdlib.h>

/*
 * With transmit 1, POV-Ray's diffuse light would be 0 for any coefficient. Its colours are float.
 */
#define TRANSMIT_MAX (1 - 0x1p-20)

static void put_head(struct pov *o)
{
    const struct view *v = &o->s->view;
    fprintf(o->f,
        "// Render this file, scene.pov, to linear 16 bit with\n"
        "//   povray +Iscene.pov +Oscene.ppm +W%u +H%u File_Gamma=1 +FP16 -A -D\n"
        "#version 3.7;\n"
        "global_settings { assumed_gamma 1 max_trace_level 5 adc_bailout 0 }\n",
        v->res_x, v->res_y);
    struct vec3 dir = v3_unit(v3_sub(v->at, v->from));
    struct vec3 right = v3_unit(v3_cross(dir, v3_unit(v->up))), up = v3_cross(right, dir);
    double height = 2 * tan(v->angle_deg * (M_PI / 360));
    pov_point(o, "camera { perspective location ", v->from);
    pov_vec(o, " direction ", dir);
    pov_vec(o, "\n  up ", v3_scale(up, height));
    pov_vec(o, " right image_width/image_height*", v3_scale(right, height));
    const double *b = o->s->background;
    pov_vec(o, " }\nbackground { rgb ", v3(b[0], b[1], b[2]));
    fputs(" }\n", o->f);
    for (uint32_t i = 0; i < o->s->n_lights; i++) {
        const struct light *l = &o->s->lights[i];
        pov_point(o, "light_source { ", l->pos);
        pov_vec(o, " rgb ", v3(l->r, l->g, l->b));
        fputs(" }\n", o->f);
    }
}

static void put_texture(struct pov *o, uint32_t i)
{
    const struct material *m = &o->s->materials[i];
    double t = (double)(float)fmin(m->t, TRANSMIT_MAX);
    fprintf(o->f, "#declare M%u = texture { pigment { ", i);
    pov_vec(o, "rgb ", v3(m->r, m->g, m->b));
    if (m->t > 0) pov_real(o, " transmit ", t);
    fputs(" } finish { ambient 0", o->f);
    pov_real(o, " diffuse ", m->kd / (1 - t));
    if (m->ks > 0) {
        pov_real(o, " phong ", m->ks);
        pov_real(o, " phong_size ", m->shine);
        pov_real(o, " reflection ", m->ks);
    }
    fputs(" } }\n", o->f);
}

static void put_triangle(struct pov *o, const struct triangle *t, bool smooth)
{
    const char *lead = smooth ? "smooth_triangle { " : "triangle { ";
    for (int k = 0; k < 3; k++, lead = ",") {
        pov_point(o, lead, o->s->vertices[t->v[k]]);
        if (smooth) pov_vec(o, ",", o->s->normals[t->v[k]]);
    }
    fputs(" }\n", o->f);
}

/* Primitives grouped by material, in file order within a material. */
struct listed {
    uint32_t material, prim;
};

static int by_material(const void *a, const void *b)
{
    const struct listed *p = a, *q = b;
    if (p->material != q->material) return p->material < q->material ? -1 : 1;
    return (p->prim > q->prim) - (p->prim < q->prim);
}

static void put_meshes(struct pov *o, const struct listed *list, uint32_t n, uint32_t most)
{
    struct triangle *t = xmalloc(most, sizeof *t);
    bool open = false;
    for (uint32_t i = 0; i < n; i++) {
        const struct prim *p = &o->s->prims[list[i].prim];
        uint32_t triangles = scene_triangulate(o->s, p, t);
        if (triangles && !open) fputs("mesh {\n", o->f);
        if (triangles) open = true;
        for (uint32_t k = 0; k < triangles; k++) put_triangle(o, &t[k], p->kind == PRIM_PATCH);
        if (open && (i + 1 == n || list[i + 1].material != p->material)) {
            pov_material(o, p->material);
            open = false;
        }
    }
    free(t);
}

void pov_write(FILE *f, const struct scene *s, double scale)
{
    struct pov o = {f, s, scale};
    put_head(&o);
    for (uint32_t i = 0; i < s->n_materials; i++) put_texture(&o, i);

    struct listed *polygons = xmalloc(s->n_prims, sizeof *polygons);
    uint32_t n = 0, most = 0;
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *p = &s->prims[i];
        if (scene_prims[p->kind]->pov) {
            scene_prims[p->kind]->pov(&o, p);
            continue;
        }
        if (p->poly.count > most) most = p->poly.count;
        polygons[n++] = (struct listed){p->material, i};
    }
    qsort(polygons, n, sizeof *polygons, by_material);
    put_meshes(&o, polygons, n, most);
    free(polygons);
}

uint32_t pov_refused(const struct scene *s, double scale, uint32_t *which)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *p = &s->prims[i];
        const struct prim_row *row = scene_prims[p->kind];
        if (row->pov_takes && !row->pov_takes(p, scale) && n++ == 0) *which = i;
    }
    return n;
}
