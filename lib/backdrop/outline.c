/* outline: shifts outlines by whole turns and projects them to pixels. */
#include "backdrop/outline.h"

#include <stdlib.h>

#define SEEN 2.0 /* pixels: areas smaller in both directions are left out */
#define STEP 0.4 /* pixels: points nearer to the previous one are left out */
#define TURNS_MAX 3

/* The range of multiples of 360 by which the outline may be visible. 0 if the map's coordinates are
 * far outside degrees. An outline without points has no extent to divide. */
static void find_turns(const struct drawing *s, const struct outline *o, int turn[2])
{
    turn[0] = turn[1] = 0;
    if (o->flat || o->n == 0 || fmax(fabs(s->lo[0]), fabs(s->hi[0])) > 360 * TURNS_MAX) return;
    turn[0] = (int)ceil((s->lo[0] - o->hi.x) / 360);
    turn[1] = (int)floor((s->hi[0] - o->lo.x) / 360);
}

static struct outline_point turned(struct outline_point p, int turn)
{
    return (struct outline_point){p.x + 360 * turn, p.y};
}

/* ---- lines ---------------------------------------------------------------------------------- */

/* The piece being added. */
struct piece {
    const struct drawing *s;
    struct backdrop_at last;
    bool open;
};

static void put_point(struct piece *p, struct outline_point at, bool always)
{
    const struct backdrop_at xy = drawing_on_map(p->s, at.x, at.y);
    if (!isfinite(xy.x) || !isfinite(xy.y)) return;
    const double dx = xy.x - p->last.x, dy = xy.y - p->last.y;
    if (!always && dx * dx + dy * dy < STEP * STEP) return;
    mark_point(p->s->list, xy.x, xy.y);
    p->last = xy;
    p->open = true;
}

static void put_end(struct piece *p)
{
    if (p->open) mark_break(p->s->list);
    p->open = false;
}

static void stroke_turn(const struct drawing *s, const struct outline *o, int k)
{
    struct halves h;
    struct piece piece = {.s = s};
    if (!outline_halves(s, turned(o->lo, k), turned(o->hi, k), &h)) return;
    for (size_t i = 0; i + 1 < o->n; i++) {
        struct outline_point p = turned(o->at[i], k), q = turned(o->at[i + 1], k);
        double part[2];
        bool seen = backdrop_cut_line(&h, p, q, part);
        if (!seen || part[0] > 0) put_end(&piece);
        if (!seen) continue;
        if (!piece.open) put_point(&piece, outline_between(p, q, part[0]), true);
        if (part[1] < 1) q = outline_between(p, q, part[1]);
        put_point(&piece, q, part[1] < 1 || i + 2 == o->n);
    }
    put_end(&piece);
}

void outline_stroke(const struct drawing *s, const struct outline *o)
{
    int turn[2];
    find_turns(s, o, turn);
    for (int k = turn[0]; k <= turn[1]; k++) stroke_turn(s, o, k);
}

void outline_dot(const struct drawing *s, const struct outline *o)
{
    int turn[2];
    struct halves h;
    find_turns(s, o, turn);
    for (int k = turn[0]; k <= turn[1]; k++)
        for (size_t i = 0; i < o->n; i++) {
            const struct outline_point p = turned(o->at[i], k);
            struct piece piece = {.s = s};
            if (outline_halves(s, p, p, &h)) put_point(&piece, p, true);
        }
}

/* ---- areas ---------------------------------------------------------------------------------- */

static bool is_large(const struct drawing *s, const struct outline_point *at, size_t n, int k)
{
    struct backdrop_at lo = {HUGE_VAL, HUGE_VAL}, hi = {-HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < n; i++) {
        const struct outline_point p = turned(at[i], k);
        const struct backdrop_at xy = drawing_on_map(s, p.x, p.y);
        lo = (struct backdrop_at){fmin(lo.x, xy.x), fmin(lo.y, xy.y)};
        hi = (struct backdrop_at){fmax(hi.x, xy.x), fmax(hi.y, xy.y)};
        if (hi.x - lo.x >= SEEN || hi.y - lo.y >= SEEN) return true;
    }
    return false;
}

/* False if what lies between the corners is outside, or too small; most of a globe's areas are. */
static bool may_be_large(
    const struct drawing *s, struct outline_point lo, struct outline_point hi, struct halves *h)
{
    if (!outline_halves(s, lo, hi, h)) return false;
    struct outline_point corners[] = {lo, {lo.x, hi.y}, hi, {hi.x, lo.y}};
    return h->n > 0 || is_large(s, corners, 4, 0);
}

/* How areas are filled. */
struct look {
    enum backdrop_kind kind;
    uint32_t rgb;
};

/* Fills a polygon that is inside of all half-planes. */
static bool fill_whole(const struct drawing *s, const struct outline *o, int k, struct look look)
{
    struct piece piece = {.s = s};
    if (!is_large(s, o->at, o->n, k)) return false;
    mark_begin(s->list, look.kind, look.rgb, 0);
    for (size_t i = 0; i < o->n; i++) put_point(&piece, turned(o->at[i], k), !piece.open);
    put_end(&piece);
    return true;
}

/* Fills the first scratch outline, which changes. */
static bool fill_cut(const struct drawing *s, const struct halves *h, struct look look)
{
    backdrop_cut_polygon(h, &s->scratch[0], &s->scratch[1]);
    return fill_whole(s, &s->scratch[0], 0, look);
}

/* Fills from one edge of the map to the other, and back along the pole. */
static bool fill_to_pole(
    const struct drawing *s, const struct outline *o, const int turn[2], struct look look)
{
    struct outline *all = &s->scratch[0];
    struct halves h;
    double sum = 0;
    bool westwards = o->at[o->n - 1].x < o->at[0].x;
    all->n = 0;
    for (int k = turn[0]; k <= turn[1]; k++)
        for (size_t i = 0; i < o->n; i++)
            outline_append(all, turned(o->at[westwards ? o->n - 1 - i : i], k));
    for (size_t i = 0; i < o->n; i++) sum += o->at[i].y;
    if (!all->n) return false;
    double pole = sum < 0 ? -90 : 90;
    outline_append(all, (struct outline_point){all->at[all->n - 1].x, pole});
    outline_append(all, (struct outline_point){all->at[0].x, pole});
    outline_bound(all);
    return outline_halves(s, all->lo, all->hi, &h) && fill_cut(s, &h, look);
}

static bool fill_turn(const struct drawing *s, const struct outline *o, int k, struct look look)
{
    struct halves h;
    if (!may_be_large(s, turned(o->lo, k), turned(o->hi, k), &h)) return false;
    if (h.n == 0) return fill_whole(s, o, k, look);
    s->scratch[0].n = 0;
    for (size_t i = 0; i < o->n; i++) outline_append(&s->scratch[0], turned(o->at[i], k));
    return fill_cut(s, &h, look);
}

bool outline_fill(
    const struct drawing *s, const struct outline *o, enum backdrop_kind kind, uint32_t rgb)
{
    const struct look look = {kind, rgb};
    int turn[2];
    bool seen = false;
    if (o->n < 3) return false;
    find_turns(s, o, turn);
    if (!o->flat && fabs(o->at[o->n - 1].x - o->at[0].x) > 180)
        return fill_to_pole(s, o, turn, look);
    for (int k = turn[0]; k <= turn[1]; k++) seen |= fill_turn(s, o, k, look);
    return seen;
}
