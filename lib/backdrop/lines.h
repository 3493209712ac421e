/* lines: lines and areas, read from text and kept. Private to lib/backdrop. */
#ifndef STORMRING_BACKDROP_LINES_H
#define STORMRING_BACKDROP_LINES_H

#include "backdrop/outline.h"

/* That on which the lines are; NULL: not known, or the map is in degrees. */
const struct plane *lines_plane(const struct backdrop_lines *l);
/* Adds the areas to the list; later areas cover earlier ones. */
void lines_fill(const struct drawing *s, struct backdrop_lines *l);
/* Adds lines, and outlines of the areas that lines_fill found visible, to the list's last mark. */
void lines_stroke(const struct drawing *s, const struct backdrop_lines *l);

#endif
