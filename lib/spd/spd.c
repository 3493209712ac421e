/* spd: the table of scenes. */
#include "spd/spd.h"
#include "spd/parts.h"

#include <string.h>

/* Sorted by name. The texts are those of `spdgen -h`, of `spdgen -l` and of spdgen(1). */
const struct spd_scene spd_scenes[] = {
    {"balls", 4, 25, "The sphereflake: a mirroring sphere carries nine smaller ones, and so on",
        "1 polygon, (9^(s+1)-1)/8 spheres", spd_balls_count, spd_balls},
    {"gears", 4, 22, "A block of meshing gears, every fifth of glass, on a mirroring floor",
        "1 + 146 s^3 polygons, 2 s^3 of them with 144 corners", spd_gears_count, spd_gears},
    {"jacks", 1, 0, "A jack of three rods with knobs, and eight smaller ones around it",
        "6 (8^s-1)/7 spheres, 3 (8^s-1)/7 cylinders", spd_jacks_count, spd_jacks},
    {"lattice", 12, 0, "Mirroring spheres at the nodes of a cubic lattice of matt rods",
        "(s+1)^3 spheres, 3 s (s+1)^2 cylinders", spd_lattice_count, spd_lattice},
    {"mount", 6, 0, "A fractal mountain of triangles behind four glass spheres",
        "4 spheres, 2 4^s triangles", spd_mount_count, spd_mount},
    {"nurbtst", 1, 0, "A B-spline surface as triangles with normals", "1500 patches, at every s",
        spd_nurbtst_count, spd_nurbtst},
    {"rings", 7, 0, "A pyramid of objects of six rings each before a wall",
        "1 polygon, 5 s (s+1) (2s+1) spheres and as many cylinders", spd_rings_count, spd_rings},
    {"sample", 1, 0, "Three tori, a cone and a disc",
        "864 patches, 16 triangles, 1 cone, at every s", spd_sample_count, spd_sample},
    {"shells", 5, 0, "A sea shell of overlapping spheres along a spiral", "180 2^s + 1 spheres",
        spd_shells_count, spd_shells},
    {"sombrero", 1, 0, "A damped cosine wave as a height field of triangles",
        "2 (16 2^s - 1)^2 triangles", spd_sombrero_count, spd_sombrero},
    {"teapot", 6, 0, "The teapot as triangles with normals, on a mirroring chessboard",
        "s^2 polygons, 64 s^2 - 8 s patches", spd_teapot_count, spd_teapot},
    {"tetra", 6, -23, "A tetrahedron of tetrahedra, which does not reflect", "4^s triangles",
        spd_tetra_count, spd_tetra},
    {"tree", 11, 0, "A tree of cones and spheres on a field, under seven lights",
        "1 polygon, 2^(s+1)-1 spheres and as many cones", spd_tree_count, spd_tree},
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
    while (size < SPD_SIZE_MAX && scene->count(size + 1) <= SPD_PRIMS_MAX) size++;
    return size;
}
