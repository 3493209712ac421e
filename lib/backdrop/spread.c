/*
 * spread: lines and areas from the globe to a plane. They are clipped on the sheet, the globe cut
 * open where the projection is not continuous: there clipping is by straight lines, and an area
 * around a pole of the sheet goes from one side of it to the other, and back along the pole.
 */
#include "backdrop/outline.h"

#include <stdlib.h>

#define STEP 1.0         /* degrees: longer lines are curves on the plane */
#define TURNS_MAX 3600.0 /* degrees: longitudes further away from 0 are none */

struct spreading {
    const struct plane *plane;
    struct plane_sheet sheet;
    struct outline on_sheet, work, other;
    outline_take *take;
    void *ctx;
};

/* The number of pieces of a line, none longer than STEP. */
static int pieces_of(struct outline_point p, struct outline_point q)
{
    return (int)ceil(fmin(fmax(fabs(q.x - p.x), fabs(q.y - p.y)), 720) / STEP);
}

static bool on_globe(struct outline_point p) { return fabs(p.x) < TURNS_MAX && fabs(p.y) <= 90; }

static void add_to_sheet(struct spreading *s, struct outline_point p)
{
    const struct plane_at at = plane_to_sheet(s->plane, (struct plane_at){p.x, p.y});
    outline_add(&s->on_sheet, (struct outline_point){at.x, at.y});
}

static void to_sheet(struct spreading *s, const struct outline *globe)
{
    const struct outline_point *last = NULL;
    for (const struct outline_point *p = globe->at; p < globe->at + globe->n; p++) {
        if (!on_globe(*p)) continue;
        const int n = last ? pieces_of(*last, *p) : 1;
        for (int i = 1; i < n; i++) add_to_sheet(s, outline_between(*last, *p, (double)i / n));
        add_to_sheet(s, *p);
        last = p;
    }
    outline_bound(&s->on_sheet);
}

static struct outline_point turned(struct outline_point p, int turn)
{
    return (struct outline_point){p.x + 360 * turn, p.y};
}

/* ---- the plane ------------------------------------------------------------------------------ */

static void give(struct spreading *s, struct outline *piece, enum outline_piece kind)
{
    if (piece->n < 2) outline_free(piece);
    else s->take(s->ctx, piece, kind);
    *piece = (struct outline){.flat = true};
}

/* Adds a point of the sheet to a piece. A line ends where PROJ has no place for it. */
static void put(
    struct spreading *s, struct outline *piece, struct outline_point p, enum outline_piece kind)
{
    struct plane_at at;
    if (plane_from_sheet(s->plane, (struct plane_at){p.x, p.y}, &at))
        outline_append(piece, (struct outline_point){at.x, at.y});
    else if (kind == OUTLINE_LINE) give(s, piece, kind);
}

/* Adds a line of the sheet without its first point. */
static void put_line(struct spreading *s, struct outline *piece, struct outline_point p,
    struct outline_point q, enum outline_piece kind)
{
    const int n = pieces_of(p, q);
    for (int i = 1; i < n; i++) put(s, piece, outline_between(p, q, (double)i / n), kind);
    put(s, piece, q, kind);
}

/* The area on the sheet is `work`. */
static void give_area(struct spreading *s, enum outline_piece kind)
{
    struct outline piece = {.flat = true};
    const struct outline *o = &s->work;
    if (o->n < 3) return;
    put(s, &piece, o->at[0], kind);
    for (size_t i = 1; i <= o->n; i++) put_line(s, &piece, o->at[i - 1], o->at[i % o->n], kind);
    if (piece.n) outline_append(&piece, piece.at[0]);
    give(s, &piece, kind);
}

/* ---- the sheet ------------------------------------------------------------------------------ */

/* The sides of the sheet that may cut what is between lo and hi. False if all is outside. */
static bool sides(
    const struct spreading *s, struct outline_point lo, struct outline_point hi, struct halves *h)
{
    const double left = s->sheet.middle - 180, right = s->sheet.middle + 180;
    h->n = 0;
    if (hi.x < left || lo.x > right || hi.y < s->sheet.lo || lo.y > s->sheet.hi) return false;
    if (lo.x < left) h->at[h->n++] = (struct half){1, 0, -left};
    if (hi.x > right) h->at[h->n++] = (struct half){-1, 0, right};
    if (lo.y < s->sheet.lo) h->at[h->n++] = (struct half){0, 1, -s->sheet.lo};
    if (hi.y > s->sheet.hi) h->at[h->n++] = (struct half){0, -1, s->sheet.hi};
    return true;
}

static void spread_line(struct spreading *s, int k)
{
    const struct outline *o = &s->on_sheet;
    struct outline piece = {.flat = true};
    struct halves h;
    if (!sides(s, turned(o->lo, k), turned(o->hi, k), &h)) return;
    for (size_t i = 0; i + 1 < o->n; i++) {
        const struct outline_point p = turned(o->at[i], k), q = turned(o->at[i + 1], k);
        double part[2];
        const bool seen = backdrop_cut_line(&h, p, q, part);
        if (!seen || part[0] > 0) give(s, &piece, OUTLINE_LINE);
        if (!seen) continue;
        const struct outline_point from = outline_between(p, q, part[0]);
        if (!piece.n) put(s, &piece, from, OUTLINE_LINE);
        put_line(s, &piece, from, outline_between(p, q, part[1]), OUTLINE_LINE);
    }
    give(s, &piece, OUTLINE_LINE);
}

/* True if all of the area is here. */
static bool spread_area(struct spreading *s, int k)
{
    const struct outline *o = &s->on_sheet;
    struct halves h;
    if (!sides(s, turned(o->lo, k), turned(o->hi, k), &h)) return false;
    s->work.n = 0;
    for (size_t i = 0; i < o->n; i++) outline_append(&s->work, turned(o->at[i], k));
    backdrop_cut_polygon(&h, &s->work, &s->other);
    give_area(s, h.n ? OUTLINE_AREA : OUTLINE_BOTH);
    return h.n == 0;
}

/* True if the area is at the left of its outline. One that goes round the globe has its nearer
 * pole. */
static bool is_left(const struct outline *globe)
{
    const struct outline_point *at = globe->at;
    const double round = at[globe->n - 1].x - at[0].x;
    double twice = 0, sum = 0;
    for (size_t i = 0; i < globe->n; i++) {
        sum += at[i].y;
        if (i) twice += (at[i].y + at[i - 1].y) * (at[i - 1].x - at[i].x);
    }
    return fabs(round) > 180 ? (round > 0) == (sum > 0) : twice > 0;
}

/* An area around a pole of the sheet. */
static void spread_polar(struct spreading *s, int first, int last, bool left)
{
    const struct outline *o = &s->on_sheet;
    const bool east = o->at[o->n - 1].x > o->at[0].x;
    const double pole = east == left ? 90 : -90;
    struct halves h;
    s->work.n = 0;
    for (int k = first; k <= last; k++)
        for (size_t i = 0; i < o->n; i++)
            outline_append(&s->work, turned(o->at[east ? i : o->n - 1 - i], k));
    if (!s->work.n) return;
    outline_append(&s->work, (struct outline_point){s->work.at[s->work.n - 1].x, pole});
    outline_append(&s->work, (struct outline_point){s->work.at[0].x, pole});
    outline_bound(&s->work);
    if (!sides(s, s->work.lo, s->work.hi, &h)) return;
    backdrop_cut_polygon(&h, &s->work, &s->other);
    give_area(s, OUTLINE_AREA);
}

static void spread(struct spreading *s, const struct outline *globe, bool area)
{
    const struct outline *o = &s->on_sheet;
    const int first = (int)ceil((s->sheet.middle - 180 - o->hi.x) / 360);
    const int last = (int)floor((s->sheet.middle + 180 - o->lo.x) / 360);
    const bool polar = area && fabs(o->at[o->n - 1].x - o->at[0].x) > 180;
    bool whole = false;
    if (polar) spread_polar(s, first, last, is_left(globe));
    else if (area)
        for (int k = first; k <= last && !whole; k++) whole = spread_area(s, k);
    for (int k = first; k <= last && !whole; k++) spread_line(s, k);
}

void outline_spread(const struct plane *plane, const struct outline *globe, bool area,
    outline_take *take, void *ctx)
{
    struct spreading s = {.plane = plane, .sheet = plane_sheet(plane), .take = take, .ctx = ctx};
    to_sheet(&s, globe);
    if (s.on_sheet.n) spread(&s, globe, area);
    outline_free(&s.on_sheet);
    outline_free(&s.work);
    outline_free(&s.other);
}
