/*
 * teapot: M. Newell's teapot of 32 bicubic Bezier patches, with the bottom that F. Crow added (IEEE
 * CG&A 7(1), 1987), on a chequered square. A patch is cut into size^2 pairs of triangles with
 * normals, the square into size^2 squares. Two lights.
 *
 * The control points are given by what generates them. Rim, body, lid and bottom are profiles, each
 * turned to four quarters. Handle and spout are sections through the plane y = 0, each mirrored.
 */
#include "spd/parts.h"

#define PATCHES 32
#define CUSP 0.0001 /* nearer to the axis, a corner is on it */

static const struct view view = {.from = {4.86, 7.2, 5.4},
    .up = {0, 0, 1},
    .angle_deg = 45,
    .hither = 1,
    .res_x = 512,
    .res_y = 512};
static const struct vec3 lights[] = {{-3.1, 9.8, 12.1}, {11.3, 5.1, 8.8}};

/*
* A quarter of a circle: its control points are (radius, 0), (radius, -bulge), (bulge, -radius) and
 * (0, -radius) at this height. Four circles are a quarter of a turned surface.
 */
struct circle {
    double radius, bulge, z;
};
static const struct circle rim[4] = {
    {1.4, 0.784, 2.4}, {1.3375, 0.749, 2.53125}, {1.4375, 0.805, 2.53125}, {1.5, 0.84, 2.4}};
static const struct circle body[7] = {{1.5, 0.84, 2.4}, {1.75, 0.98, 1.875}, {2, 1.12, 1.35},
    {2, 1.12, 0.9}, {2, 1.12, 0.45}, {1.5, 0.84, 0.225}, {1.5, 0.84, 0.15}};
static const struct circle lid[7] = {{0, 0, 3.15}, {0.8, 0.45, 3.15}, {0, 0, 2.85},
    {0.2, 0.112, 2.7}, {0.4, 0.224, 2.55}, {1.3, 0.728, 2.55}, {1.3, 0.728, 2.4}};
static const struct circle bottom[4] = {
    {0, 0, 0}, {1.425, 0.798, 0}, {1.5, 0.84, 0.075}, {1.5, 0.84, 0.15}};

/* A section through a tube: two points in the plane y = 0, and the tube's half width there. */
struct section {
    double x0, z0, x1, z1, half;
};
static const struct section handle[7] = {{-1.6, 2.025, -1.5, 2.25, 0.3},
    {-2.3, 2.025, -2.5, 2.25, 0.3}, {-2.7, 2.025, -3, 2.25, 0.3}, {-2.7, 1.8, -3, 1.8, 0.3},
    {-2.7, 1.575, -3, 1.35, 0.3}, {-2.5, 1.125, -2.65, 0.9375, 0.3}, {-2, 0.9, -1.9, 0.6, 0.3}};
static const struct section spout[7] = {{1.7, 1.425, 1.7, 0.6, 0.66},
    {2.6, 1.425, 3.1, 0.825, 0.66}, {2.3, 2.1, 2.4, 2.025, 0.25}, {2.7, 2.4, 3.3, 2.4, 0.25},
    {2.8, 2.475, 3.525, 2.49375, 0.25}, {2.9, 2.475, 3.45, 2.5125, 0.15},
    {2.8, 2.4, 3.2, 2.4, 0.15}};

struct patch {
    struct vec3 p[4][4];
};

/* One coordinate of a patch as a polynomial of s and t, highest powers first. */
struct polynomial {
    double c[4][4];
};

uint64_t spd_teapot_count(int size)
{
    uint64_t n = (uint64_t)size;
    return n * n + 2 * PATCHES * n * n - 8 * n;
}

/* Quarter 0 to 3 of the turned rings, clockwise seen from above if sense is -1, else sense is 1. */
static struct patch turned(const struct circle r[4], int quarter, int sense)
{
    struct patch out;
    for (int i = 0; i < 4; i++) {
        struct vec3 p[4] = {{r[i].radius, 0, r[i].z}, {r[i].radius, sense * r[i].bulge, r[i].z},
            {r[i].bulge, sense * r[i].radius, r[i].z}, {0, sense * r[i].radius, r[i].z}};
        for (int j = 0; j < 4; j++) {
            for (int k = 0; k < quarter; k++) p[j] = v3(-sense * p[j].y, sense * p[j].x, p[j].z);
            out.p[i][j] = p[j];
        }
    }
    return out;
}

/* The half of a tube with y <= 0, or its mirror image. */
static struct patch half_tube(const struct section s[4], bool mirrored)
{
    struct patch out;
    for (int i = 0; i < 4; i++) {
        double y = mirrored ? s[i].half : -s[i].half;
        struct vec3 p[4] = {{s[i].x0, 0, s[i].z0}, {s[i].x0, y, s[i].z0}, {s[i].x1, y, s[i].z1},
            {s[i].x1, 0, s[i].z1}};
        for (int j = 0; j < 4; j++) out.p[i][mirrored ? 3 - j : j] = p[j];
    }
    return out;
}

static void make_patches(struct patch out[PATCHES])
{
    struct patch *p = out;
    for (int q = 0; q < 4; q++) *p++ = turned(rim, q, -1);
    for (int part = 0; part < 2; part++)
        for (int q = 0; q < 4; q++) *p++ = turned(body + 3 * part, q, -1);
    for (int q = 0; q < 4; q++) *p++ = half_tube(handle + 3 * (q / 2), q % 2);
    for (int q = 0; q < 4; q++) *p++ = half_tube(spout + 3 * (q / 2), q % 2);
    for (int part = 0; part < 2; part++)
        for (int q = 0; q < 4; q++) *p++ = turned(lid + 3 * part, q, -1);
    for (int q = 0; q < 4; q++) *p++ = turned(bottom, q, 1);
}

static struct polynomial product(const struct polynomial *a, const struct polynomial *b)
{
    struct polynomial out;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            out.c[i][j] = a->c[i][0] * b->c[0][j] + a->c[i][1] * b->c[1][j] +
                          a->c[i][2] * b->c[2][j] + a->c[i][3] * b->c[3][j];
    return out;
}

/* The patch's coordinates x, y and z. */
static void make_polynomials(struct polynomial out[3], const struct patch *p)
{
    static const struct polynomial bezier = {
        {{-1, 3, -3, 1}, {3, -6, 3, 0}, {-3, 3, 0, 0}, {1, 0, 0, 0}}};
    struct polynomial control[3], half;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            control[0].c[i][j] = p->p[i][j].x;
            control[1].c[i][j] = p->p[i][j].y;
            control[2].c[i][j] = p->p[i][j].z;
        }
    for (int i = 0; i < 3; i++) {
        half = product(&bezier, &control[i]);
        out[i] = product(&half, &bezier);
    }
}

static double value(const struct polynomial *p, const double s[4], const double t[4])
{
    double r[4];
    for (int j = 0; j < 4; j++)
        r[j] = s[0] * p->c[0][j] + s[1] * p->c[1][j] + s[2] * p->c[2][j] + s[3] * p->c[3][j];
    return r[0] * t[0] + r[1] * t[1] + r[2] * t[2] + r[3] * t[3];
}

static struct vec3 values(const struct polynomial p[3], const double s[4], const double t[4])
{
    return v3(value(&p[0], s, t), value(&p[1], s, t), value(&p[2], s, t));
}

static struct patch_corner corner_at(const struct polynomial p[3], double s, double t)
{
    double ps[4] = {s * s * s, s * s, s, 1}, pt[4] = {t * t * t, t * t, t, 1};
    double ds[4] = {s * s * 3, s * 2, 1, 0}, dt[4] = {t * t * 3, t * 2, 1, 0};
    return (struct patch_corner){
        values(p, ps, pt), spd_unit(v3_cross(values(p, ps, dt), values(p, ds, pt)))};
}

static bool on_axis(struct vec3 v) { return fabs(v.x) <= CUSP && fabs(v.y) <= CUSP; }

/* At the tips of lid and bottom a triangle has two corners in one place, or one without a normal:
 * the first is left out, the second gets the axis for its normal. */
static void put_triangle(struct nff_out *o, struct patch_corner c[3])
{
    int cusps = 0;
    for (int i = 0; i < 3; i++) {
        if (!on_axis(c[i].at)) continue;
        cusps++;
        c[i].normal = v3(0, 0, c[i].at.z > 1.5 ? 1 : -1);
    }
    if (cusps < 2) spd_put_patch(o, c[0], c[1], c[2]);
}

static void put_patch(struct nff_out *o, const struct patch *patch, int size)
{
    struct polynomial p[3];
    make_polynomials(p, patch);
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++) {
            double s0 = (double)i / size, s1 = (double)(i + 1) / size;
            double t0 = (double)j / size, t1 = (double)(j + 1) / size;
            struct patch_corner a = corner_at(p, s0, t0), b = corner_at(p, s0, t1),
                                c = corner_at(p, s1, t1), d = corner_at(p, s1, t0);
            put_triangle(o, (struct patch_corner[]){a, b, c});
            put_triangle(o, (struct patch_corner[]){c, d, a});
        }
}

/* The squares with i + j of one parity. */
static void put_squares(struct nff_out *o, int size, int parity, double grey)
{
    nff_put_material(o, &(struct material){grey, grey, grey, 0.5, 0.5, spd_shine(30), 0, 0});
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++) {
            if ((i + j) % 2 != parity) continue;
            double x0 = 4.0 * (2.0 * i / size - 1.0), x1 = 4.0 * (2.0 * (i + 1) / size - 1.0);
            double y0 = 4.0 * (2.0 * j / size - 1.0), y1 = 4.0 * (2.0 * (j + 1) / size - 1.0);
            struct vec3 corners[4] = {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
            nff_put_polygon(o, 4, corners, NULL);
        }
}

void spd_teapot(struct nff_out *o, int size, double turn_deg)
{
    struct patch patches[PATCHES];
    make_patches(patches);
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    put_squares(o, size, 1, 1);
    put_squares(o, size, 0, 0.5);
    nff_put_material(o, &(struct material){1, 0.5, 0.1, 0.75, 0.25, spd_shine(37), 0, 0});
    for (int i = 0; i < PATCHES; i++) put_patch(o, &patches[i], size);
}
