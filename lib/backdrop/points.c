/* points: the points of an outline. */
#include "backdrop/outline.h"

#include <stdlib.h>

void outline_append(struct outline *o, struct outline_point p)
{
    if (o->n == o->room) {
        o->room = o->room ? 2 * o->room : 256;
        o->at = xrealloc(o->at, o->room, sizeof *o->at);
    }
    o->at[o->n++] = p;
}

void outline_add(struct outline *o, struct outline_point p)
{
    double before = o->n ? o->at[o->n - 1].x : 0;
    if (!o->flat) p.x += 360 * round((before - p.x) / 360);
    outline_append(o, p);
}

void outline_free(struct outline *o)
{
    free(o->at);
    *o = (struct outline){.flat = o->flat};
}
