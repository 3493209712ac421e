/*
 * outline: lines and areas on the map. In degrees, they are continued round the globe to where the
 * grid is; what is outside of the map, or behind the eye, is cut off. Private to lib/backdrop.
 */
#ifndef STORMRING_BACKDROP_OUTLINE_H
#define STORMRING_BACKDROP_OUTLINE_H

#include "backdrop/drawing.h"

struct point {
    double x, y;
};
struct outline {
    struct point *at;
    size_t n, room;
    bool flat; /* not in degrees: there is no way round the globe */
};

/* One point more, as it is; or by the shorter way round the globe, the first one near Greenwich. */
void outline_append(struct outline *o, struct point p);
void outline_add(struct outline *o, struct point p);
void outline_free(struct outline *o);

/* Where a x + b y + c >= 0. */
struct half {
    double a, b, c;
};
#define HALVES 5
/* What is seen of the map: within its edges, and in front of the eye. */
void seen_halves(const struct drawing *s, struct half h[HALVES]);
/* The part of a line that is in all of them, between two factors. False where there is none. */
bool cut_line(const struct half h[HALVES], struct point p, struct point q, double part[2]);
/* The same of a polygon, which becomes it. */
void cut_polygon(const struct half h[HALVES], struct outline *o);
struct point point_between(struct point p, struct point q, double f);

/* As points in pixels, a piece that is seen after the other, with an empty line behind each. */
void outline_stroke(const struct drawing *s, const struct outline *o, struct buf *out);
/*
 * The same of what it encloses; its last point is its first one. Where it goes round the globe,
 * that is what lies between it and the nearer pole. False where that is too small to be seen.
 */
bool outline_fill(const struct drawing *s, const struct outline *o, struct buf *out);

#endif
