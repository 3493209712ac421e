/* lines: converts the text of lines and areas to gnuplot data. Private to lib/backdrop. */
#ifndef STORMRING_BACKDROP_LINES_H
#define STORMRING_BACKDROP_LINES_H

#include "backdrop/outline.h"

struct lines {
    struct buf strokes; /* lines and outlines of areas */
    struct buf areas;   /* blocks $area0, $area1 ...: later areas cover earlier ones */
    bool *is_water;     /* per block: water; otherwise land */
    int n_areas, room;
};

/* Reads s->b->lines. False with a message in err if the text is invalid. Call lines_free in either
 * case. */
bool lines_read(const struct drawing *s, struct lines *l, char err[BACKDROP_ERR]);
void lines_free(struct lines *l);

#endif
