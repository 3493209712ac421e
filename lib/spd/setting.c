/* setting: functions that the scenes share; see parts.h. */
#include "spd/parts.h"

#include <math.h>

static struct view turned(struct view v, double up_angle)
{
    struct vec3 ahead = v3_sub(v.at, v.from);
    struct vec3 right = v3_cross(ahead, v.up), up = v3_cross(right, ahead);
    up = v3_scale(up, v3_len(ahead) / v3_len(up));
    v.at = v3_add(v.from, v3_add(v3_scale(ahead, cos(up_angle)), v3_scale(up, sin(up_angle))));
    return v;
}

void spd_put_setting(struct nff_out *o, struct vec3 background, const struct view *v,
    double turn_deg, const struct vec3 *lights, size_t n)
{
    struct view seen = turn_deg != 0 ? turned(*v, SPD_PI * turn_deg / 180.0) : *v;
    nff_put_background(o, background.x, background.y, background.z);
    nff_put_view(o, &seen);
    for (size_t i = 0; i < n; i++) nff_put_light(o, &(struct light){.pos = lights[i]});
}

double spd_shine(double half_angle_deg)
{
    double angle = SPD_PI * half_angle_deg / 180.0;
    if (angle <= 0) return 100000;
    if (angle >= SPD_PI / 2) return 1;
    return log(0.5) / log(cos(angle));
}

void spd_put_patch(
    struct nff_out *o, struct patch_corner a, struct patch_corner b, struct patch_corner c)
{
    struct vec3 at[3] = {a.at, b.at, c.at}, normals[3] = {a.normal, b.normal, c.normal};
    nff_put_polygon(o, 3, at, normals);
}
