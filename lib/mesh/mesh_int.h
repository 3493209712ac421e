/* mesh_int: what the files of mesh share. */
#ifndef STORMRING_MESH_INT_H
#define STORMRING_MESH_INT_H

#include "mesh/mesh.h"
#include "mesh/picture.h"
#include "scene/scene.h"

#include <assimp/material.h>
#include <assimp/scene.h>

#define PI 3.14159265358979323846
#define MESH_COORDINATE_MAX 1e12  /* leaves room for far lights within NFF's 1e18 */
#define MESH_CORNERS_MAX 1000000U /* of a face; NFF has no larger polygon */
#define MESH_FACES_MAX 100000000U
#define MESH_LIGHTS_MAX 1000U

enum mesh_loss_kind {
    LOSS_LIBRARIES,
    LOSS_MATERIALS,
    LOSS_TEXTURES,
    LOSS_PICTURES,
    LOSS_MAPPINGS,
    LOSS_EMISSION,
    LOSS_METAL,
    LOSS_HOLES,
    LOSS_GLASS,
    LOSS_COLOURS,
    LOSS_BRIGHT,
    LOSS_ALPHA,
    LOSS_UNREAD_COLOURS,
    LOSS_EXTENSIONS,
    LOSS_SCENES,
    LOSS_BONES,
    LOSS_MORPHS,
    LOSS_ANIMATIONS,
    LOSS_BYTES,
    LOSS_CORNERS,
    LOSS_POINTS,
    LOSS_LINES,
    LOSS_SURFACES,
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
    LOSS_FAR,
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
static inline struct vec3 mesh_row(const struct mesh_frame *f, int i)
{
    return v3(f->m[i][0], f->m[i][1], f->m[i][2]);
}
static inline struct mesh_frame mesh_frame_of(const struct aiMatrix4x4 *b)
{
    return (struct mesh_frame){{{(double)b->a1, (double)b->a2, (double)b->a3, (double)b->a4},
        {(double)b->b1, (double)b->b2, (double)b->b3, (double)b->b4},
        {(double)b->c1, (double)b->c2, (double)b->c3, (double)b->c4}}};
}
static inline struct vec3 mesh_vec(struct aiVector3D v)
{
    return v3((double)v.x, (double)v.y, (double)v.z);
}
/* True if the length has a direction: neither 0 nor infinite nor NaN. */
static inline bool mesh_is_length(double length) { return length > 1e-30 && length < 1e30; }
/* True if single precision may move a point this far away by 1/20,000 of the extent or more. */
static inline bool mesh_is_far(double away, double extent)
{
    return away * 0x1p-24 > extent / 20000;
}
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
    bool coloured;       /* by mesh_has_colours */
};

/* Where a light or camera is: at the node with its name. */
struct mesh_place {
    struct mesh_frame frame;
    unsigned n; /* nodes that it may be at; frame is the first one's */
    bool bare;  /* they have no meshes */
};

/* A file or texture within the mesh. */
struct mesh_picture {
    char *name;
    struct image im; /* rgba is NULL if it cannot be read */
};
/* The base colour's picture of a material, and how corners' coordinates become places in it. */
struct mesh_texture {
    const struct mesh_picture *picture; /* NULL: none */
    unsigned set;                       /* of texture coordinates */
    enum aiTextureMapMode wrap[2];
    double scale[2], move[2];
};

/* Texture coordinates that KHR_texture_transform chooses for a material's base colour. */
struct mesh_set {
    uint32_t material, set;
};

/* Not of bytes; of bytes; and with what libassimp takes wrong. */
enum mesh_stl { MESH_STL_NONE, MESH_STL_BYTES, MESH_STL_ODD };

struct mesh {
    const struct aiScene *scene;
    const char *path; /* the caller's; pictures are looked for beside it */
    /* Of standard input or a pipe, while it is read, mended; the name tells libassimp its kind. */
    const unsigned char *bytes;
    size_t n_bytes;
    char name[8];
    struct mesh_options o;
    struct mesh_part *parts;
    size_t n_parts;
    struct mesh_place *light_places, *camera_places; /* as many as the scene's */
    struct material *materials;                      /* likewise */
    struct mesh_texture *textures;                   /* likewise; NULL: they are not asked for */
    struct mesh_picture **pictures;
    size_t n_pictures;
    uint64_t picture_room_px; /* for those that are not read yet */
    struct vec3 lo, hi;       /* bounds of the faces */
    double unit;              /* of the file, in the scene's; lights fade by distances in it */
    int digits;               /* of coordinates far from the origin; 0: single precision will do */
    struct view view;
    struct light *lights; /* own_colour is set */
    uint32_t n_lights;
    struct mesh_loss loss[LOSSES + 1];
    char turned[128];     /* what mesh_turned returns */
    char first_lost[512]; /* LOSS_PICTURES with the reason of the first */
    /* What only libassimp's log says: */
    unsigned lost_libraries; /* files of materials that are not there */
    unsigned lost_materials; /* materials that are in no such file */
    bool lost_vertex;        /* a face names a vertex that is not there */
    bool lost_end;           /* the file ends too early */
    unsigned lost_corners;   /* of facets of an STL, behind the third */
    /* What only the file says: */
    enum mesh_stl stl;
    uint64_t lost_bytes; /* of an STL, behind its facets */
    unsigned skins;      /* nodes of glTF that have one */
    struct mesh_set *sets;
    size_t n_sets;
    bool lost_colours;        /* of a PLY or OFF: it has some that are not read */
    bool bad_colours;         /* of a PLY: libassimp reads them wrong */
    bool clear_colours;       /* of an AMF: libassimp sets those that are not there to 0 */
    double colour_scale;      /* of corners' colours: 1, or 1/255 of an OBJ or PLY with bytes */
    bool bad_coordinates;     /* of textures of a glTF: integers, which libassimp reads wrong */
    unsigned lost_surfaces;   /* of an OBJ: free-form ones, and files that it calls */
    int64_t lost_edges;       /* of a PLY */
    const char *wrapping;     /* the kind of bytes that few readers take; NULL: none */
    unsigned lost_scenes;     /* of glTF, besides the one that is shown */
    unsigned viewpoints;      /* words of an X3D */
    unsigned lost_extensions; /* of glTF, without which places are others */
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
    const struct mesh_part *part;
    const struct aiFace *face;
};
/* The vertex of corner i. In a mirrored mesh the order is reversed behind the first corner, so that
 * it still runs counterclockwise about the side to which the normals point. */
static inline unsigned mesh_vertex(const struct mesh_part *p, const struct aiFace *f, unsigned i)
{
    return f->mIndices[p->mirrors && i > 0 ? f->mNumIndices - i : i];
}
/* Calls f with every usable face. Counts the others in loss, unless that is NULL. */
void mesh_faces_each(const struct mesh *m, struct mesh_loss *loss,
    void (*f)(void *ctx, const struct mesh_face *face), void *ctx);

/* UTF-8 text may begin with a byte order mark, which libassimp takes for part of the first word:
 * its length, 3 or 0. (mark.c) */
size_t mesh_bytes_marked(const unsigned char *data, size_t n);
/* Has an OFF faces with a colour? */
bool mesh_off_paints(FILE *f);
/* Finds in an STL what m->stl says. Copies one that is odd in a way that libassimp reads. */
void mesh_stl_find(struct mesh *m, FILE *f);
void mesh_stl_copy(FILE *from, FILE *to);
/* Finds skins, sets and lost extensions of a glTF. Sets unread to a required extension that is not
 * read, or "". Copies a glTF without its skins. */
void mesh_gltf_read(struct mesh *m, FILE *f, char unread[ERR_WORD]);
void mesh_gltf_copy(FILE *from, FILE *to);
#define MESH_LEAD 160 /* bytes of what stands in the place of others */
/* Of a line of an MTL, whose word of n bytes begins at `at`, that libassimp takes wrong: fills lead
 * with what stands in the place of the first bytes, and returns their number; 0: of no other. */
size_t mesh_mtl_line(const char *line, size_t at, size_t n, char lead[MESH_LEAD]);
/* Takes scale and move of a picture out of its name. False: there are none. */
bool mesh_mtl_frame(char *name, double by[4]);
/* A copy of *n bytes with parts mended that libassimp reads wrong, which the caller frees; NULL:
 * there are none. mark.c says which. */
char *mesh_bytes_mended(const struct mesh *m, const unsigned char *data, size_t *n);
/* aiImportFile, of the bytes if there are some. It passes over such a mark and mends such parts,
 * also of the files that this one names. Those may be there in another case. */
const struct aiScene *mesh_import(const struct mesh *m);
/* A file that is there, and whose name differs in case at most, or has a byte where this one has
 * %XX; NULL: none. The caller frees it. */
char *mesh_neighbour(const char *path);

/* What the colour of a face's material is multiplied by. */
struct mesh_colour {
    bool is; /* the corners have colours, or the material a texture that is taken */
    struct vec3 c;
    uint32_t texture; /* 0: it has none; otherwise tells one colour of textures from another */
};
#define MESH_TEXTURE_STEPS 52 /* of a component */
#define MESH_TEXTURE_COLOURS (MESH_TEXTURE_STEPS * MESH_TEXTURE_STEPS * MESH_TEXTURE_STEPS)
bool mesh_has_colours(const struct mesh *m, const struct aiMesh *mesh);
struct mesh_colour mesh_colour_of(const struct mesh *m, const struct mesh_face *face);
void mesh_textures_free(struct mesh *m);

/* Counts meshes that libassimp cannot hold well, and chooses digits. Bounds are known. */
void mesh_find_far(struct mesh *m);
/* Fills the materials. */
void mesh_materials_find(struct mesh *m);
/* True of each that a part has; the caller frees. */
bool *mesh_materials_used(const struct mesh *m);
/* White, if the material has a picture and its own colour was made up by libassimp. */
void mesh_material_textured(struct material *m);
/* The file's view, or one that fits; the file's lights, or two. Bounds are known. */
void mesh_view_find(struct mesh *m);
void mesh_lights_find(struct mesh *m);
/* Names the losses, and counts those that the scene itself tells. */
void mesh_losses_find(struct mesh *m);
/* The frame of the root's parent, from the axes and unit that the file states; fills turned. */
struct mesh_frame mesh_axes(struct mesh *m);
/* True if the name of libassimp's reader begins with this. */
bool mesh_is_read_by(const struct mesh *m, const char *name);
/* True if Blender wrote an FBX or Collada: lamps are in watts, suns in watts per square metre. */
bool mesh_is_in_watts(const struct mesh *m);
/* True if the file is glTF 2, whose lights have physical units. */
bool mesh_is_gltf(const struct mesh *m);
/* glTF 1, whose cameras libassimp turns backwards. */
bool mesh_is_gltf1(const struct mesh *m);

#endif
