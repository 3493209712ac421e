/* map: extinction and colour from scalars, directly by the knots: no table, no sampling. */
#include "volume/volume_int.h"

#include <stdlib.h>

#define BEYOND 1e30 /* no value is as large */

static void span_init(struct map_span *p, const struct spec_knot *a, const struct spec_knot *b)
{
    double width = b->s - a->s;
    p->lo = a->s;
    p->hi = b->s;
    p->slope = 0;
    p->k0 = a->k;
    p->k1 = (b->k - a->k) / width;
    for (int c = 0; c < 3; c++) {
        p->rgb0[c] = a->rgb[c];
        p->rgb1[c] = (b->rgb[c] - a->rgb[c]) / width;
        p->slope = fmax(p->slope, fabs(p->rgb1[c]));
    }
    p->transparent = a->k == 0 && b->k == 0;
}

static void add_span(struct map *m, const struct spec_knot *a, const struct spec_knot *b)
{
    m->closed = b->s > a->s;
    if (m->closed) span_init(&m->span[m->n++], a, b);
}

void map_init(struct map *m, const struct spec_knot *knot, size_t n)
{
    m->span = xmalloc(n + 1, sizeof *m->span);
    m->n = 0;
    m->closed = false;
    for (size_t i = 1; i < n; i++) add_span(m, &knot[i - 1], &knot[i]);
}

void map_init_colours(struct map *m, const struct spec_knot *knot, size_t n)
{
    m->span = xmalloc(n + 2, sizeof *m->span);
    m->n = 0;
    m->closed = false;
    if (!n) return;
    struct spec_knot below = knot[0], above = knot[n - 1];
    below.s = -BEYOND;
    above.s = BEYOND;
    add_span(m, &below, &knot[0]);
    for (size_t i = 1; i < n; i++) add_span(m, &knot[i - 1], &knot[i]);
    add_span(m, &knot[n - 1], &above);
    for (uint32_t i = 0; i < m->n; i++) m->span[i].transparent = false;
}

void map_colour(const struct map_span *p, double s, double rgb[3])
{
    for (int c = 0; c < 3; c++) rgb[c] = p->rgb0[c] + p->rgb1[c] * (s - p->lo);
}

int map_find(const struct map *m, double s)
{
    if (m->n == 0 || !(s >= m->span[0].lo)) return -1;
    if (!(s < m->span[m->n - 1].hi))
        return m->closed && s == m->span[m->n - 1].hi ? (int)m->n - 1 : -1;
    uint32_t lo = 0, hi = m->n;
    while (hi - lo > 1) {
        uint32_t mid = (lo + hi) / 2;
        if (s < m->span[mid].lo) hi = mid;
        else lo = mid;
    }
    return (int)lo;
}
