/* paint: the list of backdrop, painted. */
#include "paint/line.h"
#include "paint/pen.h"

#include <math.h>
#include <stdlib.h>

#define BEYOND 2.0    /* pixels: so far outside lines are cut */
#define BASELINE .375 /* em: of a label, below its point, as gnuplot has it */

struct paint {
    struct backdrop_lines *lines;
    struct backdrop_list list;
    PangoLayout *layout;
    struct cover cover;
};

struct paint *paint_open(const struct backdrop *b, char err[BACKDROP_ERR])
{
    struct backdrop_lines *lines = backdrop_lines_read(b, err);
    if (!lines) return NULL;
    struct paint *p = xcalloc(1, sizeof *p);
    p->lines = lines;
    p->layout = paint_layout();
    pango_layout_set_single_paragraph_mode(p->layout, TRUE);
    return p;
}

void paint_free(struct paint *p)
{
    if (!p) return;
    backdrop_lines_free(p->lines);
    backdrop_list_free(&p->list);
    g_object_unref(p->layout);
    free(p->cover.at);
    free(p);
}

static void set_colour(cairo_t *cr, uint32_t rgb, double opacity)
{
    cairo_set_source_rgba(
        cr, (rgb >> 16 & 255) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0, opacity);
}

struct canvas {
    cairo_t *cr;
    uint32_t *argb;
    double w, h; /* pixels of the picture: y = 0 of the list is at h */
};

/* ---- areas, which backdrop has cut, and lines, of which it cut those on the map -------------- */

static void fill(const struct canvas *c, const struct backdrop_at *at, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (isnan(at[i].x)) cairo_new_sub_path(c->cr);
        else cairo_line_to(c->cr, at[i].x, c->h - at[i].y);
    cairo_fill(c->cr);
}

/* How far inside of one of the sides a point is; lines end BEYOND outside. */
static double inside(const struct canvas *c, int side, struct backdrop_at p)
{
    double v = side < 2 ? p.x : p.y, size = side < 2 ? c->w : c->h;
    return (side % 2 ? size - v : v) + BEYOND;
}

static struct backdrop_at between(struct backdrop_at p, struct backdrop_at q, double f)
{
    return (struct backdrop_at){p.x + f * (q.x - p.x), p.y + f * (q.y - p.y)};
}

/* Moves the ends of a line to where it enters and leaves the picture: points near the plane of the
 * eye may be millions of pixels away. False if it does not enter, or has no end. */
static bool cut(const struct canvas *c, struct backdrop_at *p, struct backdrop_at *q)
{
    for (int side = 0; side < 4; side++) {
        const double a = inside(c, side, *p), b = inside(c, side, *q);
        if (a < 0 && b < 0) return false;
        if (a < 0) *p = between(*p, *q, a / (a - b));
        if (b < 0) *q = between(*p, *q, inside(c, side, *p) / (inside(c, side, *p) - b));
    }
    return isfinite(p->x + p->y + q->x + q->y);
}

static void stroke(const struct canvas *c, struct paint *paint, const struct backdrop_mark *m)
{
    const struct backdrop_at *at = paint->list.at + m->first;
    for (size_t i = 1; i < m->n; i++) {
        struct backdrop_at p = at[i - 1], q = at[i];
        if (!cut(c, &p, &q)) continue;
        p.y = c->h - p.y;
        q.y = c->h - q.y;
        paint_line(&paint->cover, p, q, m->width);
    }
    paint_covered(&paint->cover, m->rgb, c->argb);
}

/* ---- the legend and labels ------------------------------------------------------------------- */

/* A border is on whole pixels, as gnuplot has it. */
static void rectangle(
    const struct canvas *c, const struct backdrop_mark *m, const struct backdrop_at at[2])
{
    double x0 = at[0].x, x1 = at[1].x, y0 = c->h - at[1].y, y1 = c->h - at[0].y;
    if (m->kind == BACKDROP_BOX) {
        x0 = floor(x0) + .5, x1 = floor(x1) + .5, y0 = floor(y0) + .5, y1 = floor(y1) + .5;
        cairo_set_line_width(c->cr, m->width);
    }
    cairo_rectangle(c->cr, x0, y0, x1 - x0, y1 - y0);
    if (m->kind == BACKDROP_BOX) cairo_stroke(c->cr);
    else cairo_fill(c->cr);
}

static void label(const struct canvas *c, struct paint *p, const struct backdrop_mark *m)
{
    const struct backdrop_at at = p->list.at[m->first];
    if (!isfinite(at.x) || !isfinite(at.y)) return;
    paint_layout_set(p->layout, (const char *)buf_data(&p->list.text) + m->text, p->list.em);
    PangoRectangle r;
    pango_layout_get_extents(p->layout, NULL, &r);
    const double wide = (double)r.width / PANGO_SCALE;
    const double base = (double)pango_layout_get_baseline(p->layout) / PANGO_SCALE;
    const double left = -wide * (m->align + 1) / 2, top = BASELINE * p->list.em - base;
    cairo_save(c->cr);
    cairo_translate(c->cr, at.x, c->h - at.y);
    cairo_rotate(c->cr, -m->turn * G_PI / 180);
    if (m->boxed) {
        const double beside = .2 * p->list.em, high = (double)r.height / PANGO_SCALE;
        set_colour(c->cr, BACKDROP_PAPER, BACKDROP_BOXED);
        cairo_rectangle(c->cr, left - beside, top, wide + 2 * beside, high);
        cairo_fill(c->cr);
        set_colour(c->cr, m->rgb, 1);
    }
    cairo_move_to(c->cr, left, top);
    pango_cairo_show_layout(c->cr, p->layout);
    cairo_restore(c->cr);
}

static void discs(
    const struct canvas *c, const struct backdrop_mark *m, const struct backdrop_at *at)
{
    for (size_t i = 0; i < m->n; i++) {
        cairo_arc(c->cr, at[i].x, c->h - at[i].y, m->width / 2, 0, 2 * G_PI);
        cairo_fill(c->cr);
    }
}

static void mark(const struct canvas *c, struct paint *p, const struct backdrop_mark *m)
{
    const struct backdrop_at *at = p->list.at + m->first;
    set_colour(c->cr, m->rgb, 1);
    switch (m->kind) {
    case BACKDROP_PLANE:
    case BACKDROP_AREA: fill(c, at, m->n); break;
    case BACKDROP_GRATICULE:
    case BACKDROP_LINES:
    case BACKDROP_NUMBERED:
    case BACKDROP_EDGES: stroke(c, p, m); break;
    case BACKDROP_DOTS: discs(c, m, at); break;
    case BACKDROP_PATCH:
    case BACKDROP_BOX: rectangle(c, m, at); break;
    case BACKDROP_LABEL: label(c, p, m); break;
    }
}

/* Paints the marks from one kind to another one. */
static void marks(
    const struct canvas *c, struct paint *p, enum backdrop_kind from, enum backdrop_kind to)
{
    for (const struct backdrop_mark *m = p->list.mark; m < p->list.mark + p->list.n_marks; m++)
        if (m->kind >= from && m->kind <= to) mark(c, p, m);
}

static void fit_cover(struct cover *c, uint32_t w, uint32_t h)
{
    if (c->at && c->w == w && c->h == h) return;
    free(c->at);
    *c = (struct cover){xcalloc(w, h), w, h, h, 0};
}

/* Over the paper, or over nothing. */
static bool paint(
    struct paint *p, const struct backdrop *b, unsigned parts, bool paper, uint32_t *argb)
{
    struct canvas c = {paint_pen(argb, b->w, b->h + backdrop_strip(b)), argb, b->w, b->h};
    if (!c.cr) return false;
    fit_cover(&p->cover, b->w, b->h);
    backdrop_draw(b, p->lines, parts | BACKDROP_CLIPPED, &p->list);
    set_colour(c.cr, BACKDROP_PAPER, 1);
    cairo_set_operator(c.cr, paper ? CAIRO_OPERATOR_SOURCE : CAIRO_OPERATOR_CLEAR);
    cairo_paint(c.cr);
    cairo_set_operator(c.cr, CAIRO_OPERATOR_OVER);
    cairo_set_antialias(c.cr, CAIRO_ANTIALIAS_FAST);
    cairo_save(c.cr);
    cairo_rectangle(c.cr, 0, 0, c.w, c.h);
    cairo_clip(c.cr);
    marks(&c, p, BACKDROP_PLANE, BACKDROP_AREA);
    cairo_restore(c.cr);
    cairo_surface_flush(cairo_get_target(c.cr));
    marks(&c, p, BACKDROP_GRATICULE, BACKDROP_EDGES);
    cairo_surface_mark_dirty(cairo_get_target(c.cr));
    marks(&c, p, BACKDROP_DOTS, BACKDROP_BOX);
    marks(&c, p, BACKDROP_LABEL, BACKDROP_LABEL);
    return paint_pen_free(c.cr);
}

bool paint_backdrop(struct paint *p, const struct backdrop *b, unsigned parts, uint32_t *argb)
{
    return paint(p, b, parts, true, argb);
}

bool paint_has_raised(const struct paint *p) { return backdrop_lines_raised(p->lines); }

bool paint_raised(struct paint *p, const struct backdrop *b, uint32_t *argb)
{
    return paint(p, b, BACKDROP_RAISED, false, argb);
}
