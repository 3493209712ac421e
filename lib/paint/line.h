/*
 * line: thin lines with smooth edges. Cairo strokes short pieces by an outline around each, which
 * takes ten times as long: most of the time of a picture with coasts. Private to lib/paint.
 */
#ifndef STORMRING_PAINT_LINE_H
#define STORMRING_PAINT_LINE_H

#include "backdrop/backdrop.h"

/* How much of each pixel lines cover, 0 to 255: the most of all lines, so that no joint is seen. */
struct cover {
    uint8_t *at;
    uint32_t w, h;
    uint32_t first, end; /* the rows that lines have met */
};
/* Draws a line between two points, in pixels with y downwards, which are near the picture. */
void paint_line(struct cover *c, struct backdrop_at p, struct backdrop_at q, double width);
/* Paints a colour where lines are, and clears them. */
void paint_covered(struct cover *c, uint32_t rgb, uint32_t *argb);

#endif
