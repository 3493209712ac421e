/*
 * light: the point where a ray hit a surface, and its direct light. Per light: I * (kd C N.L + ks
 * (R.L)^shine) times the transmission of the surfaces in between.
 */
#include "trace/trace_int.h"

#include <stdlib.h>

void trace_hit_point(
    const struct tracer *t, const struct ray *r, const struct hit *h, struct hit_point *at)
{
    at->item = &t->items[h->item];
    at->start = h->item + 1;
    at->surface = &t->surfaces[at->item->material];
    at->p = v3_mad(r->o, r->d, h->t);
    at->n = trace_shapes[at->item->kind]->normal(t->scene, at->item, &at->p);
    double along = v3_dot(at->n, r->d);
    at->mirrored = v3_mad(r->d, at->n, -2 * along);
    if (along > 0) at->n = v3_scale(at->n, -1); /* two-sided: toward the ray */
    at->err = ERR_UNIT * (fabs(at->p.x) + fabs(at->p.y) + fabs(at->p.z) + h->t);
}

bool light_from(const struct tracer *t, const struct hit_point *at, uint32_t i, struct vec3 *light,
    struct ray *shadow)
{
    const struct light *l = &t->scene->lights[i];
    const struct surface *f = at->surface;
    struct vec3 to = v3_sub(l->pos, at->p);
    /* The light is behind the surface, or in its plane, where rounding would decide (lanes.h). This
     * test comes before the square root, because it is cheaper. */
    double err = at->err + ERR_UNIT * (fabs(to.x) + fabs(to.y) + fabs(to.z));
    if (!(v3_dot(at->n, to) > err)) return false;
    double distance = v3_len(to);
    struct vec3 d = v3_scale(to, 1 / distance);
    double n_l = v3_dot(at->n, d), r_l = f->ks > 0 ? v3_dot(at->mirrored, d) : 0;
    double highlight = r_l > 0 ? f->ks * trace_pow(r_l < 1 ? r_l : 1, f->shine) : 0;
    if (!f->diffuse && !(highlight > 0) && !t->options.by_spd) return false;
    light->x = l->r * (f->colour_kd.x * n_l + highlight);
    light->y = l->g * (f->colour_kd.y * n_l + highlight);
    light->z = l->b * (f->colour_kd.z * n_l + highlight);
    *shadow = (struct ray){at->p, d, 0, distance, at->err, t->light_in_surface[i], at->start};
    return true;
}

#define FEW 32 /* items; more come from smoke and layered glass */

static int by_number(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static void sort_items(uint32_t *item, uint32_t n)
{
    if (n > FEW) qsort(item, n, sizeof *item, by_number);
    if (n > FEW) return;
    for (uint32_t i = 1; i < n; i++) {
        uint32_t x = item[i], k = i;
        for (; k > 0 && item[k - 1] > x; k--) item[k] = item[k - 1];
        item[k] = x;
    }
}

/*
 * The factors are multiplied in item order, so the traversal order does not change the product. A
 * polygon or patch counts once, even if the ray hit the seam of two triangles. Items that enclose
 * something count once per crossing, on the way in and out.
 */
double light_through(const struct tracer *t, struct crossings *c)
{
    double product = 1;
    uint32_t last = NO_ITEM;
    sort_items(c->item, c->n);
    for (uint32_t i = 0; i < c->n; i++) {
        const struct item *it = &t->items[c->item[i]];
        if (it->prim != last || shape_encloses(it->kind)) product *= t->surfaces[it->material].t;
        last = it->prim;
    }
    return product;
}

void crossings_add(struct crossings *c, uint32_t item)
{
    if (c->n == c->cap) {
        c->cap = c->cap ? 2 * c->cap : 64;
        c->item = xrealloc(c->item, c->cap, sizeof *c->item);
    }
    c->item[c->n++] = item;
}
