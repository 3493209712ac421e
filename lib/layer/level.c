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
        return err_set(err, "%g: expected a height of the grid, from %g to %g", z, at[0],
            at[g->n[2] - 1]);
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
