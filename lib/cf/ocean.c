/*
 * ocean: depths of levels that follow the bottom of the sea. CF conventions 1.11, appendix D
 * "Parametric Vertical Coordinates": ocean sigma, ocean s in its three forms, ocean sigma over z,
 * and ocean double sigma.
 */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>

/* Terms of the formulas: of a level, of a column, or one number each. */
enum { S, C, ZLEV, PER_LEVEL };
enum { ETA, DEPTH, PER_COLUMN };
enum { A, B, DEPTH_C, NSIGMA, Z1, Z2, HREF, K_C, SINGLE };
static const char *const level_terms[PER_LEVEL] = {"s", "C", "zlev"};
static const char *const column_terms[PER_COLUMN] = {"eta", "depth"};
static const char *const single_terms[SINGLE] = {
    "a", "b", "depth_c", "nsigma", "z1", "z2", "href", "k_c"};
#define LENGTHS (1 << DEPTH_C | 1 << Z1 | 1 << Z2 | 1 << HREF)

struct cf_ocean {
    int form; /* of forms below */
    struct cf_layer column[PER_COLUMN];
    double single[SINGLE];
    double *level[PER_LEVEL]; /* NULL: not there */
    size_t n;
};

/* Heights of level k in a column, in metres upwards. */
typedef double height(const struct cf_ocean *o, size_t k, double eta, double depth);

static double sigma(const struct cf_ocean *o, size_t k, double eta, double depth)
{
    return eta + o->level[S][k] * (depth + eta);
}

/* Y. Song and D.B. Haidvogel, Journal of Computational Physics 115, 1994 */
static double s_first(const struct cf_ocean *o, size_t k, double eta, double depth)
{
    const double s = o->level[S][k], a = o->single[A], b = o->single[B], dc = o->single[DEPTH_C];
    const double c =
        (1 - b) * sinh(a * s) / sinh(a) + b * (tanh(a * (s + .5)) / (2 * tanh(.5 * a)) - .5);
    return eta * (1 + s) + dc * s + (depth - dc) * c;
}

static double s_g1(const struct cf_ocean *o, size_t k, double eta, double depth)
{
    const double s = o->level[S][k], dc = o->single[DEPTH_C];
    const double still = dc * s + (depth - dc) * o->level[C][k];
    return still + eta * (1 + still / depth);
}

static double s_g2(const struct cf_ocean *o, size_t k, double eta, double depth)
{
    const double s = o->level[S][k], dc = o->single[DEPTH_C];
    return eta + (eta + depth) * (dc * s + depth * o->level[C][k]) / (dc + depth);
}

/* Sigma above depth_c, z below; without nsigma, where sigma is missing. */
static double sigma_z(const struct cf_ocean *o, size_t k, double eta, double depth)
{
    const double at = o->level[S][k];
    const double n = o->single[NSIGMA];
    if (isfinite(n) ? (double)k + 1 > n : !isfinite(at)) return o->level[ZLEV][k];
    return eta + at * (fmin(o->single[DEPTH_C], depth) + eta);
}

/*
 * Sigma goes from 0 at the surface over 1 at the depth f to 2 at the bottom. CF calls the result a
 * height, but with a depth above 0 it is a depth, so it is negated. Sigma from 0 to -2 means the
 * same. Level k_c, counted from the surface, is the last one above f.
 */
static double double_sigma(const struct cf_ocean *o, size_t k, double eta, double depth)
{
    const double z1 = o->single[Z1], z2 = o->single[Z2], half = .5 * (z1 - z2);
    const double *s = o->level[S], at = fabs(s[k]);
    const double bend = o->single[A] / half * (depth - o->single[HREF]);
    const double f = .5 * (z1 + z2) + (fabs(half) > 0 ? half * tanh(bend) : 0);
    const size_t from_top = fabs(s[0]) > fabs(s[o->n - 1]) ? o->n - 1 - k : k;
    (void)eta;
    return -((double)from_top < o->single[K_C] ? at * f : f + (at - 1) * (depth - f));
}

/* What each formula needs, as bits. */
static const struct {
    const char *standard;
    height *at;
    unsigned levels, singles; /* all need depth; eta is 0 if it is not named */
} forms[] = {{"ocean_sigma_coordinate", sigma, 1 << S, 0},
    {"ocean_s_coordinate", s_first, 1 << S, 1 << A | 1 << B | 1 << DEPTH_C},
    {"ocean_s_coordinate_g1", s_g1, 1 << S | 1 << C, 1 << DEPTH_C},
    {"ocean_s_coordinate_g2", s_g2, 1 << S | 1 << C, 1 << DEPTH_C},
    {"ocean_sigma_z_coordinate", sigma_z, 1 << S | 1 << ZLEV, 1 << DEPTH_C},
    {"ocean_double_sigma_coordinate", double_sigma, 1 << S,
        1 << A | 1 << Z1 | 1 << Z2 | 1 << HREF | 1 << K_C}};

bool cf_is_ocean(struct cf_file *c, const struct cf_axis *z)
{
    char standard[CF_TEXT];
    cf_text(c, z->in, z->id, "standard_name", standard);
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
        if (strcmp(standard, forms[i].standard) == 0) return true;
    return false;
}

/* ---- terms ----------------------------------------------------------------------------------- */

/* Finds the variable of a term. False with a message in err if the formula needs it. */
static bool named(const char *terms, const char *what, bool needed, char name[CF_TEXT],
    const struct cf_axis *z, char err[ERR_BYTES])
{
    bool found = cf_term(terms, what, name);
    if (!found && strcmp(what, "s") == 0) found = cf_term(terms, "sigma", name);
    if (!needed) name[0] = '\0';
    return found || !needed || err_set(err, "the formula_terms of %.60s lack %.20s", z->name, what);
}

static bool find_columns(struct cf_file *c, const struct cf_field *f, const char *terms,
    struct cf_ocean *o, char err[ERR_BYTES])
{
    const struct cf_axis *z = cf_axis_of(f, CF_Z);
    char name[CF_TEXT];
    for (int i = 0; i < PER_COLUMN; i++) {
        struct cf_layer *l = &o->column[i];
        *l = (struct cf_layer){.group = f->group, .id = -1, .unit = 1};
        if (!named(terms, column_terms[i], i == DEPTH, name, z, err)) return false;
        if (i == ETA && !cf_term(terms, column_terms[i], name)) continue;
        if (!cf_find_above(&l->group, name, &l->id))
            return err_set(err, "the levels need %.60s, which is not there", name);
        if (!cf_to_metres(c, l->group, l->id, &l->unit, err)) return false;
    }
    return true;
}

/* Metres in the unit of a term. */
static bool find_metres(
    struct cf_file *c, int group, const char *name, double *metres, char err[ERR_BYTES])
{
    int id;
    *metres = 1;
    return !cf_find_above(&group, name, &id) || cf_to_metres(c, group, id, metres, err);
}

static bool find_numbers(struct cf_file *c, const struct cf_axis *z, const char *terms,
    struct cf_ocean *o, char err[ERR_BYTES])
{
    char name[CF_TEXT];
    double metres;
    const unsigned singles = forms[o->form].singles;
    const unsigned lengths = LENGTHS | (singles >> HREF & 1 ? 1 << A : 0);
    for (int i = 0; i < PER_LEVEL; i++) {
        if (!named(terms, level_terms[i], forms[o->form].levels >> i & 1, name, z, err))
            return false;
        if (!*name) continue;
        o->level[i] = xcalloc(z->n, sizeof *o->level[i]);
        if (!cf_level_numbers(c, z, name, o->level[i], err)) return false;
        if (i == ZLEV && !find_metres(c, z->in, name, &metres, err)) return false;
        for (size_t k = 0; i == ZLEV && k < z->n; k++) o->level[i][k] *= metres;
    }
    for (int i = 0; i < SINGLE; i++) {
        const bool needed = singles >> i & 1;
        o->single[i] = (double)NAN;
        if (i == NSIGMA) cf_term(terms, single_terms[i], name);
        else if (!named(terms, single_terms[i], needed, name, z, err)) return false;
        if (*name && !cf_number(c, z->in, name, &o->single[i], err)) return false;
        if (!*name || !(lengths >> i & 1)) continue;
        if (!find_metres(c, z->in, name, &metres, err)) return false;
        o->single[i] *= metres;
    }
    return true;
}

struct cf_ocean *cf_ocean_find(struct cf_file *c, const struct cf_field *f, char err[ERR_BYTES])
{
    const struct cf_axis *z = cf_axis_of(f, CF_Z);
    char standard[CF_TEXT], *terms = cf_whole_text(c, z->in, z->id, "formula_terms");
    struct cf_ocean *o = xcalloc(1, sizeof *o);
    o->n = z->n;
    cf_text(c, z->in, z->id, "standard_name", standard);
    while (strcmp(standard, forms[o->form].standard) != 0) o->form++; /* by cf_is_ocean */
    const bool good = find_columns(c, f, terms, o, err) && find_numbers(c, z, terms, o, err);
    free(terms);
    if (good) return o;
    cf_ocean_free(o);
    return NULL;
}

void cf_ocean_free(struct cf_ocean *o)
{
    for (int i = 0; o && i < PER_LEVEL; i++) free(o->level[i]);
    free(o);
}

/* ---- heights --------------------------------------------------------------------------------- */

bool cf_ocean_values(struct cf_file *c, const struct cf_field *f, const struct cf_ocean *o,
    size_t time, size_t member, struct grid *g, char err[ERR_BYTES])
{
    const size_t layer = (size_t)g->n[0] * g->n[1];
    const struct cf_axis *z = cf_axis_of(f, CF_Z);
    const bool turned = z->n > 1 && (z->at[1] < z->at[0]) != z->down;
    double *column[PER_COLUMN];
    bool good = true;
    for (int i = 0; i < PER_COLUMN; i++) {
        const struct cf_layer *l = &o->column[i];
        column[i] = xcalloc(layer, sizeof *column[i]);
        if (good && l->id >= 0) good = cf_layer_read(c, f, l, time, member, g, column[i], err);
    }
    for (size_t k = 0; good && k < z->n; k++) {
        float *to = g->value + layer * (turned ? z->n - 1 - k : k);
        for (size_t i = 0; i < layer; i++) {
            const double h = forms[o->form].at(o, k, column[ETA][i], column[DEPTH][i]);
            to[i] = isfinite(h) ? (float)h : NAN;
        }
    }
    for (int i = 0; i < PER_COLUMN; i++) free(column[i]);
    return good;
}
