/*
 * spec: a rendering specification, which sets the camera, the light and the colour map of a picture
 * of a grid. No I/O but spec_load. stormring-spec(5) is the manual of the format.
 */
#ifndef STORMRING_SPEC_H
#define STORMRING_SPEC_H

#include "grid/grid.h"

struct spec_knot {
    double s, rgb[3], k; /* two of one s are a jump: the first holds below it, the second above */
};
struct spec_iso {
    double s, rgb[3], opacity; /* opacity 0 .. 1, of the sheet itself, whatever its slant */
};
#define SPEC_LIMIT .9999 /* of opacity, where none is given */
struct spec {
    double from[3], at[3], up[3], angle; /* as in NFF, in scaled space; angle in degrees */
    uint32_t w, h;                       /* resolution */
    bool lit;
    double light[3];      /* in scaled space */
    double attenuation;   /* a, per unit of scaled space */
    double scale[3];      /* of the grid's coordinates; not 0 */
    double opacity_limit; /* a ray ends when its alpha reaches it */
    bool backed;
    double background[3];   /* behind everything, where backed; else transparent */
    struct spec_knot *knot; /* ascending by s, none or two and more; outside of them k = 0 */
    size_t n_knots;
    struct spec_iso *iso; /* ascending by s, each s once */
    size_t n_isos;
};
/* 0, or -1 with text in err; `name` is for messages. The caller frees the specification. */
int spec_read(const char *name, const char *text, size_t n, struct spec *s, char err[ERR_BYTES]);
/* The same of a file; "-": standard input. */
int spec_load(const char *path, struct spec *s, char err[ERR_BYTES]);
void spec_free(struct spec *s);

#endif
