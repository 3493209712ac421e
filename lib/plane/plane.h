/*
 * plane: planes of map projections, as strings of PROJ such as "+proj=lcc +lat_1=50 +lat_2=50
 * +lat_0=50 +lon_0=10 +R=6371229", and places on them.
 *
 * Call order: plane_add and plane_earth write a string; plane_open; plane_place; plane_close. A
 * caller must link libproj if it is there.
 */
#ifndef STORMRING_PLANE_H
#define STORMRING_PLANE_H

#include "base/base.h"

#define PLANE_TEXT 160 /* bytes of a string */

/* Appends " +key=v" to a string that is not empty. One that has no room becomes empty, and stays
 * so. */
void plane_add(char text[PLANE_TEXT], const char *key, double v);
/* Appends the half axes of the earth, in metres: +R if they are equal, otherwise +a and +b. */
void plane_earth(char text[PLANE_TEXT], double a_m, double b_m);
/* Begins the string of a rotated sphere, whose north pole is at this place. The longitude of the
 * true north pole on the rotated sphere is `turned`. */
void plane_rotated(
    char text[PLANE_TEXT], double pole_lat_deg, double pole_lon_deg, double turned_deg);

struct plane;
/* True if this was built with libproj. */
bool plane_possible(void);
/* NULL with a message in err if PROJ refuses the string, or if the library was missing when this
 * was built. */
struct plane *plane_open(const char *text, char err[ERR_BYTES]);
/* Finds a place: metres, or degrees of a rotated sphere. False if it is not on the plane. */
bool plane_place(struct plane *p, double lon_deg, double lat_deg, double at[2]);
void plane_close(struct plane *p);

#endif
