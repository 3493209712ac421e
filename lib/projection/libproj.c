/* libproj: places on planes through libproj (PROJ, OSGeo). */
#include "projection/projection.h"

#include <proj.h>
#include <stdlib.h>
#include <string.h>

struct projection {
    PJ_CONTEXT *context;
    PJ *transformation;
    bool degrees; /* a rotated sphere */
};

bool projection_possible(void) { return true; }

struct projection *projection_open(const char *text, char err[ERR_BYTES])
{
    struct projection *p = xcalloc(1, sizeof *p);
    p->context = proj_context_create();
    proj_log_level(p->context, PJ_LOG_NONE);
    p->transformation = proj_create(p->context, text);
    p->degrees = strstr(text, "+o_proj=longlat") != NULL;
    if (p->transformation) return p;
    const int code = proj_context_errno(p->context);
    err_set(err, "PROJ refuses '%s': %s", text, proj_context_errno_string(p->context, code));
    projection_close(p);
    return NULL;
}

bool projection_place(struct projection *p, double lon_deg, double lat_deg, double at[2])
{
    const PJ_COORD from = proj_coord(proj_torad(lon_deg), proj_torad(lat_deg), 0, 0);
    proj_errno_reset(p->transformation);
    const PJ_COORD to = proj_trans(p->transformation, PJ_FWD, from);
    at[0] = p->degrees ? proj_todeg(to.xy.x) : to.xy.x;
    at[1] = p->degrees ? proj_todeg(to.xy.y) : to.xy.y;
    return isfinite(at[0]) && isfinite(at[1]);
}

void projection_close(struct projection *p)
{
    if (!p) return;
    proj_destroy(p->transformation);
    proj_context_destroy(p->context);
    free(p);
}
