/* legend: the strip below the picture: a colour bar with values; title and time. */
#include "backdrop/drawing.h"
#include "image/image.h"

#include <stdlib.h>
#include <string.h>

#define SPAN_PIECES 48 /* pieces of one colour per span */

/* Draws a piece of the bar: a colour of this opacity over the page. */
static void patch(const struct drawing *s, double x0, double x1, double y0, double y1,
    const double rgb[3], double alpha)
{
    uint8_t c[3];
    for (int i = 0; i < 3; i++) c[i] = srgb_encode8((float)(rgb[i] * alpha + PAGE * (1 - alpha)));
    mark_rectangle(s->list, BACKDROP_PATCH, (uint32_t)c[0] << 16 | (uint32_t)c[1] << 8 | c[2],
        (double[2]){x0, y0}, (double[2]){x1, y1});
}

struct bar {
    double x, y, w, h, lo, hi; /* place in pixels; values at the ends */
    const struct spec_knot *knot;
    size_t n;       /* of knot */
    double least;   /* opacity at least: of a slice, the second field, a flat ground */
    bool of_ground; /* not of the field */
    double *even;   /* n_even values at even distances; NULL: the bar is linear */
    size_t n_even;
};

static double bar_x(const struct bar *b, double v)
{
    double part = (v - b->lo) / (b->hi - b->lo);
    if (b->even) {
        size_t i = 1;
        while (i + 1 < b->n_even && v > b->even[i]) i++;
        const double from = b->even[i - 1], to = b->even[i];
        part = ((double)i - .5 + (v - from) / (to - from)) / (double)b->n_even;
    }
    return b->x + b->w * part;
}

#define EVEN_LEAST 4 /* intervals from which there are many and few */
#define CROWDED .1   /* of a linear bar, which half of its intervals would share */

static int by_length(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Where half of the intervals between knots would share a small part of the bar, as between
 * quantiles of a field with outliers, all intervals get one length. */
static void bar_places(struct bar *b, const struct spec_knot *knot, size_t n)
{
    double *length = xmalloc(n + 1, sizeof *length), crowd = 0;
    size_t intervals = 0;
    b->even = xmalloc(n + 1, sizeof *b->even);
    for (size_t i = 0; i < n; i++) {
        if (i && !(knot[i].s > knot[i - 1].s)) continue;
        if (i) length[intervals++] = knot[i].s - b->even[b->n_even - 1];
        b->even[b->n_even++] = knot[i].s;
    }
    qsort(length, intervals, sizeof *length, by_length);
    for (size_t i = 0; i < intervals / 2; i++) crowd += length[i];
    free(length);
    if (intervals >= EVEN_LEAST && crowd < CROWDED * (b->hi - b->lo)) return;
    free(b->even);
    b->even = NULL;
}

/* The values at the ends of intervals, in as many digits as tell them apart. */
static void bar_even_values(const struct bar *b, const struct drawing *s)
{
    char text[64];
    for (size_t i = 0; i < b->n_even; i++) {
        double least = HUGE_VAL, digit = i && i + 1 < b->n_even ? 1 : .1; /* one more at the ends */
        if (i) least = b->even[i] - b->even[i - 1];
        if (i + 1 < b->n_even) least = fmin(least, b->even[i + 1] - b->even[i]);
        const double unit = digit * pow(10, floor(log10(least)));
        snprintf(text, sizeof text, "%.10g", round(b->even[i] / unit) * unit + 0.0);
        const double at[2] = {bar_x(b, b->even[i]), b->y - BACKDROP_ROW / 2 * s->em};
        backdrop_label(s, text, at, 0);
    }
}

/* The bar's surfaces: none beside colours of the second field, because theirs is the first one. */
static size_t bar_n_isos(const struct spec *p) { return p->n_colours ? 0 : p->n_isos; }

/* The opacity of the most opaque slice, which shows the colours whatever their extinction is. The
 * second field says nothing of opacity. */
static double least_opacity(const struct spec *p)
{
    double most = p->n_colours ? 1 : 0;
    for (size_t i = 0; i < p->n_slices; i++) most = fmax(most, p->slice[i].opacity);
    return most;
}

/* The opacity is that of a layer as thick as the grid's shortest extent, or of a slice. */
static void bar_spans(const struct bar *b, const struct drawing *s)
{
    double thick = HUGE_VAL;
    for (int a = 0; a < 3; a++)
        thick = fmin(thick, fabs((s->hi[a] - s->lo[a]) * s->b->spec->scale[a]));
    const struct spec_knot *p = b->knot;
    size_t n = b->n;
    for (const struct spec_knot *q = p + 1; n > 1; n--, p++, q++) {
        for (int j = 0; j < SPAN_PIECES && b->least + p->k + q->k > 0 && q->s > p->s; j++) {
            double f = (j + .5) / SPAN_PIECES, rgb[3];
            for (int c = 0; c < 3; c++) rgb[c] = p->rgb[c] + f * (q->rgb[c] - p->rgb[c]);
            double x0 = bar_x(b, p->s + (q->s - p->s) * j / SPAN_PIECES);
            double x1 = bar_x(b, p->s + (q->s - p->s) * (j + 1) / SPAN_PIECES);
            double alpha = fmax(b->least, 1 - exp(-thick * (p->k + f * (q->k - p->k))));
            patch(s, x0, fmin(fmax(x1, x0 + .3) + .7, b->x + b->w), b->y, b->y + b->h, rgb, alpha);
        }
    }
}

/* The colours of the second field hold beyond its first and its last knot, too. */
static void bar_ends(const struct bar *b, const struct drawing *s)
{
    const struct spec *p = s->b->spec;
    if (!p->n_colours) return;
    const struct spec_knot *first = p->colour, *last = first + p->n_colours - 1;
    patch(s, b->x, bar_x(b, first->s) + .7, b->y, b->y + b->h, first->rgb, 1);
    patch(s, bar_x(b, last->s), b->x + b->w, b->y, b->y + b->h, last->rgb, 1);
}

/* Above the bar if it has values below. Labels that would cover others are left out. */
static void bar_isos(const struct bar *b, const struct drawing *s)
{
    char text[64];
    double y = s->b->spec->n_knots ? b->y + b->h + BACKDROP_ROW / 2 * s->em
                                   : b->y - BACKDROP_ROW / 2 * s->em;
    for (size_t i = 0; i < bar_n_isos(s->b->spec); i++) {
        const struct spec_iso *iso = s->b->spec->iso + i;
        double x = bar_x(b, iso->s), at[2] = {x, y};
        patch(s, x - .012 * b->w, x + .012 * b->w, b->y, b->y + b->h, iso->rgb, iso->opacity);
        snprintf(text, sizeof text, "%.10g", iso->s);
        backdrop_label(s, text, at, 0);
    }
}

/* As many values as have room, but 8 at most. */
static void bar_values(const struct bar *b, const struct drawing *s)
{
    char text[64];
    struct ticks t = {0, 0, -1};
    for (int n = 8; n > 0; n--) {
        double widest = 0, step = backdrop_step(b->hi - b->lo, n);
        t = backdrop_ticks(b->lo, b->hi, step);
        for (int i = t.first; i <= t.last; i++) {
            snprintf(text, sizeof text, "%.10g", i * t.step + 0.0);
            widest = fmax(widest, backdrop_text_width(s, text));
        }
        if (widest + .5 * s->em < b->w * step / (b->hi - b->lo)) break;
    }
    for (int i = t.first; i <= t.last; i++) {
        snprintf(text, sizeof text, "%.10g", i * t.step + 0.0);
        double at[2] = {bar_x(b, i * t.step), b->y - BACKDROP_ROW / 2 * s->em};
        backdrop_label(s, text, at, 0);
    }
}

/* Copies the characters of text that fit into a width, the last one as dots if some do not. */
static void shorten(const struct drawing *s, const char *text, double width, char *out, size_t n)
{
    static const char dots[] = "\xe2\x80\xa6";
    size_t length = strlen(text);
    if (length > n - sizeof dots) length = n - sizeof dots;
    snprintf(out, n, "%.*s", (int)length, text);
    while (length && (text[length] || backdrop_text_width(s, out) > width)) {
        do length--;
        while (length && (text[length] & 0xc0) == 0x80);
        snprintf(out, n, "%.*s%s", (int)length, text, dots);
        if (backdrop_text_width(s, out) <= width) break;
    }
    if (!length) *out = '\0';
}

/* The time at the right; the title in the middle, or at the left if it is long. */
void backdrop_caption(const struct drawing *s)
{
    char text[256];
    double y = (BACKDROP_LINE / 2) * s->em - s->strip, margin = BACKDROP_MARGIN * s->em;
    double right = s->w - margin;
    s->labels->in_strip = true;
    if (*s->b->time && backdrop_label(s, s->b->time, (double[2]){right, y}, 1) == LABEL_PLACED)
        right -= backdrop_text_width(s, s->b->time) + 2 * margin;
    shorten(s, s->b->title, right - margin, text, sizeof text);
    double half = backdrop_text_width(s, text) / 2;
    bool centred = s->w / 2 + half <= right && s->w / 2 - half >= margin;
    if (*text) backdrop_label(s, text, (double[2]){centred ? s->w / 2 : margin, y}, centred - 1);
}

static void draw_bar(struct bar b, const struct drawing *s)
{
    const struct spec *p = s->b->spec;
    const size_t n_isos = b.of_ground ? 0 : bar_n_isos(p);
    b.lo = HUGE_VAL, b.hi = -HUGE_VAL;
    for (size_t i = 0; i < b.n; i++) b.lo = fmin(b.lo, b.knot[i].s), b.hi = fmax(b.hi, b.knot[i].s);
    for (size_t i = 0; i < n_isos; i++)
        b.lo = fmin(b.lo, p->iso[i].s), b.hi = fmax(b.hi, p->iso[i].s);
    if (n_isos == 0) bar_places(&b, b.knot, b.n);
    double pad = b.hi > b.lo ? .04 * (b.hi - b.lo) : fmax(.01, .1 * fabs(b.lo));
    b.lo -= pad;
    b.hi += pad;
    if (!b.of_ground) bar_ends(&b, s);
    bar_spans(&b, s);
    if (!b.of_ground) bar_isos(&b, s);
    mark_rectangle(
        s->list, BACKDROP_BOX, FRAME, (double[2]){b.x, b.y}, (double[2]){b.x + b.w, b.y + b.h});
    if (b.even) bar_even_values(&b, s);
    else if (b.of_ground || p->n_knots) bar_values(&b, s);
    free(b.even);
}

/* One bar in the middle, or two: of the field, and of a flat ground. */
void backdrop_legend(const struct drawing *s)
{
    static const double page[3] = {PAGE, PAGE, PAGE};
    const struct spec *p = s->b->spec;
    struct bar b = {.x = .2 * s->w, .w = .6 * s->w, .h = s->em};
    b.y = (BACKDROP_LINE + BACKDROP_ROW) * s->em - s->strip;
    b.knot = p->n_colours ? p->colour : p->knot;
    b.n = p->n_colours ? p->n_colours : p->n_knots;
    b.least = least_opacity(p);
    s->labels->in_strip = true;
    patch(s, 0, s->w, -s->strip, 0, page, 1); /* over lines that leave the picture */
    if (p->flat) {
        struct bar ground = b;
        b.x = .04 * s->w, b.w = ground.w = .44 * s->w, ground.x = .52 * s->w;
        ground.knot = p->ground, ground.n = p->n_grounds, ground.least = p->flat_opacity;
        ground.of_ground = true;
        draw_bar(ground, s);
    }
    draw_bar(b, s);
}
