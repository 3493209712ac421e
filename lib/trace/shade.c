/*
 * shade: the colour a ray sees. Per light: shadow * I * (kd C N.L + ks (R.L)^shine), the normal turned toward the ray;
 * then ks * reflected + T * refracted, as POV-Ray 3.7 does it.
 *
 * A ray carries the media it is inside of. All polygons of one material bound one medium (they are one mesh in
 * the reference), a sphere or cone bounds its own. Crossing the surface of a medium that the ray is in leaves it, of
 * another enters it.
 */
#include "trace/trace_int.h"

#include <stdlib.h>
#include <string.h>

#define SAME_IOR 1e-10 /* POV-Ray: a ratio as near to 1 as this bends nothing */

struct medium {
    uint32_t id;
    double ior;
};
struct media {
    int n;
    struct medium in[MEDIA_MAX];
};

static void media_copy(struct media *to, const struct media *from)
{
    to->n = from->n;
    memcpy(to->in, from->in, (size_t)from->n * sizeof from->in[0]);
}

/* The medium that the item bounds: a material's mesh, or the primitive itself. */
static uint32_t medium_of(const struct tracer *t, const struct item *it)
{
    return it->kind == ITEM_TRIANGLE ? it->material : t->scene->n_materials + it->prim;
}

/* Enters or leaves medium m; returns the ratio of the indices of refraction, before / after. */
static double media_cross(struct media *in, struct medium m)
{
    int i = in->n - 1;
    while (i >= 0 && in->in[i].id != m.id) i--;
    double before = in->n ? in->in[in->n - 1].ior : 1;
    if (i < 0) {
        if (in->n < MEDIA_MAX) in->in[in->n++] = m;
        return before / m.ior;
    }
    memmove(&in->in[i], &in->in[i + 1], (size_t)(in->n - i - 1) * sizeof in->in[0]);
    in->n--;
    return before / (in->n ? in->in[in->n - 1].ior : 1);
}

void crossings_add(struct crossings *c, uint32_t item)
{
    if (c->n == c->cap) {
        c->cap = c->cap ? 2 * c->cap : 64;
        c->item = xrealloc(c->item, c->cap, sizeof *c->item);
    }
    c->item[c->n++] = item;
}

/*
 * What the crossed surfaces let through, multiplied in the order of items. Polygons and patches count once, also where
 * the ray met the seam of two triangles; the others as often as they stand there, on the way in and out.
 */
static double through(const struct tracer *t, struct crossings *c)
{
    for (uint32_t i = 1; i < c->n; i++) {
        uint32_t x = c->item[i], k = i;
        for (; k > 0 && c->item[k - 1] > x; k--) c->item[k] = c->item[k - 1];
        c->item[k] = x;
    }
    double product = 1;
    uint32_t last = NO_ITEM;
    for (uint32_t i = 0; i < c->n; i++) {
        const struct item *it = &t->items[c->item[i]];
        if (it->prim != last || it->kind != ITEM_TRIANGLE) product *= t->surfaces[it->material].t;
        last = it->prim;
    }
    return product;
}

/* The part of a light's power that reaches the start of ray r, whose t_max is the distance to it. */
static double visibility(struct tracer *t, const struct ray *r)
{
    t->crossings.n = 0;
    t->counts.shadow++;
    if (t->k->blocked(&t->bvh, r, t->transmits, &t->crossings)) return 0;
    return t->crossings.n ? through(t, &t->crossings) : 1;
}

/* Where a ray met an item. */
struct point {
    struct vec3 p, n; /* n toward the ray */
    double err;
    const struct item *item;
    const struct surface *surface;
};

static void light_up(struct tracer *t, const struct point *at, struct vec3 mirrored,
    const struct light *light, struct vec3 *sum)
{
    const struct surface *f = at->surface;
    struct vec3 to = v3_sub(light->pos, at->p);
    double distance = v3_len(to);
    if (!(distance > 0)) return;
    struct ray r = {at->p, v3_scale(to, 1 / distance), 0, distance, at->err};
    double n_l = v3_dot(at->n, r.d);
    if (!(n_l > 0)) return;
    double r_l = f->ks > 0 ? v3_dot(mirrored, r.d) : 0;
    double highlight = r_l > 0 ? f->ks * trace_pow(r_l < 1 ? r_l : 1, f->shine) : 0;
    if (!f->diffuse && !(highlight > 0)) return;
    double shadow = visibility(t, &r);
    if (!(shadow > 0)) return;
    sum->x += shadow * light->r * (f->colour_kd.x * n_l + highlight);
    sum->y += shadow * light->g * (f->colour_kd.y * n_l + highlight);
    sum->z += shadow * light->b * (f->colour_kd.z * n_l + highlight);
}

static struct vec3 colour(struct tracer *t, const struct ray *r, int level, const struct media *in);

static struct vec3 reflected(struct tracer *t, const struct point *at, struct vec3 mirrored,
    int level, const struct media *in)
{
    struct ray r = {at->p, v3_unit(mirrored), 0, HUGE_VAL, at->err};
    t->counts.reflected++;
    return colour(t, &r, level + 1, in);
}

/* What becomes of a ray that goes on through a surface. */
enum passage { STRAIGHT, BENT, TURNED_BACK };

/*
 * Crosses the surface: changes the ray and what it is inside of, unless it is reflected totally.
 * P. Heckbert, "Derivation of refraction formulas", An Introduction to Ray Tracing, 1989.
 */
static enum passage pass(const struct tracer *t, const struct point *at, struct ray *r, struct media *in)
{
    struct media inside;
    media_copy(&inside, in);
    double ratio =
        media_cross(&inside, (struct medium){medium_of(t, at->item), at->surface->ior});
    struct vec3 d = r->d;
    bool straight = fabs(ratio - 1) < SAME_IOR;
    if (!straight) {
        double c = -v3_dot(d, at->n), k = 1 + ratio * ratio * (c * c - 1);
        if (k < 0) return TURNED_BACK;
        d = v3_unit(v3_mad(v3_scale(d, ratio), at->n, ratio * c - sqrt(k)));
    }
    *r = (struct ray){at->p, d, 0, HUGE_VAL, at->err};
    media_copy(in, &inside);
    return straight ? STRAIGHT : BENT;
}

static void meet(const struct tracer *t, const struct ray *r, const struct hit *h, struct point *at)
{
    at->item = &t->items[h->item];
    at->surface = &t->surfaces[at->item->material];
    at->p = v3_mad(r->o, r->d, h->t);
    at->n = shapes[at->item->kind]->normal(t->scene, at->item, &at->p);
    if (v3_dot(at->n, r->d) > 0) at->n = v3_scale(at->n, -1);
    at->err = ERR_UNIT * (fabs(at->p.x) + fabs(at->p.y) + fabs(at->p.z) + h->t);
}

/* Light from the scene's lights, diffuse and highlight. */
static struct vec3 local_light(struct tracer *t, const struct point *at, struct vec3 mirrored)
{
    struct vec3 sum = v3(0, 0, 0);
    for (uint32_t i = 0; i < t->scene->n_lights; i++)
        light_up(t, at, mirrored, &t->scene->lights[i], &sum);
    return sum;
}

/*
 * Follows r through surfaces that transmit, adding up what each gives by itself and by reflection, weighted by the
 * transmittances before it. As in the reference, a surface that does not bend the ray does not use up a level; but
 * nothing at the last level is seen through.
 */
static struct vec3 colour(struct tracer *t, const struct ray *start, int level, const struct media *outside)
{
    struct ray r = *start;
    struct media in;
    struct vec3 sum = v3(0, 0, 0);
    double weight = 1;
    media_copy(&in, outside);
    for (;;) {
        struct hit h;
        struct point at;
        t->k->closest(&t->bvh, &r, &h);
        const double *b = t->scene->background;
        if (h.item == NO_ITEM) return v3_mad(sum, v3(b[0], b[1], b[2]), weight);
        meet(t, &r, &h, &at);
        const struct surface *f = at.surface;
        struct vec3 mirrored = v3_mad(r.d, at.n, -2 * v3_dot(r.d, at.n));
        sum = v3_mad(sum, local_light(t, &at, mirrored), weight);
        struct ray onward = r;
        struct media before;
        enum passage how = STRAIGHT;
        if (f->t > 0) {
            media_copy(&before, &in);
            how = pass(t, &at, &onward, &in);
        }
        const struct media *here = f->t > 0 ? &before : &in;
        bool deeper = level < t->options.depth;
        if (deeper && how == TURNED_BACK)
            return v3_mad(sum, reflected(t, &at, mirrored, level, here), weight);
        if (deeper && f->ks > 0)
            sum = v3_mad(sum, reflected(t, &at, mirrored, level, here), weight * f->ks);
        if (!(f->t > 0) || !deeper) return sum;
        t->counts.refracted++;
        if (how == BENT) level++;
        weight *= f->t;
        r = onward;
    }
}

struct vec3 trace_colour(struct tracer *t, const struct ray *r)
{
    struct media none;
    none.n = 0;
    t->counts.eye++;
    return colour(t, r, 1, &none);
}
