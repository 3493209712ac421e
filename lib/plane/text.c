/* text: writes strings of PROJ. */
#include "plane/plane.h"

#include <string.h>

void plane_add(char text[PLANE_TEXT], const char *key, double v)
{
    const size_t n = strlen(text);
    if (!n) return;
    const int more = snprintf(text + n, PLANE_TEXT - n, " +%s=%.10g", key, v + 0.0); /* no -0 */
    if (!isfinite(v) || more < 0 || (size_t)more >= PLANE_TEXT - n) *text = '\0';
}

void plane_earth(char text[PLANE_TEXT], double a_m, double b_m)
{
    const bool sphere = fabs(a_m - b_m) < 1e-3;
    plane_add(text, sphere ? "R" : "a", a_m);
    if (!sphere) plane_add(text, "b", b_m);
}

void plane_rotated(
    char text[PLANE_TEXT], double pole_lat_deg, double pole_lon_deg, double turned_deg)
{
    snprintf(text, PLANE_TEXT, "+proj=ob_tran +o_proj=longlat");
    plane_add(text, "o_lat_p", pole_lat_deg);
    plane_add(text, "o_lon_p", turned_deg);
    plane_add(text, "lon_0", remainder(pole_lon_deg + 180, 360));
}
