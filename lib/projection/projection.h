/*
 * projection: planes of map projections, as strings of PROJ such as "+proj=lcc +lat_1=50 +lat_2=50
 * +lat_0=50 +lon_0=10 +R=6371229", and places on them.
 *
 * Call order: projection_add, projection_earth and projection_rotated write a string;
 * projection_open; projection_place and projection_degrees; projection_close. A caller must link
 * libproj if it is there.
 */
#ifndef STORMRING_PROJECTION_H
#define STORMRING_PROJECTION_H

#include "base/base.h"

#define PROJECTION_TEXT 160 /* bytes of a string */

/* Appends " +key=v" to a string that is not empty. One that has no room becomes empty, and stays
 * so. */
void projection_add(char text[PROJECTION_TEXT], const char *key, double v);
/* Appends the half axes of the earth, in metres: +R if they are equal, otherwise +a and +b. */
void projection_earth(char text[PROJECTION_TEXT], double a_m, double b_m);
/* Begins the string of a rotated sphere, whose north pole is at this place. The longitude of the
 * true north pole on the rotated sphere is `turned`. */
void projection_rotated(
    char text[PROJECTION_TEXT], double pole_lat_deg, double pole_lon_deg, double turned_deg);

struct projection;
/* True if this was built with libproj. */
bool projection_possible(void);
/* NULL with a message in err if PROJ refuses the string, or if the library was missing when this
 * was built. */
struct projection *projection_open(const char *text, char err[ERR_BYTES]);
/* Finds a place: metres, or degrees of a rotated sphere. False if it is not on the plane. */
bool projection_place(struct projection *p, double lon_deg, double lat_deg, double at[2]);
/* Finds the longitude and latitude of a place, back from `at`. False if it is none. */
bool projection_degrees(struct projection *p, const double at[2], double degrees[2]);
void projection_close(struct projection *p);

#endif
