/*
 * piece: cuts a segment of a cell where the field along the ray crosses a knot of the map. Within a
 * piece extinction and colour are polynomials, which suits Gauss-Legendre quadrature. A piece
 * belongs to the span at its middle, so rounding at its ends does not matter.
 */
#include "volume/volume_int.h"

typedef void piece_fn(struct path *, const struct piece *);

static void piece(struct path *p, double a, double b, int span, piece_fn *each)
{
    const struct cell *c = p->cell;
    const struct map_span *s = span < 0 ? NULL : &p->v->map.span[span];
    if (!s || s->transparent || !(a < b)) return;
    struct piece out = {.span = s, .a = a, .b = b};
    cubic_part(c->p, a, b, out.q);
    out.q[0] -= s->lo - c->base;
    each(p, &out);
}

static void by_middle(struct path *p, double a, double b, piece_fn *each)
{
    double middle = p->cell->base + cubic_at(p->cell->p, a + (b - a) / 2);
    piece(p, a, b, map_find(&p->v->map, middle), each);
}

/* Edge i of the map: the lower end of span i, or the upper end of the last span. */
static double edge(const struct map *m, int i)
{
    return i < (int)m->n ? m->span[i].lo : m->span[m->n - 1].hi;
}

/* Cuts a .. b, where the field is monotone. */
static void monotone(struct path *p, double a, double b, piece_fn *each)
{
    const struct map *m = &p->v->map;
    const struct cell *c = p->cell;
    double from = cubic_at(c->p, a), to = cubic_at(c->p, b);
    bool up = from < to;
    int i = up ? 0 : (int)m->n, step = up ? 1 : -1;
    for (; i >= 0 && i <= (int)m->n && a < b; i += step) {
        double y = edge(m, i) - c->base;
        if (up ? y <= from : y >= from) continue;
        if (up ? y >= to : y <= to) break;
        double w = cubic_root(c->p, a, b, y);
        by_middle(p, a, w, each);
        a = w;
    }
    by_middle(p, a, b, each);
}

void volume_pieces(struct path *p, double a, double b, piece_fn *each)
{
    const struct map *m = &p->v->map;
    double part[4], lo, hi;
    cubic_part(p->cell->p, a, b, part);
    cubic_bounds(part, &lo, &hi);
    /* The common case: the whole segment lies in one span. */
    int first = map_find(m, p->cell->base + lo), last = map_find(m, p->cell->base + hi);
    if (first == last && (first >= 0 || m->n == 0 || p->cell->base + lo > m->span[m->n - 1].hi ||
                             p->cell->base + hi < m->span[0].lo)) {
        piece(p, a, b, first, each);
        return;
    }
    volume_pieces_cut(p, a, b, each);
}

void volume_pieces_cut(struct path *p, double a, double b, piece_fn *each)
{
    double part[4], w[4];
    cubic_part(p->cell->p, a, b, part);
    int n = cubic_monotone(part, w);
    for (int i = 0; i + 1 < n; i++)
        monotone(p, a + w[i] * (b - a), i + 2 < n ? a + w[i + 1] * (b - a) : b, each);
}
