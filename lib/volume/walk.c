/*
 * walk: from cell to cell. Where the ray meets a plane is computed from the plane's own coordinate
 * each time, never by adding steps (as J. Amanatides and A. Woo, "A fast voxel traversal algorithm
 * for ray tracing", Eurographics 1987, may on even grids): it is the same number for the cells on
 * both sides, and errors do not add up. The origin is moved to where the ray enters the grid, so
 * that an eye far away costs no digits inside.
 */
#include "volume/volume_int.h"

/* Slopes below this move a ray by nothing in any grid; their reciprocals would overflow. */
#define LEVEL 1e-200

/* Where plane i of an axis is met. */
static double met(const struct walk *w, int a, int32_t i)
{
    return (w->v->plane[a][i] - w->o[a]) * w->inv[a];
}

/* Where the plane n beyond the next one is met. */
static inline double ahead(const struct walk *w, int a, ptrdiff_t n)
{
    return (w->plane[a][n * w->step[a]] - w->start[a]) * w->inv[a];
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

/* Where the ray is along an axis, and where it goes next. */
static void begin_axis(struct walk *w, int a)
{
    const struct volume *v = w->v;
    const size_t stride[3] = {1, v->cells[0], (size_t)v->cells[0] * v->cells[1]};
    size_t i = (size_t)first_cell(w, a), exit = w->step[a] > 0 ? v->cells[a] : 0;
    w->cell += i * stride[a];
    w->to_cell[a] = w->step[a] * (ptrdiff_t)stride[a];
    w->zero[a] = v->plane[a] + (w->step[a] > 0);
    w->plane[a] = w->zero[a] + i;
    w->start[a] = w->o[a];
    if (w->step[a] == 0) w->inv[a] = 1, w->start[a] = -HUGE_VAL; /* no plane is ever met */
    else w->exit = fmin(w->exit, (v->plane[a][exit] - w->o[a]) * w->inv[a]);
    w->next[a] = ahead(w, a, 0);
}

/* No branch on which plane is met at t: that is chance to a processor. */
static inline void pass_axis(struct walk *w, int a, double t)
{
    ptrdiff_t meets = -(ptrdiff_t)(w->next[a] <= t);
    w->cell += (size_t)(meets & w->to_cell[a]);
    w->plane[a] += meets & w->step[a];
    w->next[a] = ahead(w, a, 0);
}

/* Through the planes that are met at t. */
static inline void pass(struct walk *w, double t)
{
    w->t = t;
    pass_axis(w, 0, t);
    pass_axis(w, 1, t);
    pass_axis(w, 2, t);
}

static inline double least(double a, double b) { return a < b ? a : b; }

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
    w->exit = HUGE_VAL;
    for (int a = 0; a < 3; a++) begin_axis(w, a);
    return true;
}

/* Past a block that shows nothing. Of the planes ahead, as many are passed as are met until it
 * ends: counted, as branches would be chance here too. */
static void leap(struct walk *w, const int32_t i[3])
{
    double end = w->exit;
    for (int a = 0; a < 3; a++) {
        int32_t in = i[a] & (BLOCK - 1);
        end = least(end, ahead(w, a, w->step[a] > 0 ? BLOCK - 1 - in : in));
    }
    for (int a = 0; a < 3; a++) {
        ptrdiff_t n = 0;
        for (int k = 0; k < BLOCK; k++) n += ahead(w, a, k) <= end;
        w->cell += (size_t)(n * w->to_cell[a]);
        w->plane[a] += n * w->step[a];
        w->passed += (uint32_t)n;
        w->next[a] = ahead(w, a, 0);
    }
    w->t = end;
}

bool walk_next(struct walk *w, double *t0, double *t1)
{
    const struct volume *v = w->v;
    if (w->end > w->t) pass(w, w->end);
    while (w->t < w->exit) {
        double end = least(least(w->next[0], w->next[1]), w->next[2]);
        bool real = end > w->t; /* else it only touches the cell */
        if (real && v->live[w->cell >> 3] >> (w->cell & 7) & 1) {
            w->passed++;
            *t0 = w->t;
            *t1 = w->end = end;
            return true;
        }
        int32_t i[3];
        walk_cell(w, i);
        if (real && !v->block[block_index(v, i)]) {
            leap(w, i);
            continue;
        }
        w->passed += real;
        pass(w, end);
    }
    return false;
}
