/*
 * balls, or sphereflake: a mirroring sphere with nine children of a third of its radius. Each child
 * has nine children in turn, size levels deep. Above a square. Three lights.
 */
#include "spd/parts.h"

static const struct view view = {.from = {2.1, 1.3, 1.7},
    .up = {0, 0, 1},
    .angle_deg = 45,
    .hither = 0.01,
    .res_x = 512,
    .res_y = 512};
static const struct vec3 lights[] = {{4, 3, 2}, {1, -4, 4}, {-3, 1, 5}};
static const struct material floor_stuff = {1, 0.75, 0.33, 0.8, 0, 1e5, 0, 1};
static const struct vec3 floor_corners[] = {
    {12, 12, -0.5}, {-12, 12, -0.5}, {-12, -12, -0.5}, {12, -12, -0.5}};

static const double shrink = 1.0 / 3.0; /* radius of a child over its parent's */

uint64_t spd_balls_count(int size)
{
    uint64_t spheres = 1, level = 1;
    for (int i = 0; i < size; i++) spheres += level *= 9;
    return spheres + 1;
}

/*
 * The nine child directions of a sphere whose own direction is +z: three sets of three, 120 degrees
 * apart.
 */
static void make_directions(struct vec3 out[9])
{
    double d = 1.0 / sqrt(2.0);
    struct vec3 axis = v3(1, -1, 0), trio[3] = {{d, d, 0}, {d, 0, -d}, {0, d, -d}};
    struct mat3 tilt = spd_rotate_about(spd_unit(axis), asin(2.0 / sqrt(6.0)));
    for (int i = 0; i < 3; i++) trio[i] = spd_transform(trio[i], &tilt);
    for (int set = 0; set < 3; set++) {
        struct mat3 turn = spd_rotate_z(set * 2.0 * SPD_PI / 3.0);
        for (int i = 0; i < 3; i++) out[3 * set + i] = spd_transform(trio[i], &turn);
    }
}

/* Rotates +z to a direction. */
static struct mat3 rotate_from_z(struct vec3 to)
{
    struct vec3 z = v3(0, 0, 1), axis = v3_cross(z, to);
    /* Nearly along z the axis is undefined. */
    if (to.z >= 0.9999) return spd_scale(1);
    if (to.z <= -0.9999) return spd_rotate_y(SPD_PI);
    return spd_rotate_about(spd_unit(axis), acos(v3_dot(z, to)));
}

static void put_flake(struct nff_out *o, const struct vec3 directions[9], int depth,
    struct vec3 center, double radius, struct vec3 direction)
{
    nff_put_sphere(o, center, radius);
    if (depth == 0) return;
    struct mat3 turn = rotate_from_z(direction);
    double reach = radius * (1.0 + shrink);
    for (int i = 0; i < 9; i++) {
        struct vec3 child = v3_add(v3_scale(spd_transform(directions[i], &turn), reach), center);
        put_flake(o, directions, depth - 1, child, radius * shrink,
            spd_divide(v3_sub(child, center), reach));
    }
}

void spd_balls(struct nff_out *o, int size, double turn_deg)
{
    struct vec3 directions[9];
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    nff_put_material(o, &floor_stuff);
    nff_put_polygon(o, 4, floor_corners, NULL);
    nff_put_material(o, &(struct material){1, 0.9, 0.7, 0.5, 0.5, spd_shine(37), 0, 1});
    make_directions(directions);
    put_flake(o, directions, size, v3(0, 0, 0), 0.5, v3(0, 0, 1));
}
