/*
 * walk: from cell to cell. Where the ray meets a plane is computed from the plane's own coordinate
 * each time, never by adding steps (as J. Amanatides and A. Woo, "A fast voxel traversal algorithm
 * for ray tracing", Eurographics 1987, may on even grids): it is the same number for the cells on
 * both sides, and errors do not add up. The origin is moved to where the ray enters the grid, so
 * that an eye far away costs no digits inside.
 */
#include "volume/volume_int.h"

#include <stdlib.h>

/* Slopes below this move a ray by nothing in any grid; their reciprocals would overflow. */
#define LEVEL 1e-200

/* Where plane i of an axis is met. */
static double met(const struct walk *w, int a, int32_t i)
{
    return (w->v->plane[a][i] - w->o[a]) * w->inv[a];
}

/* Where the ray leaves cell i along an axis. */
static double leaves(const struct walk *w, int a, int32_t i)
{
    return w->step[a] == 0 ? HUGE_VAL : met(w, a, w->step[a] > 0 ? i + 1 : i);
}

/* The first cell along an axis that is not left at 0 yet; in cells of the upper side where the ray
 * runs in a plane. */
static int32_t first_cell(const struct walk *w, int a)
{
    int32_t lo = 0, hi = (int32_t)w->v->cells[a] - 1; /* the answer is in lo .. hi */
    const double *plane = w->v->plane[a];
    while (lo < hi) {
        int32_t mid = (lo + hi) / 2;
        bool above = w->step[a] < 0 ? plane[mid + 1] < w->o[a] : plane[mid + 1] <= w->o[a];
        if (above) lo = mid + 1;
        else hi = mid;
    }
    return lo;
}

/* The stretch of the ray within the grid; false when there is none. */
static bool clip(struct walk *w, double *in)
{
    double near = 0, far = HUGE_VAL;
    for (int a = 0; a < 3; a++) {
        int32_t last = (int32_t)w->v->cells[a];
        const double *plane = w->v->plane[a];
        if (w->step[a] == 0) {
            if (!(w->o[a] >= plane[0] && w->o[a] <= plane[last])) return false;
            continue;
        }
        near = fmax(near, met(w, a, w->step[a] > 0 ? 0 : last));
        far = fmin(far, met(w, a, w->step[a] > 0 ? last : 0));
    }
    *in = near;
    return near < far;
}

bool walk_begin(struct walk *w, const struct volume *v, struct vec3 eye, struct vec3 dir)
{
    const double o[3] = {eye.x, eye.y, eye.z}, d[3] = {dir.x, dir.y, dir.z};
    *w = (struct walk){.v = v};
    for (int a = 0; a < 3; a++) {
        w->o[a] = o[a];
        w->step[a] = (d[a] > LEVEL) - (d[a] < -LEVEL);
        w->d[a] = w->step[a] ? d[a] : 0;
        w->inv[a] = w->step[a] ? 1 / d[a] : 0;
    }
    if (!clip(w, &w->before)) return false;
    double at[3];
    for (int a = 0; a < 3; a++) {
        const double *plane = v->plane[a];
        double low = plane[0], high = plane[v->cells[a]];
        at[a] = o[a] + w->before * w->d[a];
        /* The plane where it enters, exactly; and rounding takes no ray out. */
        if (w->before > 0 && w->before == met(w, a, w->step[a] > 0 ? 0 : (int32_t)v->cells[a]))
            at[a] = w->step[a] > 0 ? low : high;
        at[a] = at[a] < low ? low : at[a] > high ? high : at[a];
    }
    for (int a = 0; a < 3; a++) w->o[a] = at[a];
    for (int a = 0; a < 3; a++) {
        w->i[a] = first_cell(w, a);
        w->next[a] = leaves(w, a, w->i[a]);
    }
    return true;
}

/* Past every plane that is met at or before t. */
static void pass(struct walk *w, double t)
{
    for (int a = 0; a < 3; a++)
        while (w->next[a] <= t) {
            w->i[a] += w->step[a];
            if (w->i[a] < 0 || w->i[a] >= (int32_t)w->v->cells[a]) {
                w->out = true;
                return;
            }
            w->next[a] = leaves(w, a, w->i[a]);
        }
    w->t = t;
}

/* Where the block is left. */
static double block_end(const struct walk *w)
{
    double end = HUGE_VAL;
    for (int a = 0; a < 3; a++) {
        int32_t last = (int32_t)w->v->cells[a] - 1, lo = w->i[a] >> BLOCK_SHIFT << BLOCK_SHIFT;
        int32_t hi = lo + (1 << BLOCK_SHIFT) - 1;
        end = fmin(end, leaves(w, a, w->step[a] > 0 ? (hi < last ? hi : last) : lo));
    }
    return end;
}

bool walk_next(struct walk *w, double *t0, double *t1)
{
    if (w->end > w->t) pass(w, w->end);
    while (!w->out) {
        if (!w->v->block[block_index(w->v, w->i)]) {
            int32_t was[3] = {w->i[0], w->i[1], w->i[2]};
            pass(w, block_end(w));
            for (int a = 0; a < 3; a++) w->passed += (uint32_t)abs(w->i[a] - was[a]);
            continue;
        }
        double end = fmin(fmin(w->next[0], w->next[1]), w->next[2]);
        bool real = end > w->t;
        w->passed += real;
        if (real && cell_live(w->v, cell_index(w->v, w->i))) {
            *t0 = w->t;
            *t1 = w->end = end;
            return true;
        }
        pass(w, end);
    }
    return false;
}
