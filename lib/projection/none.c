/* none: takes the place of libproj where it is missing. */
#include "projection/projection.h"

bool projection_possible(void) { return false; }

struct projection *projection_open(const char *text, char err[ERR_BYTES])
{
    (void)text;
    err_set(err, "built without libproj-dev");
    return NULL;
}

bool projection_place(struct projection *p, double lon_deg, double lat_deg, double at[2])
{
    (void)p, (void)lon_deg, (void)lat_deg;
    at[0] = at[1] = (double)NAN;
    return false;
}

bool projection_degrees(struct projection *p, const double at[2], double degrees[2])
{
    (void)p, (void)at;
    degrees[0] = degrees[1] = (double)NAN;
    return false;
}

void projection_close(struct projection *p) { (void)p; }
