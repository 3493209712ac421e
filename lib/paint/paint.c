/* paint: the list of backdrop, painted. */
#include "paint/pen.h"

#include <math.h>
#include <stdlib.h>

#define BEYOND 2.0    /* pixels: so far outside lines are cut */
#define BASELINE .375 /* em: of a label, below its point, as gnuplot has it */
#define BOX_WIDTH 1.0 /* pixels */

struct paint {
    struct backdrop_lines *lines;
    struct backdrop_list list;
    PangoLayout *layout;
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
    free(p);
}

static void set_colour(cairo_t *cr, uint32_t rgb)
{
    cairo_set_source_rgb(
        cr, (rgb >> 16 & 255) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0);
}

/* ---- areas and lines, which backdrop has cut, except lines in space -------------------------- */

struct canvas {
    cairo_t *cr;
    double w, h; /* pixels of the picture: y = 0 of the list is at h */
};

static void fill(const struct canvas *c, const struct backdrop_at *at, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (isnan(at[i].x)) cairo_new_sub_path(c->cr);
        else cairo_line_to(c->cr, at[i].x, c->h - at[i].y);
    cairo_fill(c->cr);
}

/* How far inside of one of the sides a point is, -BEYOND at the least. */
static double inside(const struct canvas *c, int side, struct backdrop_at p)
{
    double v = side < 2 ? p.x : p.y, size = side < 2 ? c->w : c->h;
    return (side % 2 ? size - v : v) + BEYOND;
}

static struct backdrop_at between(struct backdrop_at p, struct backdrop_at q, double f)
{
    return (struct backdrop_at){p.x + f * (q.x - p.x), p.y + f * (q.y - p.y)};
}

/* Moves the ends of a line to where it enters and leaves the picture: Cairo's coordinates overflow
 * beyond 2^23 pixels, and points near the plane of the eye lie there. False if it does not. */
static bool cut(const struct canvas *c, struct backdrop_at *p, struct backdrop_at *q)
{
    for (int side = 0; side < 4; side++) {
        const double a = inside(c, side, *p), b = inside(c, side, *q);
        if (!(a >= 0 || b >= 0)) return false; /* a NaN, too */
        const struct backdrop_at at = between(*p, *q, a / (a - b));
        if (a < 0) *p = at;
        if (b < 0) *q = at;
    }
    return true;
}

static void stroke(const struct canvas *c, const struct backdrop_at *at, size_t n, double width)
{
    bool open = false;
    for (size_t i = 1; i < n; i++) {
        struct backdrop_at p = at[i - 1], q = at[i];
        if (isnan(p.x) || isnan(q.x) || !cut(c, &p, &q)) {
            open = false;
            continue;
        }
        if (!open || p.x != at[i - 1].x || p.y != at[i - 1].y)
            cairo_move_to(c->cr, p.x, c->h - p.y);
        cairo_line_to(c->cr, q.x, c->h - q.y);
        open = q.x == at[i].x && q.y == at[i].y;
    }
    cairo_set_line_width(c->cr, width);
    cairo_stroke(c->cr);
}

/* ---- the legend and labels ------------------------------------------------------------------- */

static void rectangle(
    const struct canvas *c, const struct backdrop_mark *m, const struct backdrop_at at[2])
{
    cairo_rectangle(c->cr, at[0].x, c->h - at[1].y, at[1].x - at[0].x, at[1].y - at[0].y);
    cairo_set_line_width(c->cr, BOX_WIDTH);
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
    cairo_move_to(
        c->cr, at.x - wide * (m->align + 1) / 2, c->h - at.y + BASELINE * p->list.em - base);
    pango_cairo_show_layout(c->cr, p->layout);
}

static void mark(const struct canvas *c, struct paint *p, const struct backdrop_mark *m)
{
    const struct backdrop_at *at = p->list.at + m->first;
    set_colour(c->cr, m->rgb);
    switch (m->kind) {
    case BACKDROP_PLANE:
    case BACKDROP_AREA: fill(c, at, m->n); break;
    case BACKDROP_GRATICULE:
    case BACKDROP_LINES:
    case BACKDROP_EDGES: stroke(c, at, m->n, m->width); break;
    case BACKDROP_PATCH:
    case BACKDROP_BOX: rectangle(c, m, at); break;
    case BACKDROP_LABEL: label(c, p, m); break;
    }
}

/* The marks from one kind to another one. */
static void marks(
    const struct canvas *c, struct paint *p, enum backdrop_kind from, enum backdrop_kind to)
{
    for (size_t i = 0; i < p->list.n_marks; i++)
        if (p->list.mark[i].kind >= from && p->list.mark[i].kind <= to)
            mark(c, p, &p->list.mark[i]);
}

bool paint_backdrop(struct paint *p, const struct backdrop *b, unsigned parts, uint32_t *argb)
{
    struct canvas c = {paint_pen(argb, b->w, b->h + backdrop_strip(b)), b->w, b->h};
    if (!c.cr) return false;
    backdrop_draw(b, p->lines, parts | BACKDROP_CLIPPED, &p->list);
    set_colour(c.cr, BACKDROP_PAPER);
    cairo_paint(c.cr);
    cairo_save(c.cr);
    cairo_rectangle(c.cr, 0, 0, c.w, c.h);
    cairo_clip(c.cr);
    marks(&c, p, BACKDROP_PLANE, BACKDROP_EDGES);
    cairo_restore(c.cr);
    marks(&c, p, BACKDROP_PATCH, BACKDROP_BOX);
    marks(&c, p, BACKDROP_LABEL, BACKDROP_LABEL);
    return paint_pen_free(c.cr);
}
