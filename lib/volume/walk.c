/*
 * walk: traversal from cell to cell. The intersection with a plane is computed from the plane's own
 * coordinate each time, not by adding steps (as J. Amanatides and A. Woo, "A fast voxel traversal
 * algorithm for ray tracing", Eurographics 1987, may on even grids). So it is the same number for
 * the cells on both sides, and errors do not add up. The origin is moved to the ray's entry into
 * the grid, so a distant eye costs no digits inside. The walk through a brick has the origin of
 * that through the whole grid, so it has the same numbers.
 */
#include "volume/volume_int.h"

/* t at a plane of an axis. */
static double met(const struct walk *w, int a, double plane)
{
    return (plane - w->o[a]) * w->inv[a];
}

#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* t at the plane n beyond the next one. */
ALWAYS_INLINE double ahead(const struct walk *w, const struct front *f, int a, ptrdiff_t n)
{
    return (f->plane[a][n * w->step[a]] - w->start[a]) * w->inv[a];
}

/* The first cell along an axis that the ray has not left at t. A ray within a plane belongs to the
 * upper cell. */
static int32_t first_cell(const struct walk *w, int a, double t)
{
    int32_t lo = 0, hi = (int32_t)w->v->cells[a] - 1; /* invariant: the answer is in lo .. hi */
    const double *plane = w->v->plane[a];
    while (lo < hi) {
        int32_t mid = (lo + hi) / 2;
        double upper = plane[mid + 1];
        bool above = w->step[a] < 0   ? met(w, a, upper) > t
                     : w->step[a] > 0 ? met(w, a, upper) <= t
                                      : upper <= w->o[a];
        if (above) lo = mid + 1;
        else hi = mid;
    }
    return lo;
}

/* Clips the ray to the grid. False if it misses. */
static bool clip(struct walk *w, double *in)
{
    double near = 0, far = HUGE_VAL;
    for (int a = 0; a < 3; a++) {
        const double *end = w->v->whole[a];
        if (w->step[a] == 0) {
            if (!(w->o[a] >= end[0] && w->o[a] <= end[1])) return false;
            continue;
        }
        near = fmax(near, met(w, a, end[w->step[a] < 0]));
        far = fmin(far, met(w, a, end[w->step[a] > 0]));
    }
    *in = near;
    return near < far;
}

/* Sets the ray's cell and next plane on an axis. */
static void begin_axis(struct walk *w, int a)
{
    const struct volume *v = w->v;
    size_t i = (size_t)first_cell(w, a, w->front.t), exit = w->step[a] > 0 ? v->cells[a] : 0;
    w->front.cell += i * (size_t)v->stride[a];
    w->to_cell[a] = w->step[a] * v->stride[a];
    w->zero[a] = v->plane[a] + (w->step[a] > 0);
    w->front.plane[a] = w->zero[a] + i;
    w->start[a] = w->o[a];
    if (w->step[a] == 0) w->inv[a] = 1, w->start[a] = -HUGE_VAL; /* never meets a plane */
    else w->exit = fmin(w->exit, (v->plane[a][exit] - w->o[a]) * w->inv[a]);
    w->front.next[a] = ahead(w, &w->front, a, 0);
}

/* Steps through n planes of an axis. */
ALWAYS_INLINE void pass_axis(const struct walk *w, struct front *f, int a, ptrdiff_t n)
{
    f->cell += (size_t)(n * w->to_cell[a]);
    f->plane[a] += n * w->step[a];
    f->next[a] = ahead(w, f, a, 0);
}

/* Steps through all planes at t. No branch selects the axis, because it would be unpredictable. */
ALWAYS_INLINE void pass(const struct walk *w, struct front *f, double t)
{
    f->t = t;
    pass_axis(w, f, 0, f->next[0] <= t);
    pass_axis(w, f, 1, f->next[1] <= t);
    pass_axis(w, f, 2, f->next[2] <= t);
}

ALWAYS_INLINE double least(double a, double b) { return a < b ? a : b; }

/* Narrows the ray to the bounds between which it is seen. False if it misses them. */
static bool narrow(struct walk *w)
{
    for (int a = 0; a < 3; a++) {
        const double *in = w->v->inside[a];
        if (w->step[a] == 0 && !(w->o[a] >= in[0] && w->o[a] <= in[1])) return false;
        if (w->step[a] == 0) continue;
        w->front.t = fmax(w->front.t, met(w, a, in[w->step[a] < 0]));
        w->exit = fmin(w->exit, met(w, a, in[w->step[a] > 0]));
    }
    return w->front.t < w->exit;
}

bool walk_begin(struct walk *w, const struct volume *v, struct vec3 eye, struct vec3 dir)
{
    const double o[3] = {eye.x, eye.y, eye.z}, d[3] = {dir.x, dir.y, dir.z};
    *w = (struct walk){.v = v};
    for (int a = 0; a < 3; a++) {
        w->o[a] = o[a];
        w->step[a] = (d[a] > WALK_LEVEL) - (d[a] < -WALK_LEVEL);
        w->d[a] = w->step[a] ? d[a] : 0;
        w->inv[a] = w->step[a] ? 1 / d[a] : 0;
    }
    if (!clip(w, &w->before)) return false;
    double at[3];
    for (int a = 0; a < 3; a++) {
        double low = v->whole[a][0], high = v->whole[a][1], entry = v->whole[a][w->step[a] < 0];
        at[a] = o[a] + w->before * w->d[a];
        /* The plane of entry, exactly. The clamp keeps rounding from moving the ray out of the
         * grid. */
        if (w->before > 0 && w->before == met(w, a, entry)) at[a] = entry;
        at[a] = at[a] < low ? low : at[a] > high ? high : at[a];
    }
    for (int a = 0; a < 3; a++) w->o[a] = at[a];
    w->exit = HUGE_VAL;
    if (v->narrowed && !narrow(w)) return false;
    w->front.cell = (size_t)v->origin;
    for (int a = 0; a < 3; a++) begin_axis(w, a);
    return w->front.t < w->exit;
}

/* t at which the ray leaves the block along an axis. */
ALWAYS_INLINE double block_end(const struct walk *w, const struct front *f, int a, int32_t i)
{
    int32_t in = i & (BLOCK - 1);
    return ahead(w, f, a, w->step[a] > 0 ? BLOCK - 1 - in : in);
}

/* Steps through all planes of this axis that the ray meets before the block ends. Counts them
 * without a branch. */
ALWAYS_INLINE void leap_axis(const struct walk *w, struct front *f, int a, double end)
{
    ptrdiff_t n = 0;
    for (int k = 0; k < BLOCK; k++) n += ahead(w, f, a, k) <= end;
    f->passed += (uint32_t)n;
    pass_axis(w, f, a, n);
}

/* Skips a block without live cells. */
ALWAYS_INLINE void leap(const struct walk *w, struct front *f, const int32_t i[3])
{
    double x = block_end(w, f, 0, i[0]), y = block_end(w, f, 1, i[1]);
    double end = least(least(x, y), least(block_end(w, f, 2, i[2]), w->exit));
    leap_axis(w, f, 0, end);
    leap_axis(w, f, 1, end);
    leap_axis(w, f, 2, end);
    f->t = end;
}

bool walk_cell(struct walk *w, struct segment *s)
{
    const struct volume *v = w->v;
    struct front f = w->front; /* a copy, so that the compiler keeps it in registers */
    bool found = false;
    while (!found && f.t < w->exit) {
        double end = least(least(least(f.next[0], f.next[1]), f.next[2]), w->exit);
        bool real = end > f.t; /* otherwise the ray only touches the cell */
        bool live = v->live[f.cell >> 3] >> (f.cell & 7) & 1;
        s->t0 = f.t;
        s->t1 = end;
        s->i[0] = (int32_t)(f.plane[0] - w->zero[0]);
        s->i[1] = (int32_t)(f.plane[1] - w->zero[1]);
        s->i[2] = (int32_t)(f.plane[2] - w->zero[2]);
        if (real && !live && !v->block[block_index(v, s->i)]) {
            leap(w, &f, s->i);
            continue;
        }
        found = real && live;
        f.passed += real;
        pass(w, &f, end);
    }
    w->front = f;
    return found;
}
