/*
 * surface: iso-surfaces as roots. From cell to cell a ray carries its side of each value: below, or
 * at or above. It crosses the surface where the side changes. So a root on a face shared by two
 * cells counts once, even if their cubics differ there by rounding.
 */
#include "volume/volume_int.h"

static uint32_t insert(struct crossing *list, uint32_t n, double w, const struct spec_iso *iso)
{
    uint32_t i = n;
    for (; i > 0 && list[i - 1].w > w; i--) list[i] = list[i - 1];
    list[i] = (struct crossing){w, iso};
    return n + 1;
}

/* Finds the crossings of a cell, at most 3 per surface. Returns their number. */
static uint32_t find(const struct path *p, bool fresh)
{
    const struct volume *v = p->v;
    const double *q = p->cell->p;
    double turn[4];
    uint32_t n = 0;
    int turns = cubic_monotone(q, turn);
    for (size_t i = 0; i < v->spec->n_isos; i++) {
        const struct spec_iso *iso = &v->spec->iso[i];
        double y = iso->s - p->cell->base;
        bool above = fresh ? q[0] >= y : v->above[i];
        for (int k = 1; k < turns; k++) {
            double a = turn[k - 1], b = turn[k];
            bool was = cubic_at(q, a) >= y, is = cubic_at(q, b) >= y;
            if (is == above) continue;
            n = insert(v->crossing, n, was == is ? a : cubic_root(q, a, b, y), iso);
            above = is;
        }
        v->above[i] = above;
    }
    return n;
}

void volume_surfaces(struct path *p, bool fresh, bool own)
{
    double from = 0;
    uint32_t n = p->v->spec->n_isos ? find(p, fresh) : 0;
    if (!own) return;
    for (uint32_t i = 0; i < n; i++) {
        const struct crossing *x = &p->v->crossing[i];
        if (x->w > from) volume_integrate(p, from, x->w);
        from = x->w;
        double light = path_light(p, x->w), seen = p->transmittance * x->iso->opacity;
        for (int c = 0; c < 3; c++) p->rgb[c] += seen * light * x->iso->rgb[c];
        p->transmittance *= 1 - x->iso->opacity;
    }
    if (from < 1) volume_integrate(p, from, 1);
}
