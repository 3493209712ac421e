/* A grid as POV-Ray's density file. */
#include "grid/grid.h"
#include "grid/vtk_type.h"

#include <math.h>

static void put_number(struct buf *b, uint32_t v, int size)
{
    unsigned char bytes[4];
    put_big_endian(bytes, v, size);
    buf_append(b, bytes, (size_t)size);
}

/* True if the cell above this node exists and has all its corners. */
static bool cell_there(const struct grid *g, uint32_t i, uint32_t j, uint32_t k)
{
    if (i + 1 == g->n[0] || j + 1 == g->n[1] || k + 1 == g->n[2]) return false;
    for (uint32_t c = 0; c < 8; c++)
        if (isnan(g->value[grid_node(g, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))]))
            return false;
    return true;
}

void grid_df3(const struct grid *g, double least, double most, bool mask, struct buf *out)
{
    size_t nodes = grid_node(g, 0, 0, g->n[2]);
    for (int a = 0; a < 3; a++) put_number(out, a == 2 && mask ? 2 * g->n[a] : g->n[a], 2);
    for (size_t i = 0; i < nodes; i++) {
        double v = ((double)g->value[i] - least) / (most - least);
        put_number(out, isnan(v) ? 0 : (uint32_t)(v * UINT32_MAX + 0.5), 4);
    }
    for (uint32_t k = 0; mask && k < g->n[2]; k++)
        for (uint32_t j = 0; j < g->n[1]; j++)
            for (uint32_t i = 0; i < g->n[0]; i++)
                put_number(out, cell_there(g, i, j, k) ? UINT32_MAX : 0, 4);
}
