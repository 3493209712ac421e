/*
 * circle: further grids of a file that begin elsewhere on the globe. Their columns are moved by
 * whole circles to the first grid's longitudes.
 */
#include "grid/vtk_text.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define CIRCLE 360
#define SLACK .01     /* of a step: coordinates are rounded, to float or to some decimals */
#define COLUMNS 3     /* of a globe, at least */
#define COLUMNS_MAX 16777216
#define FARTHEST 1080 /* from 0: numbers beyond it are no longitudes */

static bool in_degrees(const struct grid *g)
{
    struct grid_named x;
    if (g->at[0][0] < -FARTHEST || g->at[0][g->n[0] - 1] > FARTHEST) return false;
    return grid_title(g->title, 'x', &x) && strncasecmp(x.unit, "degree", 6) == 0;
}

static double greatest_step(const struct grid *g, int axis)
{
    double step = 0;
    for (uint32_t i = 1; i < g->n[axis]; i++)
        step = fmax(step, g->at[axis][i] - g->at[axis][i - 1]);
    return step;
}

/* Columns of a grid in another order. of[i]: the old number of column i; NONE: it has no value. */
#define NONE UINT32_MAX
struct columns {
    double *at;
    uint32_t *of, n;
};

/* Columns that rounding puts into one place become one. */
static void add_column(struct columns *c, double at, uint32_t of)
{
    if (c->n && !(at - c->at[c->n - 1] >= GRID_STEP_MIN)) return;
    c->at = xgrown(c->at, c->n, sizeof *c->at);
    c->of = xgrown(c->of, c->n, sizeof *c->of);
    c->at[c->n] = at;
    c->of[c->n++] = of;
}

/* Gives g these columns, which it then owns. */
static void take_columns(struct grid *g, struct columns *c)
{
    const size_t rows = (size_t)g->n[1] * g->n[2], n = g->n[0];
    float *value = xmalloc(rows * c->n, sizeof *value);
    for (size_t row = 0; row < rows; row++)
        for (size_t i = 0; i < c->n; i++)
            value[row * c->n + i] = c->of[i] == NONE ? NAN : g->value[row * n + c->of[i]];
    free(g->value);
    free(g->at[0]);
    free(c->of);
    g->value = value;
    g->at[0] = c->at;
    g->n[0] = c->n;
}

/* ---- a ground -------------------------------------------------------------------------------- */

/* The columns before a whole circle has passed. */
static uint32_t columns_of_circle(const struct grid *g, double slack)
{
    uint32_t n = 0;
    while (n < g->n[0] && g->at[0][n] < g->at[0][0] + CIRCLE - slack) n++;
    return n;
}

/* Copies of the ground, one for each circle: the columns between lo and hi, and the next ones.
 * Those of a part of the globe do not meet: a column without values keeps them apart. */
static struct columns columns_between(
    const struct grid *g, uint32_t n, bool globe, double lo, double hi)
{
    struct columns c = {.n = 0};
    const double *x = g->at[0], room = globe ? x[0] + CIRCLE - x[n - 1] : 0;
    const double first = floor((lo - x[n - 1]) / CIRCLE);
    for (uint32_t k = 0; x[0] + CIRCLE * (first + k) - room < hi; k++)
        for (uint32_t i = 0; i < n; i++) {
            const double turn = CIRCLE * (first + k);
            const double at = x[i] + turn;
            const double before = i ? x[i - 1] + turn : at - room;
            const double after = i + 1 < n ? x[i + 1] + turn : at + room;
            if (after <= lo || before >= hi) continue;
            if (!globe && i == 0 && c.n) add_column(&c, (c.at[c.n - 1] + at) / 2, NONE);
            add_column(&c, at, i);
        }
    return c;
}

void grid_turn_ground(struct grid *ground, const struct grid *g)
{
    const double *x = ground->at[0], lo = g->at[0][0], hi = g->at[0][g->n[0] - 1];
    const double step = greatest_step(ground, 0), slack = SLACK * step;
    if (!in_degrees(g) || !in_degrees(ground) || ground->n[0] > COLUMNS_MAX) return;
    if (x[0] <= lo && x[ground->n[0] - 1] >= hi) return;
    const uint32_t n = columns_of_circle(ground, slack);
    const bool globe = n >= COLUMNS && x[0] + CIRCLE - x[n - 1] <= step + slack;
    /* A part of the globe stays in place, unless a copy of it is between lo and hi. */
    if (!globe && x[0] + CIRCLE >= hi && x[n - 1] - CIRCLE <= lo && x[0] < hi && x[n - 1] > lo)
        return;
    struct columns c = columns_between(ground, n, globe, lo, hi);
    if (c.n > 1) take_columns(ground, &c);
    else free(c.at), free(c.of);
}

/* True for the columns of the ground that have a value. */
static bool *full_columns(const struct grid *ground)
{
    const uint32_t n = ground->n[0];
    bool *full = xcalloc(n, sizeof *full);
    for (size_t i = 0; i < grid_node(ground, 0, 0, 1); i++)
        if (!isnan(ground->value[i])) full[i % n] = true;
    return full;
}

double grid_over_ground(const struct grid *g)
{
    const struct grid *ground = g->ground;
    double share = 1;
    bool *full = full_columns(ground);
    for (int a = 0; a < 2; a++) {
        const double *at = ground->at[a], step = greatest_step(ground, a);
        const uint32_t n = ground->n[a];
        uint32_t covered = 0, cell = 0; /* a step beyond the ends counts as covered */
        for (uint32_t i = 0; i < g->n[a]; i++) {
            const double p = g->at[a][i];
            while (cell + 2 < n && p >= at[cell + 1]) cell++;
            covered += p >= at[0] - step && p <= at[n - 1] + step &&
                       (a == 1 || (full[cell] && full[cell + 1]));
        }
        share *= (double)covered / g->n[a];
    }
    free(full);
    return share;
}

/* ---- a second field -------------------------------------------------------------------------- */

/* The column of h at this longitude, or NONE. */
static uint32_t column_at(const struct grid *h, double x, double slack)
{
    const double *at = h->at[0];
    x -= CIRCLE * floor((x - at[0] + slack) / CIRCLE);
    uint32_t low = 0, high = h->n[0] - 1;
    while (low < high) {
        const uint32_t mid = low + (high - low) / 2;
        if (at[mid] < x - slack) low = mid + 1;
        else high = mid;
    }
    return fabs(at[low] - x) <= slack ? low : NONE;
}

void grid_turn_second(struct grid *h, const struct grid *g)
{
    struct columns c = {.n = 0};
    const double slack = SLACK * greatest_step(g, 0);
    if (!in_degrees(g) || !in_degrees(h)) return;
    for (uint32_t i = 0; i < g->n[0]; i++) {
        const uint32_t of = column_at(h, g->at[0][i], slack);
        if (of == NONE) break;
        add_column(&c, g->at[0][i], of);
    }
    if (c.n == g->n[0]) take_columns(h, &c);
    else free(c.at), free(c.of);
}
