/* convert_int: private to lib/convert. */
#ifndef STORMRING_CONVERT_INT_H
#define STORMRING_CONVERT_INT_H

#include "convert/convert.h"

/* How the columns of a globe are moved along. */
struct convert_roll {
    uint32_t first;  /* the column that becomes the first one */
    uint32_t period; /* columns of the circle: without the last one if that is the first again */
};
/* Moves the longitudes of a globe so that they begin at o->from or the first one after it. A grid
 * of a part of the globe moves by whole circles. Dies if x is no longitude. */
struct convert_roll convert_find_roll(
    const struct convert_options *o, const struct converter *c, struct grid *g);
/* Moves the values of each row likewise. */
void convert_roll(const struct convert_roll *roll, struct grid *g);
/* True if x lacks exactly one step, no wider than the others, to a full circle. Makes room for one
 * more column then. Dies unless x is a circle with or without its last step. */
bool convert_wants_closing(
    const struct convert_options *o, const struct converter *c, struct grid *g);
/* Copies the first column to the end of each row. */
void convert_close(struct grid *g);

#endif
