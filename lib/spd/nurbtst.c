/*
 * nurbtst: a bicubic B-spline surface of 6 by 5 control points over open uniform knots, cut into
 * 30 by 25 pairs of triangles with normals. One light. After A. Enzmann's nurbtst in the Standard
 * Procedural Databases.
 *
 * Its control points have weights, which SPD's program reads and does not use: the surface is not
 * rational. It computes basis functions and steps in float, and so does this file.
 */
#include "spd/parts.h"

#define ORDER 4
#define ROWS 6    /* control points along u */
#define COLUMNS 5 /* along v */
#define STEPS 5   /* per control point */
#define KNOTS_MAX (ROWS + ORDER)

static const struct view view = {.from = {0, 5, -10},
    .up = {0, 1, 0},
    .angle_deg = 30,
    .hither = 0.001,
    .res_x = 256,
    .res_y = 256};
static const struct vec3 lights[] = {{0, 50, -10}};

/* Heights of the control points, which lie on a grid of unit squares. */
static const double heights[ROWS][COLUMNS] = {
    {0, 3, -3, 3, 0}, {0}, {0, 0, 5, 0, 0}, {0, 0, 5, 0, 0}, {0}, {0, -3, 3, -3, 0}};

/* Basis functions and their derivatives at one parameter. */
struct basis {
    float value[KNOTS_MAX], slope[KNOTS_MAX];
};

/* The surface does not scale. */
uint64_t spd_nurbtst_count(int size)
{
    (void)size;
    return 2 * ROWS * STEPS * COLUMNS * STEPS;
}

/* Cox and de Boor's recurrence. A function that is 0 adds nothing, so that no divisor is 0. */
static struct basis basis_at(float t, int points)
{
    struct basis b = {.value = {0}};
    float knot[KNOTS_MAX] = {0};
    int knots = points + ORDER;
    for (int i = 1; i < knots; i++) knot[i] = knot[i - 1] + (i >= ORDER && i <= points ? 1 : 0);
    for (int i = 0; i < knots - 1; i++) b.value[i] = t >= knot[i] && t < knot[i + 1] ? 1 : 0;
    if (t >= knot[knots - 1]) b.value[points - 1] = 1;
    for (int k = 2; k <= ORDER; k++)
        for (int i = 0; i < knots - k; i++) {
            float rise = knot[i + k - 1] - knot[i], fall = knot[i + k] - knot[i + 1];
            float v0 = b.value[i], v1 = b.value[i + 1], s0 = b.slope[i], s1 = b.slope[i + 1];
            b.value[i] = (v0 != 0 ? (t - knot[i]) * v0 / rise : 0) +
                         (v1 != 0 ? (knot[i + k] - t) * v1 / fall : 0);
            b.slope[i] = (v0 != 0 ? v0 / rise : 0) + (v1 != 0 ? -v1 / fall : 0) +
                         (s0 != 0 ? (t - knot[i]) * s0 / rise : 0) +
                         (s1 != 0 ? (knot[i + k] - t) * s1 / fall : 0);
        }
    return b;
}

static struct patch_corner point_at(float u, float v)
{
    struct basis a = basis_at(u, ROWS), b = basis_at(v, COLUMNS);
    struct vec3 at = {0}, along_u = {0}, along_v = {0};
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < COLUMNS; j++) {
            struct vec3 control = v3(j, i, heights[i][j]);
            at = v3_mad(at, control, (double)(a.value[i] * b.value[j]));
            along_u = v3_mad(along_u, control, (double)(a.slope[i] * b.value[j]));
            along_v = v3_mad(along_v, control, (double)(a.value[i] * b.slope[j]));
        }
    return (struct patch_corner){at, spd_unit(v3_cross(along_v, along_u))};
}

/* Parameters over all knots, one by one from 0. */
static void make_steps(float out[], int points)
{
    int steps = points * STEPS;
    out[0] = 0;
    for (int i = 0; i < steps; i++)
        out[i + 1] = out[i] + (float)(points - ORDER + 1) / (float)steps;
}

/* The points of one u, moved to their places. */
static void make_row(struct patch_corner row[COLUMNS * STEPS + 1], float u,
    const float v[COLUMNS * STEPS + 1], const struct affine *place)
{
    for (int j = 0; j <= COLUMNS * STEPS; j++) {
        struct patch_corner p = point_at(u, v[j]);
        row[j] = (struct patch_corner){spd_move(p.at, place), spd_transform(p.normal, &place->m)};
    }
}

void spd_nurbtst(struct nff_out *o, int size, double turn_deg)
{
    (void)size;
    spd_put_setting(o, v3(0, 0, 0), &view, turn_deg, lights, sizeof lights / sizeof *lights);
    nff_put_material(o, &(struct material){1, 0, 0, 0.7, 0, spd_shine(10), 0, 1});

    struct mat3 about_y = spd_rotate_y(SPD_PI * 30.0 / 180.0);
    struct mat3 about_x = spd_rotate_x(SPD_PI * -90.0 / 180.0);
    struct affine turn = {.m = spd_multiply(&about_x, &about_y)};
    struct affine center = {.m = spd_scale(1), .shift = v3(-2, -2.5, 0)};
    struct affine place = spd_compose(&center, &turn);

    struct patch_corner row[2][COLUMNS * STEPS + 1];
    float u[ROWS * STEPS + 1], v[COLUMNS * STEPS + 1];
    make_steps(u, ROWS);
    make_steps(v, COLUMNS);
    make_row(row[0], u[0], v, &place);
    for (int i = 1; i <= ROWS * STEPS; i++) {
        const struct patch_corner *p = row[(i + 1) % 2], *q = row[i % 2];
        make_row(row[i % 2], u[i], v, &place);
        for (int j = 0; j < COLUMNS * STEPS; j++) {
            spd_put_patch(o, p[j], q[j], q[j + 1]);
            spd_put_patch(o, p[j], q[j + 1], p[j + 1]);
        }
    }
}
