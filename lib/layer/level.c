/* level: the field at a height. */
#include "layer/layer.h"

#include <stdlib.h>

bool layer_level(const struct grid *g, double z, float **value, char err[ERR_BYTES])
{
    const double *at = g->at[2];
    const size_t n = grid_node(g, 0, 0, 1);
    uint32_t k = 0;
    z = grid_within(z, at[0], at[g->n[2] - 1]);
    if (!(z >= at[0] && z <= at[g->n[2] - 1]))
        return err_set(
            err, "%g: expected a height of the grid, from %g to %g", z, at[0], at[g->n[2] - 1]);
    while (k + 1 < g->n[2] && at[k + 1] <= z) k++;
    const float *below = g->value + grid_node(g, 0, 0, k), *above = below + n;
    *value = xmalloc(n, sizeof **value);
    for (size_t i = 0; i < n; i++) {
        (*value)[i] = below[i];
        if (z == at[k]) continue;
        const double f = (z - at[k]) / (at[k + 1] - at[k]);
        (*value)[i] = (float)((1 - f) * (double)below[i] + f * (double)above[i]);
    }
    return true;
}

/* The cell of a place on an axis, and where it is between its planes. False outside. */
static bool find(const double *at, uint32_t n, double v, uint32_t *cell, double *t)
{
    if (!(v >= at[0] && v <= at[n - 1])) return false;
    uint32_t low = 0, high = n - 1;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (at[middle] <= v) low = middle;
        else high = middle;
    }
    *cell = low;
    *t = (v - at[low]) / (at[low + 1] - at[low]);
    return true;
}

/* A neighbour that does not count may be missing. */
static double mix(double a, double b, double t)
{
    return t <= 0 ? a : t >= 1 ? b : a + t * (b - a);
}

double layer_at(const struct grid *g, const float *value, struct layer_point p)
{
    uint32_t i, j;
    double s, t;
    if (!find(g->at[0], g->n[0], p.x, &i, &s) || !find(g->at[1], g->n[1], p.y, &j, &t))
        return (double)NAN;
    const float *v = value + grid_node(g, i, j, 0), *w = v + g->n[0];
    return mix(mix((double)v[0], (double)v[1], s), mix((double)w[0], (double)w[1], s), t);
}
