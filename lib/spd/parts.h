/*
 * parts: functions that the scenes share, and the scenes themselves. Private to lib/spd.
 *
 * Scenes must match the output of SPD's programs digit for digit. In that output, coordinates that
 * should be 0 are rounding errors like 1e-16. Therefore sums and products here follow SPD's order,
 * and unit vectors are divided, not scaled.
 */
#ifndef STORMRING_SPD_PARTS_H
#define STORMRING_SPD_PARTS_H

#include "spd/spd.h"

#define SPD_PI 3.141592653589793

/* The background of most scenes: the sky over Chapel Hill. */
#define SPD_SKY v3(0.078, 0.361, 0.753)

/* Row-major; vectors are rows and multiply from the left. */
struct mat3 {
    struct vec3 row[3];
};

/* A linear map, then a translation. */
struct affine {
    struct mat3 m;
    struct vec3 shift;
};

/* A corner of a patch, with the unit normal there. */
struct patch_corner {
    struct vec3 at, normal;
};

static inline struct vec3 spd_transform(struct vec3 v, const struct mat3 *m)
{
    const struct vec3 *r = m->row;
    return v3(v.x * r[0].x + v.y * r[1].x + v.z * r[2].x,
        v.x * r[0].y + v.y * r[1].y + v.z * r[2].y, v.x * r[0].z + v.y * r[1].z + v.z * r[2].z);
}
static inline struct vec3 spd_move(struct vec3 v, const struct affine *a)
{
    return v3_add(spd_transform(v, &a->m), a->shift);
}
static inline struct vec3 spd_divide(struct vec3 v, double d)
{
    return v3(v.x / d, v.y / d, v.z / d);
}
static inline struct vec3 spd_unit(struct vec3 v)
{
    double len = v3_len(v);
    return len > 0 ? spd_divide(v, len) : v;
}

/* Counterclockwise rotations about +x, +y and +z, and about a unit axis. */
struct mat3 spd_rotate_x(double angle);
struct mat3 spd_rotate_y(double angle);
struct mat3 spd_rotate_z(double angle);
struct mat3 spd_rotate_about(struct vec3 axis, double angle);
struct mat3 spd_scale(double factor);
/* First a, then b. */
struct mat3 spd_multiply(const struct mat3 *a, const struct mat3 *b);
struct affine spd_compose(const struct affine *a, const struct affine *b);

/*
 * Writes the background, view and lights that begin every scene. The camera is tilted upward by
 * turn_deg degrees about its position.
 */
void spd_put_setting(struct nff_out *o, struct vec3 background, const struct view *v,
    double turn_deg, const struct vec3 *lights, size_t n);
/* Phong exponent of a highlight that falls to one half at this angle. At 0 it is 1e5, which means
 * no highlight. */
double spd_shine(double half_angle_deg);

/* Writes a triangle with normals. */
void spd_put_patch(
    struct nff_out *o, struct patch_corner a, struct patch_corner b, struct patch_corner c);

/* A scene's number of primitives at a size, and the scene; see struct spd_scene. */
uint64_t spd_balls_count(int size);
uint64_t spd_gears_count(int size);
uint64_t spd_jacks_count(int size);
uint64_t spd_lattice_count(int size);
uint64_t spd_mount_count(int size);
uint64_t spd_nurbtst_count(int size);
uint64_t spd_rings_count(int size);
uint64_t spd_sample_count(int size);
uint64_t spd_shells_count(int size);
uint64_t spd_sombrero_count(int size);
uint64_t spd_teapot_count(int size);
uint64_t spd_tetra_count(int size);
uint64_t spd_tree_count(int size);

void spd_balls(struct nff_out *o, int size, double turn_deg);
void spd_gears(struct nff_out *o, int size, double turn_deg);
void spd_jacks(struct nff_out *o, int size, double turn_deg);
void spd_lattice(struct nff_out *o, int size, double turn_deg);
void spd_mount(struct nff_out *o, int size, double turn_deg);
void spd_nurbtst(struct nff_out *o, int size, double turn_deg);
void spd_rings(struct nff_out *o, int size, double turn_deg);
void spd_sample(struct nff_out *o, int size, double turn_deg);
void spd_shells(struct nff_out *o, int size, double turn_deg);
void spd_sombrero(struct nff_out *o, int size, double turn_deg);
void spd_teapot(struct nff_out *o, int size, double turn_deg);
void spd_tetra(struct nff_out *o, int size, double turn_deg);
void spd_tree(struct nff_out *o, int size, double turn_deg);

#endif
