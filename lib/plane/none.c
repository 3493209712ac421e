/* none: takes the place of proj where libproj is missing. */
#include "plane/plane.h"

bool plane_possible(void) { return false; }

struct plane *plane_open(const char *text, char err[ERR_BYTES])
{
    err_set(err, "built without libproj-dev, expected no places on '%s'", text);
    return NULL;
}

bool plane_place(struct plane *p, double lon_deg, double lat_deg, double at[2])
{
    (void)p, (void)lon_deg, (void)lat_deg, (void)at;
    return false;
}

void plane_close(struct plane *p) { (void)p; }
