/* matrix: rotations and products of matrices; see parts.h for the order of sums. */
#include "spd/parts.h"

struct mat3 spd_rotate_x(double angle)
{
    double c = cos(angle), s = sin(angle);
    return (struct mat3){{v3(1, 0, 0), v3(0, c, s), v3(0, -s, c)}};
}

struct mat3 spd_rotate_y(double angle)
{
    double c = cos(angle), s = sin(angle);
    return (struct mat3){{v3(c, 0, -s), v3(0, 1, 0), v3(s, 0, c)}};
}

struct mat3 spd_rotate_z(double angle)
{
    double c = cos(angle), s = sin(angle);
    return (struct mat3){{v3(c, s, 0), v3(-s, c, 0), v3(0, 0, 1)}};
}

struct mat3 spd_rotate_about(struct vec3 a, double angle)
{
    double c = cos(angle), s = sin(angle), d = 1.0 - c;
    return (struct mat3){{
        v3(a.x * a.x + (1.0 - a.x * a.x) * c, a.x * a.y * d + a.z * s, a.x * a.z * d - a.y * s),
        v3(a.x * a.y * d - a.z * s, a.y * a.y + (1.0 - a.y * a.y) * c, a.y * a.z * d + a.x * s),
        v3(a.x * a.z * d + a.y * s, a.y * a.z * d - a.x * s, a.z * a.z + (1.0 - a.z * a.z) * c),
    }};
}

struct mat3 spd_scale(double f) { return (struct mat3){{v3(f, 0, 0), v3(0, f, 0), v3(0, 0, f)}}; }

struct mat3 spd_multiply(const struct mat3 *a, const struct mat3 *b)
{
    return (struct mat3){
        {spd_transform(a->row[0], b), spd_transform(a->row[1], b), spd_transform(a->row[2], b)}};
}

struct affine spd_compose(const struct affine *a, const struct affine *b)
{
    return (struct affine){spd_multiply(&a->m, &b->m), spd_move(a->shift, b)};
}
