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
    struct outline_point *at; /* grown by xgrown */
    size_t n;
    bool flat;                   /* not in degrees: no turns */
    struct outline_point lo, hi; /* all points are between, once outline_bound has set them */
};

/* outline_append adds a point unchanged. outline_add moves it to the longitude nearest to the
 * previous point; the first point goes near Greenwich. */
void outline_append(struct outline *o, struct outline_point p);
void outline_add(struct outline *o, struct outline_point p);
void outline_bound(struct outline *o);
void outline_free(struct outline *o);

/* Half-planes bound the visible part of the map: its edges, the plane of the eye, and the
 * sides of the picture if the drawing is clipped. Sets those
 * that may cut what lies between lo and hi. False if all of that is outside. */
struct halves {
    struct half at[HALVES];
    int n;
};
bool outline_halves(
    const struct drawing *s, struct outline_point lo, struct outline_point hi, struct halves *h);
/* The part of a line inside all half-planes, as two factors. False if there is none. */
bool backdrop_cut_line(
    const struct halves *h, struct outline_point p, struct outline_point q, double part[2]);
/* Clips the polygon o in place, with `other` for its points in between. */
void backdrop_cut_polygon(const struct halves *h, struct outline *o, struct outline *other);
struct outline_point outline_between(struct outline_point p, struct outline_point q, double f);

/* What becomes of a line, or of an area with its outline, on a plane. Edges where the globe is cut
 * open belong to an area, but not to its outline. */
enum outline_piece {
    OUTLINE_BOTH, /* an area as a whole; its last point equals the first */
    OUTLINE_AREA, /* a part of an area, likewise */
    OUTLINE_LINE  /* a part of a line, or of an area's outline */
};
/* Takes a piece, and frees or keeps it. */
typedef void outline_take(void *ctx, struct outline *piece, enum outline_piece kind);
/* Puts a line from the globe on the plane; or, if area, an area, whose last point is its first. */
void outline_spread(const struct plane *plane, const struct outline *globe, bool area,
    outline_take *take, void *ctx);

/* Adds the visible pieces to the list's last mark. */
void outline_stroke(const struct drawing *s, const struct outline *o);
/* Adds the visible points, without lines between them. */
void outline_dot(const struct drawing *s, const struct outline *o);
/*
 * Adds the enclosed area to the list, as areas of this kind and colour; the last point equals the
 * first. An outline that goes round the globe encloses the area up to the nearer pole. False if the
 * area is too small to be visible.
 */
bool outline_fill(
    const struct drawing *s, const struct outline *o, enum backdrop_kind kind, uint32_t rgb);

#endif
