/* drawing: declarations that the files of backdrop share. */
#ifndef STORMRING_BACKDROP_DRAWING_H
#define STORMRING_BACKDROP_DRAWING_H

#include "backdrop/backdrop.h"
#include "geometry/geometry.h"
#include "plane/plane.h"

#define PAGE 0.92 /* linear light of the page, BACKDROP_PAPER */
#define SEA 0xe3ebf1u
#define LAND 0xd9d9cfu
#define COAST 0x76828au
#define COAST_WIDTH .6
#define GRATICULE 0xc3ccd3u
#define FRAME 0x8a949bu
#define NUMBERED 0x35507au
#define DOT 0xb02a20u

/* The labels so far. */
struct labels {
    struct buf boxes; /* a struct label_box for each */
    size_t series;    /* the first one of the ticks that are being labelled */
    bool in_strip;    /* now they are labels of the strip, otherwise of the picture */
};
/* The half-plane a x + b y + c >= 0 of the map. */
struct half {
    double a, b, c;
};
#define HALVES 9
struct drawing {
    const struct backdrop *b;
    struct backdrop_list *list;
    struct camera camera;
    double w, h;  /* pixels of the picture */
    double em;    /* pixels: the size of the font */
    double strip; /* pixels: the height of the strip below the picture, where y < 0 */
    struct labels *labels;
    struct outline *scratch;  /* two, for areas */
    bool clipped;             /* to the picture */
    double z;                 /* height of the map, or of lines, set by drawing_raise */
    int level;                /* 0: the map; or that of the lines at this height */
    double map[3][3];         /* of a point x, y there: right, up and forward of the eye */
    struct half half[HALVES]; /* set by drawing_bound (cut.c) */
    int n_halves;
    double lo[3], hi[3]; /* the grid's box in its own coordinates; in z, lo is the lower side */

    const struct plane *plane; /* of x and y; NULL: not known, or the map is in degrees */
};

/* ---- the list (mark.c) ---------------------------------------------------------------------- */

/* Begins a mark; or goes on with the last one, if it is of this kind and colour. */
void mark_begin(struct backdrop_list *l, enum backdrop_kind kind, uint32_t rgb, double width);
/* Adds a point to the last mark, or the end of a line or an area. */
void mark_point(struct backdrop_list *l, double x, double y);
void mark_break(struct backdrop_list *l);
void mark_rectangle(struct backdrop_list *l, enum backdrop_kind kind, uint32_t rgb,
    const double from[2], const double to[2]);
void mark_label(
    struct backdrop_list *l, const char *text, const double xy[2], int align, double turn);
/* Removes points of the last mark, so that the list has n_at. */
void mark_shorten(struct backdrop_list *l, size_t n_at);
/* Removes marks, so that n are left. */
void mark_cut(struct backdrop_list *l, size_t n_marks);

/* ---- points and text (drawing.c) ------------------------------------------------------------ */

void drawing_init(struct drawing *s, const struct backdrop *b);
/* Puts what is on the map, until the next call, at this height. */
void drawing_raise(struct drawing *s, int level, double z);
void drawing_bound(struct drawing *s); /* the half-planes, for drawing_raise (cut.c) */
/* Projects a point in grid coordinates to pixels. False if it is not in front of the eye. */
bool backdrop_project(const struct drawing *s, double x, double y, double z, double xy[2]);
/* The same for a point on the map that is known to be in front of the eye. */
static inline struct backdrop_at drawing_on_map(const struct drawing *s, double x, double y)
{
    const double(*m)[3] = s->map;
    double far = m[2][0] * x + m[2][1] * y + m[2][2];
    return (struct backdrop_at){(s->w + (m[0][0] * x + m[0][1] * y + m[0][2]) / far) / 2,
        (s->h + (m[1][0] * x + m[1][1] * y + m[1][2]) / far) / 2};
}
/* The longer side of the map, in the unit of axis 0 or 1: the specification may stretch one. */
double drawing_longest(const struct drawing *s, int axis);
/* True if this side of the box (0 low, 1 high) is between the eye and the interior. */
bool drawing_in_front(const struct drawing *s, int axis, int side);
/* Adds a point to a line. Breaks the line if the point is invisible. */
void drawing_point(const struct drawing *s, double x, double y, double z);
/*
 * Places a label with its left end (-1), its middle (0) or its right end (1) at xy. It is left out
 * if it would cover another label, or is not inside the picture, or the strip.
 */
enum label { LABEL_PLACED, LABEL_LEFT_OUT, LABEL_TOO_CLOSE };
enum label backdrop_label(const struct drawing *s, const char *text, const double xy[2], int align);
/* Keeps this place for a label that the caller adds, if it is free. */
struct label_box {
    double x0, x1, y0, y1;
};
enum label drawing_reserve(const struct drawing *s, const struct label_box *box);
/* Calls label(ctx, i * step) for each tick: for every second one, fifth one and so on if otherwise
 * they would cover each other, LABEL_TOO_CLOSE. */
struct ticks;
typedef enum label label_tick(const struct drawing *s, const void *ctx, double v);
void backdrop_label_ticks(
    const struct drawing *s, const struct ticks *t, label_tick *label, const void *ctx);
/* About the width of a text, in pixels; rather too much. */
double backdrop_text_width(const struct drawing *s, const char *text);
#define BACKDROP_FONT 16.0     /* pixels of an em at gnuplot's fontscale 1: 12 points */
#define BACKDROP_MARGIN .5     /* em: beside the caption, above the bar */
#define BACKDROP_TEXT_HIGH 1.2 /* em: the height of a line */

/* The ticks in a range: i * step for first <= i <= last. None if rounding would merge them. */
struct ticks {
    double step;
    int first, last;
};
struct ticks backdrop_ticks(double lo, double hi, double step);
/* As backdrop_step, in degrees: at most 12 steps. */
double backdrop_degree_step(double range);
/* Longitudes (axis 0) from 180 W to 180 E, latitudes unchanged. */
void backdrop_degrees_text(char *out, size_t n, int axis, double v);

/* ---- parts of the drawing (map.c, curves.c, legend.c) ---------------------------------------- */

void backdrop_graticule(const struct drawing *s);
/* Meridians and parallels on a plane, and labels where they meet the map's edge: at the lower or
 * the upper end of y first, away from the corner of the heights. */
void backdrop_curves(const struct drawing *s);
void backdrop_label_curves(const struct drawing *s, bool low, const double corner[2]);
void backdrop_edges(const struct drawing *s);
void backdrop_labels(const struct drawing *s);
void backdrop_legend(const struct drawing *s);
void backdrop_caption(const struct drawing *s);
#define BACKDROP_LINE 1.6 /* em: the height of the caption */
#define BACKDROP_ROW 1.3  /* em: the height of the numbers above and below the bar, of 1 em */

#endif
