/*
 * gears: size^3 meshing gears over a mirroring square; every fifth gear is glass. A gear is two
 * concave faces of 144 corners and the 144 quadrilaterals between them. Five lights, one of them at
 * the eye.
 */
#include "spd/parts.h"

#define TEETH 36 /* per gear */
#define CORNERS (4 * TEETH)

#define OUTER_RATIO 0.995 /* fraction of the radius: meshing teeth do not touch */
#define INNER_RATIO 0.9   /* fraction of the radius between the teeth */
#define TOOTH_RATIO (1.0 - INNER_RATIO)
#define THICKNESS 0.1

static const struct view view = {.from = {-1.1, -2.1, 2.6},
    .up = {0, 0, 1},
    .angle_deg = 45,
    .hither = 1,
    .res_x = 512,
    .res_y = 512};
static const struct vec3 lights[] = {
    {2, 4, 4}, {-2, 4, 3}, {2, -2.5, 2.5}, {-1, -4, 2}, {-1.111, -2.121, 2.626}};
static const struct vec3 ground[] = {{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}};

uint64_t spd_gears_count(int size)
{
    uint64_t n = (uint64_t)size;
    return 1 + (CORNERS + 2) * n * n * n;
}

static double fraction(double x) { return x - floor(x); }

/* A bright colour that differs from the neighbours' colours. */
static struct material stuff(int ix, int iy, int iz)
{
    double r = 0.01 + fraction((double)(ix * 3 + iy * 2 + iz + 1) * 5.0 / 7.0);
    double g = 0.01 + fraction((double)(iy * 3 + iz * 2 + ix + 1) * 3.0 / 7.0);
    double b = 0.01 + fraction((double)(iz * 3 + ix * 2 + iy + 1) * 2.0 / 7.0);
    double most = fmax(fmax(r, g), b);
    bool glass = (ix * 4 + iy * 2 + iz) % 5 == 0;
    return (struct material){r / most, g / most, b / most, glass ? 0.2 : 1, 0, spd_shine(0),
        glass ? 0.8 : 0, glass ? 1.1 : 0};
}

/* The four corners of one tooth, which spans tooth_angle from gear_angle. */
static void make_tooth(struct vec3 out[4], struct vec3 center, double gear_angle,
    double tooth_angle, struct vec3 outer, struct vec3 inner)
{
    static const double at[4] = {-0.19, 0.19, 0.3, 0.7};
    for (int i = 0; i < 4; i++) {
        struct mat3 turn = spd_rotate_z(gear_angle + at[i] * tooth_angle);
        out[i] = v3_add(spd_transform(i < 2 ? outer : inner, &turn), center);
    }
}

/*
 * sense 1: counterclockwise, -1: clockwise, so that faces point outwards. z is relative to the
 * center.
 */
static void make_face(struct vec3 out[CORNERS], struct vec3 center, double z, double offset_angle,
    double radius, int sense)
{
    struct vec3 outer = v3(OUTER_RATIO * radius, 0, z),
                inner = v3((1.0 - TOOTH_RATIO) * radius, 0, z);
    double tooth_angle = 2.0 * SPD_PI / TEETH;
    for (int i = 0; i < TEETH; i++) {
        double turned = 2.0 * SPD_PI * i / TEETH;
        make_tooth(
            out + 4 * i, center, offset_angle + sense * turned, sense * tooth_angle, outer, inner);
    }
}

static void put_gear(
    struct nff_out *o, struct vec3 center, double offset_angle, double radius, double thickness)
{
    struct vec3 face[CORNERS];
    make_face(face, center, 0, offset_angle, radius, 1);
    nff_put_polygon(o, CORNERS, face, NULL);
    for (int i = 0; i < CORNERS; i++) {
        struct vec3 a = face[i], b = face[(i + 1) % CORNERS];
        struct vec3 side[4] = {a, v3(a.x, a.y, a.z - thickness), v3(b.x, b.y, b.z - thickness), b};
        nff_put_polygon(o, 4, side, NULL);
    }
    make_face(face, center, -thickness, offset_angle, radius, -1);
    nff_put_polygon(o, CORNERS, face, NULL);
}

void spd_gears(struct nff_out *o, int size, double turn_deg)
{
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    nff_put_material(o, &(struct material){1, 0.85, 0.7, 0.3, 0.6, spd_shine(37), 0, 0});
    nff_put_polygon(o, 4, ground, NULL);

    double radius = 1.0 / (size - (size - 1) * TOOTH_RATIO / 2.0);
    double first = -1.0 + radius, step = radius * (2.0 - TOOTH_RATIO);
    double thickness = fmin(THICKNESS, 1.0 / (2.0 * size));
    for (int iz = 0; iz < size; iz++)
        for (int iy = 0; iy < size; iy++)
            for (int ix = 0; ix < size; ix++) {
                struct vec3 center =
                    v3(first + ix * step, first + iy * step, 1.0 + iz * (-1.0 / size));
                struct material m = stuff(ix, iy, iz);
                nff_put_material(o, &m);
                put_gear(o, center, SPD_PI * ((ix + iy + iz) % 2) / TEETH, radius, thickness);
            }
}
