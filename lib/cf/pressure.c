/* pressure: whether pressures are those of air or of the sea. */
#include "cf/cf_int.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define AIR_MOST_PA 1.1e5  /* the greatest pressure at the ground was 1085 hPa */
#define SEA_MOST_PA 1.15e8 /* the deepest trench has 11300 dbar */

double cf_in_pascals(const char *units)
{
    bool hecto = strcmp(units, "hPa") == 0 || strcmp(units, "mb") == 0 ||
                 strcmp(units, "mbar") == 0 || strncmp(units, "millibar", 8) == 0;
    return hecto ? 100 : strcmp(units, "dbar") == 0 ? 1e4 : cf_in_units(units, "Pa");
}

static bool is_of_sea(const char *text)
{
    return text_has(text, "sea_water") || text_has(text, "sea water") ||
           text_has(text, "seawater") || text_has(text, "ocean");
}

/* The standard name decides, then the unit, then other texts of the axis and the field. */
static bool is_sea(struct cf_file *c, const struct cf_field *f, const struct cf_axis *z)
{
    char standard[CF_TEXT], about[CF_TEXT], of_field[CF_TEXT];
    cf_text(c, z->in, z->id, "standard_name", standard);
    cf_text(c, z->in, z->id, "long_name", about);
    cf_text(c, f->group, f->id, "standard_name", of_field);
    if (is_of_sea(standard)) return true;
    if (text_has(standard, "air_pressure")) return false;
    const bool decibar = strncasecmp(z->units, "dbar", 4) == 0 || text_has(z->units, "decibar");
    return decibar || is_of_sea(about) || is_of_sea(of_field) || is_of_sea(f->long_name);
}

bool cf_sea_levels(
    struct cf_file *c, const struct cf_field *f, double **pascals, bool *sea, char err[ERR_BYTES])
{
    const struct cf_axis *z = cf_axis_of(f, CF_Z), *y = cf_axis_of(f, CF_Y);
    const double unit = cf_in_pascals(z->units);
    *pascals = NULL;
    *sea = z->pressure && is_sea(c, f, z);
    if (!z->pressure || unit <= 0) return true;
    const double most = *sea ? SEA_MOST_PA : AIR_MOST_PA;
    for (size_t k = 0; k < z->n; k++) {
        const double p = z->at[k] * unit;
        if (p <= most && (p >= 0 || !*sea)) continue;
        return err_set(err,
            "%.60s has the level %g %.20s, expected %g hPa at most in air, or in the sea, by the "
            "standard_name sea_water_pressure, 0 to %g dbar",
            z->name, z->at[k], z->units, AIR_MOST_PA / 100, SEA_MOST_PA / 1e4);
    }
    if (!*sea) return true;
    if (y->rotated || strncasecmp(y->units, "degree", 6) != 0)
        return err_set(err, "depths of pressures need the latitude, expected y in degrees north");
    *pascals = xcalloc(z->n, sizeof **pascals);
    for (size_t k = 0; k < z->n; k++) (*pascals)[k] = z->at[k] * unit;
    return true;
}

bool cf_looks_like_hectopascals(const struct cf_axis *z)
{
    static const double usual[] = {1000, 975, 950, 925, 900, 875, 850, 800, 750, 700, 650, 600, 550,
        500, 450, 400, 350, 300, 250, 200, 150, 100, 70, 50, 30, 20, 10, 7, 5, 3, 2, 1};
    size_t hits = 0;
    double most = 0;
    if (z->made || !z->at || z->units[0] || z->down) return false;
    for (size_t k = 0; k < z->n; k++) {
        const double p = z->at[k];
        if (!(p > 0 && p <= AIR_MOST_PA / 100)) return false;
        most = fmax(most, p);
        for (size_t i = 0; i < sizeof usual / sizeof *usual; i++) hits += fabs(p - usual[i]) <= 0;
    }
    return z->n > 1 && most >= 500 && 4 * hits >= 3 * z->n;
}
