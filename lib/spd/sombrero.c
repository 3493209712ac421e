/*
 * sombrero: a damped cosine wave as a height field of 16 2^size points a side, cut into triangles
 * without normals. One light. After A. Enzmann's sombrero in the Standard Procedural Databases.
 *
 * SPD samples the wave at steps of 8 / n and draws n points 8 / (n - 1) apart: the picture is
 * wider than the function by one step. Heights are of type float there, and so they are here.
 */
#include "spd/parts.h"

static const struct view view = {.from = {0, 5, -8},
    .up = {0, 0, 1},
    .angle_deg = 40,
    .hither = 0.01,
    .res_x = 512,
    .res_y = 512};
static const struct vec3 lights[] = {{10, 10, -10}};

static int64_t points(int size) { return INT64_C(16) << size; }

uint64_t spd_sombrero_count(int size)
{
    uint64_t cells = (uint64_t)points(size) - 1;
    return 2 * cells * cells;
}

/* Point (i, j) of n by n. */
static struct vec3 point_at(int64_t i, int64_t j, int64_t n)
{
    double x = -4.0 + (double)j * (8.0 / (double)n), z = -4.0 + (double)i * (8.0 / (double)n);
    double r = sqrt(x * x + z * z);
    float height = (float)(3.0 * cos(2.0 * 3.14159265358 * r) * exp(-r) / 3.0);
    double step = 8.0 / (double)(n - 1);
    return v3(-4.0 + (double)j * step, -3.0 + (double)height, -4.0 + (double)i * step);
}

void spd_sombrero(struct nff_out *o, int size, double turn_deg)
{
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    nff_put_material(o, &(struct material){1, 0.1, 0.1, 0.8, 0, spd_shine(40), 0, 1});
    int64_t n = points(size);
    for (int64_t i = 0; i < n - 1; i++)
        for (int64_t j = 0; j < n - 1; j++) {
            struct vec3 a = point_at(i, j, n), c = point_at(i + 1, j + 1, n);
            nff_put_polygon(o, 3, (struct vec3[]){a, c, point_at(i, j + 1, n)}, NULL);
            nff_put_polygon(o, 3, (struct vec3[]){a, point_at(i + 1, j, n), c}, NULL);
        }
}
