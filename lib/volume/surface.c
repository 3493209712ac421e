/*
 * surface: sheets in a cell, front to back. Iso-surfaces are roots. From cell to cell a ray carries
 * its side of each value: below, or at or above. It crosses the surface where the side changes. So
 * a root on a face shared by two cells counts once, even if their cubics differ there by rounding.
 * A value that is less by rounding alone is not below: a field that comes down to the value, and
 * never below it, has no surface there.
 */
#include "volume/volume_int.h"

#include <float.h>

/* More than the rounding error of the field in the cell: it adds about 30 products of these. */
static double rounding(const struct cell *c)
{
    double sum = 0;
    for (int i = 0; i < 7; i++) sum += fabs(c->f[i]);
    return 64 * DBL_EPSILON * sum;
}

/* Where the side changes between a and b: values less than low are below. */
static double place(const double *q, double a, double b, double y, double low)
{
    double from = cubic_at(q, a), to = cubic_at(q, b);
    if ((from >= low) == (to >= low)) return a;
    if ((from >= y) == (to >= y)) return to >= low ? b : a;
    return cubic_root(q, a, b, y);
}

/* Finds the crossings of a cell, at most 3 per surface. Returns their number. */
static uint32_t find(const struct path *p, bool fresh)
{
    const struct volume *v = p->v;
    const double *q = p->cell->p;
    double turn[4], error = rounding(p->cell);
    uint32_t n = 0;
    int turns = cubic_monotone(q, turn);
    for (size_t i = 0; i < v->spec->n_isos; i++) {
        const struct spec_iso *iso = &v->spec->iso[i];
        double y = iso->s - p->cell->base, low = y - error;
        bool above = fresh ? q[0] >= low : v->above[i];
        for (int k = 1; k < turns; k++) {
            bool is = cubic_at(q, turn[k]) >= low;
            if (is == above) continue;
            n = crossing_insert(v->crossing, n,
                (struct crossing){place(q, turn[k - 1], turn[k], y, low), iso, iso->opacity});
            above = is;
        }
        v->above[i] = above;
    }
    return n;
}

/* Adds a sheet that covers this part of what is behind. */
static void add_sheet(struct path *p, const struct crossing *x)
{
    double rgb[3], light = 1;
    if (!x->iso) {
        if (!slice_colour(p, x->w, rgb)) return;
    } else {
        light = path_light(p, x->w);
        memcpy(rgb, x->iso->rgb, sizeof rgb);
    }
    double seen = p->transmittance * x->opacity;
    for (int c = 0; c < 3; c++) p->rgb[c] += seen * light * rgb[c];
    p->transmittance *= 1 - x->opacity;
}

void volume_surfaces(struct path *p, const struct segment *s, const double o[3], const double d[3],
    bool fresh, bool own)
{
    double from = 0;
    uint32_t n = p->v->spec->n_isos ? find(p, fresh) : 0;
    if (!own) return;
    n = slice_crossings(p->v, s, o, d, fresh, n);
    for (uint32_t i = 0; i < n; i++) {
        const struct crossing *x = &p->v->crossing[i];
        if (x->w > from) volume_integrate(p, from, x->w);
        from = x->w;
        add_sheet(p, x);
    }
    if (from < 1) volume_integrate(p, from, 1);
}
