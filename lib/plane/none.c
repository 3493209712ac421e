/* none: takes the place of libproj where it is missing. */
#include "plane/plane_int.h"

bool plane_proj_open(struct plane *p, const char *text, char err[ERR_BYTES])
{
    (void)p, (void)text;
    return err_set(err, "built without libproj-dev");
}

void plane_proj_free(struct plane *p) { (void)p; }

bool plane_proj_forward(const struct plane *p, struct plane_at degrees, struct plane_at *at)
{
    (void)p, (void)degrees, (void)at;
    return false;
}

bool plane_proj_inverse(const struct plane *p, struct plane_at at, struct plane_at *degrees)
{
    (void)p, (void)at, (void)degrees;
    return false;
}
