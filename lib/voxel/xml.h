/* xml: what the files of a grid in VTK's XML have. Private to lib/voxel. */
#ifndef STORMRING_VOXEL_XML_H
#define STORMRING_VOXEL_XML_H

#include "voxel/voxel_int.h"

enum xml_where { XML_OUTSIDE, XML_POINTS, XML_CELLS, XML_AXES }; /* the element around an array */

/* A DataArray of a piece. */
struct xml_array {
    char name[GRID_NAME];
    enum xml_where where;
    size_t piece;
    struct voxel_type type; /* size 0: no numbers */
    uint64_t components, offset;
    bool appended, text;
    size_t begin, end; /* of its own text in the file */
    struct voxel_source source;
};

struct xml_piece {
    double extent[6]; /* the first and the last node on each axis */
    char *source;     /* the file that has it; NULL: the arrays of this one */
};

struct xml_grid {
    bool rectilinear;
    double extent[6], origin[3], spacing[3], direction[9];
    struct xml_piece *piece;
    struct xml_array *at;
    size_t n_pieces, n;
};

/* Makes the axes and arrays of v. */
bool voxel_take_xml(struct voxel *v, const struct xml_grid *g);

#endif
