/*
 * heights: the variables from which the height of each node comes. CF conventions 1.10, appendix D
 * "Parametric Vertical Coordinates", and the attributes A_var, B_var, P0_var and PS_var of older
 * files of the Community Climate Model.
 */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define WRF_GRAVITY 9.81
#define P0 1e5 /* Pa, of files whose P0 is a name without a variable */

/* ---- geopotential --------------------------------------------------------------------------- */

/* True if the variable is a geopotential or its height, by its standard name or by other signs. */
static bool is_geopotential(struct cf_file *c, int group, int id, const char *name, bool *standard)
{
    static const char *const names[] = {"gh", "hgt", "z3", "zg", "height"};
    static const char *const others[] = {"anomaly", "deviation", "difference", "eddy", "error",
        "perturbation", "range", "spread", "tendency", "variance"};
    char said[CF_TEXT], about[CF_TEXT], cells[CF_TEXT];
    cf_text(c, group, id, "standard_name", said);
    cf_text(c, group, id, "long_name", about);
    cf_text(c, group, id, "cell_methods", cells);
    *standard = strcmp(said, "geopotential_height") == 0 || strcmp(said, "geopotential") == 0;
    bool is = *standard || text_has(about, "geopotential");
    for (size_t i = 0; !is && i < sizeof names / sizeof *names; i++)
        is = strcasecmp(name, names[i]) == 0;
    for (size_t i = 0; is && i < sizeof others / sizeof *others; i++)
        is = !text_has(about, others[i]) && !text_has(said, others[i]) &&
             !text_has(cells, others[i]);
    return is;
}

/* Returns 1 if the group has one, 0 if it has none, and -1 with a message in err if its unit is
 * wrong. */
static int find_geopotential_in(struct cf_file *c, int group, const struct cf_field *f,
    struct cf_heights *h, char err[ERR_BYTES])
{
    int n = 0;
    char name[NC_MAX_NAME + 1] = "", units[CF_TEXT];
    cf_did(c, nc_inq_nvars(group, &n));
    for (int k = 0; k < 2 * n; k++) { /* first those with a standard name */
        const int id = k % n;
        bool standard;
        cf_did(c, nc_inq_varname(group, id, name));
        if (!is_geopotential(c, group, id, name, &standard) || standard != (k < n)) continue;
        cf_text(c, group, id, "units", units);
        h->metres = cf_metres_in(units);
        if (h->metres <= 0 && !standard) continue;
        if (cf_field_read(c, group, id, &h->geopotential, err) &&
            cf_same_axes(f, &h->geopotential)) {
            if (h->metres > 0) return 1;
            err_set(err, "%.60s is in '%.60s', expected a length or m2 s-2", name, units);
            return -1;
        }
        cf_field_free(&h->geopotential);
    }
    return 0;
}

/* The same of the field's group and those that enclose it. */
static int find_geopotential(
    struct cf_file *c, const struct cf_field *f, struct cf_heights *h, char err[ERR_BYTES])
{
    int group = f->group, found;
    do found = find_geopotential_in(c, group, f, h, err);
    while (!found && nc_inq_grp_parent(group, &group) == NC_NOERR);
    return found;
}

/* Finds the geopotential of the model WRF, the sum of two variables. */
static bool find_wrf(struct cf_file *c, const struct cf_field *f, struct cf_heights *h)
{
    char err[ERR_BYTES];
    int id[2];
    if (nc_inq_varid(f->group, "PH", &id[0]) != NC_NOERR ||
        nc_inq_varid(f->group, "PHB", &id[1]) != NC_NOERR)
        return false;
    h->metres = 1 / WRF_GRAVITY;
    if (cf_field_read(c, f->group, id[0], &h->geopotential, err) &&
        cf_field_read(c, f->group, id[1], &h->base, err) && cf_same_axes(f, &h->geopotential) &&
        cf_same_axes(f, &h->base))
        return true;
    cf_field_free(&h->geopotential);
    cf_field_free(&h->base);
    return false;
}

/* ---- hybrid levels --------------------------------------------------------------------------- */

struct names {
    char a[CF_TEXT], ap[CF_TEXT], b[CF_TEXT], p0[CF_TEXT], ptop[CF_TEXT];
    char ps[CF_TEXT], orog[CF_TEXT];                  /* surface pressure, or height; "": none */
    char lev[CF_TEXT];                                /* -ln(pressure / p0) */
    char b2[CF_TEXT], second[CF_TEXT], ztop[CF_TEXT]; /* of SLEVE coordinates */
};

/* Returns 1 if the levels are hybrid or sigma levels, 0 if they state no formula, and -1 with a
 * message in err if they state another one. */
static int find_names(
    struct cf_file *c, const struct cf_axis *z, struct names *n, char err[ERR_BYTES])
{
    char *terms = cf_whole_text(c, z->in, z->id, "formula_terms");
    bool stated = *terms;
    memset(n, 0, sizeof *n);
    cf_term(terms, "a", n->a), cf_term(terms, "ap", n->ap), cf_term(terms, "p0", n->p0);
    cf_term(terms, "ps", n->ps), cf_term(terms, "ptop", n->ptop), cf_term(terms, "orog", n->orog);
    if (!cf_term(terms, "b", n->b)) cf_term(terms, "sigma", n->b);
    cf_term(terms, "lev", n->lev), cf_term(terms, "ztop", n->ztop);
    cf_term(terms, "b2", n->b2), cf_term(terms, "zsurf2", n->second);
    const bool sleve = n->b2[0] && n->second[0] && n->ztop[0] && n->a[0];
    if (sleve) cf_term(terms, "b1", n->b), cf_term(terms, "zsurf1", n->orog);
    free(terms);
    if (stated && n->b[0] && (n->ps[0] || n->orog[0])) return 1;
    if (stated && n->lev[0] && n->p0[0]) return 1;
    if (stated) {
        err_set(err,
            "the formula_terms of %.60s are none of those known: a or ap, b and ps or orog; sigma, "
            "ptop and ps; p0 and lev; a, b1, b2, ztop, zsurf1 and zsurf2",
            z->name);
        return -1;
    }
    cf_text(c, z->in, z->id, "A_var", n->a);
    cf_text(c, z->in, z->id, "B_var", n->b);
    cf_text(c, z->in, z->id, "P0_var", n->p0);
    cf_text(c, z->in, z->id, "PS_var", n->ps);
    return n->a[0] && n->b[0] && n->ps[0];
}

/* True if a is a pressure, and not a factor of p0, as its name says. */
static bool is_in_pascals(struct cf_file *c, int group, int id, const struct names *n)
{
    char units[CF_TEXT];
    cf_text(c, group, id, "units", units);
    return n->ps[0] && units[0] && cf_in_pascals(units) > 0;
}

/* Reads one number: cf_to_metres or cf_to_pascals converts it. */
static bool read_in(struct cf_file *c, int group, const char *name,
    bool (*convert)(struct cf_file *, int, int, double *, char *), double *out, char err[ERR_BYTES])
{
    int id;
    return cf_number(c, group, name, out, err) && cf_find_above(&group, name, &id) &&
           convert(c, group, id, out, err);
}

/* Brings coefficients to a[k] + b[k] * surface pressure or height. */
static bool find_coefficients(struct cf_file *c, const struct cf_axis *z, const struct names *n,
    struct cf_heights *h, char err[ERR_BYTES])
{
    double p0 = P0, ptop = 0;
    int id, in = z->in;
    if (n->ztop[0] && n->orog[0]) { /* SLEVE: a is a part of ztop */
        if (!read_in(c, z->in, n->ztop, cf_to_metres, &p0, err)) return false;
        h->b2 = xcalloc(z->n, sizeof *h->b2);
        if (!cf_level_numbers(c, z, n->b2, h->b2, err)) return false;
    } else if (n->orog[0]) { /* a height is a + b times that of the ground */
        p0 = 1;
        if (n->a[0] && cf_find_above(&in, n->a, &id) && !cf_to_metres(c, in, id, &p0, err))
            return false;
    } else if (n->p0[0] && cf_find_above(&in, n->p0, &id)) {
        if (!read_in(c, z->in, n->p0, cf_to_pascals, &p0, err)) return false;
    }
    if (n->ptop[0] && !read_in(c, z->in, n->ptop, cf_to_pascals, &ptop, err)) return false;
    h->a = xcalloc(z->n, sizeof *h->a);
    if (n->lev[0] && !n->b[0]) {
        if (!cf_level_numbers(c, z, n->lev, h->a, err)) return false;
        for (size_t k = 0; k < z->n; k++) h->a[k] = p0 * exp(-h->a[k]);
        return true;
    }
    h->b = xcalloc(z->n, sizeof *h->b);
    const char *a = n->ap[0] ? n->ap : n->a;
    if (a[0] && !cf_level_numbers(c, z, a, h->a, err)) return false;
    if (!cf_level_numbers(c, z, n->b, h->b, err)) return false;
    in = z->in;
    if (a[0] && cf_find_above(&in, a, &id) && (n->ap[0] || is_in_pascals(c, in, id, n))) {
        p0 = 1;
        if (!cf_to_pascals(c, in, id, &p0, err)) return false;
    }
    for (size_t k = 0; k < z->n; k++) {
        h->a[k] = h->a[k] * p0 + ptop * (1 - h->b[k]);
        if (!isfinite(h->a[k]) || !isfinite(h->b[k]) || (h->b2 && !isfinite(h->b2[k])))
            return err_set(err, "a coefficient of the levels is no number, expected numbers");
    }
    return true;
}

/* True if the variable says that it is the logarithm of a pressure. */
static bool is_logarithm(struct cf_file *c, int group, int id, const char *name)
{
    char standard[CF_TEXT], about[CF_TEXT];
    cf_text(c, group, id, "standard_name", standard);
    cf_text(c, group, id, "long_name", about);
    return strcasecmp(name, "lnsp") == 0 || strcasecmp(name, "lnps") == 0 ||
           text_has(standard, "logarithm") || text_has(about, "logarithm") ||
           strncasecmp(about, "ln(", 3) == 0;
}

/* Finds the pressure at the surface, or its height. */
static bool find_surface(struct cf_file *c, const struct cf_field *f, const char *name,
    bool pressure, struct cf_layer *s, char err[ERR_BYTES])
{
    *s = (struct cf_layer){.group = f->group, .unit = 1};
    if (!cf_find_above(&s->group, name, &s->id))
        return err_set(err, "the levels need %.60s of the surface, which is not there", name);
    s->logarithm = pressure && is_logarithm(c, s->group, s->id, name);
    if (s->logarithm) return true; /* of Pa, with any unit or none */
    return (pressure ? cf_to_pascals : cf_to_metres)(c, s->group, s->id, &s->unit, err);
}

bool cf_heights_find(struct cf_file *c, const struct cf_field *f, bool standard,
    struct cf_heights *h, char err[ERR_BYTES])
{
    const struct cf_axis *z = cf_axis_of(f, CF_Z);
    struct names n;
    *h = (struct cf_heights){.kind = CF_HEIGHTS_NONE};
    if (z->made) return true;
    const int found = standard ? 0 : find_wrf(c, f, h) ? 1 : find_geopotential(c, f, h, err);
    if (found < 0) return false;
    if (found) {
        h->kind = CF_HEIGHTS_GEOPOTENTIAL;
        return true;
    }
    if (z->at && z->in >= 0 && cf_is_ocean(c, z)) {
        h->kind = CF_HEIGHTS_OCEAN;
        h->ocean = cf_ocean_find(c, f, err);
        return h->ocean != NULL;
    }
    const int named = z->at ? find_names(c, z, &n, err) : 0;
    if (named < 0) return false;
    if (named == 0) {
        bool sea;
        if (!cf_sea_levels(c, f, &h->a, &sea, err)) return false;
        if (sea) h->kind = CF_HEIGHTS_SEA;
        return cf_look(c, err);
    }
    h->kind = n.ps[0] || n.lev[0] ? CF_HEIGHTS_HYBRID : CF_HEIGHTS_OROGRAPHY;
    if (n.ps[0]) n.orog[0] = '\0';
    if (n.b[0] && !find_surface(c, f, n.ps[0] ? n.ps : n.orog, n.ps[0], &h->surface, err))
        return false;
    if (n.second[0] && n.orog[0] && !find_surface(c, f, n.second, false, &h->second, err))
        return false;
    return find_coefficients(c, z, &n, h, err);
}

void cf_heights_free(struct cf_heights *h)
{
    cf_field_free(&h->geopotential);
    cf_field_free(&h->base);
    free(h->a);
    free(h->b);
    free(h->b2);
    cf_ocean_free(h->ocean);
}

/* ---- values ---------------------------------------------------------------------------------- */

bool cf_heights_values(struct cf_file *c, const struct cf_field *f, const struct cf_heights *h,
    size_t time, size_t member, struct grid *g, char err[ERR_BYTES])
{
    const size_t layer = (size_t)g->n[0] * g->n[1];
    if (h->kind == CF_HEIGHTS_GEOPOTENTIAL) {
        if (!cf_values(c, &h->geopotential, time, member, g, err)) return false;
        const size_t nodes = layer * g->n[2];
        struct grid base = *g;
        base.value = h->base.n_axes ? xcalloc(nodes, sizeof *base.value) : NULL;
        const bool good = !base.value || cf_values(c, &h->base, time, member, &base, err);
        for (size_t i = 0; i < nodes; i++) {
            const double more = base.value ? (double)base.value[i] : 0;
            g->value[i] = (float)(((double)g->value[i] + more) * h->metres);
        }
        free(base.value);
        return good;
    }
    if (h->kind == CF_HEIGHTS_OCEAN) return cf_ocean_values(c, f, h->ocean, time, member, g, err);
    double *ps = xcalloc(layer, sizeof *ps), *second = xcalloc(layer, sizeof *second);
    bool good = (!h->b || cf_layer_read(c, f, &h->surface, time, member, g, ps, err)) &&
                (!h->b2 || cf_layer_read(c, f, &h->second, time, member, g, second, err));
    const struct cf_axis *z = cf_axis_of(f, CF_Z);
    bool turned = z->n > 1 && (z->at[1] < z->at[0]) != z->down;
    for (size_t k = 0; good && k < z->n; k++) {
        float *to = g->value + layer * (turned ? z->n - 1 - k : k);
        const double b = h->b ? h->b[k] : 0, b2 = h->b2 ? h->b2[k] : 0;
        for (size_t i = 0; i < layer; i++) to[i] = (float)(h->a[k] + b * ps[i] + b2 * second[i]);
    }
    free(second);
    free(ps);
    return good;
}
