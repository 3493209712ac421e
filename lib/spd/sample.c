/*
 * sample: three tori through each other, a cone, and a disc below. NFF has no torus and no disc: a
 * torus is 288 triangles with normals, a disc is 16 triangles. One light. After A. Enzmann's sample
 * in the Standard Procedural Databases.
 */
#include "spd/parts.h"

#define TORUS_STEPS 12 /* along the ring and around it */
#define DISC_STEPS 16

static const struct view view = {.from = {0, 5, -5},
    .up = {0, 1, 0},
    .angle_deg = 45,
    .hither = 0.001,
    .res_x = 512,
    .res_y = 512};
static const struct vec3 lights[] = {{-10, 20, -20}};

static const struct torus {
    struct vec3 colour, center, axis;
} tori[] = {{{0, 1, 1}, {-1, 0, 0}, {1, 1, -0.5}}, {{1, 1, 0}, {0, 0, 0}, {0, 1, -0.5}},
    {{1, 0, 1}, {1, 0, 0}, {-1, 1, -0.5}}};
static const struct vec3 red = {1, 0, 0};

/* The scene does not scale. */
uint64_t spd_sample_count(int size)
{
    (void)size;
    return 3 * 2 * TORUS_STEPS * TORUS_STEPS + 1 + DISC_STEPS;
}

static void put_colour(struct nff_out *o, struct vec3 c)
{
    nff_put_material(o, &(struct material){c.x, c.y, c.z, 0.7, 0, spd_shine(10), 0, 1});
}

/* Takes the origin to center and +z to a unit vector that is not z itself. */
static struct affine raised(struct vec3 center, struct vec3 axis)
{
    return (struct affine){
        spd_rotate_about(spd_unit(v3(-axis.y, axis.x, 0)), acos(axis.z)), center};
}

/* u goes around the ring's section, v along the ring. */
static struct patch_corner torus_at(double u, double v, const struct affine *place)
{
    const double r0 = 2.0, r1 = 0.5; /* of the ring, of its section */
    struct vec3 at = v3((r0 + r1 * sin(u)) * cos(v), (r0 + r1 * sin(u)) * sin(v), r1 * cos(u));
    struct vec3 along_u = v3(r1 * cos(u) * cos(v), r1 * cos(u) * sin(v), -r1 * sin(u));
    struct vec3 along_v = v3(-(r0 + r1 * sin(u)) * sin(v), (r0 + r1 * sin(u)) * cos(v), 0.0);
    struct vec3 normal = spd_unit(v3_cross(along_u, along_v));
    return (struct patch_corner){spd_move(at, place), spd_transform(normal, &place->m)};
}

/* Parameters around a circle, one by one from 0. */
static void make_steps(double out[], int n)
{
    out[0] = 0;
    for (int i = 0; i < n; i++) out[i + 1] = out[i] + 2.0 * SPD_PI / n;
}

static void put_torus(struct nff_out *o, const struct torus *t)
{
    struct affine place = raised(t->center, spd_unit(t->axis));
    double at[TORUS_STEPS + 1];
    make_steps(at, TORUS_STEPS);
    put_colour(o, t->colour);
    for (int i = 0; i < TORUS_STEPS; i++)
        for (int j = 0; j < TORUS_STEPS; j++) {
            struct patch_corner here = torus_at(at[i], at[j], &place),
                                far = torus_at(at[i + 1], at[j + 1], &place);
            spd_put_patch(o, far, torus_at(at[i], at[j + 1], &place), here);
            spd_put_patch(o, torus_at(at[i + 1], at[j], &place), far, here);
        }
}

static void put_disc(struct nff_out *o, struct vec3 center, struct vec3 axis, double radius)
{
    struct affine place = raised(center, axis);
    double at[DISC_STEPS + 1];
    make_steps(at, DISC_STEPS);
    for (int i = 0; i < DISC_STEPS; i++) {
        struct vec3 a = v3(radius * cos(at[i]), radius * sin(at[i]), 0);
        struct vec3 b = v3(radius * cos(at[i + 1]), radius * sin(at[i + 1]), 0);
        struct vec3 corners[3] = {spd_move(a, &place), spd_move(b, &place), center};
        nff_put_polygon(o, 3, corners, NULL);
    }
}

void spd_sample(struct nff_out *o, int size, double turn_deg)
{
    (void)size;
    spd_put_setting(o, v3(0.8, 0.8, 0.8), &view, turn_deg, lights, sizeof lights / sizeof *lights);
    for (size_t i = 0; i < sizeof tori / sizeof *tori; i++) put_torus(o, &tori[i]);
    put_colour(o, red);
    nff_put_cone(o, v3(0, -2, 0), 2, v3(0, 2, 0), 0.1);
    put_colour(o, red);
    put_disc(o, v3(0, -2, 0), v3(0, 1, 0), 4);
}
