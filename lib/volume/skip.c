/*
 * skip: which cells show something: none of their corners is missing, and the map absorbs, or an
 * iso-surface has its value, somewhere between the least and the greatest of them. A trilinear
 * field is within its corners' range, so that what is skipped is exactly clear.
 */
#include "volume/volume_int.h"

/* The range of a cell's corners; false where one is missing. */
static bool range(const struct volume *v, const float *f, double *lo, double *hi)
{
    *lo = HUGE_VAL, *hi = -HUGE_VAL;
    for (int corner = 0; corner < 8; corner++) {
        double s = (double)f[(corner & 1) * v->stride[0] + (corner >> 1 & 1) * v->stride[1] +
                             (corner >> 2) * v->stride[2]];
        if (!isfinite(s)) return false;
        *lo = s < *lo ? s : *lo;
        *hi = s > *hi ? s : *hi;
    }
    return true;
}

static bool seen(const struct volume *v, double lo, double hi)
{
    for (size_t i = 0; i < v->spec->n_isos; i++) {
        double s = v->spec->iso[i].s;
        if (lo <= s && s <= hi) return true;
    }
    return map_absorbs(&v->map, lo, hi);
}

void skip_init(struct volume *v)
{
    size_t n_blocks = 1, n_nodes = 1;
    for (int a = 0; a < 3; a++) {
        v->blocks[a] = ((v->cells[a] - 1) >> BLOCK_SHIFT) + 1;
        n_blocks *= v->blocks[a];
        n_nodes *= v->cells[a] + 1;
    }
    v->live = xcalloc(n_nodes / 8 + 8, 1);
    v->block = xcalloc(n_blocks, 1);
    int32_t i[3];
    for (i[2] = 0; i[2] < (int32_t)v->cells[2]; i[2]++)
        for (i[1] = 0; i[1] < (int32_t)v->cells[1]; i[1]++)
            for (i[0] = 0; i[0] < (int32_t)v->cells[0]; i[0]++) {
                double lo, hi;
                const float *f =
                    v->first + i[0] * v->stride[0] + i[1] * v->stride[1] + i[2] * v->stride[2];
                if (!range(v, f, &lo, &hi) || !seen(v, lo, hi)) continue;
                v->range = fmax(v->range, hi - lo);
                size_t cell = cell_index(v, i);
                v->live[cell >> 3] |= (uint8_t)(1u << (cell & 7));
                v->block[block_index(v, i)] = 1;
            }
}
