/*
 * terms: the variables that the formulas of levels name: of a level, of a column, or one number.
 */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define GRAVITY 9.80665 /* m/s2 */
#define NUMBERS_MOST (1 << 20)

/* ---- names and units ------------------------------------------------------------------------- */

bool cf_term(const char *terms, const char *what, char name[CF_TEXT])
{
    static const char blanks[] = " \t\r\n";
    const size_t n = strlen(what);
    for (const char *at = terms; *at; at += strcspn(at, blanks)) {
        at += strspn(at, blanks);
        if (strncasecmp(at, what, n) != 0 || at[n] != ':') continue;
        at += n + 1;
        at += strspn(at, blanks);
        snprintf(name, CF_TEXT, "%.*s", (int)strcspn(at, blanks), at);
        return true;
    }
    name[0] = '\0';
    return false;
}

/* A path from the root, /g/v, or from the group, g/v. */
static bool find_path(int *group, const char *path, int *id)
{
    const char *slash = strrchr(path, '/');
    char in[CF_TEXT];
    snprintf(in, CF_TEXT, "%.*s", (int)(slash - path), path);
    while (*path == '/' && nc_inq_grp_parent(*group, group) == NC_NOERR) continue;
    if (*in && nc_inq_grp_full_ncid(*group, in, group) != NC_NOERR) return false;
    return nc_inq_varid(*group, slash + 1, id) == NC_NOERR;
}

bool cf_find_above(int *group, const char *name, int *id)
{
    if (strchr(name, '/')) return find_path(group, name, id);
    while (nc_inq_varid(*group, name, id) != NC_NOERR)
        if (nc_inq_grp_parent(*group, group) != NC_NOERR) return false;
    return true;
}

/* The spellings of the table are known without libudunits2. */
double cf_metres_in(const char *units)
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

bool cf_to_metres(struct cf_file *c, int group, int id, double *value, char err[ERR_BYTES])
{
    char units[CF_TEXT], name[NC_MAX_NAME + 1] = "";
    cf_text(c, group, id, "units", units);
    double metres = units[0] ? cf_metres_in(units) : 1;
    *value *= metres;
    if (metres > 0) return true;
    cf_did(c, nc_inq_varname(group, id, name));
    return err_set(err, "%.60s is in '%.60s', expected a length", name, units);
}

bool cf_to_pascals(struct cf_file *c, int group, int id, double *value, char err[ERR_BYTES])
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

/* Reads the numbers of a variable of one dimension or none, which the caller frees. NULL with the
 * reason in err if they cannot be read. */
static double *numbers(
    struct cf_file *c, int group, const char *name, size_t *length, char err[ERR_BYTES])
{
    int id, dims, dim[NC_MAX_VAR_DIMS];
    struct cf_packing p;
    *length = 1;
    if (!cf_find_above(&group, name, &id)) {
        err_set(err, "the levels name %.60s, which is not there", name);
        return NULL;
    }
    cf_did(c, nc_inq_var(group, id, NULL, NULL, &dims, dim, NULL));
    if (!c->status && dims > 1) {
        err_set(err, "%.60s has %d dimensions, expected 1", name, dims);
        return NULL;
    }
    if (!c->status && dims == 1) cf_did(c, nc_inq_dimlen(group, dim[0], length));
    cf_packing(c, group, id, &p);
    if (!cf_unpacks(&p, name, err)) return NULL;
    if (*length > NUMBERS_MOST) { /* a small file can claim them */
        err_set(err, "%.60s has %zu numbers, expected at most %d", name, *length, NUMBERS_MOST);
        return NULL;
    }
    double *all = xcalloc(*length + 1, sizeof *all);
    if (!c->status) cf_did(c, nc_get_var_double(group, id, all));
    for (size_t i = 0; !c->status && i < *length; i++) all[i] = cf_unpack(&p, all[i]);
    if (cf_look(c, err)) return all;
    free(all);
    return NULL;
}

bool cf_number(struct cf_file *c, int group, const char *name, double *out, char err[ERR_BYTES])
{
    size_t n;
    double *all = numbers(c, group, name, &n, err);
    if (all) *out = all[0];
    const bool good = all && (n == 1 || err_set(err, "%.60s has %zu numbers, expected 1", name, n));
    free(all);
    return good;
}

bool cf_level_numbers(
    struct cf_file *c, const struct cf_axis *z, const char *name, double *out, char err[ERR_BYTES])
{
    size_t n;
    double *all = numbers(c, z->in, name, &n, err);
    bool good = all != NULL;
    for (size_t k = 0; good && k < z->n; k++) {
        const double level = n == z->n ? (double)k + 1 : z->at[k];
        good = level >= 1 && level <= (double)n && level == floor(level);
        if (good) out[k] = all[(size_t)level - 1];
    }
    if (all && !good)
        err_set(err, "%.60s has %zu numbers, expected %zu, or levels that count them from 1", name,
            n, z->n);
    free(all);
    return good;
}

/* ---- layers ---------------------------------------------------------------------------------- */

/* True if a dimension is the axis of the field; or, of ROMS, if it is that of the rho points
 * between which its u, v or psi points lie: xi_rho is an axis xi_u. more is 1 if it has one more.
 * Then the field has the means of neighbours. */
static bool lies_on(const struct cf_axis *a, const char *dim, size_t count, size_t *more)
{
    static const char *const points[] = {"u", "v", "psi"};
    const size_t head = strncmp(dim, "xi_", 3) == 0 ? 3 : strncmp(dim, "eta_", 4) == 0 ? 4 : 0;
    *more = 0;
    if (strncmp(a->name, dim, CF_TEXT - 1) == 0) return true;
    if (!head || strcmp(dim + head, "rho") != 0 || strncmp(a->name, dim, head) != 0) return false;
    *more = count == a->n + 1;
    for (size_t i = 0; i < sizeof points / sizeof *points; i++)
        if (strcmp(a->name + head, points[i]) == 0) return true;
    return false;
}

/* The mean of the stored numbers at a node and at its neighbours, if there are more than nodes. */
static double mean_at(
    const struct cf_packing *p, const double *at, const size_t step[2], const size_t more[2])
{
    double sum = 0;
    for (size_t j = 0; j <= more[CF_Y]; j++)
        for (size_t i = 0; i <= more[CF_X]; i++)
            sum += cf_unpack(p, at[i * step[CF_X] + j * step[CF_Y]]);
    return sum / (double)((1 + more[CF_X]) * (1 + more[CF_Y]));
}

bool cf_layer_read(struct cf_file *c, const struct cf_field *f, const struct cf_layer *h,
    size_t time, size_t member, const struct grid *g, double *layer, char err[ERR_BYTES])
{
    int dims = 0, dim[NC_MAX_VAR_DIMS];
    char name[NC_MAX_NAME + 1], what[NC_MAX_NAME + 1] = "";
    size_t start[CF_AXES_MAX] = {0}, count[CF_AXES_MAX], of[CF_AXES_MAX] = {0};
    size_t more[2] = {0}, step[2] = {0}, extra, n = 1;
    unsigned seen = 0;
    cf_did(c, nc_inq_var(h->group, h->id, what, NULL, &dims, dim, NULL));
    if (dims > CF_AXES_MAX) dims = 0;
    for (int i = 0; i < dims; i++) {
        const struct cf_axis *a = NULL;
        cf_did(c, nc_inq_dim(h->group, dim[i], name, &count[i]));
        for (int k = 0; k < f->n_axes; k++)
            if (lies_on(&f->axis[k], name, count[i], &extra)) {
                a = &f->axis[k];
                if (a->kind <= CF_Y) more[a->kind] = extra;
            }
        if (count[i] == 1 && !(a && a->kind <= CF_Y)) continue;
        const bool chosen = a && a->chosen;
        if (!a || a->n + (a->kind <= CF_Y ? more[a->kind] : 0) != count[i] || a->kind == CF_Z ||
            (a->kind == CF_NONE && !chosen))
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
    for (int i = dims - 1; i >= 0; n *= count[i--])
        if (of[i]) step[of[i] == 1 ? CF_X : CF_Y] = n;
    double *values = xcalloc(n, sizeof *values);
    struct cf_packing p;
    cf_packing(c, h->group, h->id, &p);
    if (!cf_unpacks(&p, what, err)) {
        free(values);
        return false;
    }
    cf_did(c, nc_get_vara_double(h->group, h->id, start, count, values));
    const struct cf_axis *x = cf_axis_of(f, CF_X), *y = cf_axis_of(f, CF_Y);
    for (size_t j = 0; j < y->n; j++)
        for (size_t i = 0; i < x->n; i++) {
            const size_t column = x->at[1] < x->at[0] ? x->n - 1 - i : i;
            const size_t row = y->at[1] < y->at[0] ? y->n - 1 - j : j;
            const double *at = values + i * step[CF_X] + j * step[CF_Y];
            const double mean = mean_at(&p, at, step, more);
            layer[row * x->n + column] = (h->logarithm ? exp(mean) : mean) * h->unit;
        }
    free(values);
    return cf_look(c, err);
}
