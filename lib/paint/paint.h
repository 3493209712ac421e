/*
 * paint: paints backgrounds of pictures of grids with Cairo and Pango while a camera moves: what
 * backdrop draws, in the same places; and text over a picture. Pixels are those that Cairo and SDL
 * call ARGB32: premultiplied, in the machine's byte order, row 0 on top. No I/O, except that Pango
 * reads fonts.
 */
#ifndef STORMRING_PAINT_H
#define STORMRING_PAINT_H

#include "backdrop/backdrop.h"

/* The lines of a map, and memory that paintings share. */
struct paint;
/* Reads b->lines, and keeps none of b. NULL with a message in err if they are invalid. */
struct paint *paint_open(const struct backdrop *b, char err[BACKDROP_ERR]);
void paint_free(struct paint *p);

#define PAINT_MAP BACKDROP_MAP   /* the plane of the map, areas and lines */
#define PAINT_AXES BACKDROP_AXES /* edges of the grid, graticule, labels */
#define PAINT_STRIP (BACKDROP_LEGEND | BACKDROP_CAPTION)
/*
 * Paints these parts over the colour of the page, which is opaque: b->w times b->h plus
 * backdrop_strip(b) pixels. b may have another grid, camera and size at each call; b->lines do not
 * count. Its map must be that of paint_open: b->flat NULL, or not; b->proj, and about the same x
 * and y. Returns false, and paints nothing, if a side is more than Cairo's 32767 pixels, or there
 * is no memory.
 */
bool paint_backdrop(struct paint *p, const struct backdrop *b, unsigned parts, uint32_t *argb);
/* True if some lines are at heights. Then paint_raised paints these, which belong over a picture,
 * and makes the other pixels transparent. Otherwise as paint_backdrop. */
bool paint_has_raised(const struct paint *p);
bool paint_raised(struct paint *p, const struct backdrop *b, uint32_t *argb);

enum paint_place { PAINT_TOP_LEFT, PAINT_TOP_RIGHT, PAINT_BOTTOM_LEFT, PAINT_BOTTOM_RIGHT };
/* Paints lines of text in a translucent box in a corner of w times h pixels. The text is smaller if
 * it would not fit. */
bool paint_text(uint32_t *argb, uint32_t w, uint32_t h, const char *text, enum paint_place place);

#endif
