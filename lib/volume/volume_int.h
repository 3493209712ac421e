/*
 * volume_int: what the renderer's files share. A ray walks the grid (walk.c); the field along it in
 * one cell is a cubic of w, 0 .. 1 from entry to exit (cell.c, cubic.c); it is cut where it meets a
 * sheet or a knot of the map (piece.c), and integrated (integrate.c, lit.c). Where there are
 * neither sheets nor light, the default method takes cells several at a time (batch.h, kernel.h).
 */
#ifndef STORMRING_VOLUME_INT_H
#define STORMRING_VOLUME_INT_H

#include "volume/batch.h"
#include "volume/volume.h"

#include <string.h>

#define BLOCK_SHIFT 2
#define BLOCK (1 << BLOCK_SHIFT) /* cells along each edge of what is skipped at once */
#define GAUSS_MAX VOLUME_NODES_MAX

/* ---- the map (map.c) ------------------------------------------------------------------------ */

/* Between two knots: k = k0 + k1 (s - lo), likewise rgb. */
struct span {
    double lo, hi, k0, k1, rgb0[3], rgb1[3];
    double slope; /* the greatest of rgb1 */
    bool clear;   /* k = 0 throughout */
};
struct map {
    struct span *span; /* ascending, contiguous, none of width 0 */
    uint32_t n;
    bool closed; /* the last span holds at its upper end too */
};

void map_init(struct map *m, const struct spec *s);
/* The span that holds at s, -1 outside of the map. */
int map_find(const struct map *m, double s);
/* Does anything between lo and hi, both included, absorb? */
bool map_absorbs(const struct map *m, double lo, double hi);

/* ---- exp ------------------------------------------------------------------------------------- */

/*
 * exp(x) for x <= 0, of sums and products of doubles only. A C library's own differs in the last
 * bit from host to host, as it picks variants with FMA at run time.
 */
static inline double volume_exp(double x)
{
    static const double log2_e = 1.4426950408889634074;
    static const double ln2_high = 0.693147180369123816490; /* 33 bits: n times it is exact */
    static const double ln2_low = 1.90821492927058770002e-10;
    static const double round = 0x1.8p52; /* a sum's last bits are then n */
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
/* Bounds of p on 0 .. 1: its control points'. */
void cubic_bounds(const double p[4], double *lo, double *hi);
/* Where p turns within 0 .. 1: ascending, both ends included: 2 to 4 numbers. */
int cubic_monotone(const double p[4], double w[4]);
/* Where p is y in a .. b, where it is monotone and y is between its ends. */
double cubic_root(const double p[4], double a, double b, double y);

/* ---- the grid, prepared (skip.c, volume.c) -------------------------------------------------- */

/* A ray meets an iso-surface, at w of a cell. */
struct crossing {
    double w;
    const struct spec_iso *iso;
};

/* Nodes and weights of Gauss and Legendre for 0 .. 1. */
struct rule {
    int m;
    double node[GAUSS_MAX], weight[GAUSS_MAX];
};

struct volume {
    const struct spec *spec;
    struct volume_options o;
    double *plane[3];     /* scaled coordinates, ascending; BLOCK at infinity to either side */
    double *inv_edge[3];  /* of the cell above each plane but the last */
    uint32_t cells[3];    /* planes less one */
    ptrdiff_t stride[3];  /* from a node to the next, in values; negative where the scale is */
    const float *first;   /* the node at the lowest corner */
    const float *value;   /* in memory: */
    ptrdiff_t row, layer; /* nodes from one to the next */
    ptrdiff_t origin;     /* the cell at the lowest corner: of its nodes the first in memory */
    uint8_t *live;        /* a bit a cell, by its first node in memory: something is seen in it */
    uint8_t *block;       /* a byte a block: some cell of it is live */
    uint32_t blocks[3];
    double range; /* of values in a live cell, at most */
    struct map map;
    struct camera camera;
    struct rule rule;          /* of the method; under a light, for straight pieces, */
    struct rule bent;          /* and for others */
    double bright;             /* the greatest colour that the map has */
    struct crossing *crossing; /* of one cell */
    bool *above;               /* by surface: the ray is at or above its value */
    const struct kernel *kernel;
    bool batched;          /* cells are taken several at a time */
    struct stream *stream; /* rays are */
    struct batch batch;
    struct volume_counts counts;
};

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
static inline size_t block_index(const struct volume *v, const int32_t i[3])
{
    size_t x = (size_t)i[0] >> BLOCK_SHIFT, y = (size_t)i[1] >> BLOCK_SHIFT;
    return (((size_t)i[2] >> BLOCK_SHIFT) * v->blocks[1] + y) * v->blocks[0] + x;
}

/* ---- the walk (walk.c) ---------------------------------------------------------------------- */

/* Slopes below this move a ray by nothing in any grid; their reciprocals would overflow. */
#define WALK_LEVEL 1e-200

/* How far a ray has come. */
struct front {
    double t;               /* from o */
    double next[3];         /* where the cell ends along each axis, */
    const double *plane[3]; /* by the planes there */
    size_t cell;
    uint32_t passed; /* cells */
};
struct walk {
    const struct volume *v;
    struct front front;
    double o[3], d[3], inv[3]; /* from where the ray enters the grid, or the eye inside it */
    double before, exit;       /* from the eye to o; where the ray leaves the grid */
    ptrdiff_t step[3];         /* -1, 0 or 1 */
    ptrdiff_t to_cell[3];      /* what a step adds to a cell's index */
    double start[3];           /* o; -infinity along an axis whose step is 0 */
    const double *zero[3];     /* the plane of cell 0 */
};
/* Through the middle of pixel p. */
static inline struct vec3 volume_direction(const struct volume *v, uint64_t p)
{
    const struct camera *c = &v->camera;
    return v3_unit(camera_direction(c, (double)(p % c->w) + 0.5, (double)(p / c->w) + 0.5));
}
/* False when the ray misses the grid. */
bool walk_begin(struct walk *w, const struct volume *v, struct vec3 eye, struct vec3 dir);
/* A cell, and where the ray is in it. */
struct stretch {
    double t0, t1;
    int32_t i[3];
};
/* The next live cells, at most so many; 0 when there is none left. */
uint32_t walk_cells(struct walk *w, struct stretch *out, uint32_t most);

/* ---- one cell (cell.c) ---------------------------------------------------------------------- */

struct cell {
    double base;            /* the field at its lowest corner; */
    double p[4];            /* and along the ray, less base */
    double edge[3];         /* its edges' lengths, */
    double f[7];            /* the field less base: x, y, z, xy, xz, yz, xyz */
    double from[3], way[3]; /* local coordinates at entry; how they change until exit */
    double t, len;          /* entry, from the eye; length */
};
/* Times are from o; the caller adds what is before that to t. */
void cell_init(struct cell *c, const struct volume *v, const double o[3], const double d[3],
    const struct stretch *s);
/* The gradient, in scaled space, at w. */
struct vec3 cell_gradient(const struct cell *c, double w);

/* ---- integration (integrate.c, surface.c, batch.c) ------------------------------------------ */

/* What a ray has gathered. */
struct path {
    struct volume *v;
    double rgb[3], clear; /* clear: exp(-tau), what still shines through */
    struct cell *cell;
    struct vec3 dir;
};
/* A stretch of one cell in one span: the cubic less the span's lo, w 0 .. 1 in it. */
struct piece {
    const struct span *span;
    double q[4], a, b; /* a, b: in the cell's w */
};

/*
 * What the adaptive method has rules of nodes for: pieces of this optical depth at most, on which
 * the field's q[2] and q[3] are, together, at most so much of its range. A rule of 3, 4, 5, 6 and 7
 * nodes is then wrong by 3.5e-3, 1.7e-4, 6.6e-6, 2.1e-7 and 6e-9 of the colour's range at most, by
 * a search for the worst such piece. (Of all cubics, 3 nodes may miss a fifth of it, however thin
 * the piece is: k c is of degree 6.)
 */
#define DEPTH_MAX 1.0
#define BEND_MAX 0.5
void gauss_rule(struct rule *r, int m);
/* The optical depth of a piece, up to x of it. */
double depth_to(const struct path *p, const struct piece *s, double x);
bool is_straight(const struct piece *s, double lo, double hi);
/* Adds a piece of this depth: the rule gives the mean colour, alpha is exact. */
void gauss(struct path *p, const struct piece *s, double depth, const struct rule *r);
/* The two halves of a piece. */
void halve(const struct piece *s, struct piece half[2]);
/* lit.c: a piece by the adaptive method, where there is a light or an attenuation; and the rules
 * for it. */
static inline bool is_lit(const struct volume *v)
{
    return v->spec->lit || v->spec->attenuation > 0;
}
void lit_piece(struct path *p, const struct piece *s);
void lit_rules(struct volume *v);
/* Between w = a and b of the cell, by the method of the options. */
void integrate(struct path *p, double a, double b);
/* As opaque as the specification wants. */
static inline bool path_done(const struct path *p)
{
    return 1 - p->clear >= p->v->spec->opacity_limit;
}
/* One stretch of a given optical depth whose k-weighted mean colour is rgb. */
void path_add(struct path *p, double dtau, const double rgb[3]);
/* exp(-a t) and, when lit, the light at w of the cell: what a colour there is multiplied by. */
double path_light(const struct path *p, double w);
/* The whole cell by the adaptive method: in one span, or, s NULL, cut where the map has knots. */
void integrate_cut(struct path *p, const struct span *s);
/* The pieces between a and b, each to `each`, front to back. */
void pieces(struct path *p, double a, double b, void (*each)(struct path *, const struct piece *));
/* The same, where it is known not to be in one span. */
void pieces_cut(
    struct path *p, double a, double b, void (*each)(struct path *, const struct piece *));
/* Integrates the cell, and lays the sheets of its iso-surfaces between. fresh: the ray comes from
 * where the field was not known. */
void surfaces(struct path *p, bool fresh);
/* Puts what a ray gathered. */
void volume_put(const struct volume *v, const double rgb[3], double clear, float *rgba);
/* Is the adaptive method precise enough in float? */
bool stream_fits(const struct volume *v);
struct stream *stream_new(struct volume *v);
void stream_free(struct stream *s);
void stream_pixels(struct stream *s, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba);
/* The whole ray by the adaptive method, where there is neither light, nor attenuation, nor a
 * surface. */
void batch_ray(struct path *p, struct walk *w);

#endif
