/* legend: a colour bar with values. */
#include "backdrop/drawing.h"
#include "image/image.h"

#define SPAN_PIECES 48 /* pieces of one colour per span */

/* Draws a piece of the bar: a colour of this opacity over the page. */
static void patch(const struct drawing *s, double x0, double x1, double y0, double y1,
    const double rgb[3], double alpha)
{
    uint8_t c[3];
    for (int i = 0; i < 3; i++) c[i] = srgb_encode8((float)(rgb[i] * alpha + PAGE * (1 - alpha)));
    buf_printf(s->out,
        "set object rect from %.2f,%.2f to %.2f,%.2f front fs solid noborder fc "
        "rgb '#%02x%02x%02x'\n",
        x0, y0, x1, y1, c[0], c[1], c[2]);
}

struct bar {
    double x, y, w, h, lo, hi; /* place in pixels; values at the ends */
};

static double bar_x(const struct bar *b, double v)
{
    return b->x + b->w * (v - b->lo) / (b->hi - b->lo);
}

/* The opacity is that of a layer as thick as the grid's shortest extent. */
static void bar_spans(const struct bar *b, const struct drawing *s)
{
    double thick = HUGE_VAL;
    for (int a = 0; a < 3; a++)
        thick = fmin(thick, fabs((s->hi[a] - s->lo[a]) * s->b->spec->scale[a]));
    for (size_t i = 0; i + 1 < s->b->spec->n_knots; i++) {
        const struct spec_knot *p = s->b->spec->knot + i, *q = p + 1;
        for (int j = 0; j < SPAN_PIECES && (p->k > 0 || q->k > 0) && q->s > p->s; j++) {
            double f = (j + .5) / SPAN_PIECES, rgb[3];
            for (int c = 0; c < 3; c++) rgb[c] = p->rgb[c] + f * (q->rgb[c] - p->rgb[c]);
            double x0 = bar_x(b, p->s + (q->s - p->s) * j / SPAN_PIECES);
            double x1 = bar_x(b, p->s + (q->s - p->s) * (j + 1) / SPAN_PIECES);
            double alpha = 1 - exp(-thick * (p->k + f * (q->k - p->k)));
            patch(s, x0, fmax(x1, x0 + .3) + .7, b->y, b->y + b->h, rgb, alpha);
        }
    }
}

/* The background of the bar and its labels, because the map may extend below them. */
static void bar_plate(const struct bar *b, const struct drawing *s)
{
    static const double page[3] = {PAGE, PAGE, PAGE};
    double above = s->b->spec->n_knots && s->b->spec->n_isos ? 2.6 : 1.6;
    patch(s, b->x - b->h, b->x + b->w + b->h, b->y - 3 * b->h, b->y + above * b->h, page, 1);
}

static void bar_isos(const struct bar *b, const struct drawing *s)
{
    char text[64];
    double y = b->y + (s->b->spec->n_knots ? 1.7 : -.8) * b->h; /* the map has labels below */
    for (size_t i = 0; i < s->b->spec->n_isos; i++) {
        const struct spec_iso *iso = s->b->spec->iso + i;
        double x = bar_x(b, iso->s), at[2] = {x, y};
        patch(s, x - .012 * b->w, x + .012 * b->w, b->y, b->y + b->h, iso->rgb, iso->opacity);
        snprintf(text, sizeof text, "%.6g", iso->s);
        backdrop_label(s, text, at, "center");
    }
}

void backdrop_legend(const struct drawing *s)
{
    const struct spec *p = s->b->spec;
    struct bar b = {.3 * s->w, .09 * s->h, .4 * s->w, .022 * s->h, HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < p->n_knots; i++)
        b.lo = fmin(b.lo, p->knot[i].s), b.hi = fmax(b.hi, p->knot[i].s);
    for (size_t i = 0; i < p->n_isos; i++)
        b.lo = fmin(b.lo, p->iso[i].s), b.hi = fmax(b.hi, p->iso[i].s);
    double pad = b.hi > b.lo ? .04 * (b.hi - b.lo) : fmax(.01, .1 * fabs(b.lo));
    b.lo -= pad;
    b.hi += pad;
    bar_plate(&b, s);
    bar_spans(&b, s);
    bar_isos(&b, s);
    buf_printf(s->out,
        "set object rect from %.2f,%.2f to %.2f,%.2f front fs empty border rgb '" FRAME "'\n", b.x,
        b.y, b.x + b.w, b.y + b.h);
    struct ticks t = backdrop_ticks(b.lo, b.hi, backdrop_step(b.hi - b.lo, 8));
    char text[64];
    for (int i = t.first; p->n_knots && i <= t.last; i++) {
        snprintf(text, sizeof text, "%.6g", i * t.step + 0.0);
        backdrop_label(s, text, (double[2]){bar_x(&b, i * t.step), b.y - .8 * b.h}, "center");
    }
    backdrop_label(s, s->b->title, (double[2]){.5 * s->w, b.y - 2.1 * b.h}, "center");
}
