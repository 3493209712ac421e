/* lines: the text of lines and areas, to gnuplot's data. Private to lib/backdrop. */
#ifndef STORMRING_BACKDROP_LINES_H
#define STORMRING_BACKDROP_LINES_H

#include "backdrop/outline.h"

struct lines {
    struct buf strokes; /* of lines, and around areas */
    struct buf areas;   /* blocks $area0, $area1 ...: what follows lies over what came before */
    bool *is_water;     /* of each block: else land */
    int n_areas, room;
};

/* s->b->lines; false with text in err where they are no such text. To be freed in either case. */
bool lines_read(const struct drawing *s, struct lines *l, char err[BACKDROP_ERR]);
void lines_free(struct lines *l);

#endif
