/*
 * wrf: what files of the model WRF have instead of the conventions: staggered dimensions, a plane
 * in global attributes, and times as texts. W.C. Skamarock and others, "A Description of the
 * Advanced Research WRF Model Version 4", NCAR/TN-556+STR, 2019.
 */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>

#define EARTH_M 6370000. /* radius */

void cf_wrf_center(struct cf_field *f)
{
    static const char *const of_grid[] = {"west_east_stag", "south_north_stag", "bottom_top_stag"};
    for (int i = 0; i < f->n_axes; i++) {
        struct cf_axis *a = &f->axis[i];
        bool is = false; /* soil_layers_stag is not: its layers are no edges of others */
        for (size_t k = 0; k < sizeof of_grid / sizeof *of_grid; k++)
            is = is || strcmp(a->name, of_grid[k]) == 0;
        if (!is || a->chosen || a->n < 2) continue;
        if (a->at && a->in >= 0) continue; /* it has coordinates */
        a->name[strlen(a->name) - strlen("_stag")] = '\0';
        a->n--;
        a->staggered = true;
    }
}

static double number(struct cf_file *c, const char *name)
{
    double both[2];
    return cf_reals(c, c->root, NC_GLOBAL, name, both) ? both[0] : (double)NAN;
}

void cf_wrf_plane(struct cf_file *c, char text[PROJECTION_TEXT])
{
    const double kind = number(c, "MAP_PROJ"),
                 middle = number(c, "MOAD_CEN_LAT"); /* of all nests */
    const double first = number(c, "TRUELAT1"), second = number(c, "TRUELAT2");
    const double pole = number(c, "POLE_LAT"), stand = number(c, "STAND_LON");
    if (kind == 1) {
        snprintf(text, PROJECTION_TEXT, "+proj=lcc");
        projection_add(text, "lat_1", first);
        projection_add(text, "lat_2", fabs(second) <= 90 ? second : first);
        projection_add(text, "lat_0", isfinite(middle) ? middle : first);
        projection_add(text, "lon_0", stand);
    } else if (kind == 2) {
        snprintf(text, PROJECTION_TEXT, "+proj=stere");
        projection_add(text, "lat_0", first < 0 ? -90 : 90);
        projection_add(text, "lat_ts", first);
        projection_add(text, "lon_0", stand);
    } else if (kind == 3) {
        snprintf(text, PROJECTION_TEXT, "+proj=merc");
        projection_add(text, "lat_ts", first);
        projection_add(text, "lon_0", number(c, "CEN_LON"));
    } else if (kind == 6 && fabs(pole) < 90) {
        projection_rotated(text, pole, 180 - stand, number(c, "POLE_LON"));
        return;
    }
    projection_earth(text, EARTH_M, EARTH_M); /* of none of them, the text stays empty */
}

/* ---- times ----------------------------------------------------------------------------------- */

/* Hours since the year 0 of a text such as 2026-11-28_06:00:00; NaN if it is none. */
static double hours_of(const char *text)
{
    static const char form[] = "0000-00-00_00:00:00";
    long part[6] = {0};
    for (size_t i = 0, p = 0; form[i]; i++) {
        const bool digit = form[i] == '0';
        if (digit ? text[i] < '0' || text[i] > '9' : text[i] != form[i]) return (double)NAN;
        if (digit) part[p] = 10 * part[p] + (text[i] - '0');
        else p++;
    }
    /* March is the first month, so that a leap day is the last of its year. */
    const long m = (part[1] + 9) % 12, y = part[0] - (m > 9);
    const long days = 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + part[2];
    return 24. * (double)days + (double)part[3] + (double)part[4] / 60 + (double)part[5] / 3600;
}

/* Reads Times, of texts. */
static bool texts(struct cf_file *c, int group, int id, struct cf_axis *a)
{
    char text[20] = "", first[20] = "";
    for (size_t i = 0; i < a->n; i++) {
        const size_t start[2] = {i, 0}, count[2] = {1, 19};
        if (!cf_did(c, nc_get_vara_text(group, id, start, count, text))) return false;
        if (i == 0) memcpy(first, text, sizeof first);
        a->at[i] = hours_of(text) - hours_of(first);
        if (!isfinite(a->at[i])) return false;
    }
    snprintf(a->units, CF_TEXT, "hours since %.10s %.8s", first, first + 11);
    return true;
}

void cf_wrf_times(struct cf_file *c, int group, struct cf_axis *a)
{
    int id, n, dims[NC_MAX_VAR_DIMS];
    nc_type type;
    size_t length = 0;
    if (!a->n) return;
    a->at = xcalloc(a->n, sizeof *a->at);
    bool good = nc_inq_varid(group, "XTIME", &id) == NC_NOERR &&
                nc_inq_var(group, id, NULL, &type, &n, dims, NULL) == NC_NOERR && n == 1 &&
                dims[0] == a->dim && type != NC_CHAR && type < NC_STRING;
    if (good) cf_text(c, group, id, "units", a->units);
    good = good && strstr(a->units, " since ") && cf_did(c, nc_get_var_double(group, id, a->at));
    if (good) return;
    a->units[0] = '\0';
    good = nc_inq_varid(group, "Times", &id) == NC_NOERR &&
           nc_inq_var(group, id, NULL, &type, &n, dims, NULL) == NC_NOERR && n == 2 &&
           dims[0] == a->dim && type == NC_CHAR &&
           nc_inq_dimlen(group, dims[1], &length) == NC_NOERR && length >= 19;
    if (good && texts(c, group, id, a)) return;
    free(a->at);
    a->at = NULL;
}
