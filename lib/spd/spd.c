/* spd: the table of scenes. */
#include "spd/spd.h"
#include "spd/parts.h"

#include <string.h>

const struct spd_scene spd_scenes[] = {
    {"balls", 4, 25, "1 polygon, (9^(s+1)-1)/8 spheres", spd_balls_count, spd_balls},
    {"gears", 4, 22, "1 + 146 s^3 polygons, 2 s^3 of them with 144 corners", spd_gears_count,
        spd_gears},
    {"tetra", 6, -23, "4^s triangles", spd_tetra_count, spd_tetra},
};
const size_t spd_n_scenes = sizeof spd_scenes / sizeof *spd_scenes;

const struct spd_scene *spd_find(const char *name)
{
    for (size_t i = 0; i < spd_n_scenes; i++)
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
