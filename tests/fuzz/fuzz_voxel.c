/*
 * Whatever the bytes: voxel_read returns a message, or arrays; each becomes a grid whose axes
 * ascend, only z perhaps with one node, and whose values are in range, or a message.
 */
#include "voxel/voxel.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MUST(x)                                                                                    \
    do {                                                                                           \
        if (!(x)) fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #x), abort();   \
    } while (0)
#define NODES_MAX (1U << 22) /* larger ones would only take time */

static void check_message(const char *err)
{
    MUST(strncmp(err, "fuzz:", 5) == 0 && strlen(err) > 8 && strlen(err) < ERR_BYTES);
}

static void check_grid(const struct grid *g)
{
    const size_t n = grid_node(g, 0, 0, g->n[2]);
    for (int a = 0; a < 3; a++) {
        MUST(g->n[a] >= 1 + (a < 2));
        MUST(g->n[a] == 1 || g->at[a][0] < g->at[a][1]);
        MUST(grid_axis_fault(g->at[a], g->n[a]) == 0);
        MUST(fabs(g->at[a][0]) <= GRID_MAX && fabs(g->at[a][g->n[a] - 1]) <= GRID_MAX);
    }
    for (size_t i = 0; i < n; i++)
        MUST(isnan(g->value[i]) || fabsf(g->value[i]) <= (float)GRID_MAX);
    MUST(memchr(g->name, '\0', GRID_NAME));
}

static void check_array(const struct voxel *v, size_t i)
{
    const struct voxel_about a = voxel_array(v, i);
    uint64_t n = a.components;
    for (int axis = 0; axis < 3; axis++) n *= a.n[axis];
    MUST(a.components && voxel_find(v, a.name) <= i);
    if (n > NODES_MAX) return;
    for (int way = 0; way < 4; way++) {
        struct grid g;
        struct buf title = {0};
        char err[ERR_BYTES] = "";
        const uint64_t component = way & 1 ? VOXEL_LENGTH : a.components - 1;
        if (voxel_grid(v, i, component, way & 2, &g, err)) {
            check_grid(&g);
            voxel_title(v, &g, NULL, way & 2, &title);
            grid_free(&g);
        } else {
            check_message(err);
            MUST(!g.value && !g.at[0] && !g.at[1] && !g.at[2]);
        }
        buf_free(&title);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char err[ERR_BYTES] = "";
    /* Exactly as long as the bytes, so that a read past them is seen. */
    unsigned char *bytes = xmalloc(size, 1);
    if (size) memcpy(bytes, data, size);
    struct voxel *v = voxel_read("fuzz", NULL, bytes, size, err);
    if (!v) check_message(err);
    for (size_t i = 0; v && i < voxel_arrays(v) && i < 8; i++) check_array(v, i);
    voxel_free(v);
    free(bytes);
    return 0;
}
