/* grid: the axes of a scalar field and its value at a point. */
#include "grid/grid.h"

#include <stdlib.h>

void grid_free(struct grid *g)
{
    for (int a = 0; a < 3; a++) free(g->at[a]);
    free(g->value);
    free(g->second);
    if (g->ground) grid_free(g->ground);
    free(g->ground);
    *g = (struct grid){0};
}

uint32_t grid_axis_fault(const double *at, uint32_t n)
{
    bool down = n > 1 && at[1] < at[0];
    for (uint32_t i = 1; i < n; i++) {
        double step = down ? at[i - 1] - at[i] : at[i] - at[i - 1];
        if (!(step >= GRID_STEP_MIN)) return i;
    }
    return 0;
}

void grid_axis_why(const double *at, uint32_t fault, char why[GRID_FAULT])
{
    double a = at[fault], b = at[fault - 1], step = fabs(a - b);
    if (step > 0 && step < GRID_STEP_MIN)
        snprintf(why, GRID_FAULT, "%.17g after %.17g, expected steps of %g at least", a, b,
            GRID_STEP_MIN);
    else
        snprintf(
            why, GRID_FAULT, "%.9g after %.9g, expected all to ascend or all to descend", a, b);
}

#define DIGITS 1e-5 /* of a number: what six digits of it leave out */
#define SLIGHT 1e-4 /* of the axis: more is another place */

double grid_within(double v, double lo, double hi)
{
    const double most = SLIGHT * (hi - lo);
    if (v < lo && lo - v <= fmin(DIGITS * fabs(lo), most)) return lo;
    return v > hi && v - hi <= fmin(DIGITS * fabs(hi), most) ? hi : v;
}

/* Finds the cell of p on an axis and the position in it, 0 .. 1. False outside. */
static bool find_cell(const double *at, uint32_t n, double p, uint32_t *cell, double *t)
{
    if (!(p >= at[0] && p <= at[n - 1])) return false;
    uint32_t low = 0, high = n - 1;
    while (high - low > 1) {
        uint32_t mid = low + (high - low) / 2;
        if (p >= at[mid]) low = mid;
        else high = mid;
    }
    *cell = low;
    *t = (p - at[low]) / (at[low + 1] - at[low]);
    return true;
}

static double mix(double a, double b, double t) { return a + (b - a) * t; }
/* Interpolates between two neighbours along x. */
static double mix_at(const float *v, double t) { return mix((double)v[0], (double)v[1], t); }

double grid_at(const struct grid *g, const double p[3])
{
    uint32_t c[3];
    double t[3], side[2];
    for (int a = 0; a < 3; a++)
        if (!find_cell(g->at[a], g->n[a], p[a], &c[a], &t[a])) return (double)NAN;
    for (uint32_t k = 0; k < 2; k++) {
        const float *v = g->value + grid_node(g, c[0], c[1], c[2] + k), *w = v + g->n[0];
        side[k] = mix(mix_at(v, t[0]), mix_at(w, t[0]), t[1]);
    }
    return mix(side[0], side[1], t[2]);
}
