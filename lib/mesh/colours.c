/* colours: the one colour that NFF has for a face, of its corners' colours and its texture. */
#include "mesh/mesh_int.h"

#include <assimp/material.h>

#define CORNER_STEPS 31 /* of a component of corners' colours, in linear light */
#define TEXTURE_STEP 5U /* of a component of a texture's colours, in 255ths of sRGB */
#define SIDE_MAX 16     /* 256 samples of a triangle */

/* A component in steps; 1 if it is no number. */
static double stepped(double c)
{
    c = isnan(c) ? 1 : fmin(fmax(c, 0), 1);
    return rint(c * CORNER_STEPS) / CORNER_STEPS;
}

bool mesh_has_colours(const struct mesh *m, const struct aiMesh *mesh)
{
    bool is = mesh->mColors[0] && !m->bad_colours && !m->clear_colours;
    for (unsigned i = 0; m->clear_colours && mesh->mColors[0] && i < mesh->mNumVertices && !is; i++)
        is = mesh->mColors[0][i].a > 0;
    return is;
}

/* White, if the corner has none. */
static struct vec3 of_corner(const struct mesh *m, const struct aiColor4D *c)
{
    const bool is =
        !isnan(c->r) && !isnan(c->g) && !isnan(c->b) && !(m->clear_colours && !(c->a > 0));
    return is ? v3_scale(v3((double)c->r, (double)c->g, (double)c->b), m->colour_scale)
              : v3(1, 1, 1);
}

static struct vec3 of_corners(
    const struct mesh *m, const struct mesh_part *p, const struct aiFace *f)
{
    struct vec3 sum = v3(0, 0, 0);
    for (unsigned i = 0; i < f->mNumIndices; i++) {
        sum = v3_add(sum, of_corner(m, &p->mesh->mColors[0][f->mIndices[i]]));
    }
    sum = v3_scale(sum, 1. / f->mNumIndices);
    return v3(stepped(sum.x), stepped(sum.y), stepped(sum.z));
}

/* ---- textures -------------------------------------------------------------------------------- */

struct uv {
    double u[2];
};

static struct uv uv_of(const struct mesh_texture *t, const struct mesh_face *face, uint32_t i)
{
    const unsigned at = mesh_vertex(face->part, face->face, i);
    const struct aiVector3D *v = &face->part->mesh->mTextureCoords[t->set][at];
    return (struct uv){
        {(double)v->x * t->scale[0] + t->move[0], (double)v->y * t->scale[1] + t->move[1]}};
}

/* The texel of n along an axis. u is finite. */
static uint32_t texel(double u, enum aiTextureMapMode wrap, uint32_t n)
{
    if (wrap == aiTextureMapMode_Clamp || wrap == aiTextureMapMode_Decal) u = fmin(fmax(u, 0), 1);
    else if (wrap == aiTextureMapMode_Mirror) u = 1 - fabs(u - 2 * floor(u / 2) - 1);
    else u -= floor(u);
    const uint32_t at = (uint32_t)(u * n);
    return at < n ? at : n - 1;
}

struct sum {
    double rgb[3], alpha, weight;
};

static void sample(const struct mesh_texture *t, struct uv at, double weight, struct sum *s)
{
    const struct image *im = &t->picture->im;
    if (!(fabs(at.u[0]) < 1e9 && fabs(at.u[1]) < 1e9)) return;
    const uint32_t x = texel(at.u[0], t->wrap[0], im->w);
    const uint32_t y = im->h - 1 - texel(at.u[1], t->wrap[1], im->h); /* v runs upwards */
    const float *c = &im->rgba[4 * ((size_t)y * im->w + x)];
    for (int k = 0; k < 3; k++) s->rgb[k] += weight * (double)c[k];
    s->alpha += weight * (double)c[3];
    s->weight += weight;
}

static struct uv between(struct uv a, struct uv b, struct uv c, double s, double t)
{
    struct uv out;
    for (int k = 0; k < 2; k++) out.u[k] = a.u[k] + s * (b.u[k] - a.u[k]) + t * (c.u[k] - a.u[k]);
    return out;
}

/* Samples per side of a triangle: about two for each texel of the longest side. */
static int side_of(const struct image *im, struct uv a, struct uv b, struct uv c)
{
    const double w = im->w, h = im->h;
    double most = hypot((b.u[0] - a.u[0]) * w, (b.u[1] - a.u[1]) * h);
    most = fmax(most, hypot((c.u[0] - b.u[0]) * w, (c.u[1] - b.u[1]) * h));
    most = fmax(most, hypot((a.u[0] - c.u[0]) * w, (a.u[1] - c.u[1]) * h));
    return most < SIDE_MAX / 2. ? (int)fmax(1, ceil(2 * most)) : SIDE_MAX;
}

/* The centres of n x n equal triangles. */
static void sample_triangle(
    const struct mesh_texture *t, const struct uv c[3], double area, struct sum *s)
{
    const int n = side_of(&t->picture->im, c[0], c[1], c[2]);
    for (int i = 0; i < n; i++)
        for (int k = 0; i + k < n; k++) {
            const double weight = area / (n * n);
            sample(t, between(c[0], c[1], c[2], (i + 1. / 3) / n, (k + 1. / 3) / n), weight, s);
            if (i + k + 1 < n)
                sample(t, between(c[0], c[1], c[2], (i + 2. / 3) / n, (k + 2. / 3) / n), weight, s);
        }
}

/* The mean over the face, as a fan. Transparent texels do not count. */
static bool of_texture(const struct mesh_texture *t, const struct mesh_face *face, struct vec3 *out)
{
    struct sum s = {.weight = 0};
    struct uv c[3] = {uv_of(t, face, 0), {{0}}, uv_of(t, face, 1)};
    for (uint32_t i = 1; i + 1 < face->n; i++) {
        const struct vec3 *v = face->v;
        c[1] = c[2], c[2] = uv_of(t, face, i + 1);
        sample_triangle(t, c, v3_len(v3_cross(v3_sub(v[i], v[0]), v3_sub(v[i + 1], v[0]))), &s);
    }
    if (!(s.weight > 0)) return false;
    *out = v3(0, 0, 0);
    if (s.alpha > 0) *out = v3(s.rgb[0] / s.alpha, s.rgb[1] / s.alpha, s.rgb[2] / s.alpha);
    return true;
}

static uint32_t step_of(double linear)
{
    return (srgb_encode8((float)linear) + TEXTURE_STEP / 2) / TEXTURE_STEP;
}
static double value_of(uint32_t step)
{
    return (double)srgb_decode8((uint8_t)(step * TEXTURE_STEP));
}

/* ---- both ------------------------------------------------------------------------------------ */

struct mesh_colour mesh_colour_of(const struct mesh *m, const struct mesh_face *face)
{
    struct mesh_colour out = {.c = v3(1, 1, 1)};
    const struct aiMesh *mesh = face->part->mesh;
    const bool known = m->textures && face->material < m->scene->mNumMaterials;
    const struct mesh_texture *t = known ? &m->textures[face->material] : NULL;
    struct vec3 mean;
    if (face->part->coloured) out.is = true, out.c = of_corners(m, face->part, face->face);
    if (!t || !t->picture || !t->picture->im.rgba || !mesh->mTextureCoords[t->set]) return out;
    if (!of_texture(t, face, &mean)) return out;
    const uint32_t r = step_of(mean.x), g = step_of(mean.y), b = step_of(mean.z);
    out.is = true;
    out.c = v3(out.c.x * value_of(r), out.c.y * value_of(g), out.c.z * value_of(b));
    out.texture = 1 + (r * MESH_TEXTURE_STEPS + g) * MESH_TEXTURE_STEPS + b;
    return out;
}
