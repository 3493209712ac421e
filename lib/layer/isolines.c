/*
 * isolines: marching squares. A cell has two points or four on its edges, so each point is in one
 * line. A line is followed from a cell to its neighbour, first one way, then the other.
 */
#include "layer/layer.h"

#include <stdlib.h>

/* Edges of a cell, counterclockwise from the lower one. Corner e is the first of edge e. */
enum edge { LOW, RIGHT, HIGH, LEFT, NO_EDGE };

struct points {
    struct layer_point *at; /* grown by xgrown */
    size_t n;
};
struct tracer {
    const struct grid *g;
    const float *value;
    double v;
    unsigned char *done;  /* for each cell: a bit for each edge whose point is in a line */
    struct points way[2]; /* from the first cell of a line, forwards and backwards */
    struct points whole;
};
struct cell {
    uint32_t i, j;
};

static size_t node(const struct tracer *t, struct cell c, unsigned corner)
{
    const uint32_t right = corner == 1 || corner == 2, high = corner >= 2;
    return grid_node(t->g, c.i + right, c.j + high, 0);
}

static double at_corner(const struct tracer *t, struct cell c, unsigned corner)
{
    return (double)t->value[node(t, c, corner & 3)];
}

static bool is_above(const struct tracer *t, struct cell c, unsigned corner)
{
    return at_corner(t, c, corner) >= t->v;
}

static bool is_crossed(const struct tracer *t, struct cell c, unsigned edge)
{
    return is_above(t, c, edge) != is_above(t, c, edge + 1);
}

/* The sum of the corners; NaN if one is missing. */
static double sum(const struct tracer *t, struct cell c)
{
    return at_corner(t, c, 0) + at_corner(t, c, 1) + at_corner(t, c, 2) + at_corner(t, c, 3);
}

/* The edge at which the line that enters a cell at this one leaves it. */
static unsigned partner(const struct tracer *t, struct cell c, unsigned edge)
{
    unsigned n = 0, other = NO_EDGE;
    for (unsigned e = 0; e < 4; e++)
        if (e != edge && is_crossed(t, c, e)) n++, other = e;
    if (n < 3) return other;
    /* A saddle: lines go round the two corners that are not on the side of the centre. */
    const bool round_first = is_above(t, c, 0) != (sum(t, c) / 4 >= t->v);
    return round_first ? 3 - edge : edge ^ 1;
}

/* From the lower corner of the edge, so that both its cells compute the same point. */
static struct layer_point crossing(const struct tracer *t, struct cell c, unsigned edge)
{
    const bool level = edge == LOW || edge == HIGH;
    const unsigned first = edge == LEFT ? 0 : edge == HIGH ? 3 : edge;
    const unsigned last = edge == LEFT ? 3 : edge == HIGH ? 2 : edge + 1;
    const double a = at_corner(t, c, first), f = (t->v - a) / (at_corner(t, c, last) - a);
    const double *x = t->g->at[0] + c.i, *y = t->g->at[1] + c.j;
    return (struct layer_point){level ? x[0] + f * (x[1] - x[0]) : x[edge == RIGHT],
        level ? y[edge == HIGH] : y[0] + f * (y[1] - y[0])};
}

static void add(struct points *p, struct layer_point at)
{
    if (p->n && p->at[p->n - 1].x == at.x && p->at[p->n - 1].y == at.y) return;
    p->at = xgrown(p->at, p->n, sizeof *p->at);
    p->at[p->n++] = at;
}

/* Moves to the cell beyond an edge. False at the edge of the grid and at a cell without all its
 * corners. */
static bool step(const struct tracer *t, struct cell *c, unsigned edge)
{
    if ((edge == LEFT && !c->i) || (edge == LOW && !c->j)) return false;
    c->i += (edge == RIGHT) - (uint32_t)(edge == LEFT);
    c->j += (edge == HIGH) - (uint32_t)(edge == LOW);
    return c->i + 1 < t->g->n[0] && c->j + 1 < t->g->n[1] && !isnan(sum(t, *c));
}

static unsigned char *done_of(const struct tracer *t, struct cell c)
{
    return &t->done[(size_t)c.j * t->g->n[0] + c.i];
}

/* Follows a line that leaves cell c at this edge, until it ends or comes back to where it was. */
static void follow(const struct tracer *t, struct cell c, unsigned edge, struct points *p)
{
    p->n = 0;
    for (;;) {
        add(p, crossing(t, c, edge));
        *done_of(t, c) |= (unsigned char)(1u << edge);
        if (!step(t, &c, edge)) return;
        edge ^= 2; /* the same edge, of the next cell */
        if (*done_of(t, c) & 1u << edge) return;
        *done_of(t, c) |= (unsigned char)(1u << edge);
        edge = partner(t, c, edge);
    }
}

/* A line that is closed comes back to the other edge of its first cell. */
static void trace(struct tracer *t, struct cell c, unsigned edge, layer_line *line, void *ctx)
{
    const unsigned other = partner(t, c, edge);
    *done_of(t, c) |= (unsigned char)(1u << other);
    follow(t, c, edge, &t->way[0]);
    follow(t, c, other, &t->way[1]);
    t->whole.n = 0;
    for (size_t i = t->way[1].n; i; i--) add(&t->whole, t->way[1].at[i - 1]);
    for (size_t i = 0; i < t->way[0].n; i++) add(&t->whole, t->way[0].at[i]);
    if (t->whole.n > 1) line(ctx, t->whole.at, t->whole.n);
}

void layer_isolines(const struct grid *g, const float *value, double v, layer_line *line, void *ctx)
{
    struct tracer t = {.g = g, .value = value, .v = v};
    t.done = xcalloc(grid_node(g, 0, 0, 1), sizeof *t.done);
    for (uint32_t j = 0; j + 1 < g->n[1]; j++)
        for (uint32_t i = 0; i + 1 < g->n[0]; i++) {
            const struct cell c = {i, j};
            if (isnan(sum(&t, c))) continue;
            for (unsigned e = 0; e < 4; e++)
                if (is_crossed(&t, c, e) && !(*done_of(&t, c) & 1u << e))
                    trace(&t, c, e, line, ctx);
        }
    free(t.done);
    free(t.way[0].at);
    free(t.way[1].at);
    free(t.whole.at);
}
