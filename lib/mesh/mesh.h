/*
 * mesh: the meshes, materials, camera and lights of a file that libassimp reads, as an NFF scene.
 * What the page mesh2nff(1) says of mapping, limits and losses is done here.
 *
 * Call order: mesh_open, which reads and checks everything; mesh_take_textures if textures are to
 * become colours; then mesh_losses and mesh_write in any order; mesh_close.
 */
#ifndef STORMRING_MESH_H
#define STORMRING_MESH_H

#include "base/base.h"

struct mesh_options {
    uint32_t width, height; /* resolution of the view; 0: 512 rows, and the camera's aspect */
    bool z_up;              /* of a fitted view; otherwise y points up */
};

struct mesh;

/*
 * Reads path, or standard input if it is "-"; path must stay. Returns NULL with a message in err,
 * without the name of the file, if it cannot be read, is no such file, has no face with an area, or
 * is too large.
 */
struct mesh *mesh_open(const char *path, const struct mesh_options *o, char err[ERR_BYTES]);
void mesh_close(struct mesh *m);

/* Reads the pictures of base colours, whose colours the faces get. */
void mesh_take_textures(struct mesh *m);

/* Parts of the file that NFF cannot hold, or that are unusable. */
struct mesh_loss {
    const char *what, *outcome; /* "points", "left out" */
    uint64_t n;
};
/* All kinds, up to the first without `what`; n is 0 where nothing was lost. */
const struct mesh_loss *mesh_losses(const struct mesh *m);

/* How the scene's axes and unit differ from those that the file states; "": not. */
const char *mesh_turned(const struct mesh *m);

/* Writes the scene. Returns how many colours of textures it has. f's error flag reports lost
 * output. */
uint32_t mesh_write(const struct mesh *m, FILE *f);

/*
 * Writes the shortest decimal that reads back as v (to double, then to float), without a final
 * zero byte. Returns its length. v must be finite.
 */
#define MESH_NUMBER 32
size_t mesh_number(char text[MESH_NUMBER], float v);

#endif
