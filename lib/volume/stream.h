/*
 * stream: the adaptive method on many rays at once, in float.
 *
 * LANES rays walk side by side, each from cell to cell; whoever ends makes room for the next pixel.
 * The live cells that they come to are put into one list, each ray's front to back, and worked on
 * LANES at a time, whatever rays they are of: so that no lane is idle where rays part, and where
 * little is seen. What a cell adds to its ray does not depend on what is in front of it but for the
 * factor T; the list is added up in order. (T. Aila and S. Laine, "Understanding the efficiency of
 * ray traversal on GPUs", HPG 2009, keep lanes busy in the same way; lists apart from the walk are
 * those of S. Laine, T. Karras and T. Aila, "Megakernels considered harmful", HPG 2013.)
 *
 * Every lane does what it would do alone: no bit depends on the width, nor on who is beside whom.
 * Times are in double, what is within one cell in float: positions from entry to exit are 0 .. 1,
 * the field is less its corner's, knots too. stream_fits says where that is precise enough.
 */
#ifndef STORMRING_VOLUME_STREAM_H
#define STORMRING_VOLUME_STREAM_H

#include "volume/volume_int.h"

#define STREAM_LANES 16   /* the most that a kernel has */
#define STREAM_WALKERS 16 /* rays on their way: several steps hide what each waits for */
#define STREAM_RAYS 256   /* in one call */
#define STREAM_CELLS 256  /* in the list, when it is worked on */
#define STREAM_ROOM (STREAM_CELLS + 2 * STREAM_WALKERS)
#define STREAM_PIECES 8 /* that one cell may be cut into; one of more is left to piece.c */
#define STREAM_LINE 64  /* bytes of a cache line: no vector lies in two */
#define STREAM_ALONE UINT32_MAX

/* The map with an entry below it and one above, both clear: `first` numbers them from 0. */
struct stream_map {
    float *edge_high, *edge_low;                /* knot i is their sum: where entry i + 1 begins */
    float *k0, *k1, *rgb0[3], *rgb1[3], *slope; /* as in struct span */
    float *from_high, *from_low;                /* its lo */
    bool *clear;
    uint32_t edges, entries;
    bool closed;
};

/* Where rays are; see struct walk. */
struct stream_lanes {
    _Alignas(STREAM_LINE) double t[STREAM_WALKERS]; /* parked: exit is below t */
    double exit[STREAM_WALKERS];
    double next[3][STREAM_WALKERS], prev[3][STREAM_WALKERS], rate[3][STREAM_WALKERS];
    double start[3][STREAM_WALKERS], inv[3][STREAM_WALKERS];
    int64_t plane[3][STREAM_WALKERS], step[3][STREAM_WALKERS]; /* plane: of `next`, from plane[0] */
    int64_t node[STREAM_WALKERS], to_node[3][STREAM_WALKERS];
    int64_t passed[STREAM_WALKERS];
    /* Where the cell ends; the plane that is then next on that axis; the byte of `live`. */
    double end[STREAM_WALKERS];
    int64_t beyond[STREAM_WALKERS], byte[STREAM_WALKERS];
    float base[3][STREAM_WALKERS],
        sign[3][STREAM_WALKERS]; /* local = base + sign (t - prev) rate */
    int32_t ray[STREAM_WALKERS];
};

/* Where a cubic is y, between a and b; from there on, entry of the map holds. */
#define STREAM_ROOTS (STREAM_ROOM * (STREAM_PIECES - 1))
struct stream_roots {
    uint32_t n;
    _Alignas(STREAM_LINE) float p[4][STREAM_ROOTS], a[STREAM_ROOTS], b[STREAM_ROOTS],
        y[STREAM_ROOTS], w[STREAM_ROOTS];
    int32_t entry[STREAM_ROOTS], good[STREAM_ROOTS];
};

/* From a to b of a cell, in an entry of the map. */
#define STREAM_PARTS (STREAM_ROOM * STREAM_PIECES)
struct stream_pieces {
    uint32_t n;
    _Alignas(STREAM_LINE) float p[4][STREAM_PARTS], base[STREAM_PARTS], len[STREAM_PARTS];
    float a[STREAM_PARTS], b[STREAM_PARTS], add[STREAM_PARTS][4];
    float error[STREAM_PARTS];
    int32_t entry[STREAM_PARTS];
};

/* Rays at their first cells. */
#define STREAM_STARTS 64
struct stream_starts {
    uint64_t hit; /* a bit for each that meets the grid, and is not on its way yet */
    uint32_t ray; /* the first of them */
    _Alignas(STREAM_LINE) double exit[STREAM_STARTS], next[3][STREAM_STARTS],
        prev[3][STREAM_STARTS];
    double rate[3][STREAM_STARTS], start[3][STREAM_STARTS], inv[3][STREAM_STARTS];
    int64_t plane[3][STREAM_STARTS], step[3][STREAM_STARTS];
    int64_t node[STREAM_STARTS], to_node[3][STREAM_STARTS];
    int64_t guess[3][STREAM_LANES]; /* cells, from the last time */
    double base[3][STREAM_STARTS], sign[3][STREAM_STARTS];
};

struct stream {
    void *room; /* that it lies in, at the beginning of a line */
    struct volume *v;
    struct stream_map map;
    float tolerance;
    uint64_t half_pack[16]; /* of doubles: of their halves, */
    uint64_t pack[256];     /* by mask: the lanes that are in it, a byte each */

    /* This call's rays. */
    const struct lattice *pixels;
    uint64_t n0;
    uint32_t taken, n;
    _Alignas(STREAM_LINE) double sum[STREAM_RAYS][4]; /* what they have gathered: rgb, alpha */
    struct stream_starts starts;
    struct stream_lanes lanes;
    uint32_t parked; /* bits */

    /* The list: entry, and change until exit, in local coordinates; length; */
    uint32_t cells;
    _Alignas(STREAM_LINE) float from[3][STREAM_ROOM], way[3][STREAM_ROOM], len[STREAM_ROOM];
    int64_t node[STREAM_ROOM]; /* the lowest in memory of the cell */
    int32_t of[STREAM_ROOM];
    /* the field less `base` along the ray; the map's entries at its ends; */
    float p[4][STREAM_ROOM], base[STREAM_ROOM];
    int32_t first[STREAM_ROOM], last[STREAM_ROOM];
    /* what it adds: rgb and alpha, where `simple`. */
    _Alignas(STREAM_LINE) float add[STREAM_ROOM][4];
    uint16_t simple[STREAM_ROOM]; /* a bit a lane */
    uint8_t whole[STREAM_ROOM];   /* `add` is all of it: 1 + the samples it took */
    /* Where it is not: the entry where it begins; its pieces. */
    int32_t entry[STREAM_ROOM];
    uint32_t piece[STREAM_ROOM], piece_end[STREAM_ROOM];
    struct stream_roots roots;
    struct stream_pieces pieces;
};

#endif
