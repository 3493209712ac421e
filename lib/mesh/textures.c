/* textures: finds the pictures of base colours that materials have. */
#include "mesh/mesh_int.h"

#include <assimp/material.h>
#include <stdlib.h>
#include <string.h>

/* The number behind the star of a texture within the mesh, or that of the one with this name. */
static const struct aiTexture *embedded(const struct aiScene *s, const char *name)
{
    int64_t at;
    if (*name == '*' && parse_int(name + 1, 0, UINT32_MAX, &at))
        return at < s->mNumTextures ? s->mTextures[at] : NULL;
    for (unsigned i = 0; i < s->mNumTextures; i++)
        if (s->mTextures[i]->mFilename.length && strcmp(s->mTextures[i]->mFilename.data, name) == 0)
            return s->mTextures[i];
    return NULL;
}

/* The file beside the mesh, or at its absolute path. Programs of Windows write backslashes. */
static char *beside(const char *mesh, const char *name)
{
    const char *slash = *name == '/' ? NULL : strrchr(mesh, '/');
    const size_t lead = slash ? (size_t)(slash + 1 - mesh) : 0, n = lead + strlen(name) + 1;
    char *path = xmalloc(n, 1);
    snprintf(path, n, "%.*s%s", (int)lead, mesh, name);
    for (char *p = path + lead; *p; p++)
        if (*p == '\\') *p = '/';
    return path;
}

static bool read_file_there(const char *path, struct image *im, char err[IMAGE_ERR])
{
    char other[IMAGE_ERR];
    if (mesh_picture_read(path, im, err)) return true;
    char *there = mesh_neighbour(path);
    const bool ok = there && strcmp(there, path) != 0 && mesh_picture_read(there, im, other);
    free(there);
    return ok;
}

/* As the mesh names the file, or else its last component beside the mesh: absolute paths are those
 * of another machine. */
static bool read_named(const char *mesh, const char *name, struct image *im, char err[IMAGE_ERR])
{
    char *path = beside(mesh, name), other[IMAGE_ERR];
    bool ok = read_file_there(path, im, err);
    const char *slash = strrchr(path, '/');
    if (!ok && slash) {
        char *last = beside(mesh, slash + 1);
        ok = strcmp(last, path) != 0 && read_file_there(last, im, other);
        free(last);
    }
    free(path);
    return ok;
}

static bool read_picture(struct mesh *m, const char *name, struct image *im, char err[IMAGE_ERR])
{
    const struct aiTexture *within = embedded(m->scene, name);
    const bool ok =
        within ? mesh_picture_embedded(within, im, err) : read_named(m->path, name, im, err);
    const uint64_t px = ok ? (uint64_t)im->w * im->h : 0;
    if (px <= m->picture_room_px) {
        m->picture_room_px -= px;
        return ok;
    }
    image_free(im);
    snprintf(err, IMAGE_ERR, "no room for more pictures");
    return false;
}

/* The picture with this name, read once. The first fault is kept for the losses. */
static const struct mesh_picture *picture_of(struct mesh *m, const char *name)
{
    size_t i = 0;
    char err[IMAGE_ERR], shown[128];
    while (i < m->n_pictures && strcmp(m->pictures[i]->name, name) != 0) i++;
    if (i < m->n_pictures) return m->pictures[i];
    m->pictures = xgrown(m->pictures, m->n_pictures, sizeof(struct mesh_picture *));
    struct mesh_picture *p = m->pictures[m->n_pictures++] = xcalloc(1, sizeof *p);
    p->name = xstrdup(name);
    if (read_picture(m, name, &p->im, err)) return p;
    p->im = (struct image){0};
    struct mesh_loss *l = &m->loss[LOSS_PICTURES];
    text_shown(shown, sizeof shown, name);
    if (!l->n++) snprintf(m->first_lost, sizeof m->first_lost, "%s (%s: %s)", l->what, shown, err);
    return p;
}

/* Only moved and scaled pictures are placed right: libassimp's turns are about another point. */
static bool take_transform(
    const struct aiMaterial *from, enum aiTextureType type, struct mesh_texture *t)
{
    struct aiUVTransform by;
    t->scale[0] = t->scale[1] = 1;
    t->move[0] = t->move[1] = 0;
    if (aiGetMaterialUVTransform(from, "$tex.uvtrafo", type, 0, &by) != aiReturn_SUCCESS)
        return true;
    t->scale[0] = (double)by.mScaling.x, t->scale[1] = (double)by.mScaling.y;
    t->move[0] = (double)by.mTranslation.x, t->move[1] = (double)by.mTranslation.y;
    return by.mRotation == 0;
}

static void take(struct mesh *m, unsigned i, struct mesh_texture *t)
{
    const struct aiMaterial *from = m->scene->mMaterials[i];
    struct aiString name;
    enum aiTextureType type = aiTextureType_BASE_COLOR;
    enum aiTextureMapping mapping = aiTextureMapping_UV;
    if (!aiGetMaterialTextureCount(from, type)) type = aiTextureType_DIFFUSE;
    t->wrap[0] = t->wrap[1] = aiTextureMapMode_Wrap;
    if (aiGetMaterialTexture(from, type, 0, &name, &mapping, &t->set, NULL, NULL, t->wrap, NULL) !=
        aiReturn_SUCCESS)
        return;
    for (size_t k = 0; k < m->n_sets; k++)
        if (m->sets[k].material == i) t->set = m->sets[k].set;
    double by[4];
    const bool framed = mesh_is_read_by(m, "Wavefront") && mesh_mtl_frame(name.data, by);
    if (m->bad_coordinates || mapping != aiTextureMapping_UV || !take_transform(from, type, t) ||
        t->set >= AI_MAX_NUMBER_OF_TEXTURECOORDS)
        m->loss[LOSS_MAPPINGS].n++;
    else t->picture = picture_of(m, name.data);
    for (int k = 0; framed && k < 2; k++) t->scale[k] = by[k], t->move[k] = by[k + 2];
}

/* True if it has a texture that is not the base colour's first one. */
static bool has_others(const struct aiMaterial *from)
{
    for (unsigned i = 0; i < from->mNumProperties; i++) {
        const struct aiMaterialProperty *p = from->mProperties[i];
        if (strcmp(p->mKey.data, "$tex.file") != 0) continue;
        const bool base =
            p->mSemantic == aiTextureType_DIFFUSE || p->mSemantic == aiTextureType_BASE_COLOR;
        if (!base || p->mIndex) return true;
    }
    return false;
}

void mesh_take_textures(struct mesh *m)
{
    const struct aiScene *s = m->scene;
    bool *used = mesh_materials_used(m);
    m->textures = xcalloc(s->mNumMaterials + 1, sizeof *m->textures);
    m->loss[LOSS_TEXTURES].n = 0;
    for (unsigned i = 0; i < s->mNumMaterials; i++) {
        if (!used[i]) continue;
        struct mesh_texture *t = &m->textures[i];
        take(m, i, t);
        m->loss[LOSS_TEXTURES].n += has_others(s->mMaterials[i]);
        if (t->picture && t->picture->im.rgba) mesh_material_textured(&m->materials[i]);
    }
    if (m->loss[LOSS_PICTURES].n) m->loss[LOSS_PICTURES].what = m->first_lost;
    m->loss[LOSS_TEXTURES].what = "materials with textures besides the base colour's";
    free(used);
}

void mesh_textures_free(struct mesh *m)
{
    for (size_t i = 0; i < m->n_pictures; i++) {
        image_free(&m->pictures[i]->im);
        free(m->pictures[i]->name);
        free(m->pictures[i]);
    }
    free(m->pictures);
    free(m->textures);
}
