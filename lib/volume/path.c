/*
 * path: what a ray gathers. Light and colour at a point of a cell, a piece by Gauss-Legendre nodes,
 * and halves of a piece.
 */
#include "volume/volume_int.h"

void path_add(struct path *p, double dtau, const double rgb[3])
{
    double through = volume_exp(-dtau), seen = p->transmittance * (1 - through);
    for (int c = 0; c < 3; c++) p->rgb[c] += seen * rgb[c];
    p->transmittance *= through;
}

double path_fade(const struct path *p, double w)
{
    const double a = p->v->spec->attenuation;
    return a > 0 ? volume_exp(-a * (p->cell->t + w * p->cell->len)) : 1;
}

double path_light(const struct path *p, double w)
{
    const struct spec *s = p->v->spec;
    double light = path_fade(p, w);
    if (!s->lit) return light;
    struct vec3 g = cell_gradient(p->cell, w);
    struct vec3 at = v3_mad(p->v->camera.eye, p->dir, p->cell->t + w * p->cell->len);
    struct vec3 l = v3_sub(v3(s->light[0], s->light[1], s->light[2]), at);
    double gg = v3_dot(g, g) * v3_dot(l, l);
    if (!(gg > 0)) return light;
    return light * (VOLUME_AMBIENT + (1 - VOLUME_AMBIENT) * fabs(v3_dot(g, l)) / sqrt(gg));
}

bool volume_colour(const struct path *p, double w, double rgb[3])
{
    const struct map *m = p->second ? &p->v->tint : &p->v->map;
    const struct cell *c = p->second ? p->second : p->cell;
    double s = c->base + cubic_at(c->p, w);
    int i = map_find(m, s);
    if (i >= 0) map_colour(&m->span[i], s, rgb);
    return i >= 0;
}

/* The colour at x of the piece, where the field is q above the span's lo. */
static inline void colour_at(const struct piece *s, double x, double q, double rgb[3])
{
    const struct map_span *f = s->tint ? s->tint : s->span;
    if (s->tint) q = cubic_at(s->of_tint, x);
    for (int c = 0; c < 3; c++) rgb[c] = f->rgb0[c] + f->rgb1[c] * q;
}

void volume_gauss(struct path *p, const struct piece *s, double depth, const struct rule *r)
{
    const struct map_span *f = s->span;
    bool lit = is_lit(p->v);
    double sum = 0, rgb[3] = {0, 0, 0}, colour[3];
    for (int i = 0; i < r->m; i++) {
        double x = cubic_at(s->q, r->node[i]), k = f->k0 + f->k1 * x;
        double weight = r->weight[i] * k * volume_exp(-volume_depth_to(p, s, r->node[i]));
        double light = lit ? path_light(p, s->a + (s->b - s->a) * r->node[i]) : 1;
        sum += weight;
        colour_at(s, r->node[i], x, colour);
        for (int c = 0; c < 3; c++) rgb[c] += weight * light * colour[c];
    }
    p->v->counts.samples += (uint64_t)r->m;
    if (!(sum > 0)) { /* all weights underflow: only the start of the piece is visible */
        double light = lit ? path_light(p, s->a) : 1;
        colour_at(s, 0, s->q[0], colour);
        for (int c = 0; c < 3; c++) rgb[c] = light * colour[c];
        sum = 1;
    }
    for (int c = 0; c < 3; c++) rgb[c] /= sum;
    path_add(p, depth, rgb);
}

void volume_halve(const struct piece *s, struct piece half[2])
{
    double middle = s->a + (s->b - s->a) / 2;
    half[0] = half[1] = *s;
    half[0].b = half[1].a = middle;
    cubic_part(s->q, 0, 0.5, half[0].q);
    cubic_part(s->q, 0.5, 1, half[1].q);
    if (!s->tint) return;
    cubic_part(s->of_tint, 0, 0.5, half[0].of_tint);
    cubic_part(s->of_tint, 0.5, 1, half[1].of_tint);
}
