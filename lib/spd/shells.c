/*
 * shells: a sea shell of overlapping spheres along a spiral on a cone (C. Pickover, "A short recipe
 * for seashell synthesis", IEEE CG&A 9(6), 1989), many of them tiny. One light.
 */
#include "spd/parts.h"

#define TURNS 9.0
#define GROWTH 0.15      /* logarithm of the radius, per radian */
#define STEEPNESS (-2.0) /* height over radius */

static const struct view view = {.from = {-6, -60, 35},
    .at = {0, 8, -15},
    .up = {0, 0, 1},
    .angle_deg = 45,
    .hither = 0.5,
    .res_x = 512,
    .res_y = 512};
static const struct vec3 lights[] = {{-100, -100, 100}};

static int64_t steps(int size) { return INT64_C(180) << size; }

uint64_t spd_shells_count(int size) { return (uint64_t)steps(size) + 1; }

void spd_shells(struct nff_out *o, int size, double turn_deg)
{
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    nff_put_material(o, &(struct material){1, 0.8, 0.4, 0.8, 0.2, spd_shine(10), 0, 1});
    int64_t n = steps(size);
    for (int64_t i = -n * 2 / 3; i <= n / 3; i++) {
        double angle = 2.0 * TURNS * SPD_PI * (double)i / (double)n;
        double r = exp(GROWTH * angle);
        nff_put_sphere(o, v3(r * sin(angle), r * cos(angle), STEEPNESS * r), r);
    }
}
