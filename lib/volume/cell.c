/*
 * cell: the trilinear field of a cell along a ray. All values are relative to the cell's lowest
 * corner. Differences of neighbours are exact in double, so an offset (pressure in Pa, temperature
 * in K) costs no digits.
 */
#include "volume/volume_int.h"

/* first: the value at the lowest corner of the grid. */
static void corners(struct cell *c, const float *first, const struct volume *v, const int32_t i[3])
{
    const ptrdiff_t x = v->stride[0], y = v->stride[1], z = v->stride[2];
    const float *s = first + i[0] * x + i[1] * y + i[2] * z;
    double o = (double)s[0];
    double fx = (double)s[x] - o, fy = (double)s[y] - o, fz = (double)s[z] - o;
    double xy = (double)s[x + y] - o, xz = (double)s[x + z] - o, yz = (double)s[y + z] - o;
    double xyz = (double)s[x + y + z] - o;
    c->base = o;
    c->f[0] = fx, c->f[1] = fy, c->f[2] = fz;
    c->f[3] = xy - fx - fy;
    c->f[4] = xz - fx - fz;
    c->f[5] = yz - fy - fz;
    c->f[6] = xyz - xy - xz - yz + fx + fy + fz;
}

/* The field along the ray, of the corners. */
static void along(struct cell *c)
{
    const double *f = c->f, x = c->from[0], y = c->from[1], z = c->from[2];
    const double dx = c->delta[0], dy = c->delta[1], dz = c->delta[2];
    double xy = f[3] + f[6] * z, xz = f[4] + f[6] * y, yz = f[5] + f[6] * x;
    c->p[0] = f[0] * x + y * (f[1] + f[3] * x) + z * (f[2] + f[4] * x + y * yz);
    c->p[1] = dx * (f[0] + f[3] * y + z * xz) + dy * (f[1] + f[3] * x + z * yz) +
              dz * (f[2] + f[4] * x + y * yz);
    c->p[2] = dx * dy * xy + dx * dz * xz + dy * dz * yz;
    c->p[3] = dx * dy * dz * f[6];
}

void cell_init(struct cell *c, const struct volume *v, const double o[3], const double d[3],
    const struct segment *s)
{
    const double t0 = s->t0, t1 = s->t1;
    corners(c, v->first, v, s->i);
    for (int a = 0; a < 3; a++) {
        const double *plane = v->plane[a] + s->i[a];
        double h = c->edge[a] = plane[1] - plane[0];
        double u0 = (o[a] + t0 * d[a] - plane[0]) / h;
        double u1 = (o[a] + t1 * d[a] - plane[0]) / h;
        u0 = u0 < 0 ? 0 : u0 > 1 ? 1 : u0;
        u1 = u1 < 0 ? 0 : u1 > 1 ? 1 : u1;
        c->from[a] = u0;
        c->delta[a] = u1 - u0;
    }
    c->t = t0;
    c->len = t1 - t0;
    along(c);
}

void cell_second(struct cell *c, const struct cell *of, const struct volume *v, const int32_t i[3])
{
    *c = *of;
    corners(c, v->second, v, i);
    along(c);
}

struct vec3 cell_gradient(const struct cell *c, double w)
{
    const double *f = c->f;
    double x = c->from[0] + w * c->delta[0], y = c->from[1] + w * c->delta[1];
    double z = c->from[2] + w * c->delta[2];
    return v3((f[0] + f[3] * y + z * (f[4] + f[6] * y)) / c->edge[0],
        (f[1] + f[3] * x + z * (f[5] + f[6] * x)) / c->edge[1],
        (f[2] + f[4] * x + y * (f[5] + f[6] * x)) / c->edge[2]);
}
