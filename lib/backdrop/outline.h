/*
 * outline: lines and areas on the map. In degrees they are shifted by whole turns to the grid's
 * longitudes. Parts outside the map or behind the eye are cut off. Private to lib/backdrop.
 */
#ifndef STORMRING_BACKDROP_OUTLINE_H
#define STORMRING_BACKDROP_OUTLINE_H

#include "backdrop/drawing.h"

struct outline_point {
    double x, y;
};
struct outline {
    struct outline_point *at;
    size_t n, room;
    bool flat; /* not in degrees: no turns */
};

/* outline_append adds a point unchanged. outline_add moves it to the longitude nearest to the
 * previous point; the first point goes near Greenwich. */
void outline_append(struct outline *o, struct outline_point p);
void outline_add(struct outline *o, struct outline_point p);
void outline_free(struct outline *o);

/* The half-plane a x + b y + c >= 0. */
struct half {
    double a, b, c;
};
#define HALVES 5
/* The half-planes that bound the visible part of the map: its edges, and the plane of the eye. */
void outline_halves(const struct drawing *s, struct half h[HALVES]);
/* The part of a line inside all half-planes, as two factors. False if there is none. */
bool backdrop_cut_line(
    const struct half h[HALVES], struct outline_point p, struct outline_point q, double part[2]);
/* Clips a polygon in place. */
void backdrop_cut_polygon(const struct half h[HALVES], struct outline *o);
struct outline_point outline_between(struct outline_point p, struct outline_point q, double f);

/* Writes points in pixels; an empty line ends each visible piece. */
void outline_stroke(const struct drawing *s, const struct outline *o, struct buf *out);
/*
 * The same for the enclosed area; the last point equals the first. An outline that goes round the
 * globe encloses the area up to the nearer pole. False if the area is too small to be visible.
 */
bool outline_fill(const struct drawing *s, const struct outline *o, struct buf *out);

#endif
