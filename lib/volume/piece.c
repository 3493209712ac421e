/*
 * piece: cuts a segment of a cell where the field along the ray crosses a knot of the map. Within a
 * piece extinction and colour are polynomials, which suits Gauss-Legendre quadrature. A piece
 * belongs to the span at its middle, so rounding at its ends does not matter. With a second field,
 * each piece is cut again, where that crosses a knot of its colours.
 */
#include "volume/volume_int.h"

/* What a segment is cut by, and where its parts go. */
struct cutter {
    const struct map *map;
    const struct cell *cell;
    void (*put)(struct path *p, const struct cutter *k, double a, double b, int span);
    const struct map_span *span; /* of the map, while the second field cuts */
    piece_fn *each;
};

static void by_middle(struct path *p, const struct cutter *k, double a, double b)
{
    double middle = k->cell->base + cubic_at(k->cell->p, a + (b - a) / 2);
    k->put(p, k, a, b, map_find(k->map, middle));
}

/* Edge i of the map: the lower end of span i, or the upper end of the last span. */
static double edge(const struct map *m, int i)
{
    return i < (int)m->n ? m->span[i].lo : m->span[m->n - 1].hi;
}

/* Cuts a .. b, where the field is monotone. */
static void monotone(struct path *p, const struct cutter *k, double a, double b)
{
    const struct map *m = k->map;
    const struct cell *c = k->cell;
    double from = cubic_at(c->p, a), to = cubic_at(c->p, b);
    bool up = from < to;
    int i = up ? 0 : (int)m->n, step = up ? 1 : -1;
    for (; i >= 0 && i <= (int)m->n && a < b; i += step) {
        double y = edge(m, i) - c->base;
        if (up ? y <= from : y >= from) continue;
        if (up ? y >= to : y <= to) break;
        double w = cubic_root(c->p, a, b, y);
        by_middle(p, k, a, w);
        a = w;
    }
    by_middle(p, k, a, b);
}

static void cut_segment(struct path *p, const struct cutter *k, double a, double b)
{
    double part[4], w[4];
    cubic_part(k->cell->p, a, b, part);
    int n = cubic_monotone(part, w);
    for (int i = 0; i + 1 < n; i++)
        monotone(p, k, a + w[i] * (b - a), i + 2 < n ? a + w[i + 1] * (b - a) : b);
}

/* ---- pieces --------------------------------------------------------------------------------- */

static struct piece piece_of(const struct path *p, const struct map_span *span, double a, double b)
{
    struct piece out = {.span = span, .a = a, .b = b};
    cubic_part(p->cell->p, a, b, out.q);
    out.q[0] -= span->lo - p->cell->base;
    return out;
}

static void put_tinted(struct path *p, const struct cutter *k, double a, double b, int span)
{
    if (!(a < b)) return;
    struct piece out = piece_of(p, k->span, a, b);
    out.tint = &k->map->span[span];
    cubic_part(k->cell->p, a, b, out.of_tint);
    out.of_tint[0] -= out.tint->lo - k->cell->base;
    k->each(p, &out);
}

static void put_piece(struct path *p, const struct cutter *k, double a, double b, int span)
{
    const struct map_span *s = span < 0 ? NULL : &k->map->span[span];
    if (!s || s->transparent || !(a < b)) return;
    if (p->second) {
        const struct cutter by_tint = {&p->v->tint, p->second, put_tinted, s, k->each};
        cut_segment(p, &by_tint, a, b);
        return;
    }
    struct piece out = piece_of(p, s, a, b);
    k->each(p, &out);
}

void volume_pieces(struct path *p, double a, double b, piece_fn *each)
{
    const struct map *m = &p->v->map;
    const struct cutter k = {m, p->cell, put_piece, NULL, each};
    double part[4], lo, hi;
    cubic_part(p->cell->p, a, b, part);
    cubic_bounds(part, &lo, &hi);
    /* The common case: the whole segment lies in one span. */
    int first = map_find(m, p->cell->base + lo), last = map_find(m, p->cell->base + hi);
    if (first == last && (first >= 0 || m->n == 0 || p->cell->base + lo > m->span[m->n - 1].hi ||
                             p->cell->base + hi < m->span[0].lo)) {
        put_piece(p, &k, a, b, first);
        return;
    }
    cut_segment(p, &k, a, b);
}

void volume_pieces_cut(struct path *p, double a, double b, piece_fn *each)
{
    const struct cutter k = {&p->v->map, p->cell, put_piece, NULL, each};
    cut_segment(p, &k, a, b);
}
