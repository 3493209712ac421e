/* text: writes strings of PROJ. */
#include "projection/projection.h"

#include <string.h>

void projection_add(char text[PROJECTION_TEXT], const char *key, double v)
{
    const size_t n = strlen(text);
    if (!n) return;
    const int more =
        snprintf(text + n, PROJECTION_TEXT - n, " +%s=%.10g", key, v + 0.0); /* no -0 */
    if (!isfinite(v) || more < 0 || (size_t)more >= PROJECTION_TEXT - n) *text = '\0';
}

void projection_earth(char text[PROJECTION_TEXT], double a_m, double b_m)
{
    const bool sphere = fabs(a_m - b_m) < 1e-3;
    projection_add(text, sphere ? "R" : "a", a_m);
    if (!sphere) projection_add(text, "b", b_m);
}

void projection_rotated(
    char text[PROJECTION_TEXT], double pole_lat_deg, double pole_lon_deg, double turned_deg)
{
    snprintf(text, PROJECTION_TEXT, "+proj=ob_tran +o_proj=longlat");
    projection_add(text, "o_lat_p", pole_lat_deg);
    projection_add(text, "o_lon_p", turned_deg);
    projection_add(text, "lon_0", remainder(pole_lon_deg + 180, 360));
}
