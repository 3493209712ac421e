/*
 * exact: the picture of SCENE, W by H pixels, as stormring-nff(5) defines it: traced in long double
 * by code that shares none with lib/trace, as a PFM on standard output. Where surfaces coincide, a
 * ray meets one of them: the first in the file, or the last with -l. It ignores the others. A
 * shadow ray crosses all of them, or one with -o. Spheres and flat convex polygons only; depth 5;
 * the eye outside of all glass. No ray is left out.
 */
#include "image/image.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#define DEPTH 5
#define NONE UINT32_MAX
#define MEDIA 64
#define HALF_DEGREE (3.14159265358979323846264338328L / 360)

typedef long double real;
struct v {
    real x, y, z;
};
static struct v of(struct vec3 a) { return (struct v){(real)a.x, (real)a.y, (real)a.z}; }
static struct v mad(struct v a, struct v b, real s)
{
    return (struct v){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}
static struct v sub(struct v a, struct v b) { return mad(a, b, -1); }
static real dot(struct v a, struct v b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static struct v cross(struct v a, struct v b)
{
    return (struct v){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static struct v unit(struct v a) { return mad((struct v){0, 0, 0}, a, 1 / sqrtl(dot(a, a))); }

/* The media around a ray, innermost last. Polygons of a material share one; each sphere has its
 * own. */
struct media {
    int n;
    uint32_t id[MEDIA];
};

struct world {
    const struct scene *s;
    bool last, once; /* -l, -o */
    real near;       /* surfaces that are no farther apart coincide */
};

static struct v corner(const struct scene *s, const struct prim *p, uint32_t i)
{
    return of(s->vertices[p->poly.first + i % p->poly.count]);
}

static struct v normal(const struct scene *s, const struct prim *p, struct v at)
{
    if (p->kind == PRIM_SPHERE) return unit(sub(at, of(p->sphere.center)));
    struct v a = corner(s, p, 0);
    return unit(cross(sub(corner(s, p, 1), a), sub(corner(s, p, 2), a)));
}

/* Distances along the ray at which it crosses the primitive: at most two. */
static int crossings(const struct scene *s, const struct prim *p, struct v o, struct v d, real t[2])
{
    if (p->kind == PRIM_SPHERE) {
        struct v c = sub(of(p->sphere.center), o);
        real r = (real)p->sphere.radius, b = dot(c, d);
        struct v aside = mad(c, d, -b);
        real left = r * r - dot(aside, aside);
        if (left < 0) return 0;
        t[0] = b - sqrtl(left);
        t[1] = b + sqrtl(left);
        return 2;
    }
    struct v a = corner(s, p, 0), n = normal(s, p, a);
    real slope = dot(n, d);
    if (slope == 0) return 0;
    t[0] = dot(n, sub(a, o)) / slope;
    struct v at = mad(o, d, t[0]);
    for (uint32_t i = 0; i < p->poly.count; i++) {
        struct v from = corner(s, p, i);
        if (dot(n, cross(sub(corner(s, p, i + 1), from), sub(at, from))) < 0) return 0;
    }
    return 1;
}

static uint32_t closest(const struct world *w, struct v o, struct v d, real *at)
{
    uint32_t best = NONE;
    *at = HUGE_VALL;
    for (uint32_t i = 0; i < w->s->n_prims; i++) {
        real t[2];
        int n = crossings(w->s, &w->s->prims[i], o, d, t);
        for (int k = 0; k < n; k++) {
            bool tie = fabsl(t[k] - *at) <= w->near;
            if (t[k] <= w->near || (tie ? !w->last : t[k] > *at)) continue;
            *at = t[k];
            best = i;
        }
    }
    return best;
}

/* True if a primitive before number i is crossed at t as well. */
static bool crossed_before(const struct world *w, uint32_t i, struct v o, struct v d, real t)
{
    for (uint32_t j = 0; j < i; j++) {
        real u[2];
        int n = crossings(w->s, &w->s->prims[j], o, d, u);
        for (int k = 0; k < n; k++)
            if (fabsl(u[k] - t) <= w->near) return true;
    }
    return false;
}

/* The part of a lamp's light that comes through. */
static real through(const struct world *w, struct v o, struct v d, real far)
{
    real part = 1;
    for (uint32_t i = 0; i < w->s->n_prims && part > 0; i++) {
        const struct prim *p = &w->s->prims[i];
        real t[2];
        int n = crossings(w->s, p, o, d, t);
        for (int k = 0; k < n; k++) {
            if (t[k] <= w->near || t[k] >= far - w->near) continue;
            if (w->once && crossed_before(w, i, o, d, t[k])) continue;
            part *= (real)w->s->materials[p->material].t;
        }
    }
    return part;
}

static real ior(const struct scene *s, const struct media *m)
{
    if (!m->n) return 1;
    uint32_t id = m->id[m->n - 1];
    real r =
        (real)s->materials[id < s->n_materials ? id : s->prims[id - s->n_materials].material].ior;
    return r > 0 ? r : 1;
}

static void cross_into(struct media *m, uint32_t id)
{
    for (int i = m->n - 1; i >= 0; i--)
        if (m->id[i] == id) {
            memmove(&m->id[i], &m->id[i + 1], (size_t)(m->n - i - 1) * sizeof m->id[0]);
            m->n--;
            return;
        }
    if (m->n == MEDIA) die(ST_USAGE, "expected at most %d media within each other", MEDIA);
    m->id[m->n++] = id;
}

static struct v direct(
    const struct world *w, const struct material *m, struct v at, struct v n, struct v mirror)
{
    struct v sum = {0, 0, 0};
    for (uint32_t i = 0; i < w->s->n_lights; i++) {
        const struct light *l = &w->s->lights[i];
        struct v to = sub(of(l->pos), at);
        real far = sqrtl(dot(to, to)), n_l = dot(n, to) / far, r_l = dot(mirror, to) / far;
        if (n_l <= 0) continue;
        real shine = r_l > 0 ? (real)m->ks * powl(r_l, (real)m->shine) : 0;
        real part = through(w, at, unit(to), far);
        sum.x += part * (real)l->r * ((real)m->kd * (real)m->r * n_l + shine);
        sum.y += part * (real)l->g * ((real)m->kd * (real)m->g * n_l + shine);
        sum.z += part * (real)l->b * ((real)m->kd * (real)m->b * n_l + shine);
    }
    return sum;
}

static struct v colour(
    const struct world *w, struct v o, struct v d, int level, const struct media *in)
{
    const double *b = w->s->background;
    real t;
    uint32_t hit = closest(w, o, d, &t);
    if (hit == NONE) return (struct v){(real)b[0], (real)b[1], (real)b[2]};
    const struct prim *p = &w->s->prims[hit];
    const struct material *m = &w->s->materials[p->material];
    struct v at = mad(o, d, t), n = normal(w->s, p, at), mirror = mad(d, n, -2 * dot(n, d));
    if (dot(n, d) > 0) n = mad((struct v){0, 0, 0}, n, -1);
    struct v sum = direct(w, m, at, n, mirror);
    if (level == DEPTH) return sum;
    real reflected = (real)m->ks;
    if (m->t > 0) {
        struct media inside = *in;
        cross_into(&inside, p->kind == PRIM_SPHERE ? w->s->n_materials + hit : p->material);
        real ratio = ior(w->s, in) / ior(w->s, &inside), c = -dot(n, d);
        real k = 1 + ratio * ratio * (c * c - 1);
        bool bends = fabsl(ratio - 1) >= 1e-10L;
        if (bends && k < 0) {
            reflected = 1;
        } else {
            struct v on =
                bends ? unit(mad(mad((struct v){0, 0, 0}, d, ratio), n, ratio * c - sqrtl(k))) : d;
            sum = mad(sum, colour(w, at, on, level + bends, &inside), (real)m->t);
        }
    }
    return reflected > 0 ? mad(sum, colour(w, at, mirror, level + 1, in), reflected) : sum;
}

static void check(const char *name, const struct scene *s)
{
    for (uint32_t i = 0; i < s->n_prims; i++)
        if (s->prims[i].kind != PRIM_SPHERE && s->prims[i].kind != PRIM_POLYGON)
            die(ST_USAGE, "%s: a cone or a patch, expected spheres and polygons", name);
}

int main(int argc, char **argv)
{
    struct world w = {.near = 1e-13L};
    struct scene s;
    struct image im;
    struct buf text = {0};
    char err[SCENE_ERR];
    int width, height, c;
    prog_init(argv[0]);
    while ((c = prog_getopt(argc, argv, "lo")) != -1) {
        if (c == 'l') w.last = true;
        if (c == 'o') w.once = true;
    }
    if (argc - optind != 2) usage(ST_USAGE, "[-lo] WxH SCENE");
    opt_size('s', argv[optind], 4096, &width, &height);
    const char *name = argv[optind + 1];
    if (read_file(name, &text) != 0) die(ST_USAGE, "%s:", name);
    if (nff_read(name, (const char *)buf_data(&text), buf_size(&text), &s, err) != 0)
        die(ST_USAGE, "%s", err);
    check(name, &s);
    w.s = &s;
    struct v eye = of(s.view.from), ahead = unit(sub(of(s.view.at), eye));
    struct v right = unit(cross(ahead, of(s.view.up))), up = cross(right, ahead);
    real half = tanl((real)s.view.angle_deg * HALF_DEGREE);
    image_init(&im, (uint32_t)width, (uint32_t)height);
    for (int i = 0; i < width * height; i++) {
        real x = (2 * (i % width + .5L) - width) / height, y = 1 - 2 * (i / width + .5L) / height;
        struct v sum = colour(
            &w, eye, unit(mad(mad(ahead, right, half * x), up, half * y)), 1, &(struct media){0});
        float *out = im.rgba + (size_t)4 * (size_t)i;
        out[0] = (float)sum.x;
        out[1] = (float)sum.y;
        out[2] = (float)sum.z;
        out[3] = 1;
    }
    if (image_write(stdout, &im, IMAGE_PFM, 0, NULL) != 0) die(ST_SYSTEM, "standard output:");
    image_free(&im);
    scene_free(&s);
    buf_free(&text);
    close_stdout();
    return ST_OK;
}
