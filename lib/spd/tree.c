/*
 * tree: a branch is a cone with a sphere on its tip, and carries two shorter and thinner branches,
 * and so on, size times (M. Aono and T. Kunii, "Botanical tree image generation", IEEE CG&A 4(5),
 * 1984). On a field. Seven lights.
 */
#include "spd/parts.h"

#define RADIUS 0.15 /* of the trunk at its foot; its length is 1 */
#define TAPER 0.67  /* radius at the tip over radius at the foot */

static const struct view view = {.from = {4.5, 0.4, 2},
    .at = {0, 0, 1.5},
    .up = {0, 0, 1},
    .angle_deg = 45,
    .hither = 1,
    .res_x = 512,
    .res_y = 512};
static const struct vec3 lights[] = {{-5, 5, 50}, {30, -30, 30}, {-40, -30, 20}, {10, 30, 40},
    {-30, 40, 10}, {50, 25, 20}, {-10, -60, 30}};
static const struct vec3 field[] = {{50, 50, 0}, {-50, 50, 0}, {-50, -50, 0}, {50, -50, 0}};

/* The two branches that a branch carries. */
static const struct fork {
    double lean_deg, around_deg; /* from the branch, about it */
    double shrink;
} forks[2] = {{40, 90, 0.65}, {25, 230, 0.70}};

uint64_t spd_tree_count(int size) { return 1 + 2 * ((UINT64_C(2) << size) - 1); }

/* From a branch's own coordinates to its parent's. */
static struct affine made(const struct fork *f)
{
    struct mat3 lean = spd_rotate_x(f->lean_deg * SPD_PI / 180.0);
    struct mat3 around = spd_rotate_z(f->around_deg * SPD_PI / 180.0);
    struct affine turn = {.m = spd_multiply(&lean, &around)};
    struct affine at_tip = {.m = spd_scale(f->shrink), .shift = v3(0, 0, 1)};
    return spd_compose(&turn, &at_tip);
}

static void put_branch(struct nff_out *o, const struct affine fork[2], int depth,
    const struct affine *place, double thickness)
{
    struct vec3 foot = spd_move(v3(0, 0, 0), place), tip = spd_move(v3(0, 0, 1), place);
    double radius = thickness * RADIUS;
    nff_put_cone(o, foot, radius, tip, radius * TAPER);
    nff_put_sphere(o, tip, radius * TAPER);
    for (int i = 0; depth > 0 && i < 2; i++) {
        struct affine onward = spd_compose(&fork[i], place);
        put_branch(o, fork, depth - 1, &onward, thickness * TAPER);
    }
}

void spd_tree(struct nff_out *o, int size, double turn_deg)
{
    struct affine fork[2] = {made(&forks[0]), made(&forks[1])};
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    nff_put_material(o, &(struct material){0.2, 0.7, 0.2, 1, 0, spd_shine(0), 0, 0});
    nff_put_polygon(o, 4, field, NULL);
    nff_put_material(o, &(struct material){0.55, 0.4, 0.2, 1, 0, spd_shine(0), 0, 0});
    put_branch(o, fork, size, &(struct affine){.m = spd_scale(1)}, 1);
}
