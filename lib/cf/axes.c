/* axes: reads coordinate variables and identifies x, y, z and time. */
#include "cf/cf_int.h"
#include "units/units.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* A small file can claim to have more, which would take gigabytes to read. */
#define NODES_MOST (1 << 24)

static bool one_of(const char *s, const char *const *words)
{
    for (; *words; words++)
        if (strcasecmp(s, *words) == 0) return true;
    return false;
}

double cf_in_units(const char *unit, const char *of)
{
    char err[ERR_BYTES];
    struct units_linear l;
    return units_linear(unit, of, &l, err) && fabs(l.offset) <= 0 ? l.factor : 0;
}

/* The words are known without libudunits2, which takes 5 ms to read its units. */
static bool is_pressure(const char *units)
{
    static const char *const words[] = {"Pa", "hPa", "kPa", "dbar", "decibar", "mb", "mbar",
        "millibar", "millibars", "bar", "bars", "atm", "pascal", "pascals", "hectopascal",
        "hectopascals", "kilopascal", "kilopascals", "torr", "psi", "N m-2", NULL};
    return one_of(units, words) || (units[0] && cf_in_units(units, "Pa") > 0);
}

/* The kind that a coordinate variable's attributes state; CF_NONE if they state none. */
static enum cf_kind kind_of(struct cf_file *c, int group, int id, struct cf_axis *a)
{
    static const char *const east[] = {"degrees_east", "degree_east", "degree_E", "degrees_E",
        "degreeE", "degreesE", "longitude", "grid_longitude", "projection_x_coordinate",
        "projection_x_angular_coordinate", NULL};
    static const char *const north[] = {"degrees_north", "degree_north", "degree_N", "degrees_N",
        "degreeN", "degreesN", "latitude", "grid_latitude", "projection_y_coordinate",
        "projection_y_angular_coordinate", NULL};
    static const char *const up[] = {
        "height", "altitude", "depth", "air_pressure", "model_level_number", NULL};
    static const char letters[] = "XYZT";
    char axis[CF_TEXT], standard[CF_TEXT], positive[CF_TEXT];
    cf_text(c, group, id, "axis", axis);
    cf_text(c, group, id, "standard_name", standard);
    cf_text(c, group, id, "positive", positive);
    a->rotated = strncasecmp(standard, "grid_l", 6) == 0;
    a->member = strcasecmp(standard, "realization") == 0;
    const char *at = axis[0] && !axis[1] ? strchr(letters, axis[0] & ~0x20) : NULL;
    if (at) return (enum cf_kind)(at - letters);
    if (one_of(a->units, east) || one_of(standard, east)) return CF_X;
    if (one_of(a->units, north) || one_of(standard, north)) return CF_Y;
    if (strstr(a->units, " since ") || strcasecmp(standard, "time") == 0 ||
        strcasecmp(a->name, "time") == 0)
        return CF_T;
    cf_text(c, group, id, "formula_terms", axis);
    return positive[0] || axis[0] || one_of(standard, up) || is_pressure(a->units) ? CF_Z : CF_NONE;
}

/*
 * The kind that an axis's name suggests, for files without attributes; CF_NONE if it suggests none.
 * `other`: it is not an axis of a grid, so it must not become the height by elimination.
 */
static enum cf_kind kind_by_name(const char *name, bool *other)
{
    static const struct {
        const char *part; /* part of the name; with "=" in front the whole name */
        enum cf_kind kind;
    } table[] = {{"_type", CF_NONE}, {"ensemble", CF_NONE}, {"member", CF_NONE}, {"=ens", CF_NONE},
        {"=number", CF_NONE}, {"realization", CF_NONE}, {"bnds", CF_NONE}, {"=expver", CF_NONE},
        {"time", CF_T}, {"step", CF_T}, {"date", CF_T}, {"month", CF_T}, {"year", CF_T},
        {"hour", CF_T}, {"=day", CF_T}, {"=t", CF_T}, {"longitude", CF_X}, {"west_east", CF_X},
        {"=lon", CF_X}, {"=x", CF_X}, {"latitude", CF_Y}, {"south_north", CF_Y}, {"=lat", CF_Y},
        {"=y", CF_Y}, {"bottom_top", CF_Z}, {"level", CF_Z}, {"height", CF_Z}, {"depth", CF_Z},
        {"altitude", CF_Z}, {"pressure", CF_Z}, {"=lev", CF_Z}, {"=z", CF_Z}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const char *part = table[i].part;
        if (*part == '=' ? strcasecmp(name, part + 1) != 0 : !text_has(name, part)) continue;
        *other = table[i].kind == CF_NONE;
        return table[i].kind;
    }
    *other = false;
    return CF_NONE;
}

bool cf_is_other(const struct cf_axis *a)
{
    bool other;
    kind_by_name(a->name, &other);
    return a->member || other;
}

/* Finds the coordinate variable of a dimension: the variable of the same name along it, in the
 * group or an enclosing one. */
static bool find_coordinates(int group, int dim, const char *name, int *in, int *id)
{
    int n, its;
    for (*in = group;; group = *in) {
        if (nc_inq_varid(*in, name, id) == NC_NOERR && nc_inq_varndims(*in, *id, &n) == NC_NOERR &&
            n == 1 && nc_inq_vardimid(*in, *id, &its) == NC_NOERR && its == dim)
            return true;
        if (nc_inq_grp_parent(group, in) != NC_NOERR) return false;
    }
}

/* All times are after 1582, from when on the proleptic Gregorian calendar is the usual one. */
static bool is_modern(const struct cf_axis *a)
{
    struct units_date from;
    for (size_t i = 0; i < a->n; i++)
        if (a->at[i] < 0) return false;
    return units_date(0, a->units, &from) && from.year > 1582;
}

/* A date of another calendar must not be taken for one of the usual calendar. */
static void name_calendar(struct cf_file *c, int in, int id, struct cf_axis *a)
{
    char calendar[CF_TEXT] = "";
    if (a->kind == CF_T) cf_text(c, in, id, "calendar", calendar);
    if (strcasecmp(calendar, "standard") == 0 || strcasecmp(calendar, "gregorian") == 0) return;
    if (strcasecmp(calendar, "proleptic_gregorian") == 0 && is_modern(a)) return;
    size_t n = strlen(a->units);
    if (calendar[0]) snprintf(a->units + n, CF_TEXT - n, " (%s)", calendar);
}

/* By any of its names. Depths below 0 are heights already. */
static bool is_depth(struct cf_file *c, const struct cf_axis *a)
{
    char standard[CF_TEXT], about[CF_TEXT];
    bool below = false;
    cf_text(c, a->in, a->id, "standard_name", standard);
    cf_text(c, a->in, a->id, "long_name", about);
    for (size_t i = 0; i < a->n; i++) below = below || a->at[i] > 0;
    return below &&
           (text_has(standard, "depth") || text_has(a->name, "depth") || text_has(about, "depth"));
}

/* Of levels whose pressure grows with their number. */
static bool is_sigma(struct cf_file *c, const struct cf_axis *a)
{
    char standard[CF_TEXT];
    cf_text(c, a->in, a->id, "standard_name", standard);
    return strcmp(standard, "atmosphere_sigma_coordinate") == 0 ||
           strcmp(standard, "atmosphere_hybrid_sigma_pressure_coordinate") == 0;
}

/* Of levels that go from 0 at the surface to 2 or to -2, whatever they say. */
static bool is_double_sigma(struct cf_file *c, const struct cf_axis *a)
{
    char standard[CF_TEXT];
    cf_text(c, a->in, a->id, "standard_name", standard);
    return strcmp(standard, "ocean_double_sigma_coordinate") == 0;
}

double cf_degrees_in(const char *units)
{
    static const char *const words[] = {"degrees_west", "degree_west", "degrees_W", "degree_W",
        "degreesW", "degreeW", "degrees_south", "degree_south", "degrees_S", "degree_S", "degreesS",
        NULL};
    static const char *const radians[] = {"radian", "radians", "rad", NULL};
    if (one_of(units, radians)) return 57.295779513082321; /* 180 / pi */
    return one_of(units, words) ? -1 : 1;
}

/* Degrees to the west and to the south, and radians, become the degrees that maps have. Radians may
 * be of another angle, as those of a scan. */
static void face_east_and_north(struct cf_file *c, struct cf_axis *a)
{
    const double degrees = cf_degrees_in(a->units);
    char standard[CF_TEXT];
    cf_text(c, a->in, a->id, "standard_name", standard);
    const char *name = standard[0] ? standard : a->name;
    const bool lon = strncasecmp(name, "lon", 3) == 0, lat = strncasecmp(name, "lat", 3) == 0;
    if (degrees == 1 || (degrees > 1 && !lon && !lat)) return;
    const bool east = degrees > 1 ? lon : text_has(a->units, "w");
    snprintf(a->units, CF_TEXT, "%s", east ? "degrees_east" : "degrees_north");
    for (size_t i = 0; i < a->n; i++) a->at[i] *= degrees;
}

/* The levels of the model WRF, which have no coordinates, are counted from the lowest one. */
static void count_levels(struct cf_axis *a)
{
    a->kind = CF_Z;
    a->in = a->id = -1;
    snprintf(a->units, CF_TEXT, "1");
    a->at = xcalloc(a->n, sizeof *a->at);
    for (size_t i = 0; i < a->n; i++) a->at[i] = (double)i + 1;
}

bool cf_axis_read(struct cf_file *c, int group, int dim, struct cf_axis *a, char err[ERR_BYTES])
{
    char name[NC_MAX_NAME + 1] = "", positive[CF_TEXT];
    int in, id;
    struct cf_packing p;
    *a = (struct cf_axis){.kind = CF_NONE, .dim = dim};
    if (!cf_did(c, nc_inq_dim(group, dim, name, &a->n))) return cf_look(c, err);
    snprintf(a->name, CF_TEXT, "%.*s", CF_TEXT - 1, name);
    if (a->n > NODES_MOST)
        return err_set(err, "%.60s has %zu nodes, expected %d at most", name, a->n, NODES_MOST);
    if (strcasecmp(name, "time") == 0) a->kind = CF_T;
    if (!find_coordinates(group, dim, name, &in, &id)) {
        if (strncmp(name, "bottom_top", 10) == 0) count_levels(a);
        if (a->kind == CF_T) cf_wrf_times(c, group, a);
        return true;
    }
    cf_packing(c, in, id, &p);
    if (!cf_is_numeric(&p)) return true; /* labels, not numbers */
    if (!cf_unpacks(&p, a->name, err)) return false;
    cf_text(c, in, id, "units", a->units);
    cf_text(c, in, id, "positive", positive);
    a->in = in;
    a->id = id;
    a->at = xcalloc(a->n, sizeof *a->at);
    cf_did(c, nc_get_var_double(in, id, a->at));
    for (size_t i = 0; i < a->n; i++) a->at[i] = cf_unpack(&p, a->at[i]);
    face_east_and_north(c, a);
    a->kind = kind_of(c, in, id, a);
    a->pressure = a->kind == CF_Z && is_pressure(a->units);
    a->down = strcasecmp(positive, "down") == 0 || a->pressure ||
              (!positive[0] && (is_depth(c, a) || is_sigma(c, a)));
    if (is_double_sigma(c, a)) a->down = a->n && a->at[0] + a->at[a->n - 1] > 0;
    name_calendar(c, in, id, a);
    return true;
}

/* The level of a field of x and y. NULL if there is no room for it. */
static struct cf_axis *make_level(struct cf_field *f)
{
    if (f->n_axes == CF_AXES_MAX) return NULL;
    struct cf_axis *a = &f->axis[f->n_axes++];
    *a = (struct cf_axis){.kind = CF_Z, .n = 1, .name = "surface", .made = true};
    a->at = xcalloc(1, sizeof *a->at);
    return a;
}

/* Of two axes of a kind, the one that is left out: it has one element, as that of the time at which
 * a forecast was made. NULL if neither is. */
static struct cf_axis *lesser(struct cf_axis *a, struct cf_axis *b)
{
    if ((a->n == 1) != (b->n == 1)) return a->n == 1 ? a : b;
    if (a->n > 1 || a->kind != CF_T) return NULL;
    bool first = strcasecmp(a->name, "time") == 0, second = strcasecmp(b->name, "time") == 0;
    if (first == second) return NULL;
    return first ? b : a;
}

bool cf_tell_axes_apart(struct cf_file *c, struct cf_field *f, char err[ERR_BYTES])
{
    struct cf_axis *of[CF_NONE] = {NULL};
    bool other[sizeof f->axis / sizeof *f->axis] = {false};
    for (int i = 0; i < f->n_axes; i++) {
        struct cf_axis *a = &f->axis[i];
        if (a->kind == CF_NONE) continue;
        struct cf_axis *b = of[a->kind], *less = b ? lesser(b, a) : NULL;
        if (b && !less)
            return err_set(err, "%.60s and %.60s both are %c, expected one", b->name, a->name,
                "xyzt"[a->kind]);
        if (less != a) of[a->kind] = a;
        if (less) less->kind = CF_NONE;
    }
    for (int i = 0; i < f->n_axes; i++) {
        struct cf_axis *a = &f->axis[i];
        if (a->kind != CF_NONE || a->n == 1 || a->chosen) continue;
        enum cf_kind kind = kind_by_name(a->name, &other[i]);
        other[i] |= a->member;
        if (kind == CF_NONE || other[i]) continue;
        other[i] = of[kind] && of[kind]->n > 1;
        if (other[i]) continue;
        if (of[kind]) of[kind]->kind = CF_NONE; /* one element, as that of the time of a forecast */
        of[kind] = a;
        a->kind = kind;
    }
    for (int i = f->n_axes - 1, next = CF_X; i >= 0; i--) {
        struct cf_axis *a = &f->axis[i];
        if (a->kind != CF_NONE || a->n == 1 || a->chosen) continue;
        while (next < CF_NONE && of[next]) next++;
        if (next == CF_NONE || other[i]) return cf_choices(c, f, a, err);
        of[next] = a;
        a->kind = (enum cf_kind)next;
    }
    if (of[CF_X] && of[CF_Y] && !of[CF_Z]) of[CF_Z] = make_level(f);
    for (int k = CF_X; k <= CF_Z; k++)
        if (!of[k])
            return err_set(err,
                "no %c among its %d dimensions, expected x and y, as of a map, or x, y and z",
                "xyz"[k], f -> n_axes);
    return true;
}

const struct cf_axis *cf_axis_of(const struct cf_field *f, enum cf_kind kind)
{
    for (int i = 0; i < f->n_axes; i++)
        if (f->axis[i].kind == kind) return &f->axis[i];
    return NULL;
}

bool cf_axis_is_longitude(const struct cf_axis *a)
{
    return a->kind == CF_X && (!a->units[0] || strncasecmp(a->units, "degree", 6) == 0);
}

/* Makes the longitudes ascend, or descend, by whole circles, where they jump by more than half of
 * one. False unless they are one circle at most. */
static bool unwrap(const double *at, double *to, size_t n, double sign)
{
    double turned = 0;
    to[0] = at[0];
    for (size_t i = 1; i < n; i++) {
        if (sign * (at[i] - at[i - 1]) < -180) turned += 360 * sign;
        to[i] = at[i] + turned;
        if (!(sign * (to[i] - to[i - 1]) > 0)) return false;
    }
    const double step = fabs(to[n - 1] - to[0]) / (double)(n - 1);
    return fabs(to[n - 1] - to[0]) <= 360 + step / 100;
}

void cf_unwrap(struct cf_axis *a)
{
    const bool degrees =
        strncasecmp(a->units, "degree", 6) == 0 || (!a->units[0] && text_has(a->name, "lon"));
    if (a->kind != CF_X || !degrees || !a->at || a->n < 2) return;
    if (a->n > 2 ? !grid_axis_fault(a->at, (uint32_t)a->n) : fabs(a->at[1] - a->at[0]) <= 180)
        return;
    double *to = xcalloc(a->n, sizeof *to);
    if (((a->n > 2 || a->at[1] < a->at[0]) && unwrap(a->at, to, a->n, 1)) ||
        unwrap(a->at, to, a->n, -1))
        memcpy(a->at, to, a->n * sizeof *to);
    free(to);
}

bool cf_same_axes(const struct cf_field *a, const struct cf_field *b)
{
    bool same = true;
    for (int k = CF_X; same && k <= CF_T; k++) {
        const struct cf_axis *p = cf_axis_of(a, (enum cf_kind)k),
                             *q = cf_axis_of(b, (enum cf_kind)k);
        same = !p == !q;
        if (!p || !q) continue;
        same = p->n == q->n && p->down == q->down && !p->at == !q->at &&
               (!p->at || memcmp(p->at, q->at, p->n * sizeof *p->at) == 0);
    }
    return same;
}

bool cf_interval(struct cf_file *c, const struct cf_axis *a, size_t i, double bounds[2])
{
    char name[CF_TEXT];
    int id, dims = 0, dim[NC_MAX_VAR_DIMS];
    size_t corners = 0;
    double at[2];
    cf_text(c, a->in, a->id, "bounds", name);
    if (!*name || nc_inq_varid(a->in, name, &id) ||
        nc_inq_var(a->in, id, NULL, NULL, &dims, dim, NULL) || dims != 2 || dim[0] != a->dim ||
        nc_inq_dimlen(a->in, dim[1], &corners) || corners != 2 ||
        nc_get_vara_double(a->in, id, (size_t[]){i, 0}, (size_t[]){1, 2}, at))
        return false;
    bounds[0] = fmin(at[0], at[1]);
    bounds[1] = fmax(at[0], at[1]);
    return bounds[0] < bounds[1];
}
