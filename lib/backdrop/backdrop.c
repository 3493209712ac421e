/* backdrop: the script as a whole. */
#include "backdrop/lines.h"

#define UNIT .005 /* pngcairo places things at 200 units a pixel */
#define FILL "filledcurves closed fs solid noborder fc rgb '"

/*
 * gnuplot's graph extends from the centre of the first pixel to one unit before the centre of the
 * last one.
 * pngcairo accepts UTF-8 directly. `set encoding` would make gnuplot warn in a locale without a
 * degree sign, such as C.
 */
static void head(const struct drawing *s, double lo, double hi)
{
    buf_printf(s->out,
        "reset\nset terminal pngcairo size %g,%g fontscale %.3f background rgb '" PAPER "'\n"
        "unset border\nunset tics\nunset key\n"
        "set lmargin at screen 0\nset rmargin at screen 1\n"
        "set bmargin at screen 0\nset tmargin at screen 1\n"
        "set xrange [.5:%.3f]\nset yrange [%.3f:%.3f]\n",
        s->w, hi - lo, s->em / BACKDROP_FONT, s->w - .5 - UNIT, lo + .5, hi - .5 - UNIT);
}

/* The part of the grid's lowest plane that is in front of the eye. */
static void plane(const struct drawing *s)
{
    struct outline o = {.flat = s->b->flat};
    for (int i = 0; i <= 4; i++)
        outline_append(&o,
            (struct outline_point){(i + 1) & 2 ? s->hi[0] : s->lo[0], i & 2 ? s->hi[1] : s->lo[1]});
    buf_printf(s->out, "$plane << EOD\n");
    if (!outline_fill(s, &o, s->out)) buf_printf(s->out, "0 0\n");
    buf_printf(s->out, "EOD\n");
    outline_free(&o);
}

uint32_t backdrop_strip(const struct backdrop *b)
{
    struct drawing s;
    drawing_init(&s, b, NULL);
    return (uint32_t)s.strip;
}

void backdrop_write_caption(const struct backdrop *b, struct buf *out)
{
    struct labels labels = {.series = 0};
    struct drawing s;
    drawing_init(&s, b, out);
    s.labels = &labels;
    head(&s, -s.strip, ceil(BACKDROP_LINE * s.em) - s.strip);
    backdrop_caption(&s);
    buf_printf(out, "plot NaN\n");
    buf_free(&labels.boxes);
}

int backdrop_write(const struct backdrop *b, bool caption, struct buf *out, char err[BACKDROP_ERR])
{
    struct drawing drawing, *s = &drawing;
    struct lines lines = {.n_areas = 0};
    struct labels labels = {.series = 0};
    drawing_init(s, b, out);
    s->labels = &labels;
    bool good = !b->lines || lines_read(s, &lines, err);
    if (good) {
        head(s, -s->strip, s->h);
        backdrop_labels(s);
        backdrop_legend(s);
        if (caption) backdrop_caption(s);
        plane(s);
        buf_append(out, buf_data(&lines.areas), buf_size(&lines.areas));
        buf_printf(out, "$graticule << EOD\n");
        backdrop_graticule(s);
        buf_printf(out, "EOD\n$lines << EOD\n");
        buf_append(out, buf_data(&lines.strokes), buf_size(&lines.strokes));
        buf_printf(out, "EOD\n$edges << EOD\n");
        backdrop_edges(s);
        buf_printf(out, "EOD\nplot $plane with " FILL SEA "'");
        for (int i = 0; i < lines.n_areas; i++)
            buf_printf(out, ", $area%d with " FILL "%s'", i, lines.is_water[i] ? SEA : LAND);
        buf_printf(out, ", $graticule with lines lc rgb '" GRATICULE "'");
        if (buf_size(&lines.strokes))
            buf_printf(out, ", $lines with lines lw %.2g lc rgb '" COAST "'", COAST_WIDTH);
        buf_printf(out, ", $edges with lines lc rgb '" FRAME "'\n");
    }
    buf_free(&labels.boxes);
    lines_free(&lines);
    return good ? 0 : -1;
}
