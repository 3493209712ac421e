/*
 * drawing: what the files of backdrop share.
 */
#ifndef STORMRING_BACKDROP_DRAWING_H
#define STORMRING_BACKDROP_DRAWING_H

#include "backdrop/backdrop.h"

#define PAGE 0.92       /* linear light of what is behind all, */
#define PAPER "#f6f6f6" /* the same in sRGB */
#define SEA "#e3ebf1"
#define LAND "#d9d9cf"
#define COAST "#76828a"
#define COAST_WIDTH .6
#define GRATICULE "#c3ccd3"
#define FRAME "#8a949b"

struct drawing {
    const struct backdrop *b;
    struct buf *out;
    struct camera camera;
    double w, h;         /* pixels */
    double lo[3], hi[3]; /* the grid's box, in its own coordinates; z: lo is below */
};

/* ---- points and text (drawing.c) ------------------------------------------------------------ */

void drawing_init(struct drawing *s, const struct backdrop *b, struct buf *out);
/* A point of the grid's coordinates to pixels, y upwards as gnuplot has it. False where it is not
 * in front of the eye. */
bool backdrop_project(const struct drawing *s, double x, double y, double z, double xy[2]);
/* A point of a line in a data block; the line is broken where it cannot be seen. */
void backdrop_point(const struct drawing *s, double x, double y, double z);
void backdrop_label(const struct drawing *s, const char *text, const double xy[2], const char *how);

/* The ticks within a range: i times step for first <= i <= last; none where they could not be told
 * apart. */
struct ticks {
    double step;
    int first, last;
};
struct ticks backdrop_ticks(double lo, double hi, double step);
/* 1, 2 or 5 times a power of ten, so that a range has at most n of it. */
double backdrop_step(double range, int n);

/* ---- what is drawn (map.c, legend.c) -------------------------------------------------------- */

void backdrop_graticule(const struct drawing *s);
void backdrop_edges(const struct drawing *s);
void backdrop_labels(const struct drawing *s);
void backdrop_legend(const struct drawing *s);

#endif
