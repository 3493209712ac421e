/*
 * barbs: World Meteorological Organization, "Manual on the Global Data-processing and Forecasting
 * System", 2010, attachment on the graphical representation of data: the shaft points to where the
 * wind comes from; a half feather is 5 knots, a feather 10, a pennant 50, on the side of low
 * pressure.
 */
#include "layer/layer.h"

#include <stdlib.h>

#define FEATHER .42 /* of the shaft: the length of a feather */
#define LEAN .15    /* of the shaft: how far its tip leans outwards */
#define GAP .15     /* of the shaft: between feathers */
#define CALM .12    /* of the shaft: the radius of a circle without one */
#define POINTS 512

struct pen {
    struct layer_barb b;
    double side; /* of the feathers: 1 left, -1 right, looking with the wind */
    struct layer_point at[POINTS];
    size_t n;
};

/* Adds the point at a part of the shaft from its foot, and so far beside it. */
static void go(struct pen *p, double along, double beside)
{
    const double x = p->b.to.x * p->b.length, y = p->b.to.y * p->b.length;
    beside *= p->side;
    if (p->n < POINTS)
        p->at[p->n++] = (struct layer_point){
            p->b.foot.x - along * x - beside * y, p->b.foot.y - along * y + beside * x};
}

/* Moves inwards after it. */
static void feather(struct pen *p, double *along, double part)
{
    go(p, *along, 0);
    go(p, *along + part * LEAN, part * FEATHER);
    go(p, *along, 0);
    *along -= GAP;
}

static void pennant(struct pen *p, double *along)
{
    go(p, *along, 0);
    go(p, *along + LEAN / 2, FEATHER);
    go(p, *along - GAP, 0);
    *along -= 2 * GAP;
}

static void feathers(struct pen *p, int fives)
{
    double along = fives == 1 ? 1 - GAP : 1; /* a half feather alone is not at the end */
    go(p, 0, 0);
    go(p, 1, 0);
    for (int i = 0; i < fives / 10; i++) pennant(p, &along);
    for (int i = 0; i < fives % 10 / 2; i++) feather(p, &along, 1);
    if (fives % 2) feather(p, &along, .5);
}

static void circle(struct pen *p)
{
    const double turn = 3.14159265358979323846 / 8;
    for (int i = 0; i <= 16; i++) go(p, CALM * cos(i * turn), CALM * sin(i * turn));
}

void layer_barb(const struct layer_barb *b, layer_line *line, void *ctx)
{
    struct pen p = {.b = *b, .side = b->southern ? -1 : 1};
    const int fives = (int)fmin(round(b->knots / 5), 10 * POINTS);
    if (fives) feathers(&p, fives);
    else circle(&p);
    line(ctx, p.at, p.n);
}
