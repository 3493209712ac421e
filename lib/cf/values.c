/* values: converts a field's axes and values to a grid. */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>

/* z is negated if it increases downwards, so that it points up. Other axes are not negated. */
static double sign_of(const struct cf_axis *a) { return a->kind == CF_Z && a->down ? -1 : 1; }
static bool is_turned(const struct cf_axis *a)
{
    return a->n > 1 && (a->at[1] < a->at[0]) != (sign_of(a) < 0);
}

bool cf_axes(const struct cf_field *f, struct grid *g, char err[ERR_BYTES])
{
    *g = (struct grid){0};
    for (int k = 0; k < 3; k++) {
        const struct cf_axis *a = cf_axis_of(f, (enum cf_kind)k);
        double *at = g->at[k] = xmalloc(a->n, sizeof *at);
        g->n[k] = (uint32_t)a->n;
        for (size_t i = 0; i < a->n; i++)
            at[is_turned(a) ? a->n - 1 - i : i] = sign_of(a) * a->at[i] + 0.0; /* no -0 */
        if (!(fabs(at[0]) <= GRID_MAX && fabs(at[a->n - 1]) <= GRID_MAX)) {
            err_set(err, "%.60s goes from %g to %g, expected %g at most", a->name, at[0],
                at[a->n - 1], GRID_MAX);
            grid_free(g);
            return false;
        }
    }
    size_t nodes;
    if (__builtin_mul_overflow((size_t)g->n[0] * g->n[1], g->n[2], &nodes)) {
        grid_free(g);
        return err_set(err, "too many nodes, expected as many as fit in memory");
    }
    g->value = xmalloc(nodes, sizeof *g->value);
    return true;
}

/* Mapping from the file's layout to the grid's; arrays 0 .. 2 start with the outermost axis in the
 * file. */
struct way {
    size_t start[CF_AXES_MAX], count[CF_AXES_MAX]; /* of a slab: one node of the outermost axis */
    int outermost;
    size_t n[3], more[3];      /* more: 1 if the axis is staggered */
    ptrdiff_t step[3], origin; /* in the grid */
};

static struct way find_way(
    const struct cf_field *f, size_t time, size_t member, const struct grid *g)
{
    struct way w = {.origin = 0};
    for (int i = 0, k = 0; i < f->n_axes; i++) {
        const struct cf_axis *a = &f->axis[i];
        w.count[i] = 1;
        if (a->kind == CF_T) {
            w.start[i] = time;
            continue;
        }
        if (a->kind == CF_NONE) {
            w.start[i] = a->over ? member : a->pick;
            continue;
        }
        w.n[k] = a->n;
        w.step[k] = (ptrdiff_t)grid_node(g, a->kind == CF_X, a->kind == CF_Y, a->kind == CF_Z);
        if (is_turned(a)) {
            w.origin += w.step[k] * (ptrdiff_t)(a->n - 1);
            w.step[k] = -w.step[k];
        }
        w.more[k] = a->staggered;
        if (k == 0) w.outermost = i;
        w.count[i] = (k ? a->n : 1) + w.more[k];
        k++;
    }
    return w;
}

/* Replaces n + 1 blocks of numbers by the n means of neighbours. */
static void center(double *v, size_t times, size_t n, size_t block)
{
    for (size_t t = 0; t < times; t++)
        for (size_t i = 0; i < n * block; i++) {
            const double *from = v + t * (n + 1) * block + i;
            v[t * n * block + i] = (from[0] + from[block]) / 2;
        }
}

static void center_all(const struct way *w, double *slab)
{
    const size_t row = w->n[2] + w->more[2];
    if (w->more[0]) center(slab, 1, 1, (w->n[1] + w->more[1]) * row);
    if (w->more[1]) center(slab, 1, w->n[1], row);
    if (w->more[2]) center(slab, w->n[1], w->n[2], 1);
}

bool cf_values(struct cf_file *c, const struct cf_field *f, size_t time, size_t member,
    struct grid *g, char err[ERR_BYTES])
{
    struct way w = find_way(f, time, member, g);
    const size_t n = (1 + w.more[0]) * (w.n[1] + w.more[1]) * (w.n[2] + w.more[2]);
    double *slab = xcalloc(n, sizeof *slab), worst = 0;
    for (size_t i = 0; i < w.n[0] && !c->status; i++) {
        const double *from = slab;
        w.start[w.outermost] = i;
        cf_did(c, nc_get_vara_double(f->group, f->id, w.start, w.count, slab));
        for (size_t m = 0; m < n; m++) slab[m] = cf_unpack(&f->packing, slab[m]);
        center_all(&w, slab);
        for (size_t j = 0; j < w.n[1]; j++) {
            float *to = g->value + w.origin + w.step[0] * (ptrdiff_t)i + w.step[1] * (ptrdiff_t)j;
            for (size_t k = 0; k < w.n[2]; k++, to += w.step[2]) {
                double v = *from++;
                if (fabs(v) > worst) worst = fabs(v);
                *to = (float)v;
            }
        }
    }
    free(slab);
    if (!cf_look(c, err)) return false;
    if (worst <= GRID_MAX) return true;
    return err_set(
        err, "a value is as large as %g, expected at most %g, or missing_value", worst, GRID_MAX);
}
