/* materials: what NFF can say of a material: colour, Kd, Ks, shine, T and index of refraction. */
#include "mesh/mesh_int.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <stdlib.h>
#include <string.h>

#define COLOUR_MAX 1e6
#define SHINE_MAX 1e9
#define IOR_MIN 1e-3
#define IOR_MAX 1e3

/* v within the bounds; `low` if it is no number. */
static double within(double v, double low, double high) { return fmin(fmax(v, low), high); }

static double real(const struct aiMaterial *m, const char *key, double fallback)
{
    ai_real v;
    unsigned n = 1;
    bool is = aiGetMaterialFloatArray(m, key, 0, 0, &v, &n) == aiReturn_SUCCESS && n == 1;
    return is && isfinite(v) ? (double)v : fallback;
}

/* False, and white, if the material has none. */
static bool colour(const struct aiMaterial *m, const char *key, struct vec3 *out)
{
    struct aiColor4D c;
    bool is = aiGetMaterialColor(m, key, 0, 0, &c) == aiReturn_SUCCESS;
    *out = v3(1, 1, 1);
    if (is)
        *out = v3(within((double)c.r, 0, COLOUR_MAX), within((double)c.g, 0, COLOUR_MAX),
            within((double)c.b, 0, COLOUR_MAX));
    return is;
}

/* True if the alpha of a glTF has this mode. Materials of other formats have none: otherwise. */
static bool has_alpha(const struct aiMaterial *m, const char *mode, bool otherwise)
{
    struct aiString s;
    const bool is = aiGetMaterialString(m, AI_MATKEY_GLTF_ALPHAMODE, &s) == aiReturn_SUCCESS;
    return is ? strcmp(s.data, mode) == 0 : otherwise;
}

/*
 * True if libassimp made the material up for faces without one. The name alone does not tell: STL
 * and others use it for the colours of the file, too. bare: the format has no materials, and those
 * that libassimp makes up have no name.
 */
static bool is_made_up(const struct aiMaterial *m, struct vec3 diffuse, bool bare)
{
    struct aiString name;
    const bool named = aiGetMaterialString(m, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS;
    return (bare || (named && strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0)) &&
           (float)diffuse.x == .6f && (float)diffuse.y == .6f && (float)diffuse.z == .6f;
}

/* KHR_materials_pbrSpecularGlossiness: there is no metal, and the opacity is that of the colour. */
static bool is_glossy(const struct aiMaterial *m)
{
    return real(m, "$mat.glossinessFactor", -1) >= 0;
}
static double opacity_of(const struct aiMaterial *m)
{
    struct aiColor4D c;
    const bool is =
        is_glossy(m) && aiGetMaterialColor(m, "$clr.diffuse", 0, 0, &c) == aiReturn_SUCCESS;
    return is ? (double)c.a : real(m, "$mat.opacity", 1);
}

/* illum 0 or 1 of an MTL, see mtl.c */
static bool is_matt(const struct mesh *m, const struct aiMaterial *from)
{
    int model = 0;
    unsigned n = 1;
    return mesh_is_read_by(m, "Wavefront") &&
           aiGetMaterialIntegerArray(from, "$mat.shadingm", 0, 0, &model, &n) == aiReturn_SUCCESS &&
           model == aiShadingMode_NoShading;
}

static struct material translate(const struct aiMaterial *m, bool bare)
{
    struct material out;
    struct vec3 c;
    colour(m, "$clr.diffuse", &c);
    if (is_made_up(m, c, bare)) c = v3(1, 1, 1);
    out.r = c.x, out.g = c.y, out.b = c.z;
    double opacity = has_alpha(m, "BLEND", true) ? within(opacity_of(m), 0, 1) : 1;
    double through = within(real(m, "$mat.transmission.factor", 0), 0, 1);
    out.kd = opacity * (1 - through);
    out.t = 1 - out.kd;
    out.shine = within(real(m, "$mat.shininess", 0), 0, SHINE_MAX);
    /* With shine 0 the highlight would be everywhere. */
    out.ks = 0;
    if (colour(m, "$clr.specular", &c) && out.shine > 0)
        out.ks = within((c.x + c.y + c.z) / 3 * real(m, "$mat.shinpercent", 1), 0, COLOUR_MAX);
    out.ior = within(real(m, "$mat.refracti", 1), 0, IOR_MAX);
    if (out.ior < IOR_MIN) out.ior = 1; /* 0 stands for a material that bends no light */
    return out;
}

/* KHR_materials_volume: light loses colours on its way through. */
static bool absorbs(const struct aiMaterial *m)
{
    struct vec3 c;
    return real(m, "$mat.volume.thicknessFactor", 0) > 0 &&
           real(m, "$mat.volume.attenuationDistance", 0) > 0 &&
           colour(m, "$mat.volume.attenuationColor", &c) && fmin(c.x, fmin(c.y, c.z)) < 1;
}

static bool has_texture(const struct aiMaterial *m)
{
    for (unsigned i = 0; i < m->mNumProperties; i++)
        if (strcmp(m->mProperties[i]->mKey.data, "$tex.file") == 0) return true;
    return false;
}

void mesh_material_textured(struct material *m)
{
    if ((float)m->r == .6F && (float)m->g == .6F && (float)m->b == .6F) m->r = m->g = m->b = 1;
}

bool *mesh_materials_used(const struct mesh *m)
{
    const unsigned n = m->scene->mNumMaterials;
    bool *used = xcalloc(n + 1, sizeof *used);
    for (size_t i = 0; i < m->n_parts; i++)
        if (m->parts[i].mesh->mMaterialIndex < n) used[m->parts[i].mesh->mMaterialIndex] = true;
    return used;
}

void mesh_materials_find(struct mesh *m)
{
    const struct aiScene *s = m->scene;
    bool *used = mesh_materials_used(m);
    const bool x3d = mesh_is_read_by(m, "Extensible 3D"); /* its shininess is from 0 to 1 */
    const bool off = mesh_is_read_by(m, "OFF");
    m->materials = xcalloc(s->mNumMaterials + 1, sizeof *m->materials);
    for (unsigned i = 0; i < s->mNumMaterials; i++) {
        const struct aiMaterial *from = s->mMaterials[i];
        struct vec3 glow;
        m->materials[i] = translate(from, off);
        if (is_matt(m, from)) m->materials[i].ks = 0;
        if (x3d) m->materials[i].shine = fmin(m->materials[i].shine * 128, SHINE_MAX);
        if (!used[i]) continue;
        m->loss[LOSS_TEXTURES].n += has_texture(from);
        m->loss[LOSS_EMISSION].n +=
            colour(from, "$clr.emissive", &glow) && glow.x + glow.y + glow.z > 0;
        m->loss[LOSS_HOLES].n += has_alpha(from, "MASK", false);
        m->loss[LOSS_GLASS].n += absorbs(from);
        m->loss[LOSS_METAL].n += !is_glossy(from) && real(from, "$mat.metallicFactor", 0) > 0;
    }
    free(used);
}
