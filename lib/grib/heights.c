/*
 * heights: the fields from which the height of each node comes. The pressure of model level k is
 * the mean of its two half levels, whose coefficients all messages of the level type carry (ECMWF,
 * "IFS Documentation", part III, section 2.2.1).
 */
#include "grib/grib_int.h"

#include <stdlib.h>
#include <string.h>

#define GRAVITY 9.80665 /* m/s2 */

/* ---- the fields ------------------------------------------------------------------------------ */

/* True if p has one level, and the grid and the times of s. */
static bool is_surface_of(const struct gb_stack *s, const struct gb_stack *p)
{
    bool same = p->n_levels == 1 && p->n_times == s->n_times && gb_same_grid(p->at, s->at);
    for (size_t t = 0; same && t < s->n_times; t++)
        same = p->at[t].when == s->at[t * s->n_levels].when;
    return same;
}

void gb_heights_find(
    const struct gb_index *x, const struct gb_stack *s, bool standard, struct gb_heights *h)
{
    const bool hybrid = strcmp(s->at->levels, "hybrid") == 0;
    *h = (struct gb_heights){.kind = GB_HEIGHTS_NONE};
    for (size_t i = 0, n; i < x->n; i += n) {
        struct gb_stack p = gb_stack_at(x, i);
        const char *name = p.at->name;
        n = p.n;
        if (p.n_members != s->n_members) continue;
        double metres = strcmp(name, "gh") == 0 ? 1 : strcmp(name, "z") == 0 ? 1 / GRAVITY : 0;
        if (metres > 0 && !standard && gb_same_axes(s, &p)) {
            *h = (struct gb_heights){GB_HEIGHTS_GEOPOTENTIAL, p, metres, false};
            return;
        }
        bool logarithm = strcmp(name, "lnsp") == 0;
        if (hybrid && (logarithm || strcmp(name, "sp") == 0) && is_surface_of(s, &p))
            *h = (struct gb_heights){GB_HEIGHTS_HYBRID, p, 0, logarithm};
    }
}

/* ---- values ---------------------------------------------------------------------------------- */

/* Reads the coefficients of the half levels: n of a, then n of b. The caller frees them. */
static bool coefficients(
    const char *path, const struct gb_entry *e, double **ab, size_t *n, char err[ERR_BYTES])
{
    struct gb_file in;
    *ab = NULL;
    *n = 0;
    if (!gb_open_at(path, e->number, &in, err)) return false;
    if (codes_get_size(in.h, "pv", n) == CODES_SUCCESS && *n >= 4 && *n % 2 == 0) {
        *ab = xcalloc(*n, sizeof **ab);
        if (codes_get_double_array(in.h, "pv", *ab, n) != CODES_SUCCESS) *n = 0;
    }
    *n /= 2;
    gb_close(&in);
    return *n > 1 || err_set(err, "the levels have no coefficients, expected the key pv");
}

static bool pressures(const char *path, const struct gb_stack *s, const struct gb_heights *h,
    size_t time, struct grid *g, char err[ERR_BYTES])
{
    const struct gb_entry *level = s->at + time * s->n_levels;
    const size_t layer = (size_t)g->n[0] * g->n[1];
    struct grid surface = {.n = {g->n[0], g->n[1], 1}};
    double *ab;
    size_t n;
    surface.value = xcalloc(layer, sizeof *surface.value);
    bool good =
        coefficients(path, level, &ab, &n, err) && gb_values(path, &h->field, time, &surface, err);
    for (size_t k = 0; good && k < s->n_levels; k++) {
        double number = level[k].level;
        if (!(number >= 1 && number <= (double)(n - 1))) {
            good = err_set(err, "level %g, expected 1 to %zu", number, n - 1);
            break;
        }
        const double *at = ab + (size_t)number; /* the half level below */
        double a = (at[-1] + at[0]) / 2, b = (at[n - 1] + at[n]) / 2;
        float *to = g->value + layer * (s->n_levels - 1 - k); /* model levels count downwards */
        for (size_t i = 0; i < layer; i++) {
            double ps = (double)surface.value[i];
            to[i] = (float)(a + b * (h->logarithm ? exp(ps) : ps));
        }
    }
    free(ab);
    free(surface.value);
    return good;
}

bool gb_heights_values(const char *path, const struct gb_stack *s, const struct gb_heights *h,
    size_t time, struct grid *g, char err[ERR_BYTES])
{
    if (h->kind == GB_HEIGHTS_HYBRID) return pressures(path, s, h, time, g, err);
    if (!gb_values(path, &h->field, time, g, err)) return false;
    const size_t nodes = grid_node(g, 0, 0, g->n[2]);
    for (size_t i = 0; i < nodes; i++) g->value[i] = (float)((double)g->value[i] * h->metres);
    return true;
}
