/* mesh_int: what the files of mesh share. */
#ifndef STORMRING_MESH_INT_H
#define STORMRING_MESH_INT_H

#include "mesh/mesh.h"
#include "scene/scene.h"

#include <assimp/scene.h>

#define MESH_COORDINATE_MAX 1e12  /* leaves room for far lights within NFF's 1e18 */
#define MESH_CORNERS_MAX 1000000U /* of a face; NFF has no larger polygon */
#define MESH_FACES_MAX 100000000U
#define MESH_LIGHTS_MAX 1000U

enum mesh_loss_kind {
    LOSS_LIBRARIES,
    LOSS_TEXTURES,
    LOSS_EMISSION,
    LOSS_METAL,
    LOSS_COLOURS,
    LOSS_BONES,
    LOSS_MORPHS,
    LOSS_ANIMATIONS,
    LOSS_POINTS,
    LOSS_LINES,
    LOSS_CAMERAS,
    LOSS_BAD_CAMERAS,
    LOSS_PLACES,
    LOSS_SPOTS,
    LOSS_AREAS,
    LOSS_AMBIENTS,
    LOSS_BAD_LIGHTS,
    LOSS_BAD_FACES,
    LOSS_FLAT_FACES,
    LOSS_BAD_NORMALS,
    LOSSES
};

/* Maps a node's coordinates to the scene's: the upper three rows; the last one is 0 0 0 1. */
struct mesh_frame {
    double m[3][4];
};
static inline struct vec3 mesh_frame_point(const struct mesh_frame *f, struct vec3 p)
{
    const double(*m)[4] = f->m;
    return v3(m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
        m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
        m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]);
}
static inline struct vec3 mesh_frame_vector(const struct mesh_frame *f, struct vec3 v)
{
    const double(*m)[4] = f->m;
    return v3(m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
        m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
        m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z);
}
static inline struct vec3 mesh_vec(struct aiVector3D v)
{
    return v3((double)v.x, (double)v.y, (double)v.z);
}
/* True if the length has a direction: neither 0 nor infinite nor NaN. */
static inline bool mesh_is_length(double length) { return length > 1e-30 && length < 1e30; }
/* True if v is finite and within the bounds of coordinates. */
static inline bool mesh_is_place(struct vec3 v)
{
    return fabs(v.x) <= MESH_COORDINATE_MAX && fabs(v.y) <= MESH_COORDINATE_MAX &&
           fabs(v.z) <= MESH_COORDINATE_MAX;
}

/* A mesh at a node. */
struct mesh_part {
    const struct aiMesh *mesh;
    struct mesh_frame frame;
    struct vec3 turn[3]; /* rows of the inverse transpose times |determinant|: turns normals */
    bool mirrors;        /* the determinant is negative: corners would run the other way round */
};

/* Where a light or camera is: at the node with its name. */
struct mesh_place {
    struct mesh_frame frame;
    unsigned n; /* nodes that it may be at; frame is the first one's */
    bool bare;  /* they have no meshes */
};

struct mesh {
    const struct aiScene *scene;
    struct mesh_options o;
    struct mesh_part *parts;
    size_t n_parts;
    struct mesh_place *light_places, *camera_places; /* as many as the scene's */
    struct material *materials;                      /* likewise */
    struct vec3 lo, hi;                              /* bounds of the faces */
    struct view view;
    struct light *lights; /* own_colour is set */
    uint32_t n_lights;
    struct mesh_loss loss[LOSSES + 1];
    /* What only libassimp's log says: */
    unsigned lost_libraries; /* files of materials that are not there */
    bool lost_vertex;        /* a face names a vertex that is not there */
    bool lost_end;           /* the file ends too early */
};

/* Fills parts and frames from the tree of nodes. False with err if there are too many faces. */
bool mesh_parts_find(struct mesh *m, char err[ERR_BYTES]);

/* A face with an area, in the scene's coordinates. */
struct mesh_face {
    uint32_t n; /* 3 to MESH_CORNERS_MAX */
    const struct vec3 *v;
    const struct vec3 *normals; /* unit; NULL: the face is flat */
    struct vec3 normal;         /* unit, of its plane (Newell) */
    uint32_t material;
    bool coloured;      /* the corners have colours */
    struct vec3 colour; /* their mean, in steps of 1 / MESH_COLOUR_STEPS */
};
#define MESH_COLOUR_STEPS 31
/* Calls f with every usable face. Counts the others in loss, unless that is NULL. */
void mesh_faces_each(const struct mesh *m, struct mesh_loss *loss,
    void (*f)(void *ctx, const struct mesh_face *face), void *ctx);

/* UTF-8 text may begin with a byte order mark, which libassimp takes for part of the first word:
 * its length, 3 or 0. (mark.c) */
size_t mesh_bytes_marked(const unsigned char *data, size_t n);
bool mesh_file_marked(const char *path);
/* aiImportFile of a file with such a mark, which is passed over. */
const struct aiScene *mesh_import_unmarked(const char *path);

/* Fills the materials. */
void mesh_materials_find(struct mesh *m);
/* The file's view, or one that fits; the file's lights, or two. Bounds are known. */
void mesh_view_find(struct mesh *m);
void mesh_lights_find(struct mesh *m);
/* Names the losses, and counts those that the scene itself tells. */
void mesh_losses_find(struct mesh *m);
/* True if the file is glTF 2, whose lights have physical units. */
bool mesh_is_gltf(const struct mesh *m);
/* glTF 1, whose cameras libassimp turns backwards. */
bool mesh_is_gltf1(const struct mesh *m);

#endif
