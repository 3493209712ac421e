/*
 * jacks: three crossed cylinders with spheres at their six ends. In each octant between the arms is
 * a jack of half the size, and so on, size - 1 times. One light. After A. Enzmann's jacks in the
 * Standard Procedural Databases.
 */
#include "spd/parts.h"

static const struct view view = {.from = {0, 0, -8},
    .up = {0, 1, 0},
    .angle_deg = 25,
    .hither = 0.001,
    .res_x = 256,
    .res_y = 256};
static const struct vec3 lights[] = {{-10, 3, -20}};
static const struct vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

uint64_t spd_jacks_count(int size)
{
    uint64_t jacks = 1, level = 1;
    for (int i = 1; i < size; i++) jacks += level *= 8;
    return 9 * jacks;
}

/* The arms end at 0.75 of the octants' edges, so that jacks of different sizes stay apart. */
static void put_jack(struct nff_out *o, const struct affine *place)
{
    struct affine shrink = {.m = spd_scale(0.75)}, at = spd_compose(&shrink, place);
    double factor = v3_len(at.m.row[0]);
    for (int i = 0; i < 3; i++)
        nff_put_cone(o, spd_move(v3_scale(axes[i], -1), &at), 0.1 * factor, spd_move(axes[i], &at),
            0.1 * factor);
    for (int side = 1; side >= -1; side -= 2)
        for (int i = 0; i < 3; i++)
            nff_put_sphere(o, spd_move(v3_scale(axes[i], side), &at), 0.2 * factor);
}

static void put_jacks(struct nff_out *o, int depth, const struct affine *place)
{
    put_jack(o, place);
    if (depth == 1) return;
    for (int octant = 0; octant < 8; octant++) {
        struct affine half = {.m = spd_scale(0.5),
            .shift = v3(octant & 4 ? 0.5 : -0.5, octant & 2 ? 0.5 : -0.5, octant & 1 ? 0.5 : -0.5)};
        struct affine inner = spd_compose(&half, place);
        put_jacks(o, depth - 1, &inner);
    }
}

void spd_jacks(struct nff_out *o, int size, double turn_deg)
{
    spd_put_setting(o, v3(0.2, 0.05, 0.2), &view, turn_deg, lights, sizeof lights / sizeof *lights);
    nff_put_material(o, &(struct material){0.737, 0.561, 0.561, 0.7, 0.7, spd_shine(20), 0, 1});
    struct mat3 about_x = spd_rotate_x(-30 * SPD_PI / 180.0);
    struct mat3 about_y = spd_rotate_y(-20 * SPD_PI / 180.0);
    put_jacks(o, size, &(struct affine){.m = spd_multiply(&about_y, &about_x)});
}
