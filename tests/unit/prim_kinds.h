/*
 * prim_kinds: what unit tests know of each kind of primitive, a row each: random ones, those that
 * are convex by themselves, texts that are refused, and lamps in its surface.
 */
#ifndef PRIM_KINDS_H
#define PRIM_KINDS_H

#include "scene/scene.h"

#include <setjmp.h>
#include <stdlib.h>
#include <cmocka.h>

/* Transforms that every coordinate goes through: p * scale + shift on each axis. */
struct placing {
    double scale, shift;
};
static const struct placing in_place = {1, 0};

static inline struct vec3 placed(struct placing at, struct vec3 p)
{
    return v3_mad(v3(at.shift, at.shift, at.shift), p, at.scale);
}

static inline void put_point(struct buf *b, struct placing at, double x, double y, double z)
{
    buf_printf(b, " %.17g %.17g %.17g", x * at.scale + at.shift, y * at.scale + at.shift,
        z * at.scale + at.shift);
}

static inline double between(uint64_t seed, uint64_t *n, double lo, double hi)
{
    return lo + (hi - lo) * rng_unit(seed, (*n)++);
}

static inline struct vec3 random_point(uint64_t seed, uint64_t *n, double size)
{
    double x = between(seed, n, -size, size), y = between(seed, n, -size, size);
    return v3(x, y, between(seed, n, -size, size));
}

/* Vectors of the references, in long double. */
typedef long double real;
struct vec {
    real x, y, z;
};
static inline struct vec less(struct vec3 a, struct vec3 b)
{
    return (struct vec){(real)a.x - (real)b.x, (real)a.y - (real)b.y, (real)a.z - (real)b.z};
}
static inline real dot(struct vec a, struct vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline struct vec mad(struct vec a, struct vec b, real s)
{
    return (struct vec){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

struct prim_kind_row {
    /* One of about size r at p. */
    void (*put)(
        struct buf *b, struct placing at, struct vec3 p, double r, uint64_t seed, uint64_t *n);
    /* NULL: the scene's vertices are placed. */
    void (*place)(struct prim *p, struct placing at);
    const char *convex[2]; /* around 0: no ray that leaves the outside of one hits it again */
    struct {
        const char *text, *says;
    } refused[4];
    /* A point of the surface, well inside of it, and its normal. d: a random direction; u, v: .1
     * to .4. */
    struct vec3 (*lamp)(const struct scene *s, const struct prim *q, struct vec3 d, double u,
        double v, struct vec3 *normal);
    /* The way is from a point (0) to the lamp (1). Where it crosses the surface again, which has no
     * end; *z: inside of the ends if 0 to 1. NULL: nowhere. */
    real (*again)(const struct prim *q, struct vec3 lamp, struct vec way, real *z);
};

/* ---- sphere ------------------------------------------------------------------------------- */

static inline void put_sphere(
    struct buf *b, struct placing at, double x, double y, double z, double r)
{
    buf_printf(b, "s");
    put_point(b, at, x, y, z);
    buf_printf(b, " %.17g\n", r * at.scale);
}

static inline void sphere_put(
    struct buf *b, struct placing at, struct vec3 p, double r, uint64_t seed, uint64_t *n)
{
    (void)seed, (void)n;
    put_sphere(b, at, p.x, p.y, p.z, r);
}

static inline void sphere_place(struct prim *p, struct placing at)
{
    p->sphere.center = placed(at, p->sphere.center);
    p->sphere.radius *= at.scale;
}

static inline struct vec3 sphere_lamp(const struct scene *s, const struct prim *q, struct vec3 d,
    double u, double v, struct vec3 *normal)
{
    (void)s, (void)u, (void)v;
    *normal = d;
    return v3_mad(q->sphere.center, d, fabs(q->sphere.radius));
}

static inline real sphere_again(const struct prim *q, struct vec3 lamp, struct vec way, real *z)
{
    *z = .5L;
    return 1 - 2 * dot(way, less(lamp, q->sphere.center)) / dot(way, way);
}

/* ---- cone --------------------------------------------------------------------------------- */

static inline void cone_put(
    struct buf *b, struct placing at, struct vec3 p, double r, uint64_t seed, uint64_t *n)
{
    buf_printf(b, "c\n");
    put_point(b, at, p.x, p.y, p.z);
    buf_printf(b, " %.17g\n", r * at.scale);
    double dx = between(seed, n, -1, 1), dy = between(seed, n, -1, 1);
    put_point(b, at, p.x + dx, p.y + dy, p.z + 0.5);
    buf_printf(b, " %.17g\n", r * at.scale * between(seed, n, 0, 1));
}

static inline void cone_place(struct prim *p, struct placing at)
{
    p->cone.base = placed(at, p->cone.base);
    p->cone.apex = placed(at, p->cone.apex);
    p->cone.base_radius *= at.scale;
    p->cone.apex_radius *= at.scale;
}

static inline struct vec3 cone_lamp(const struct scene *s, const struct prim *q, struct vec3 d,
    double u, double v, struct vec3 *normal)
{
    (void)s;
    struct vec3 axis = v3_sub(q->cone.apex, q->cone.base);
    double len = v3_len(axis), r = q->cone.base_radius;
    double widen = q->cone.apex_radius - r;
    axis = v3_scale(axis, 1 / len);
    d = v3_unit(v3_mad(d, axis, -v3_dot(d, axis)));
    *normal = v3_unit(v3_mad(d, axis, -widen / len));
    return v3_mad(v3_mad(q->cone.base, axis, (u + v) * len), d, r + widen * (u + v));
}

static inline real cone_again(const struct prim *q, struct vec3 lamp, struct vec way, real *z)
{
    struct vec axis = less(q->cone.apex, q->cone.base), up = less(lamp, q->cone.base);
    real len2 = dot(axis, axis), z0 = dot(up, axis) / len2, rise = dot(way, axis) / len2;
    real widen = (real)q->cone.apex_radius - (real)q->cone.base_radius;
    real r = (real)q->cone.base_radius + widen * z0;
    struct vec across = mad(up, axis, -z0), e = mad(way, axis, -rise);
    real a = dot(e, e) - widen * rise * widen * rise;
    real t = 1 - 2 * (dot(across, e) - r * widen * rise) / a;
    *z = z0 + (t - 1) * rise;
    return t;
}

/* ---- polygon and patch -------------------------------------------------------------------- */

/* An arrow head: concave. */
static inline void polygon_put(
    struct buf *b, struct placing at, struct vec3 p, double r, uint64_t seed, uint64_t *n)
{
    (void)seed, (void)n;
    buf_printf(b, "p 4\n");
    put_point(b, at, p.x, p.y, p.z + r);
    put_point(b, at, p.x - r, p.y, p.z - r);
    put_point(b, at, p.x, p.y, p.z - r / 2);
    put_point(b, at, p.x + r, p.y, p.z - r);
    buf_printf(b, "\n");
}

static inline void patch_put(
    struct buf *b, struct placing at, struct vec3 p, double r, uint64_t seed, uint64_t *n)
{
    (void)r;
    buf_printf(b, "pp 3\n");
    for (int i = 0; i < 3; i++) {
        double dx = between(seed, n, -1, 1), dy = between(seed, n, -1, 1);
        put_point(b, at, p.x + dx, p.y + dy, p.z + between(seed, n, -1, 1));
        buf_printf(b, " %.17g %.17g 1\n", dx, dy);
    }
}

static inline struct vec3 polygon_lamp(const struct scene *s, const struct prim *q, struct vec3 d,
    double u, double v, struct vec3 *normal)
{
    struct triangle tri[8];
    (void)d;
    scene_triangulate(s, q, tri);
    struct vec3 a = s->vertices[tri[0].v[0]], e = v3_sub(s->vertices[tri[0].v[1]], a);
    struct vec3 f = v3_sub(s->vertices[tri[0].v[2]], a);
    *normal = v3_unit(v3_cross(e, f));
    return v3_mad(v3_mad(a, e, u), f, v);
}

/* ------------------------------------------------------------------------------------------- */

static const struct prim_kind_row prim_kinds[PRIM_KINDS] = {
    [PRIM_SPHERE] = {sphere_put, sphere_place, {"s 0 0 0 1\n"},
        {{"s 0 0 0 0", "radius"}, {"s 0 0 0 1e-300", "radius"}}, sphere_lamp, sphere_again},
    [PRIM_CONE] = {cone_put, cone_place,
        {"c\n0 0 -1 .7\n.2 .1 1 .7\n", "c\n0 0 -1 .9\n.2 .1 1 .1\n"},
        {{"c 0 0 0 1 0 0 0 1", "same point"}, {"c 0 0 0 0 0 0 1 0", "both 0"},
            {"c 0 0 0 1 0 0 1 -1", "one sign"}},
        cone_lamp, cone_again},
    [PRIM_POLYGON] = {polygon_put, NULL,
        {"p 5\n1 0 .1\n.3 1 .23\n-1 .4 -.02\n-.8 -.7 -.22\n.4 -.9 -.14\n"},
        {{"p 2 0 0 0 1 1 1", "polygon's count is '2', expected an integer from 3"}}, polygon_lamp,
        NULL},
    [PRIM_PATCH] = {patch_put, NULL, {NULL}, {{NULL, NULL}}, polygon_lamp, NULL},
};

static inline void put_random_prim(struct buf *b, struct placing at, uint64_t seed, uint64_t *n)
{
    double x = between(seed, n, -2, 2), y = between(seed, n, -2, 2), z = between(seed, n, -1, 2);
    double r = between(seed, n, 0.05, 0.6);
    uint64_t kind = rng_u64(seed, (*n)++) % PRIM_KINDS;
    prim_kinds[kind].put(b, at, v3(x, y, z), r, seed, n);
}

#endif
