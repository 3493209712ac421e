/*
 * stream: the adaptive method on many rays at once, in float.
 *
 * Up to STREAM_WALKERS rays traverse the grid side by side, VF at a time. A lane that ends its ray
 * takes the next pixel. The live cells of all rays go into one list, each ray's cells front to
 * back. The list is integrated VF cells at a time, whatever their rays, so no lane is idle where
 * rays diverge or where few cells are visible. A cell's contribution depends on those in front only
 * through the factor T, so the list is summed in order. (T. Aila and S. Laine, "Understanding the
 * efficiency of ray traversal on GPUs", HPG 2009, keep lanes busy in the same way. Separate lists
 * and traversal are from S. Laine, T. Karras and T. Aila, "Megakernels considered harmful", HPG
 * 2013.)
 *
 * Every lane computes the same as it would alone: no bit depends on the width or on the other
 * lanes. Times are double. Values within one cell are float: positions from entry to exit are 0 ..
 * 1; the field and the knots are relative to the cell's corner. Cells for which that is not precise
 * enough, and those that may meet a surface, are done alone: by the code of volume.c, in double.
 */
#ifndef STORMRING_VOLUME_STREAM_H
#define STORMRING_VOLUME_STREAM_H

#include "volume/volume_int.h"

#define STREAM_LANES 16   /* the largest VF of all kernels */
#define STREAM_WALKERS 32 /* maximum active rays; interleaving several steps hides latency */
#define STREAM_RAYS 256   /* rays per call */
#define STREAM_CELLS 256  /* list length that triggers integration */
#define STREAM_ROOM (STREAM_CELLS + 2 * STREAM_WALKERS)
#define STREAM_PIECES 8 /* maximum pieces of one cell; cells with more are left to piece.c */
#define STREAM_LINE 64  /* bytes per cache line; no vector straddles two lines */
#define STREAM_ALONE UINT32_MAX
#define SURFACE_MARGIN 0x1p-18F          /* of the range of a cell's values; see ROUNDING */
#define STREAM_FAST_ERROR (18 * 0x1p-24) /* see stream_fast.h */
#define STREAM_NODES 7                   /* of the Gauss rule for lit pieces, at most */

/* The map, with a transparent entry below and one above. `first` counts entries from 0. */
struct stream_map {
    float *edge_high, *edge_low; /* knot i is their sum: the lower end of entry i + 1 */
    float *k0, *k1, *rgb0[3], *rgb1[3], *slope; /* as in struct map_span */
    float *from_high, *from_low;                /* lo of the entry */
    float *room; /* the greatest range of a cell for which float is precise enough */
    bool *transparent;
    uint32_t edges, entries;
    bool closed;
};

/* State of the rays; see struct walk. */
struct stream_lanes {
    _Alignas(STREAM_LINE) double t[STREAM_WALKERS]; /* parked: exit < t */
    /* The end of live regions, or -1 if the ray has ended; the end of the grid. */
    double exit[STREAM_WALKERS], stop[STREAM_WALKERS];
    double next[3][STREAM_WALKERS], prev[3][STREAM_WALKERS], rate[3][STREAM_WALKERS];
    double start[3][STREAM_WALKERS], inv[3][STREAM_WALKERS];
    /* plane: of `next`, as an index into plane[0]; with s->even: its number on the axis. */
    int64_t plane[3][STREAM_WALKERS], step[3][STREAM_WALKERS];
    double number[3][STREAM_WALKERS], way[3][STREAM_WALKERS]; /* with s->even: plane and step */
    int64_t node[STREAM_WALKERS], to_node[3][STREAM_WALKERS];
    int64_t passed[STREAM_WALKERS];
    /* End of the cell; the plane that follows on that axis; the byte of `live`. */
    double end[STREAM_WALKERS];
    int64_t beyond[STREAM_WALKERS], byte[STREAM_WALKERS];
    float base[3][STREAM_WALKERS],
        sign[3][STREAM_WALKERS]; /* local = base + sign (t - prev) rate */
    int32_t ray[STREAM_WALKERS];
    /* With s->wide: see struct stream_ray. */
    double before[STREAM_WALKERS], still[3][STREAM_WALKERS];
    double light[3][STREAM_WALKERS], dir[3][STREAM_WALKERS];
};

/*
 * The rays with s->fast, in float. On an axis, plane number n is at time (n - start) * inv, and the
 * local coordinate at time t is base - (next - t) * rate.
 */
struct stream_fast {
    _Alignas(STREAM_LINE) float t[STREAM_WALKERS], exit[STREAM_WALKERS], stop[STREAM_WALKERS],
        end[STREAM_WALKERS];
    float next[3][STREAM_WALKERS], number[3][STREAM_WALKERS], way[3][STREAM_WALKERS];
    float start[3][STREAM_WALKERS], inv[3][STREAM_WALKERS];
    float base[3][STREAM_WALKERS], rate[3][STREAM_WALKERS];
    int32_t node[STREAM_WALKERS], byte[STREAM_WALKERS], to_node[3][STREAM_WALKERS];
    int32_t passed[STREAM_WALKERS];
};

/* Sets the end of the lane's cell, and what goes with it. */
static inline void stream_lane_end(struct stream_lanes *l, int lane)
{
    int a = l->next[0][lane] <= l->next[1][lane] ? 0 : 1;
    if (!(l->next[a][lane] <= l->next[2][lane])) a = 2;
    l->end[lane] = l->next[a][lane];
    l->beyond[lane] = l->plane[a][lane] + l->step[a][lane];
    l->byte[lane] = l->node[lane] >> 3;
}

static inline void stream_fast_end(struct stream_fast *q, int lane)
{
    q->end[lane] = fminf(q->next[0][lane], fminf(q->next[1][lane], q->next[2][lane]));
    q->byte[lane] = q->node[lane] >> 3;
}

/* What s->wide keeps of a ray. `light` and `dir` are in the order of memory: mirrored with axes. */
struct stream_ray {
    double o[3], d[3], before; /* as in struct walk */
    double light[3], dir[3];   /* from o to the light; d */
    double still[3];           /* 1 / edge of the cell on axes without movement; else 0 */
    double last;               /* end of the last cell with a surface; -1: none */
};

/*
 * The light in a cell, as polynomials of w, 0 .. 1 from entry to exit: g.l, |g|^2 and |l|^2, with g
 * along the gradient and l to the light, both scaled to at most about 1. slope: |dg/dw|^2 at 0.
 */
enum { LIGHT_FACING = 0, LIGHT_GRADIENT = 4, LIGHT_WAY = 9, LIGHT_SLOPE = 12, LIGHT_VALUES };

/* Roots: cubic p equals y between a and b. From the root on, map entry `entry` holds. */
#define STREAM_ROOTS (STREAM_ROOM * (STREAM_PIECES - 1))
struct stream_roots {
    uint32_t n;
    _Alignas(STREAM_LINE) float p[4][STREAM_ROOTS], a[STREAM_ROOTS], b[STREAM_ROOTS],
        y[STREAM_ROOTS], w[STREAM_ROOTS];
    int32_t entry[STREAM_ROOTS], good[STREAM_ROOTS];
};

/* Pieces: part a .. b of a cell, within one entry of the map. */
#define STREAM_PARTS (STREAM_ROOM * STREAM_PIECES)
struct stream_pieces {
    uint32_t n;
    _Alignas(STREAM_LINE) float p[4][STREAM_PARTS], base[STREAM_PARTS], len[STREAM_PARTS];
    float a[STREAM_PARTS], b[STREAM_PARTS], add[STREAM_PARTS][4];
    float error[STREAM_PARTS];
    int32_t entry[STREAM_PARTS], cell[STREAM_PARTS];
};

/* Where a ray is in regions with live cells; most: the greatest number of cells that it may pass.
 * The last span takes in those for which there is no room. */
#define REGION_SHIFT 4 /* a region has 16 cells along each axis */
#define STREAM_SPANS 6
struct stream_spans {
    double begin[STREAM_SPANS], end[STREAM_SPANS];
    int64_t most;
    uint32_t n, taken;
};

/* Rays at their first cells. */
#define STREAM_STARTS 64
struct stream_starts {
    uint64_t hit; /* one bit per ray that hits the grid and has not started */
    uint32_t ray; /* the first ray of this group */
    _Alignas(STREAM_LINE) double enter[STREAM_STARTS], exit[STREAM_STARTS];
    double next[3][STREAM_STARTS], prev[3][STREAM_STARTS];
    double rate[3][STREAM_STARTS], start[3][STREAM_STARTS], inv[3][STREAM_STARTS];
    int64_t plane[3][STREAM_STARTS], step[3][STREAM_STARTS];
    int64_t node[STREAM_STARTS], to_node[3][STREAM_STARTS];
    int64_t guess[3][STREAM_LANES]; /* cell indices of the previous rays */
    double base[3][STREAM_STARTS], sign[3][STREAM_STARTS], still[3][STREAM_STARTS];
};

/* Adds up the cells of the rays of pixels n0 .. n0+n of the lattice, n <= STREAM_RAYS, in s->sum.
 * (stream_ray.h, at each vector width) */
typedef void stream_kernel(struct stream *s, const struct lattice *l, uint64_t n0, uint32_t n);
stream_kernel *volume_kernel_sse2(void);
/* NULL if this build or this machine lacks the instructions. */
stream_kernel *volume_kernel_avx2(void);
stream_kernel *volume_kernel_avx512(void);

struct stream {
    void *room; /* the allocation; the struct starts at a cache line in it */
    stream_kernel *kernel;
    struct volume *v;
    struct stream_map map;
    float tolerance;
    bool even;   /* planes are at equal distances on each axis: see stream_walk.h */
    bool fast;   /* and the walk may be in float: see stream_fast.h */
    int walkers; /* active rays: a multiple of STREAM_LANES, up to STREAM_WALKERS */
    bool wide;   /* the list has all that light, sheets, a clip box and narrow spans need */
    bool narrow; /* some cells have a range for which float is not precise enough */
    float least_room;
    bool shines; /* there is a light or an attenuation */
    /* Gauss rule of lit pieces, and its errors: see stream_lit.h. */
    int nodes;
    float at[STREAM_NODES], weight[STREAM_NODES];
    float bright, straight, near[2], any[2];
    float *value_high, *value_low; /* the values of surfaces are their sums */
    bool *above;                   /* per ray and surface: see surface.c */
    struct meeting *ground;        /* per ray; NULL: there is no ground */
    /* Leaps over empty regions (leap.c): 1 if some cell of the region is live; planes of all axes
     * that are faces of regions. */
    bool leaps;
    double *region, *region_plane;
    int64_t regions[3];
    struct stream_spans spans[STREAM_RAYS];
    uint64_t half_pack[16]; /* for doubles: indices of their halves */
    uint64_t pack[256];     /* by mask: the indices of its lanes, one byte each */

    /* The rays of this call. */
    const struct lattice *pixels;
    uint64_t n0;
    uint32_t taken, n;
    _Alignas(STREAM_LINE) double sum[STREAM_RAYS][4]; /* accumulated rgb and alpha */
    struct stream_starts starts;
    struct stream_lanes lanes;
    struct stream_fast quick;
    struct stream_ray ray[STREAM_RAYS];
    uint32_t parked; /* one bit per lane */

    /* The list of cells: entry, and change until exit, in local coordinates; length. */
    uint32_t cells;
    _Alignas(STREAM_LINE) float from[3][STREAM_ROOM], delta[3][STREAM_ROOM], len[STREAM_ROOM];
    int64_t node[STREAM_ROOM]; /* the cell's first node in memory */
    int32_t of[STREAM_ROOM];
    /* With `wide`: the ends of the cell, from o, as the bits of doubles; the distance from the eye;
     * 1 / edges; the way to the light. */
    int64_t begin[STREAM_ROOM], end[STREAM_ROOM];
    _Alignas(STREAM_LINE) float eye[STREAM_ROOM], edge[3][STREAM_ROOM], way[3][STREAM_ROOM];
    float light[LIGHT_VALUES][STREAM_ROOM];
    float turn[STREAM_ROOM];    /* of the cell / the greatest of a piece; infinity: alone */
    uint16_t hard[STREAM_ROOM]; /* one bit per lane: surely alone, as it may meet a surface */
    /* The field along the ray minus `base`; the map entries at the bounds of the field. */
    float p[4][STREAM_ROOM], base[STREAM_ROOM];
    int32_t first[STREAM_ROOM], last[STREAM_ROOM];
    /* The contribution rgb and alpha, if `simple`. */
    _Alignas(STREAM_LINE) float add[STREAM_ROOM][4];
    uint16_t simple[STREAM_ROOM]; /* one bit per lane */
    uint8_t whole[STREAM_ROOM];   /* `add` is complete: 1 + number of samples; 0: not complete */
    bool parts[STREAM_ROOM];      /* by vectors: some cell is not whole */
    /* For other cells: the entry at the start; the range of pieces. */
    int32_t entry[STREAM_ROOM];
    uint32_t piece[STREAM_ROOM], piece_end[STREAM_ROOM];
    struct stream_roots roots;
    struct stream_pieces pieces;
};

/* Finds the regions with live cells. (leap.c) */
void volume_leap_init(struct stream *s);
void volume_leap_free(struct stream *s);
/* Brings the ray of a lane to its next span, and sets `exit` to where the span ends. False if
 * there is none. */
bool volume_leap(struct stream *s, int lane);

#endif
