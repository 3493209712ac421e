/*
 * rings: a pyramid of size layers, seen from its tip, before a wall that fills the picture. Layer n
 * has n^2 objects. An object is six pentagonal rings of cylinders, which join the midpoints of a
 * dodecahedron's edges, and spheres at their corners. Three lights.
 */
#include "spd/parts.h"

#define CORNERS 30     /* of an object: five of each ring */
#define RADIUS 0.07412 /* of cylinders and spheres: rings touch each other */

static const double colours[6][3] = {
    {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}};

uint64_t spd_rings_count(int size)
{
    uint64_t n = (uint64_t)size;
    return 1 + 10 * n * (n + 1) * (2 * n + 1);
}

/* The object fits into a unit sphere. One ring lies in the plane z = 0. */
static void make_corners(struct vec3 out[CORNERS])
{
    double scale = 1.0 / (1.0 + RADIUS);
    double between_faces = 2.0 * acos(cos(SPD_PI / 3.0) / sin(SPD_PI / 5.0));
    struct mat3 tilt = spd_rotate_x(between_faces);
    for (int i = 0; i < 5; i++)
        out[i] = v3(scale * cos(i * 2.0 * SPD_PI / 5.0), scale * sin(i * 2.0 * SPD_PI / 5.0), 0.0);
    for (int ring = 1; ring < 6; ring++) {
        struct mat3 turn = spd_rotate_z(SPD_PI * (2.0 * (ring - 1) + 1.0) / 5.0);
        for (int i = 0; i < 5; i++)
            out[5 * ring + i] = spd_transform(spd_transform(out[i], &tilt), &turn);
    }
}

/* Spans the picture and 1 % more. */
static void put_wall(struct nff_out *o, struct vec3 from, double y)
{
    double half = 1.01 * (y - from.y) * tan(SPD_PI / 8.0);
    struct vec3 wall[4] = {{half + from.x, y, half + from.z}, {-half + from.x, y, half + from.z},
        {-half + from.x, y, -half + from.z}, {half + from.x, y, -half + from.z}};
    nff_put_material(o, &(struct material){1, 1, 1, 1, 0, spd_shine(0), 0, 0});
    nff_put_polygon(o, 4, wall, NULL);
}

static void put_object(struct nff_out *o, const struct vec3 corners[CORNERS], struct vec3 center)
{
    for (int i = 0; i < CORNERS; i++) {
        int before = i % 5 == 0 ? i + 4 : i - 1;
        const double *c = colours[i / 5];
        struct vec3 corner = v3_add(corners[i], center);
        if (i % 5 == 0)
            nff_put_material(
                o, &(struct material){c[0], c[1], c[2], 0.5, 0.2, spd_shine(37), 0, 0});
        nff_put_cone(o, corner, RADIUS, v3_add(corners[before], center), RADIUS);
        nff_put_sphere(o, corner, RADIUS);
    }
}

void spd_rings(struct nff_out *o, int size, double turn_deg)
{
    double spread = 1 / sin(SPD_PI / 8.0); /* distance of layers */
    struct vec3 corners[CORNERS];
    struct view view = {.from = {-1, -spread, 0.5},
        .at = {-1, -spread + 1.0, 0.5},
        .up = {0, 0, 1},
        .angle_deg = 45,
        .hither = 1,
        .res_x = 512,
        .res_y = 512};
    struct vec3 lights[] = {{3, -spread, 3}, {-4, -spread, 1}, {2, -spread, -4}};
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    put_wall(o, view.from, spread * (size + 1));
    make_corners(corners);
    for (int layer = 0; layer < size; layer++)
        for (int iz = 0; iz <= layer; iz++)
            for (int ix = 0; ix <= layer; ix++)
                put_object(o, corners, v3(2 * ix - layer, spread * (layer + 1), 2 * iz - layer));
}
