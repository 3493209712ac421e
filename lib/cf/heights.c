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

#define GRAVITY 9.80665 /* m/s2 */
#define WRF_GRAVITY 9.81
#define P0 1e5          /* Pa, of files whose P0 is a name without a variable */

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

/* Metres in a unit of a geopotential or its height; 0 if it is none of either. The spellings of the
 * table are known without libudunits2. */
static double metres_in(const char *units)
{
    static const struct {
        const char *unit;
        double metres;
    } table[] = {{"m2 s-2", 1 / GRAVITY}, {"m**2 s**-2", 1 / GRAVITY}, {"m^2 s^-2", 1 / GRAVITY},
        {"m2/s2", 1 / GRAVITY}, {"m^2/s^2", 1 / GRAVITY}, {"m", 1}, {"gpm", 1}, {"meter", 1},
        {"meters", 1}, {"metre", 1}, {"metres", 1}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        if (strcasecmp(units, table[i].unit) == 0) return table[i].metres;
    double metres = cf_in_units(units, "m");
    return metres > 0 ? metres : cf_in_units(units, "m2 s-2") / GRAVITY;
}

/* Returns 1 if the file has one, 0 if it has none, and -1 with a message in err if its unit is
 * wrong. */
static int find_geopotential(
    struct cf_file *c, const struct cf_field *f, struct cf_heights *h, char err[ERR_BYTES])
{
    int n = 0;
    char name[NC_MAX_NAME + 1] = "", units[CF_TEXT];
    cf_did(c, nc_inq_nvars(f->group, &n));
    for (int k = 0; k < 2 * n; k++) { /* first those with a standard name */
        const int id = k % n;
        bool standard;
        cf_did(c, nc_inq_varname(f->group, id, name));
        if (!is_geopotential(c, f->group, id, name, &standard) || standard != (k < n)) continue;
        cf_text(c, f->group, id, "units", units);
        h->metres = metres_in(units);
        if (h->metres <= 0 && !standard) continue;
        if (cf_field_read(c, f->group, id, &h->geopotential, err) &&
            cf_same_axes(f, &h->geopotential)) {
            if (h->metres > 0) return 1;
            err_set(err, "%.60s is in '%.60s', expected a length or m2 s-2", name, units);
            return -1;
        }
        cf_field_free(&h->geopotential);
    }
    return 0;
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

/* Finds the variable of a term, such as "ps" in "a: hyam b: hybm p0: P0 ps: PS". */
static bool term(const char *terms, const char *what, char name[CF_TEXT])
{
    size_t n = strlen(what);
    for (const char *at = terms; (at = strstr(at, what)) != NULL; at += n) {
        if ((at != terms && at[-1] != ' ') || at[n] != ':') continue;
        at += n + 1;
        while (*at == ' ') at++;
        snprintf(name, CF_TEXT, "%.*s", (int)strcspn(at, " "), at);
        return true;
    }
    name[0] = '\0';
    return false;
}

struct names {
    char a[CF_TEXT], ap[CF_TEXT], b[CF_TEXT], p0[CF_TEXT], ptop[CF_TEXT];
    char ps[CF_TEXT], orog[CF_TEXT]; /* surface pressure, or height; "": none */
};

/* Returns 1 if the levels are hybrid or sigma levels, 0 if they state no formula, and -1 with a
 * message in err if they state another one. */
static int find_names(
    struct cf_file *c, const struct cf_axis *z, struct names *n, char err[ERR_BYTES])
{
    char *terms = cf_whole_text(c, z->in, z->id, "formula_terms");
    bool stated = *terms;
    memset(n, 0, sizeof *n);
    term(terms, "a", n->a), term(terms, "ap", n->ap), term(terms, "p0", n->p0);
    term(terms, "ps", n->ps), term(terms, "ptop", n->ptop), term(terms, "orog", n->orog);
    if (!term(terms, "b", n->b)) term(terms, "sigma", n->b);
    free(terms);
    if (stated && n->b[0] && (n->ps[0] || n->orog[0])) return 1;
    if (stated) {
        err_set(
            err, "the formula_terms of %.60s are neither of hybrid nor of sigma levels", z->name);
        return -1;
    }
    cf_text(c, z->in, z->id, "A_var", n->a);
    cf_text(c, z->in, z->id, "B_var", n->b);
    cf_text(c, z->in, z->id, "P0_var", n->p0);
    cf_text(c, z->in, z->id, "PS_var", n->ps);
    return n->a[0] && n->b[0] && n->ps[0];
}

/* Multiplies by the metres in a unit of a variable; one without a unit is in metres. False with the
 * reason in err if its unit is no length. */
static bool to_metres(struct cf_file *c, int group, int id, double *value, char err[ERR_BYTES])
{
    char units[CF_TEXT], name[NC_MAX_NAME + 1] = "";
    cf_text(c, group, id, "units", units);
    double metres = units[0] ? metres_in(units) : 1;
    *value *= metres;
    if (metres > 0) return true;
    cf_did(c, nc_inq_varname(group, id, name));
    return err_set(err, "%.60s is in '%.60s', expected a length", name, units);
}

/* The same for a pressure, in Pa. */
static bool to_pascals(struct cf_file *c, int group, int id, double *value, char err[ERR_BYTES])
{
    char units[CF_TEXT], name[NC_MAX_NAME + 1] = "";
    cf_text(c, group, id, "units", units);
    if (!units[0]) return true;
    const double pascals = cf_in_pascals(units);
    *value *= pascals;
    if (pascals > 0) return true;
    cf_did(c, nc_inq_varname(group, id, name));
    return err_set(err, "%.60s is in '%.60s', expected a unit of pressure", name, units);
}

/* Reads n numbers of a variable. */
static bool numbers(
    struct cf_file *c, int group, const char *name, size_t n, double *out, char err[ERR_BYTES])
{
    int id, dims, dim[NC_MAX_VAR_DIMS];
    size_t length = 1;
    struct cf_packing p;
    if (nc_inq_varid(group, name, &id) != NC_NOERR)
        return err_set(err, "the levels name %.60s, which is not there", name);
    cf_did(c, nc_inq_var(group, id, NULL, NULL, &dims, dim, NULL));
    if (!c->status && dims > 1)
        return err_set(err, "%.60s has %d dimensions, expected 1", name, dims);
    if (!c->status && dims == 1) cf_did(c, nc_inq_dimlen(group, dim[0], &length));
    if (!c->status && length != n)
        return err_set(err, "%.60s has %zu numbers, expected %zu", name, length, n);
    cf_packing(c, group, id, &p);
    if (!cf_unpacks(&p, name, err)) return false;
    if (!c->status) cf_did(c, nc_get_var_double(group, id, out));
    for (size_t i = 0; !c->status && i < n; i++) out[i] = cf_unpack(&p, out[i]);
    return cf_look(c, err);
}

/* Brings coefficients to a[k] + b[k] * surface pressure or height. */
static bool find_coefficients(struct cf_file *c, const struct cf_axis *z, const struct names *n,
    struct cf_heights *h, char err[ERR_BYTES])
{
    double p0 = P0, ptop = 0;
    int id;
    if (n->orog[0]) { /* a height is a + b times that of the ground */
        p0 = 1;
        if (n->a[0] && nc_inq_varid(z->in, n->a, &id) == NC_NOERR &&
            !to_metres(c, z->in, id, &p0, err))
            return false;
    } else if (n->p0[0] && nc_inq_varid(z->in, n->p0, &id) == NC_NOERR) {
        if (!numbers(c, z->in, n->p0, 1, &p0, err)) return false;
        if (!to_pascals(c, z->in, id, &p0, err)) return false;
    }
    if (n->ptop[0]) {
        if (!numbers(c, z->in, n->ptop, 1, &ptop, err)) return false;
        if (nc_inq_varid(z->in, n->ptop, &id) == NC_NOERR && !to_pascals(c, z->in, id, &ptop, err))
            return false;
    }
    h->a = xcalloc(z->n, sizeof *h->a);
    h->b = xcalloc(z->n, sizeof *h->b);
    const char *a = n->ap[0] ? n->ap : n->a;
    if (a[0] && !numbers(c, z->in, a, z->n, h->a, err)) return false;
    if (!numbers(c, z->in, n->b, z->n, h->b, err)) return false;
    if (n->ap[0] && nc_inq_varid(z->in, n->ap, &id) == NC_NOERR) {
        p0 = 1;
        if (!to_pascals(c, z->in, id, &p0, err)) return false;
    }
    for (size_t k = 0; k < z->n; k++) {
        h->a[k] = h->a[k] * p0 + ptop * (1 - h->b[k]);
        if (!isfinite(h->a[k]) || !isfinite(h->b[k]))
            return err_set(err, "a coefficient of the levels is no number, expected numbers");
    }
    return true;
}

/* Finds a variable in the group or an enclosing one. */
static bool find_above(int *group, const char *name, int *id)
{
    while (nc_inq_varid(*group, name, id) != NC_NOERR)
        if (nc_inq_grp_parent(*group, group) != NC_NOERR) return false;
    return true;
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
    const int named = z->at ? find_names(c, z, &n, err) : 0;
    if (named < 0) return false;
    if (named == 0) {
        bool sea;
        if (!cf_sea_levels(c, f, &h->a, &sea, err)) return false;
        if (sea) h->kind = CF_HEIGHTS_SEA;
        return cf_look(c, err);
    }
    const char *surface = n.ps[0] ? n.ps : n.orog;
    h->group = f->group;
    if (!find_above(&h->group, surface, &h->surface))
        return err_set(err, "the levels need %.60s of the surface, which is not there", surface);
    h->kind = n.ps[0] ? CF_HEIGHTS_HYBRID : CF_HEIGHTS_OROGRAPHY;
    h->unit = 1;
    if (n.ps[0]) n.orog[0] = '\0';
    if (!(n.ps[0] ? to_pascals : to_metres)(c, h->group, h->surface, &h->unit, err)) return false;
    return find_coefficients(c, z, &n, h, err);
}

void cf_heights_free(struct cf_heights *h)
{
    cf_field_free(&h->geopotential);
    cf_field_free(&h->base);
    free(h->a);
    free(h->b);
}

/* ---- values ---------------------------------------------------------------------------------- */

/* Reads the surface pressure in Pa, or its height in metres, at one time, as a layer of g. Its
 * dimensions are those of the field, without z. */
static bool surface(struct cf_file *c, const struct cf_field *f, const struct cf_heights *h,
    size_t time, size_t member, const struct grid *g, double *layer, char err[ERR_BYTES])
{
    int dims = 0, dim[NC_MAX_VAR_DIMS];
    char name[NC_MAX_NAME + 1], what[NC_MAX_NAME + 1] = "";
    size_t start[CF_AXES_MAX] = {0}, count[CF_AXES_MAX], of[CF_AXES_MAX] = {0};
    unsigned seen = 0;
    cf_did(c, nc_inq_var(h->group, h->surface, what, NULL, &dims, dim, NULL));
    if (dims > CF_AXES_MAX) dims = 0;
    for (int i = 0; i < dims; i++) {
        const struct cf_axis *a = NULL;
        cf_did(c, nc_inq_dim(h->group, dim[i], name, &count[i]));
        for (int k = 0; k < f->n_axes; k++)
            if (strncmp(f->axis[k].name, name, CF_TEXT - 1) == 0) a = &f->axis[k];
        if (count[i] == 1 && !(a && a->kind <= CF_Y)) continue;
        const bool chosen = a && a->chosen;
        if (!a || a->n != count[i] || a->kind == CF_Z || (a->kind == CF_NONE && !chosen))
            return err_set(err,
                "%.60s of the surface has the dimension %.60s, expected x, y and time of the field",
                what, name);
        if (chosen) start[i] = a->over ? member : a->pick;
        else if (a->kind == CF_T) start[i] = time;
        if (chosen || a->kind == CF_T) count[i] = 1;
        else of[i] = a->kind == CF_X ? 1 : g->n[0];
        if (!chosen && seen >> a->kind & 1)
            return err_set(err, "%.60s of the surface has %.60s twice", what, name);
        if (!chosen) seen |= 1U << a->kind;
    }
    if (!(seen >> CF_X & 1 && seen >> CF_Y & 1))
        return err_set(err, "%.60s of the surface lacks x or y, expected both", what);
    size_t n = (size_t)g->n[0] * g->n[1], at[CF_AXES_MAX] = {0};
    double *values = xcalloc(n, sizeof *values);
    struct cf_packing p;
    cf_packing(c, h->group, h->surface, &p);
    if (!cf_unpacks(&p, what, err)) {
        free(values);
        return false;
    }
    cf_did(c, nc_get_vara_double(h->group, h->surface, start, count, values));
    for (size_t m = 0; m < n; m++) {
        size_t to = 0;
        for (int i = 0; i < dims; i++) {
            if (!of[i]) continue;
            const struct cf_axis *a = cf_axis_of(f, of[i] == 1 ? CF_X : CF_Y);
            to += of[i] * (a->at[1] < a->at[0] ? a->n - 1 - at[i] : at[i]);
        }
        layer[to] = cf_unpack(&p, values[m]) * h->unit;
        for (int i = dims - 1; i >= 0 && ++at[i] == count[i]; i--) at[i] = 0;
    }
    free(values);
    return cf_look(c, err);
}

bool cf_heights_values(struct cf_file *c, const struct cf_field *f, const struct cf_heights *h,
    size_t time, size_t member, struct grid *g, char err[ERR_BYTES])
{
    const size_t layer = (size_t)g->n[0] * g->n[1];
    if (h->kind == CF_HEIGHTS_GEOPOTENTIAL) {
        if (!cf_values(c, &h->geopotential, time, member, g, err)) return false;
        const size_t nodes = layer * g->n[2];
        struct grid base = *g;
        base.value = h->base.n_axes ? xcalloc(nodes, sizeof *base.value) : NULL;
        const bool good =
            !base.value || cf_values(c, &h->base, time, member, &base, err);
        for (size_t i = 0; i < nodes; i++) {
            const double more = base.value ? (double)base.value[i] : 0;
            g->value[i] = (float)(((double)g->value[i] + more) * h->metres);
        }
        free(base.value);
        return good;
    }
    double *ps = xcalloc(layer, sizeof *ps);
    bool good = h->kind == CF_HEIGHTS_SEA || surface(c, f, h, time, member, g, ps, err);
    const struct cf_axis *z = cf_axis_of(f, CF_Z);
    bool turned = z->n > 1 && (z->at[1] < z->at[0]) != z->down;
    for (size_t k = 0; good && k < z->n; k++) {
        float *to = g->value + layer * (turned ? z->n - 1 - k : k);
        for (size_t i = 0; i < layer; i++) to[i] = (float)(h->a[k] + (h->b ? h->b[k] * ps[i] : 0));
    }
    free(ps);
    return good;
}
