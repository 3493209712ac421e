/*
 * onward: reflection and refraction, as in POV-Ray 3.7. A ray that crosses
 * the surface of a medium that contains it leaves that medium; otherwise it enters the medium.
 * Total internal reflection has weight 1 and replaces both rays. A surface that does not bend the
 * ray does not use up a level.
 */
#include "trace/trace_int.h"

#define SAME_IOR 1e-10 /* the reference's value: a ratio this close to 1 bends nothing */

/* The medium that the item bounds. */
static uint32_t medium_of(const struct tracer *t, const struct item *it)
{
    return shape_encloses(it->kind) ? t->scene->n_materials + it->prim : it->material;
}

/* The index of refraction of the innermost medium. */
static double ior_in(const struct tracer *t, const struct media *m, uint32_t list)
{
    if (!list) return 1;
    uint32_t id = m->link[list].id, n = t->scene->n_materials;
    return t->surfaces[id < n ? id : t->scene->prims[id - n].material].ior;
}

enum passage { STRAIGHT, BENT, TURNED_BACK };

/* P. Heckbert, "Derivation of refraction formulas", An Introduction to Ray Tracing, 1989. */
static enum passage refract(struct vec3 *d, struct vec3 n, double ratio)
{
    if (fabs(ratio - 1) < SAME_IOR) return STRAIGHT;
    double c = -v3_dot(*d, n), k = 1 + ratio * ratio * (c * c - 1);
    if (k < 0) return TURNED_BACK;
    *d = v3_unit(v3_mad(v3_scale(*d, ratio), n, ratio * c - sqrt(k)));
    return BENT;
}

void trace_spawn_secondary(const struct tracer *t, const struct ray *r, const struct hit_point *at,
    int level, struct media *m, uint32_t outside, struct onward *o)
{
    const struct surface *f = at->surface;
    o->reflected = f->ks > 0 || (f->t > 0 && t->options.by_spd);
    o->mirror_weight = f->ks;
    o->passed = f->t > 0;
    if (o->passed) {
        struct vec3 d = r->d;
        o->inside = media_cross(m, outside, medium_of(t, at->item));
        enum passage how = refract(&d, at->n, ior_in(t, m, outside) / ior_in(t, m, o->inside));
        o->through = (struct ray){at->p, d, 0, HUGE_VAL, at->err, false, at->start};
        o->through_weight = f->t;
        o->through_level = level + (how == BENT || t->options.by_spd);
        if (how == TURNED_BACK) {
            media_drop(m, o->inside);
            o->passed = false;
            o->reflected = true;
            o->mirror_weight = 1;
        }
    }
    if (o->reflected)
        o->mirror =
            (struct ray){at->p, v3_unit(at->mirrored), 0, HUGE_VAL, at->err, false, at->start};
    o->mirror_level = level + 1;
}
