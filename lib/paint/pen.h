/* pen: what the files of paint share: Cairo's surface over an array of pixels; text by Pango. */
#ifndef STORMRING_PAINT_PEN_H
#define STORMRING_PAINT_PEN_H

#include "paint/paint.h"

#include <pango/pangocairo.h>

/* NULL if Cairo refuses the size. */
cairo_t *paint_pen(uint32_t *argb, uint32_t w, uint32_t h);
/* Waits until all is in the pixels. False if there was no memory. */
bool paint_pen_free(cairo_t *cr);
PangoLayout *paint_layout(void);
/* Sets text, of which what is no UTF-8 is replaced, and its size in pixels. */
void paint_layout_set(PangoLayout *layout, const char *text, double em);

#endif
