/* The table of scenes. */
#include "spd/spd.h"
#include "spd/parts.h"

#include <string.h>

const struct spd_scene spd_scenes[] = {
    {"balls", 4, 25, "1 polygon, (9^(s+1)-1)/8 spheres", spd_balls_count, spd_balls},
    {"gears", 4, 22, "1 + 146 s^3 polygons, 2 s^3 of them with 144 corners", spd_gears_count,
        spd_gears},
    {"tetra", 6, -23, "4^s triangles", spd_tetra_count, spd_tetra},
};
const size_t n_spd_scenes = sizeof spd_scenes / sizeof *spd_scenes;

const struct spd_scene *spd_find(const char *name)
{
    for (size_t i = 0; i < n_spd_scenes; i++)
        if (strcmp(spd_scenes[i].name, name) == 0) return &spd_scenes[i];
    return NULL;
}

void spd_write(const struct spd_scene *scene, struct nff_out *o, int size, bool imbalanced)
{
    scene->write(o, size, imbalanced ? scene->imbalanced_deg : 0);
}

int spd_size_max(const struct spd_scene *scene)
{
    int size = 1;
    while (scene->count(size + 1) <= SPD_PRIMS_MAX) size++;
    return size;
}

static struct view turned(struct view v, double up_angle)
{
    struct vec3 ahead = v3_sub(v.at, v.from);
    struct vec3 right = v3_cross(ahead, v.up), up = v3_cross(right, ahead);
    up = v3_scale(up, v3_len(ahead) / v3_len(up));
    v.at = v3_add(v.from, v3_add(v3_scale(ahead, cos(up_angle)), v3_scale(up, sin(up_angle))));
    return v;
}

void spd_put_setting(
    struct nff_out *o, const struct view *v, double turn_deg, const struct vec3 *lights, size_t n)
{
    struct view seen = turn_deg != 0 ? turned(*v, SPD_PI * turn_deg / 180.0) : *v;
    nff_put_background(o, 0.078, 0.361, 0.753); /* the sky over Chapel Hill */
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

struct mat3 spd_rotate_z(double angle)
{
    double c = cos(angle), s = sin(angle);
    return (struct mat3){{v3(c, s, 0), v3(-s, c, 0), v3(0, 0, 1)}};
}
