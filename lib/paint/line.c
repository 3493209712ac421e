/* line: the cover of a pixel is that of a strip as wide as the line, at the distance of the
 * pixel's centre. */
#include "paint/line.h"

#include <math.h>
#include <string.h>

struct line {
    double px, py, dx, dy, inverse; /* 1 / length squared; 0 for a point */
    double reach;                   /* pixels: further away a line covers nothing */
    double most;
};

static double distance(const struct line *l, double x, double y)
{
    const double ax = x - l->px, ay = y - l->py;
    double t = (ax * l->dx + ay * l->dy) * l->inverse;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    const double bx = ax - t * l->dx, by = ay - t * l->dy;
    return sqrt(bx * bx + by * by);
}

/* The first pixel whose centre is not below v, within a side. */
static uint32_t pixel(double v, uint32_t side)
{
    v = ceil(v - .5);
    return v <= 0 ? 0 : v >= side ? side : (uint32_t)v;
}

/* The part of the line that is near row y, from a to b in factors. */
static void part_of(const struct line *l, double y, double *a, double *b)
{
    *a = 0;
    *b = 1;
    if (fabs(l->dy) < 1e-6) return;
    const double s = (y - l->reach - l->py) / l->dy, t = (y + l->reach - l->py) / l->dy;
    *a = fmax(0, fmin(s, t));
    *b = fmin(1, fmax(s, t));
}

static void row(struct cover *c, const struct line *l, uint32_t y)
{
    double a, b;
    part_of(l, y + .5, &a, &b);
    const double from = l->px + a * l->dx, to = l->px + b * l->dx;
    const uint32_t end = pixel(fmax(from, to) + l->reach, c->w);
    uint8_t *at = c->at + (size_t)y * c->w;
    for (uint32_t x = pixel(fmin(from, to) - l->reach, c->w); x < end; x++) {
        const double v = fmin(l->most, l->reach - distance(l, x + .5, y + .5));
        const int cover = (int)(255 * v + .5);
        if (cover > at[x]) at[x] = (uint8_t)cover;
    }
}

void paint_line(struct cover *c, struct backdrop_at p, struct backdrop_at q, double width)
{
    struct line l = {p.x, p.y, q.x - p.x, q.y - p.y, 0, (1 + width) / 2, fmin(width, 1)};
    const double square = l.dx * l.dx + l.dy * l.dy;
    if (square > 0) l.inverse = 1 / square;
    const uint32_t first = pixel(fmin(p.y, q.y) - l.reach, c->h);
    const uint32_t end = pixel(fmax(p.y, q.y) + l.reach, c->h);
    if (first >= end) return;
    for (uint32_t y = first; y < end; y++) row(c, &l, y);
    if (first < c->first) c->first = first;
    if (end > c->end) c->end = end;
}

static uint32_t mixed(uint32_t under, uint32_t over, uint32_t cover)
{
    uint32_t result = 0;
    over |= 0xff000000u;
    for (int shift = 0; shift < 32; shift += 8) {
        uint32_t u = under >> shift & 255, o = over >> shift & 255;
        result |= ((u * (255 - cover) + o * cover) * 257 + 32896) >> 16 << shift;
    }
    return result;
}

void paint_covered(struct cover *c, uint32_t rgb, uint32_t *argb)
{
    for (size_t i = (size_t)c->first * c->w; i < (size_t)c->end * c->w; i++)
        if (c->at[i]) argb[i] = mixed(argb[i], rgb, c->at[i]);
    if (c->first < c->end)
        memset(c->at + (size_t)c->first * c->w, 0, (size_t)(c->end - c->first) * c->w);
    c->first = c->h;
    c->end = 0;
}
