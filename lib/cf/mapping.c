/*
 * mapping: the plane of a projection that a grid mapping states. CF conventions 1.10, appendix F
 * "Grid Mappings".
 */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>

#define EARTH_M 6371229. /* radius, where a file states none: that of most weather models */

/* The grid mappings, and PROJ's names. */
static const struct mapping {
    const char *name, *proj;
    const char *parallel[2]; /* PROJ's keys of the standard parallels */
    bool needs_lat, needs_parallel;
} mappings[] = {{"lambert_conformal_conic", "lcc", {"lat_1", "lat_2"}, true, true},
    {"albers_conical_equal_area", "aea", {"lat_1", "lat_2"}, true, true},
    {"polar_stereographic", "stere", {"lat_ts"}, true, false},
    {"stereographic", "stere", {NULL}, true, false}, {"mercator", "merc", {"lat_ts"}, false, false},
    {"transverse_mercator", "tmerc", {NULL}, true, false},
    {"oblique_mercator", "omerc", {NULL}, true, false},
    {"lambert_azimuthal_equal_area", "laea", {NULL}, true, false},
    {"azimuthal_equidistant", "aeqd", {NULL}, true, false},
    {"lambert_cylindrical_equal_area", "cea", {"lat_ts"}, false, false},
    {"sinusoidal", "sinu", {NULL}, false, false}, {"orthographic", "ortho", {NULL}, true, false},
    {"vertical_perspective", "nsper", {NULL}, true, false},
    {"geostationary", "geos", {NULL}, false, false}};

/* ---- attributes ------------------------------------------------------------------------------ */

/* A variable with attributes. */
struct place {
    struct cf_file *c;
    int group, id;
};

static bool real(const struct place *at, const char *name, double *out)
{
    double both[2];
    if (!cf_reals(at->c, at->group, at->id, name, both)) return false;
    *out = both[0];
    return true;
}

/* Appends an attribute as a key. */
static bool add(
    const struct place *at, const char *name, const char *key, char text[PROJECTION_TEXT])
{
    double v;
    if (!real(at, name, &v)) return false;
    projection_add(text, key, v);
    return true;
}

static void add_earth(const struct place *at, char text[PROJECTION_TEXT])
{
    static const struct {
        const char *part; /* of a name */
        double a, flattening;
    } known[] = {{"wgs", 6378137, 298.257223563}, {"grs", 6378137, 298.257222101},
        {"bessel 1841", 6377397.155, 299.1528128}, {"airy 1830", 6377563.396, 299.3249646},
        {"international 1924", 6378388, 297}, {"krass", 6378245, 298.3}};
    double a = EARTH_M, b, flattening = 0;
    char name[CF_TEXT];
    cf_text(at->c, at->group, at->id, "reference_ellipsoid_name", name);
    if (!*name) cf_text(at->c, at->group, at->id, "horizontal_datum_name", name);
    if (real(at, "semi_major_axis", &a)) {
        if (a < 1e4) a *= 1000; /* in km, against the conventions */
        b = a;
        if (real(at, "inverse_flattening", &flattening) && flattening > 1) b = a - a / flattening;
        else if (real(at, "semi_minor_axis", &b) && b < 1e4) b *= 1000;
        if (flattening > 1) {
            projection_add(text, "a", a);
            projection_add(text, "rf", flattening);
        } else projection_earth(text, a, b);
        return;
    }
    size_t i = 0, n = sizeof known / sizeof *known;
    const bool radius = real(at, "earth_radius", &a);
    while (!radius && i < n && !text_has(name, known[i].part)) i++;
    if (radius || i == n) projection_earth(text, a < 1e4 ? 1000 * a : a, a < 1e4 ? 1000 * a : a);
    else projection_add(text, "a", known[i].a), projection_add(text, "rf", known[i].flattening);
}

/* ---- the plane ------------------------------------------------------------------------------- */

static bool lacks(const char *mapping, const char *what, char err[ERR_BYTES])
{
    return err_set(err, "its grid mapping %.40s has no number %.60s", mapping, what);
}

static bool rotated(const struct place *at, char text[PROJECTION_TEXT], char err[ERR_BYTES])
{
    double lat, lon, turned = 0;
    if (!real(at, "grid_north_pole_latitude", &lat))
        return lacks("rotated_latitude_longitude", "grid_north_pole_latitude", err);
    if (!real(at, "grid_north_pole_longitude", &lon))
        return lacks("rotated_latitude_longitude", "grid_north_pole_longitude", err);
    real(at, "north_pole_grid_longitude", &turned);
    projection_rotated(text, lat, lon, turned);
    return true;
}

/* Appends the height from which the earth is seen, and the axis about which a satellite's scan
 * sweeps. */
static bool add_satellite(const struct place *at, char text[PROJECTION_TEXT])
{
    char sweep[CF_TEXT], fixed[CF_TEXT];
    cf_text(at->c, at->group, at->id, "sweep_angle_axis", sweep);
    cf_text(at->c, at->group, at->id, "fixed_angle_axis", fixed);
    const size_t n = strlen(text);
    if (strcmp(sweep, "x") == 0 || strcmp(fixed, "y") == 0)
        snprintf(text + n, PROJECTION_TEXT - n, " +sweep=x");
    return add(at, "perspective_point_height", "h", text);
}

/* Writes the string of one of the table. metres: in a unit of the coordinates, and of their false
 * origin. */
static bool compose(const struct place *at, const struct mapping *m, double metres,
    char text[PROJECTION_TEXT], char err[ERR_BYTES])
{
    static const char *const lons[] = {"longitude_of_projection_origin",
        "longitude_of_central_meridian", "straight_vertical_longitude_from_pole"};
    double parallel[2], v;
    bool lon = false;
    snprintf(text, PROJECTION_TEXT, "+proj=%s", m->proj);
    size_t n =
        m->parallel[0] ? cf_reals(at->c, at->group, at->id, "standard_parallel", parallel) : 0;
    if (n == 1) parallel[1] = parallel[0];
    for (size_t i = 0; n && i < 2 && m->parallel[i]; i++)
        projection_add(text, m->parallel[i], parallel[i]);
    if (!n && m->needs_parallel) return lacks(m->name, "standard_parallel", err);
    if (m->needs_lat && !add(at, "latitude_of_projection_origin", "lat_0", text))
        return lacks(m->name, "latitude_of_projection_origin", err);
    const char *key = strcmp(m->proj, "omerc") == 0 ? "lonc" : "lon_0";
    for (size_t i = 0; !lon && i < sizeof lons / sizeof *lons; i++)
        lon = add(at, lons[i], key, text);
    if (!lon) return lacks(m->name, lons[0], err);
    const bool above = strcmp(m->proj, "geos") == 0 || strcmp(m->proj, "nsper") == 0;
    if (above && !add_satellite(at, text)) return lacks(m->name, "perspective_point_height", err);
    add(at, "azimuth_of_central_line", "alpha", text);
    if (!n && !add(at, "scale_factor_at_projection_origin", "k_0", text))
        add(at, "scale_factor_at_central_meridian", "k_0", text);
    if (real(at, "false_easting", &v) && fabs(v) > 0) projection_add(text, "x_0", v * metres);
    if (real(at, "false_northing", &v) && fabs(v) > 0) projection_add(text, "y_0", v * metres);
    if (real(at, "longitude_of_prime_meridian", &v) && fabs(v) > 0) projection_add(text, "pm", v);
    add_earth(at, text);
    return true;
}

/* Finds the variable that a word of the attribute grid_mapping names, in the group or around it. */
static bool find_mapping(struct cf_file *c, const struct cf_field *f, char *word, struct place *at)
{
    char *colon = strchr(word, ':');
    if (colon) *colon = '\0';
    *at = (struct place){c, f->group, -1};
    return *word && cf_find_above(&at->group, word, &at->id);
}

/* Metres in a unit of a coordinate; 0 if it is no length. */
static double metres_in(const char *unit)
{
    return strcmp(unit, "m") == 0    ? 1
           : strcmp(unit, "km") == 0 ? 1000
           : *unit                   ? cf_in_units(unit, "m")
                                     : 0;
}

/* The same on the field's plane, where angles may be places. */
static double metres_on(const struct cf_field *f, const char *unit)
{
    const double metres = metres_in(unit);
    if (metres > 0 || f->radian_m <= 0) return metres;
    return f->radian_m * (strcmp(unit, "rad") == 0 ? 1 : cf_in_units(unit, "rad"));
}

void cf_mapping_read(struct cf_file *c, struct cf_field *f)
{
    char *words = cf_whole_text(c, f->group, f->id, "grid_mapping"), *rest = words, *word;
    double metres = 1;
    bool lengths = false;
    for (int i = 0; i < f->n_axes; i++) {
        const double in =
            f->axis[i].at && f->axis[i].kind == CF_X ? metres_in(f->axis[i].units) : 0;
        if (in > 0) metres = in, lengths = true;
    }
    while (!*f->plane && (word = text_part(&rest, ' ')) != NULL) {
        char name[CF_TEXT];
        struct place at;
        if (!find_mapping(c, f, word, &at)) continue;
        cf_text(c, at.group, at.id, "grid_mapping_name", name);
        bool good = true, known = strcmp(name, "rotated_latitude_longitude") == 0;
        if (known) good = rotated(&at, f->plane, f->plane_fault);
        for (size_t i = 0; i < sizeof mappings / sizeof *mappings; i++) {
            if (strcmp(name, mappings[i].name) != 0) continue;
            known = true;
            good = compose(&at, &mappings[i], metres, f->plane, f->plane_fault);
            if (strcmp(name, "geostationary") == 0)
                real(&at, "perspective_point_height", &f->radian_m);
        }
        if (!good) *f->plane = '\0';
        else if (!known && !*name && lengths)
            err_set(f->plane_fault, "its grid mapping has no grid_mapping_name, expected one of "
                                    "nc2vtk(1)");
        else if (!known && *name && strcmp(name, "latitude_longitude") != 0)
            err_set(f->plane_fault, "its grid mapping is %.60s, expected one of nc2vtk(1)", name);
    }
    free(words);
}

void cf_mapping_use(struct cf_field *f)
{
    struct projection *p;
    char err[ERR_BYTES];
    const bool rotated = strstr(f->plane, "+o_proj") != NULL;
    bool fits = *f->plane;
    for (int i = 0; fits && i < f->n_axes; i++) {
        const struct cf_axis *a = &f->axis[i];
        if (a->kind > CF_Y) continue;
        fits = rotated ? strncmp(a->units, "degree", 6) == 0 : metres_on(f, a->units) > 0;
    }
    if (fits && projection_possible()) {
        p = projection_open(f->plane, err);
        if (!p) err_set(f->plane_fault, "%s", err);
        fits = p != NULL;
        projection_close(p);
    }
    if (!fits) *f->plane = '\0';
    for (int i = 0; fits && i < f->n_axes; i++) {
        struct cf_axis *a = &f->axis[i];
        if (a->kind > CF_Y) continue;
        a->rotated = a->rotated || rotated;
        if (rotated) continue;
        const double metres = metres_on(f, a->units);
        for (size_t k = 0; metres != 1 && k < a->n; k++) a->at[k] *= metres;
        snprintf(a->units, CF_TEXT, "m");
    }
}
