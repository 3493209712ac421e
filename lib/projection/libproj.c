/* libproj: places on planes through libproj (PROJ, OSGeo), which reads no grids here, and has no
 * network. */
#include "projection/projection.h"

#include <proj.h>
#include <stdlib.h>
#include <string.h>

#define RADIANS 0.017453292519943295

struct projection {
    PJ_CONTEXT *context;
    PJ *transformation;
    double unit; /* what PROJ has for a metre; of a rotated sphere, for a degree */
};

bool projection_possible(void) { return true; }

static bool transform(const struct projection *p, PJ_DIRECTION way, PJ_COORD from, double at[2])
{
    proj_errno_reset(p->transformation);
    const PJ_COORD to = proj_trans(p->transformation, way, from);
    at[0] = to.xy.x, at[1] = to.xy.y;
    return isfinite(at[0]) && isfinite(at[1]);
}

/* PROJ gives the degrees of a rotated sphere in radians, or in degrees: by version. Of four places
 * at right angles, one is far from 0. */
static double degree_of(const struct projection *p)
{
    double most = 0, at[2];
    for (int i = 0; i < 4; i++)
        if (transform(p, PJ_FWD, proj_coord(proj_torad(90 * i), 0, 0, 0), at))
            most = fmax(most, fmax(fabs(at[0]), fabs(at[1])));
    return most > 8 ? 1 : RADIANS;
}

static void say_nothing(void *data, int level, const char *text)
{
    (void)data, (void)level, (void)text; /* errors are returned */
}

struct projection *projection_open(const char *text, char err[ERR_BYTES])
{
    struct projection *p = xcalloc(1, sizeof *p);
    p->context = proj_context_create();
    if (!p->context) die(ST_SYSTEM, "PROJ has no memory");
    proj_log_func(p->context, NULL, say_nothing); /* no level silences all */
    proj_context_set_enable_network(p->context, 0);
    p->transformation = proj_create(p->context, text);
    if (p->transformation && proj_angular_input(p->transformation, PJ_FWD)) {
        p->unit = strstr(text, "+o_proj=longlat") ? degree_of(p) : 1;
        return p;
    }
    const int code = proj_context_errno(p->context);
    err_set(err, "PROJ refuses '%.160s': %s", text,
        code ? proj_context_errno_string(p->context, code) : "it is no projection");
    projection_close(p);
    return NULL;
}

bool projection_place(struct projection *p, double lon_deg, double lat_deg, double at[2])
{
    const PJ_COORD from = proj_coord(proj_torad(lon_deg), proj_torad(lat_deg), 0, 0);
    const bool is = transform(p, PJ_FWD, from, at);
    at[0] /= p->unit, at[1] /= p->unit;
    return is;
}

bool projection_degrees(struct projection *p, const double at[2], double degrees[2])
{
    const bool is =
        transform(p, PJ_INV, proj_coord(at[0] * p->unit, at[1] * p->unit, 0, 0), degrees);
    degrees[0] = proj_todeg(degrees[0]), degrees[1] = proj_todeg(degrees[1]);
    return is;
}

void projection_close(struct projection *p)
{
    if (!p) return;
    proj_destroy(p->transformation);
    proj_context_destroy(p->context);
    free(p);
}
