/*
 * Whatever the bytes: grid_read returns a grid or a message. What it accepts is in range, ascends,
 * and survives being written and read again.
 */
#include "grid/grid.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MUST(x)                                                                                    \
    do {                                                                                           \
        if (!(x)) fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #x), abort();   \
    } while (0)

static void check_grid(const struct grid *g, size_t size)
{
    size_t n = grid_node(g, 0, 0, g->n[2]);
    MUST(n >= 8 && n <= size);
    for (int a = 0; a < 3; a++) {
        MUST(g->n[a] >= 2 && g->at[a][0] < g->at[a][1]);
        MUST(grid_axis_fault(g->at[a], g->n[a]) == 0);
        MUST(fabs(g->at[a][0]) <= GRID_MAX && fabs(g->at[a][g->n[a] - 1]) <= GRID_MAX);
    }
    for (size_t i = 0; i < n; i++)
        MUST(isnan(g->value[i]) || fabsf(g->value[i]) <= (float)GRID_MAX);
    for (int a = 0; g->brick.is && a < 3; a++)
        MUST(g->brick.own[a][0] < g->brick.own[a][1] && g->brick.own[a][1] < g->n[a]);
    for (size_t i = 0; g->second && i < n; i++) {
        MUST(isnan(g->second[i]) == isnan(g->value[i]));
        MUST(isnan(g->second[i]) || fabsf(g->second[i]) <= (float)GRID_MAX);
    }
    MUST(!g->ground || (g->ground->n[2] == 1 && g->ground->n[0] >= 2 && g->ground->n[1] >= 2));
    for (int a = 0; g->ground && a < 2; a++)
        MUST(grid_axis_fault(g->ground->at[a], g->ground->n[a]) == 0);
    MUST(memchr(g->name, '\0', GRID_NAME));
    const double first[] = {g->at[0][0], g->at[1][0], g->at[2][0]};
    const double v = grid_at(g, first);
    MUST(isnan(v) || (float)v == g->value[0]);
}

static void check_round_trip(const struct grid *g)
{
    struct grid again;
    struct buf b = {0}, twice = {0};
    char err[ERR_BYTES];
    grid_write(g, "title", &b);
    MUST(grid_read("again", buf_data(&b), buf_size(&b), &again, err) == 0);
    grid_write(&again, "title", &twice);
    MUST(buf_size(&b) == buf_size(&twice));
    MUST(memcmp(buf_data(&b), buf_data(&twice), buf_size(&b)) == 0);
    grid_free(&again);
    buf_free(&b);
    buf_free(&twice);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct grid g;
    char err[ERR_BYTES];
    /* Exactly as long as the bytes, so that a read past them is seen. */
    unsigned char *bytes = xmalloc(size, 1);
    if (size) memcpy(bytes, data, size);
    int rc = grid_read("fuzz", bytes, size, &g, err);
    free(bytes);
    if (rc != 0) {
        MUST(strncmp(err, "fuzz:", 5) == 0 && strlen(err) > 8);
        MUST(!g.value && !g.second && !g.ground && !g.at[0] && !g.at[1] && !g.at[2]);
        return 0;
    }
    check_grid(&g, size);
    check_round_trip(&g);
    grid_free(&g);
    return 0;
}
