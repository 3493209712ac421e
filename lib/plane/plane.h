/*
 * plane: longitude and latitude to x and y on a plane of projection, or to degrees of a rotated
 * sphere, through libproj; and the globe cut open to a sheet, where lines and areas are clipped
 * before they come onto the plane. PROJ reads no grids here, and has no network.
 */
#ifndef STORMRING_PLANE_H
#define STORMRING_PLANE_H

#include "base/base.h"

/* Degrees, or x and y of a plane. */
struct plane_at {
    double x, y;
};
struct plane;
/*
 * The plane of a PROJ string, see stormring-grid(5), for a map between the corners lo and hi. unit
 * is that of x and y: "m" or "km", or degrees if the sphere is rotated. The string may come from
 * anywhere: its words are checked. NULL with a message in err if a word or the unit is none of
 * those, PROJ refuses the string, or libproj was missing when this was built.
 */
struct plane *plane_open(const char *proj, const char *unit, struct plane_at lo, struct plane_at hi,
    char err[ERR_BYTES]);
void plane_free(struct plane *p);

/* Longitude and latitude to the plane, and back. False if there is no such point. */
bool plane_forward(const struct plane *p, struct plane_at degrees, struct plane_at *at);
bool plane_inverse(const struct plane *p, struct plane_at at, struct plane_at *degrees);

/*
 * The sheet: longitudes and latitudes of a sphere whose poles are such that the projection is
 * continuous at all x from middle - 180 to middle + 180 and y from lo to hi. Its x goes round:
 * x + 360 is the same place. East is at the right of north, as on the globe.
 */
struct plane_sheet {
    double middle, lo, hi;
};
struct plane_sheet plane_sheet(const struct plane *p);
struct plane_at plane_to_sheet(const struct plane *p, struct plane_at degrees);
/* False if the point is not on the plane. */
bool plane_from_sheet(const struct plane *p, struct plane_at sheet, struct plane_at *at);

#endif
