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
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    turn[0] = turn[1] = 0;
    if (o->flat || o->n == 0 || fmax(fabs(s->lo[0]), fabs(s->hi[0])) > 360 * TURNS_MAX) return;
    for (size_t i = 0; i < o->n; i++) {
        lo = fmin(lo, o->at[i].x);
        hi = fmax(hi, o->at[i].x);
    }
    turn[0] = (int)ceil((s->lo[0] - hi) / 360);
    turn[1] = (int)floor((s->hi[0] - lo) / 360);
}

static struct outline_point turned(struct outline_point p, int turn)
{
    return (struct outline_point){p.x + 360 * turn, p.y};
}

/* ---- lines ---------------------------------------------------------------------------------- */

/* The piece being written. */
struct piece {
    const struct drawing *s;
    struct buf *out;
    double last[2]; /* in pixels */
    bool open;
};

static void put_point(struct piece *p, struct outline_point at, bool always)
{
    double xy[2];
    if (!backdrop_project(p->s, at.x, at.y, p->s->lo[2], xy)) return;
    if (!always && hypot(xy[0] - p->last[0], xy[1] - p->last[1]) < STEP) return;
    buf_printf(p->out, "%.2f %.2f\n", xy[0], xy[1]);
    p->last[0] = xy[0];
    p->last[1] = xy[1];
    p->open = true;
}

static void put_end(struct piece *p)
{
    if (p->open) buf_printf(p->out, "\n");
    p->open = false;
}

void outline_stroke(const struct drawing *s, const struct outline *o, struct buf *out)
{
    struct half h[HALVES];
    struct piece piece = {.s = s, .out = out};
    int turn[2];
    outline_halves(s, h);
    find_turns(s, o, turn);
    for (int k = turn[0]; k <= turn[1]; k++, put_end(&piece))
        for (size_t i = 0; i + 1 < o->n; i++) {
            struct outline_point p = turned(o->at[i], k), q = turned(o->at[i + 1], k);
            double part[2];
            bool seen = backdrop_cut_line(h, p, q, part);
            if (!seen || part[0] > 0) put_end(&piece);
            if (!seen) continue;
            if (!piece.open) put_point(&piece, outline_between(p, q, part[0]), true);
            put_point(&piece, outline_between(p, q, part[1]), part[1] < 1 || i + 2 == o->n);
        }
}

/* ---- areas ---------------------------------------------------------------------------------- */

static bool is_large(const struct drawing *s, const struct outline *o)
{
    double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL}, xy[2];
    for (size_t i = 0; i < o->n; i++)
        for (int a = 0; a < 2 && backdrop_project(s, o->at[i].x, o->at[i].y, s->lo[2], xy); a++) {
            lo[a] = fmin(lo[a], xy[a]);
            hi[a] = fmax(hi[a], xy[a]);
        }
    return hi[0] - lo[0] >= SEEN || hi[1] - lo[1] >= SEEN;
}

static bool fill_polygon(const struct drawing *s, struct outline *o, struct buf *out)
{
    struct half h[HALVES];
    struct piece piece = {.s = s, .out = out};
    outline_halves(s, h);
    backdrop_cut_polygon(h, o);
    if (!is_large(s, o)) return false;
    for (size_t i = 0; i < o->n; i++) put_point(&piece, o->at[i], !piece.open);
    put_end(&piece);
    return true;
}

/* Fills from one edge of the map to the other, and back along the pole. */
static bool fill_to_pole(
    const struct drawing *s, const struct outline *o, const int turn[2], struct buf *out)
{
    struct outline all = {0};
    double sum = 0;
    bool westwards = o->at[o->n - 1].x < o->at[0].x;
    for (int k = turn[0]; k <= turn[1]; k++)
        for (size_t i = 0; i < o->n; i++)
            outline_append(&all, turned(o->at[westwards ? o->n - 1 - i : i], k));
    for (size_t i = 0; i < o->n; i++) sum += o->at[i].y;
    if (!all.n) return false;
    double pole = sum < 0 ? -90 : 90;
    outline_append(&all, (struct outline_point){all.at[all.n - 1].x, pole});
    outline_append(&all, (struct outline_point){all.at[0].x, pole});
    bool seen = fill_polygon(s, &all, out);
    outline_free(&all);
    return seen;
}

bool outline_fill(const struct drawing *s, const struct outline *o, struct buf *out)
{
    int turn[2];
    bool seen = false;
    if (o->n < 3) return false;
    find_turns(s, o, turn);
    if (!o->flat && fabs(o->at[o->n - 1].x - o->at[0].x) > 180)
        return fill_to_pole(s, o, turn, out);
    for (int k = turn[0]; k <= turn[1]; k++) {
        struct outline one = {.flat = o->flat};
        for (size_t i = 0; i < o->n; i++) outline_append(&one, turned(o->at[i], k));
        seen |= fill_polygon(s, &one, out);
        outline_free(&one);
    }
    return seen;
}
