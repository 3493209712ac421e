/* points: the points of an outline. */
#include "backdrop/outline.h"

#include <stdlib.h>

void outline_append(struct outline *o, struct outline_point p)
{
    o->at = xgrown(o->at, o->n, sizeof *o->at);
    o->at[o->n++] = p;
}

void outline_add(struct outline *o, struct outline_point p)
{
    double before = o->n ? o->at[o->n - 1].x : 0;
    if (!o->flat) p.x += 360 * round((before - p.x) / 360);
    outline_append(o, p);
}

void outline_bound(struct outline *o)
{
    o->lo = (struct outline_point){HUGE_VAL, HUGE_VAL};
    o->hi = (struct outline_point){-HUGE_VAL, -HUGE_VAL};
    for (const struct outline_point *p = o->at; p < o->at + o->n; p++) {
        o->lo = (struct outline_point){fmin(o->lo.x, p->x), fmin(o->lo.y, p->y)};
        o->hi = (struct outline_point){fmax(o->hi.x, p->x), fmax(o->hi.y, p->y)};
    }
}

void outline_free(struct outline *o)
{
    free(o->at);
    *o = (struct outline){.flat = o->flat};
}
