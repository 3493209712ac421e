/*
 * bound: the most light that a ray can bring, from the scene's materials and lights alone. A ray
 * need not be traced if the light that it can bring fits into the rest of the error budget.
 *
 * All numbers are the largest of the three colours. E is the light that a point sends back by
 * itself: per light I, at most I (C kd + ks), because N.L and (R.L)^shine are at most 1. B is the
 * background. R(l) bounds a ray of level l.
 *
 *     R(depth) = max(B, E)                      the last level has no secondary rays
 *
 * Above it, a hit may be one of three:
 *
 *     unbent         E + ks R(l+1) + t R(l)     the transmitted ray keeps its level
 *     bent           E + (ks + t) R(l+1)
 *     turned back    E + R(l+1)                 total internal reflection
 *
 * A ray passes unbent some n times in a row, n at most twice the number of items. So with
 * P = max(E + ks R(l+1)) over the transmitting materials, and T their largest t,
 *
 *     R(l) = P (1 + T + T^2 + ... + T^(n-1)) + the greatest light of a hit that ends the row
 */
#include "trace/trace_int.h"

#include <stdlib.h>

static double largest(struct vec3 c) { return fmax(c.x, fmax(c.y, c.z)); }

/* E of one material. */
static double own_light(const struct tracer *t, const struct surface *f)
{
    struct vec3 sum = v3(0, 0, 0);
    for (uint32_t i = 0; i < t->scene->n_lights; i++) {
        const struct light *l = &t->scene->lights[i];
        sum.x += l->r * (f->colour_kd.x + f->ks);
        sum.y += l->g * (f->colour_kd.y + f->ks);
        sum.z += l->b * (f->colour_kd.z + f->ks);
    }
    return largest(sum);
}

/* 1 + x + ... + x^(n-1) */
static double series(double x, double n) { return x < 1 ? fmin(n, 1 / (1 - x)) : n; }

void bound_radiance(struct tracer *t)
{
    const struct scene *s = t->scene;
    int depth = t->options.depth;
    double b = largest(v3(s->background[0], s->background[1], s->background[2]));
    double most_t = 0, *own = xmalloc(s->n_materials, sizeof *own);
    t->radiance[depth] = b;
    for (uint32_t i = 0; i < s->n_materials; i++) {
        own[i] = own_light(t, &t->surfaces[i]);
        most_t = fmax(most_t, t->surfaces[i].t);
        t->radiance[depth] = fmax(t->radiance[depth], own[i]);
    }
    for (int l = depth - 1; l > 0; l--) {
        double next = t->radiance[l + 1], passed = 0, last = b;
        for (uint32_t i = 0; i < s->n_materials; i++) {
            const struct surface *f = &t->surfaces[i];
            double mirrored = own[i] + f->ks * next;
            if (f->t > 0) {
                passed = fmax(passed, mirrored);
                last = fmax(last, fmax(mirrored + f->t * next, own[i] + next));
            }
            last = fmax(last, mirrored);
        }
        t->radiance[l] = passed * series(most_t, 2.0 * t->n_items) + last;
    }
    free(own);
}
