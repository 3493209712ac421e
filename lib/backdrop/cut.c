/*
 * cut: clips the map to its visible part. The map is a plane, and so are the bounds of the view. So
 * each bound is a straight line on the map, and lines stay straight in the picture.
 */
#include "backdrop/outline.h"

static double side(const struct half *h, struct outline_point p)
{
    return h->a * p.x + h->b * p.y + h->c;
}

struct outline_point outline_between(struct outline_point p, struct outline_point q, double f)
{
    return (struct outline_point){p.x + f * (q.x - p.x), p.y + f * (q.y - p.y)};
}

#define BEYOND 2.0 /* pixels: sides of the picture are so far out, so that no cut is seen */

/* Where a point on the map is in the direction d from the eye; c: at the map's height. */
static struct half along(const struct drawing *s, struct vec3 d)
{
    const double *scale = s->b->spec->scale;
    return (struct half){
        d.x * scale[0], d.y * scale[1], d.z * (s->z * scale[2]) - v3_dot(d, s->camera.eye)};
}

/* That of the eye has a small margin, relative to the distance of the map. */
void drawing_bound(struct drawing *s)
{
    struct half *h = s->half;
    const double *scale = s->b->spec->scale, *lo = s->lo, *hi = s->hi;
    const struct camera *c = &s->camera;
    struct vec3 corner = v3(lo[0] * scale[0], lo[1] * scale[1], s->z * scale[2]);
    h[0] = (struct half){1, 0, -lo[0]};
    h[1] = (struct half){-1, 0, hi[0]};
    h[2] = (struct half){0, 1, -lo[1]};
    h[3] = (struct half){0, -1, hi[1]};
    h[4] = along(s, c->forward);
    h[4].c -= 1e-3 * v3_len(v3_sub(corner, c->eye));
    s->n_halves = 5;
    if (!s->clipped) return;
    double half = v3_dot(c->up, c->up); /* as in backdrop_project */
    double wide = (s->w + 2 * BEYOND) / s->h * half, high = (s->h + 2 * BEYOND) / s->h * half;
    for (int i = 0; i < 4; i++)
        h[5 + i] = along(s, v3_mad(v3_scale(c->forward, i < 2 ? wide : high),
                                i < 2 ? c->right : c->up, i % 2 ? -1 : 1));
    s->n_halves = HALVES;
}

/* The corner of the box that is furthest inside (1) or outside (-1). */
static struct outline_point corner_of(
    const struct half *h, struct outline_point lo, struct outline_point hi, int way)
{
    return (struct outline_point){h->a * way > 0 ? hi.x : lo.x, h->b * way > 0 ? hi.y : lo.y};
}

bool outline_halves(
    const struct drawing *s, struct outline_point lo, struct outline_point hi, struct halves *h)
{
    const struct half *all = s->half;
    h->n = 0;
    for (int i = 0; i < s->n_halves; i++) {
        if (side(&all[i], corner_of(&all[i], lo, hi, 1)) < 0) return false;
        if (!(side(&all[i], corner_of(&all[i], lo, hi, -1)) >= 0)) h->at[h->n++] = all[i];
    }
    return true;
}

bool backdrop_cut_line(
    const struct halves *h, struct outline_point p, struct outline_point q, double part[2])
{
    part[0] = 0;
    part[1] = 1;
    for (int i = 0; i < h->n; i++) {
        double a = side(&h->at[i], p), b = side(&h->at[i], q);
        if (a < 0 && b < 0) return false;
        if (a < 0) part[0] = fmax(part[0], a / (a - b));
        if (b < 0) part[1] = fmin(part[1], a / (a - b));
    }
    return part[0] <= part[1];
}

/* I. E. Sutherland, G. W. Hodgman, "Reentrant polygon clipping", CACM 17(1), 1974. Separate pieces
 * stay joined along the clipping line, where they enclose no area. */
static void cut_by(const struct half *h, const struct outline *o, struct outline *kept)
{
    kept->n = 0;
    for (size_t i = 0; i < o->n; i++) {
        struct outline_point p = o->at[i ? i - 1 : o->n - 1], q = o->at[i];
        double a = side(h, p), b = side(h, q);
        if ((a < 0) != (b < 0)) outline_append(kept, outline_between(p, q, a / (a - b)));
        if (b >= 0) outline_append(kept, q);
    }
}

void backdrop_cut_polygon(const struct halves *h, struct outline *o, struct outline *other)
{
    for (int i = 0; i < h->n; i++) {
        cut_by(&h->at[i], o, other);
        struct outline swap = *o;
        *o = *other;
        *other = swap;
    }
}
