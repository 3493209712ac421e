/* picture: pictures of textures, from files or from within the mesh. Private to lib/mesh. */
#ifndef STORMRING_MESH_PICTURE_H
#define STORMRING_MESH_PICTURE_H

#include "image/image.h"

#include <assimp/texture.h>

#define MESH_PICTURE_PX_MAX (UINT32_C(1) << 26)  /* of one as it is read */
#define MESH_PICTURE_SIDE 1024                   /* larger ones are reduced to at most this */
#define MESH_PICTURES_PX_MAX (UINT64_C(1) << 26) /* of all as they are kept */

/* Decodes PNG, JPEG, PNM or PFM, reduced to the size above. False with
 * "what, expected what". */
bool mesh_picture_decode(const unsigned char *p, size_t n, struct image *im, char err[IMAGE_ERR]);
bool mesh_picture_read(const char *path, struct image *im, char err[IMAGE_ERR]);
/* Of a texture within the mesh: a file in memory, or texels. */
bool mesh_picture_embedded(const struct aiTexture *t, struct image *im, char err[IMAGE_ERR]);
/* A JPEG in its full size, in linear light. (jpeg.c; none.c refuses all) */
bool mesh_jpeg_decode(const unsigned char *p, size_t n, struct image *im, char err[IMAGE_ERR]);

#endif
