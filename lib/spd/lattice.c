/*
 * lattice: mirroring spheres at the nodes of a cubic grid of size^3 cells, joined by matt cylinders
 * that are red along x, green along y and blue along z. The eye is within, on top. Six lights, one
 * beyond each face. After A. Costa's lattice in the Standard Procedural Databases.
 */
#include "spd/parts.h"

/* Radii, in edges of a cell. */
#define SPHERE (1.0 / 4.0)
#define ROD (1.0 / 16.0)

static const struct vec3 lights[] = {
    {2, 0.5, 0.5}, {-1, 0.5, 0.5}, {0.5, 2, 0.5}, {0.5, -1, 0.5}, {0.5, 0.5, 2}, {0.5, 0.5, -1}};

uint64_t spd_lattice_count(int size)
{
    uint64_t n = (uint64_t)size, nodes = n + 1;
    return nodes * nodes * nodes + 3 * n * nodes * nodes;
}

static struct view view_of(int size)
{
    double across = ((double)(size / 2) + 0.5) * (1.0 / size);
    return (struct view){.from = {across, 1, 1.0 - 1.0 / (2.0 * size)},
        .at = {across, -1, -1.0 - 1.0 / (2.0 * size)},
        .up = {0.2, 1, 0},
        .angle_deg = 60,
        .hither = 0,
        .res_x = 512,
        .res_y = 512};
}

/* The cylinders from one node to its next neighbours, which begin and end within the spheres. */
static void put_rods(struct nff_out *o, int size, const int node[3], struct vec3 center)
{
    static const struct vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double inset = SPHERE / size * (1.0 - sqrt(ROD / SPHERE)) * 0.99;
    for (int i = 0; i < 3; i++) {
        if (node[i] == size) continue;
        struct vec3 c = v3_add(v3(0.1, 0.1, 0.1), v3_scale(axes[i], 0.8));
        struct vec3 end = v3_sub(v3_mad(center, axes[i], 1.0 / size), v3_scale(axes[i], inset));
        nff_put_material(o, &(struct material){c.x, c.y, c.z, 0.99, 0, spd_shine(0), 0, 0});
        nff_put_cone(o, v3_mad(center, axes[i], inset), ROD / size, end, ROD / size);
    }
}

void spd_lattice(struct nff_out *o, int size, double turn_deg)
{
    struct view view = view_of(size);
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    int node[3];
    for (node[0] = 0; node[0] <= size; node[0]++)
        for (node[1] = 0; node[1] <= size; node[1]++)
            for (node[2] = 0; node[2] <= size; node[2]++) {
                struct vec3 center =
                    v3((double)node[0] / size, (double)node[1] / size, (double)node[2] / size);
                nff_put_material(
                    o, &(struct material){0.9, 0.9, 0.9, 0.5, 0.5, spd_shine(37), 0, 0});
                nff_put_sphere(o, center, SPHERE / size);
                put_rods(o, size, node, center);
            }
}
