/*
 * vtk_brick: the two arrays by which a file says that it is a brick: the bounds of the whole grid,
 * and those of the brick's own cells. Each has six numbers: x from and to, y, z.
 */
#include "grid/vtk_text.h"

#include <string.h>

enum { WHOLE, OWN };
const char *const vtk_brick_names[2] = {"brick_whole", "brick_own"};

bool vtk_brick_array(
    struct vtk_reader *r, const char *name, struct vtk_type t, uint64_t count, bool *good)
{
    int which = strcmp(name, vtk_brick_names[WHOLE]) == 0 ? WHOLE : OWN;
    if (strcmp(name, vtk_brick_names[which]) != 0) return false;
    *good = false;
    if (count != 6 || r->has[which]) {
        vtk_fail(r, "%s: %s, expected six numbers, once", name, count == 6 ? "twice" : "no bounds");
        return true;
    }
    r->has[which] = *good = true;
    for (int i = 0; i < 6 && *good; i++) *good = vtk_number(r, name, t, &r->bounds[which][i]);
    return true;
}

/* The plane at a coordinate; n if there is none. */
static uint32_t plane_at(const double *at, uint32_t n, double coordinate)
{
    uint32_t lo = 0, hi = n;
    while (lo < hi) {
        uint32_t mid = lo + (hi - lo) / 2;
        if (at[mid] < coordinate) lo = mid + 1;
        else hi = mid;
    }
    return lo < n && at[lo] == coordinate ? lo : n;
}

/* The overlap has at least a layer of cells where the whole grid goes on. */
static bool take_axis(const struct vtk_reader *r, int a, struct grid *g)
{
    const double *at = g->at[a];
    const uint32_t n = g->n[a];
    struct grid_brick *b = &g->brick;
    for (int end = 0; end < 2; end++) {
        double own = r->bounds[OWN][2 * a + end];
        b->whole[a][end] = r->bounds[WHOLE][2 * a + end];
        b->own[a][end] = plane_at(at, n, own);
        if (b->own[a][end] == n) return false;
        if (own != b->whole[a][end] && b->own[a][end] == (end ? n - 1 : 0)) return false;
    }
    return b->own[a][0] < b->own[a][1] && b->whole[a][0] <= at[0] && b->whole[a][1] >= at[n - 1];
}

bool vtk_brick(struct vtk_reader *r, struct grid *g)
{
    if (!r->has[WHOLE] && !r->has[OWN]) return true;
    g->brick.is = r->has[WHOLE] && r->has[OWN];
    for (int a = 0; a < 3; a++)
        if (!g->brick.is || !take_axis(r, a, g))
            return vtk_fail(r,
                "%s and %s do not fit %c, expected bounds of a grid around this one, and planes "
                "within it, as gridcut writes them",
                vtk_brick_names[WHOLE], vtk_brick_names[OWN], "xyz"[a]);
    return true;
}
