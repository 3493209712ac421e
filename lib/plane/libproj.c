/* libproj: calls of PROJ. */
#include "plane/plane_int.h"

#include <math.h>
#include <proj.h>

bool plane_proj_open(struct plane *p, const char *text, char err[ERR_BYTES])
{
    PJ_CONTEXT *c = p->context = proj_context_create();
    if (!c) return err_set(err, "PROJ has no memory");
    proj_log_level(c, PJ_LOG_NONE);
    proj_context_set_enable_network(c, 0);
    PJ *proj = p->proj = proj_create(c, text);
    if (!proj || !proj_angular_input(proj, PJ_FWD))
        return err_set(err, "PROJ refuses '%.200s', expected a projection", text);
    return true;
}

void plane_proj_free(struct plane *p)
{
    proj_destroy(p->proj);
    if (p->context) proj_context_destroy(p->context);
}

static bool finite_of(PJ *proj, PJ_COORD c, struct plane_at *at)
{
    *at = (struct plane_at){c.xy.x, c.xy.y};
    if (isfinite(at->x) && isfinite(at->y)) return true;
    proj_errno_reset(proj);
    return false;
}

bool plane_proj_forward(const struct plane *p, struct plane_at degrees, struct plane_at *at)
{
    const PJ_COORD c = proj_coord(proj_torad(degrees.x), proj_torad(degrees.y), 0, 0);
    return finite_of(p->proj, proj_trans(p->proj, PJ_FWD, c), at);
}

bool plane_proj_inverse(const struct plane *p, struct plane_at at, struct plane_at *degrees)
{
    const PJ_COORD c = proj_coord(at.x, at.y, 0, 0);
    if (!finite_of(p->proj, proj_trans(p->proj, PJ_INV, c), degrees)) return false;
    degrees->x = proj_todeg(degrees->x);
    degrees->y = proj_todeg(degrees->y);
    return true;
}
