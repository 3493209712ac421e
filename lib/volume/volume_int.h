/*
 * volume_int: declarations that the renderer's files share. A ray traverses the grid (walk.c). The
 * field along it in one cell is a cubic of w, 0 .. 1 from entry to exit (cell.c, cubic.c). The
 * cubic is cut at sheets and at knots of the map (piece.c) and integrated (integrate.c, lit.c).
 * The default method renders many rays at once in float (stream.h).
 */
#ifndef STORMRING_VOLUME_INT_H
#define STORMRING_VOLUME_INT_H

#include "geometry/geometry.h"
#include "volume/volume.h"

#include <string.h>

#define BLOCK_SHIFT 2
#define BLOCK (1 << BLOCK_SHIFT) /* cells per edge of a block; skipped as a whole */
#define GAUSS_MAX VOLUME_NODES_MAX

/* ---- the map (map.c) ------------------------------------------------------------------------ */

/* A linear part between two knots: k = k0 + k1 (s - lo), rgb likewise. */
struct map_span {
    double lo, hi, k0, k1, rgb0[3], rgb1[3];
    double slope;     /* the largest |rgb1| */
    bool transparent; /* k = 0 throughout */
};
struct map {
    struct map_span *span; /* ascending, contiguous, none of width 0 */
    uint32_t n;
    bool closed; /* the last span includes its upper end */
};

void map_init(struct map *m, const struct spec_knot *knot, size_t n);
/* The same for colours alone: those of the ends hold beyond them too. Without knots it is empty. */
void map_init_colours(struct map *m, const struct spec_knot *knot, size_t n);
/* The colour of a value in this span. */
void map_colour(const struct map_span *p, double s, double rgb[3]);
/* Index of the span that contains s; -1 outside the map. */
int map_find(const struct map *m, double s);

/* ---- exp ------------------------------------------------------------------------------------- */

/*
 * exp(x) for x <= 0, from sums and products of doubles only. A C library's exp differs in the last
 * bit between hosts, because the library picks FMA variants at run time.
 */
static inline double volume_exp(double x)
{
    static const double log2_e = 1.4426950408889634074;
    static const double ln2_high = 0.693147180369123816490; /* 33 bits: n times this is exact */
    static const double ln2_low = 1.90821492927058770002e-10;
    static const double round = 0x1.8p52; /* adding this puts n into the last bits of the sum */
    double sum = x * log2_e + round, n = sum - round, scale;
    double f = (x - n * ln2_high) - n * ln2_low, f2 = f * f, f4 = f2 * f2; /* |f| <= ln 2 / 2 */
    double q =
        (1.0 / 2 + 1.0 / 6 * f) + (1.0 / 24 + 1.0 / 120 * f) * f2 +
        ((1.0 / 720 + 1.0 / 5040 * f) + (1.0 / 40320 + 1.0 / 362880 * f) * f2) * f4 +
        ((1.0 / 3628800 + 1.0 / 39916800 * f) + (1.0 / 479001600 + 1.0 / 6227020800 * f) * f2) *
            (f4 * f4);
    uint64_t bits;
    if (!(x > -700)) return 0;
    memcpy(&bits, &sum, sizeof bits);
    bits = (bits + 1023) << 52;
    memcpy(&scale, &bits, sizeof scale);
    return (1 + (f + f2 * q)) * scale;
}

/* ---- cubics (cubic.c) ----------------------------------------------------------------------- */

/* p[0] + p[1] w + p[2] w^2 + p[3] w^3 */
static inline double cubic_at(const double p[4], double w)
{
    return p[0] + w * (p[1] + w * (p[2] + w * p[3]));
}
/* q(w) = p(a + (b - a) w) */
void cubic_part(const double p[4], double a, double b, double q[4]);
/* Bounds of p on 0 .. 1, from its control points. */
void cubic_bounds(const double p[4], double *lo, double *hi);
/* The ends and turning points of p on 0 .. 1, ascending: 2 to 4 numbers. Returns their count. */
int cubic_monotone(const double p[4], double w[4]);
/* The root of p(w) = y in a .. b. p must be monotone there and y between its end values. */
double cubic_root(const double p[4], double a, double b, double y);

/* ---- the ground (ground.c) ------------------------------------------------------------------ */

struct ground;
/* Where a ray meets the ground: distance from the eye; colour, with light and attenuation, times
 * opacity; the part of the light from behind the picture that passes. */
struct meeting {
    bool is;
    double t, rgb[3], through;
};
/* Keeps pointers to `of`, the ground of a grid. Never NULL. */
struct ground *ground_new(const struct grid *of, const struct spec *s);
void ground_free(struct ground *g);
struct meeting ground_meet(const struct ground *g, const struct spec *s, struct vec3 dir);

/* ---- the grid, prepared (skip.c, volume.c) -------------------------------------------------- */

/* A ray crosses an iso-surface or a slice at w of a cell. */
struct crossing {
    double w;
    const struct spec_iso *iso; /* NULL: a slice of this opacity */
    double opacity;
};

/* A slice in scaled space. */
struct slice {
    int axis;
    double at, opacity;
};

/* Gauss-Legendre nodes and weights for 0 .. 1. */
struct rule {
    int m;
    double node[GAUSS_MAX], weight[GAUSS_MAX];
};

struct volume {
    const struct spec *spec;
    struct volume_options o;
    double *plane[3];    /* scaled coordinates, ascending; BLOCK infinite entries on either side */
    double *inv_edge[3]; /* 1 / edge length of the cell above each plane except the last */
    uint32_t cells[3];   /* planes minus one */
    bool brick;          /* part of a larger grid; otherwise all cells are its own */
    double whole[3][2];  /* scaled bounds of the larger grid */
    uint32_t own[3][2];  /* its own cells: from, to; others are the layer of overlap */
    bool narrowed;       /* rays are seen only between these bounds, of a brick or a clip box */
    double inside[3][2];
    struct slice *slice; /* those of the specification, in its order */
    size_t n_slices;
    bool *sliced[3];      /* per layer of cells: it touches a slice across this axis */
    ptrdiff_t stride[3];  /* from a node to the next, in values; negative if the scale is */
    const float *first;   /* node at the lowest corner */
    const float *value;   /* first node in memory */
    const float *second;  /* `first` of the field whose colours are seen; NULL: colours are s's */
    ptrdiff_t row, layer; /* distance in nodes */
    ptrdiff_t origin;     /* index of the cell at the lowest corner: its first node in memory */
    uint8_t *live;        /* one bit per cell, by its first node in memory: the cell is visible */
    uint8_t *block;       /* one byte per block: some cell of it is live */
    uint32_t blocks[3];
    double range;          /* largest range of values within a live cell */
    struct ground *ground; /* NULL: none is seen */
    struct map map, tint;  /* tint: colours of the second field */
    struct camera camera;
    struct rule rule;          /* of the method; with a light: for straight pieces */
    struct rule bent;          /* with a light: for other pieces */
    struct rule mixed;         /* with a second field: for all pieces */
    double bright;             /* the largest colour component of the map */
    struct crossing *crossing; /* crossings of one cell */
    bool *above;               /* per surface: the ray is at or above its value */
    bool *side;                /* the room of `above` for one ray at a time */
    struct stream *stream;     /* renders many rays at once; else NULL */
    struct volume_counts counts;
};

/* The values of the grid, less the profile. Give them back when they are not used any more.
 * (deviation.c) */
const float *volume_deviation(const struct grid *g, const struct spec *s);
void volume_deviation_free(const float *value);
void skip_init(struct volume *v);
static inline size_t cell_index(const struct volume *v, const int32_t i[3])
{
    return (size_t)(v->origin + i[0] * v->stride[0] + i[1] * v->stride[1] + i[2] * v->stride[2]);
}
static inline void cell_of_index(const struct volume *v, int64_t at, int32_t i[3])
{
    const ptrdiff_t part[3] = {at % v->row, at % v->layer / v->row, at / v->layer};
    for (int a = 0; a < 3; a++)
        i[a] = (int32_t)(v->stride[a] < 0 ? (ptrdiff_t)v->cells[a] - 1 - part[a] : part[a]);
}
/* False for cells of the overlap. */
static inline bool volume_owns(const struct volume *v, const int32_t i[3])
{
    bool own = true;
    for (int a = 0; a < 3; a++)
        own &= (uint32_t)i[a] >= v->own[a][0] && (uint32_t)i[a] < v->own[a][1];
    return own;
}
/* True if the cell touches a slice. */
static inline bool volume_is_sliced(const struct volume *v, const int32_t i[3])
{
    return v->sliced[0][i[0]] || v->sliced[1][i[1]] || v->sliced[2][i[2]];
}
/* True if rays meet surfaces or slices: then each needs the layer before a brick's own cells. */
static inline bool volume_has_sheets(const struct volume *v)
{
    return v->spec->n_isos + v->n_slices > 0;
}
static inline size_t block_index(const struct volume *v, const int32_t i[3])
{
    size_t x = (size_t)i[0] >> BLOCK_SHIFT, y = (size_t)i[1] >> BLOCK_SHIFT;
    return (((size_t)i[2] >> BLOCK_SHIFT) * v->blocks[1] + y) * v->blocks[0] + x;
}

/* ---- the walk (walk.c) ---------------------------------------------------------------------- */

/* Smaller slopes do not move a ray within any grid; their reciprocals would overflow. */
#define WALK_LEVEL 1e-200

/* The current position of a ray. */
struct front {
    double t;               /* distance from o */
    double next[3];         /* t of the next plane on each axis */
    const double *plane[3]; /* those planes */
    size_t cell;
    uint32_t passed; /* number of cells passed */
};
struct walk {
    const struct volume *v;
    struct front front;
    double o[3], d[3], inv[3]; /* o: the ray's entry into the grid, or the eye if it is inside */
    double before, exit;       /* distance from the eye to o; t at the exit from the grid */
    ptrdiff_t step[3];         /* -1, 0 or 1 */
    ptrdiff_t to_cell[3];      /* change of the cell index per step */
    double start[3];           /* o; -infinity along an axis whose step is 0 */
    const double *zero[3];     /* the next plane of cell 0 */
};
/* Direction through the middle of pixel p. */
static inline struct vec3 volume_direction(const struct volume *v, uint64_t p)
{
    const struct camera *c = &v->camera;
    return v3_unit(camera_direction(c, (double)(p % c->w) + 0.5, (double)(p / c->w) + 0.5));
}
/* False if the ray misses the grid. */
bool walk_begin(struct walk *w, const struct volume *v, struct vec3 eye, struct vec3 dir);
/* A cell and the ray's segment in it. */
struct segment {
    double t0, t1;
    int32_t i[3];
};
/* Finds the next live cell. False at the end of the grid. */
bool walk_cell(struct walk *w, struct segment *s);

/* ---- one cell (cell.c) ---------------------------------------------------------------------- */

struct cell {
    double base;              /* the field at its lowest corner */
    double p[4];              /* the field along the ray, minus base */
    double edge[3];           /* edge lengths */
    double f[7];              /* the field minus base: coefficients of x, y, z, xy, xz, yz, xyz */
    double from[3], delta[3]; /* local coordinates at entry; their change until exit */
    double t, len;            /* distance of the entry from the eye; length of the segment */
};
/* Sets c->t relative to o. The caller adds the distance from the eye to o. */
void cell_init(struct cell *c, const struct volume *v, const double o[3], const double d[3],
    const struct segment *s);
/* The second field in the same cell, i, along the same segment. */
void cell_second(struct cell *c, const struct cell *of, const struct volume *v, const int32_t i[3]);
/* The gradient at w, in scaled space. */
struct vec3 cell_gradient(const struct cell *c, double w);

/* ---- integration (integrate.c, path.c, surface.c) ------------------------------------------- */

/* The colour that a ray has accumulated. */
struct path {
    struct volume *v;
    double rgb[3], transmittance; /* exp(-tau) so far */
    struct cell *cell;
    struct vec3 dir;
    struct cell *second; /* NULL: there is no second field */
};
/* The part of a cell's segment within one span. q is the cubic minus the span's lo, with w 0 .. 1
 * in the piece. */
struct piece {
    const struct map_span *span;
    double q[4], a, b;           /* a, b: the piece's ends in the cell's w */
    const struct map_span *tint; /* the same of the second field; NULL: colours are of `span` */
    double of_tint[4];
};
typedef void piece_fn(struct path *, const struct piece *);

/*
 * The adaptive method uses Gauss rules on pieces of at most this optical depth and this bend. The
 * bend is |q[2]| + |q[3]| relative to the range of the field on the piece. A rule of 3, 4, 5, 6 and
 * 7 nodes then has an error of at most 3.5e-3, 1.7e-4, 6.6e-6, 2.1e-7 and 6e-9 of the colour's
 * range, by a search for the worst such piece. (Over all cubics, 3 nodes may be wrong by a fifth of
 * it, however thin the piece is: k c is of degree 6.)
 */
#define DEPTH_MAX 1.0
#define BEND_MAX 0.5
/*
 * Error bound for a piece of optical depth D whose colour c, of range R, is replaced by its
 * k-weighted mean: at most alpha R D / 8, for every c. In u = tau, 0 .. D, the error is D |cov(c,
 * g)| with g = exp(-u), so at most D R E(g - Eg)+ (as in G. Gruess, Math. Zeitschrift 39, 1935;
 * here g is known). With a = D / 2, E(g - Eg)+ is alpha times
 *
 *     (a coth a - 1 + ln(sinh a / a)) / (4 a^2) <= (a^2 / 3 + a^2 / 6) / (4 a^2) = 1/8
 *
 * since a coth a is 1 plus the sum, and sinh a / a the product, over n = 1, 2, ... of 2 a^2 / (a^2
 * + n^2 pi^2) and 1 + a^2 / (n^2 pi^2).
 */
#define COVARIANCE (1.0 / 8)

void volume_gauss_rule(struct rule *r, int m);
/* The optical depth of a piece from its start to x. */
static inline double volume_depth_to(const struct path *p, const struct piece *s, double x)
{
    const double *q = s->q;
    double mean = q[0] + x * (q[1] / 2 + x * (q[2] / 3 + x * q[3] / 4));
    return x * (s->span->k0 + s->span->k1 * mean) * (s->b - s->a) * p->cell->len;
}
static inline bool volume_is_straight(const struct piece *s, double lo, double hi)
{
    return fabs(s->q[2]) + fabs(s->q[3]) <= BEND_MAX * (hi - lo);
}
/* Adds a piece of this depth. The rule gives the mean colour; alpha is exact. */
void volume_gauss(struct path *p, const struct piece *s, double depth, const struct rule *r);
/* Splits a piece in two. */
void volume_halve(const struct piece *s, struct piece half[2]);
/* lit.c: integrates a piece by the adaptive method with a light or an attenuation, and sets up the
 * rules for it. */
static inline bool is_lit(const struct volume *v)
{
    return v->spec->lit || v->spec->attenuation > 0;
}
void lit_piece(struct path *p, const struct piece *s);
void lit_rules(struct volume *v);
/* Integrates from w = a to b of the cell, by the method of the options. */
void volume_integrate(struct path *p, double a, double b);
/* True if the path has reached the specification's opacity limit. */
static inline bool path_done(const struct path *p)
{
    return 1 - p->transmittance >= p->v->spec->opacity_limit;
}
/* Adds a segment of optical depth dtau whose k-weighted mean colour is rgb. */
void path_add(struct path *p, double dtau, const double rgb[3]);
/* exp(-a t) at w of the cell. */
double path_fade(const struct path *p, double w);
/* Factor of a colour at w of the cell: exp(-a t), times the shading if the specification is lit. */
double path_light(const struct path *p, double w);
/* Integrates the whole cell by the adaptive method, cut at knots of the map. */
void volume_integrate_cut(struct path *p);
/* Calls each for the pieces between a and b, front to back. With a second field they are cut by it
 * too. */
void volume_pieces(struct path *p, double a, double b, piece_fn *each);
/* The same, for a cell that is known not to lie in one span. */
void volume_pieces_cut(struct path *p, double a, double b, piece_fn *each);
/* The colour at w of the cell: of the map, or of the second field. False outside of the map. */
bool volume_colour(const struct path *p, double w, double rgb[3]);
/* Integrates the cell and adds its iso-surfaces and slices in depth order. s, o, d: the segment and
 * its ray. fresh: the field on the ray just before this cell was unknown. own: false if only the
 * ray's side of each surface counts. */
void volume_surfaces(struct path *p, const struct segment *s, const double o[3], const double d[3],
    bool fresh, bool own);
/* Inserts x, by its w. Returns n + 1. */
uint32_t crossing_insert(struct crossing *list, uint32_t n, struct crossing x);
/* Slices (slice.c): prepares those of v->spec. */
void slice_init(struct volume *v);
void slice_free(struct volume *v);
/* Adds the crossings of a segment with slices to the n of v->crossing. Returns their number. A
 * crossing at the segment's begin is that of the segment before, unless this one is fresh. */
uint32_t slice_crossings(const struct volume *v, const struct segment *s, const double o[3],
    const double d[3], bool fresh, uint32_t n);
/* The colour of a slice at w of the cell. False where the map has none. */
bool slice_colour(const struct path *p, double w, double rgb[3]);
/* Writes the pixel of a path. */
void volume_put(const struct volume *v, const double rgb[3], double transmittance, float *rgba);
/* The same, before the ground. */
void volume_put_ground(const struct volume *v, const struct meeting *m, const double rgb[3],
    double transmittance, float *rgba);
/* True if the stream can render v: by the adaptive method, to a tolerance that float allows. */
bool volume_stream_fits(const struct volume *v);
struct stream *volume_stream_new(struct volume *v);
void volume_stream_free(struct stream *s);
void volume_stream_pixels(
    struct stream *s, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba);

#endif
