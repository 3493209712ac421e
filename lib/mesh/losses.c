/* losses: what a file has and NFF cannot hold. */
#include "mesh/mesh_int.h"

#include <string.h>

static const struct mesh_loss names[LOSSES + 1] = {
    [LOSS_LIBRARIES] = {"files of materials that are not there", "their materials are grey", 0},
    [LOSS_MATERIALS] = {"names of materials that are in no file", "their faces are grey", 0},
    [LOSS_TEXTURES] = {"materials with textures", "written without them", 0},
    [LOSS_PICTURES] = {"pictures of textures that cannot be read",
        "their faces have the material's colour", 0},
    [LOSS_MAPPINGS] = {"materials with textures that are turned or not placed by coordinates "
                       "of floating point",
        "written without them", 0},
    [LOSS_EMISSION] = {"materials that emit light", "written without it", 0},
    [LOSS_METAL] = {"materials of metal", "written as if they were none", 0},
    [LOSS_HOLES] = {"materials whose alpha cuts holes", "written without holes", 0},
    [LOSS_GLASS] = {"materials whose inside absorbs light", "written as if it did not", 0},
    [LOSS_COLOURS] = {"meshes with colours at their vertices", "each face has their mean", 0},
    [LOSS_BRIGHT] = {"meshes with colours above 1 at their vertices", "written as 1", 0},
    [LOSS_ALPHA] = {"meshes whose colours at vertices have an alpha", "written as opaque", 0},
    [LOSS_UNREAD_COLOURS] = {"colours of a PLY's or OFF's faces, or in a PLY of other names than "
                             "red, green and blue or other types than uchar, ushort and float",
        "left out", 0},
    [LOSS_EXTENSIONS] = {"extensions of glTF that hide nodes or repeat meshes", "left out", 0},
    [LOSS_SCENES] = {"scenes of glTF besides the one that it shows", "left out", 0},
    [LOSS_BONES] = {"meshes with bones", "written as they rest", 0},
    [LOSS_MORPHS] = {"meshes with morph targets", "written as they rest", 0},
    [LOSS_ANIMATIONS] = {"animations", "left out", 0},
    [LOSS_BYTES] = {"bytes behind the facets of an STL", "left out", 0},
    [LOSS_CORNERS] = {"corners of facets of an STL behind the third", "left out", 0},
    [LOSS_POINTS] = {"points", "left out", 0},
    [LOSS_LINES] = {"lines", "left out", 0},
    [LOSS_SURFACES] = {"free-form curves and surfaces of an OBJ, and files that it calls",
        "left out", 0},
    [LOSS_CAMERAS] = {"cameras beyond the first", "left out", 0},
    [LOSS_BAD_CAMERAS] = {"cameras that are orthographic, of glTF 1 or X3D, or define no view",
        "left out", 0},
    [LOSS_PLACES] = {"cameras or lights whose node's name is not unique",
        "taken to be at the first one", 0},
    [LOSS_SPOTS] = {"spot lights", "written as point lights", 0},
    [LOSS_AREAS] = {"area lights", "written as point lights", 0},
    [LOSS_AMBIENTS] = {"lights without a place and direction", "left out", 0},
    [LOSS_BAD_LIGHTS] = {"lights with numbers that are not finite or too large", "left out", 0},
    [LOSS_BAD_FACES] =
        {"faces with coordinates that are not finite or beyond 1e12, with corners that "
         "are not there, or with over 1000000",
            "left out", 0},
    [LOSS_FLAT_FACES] = {"faces without area", "left out", 0},
    [LOSS_FAR] = {"meshes so far from their origin that libassimp's single precision may move "
                  "corners by 1/20000 of the extent or more",
        "written as they are read", 0},
    [LOSS_BAD_NORMALS] = {"faces with normals that are no direction", "written without them", 0},
};

bool mesh_is_gltf(const struct mesh *m) { return mesh_is_read_by(m, "glTF2"); }
bool mesh_is_gltf1(const struct mesh *m) { return mesh_is_read_by(m, "glTF "); }

/* libassimp leaves an alpha of 0 at all vertices whose colours have three components. */
static bool has_alpha(const struct aiMesh *mesh)
{
    const struct aiColor4D *of = mesh->mColors[0];
    bool clear = false, is = false;
    for (unsigned i = 0; of && i < mesh->mNumVertices; i++) clear |= of[i].a<1, is |= of[i].a> 0;
    return clear && is;
}

/* The largest component of colours; 0: there are none. */
static double brightest(const struct aiMesh *mesh, bool *whole)
{
    double most = 0;
    for (unsigned i = 0; mesh->mColors[0] && i < mesh->mNumVertices; i++) {
        const struct aiColor4D *c = &mesh->mColors[0][i];
        const double of[3] = {(double)c->r, (double)c->g, (double)c->b};
        for (int k = 0; k < 3; k++) {
            if (isnan(of[k])) continue;
            most = fmax(most, of[k]);
            *whole &= of[k] >= 0 && of[k] <= 255 && of[k] == floor(of[k]);
        }
    }
    return most;
}

/* Whole numbers of 0 to 255 with one above 1, where others have a share of 1. */
static void find_scale(struct mesh *m)
{
    bool whole = true;
    double most = 0;
    m->clear_colours = mesh_is_read_by(m, "Additive");
    m->colour_scale = 1;
    for (unsigned i = 0; i < m->scene->mNumMeshes; i++)
        most = fmax(most, brightest(m->scene->mMeshes[i], &whole));
    if (most > 1 && whole) m->colour_scale = 1 / 255.;
}

void mesh_losses_find(struct mesh *m)
{
    memcpy(m->loss, names, sizeof names);
    find_scale(m);
    m->loss[LOSS_LIBRARIES].n = m->lost_libraries;
    if (!m->lost_libraries) m->loss[LOSS_MATERIALS].n = m->lost_materials;
    m->loss[LOSS_UNREAD_COLOURS].n = m->lost_colours || m->bad_colours;
    m->loss[LOSS_EXTENSIONS].n = m->lost_extensions;
    m->loss[LOSS_CORNERS].n = m->lost_corners;
    m->loss[LOSS_LINES].n = (uint64_t)m->lost_edges;
    m->loss[LOSS_SURFACES].n = m->lost_surfaces;
    m->loss[LOSS_SCENES].n = m->lost_scenes;
    m->loss[LOSS_BYTES].n = m->lost_bytes;
    m->loss[LOSS_BONES].n = m->skins;
    m->loss[LOSS_ANIMATIONS].n = m->scene->mNumAnimations;
    for (unsigned i = 0; i < m->scene->mNumMeshes; i++) {
        const struct aiMesh *mesh = m->scene->mMeshes[i];
        bool whole;
        const bool coloured = mesh_has_colours(m, mesh);
        m->loss[LOSS_COLOURS].n += coloured;
        m->loss[LOSS_BRIGHT].n += coloured && brightest(mesh, &whole) * m->colour_scale > 1;
        m->loss[LOSS_ALPHA].n += has_alpha(mesh);
        m->loss[LOSS_BONES].n += mesh->mNumBones > 0;
        m->loss[LOSS_MORPHS].n += mesh->mNumAnimMeshes > 0;
    }
}
