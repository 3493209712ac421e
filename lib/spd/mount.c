/*
 * mount: a fractal mountain by L. Carpenter's method, here on a square grid of 2^size cells a side,
 * with a pyramid of four glass spheres before it. One light.
 *
 * Heights are displaced by random numbers that depend on the grid point and the size alone. Their
 * hash is a poor one and repeats itself over the mountain, but published pictures and times have
 * it, and it is SPD's default.
 */
#include "spd/parts.h"

#define DIMENSION 2.2 /* of the fractal, 2 to 3 */
#define SEED 21       /* another one makes another mountain */
#define CORNER (-1.0) /* lower left corner, in x and in y */
#define WIDTH 2.0
#define MODULUS 134456 /* of the random numbers */

static const struct view view = {.from = {-1.6, 1.6, 1.7},
    .up = {0, 0, 1},
    .angle_deg = 45,
    .hither = 0.01,
    .res_x = 512,
    .res_y = 512};
static const struct vec3 lights[] = {{-100, -100, 100}};

struct mountain {
    struct nff_out *o;
    int size, cells; /* cells = 2^size */
    double roughness;
};

/* A square of the grid with the heights of its corners, counterclockwise from the lower left. */
struct square {
    int x, y, width;
    double z[4];
};

uint64_t spd_mount_count(int size) { return 4 + (UINT64_C(2) << 2 * size); }

/* Up to size 7 shifts are as in SPD; from size 8 on SPD shifts by less than 0, which yields 0. */
static uint64_t shifted(int value, int shift) { return shift < 0 ? 0 : (uint64_t)value << shift; }

static long next_random(long n) { return (28411 + n * 8121) % MODULUS; }
/* -1 to 1 */
static double centred(long n) { return (double)n * 2.0 / MODULUS - 1.0; }

/*
 * Normally distributed: G. Marsaglia's polar method over a linear congruential generator, both as
 * in W. H. Press et al., "Numerical Recipes" (1986).
 */
static double random_at(int x, int y, int size)
{
    uint64_t hash = shifted(x, 23 - size) + shifted(y, 15 - size) + shifted(x, 7 - size);
    long first, second = SEED + (long)(hash & 0xffff);
    double u, v, r;
    do {
        first = next_random(second), second = next_random(first);
        u = centred(first), v = centred(second);
        r = u * u + v * v;
    } while (r >= 1.0);
    return u * sqrt(-2.0 * log(r) / r);
}

static void put_spheres(struct nff_out *o, struct vec3 center, double radius)
{
    struct vec3 top = v3(0, 0, radius * sqrt(3.0 / 2.0));
    struct mat3 tilt = spd_rotate_about(spd_unit(v3(1, 1, 0)), acos(-1.0 / 3.0));
    struct vec3 foot = spd_transform(top, &tilt);
    nff_put_sphere(o, v3_add(center, top), radius);
    for (int i = 0; i < 3; i++) {
        struct mat3 turn = spd_rotate_z(i * 2.0 * SPD_PI / 3.0);
        nff_put_sphere(o, v3_add(spd_transform(foot, &turn), center), radius);
    }
}

static void put_cell(const struct mountain *m, const struct square *s)
{
    double left = CORNER + s->x * WIDTH / m->cells, right = CORNER + (s->x + 1) * WIDTH / m->cells;
    double low = CORNER + s->y * WIDTH / m->cells, high = CORNER + (s->y + 1) * WIDTH / m->cells;
    struct vec3 p[4] = {
        {left, low, s->z[0]}, {right, low, s->z[1]}, {right, high, s->z[2]}, {left, high, s->z[3]}};
    nff_put_polygon(m->o, 3, p, NULL);
    nff_put_polygon(m->o, 3, (struct vec3[]){p[2], p[3], p[0]}, NULL);
}

/* Halves the square until it is a cell. Midpoints of edges and the middle are displaced. */
static void grow(const struct mountain *m, const struct square *s)
{
    if (s->width == 1) {
        put_cell(m, s);
        return;
    }
    int half = s->width / 2;
    double rise = half * WIDTH / m->cells * m->roughness, edge[4]; /* lower, right, upper, left */
    static const int at[4][2] = {{1, 0}, {2, 1}, {1, 2}, {0, 1}};
    for (int i = 0; i < 4; i++)
        edge[i] = (s->z[i] + s->z[(i + 1) % 4]) / 2.0 +
                  rise * random_at(s->x + at[i][0] * half, s->y + at[i][1] * half, m->size);
    double middle = (s->z[0] + s->z[1] + s->z[2] + s->z[3]) / 4.0 +
                    1.4142136 * rise * random_at(s->x + half, s->y + half, m->size);
    int x = s->x, y = s->y;
    grow(m, &(struct square){x, y, half, {s->z[0], edge[0], middle, edge[3]}});
    grow(m, &(struct square){x + half, y, half, {edge[0], s->z[1], edge[1], middle}});
    grow(m, &(struct square){x + half, y + half, half, {middle, edge[1], s->z[2], edge[2]}});
    grow(m, &(struct square){x, y + half, half, {edge[3], middle, edge[2], s->z[3]}});
}

void spd_mount(struct nff_out *o, int size, double turn_deg)
{
    double ratio = 2.0 / exp(log(2.0) / (DIMENSION - 1.0));
    struct mountain m = {o, size, 1 << size, sqrt(ratio * ratio - 1.0)};
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    nff_put_material(o, &(struct material){1, 1, 1, 0.1, 0.1, spd_shine(6.7), 0.9, 1.5});
    put_spheres(o, v3(-0.8, 0.8, 1), 0.17);
    nff_put_material(o, &(struct material){0.5, 0.45, 0.35, 1, 0, spd_shine(0), 0, 0});
    grow(&m, &(struct square){.width = m.cells});
}
