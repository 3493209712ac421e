/*
 * voxel: volumes of other programs as grids. It reads VTK's XML files of images and rectilinear
 * grids, also in pieces, VTK's legacy files of the same, NRRD, MetaImage and NIfTI-1. vol2vtk(1)
 * lists which parts.
 *
 * Call order: voxel_open, or voxel_read; then voxel_array and voxel_grid for any arrays; then
 * voxel_free. Files are untrusted: every size of a header is checked against the bytes that are
 * there, and no more is unpacked than the header announces. Values that are in a file of their own
 * must be in a regular file in the header's directory, or below it.
 */
#ifndef STORMRING_VOXEL_H
#define STORMRING_VOXEL_H

#include "base/base.h"
#include "grid/grid.h"

#define VOXEL_NODES_MAX (1U << 24) /* on an axis */

struct voxel;
/* Reads a file; "-": standard input. NULL with "file: what, expected what" in err. */
struct voxel *voxel_open(const char *path, char err[ERR_BYTES]);
/* The same for n bytes. directory: where a file of values may be; NULL: nowhere. `name` is for
 * messages, and must stay, as the bytes must. */
struct voxel *voxel_read(const char *name, const char *directory, const unsigned char *bytes,
    size_t n, char err[ERR_BYTES]);
void voxel_free(struct voxel *v);

struct voxel_about {
    const char *name;
    char type[16];       /* such as uint16 */
    uint32_t n[3];       /* values along x, y and z of the file, before axes are turned */
    uint64_t components; /* numbers of a value */
    bool cells;          /* values of cells, else of nodes */
};
/* The number of arrays, and what array i is. */
size_t voxel_arrays(const struct voxel *v);
struct voxel_about voxel_array(const struct voxel *v, size_t i);
/* The array with that name; arrays without a name are called "values". voxel_arrays(v): none. */
size_t voxel_find(const struct voxel *v, const char *name);

#define VOXEL_LENGTH UINT64_MAX /* instead of a component: the length of the vector */
/*
 * Makes a grid of an array. Values of cells become values at their centres. Axes of the file are
 * permuted and reversed so that x, y and z ascend. own: the axes of the file as they are, from 0,
 * whatever their directions in space. False with "file: what, expected what" in err.
 */
bool voxel_grid(const struct voxel *v, size_t array, uint64_t component, bool own, struct grid *g,
    char err[ERR_BYTES]);
/* Appends the title: names and units, see stormring-grid(5). unit: of the values; NULL: as in the
 * file. own: as above. */
void voxel_title(
    const struct voxel *v, const struct grid *g, const char *unit, bool own, struct buf *title);

#endif
