/* plane_int: what the files of plane share. */
#ifndef STORMRING_PLANE_INT_H
#define STORMRING_PLANE_INT_H

#include "plane/plane.h"
#include "projection/projection.h"

/* Where a projection is not continuous, and so how the globe is cut open. */
enum plane_kind {
    PLANE_CONE,     /* at the meridian opposite to lon_0 */
    PLANE_CYLINDER, /* at any one meridian */
    PLANE_POINT,    /* at the point opposite to its centre */
    PLANE_NEAR,     /* somewhere far from the map */
    PLANE_DISC,     /* where a satellite sees its horizon */
    PLANE_ROTATED   /* the plane is the rotated sphere, as degrees */
};
/* A string of PROJ after all its words were checked. */
struct plane_words {
    struct buf text; /* for PROJ; ends with a byte 0 */
    enum plane_kind kind;
    bool polar, south, longlat; /* ups; a word of the same name; o_proj=longlat */
    double lon_0, lat_0;
    double height; /* of a satellite, in metres */
};
/* False with a message in err if a word is not known. The caller frees w->text anyway. */
bool plane_words(const char *proj, struct plane_words *w, char err[ERR_BYTES]);

struct plane {
    enum plane_kind kind;
    double metres; /* in the unit of x and y; of a rotated sphere 1 */
    struct plane_sheet sheet;
    double axis[3][3]; /* of the sheet's sphere: the last one goes to its pole */
    struct projection *projection;
};

#endif
