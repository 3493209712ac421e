/*
 * spec: a rendering specification: the camera, the light and the colour map for a picture of a
 * grid. Only spec_load does I/O. stormring-spec(5) is the manual of the format.
 */
#ifndef STORMRING_SPEC_H
#define STORMRING_SPEC_H

#include "grid/grid.h"

struct spec_knot {
    /* Two knots at one s are a jump: the first holds below it, the second above. */
    double s, rgb[3], k;
};
struct spec_iso {
    double s, rgb[3], opacity; /* opacity 0 .. 1 of the sheet, independent of the viewing angle */
};
struct spec_slice {
    int axis;       /* 0 .. 2: the plane is across x, y or z */
    double at;      /* in the grid's coordinates */
    double opacity; /* 0 .. 1 */
};
struct spec_level {
    double z, s; /* at this height in the grid's coordinates, s is subtracted from the field */
};
#define SPEC_RESOLUTION_MAX 65535
#define SPEC_LIMIT .9999 /* default opacity limit */
struct spec {
    double from[3], at[3], up[3], angle; /* camera as in NFF, in scaled space; angle in degrees */
    uint32_t w, h;                       /* resolution */
    bool lit;
    double light[3];      /* in scaled space */
    double attenuation;   /* a, per unit length of scaled space */
    double scale[3];      /* factors of the grid's coordinates; not 0 */
    double opacity_limit; /* a ray ends when its alpha reaches this */
    bool backed;
    double background[3];   /* behind everything, if backed; otherwise transparent */
    struct spec_knot *knot; /* ascending by s; none, or at least two; k = 0 outside */
    size_t n_knots;
    struct spec_iso *iso; /* ascending by s, each s once */
    size_t n_isos;
    struct spec_slice *slice; /* ascending by axis and place, each once; only with a map */
    size_t n_slices;
    struct spec_knot *colour; /* of the second field, which gives all colours; k = 0 */
    size_t n_colours;
    struct spec_knot *ground; /* by the height of the ground; none: it is not seen; k = 0 */
    size_t n_grounds;
    bool flat; /* the ground is a plane, which its values colour; transparent beyond the knots */
    double flat_at, flat_opacity; /* in the grid's coordinates; 0 .. 1 */
    struct spec_level *profile; /* ascending by z; none: nothing is subtracted */
    size_t n_profile;
    bool clipped;
    double clip[3][2]; /* only this part is seen: from < to, in the grid's coordinates */
};
/*
 * Palettes: colours at equal steps of a place from 0 to 1, linear red, green and blue, with linear
 * light between them. stormring-spec(5) lists them with their authors.
 */
#define SPEC_PALETTE_POINTS 17
#define SPEC_PALETTES "batlow, grey, magma, vik or viridis" /* for messages */
#define SPEC_N_PALETTES 5
extern const char *const spec_palettes[SPEC_N_PALETTES];
/* The palette with this name of n characters. False if there is none. */
bool spec_palette(const char *name, size_t n, double rgb[SPEC_PALETTE_POINTS][3]);
/* The colour at a place in [0, 1]. */
void spec_palette_at(const double rgb[SPEC_PALETTE_POINTS][3], double place, double out[3]);

/*
 * A specification for a first picture of a grid. With SPEC_AUTO it shows a field of both signs, and
 * one that is nearly the same everywhere at a height, as SPEC_ANOMALY, others as SPEC_FOG.
 */
enum spec_kind { SPEC_AUTO, SPEC_FOG, SPEC_SLICES, SPEC_SURFACES, SPEC_ANOMALY };
#define SPEC_KINDS "fog, slices, surfaces or anomaly" /* for messages */
/* The kind of this name. False if there is none. */
bool spec_kind(const char *name, enum spec_kind *kind);
struct spec_wish {
    enum spec_kind kind;
    const char *palette; /* NULL: as it is usual for the kind */
    uint32_t w, h;       /* resolution */
};
/* clang-format off */
#define SPEC_WISH_DEFAULT {SPEC_AUTO, NULL, 1200, 800}
/* clang-format on */
#define SPEC_STARTER_PALETTE "viridis" /* of most kinds */
/*
 * Appends it: a view that fits, a scale that makes a thin grid thick, and lines for the kind, at
 * quantiles of the values. Comments state units, quantiles and the vertical exaggeration. Returns
 * false with a message in err if all values are missing, or if it is a brick. If all are equal, the
 * map has one band around them.
 */
bool spec_starter(
    const struct grid *g, const struct spec_wish *wish, struct buf *out, char err[ERR_BYTES]);

/* The profile at height z: linear between its levels, constant beyond them. */
double spec_profile_at(const struct spec *s, double z);
/* The field that the specification shows: the values of the grid, less the profile. The caller
 * frees it. NULL without a profile: the values as they are. */
float *spec_deviation(const struct spec *s, const struct grid *g);

/* Parses n bytes of text. Returns 0, or -1 with the message in err; `name` is for messages. The
 * caller frees *s with spec_free. */
int spec_read(const char *name, const char *text, size_t n, struct spec *s, char err[ERR_BYTES]);
/* Reads a file; "-": standard input. */
int spec_load(const char *path, struct spec *s, char err[ERR_BYTES]);
void spec_free(struct spec *s);
/* Appends it as text, which spec_read reads with the same numbers. (write.c) */
void spec_write(const struct spec *s, struct buf *out);
/* The same in colours of this palette: those of the map, or of the second field, and those of the
 * ground. They have the places that they had in their palette, or else places by value. Surfaces
 * keep their colours. */
void spec_write_in(const struct spec *s, const char *palette, struct buf *out);

#endif
