/* write: the scene as NFF, an entity a line, with the shortest numbers in single precision. */
#include "mesh/mesh_int.h"

#include <stdlib.h>
#include <string.h>

#define ROOM 65536
#define LINE_MAX_BYTES 512 /* of what one function below puts */

struct out {
    FILE *f;
    size_t n;
    char text[ROOM];
    const struct mesh *m;
    uint32_t material;  /* of the last `f` */
    struct vec3 colour; /* that its own was multiplied by */
    uint32_t colours;   /* of textures */
    uint8_t *seen;      /* a bit for each of them */
};

static void flush(struct out *o)
{
    fwrite(o->text, 1, o->n, o->f);
    o->n = 0;
}

static void put(struct out *o, const char *text)
{
    size_t n = strlen(text);
    memcpy(o->text + o->n, text, n);
    o->n += n;
}

static void put_real(struct out *o, double v)
{
    o->text[o->n++] = ' ';
    o->n += mesh_number(o->text + o->n, (float)v);
}

static void put_vec(struct out *o, struct vec3 v)
{
    put_real(o, v.x);
    put_real(o, v.y);
    put_real(o, v.z);
}

/* A place: single precision may be too little far from the origin. */
static void put_place(struct out *o, struct vec3 v)
{
    if (o->m->digits)
        o->n += (size_t)snprintf(o->text + o->n, 3 * MESH_NUMBER, " %.*g %.*g %.*g", o->m->digits,
            v.x, o->m->digits, v.y, o->m->digits, v.z);
    else put_vec(o, v);
}

static void put_int(struct out *o, const char *lead, uint32_t v)
{
    put(o, lead);
    o->n += (size_t)snprintf(o->text + o->n, 16, "%u", v);
}

static void put_view(struct out *o, const struct view *v)
{
    put(o, "v\nfrom");
    put_place(o, v->from);
    put(o, "\nat");
    put_place(o, v->at);
    put(o, "\nup");
    put_vec(o, v->up);
    put(o, "\nangle");
    put_real(o, v->angle_deg);
    put_int(o, "\nhither 0\nresolution ", v->res_x);
    put_int(o, " ", v->res_y);
    put(o, "\n");
}

static void put_light(struct out *o, const struct light *l)
{
    put(o, "l");
    put_place(o, l->pos);
    put_vec(o, v3(l->r, l->g, l->b));
    put(o, "\n");
}

static void put_material(struct out *o, const struct material *m)
{
    put(o, "f");
    put_vec(o, v3(m->r, m->g, m->b));
    put_real(o, m->kd);
    put_real(o, m->ks);
    put_real(o, m->shine);
    put_real(o, m->t);
    put_real(o, m->ior);
    put(o, "\n");
}

/* ---- faces ----------------------------------------------------------------------------------- */

static void put_corner(struct out *o, const struct mesh_face *face, uint32_t i)
{
    if (o->n > ROOM - LINE_MAX_BYTES) flush(o);
    put_place(o, face->v[i]);
    if (face->normals) put_vec(o, face->normals[i]);
}

/* True if all corners turn one way: of four corners, only a convex face is so. */
static bool is_convex(const struct mesh_face *f)
{
    for (uint32_t i = 0; i < f->n; i++) {
        struct vec3 b = f->v[(i + 1) % f->n];
        struct vec3 turn = v3_cross(v3_sub(b, f->v[i]), v3_sub(f->v[(i + 2) % f->n], b));
        if (!(v3_dot(turn, f->normal) > 0)) return false;
    }
    return true;
}

static void put_whole(struct out *o, const struct mesh_face *face)
{
    put_int(o, face->normals ? "pp " : "p ", face->n);
    for (uint32_t i = 0; i < face->n; i++) put_corner(o, face, i);
    put(o, "\n");
}

/* NFF's patch is a fan, which leaves a concave face: it is cut as a polygon would be. */
static void put_cut(struct out *o, const struct mesh_face *face)
{
    struct vec3 *v = xmalloc(face->n, sizeof *v);
    struct triangle *t = xmalloc(face->n, sizeof *t);
    memcpy(v, face->v, face->n * sizeof *v);
    struct scene s = {.vertices = v, .n_vertices = face->n};
    struct prim p = {.kind = PRIM_POLYGON, .poly = {0, face->n}};
    uint32_t n = scene_triangulate(&s, &p, t);
    for (uint32_t i = 0; i < n; i++) {
        put(o, "pp 3");
        for (int k = 0; k < 3; k++) put_corner(o, face, t[i].v[k]);
        put(o, "\n");
    }
    free(v);
    free(t);
}

static void count_colour(struct out *o, uint32_t i)
{
    o->colours += !(o->seen[i / 8] >> i % 8 & 1);
    o->seen[i / 8] |= (uint8_t)(1 << i % 8);
}

/* Writes the material of a face, if it is not that of the face before. */
static void put_material_of(struct out *o, const struct mesh_face *face)
{
    static const struct material plain = {.r = 1, .g = 1, .b = 1, .kd = 1, .ior = 1};
    const struct mesh_colour by = mesh_colour_of(o->m, face);
    const struct vec3 c = by.c, last = o->colour;
    if (by.texture) count_colour(o, by.texture - 1);
    if (face->material == o->material && c.x == last.x && c.y == last.y && c.z == last.z) return;
    const bool known = face->material < o->m->scene->mNumMaterials;
    struct material m = known ? o->m->materials[face->material] : plain;
    m.r *= c.x, m.g *= c.y, m.b *= c.z;
    if (known || by.is) put_material(o, &m);
    o->material = face->material;
    o->colour = c;
}

static void put_face(void *ctx, const struct mesh_face *face)
{
    struct out *o = ctx;
    if (o->n > ROOM - LINE_MAX_BYTES) flush(o);
    put_material_of(o, face);
    if (!face->normals || face->n == 3 || (face->n == 4 && is_convex(face))) put_whole(o, face);
    else put_cut(o, face);
}

uint32_t mesh_write(const struct mesh *m, FILE *f)
{
    struct out *o = xcalloc(1, sizeof *o);
    o->seen = xcalloc(MESH_TEXTURE_COLOURS / 8 + 1, 1);
    o->f = f, o->m = m, o->material = UINT32_MAX, o->colour = v3(1, 1, 1);
    put_view(o, &m->view);
    for (uint32_t i = 0; i < m->n_lights; i++) {
        put_light(o, &m->lights[i]);
        if (o->n > ROOM - LINE_MAX_BYTES) flush(o);
    }
    mesh_faces_each(m, NULL, put_face, o);
    flush(o);
    const uint32_t colours = o->colours;
    free(o->seen);
    free(o);
    return colours;
}
