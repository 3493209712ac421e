/* script: the drawing for gnuplot, which gets pixels. */
#include "backdrop/drawing.h"

#define POINT 8.0 /* pixels: across a disc of pointsize 1 */
#define UNIT .005 /* pngcairo places things at 200 units a pixel */

/*
 * gnuplot's graph extends from the centre of the first pixel to one unit before the centre of the
 * last one.
 * pngcairo accepts UTF-8 directly. `set encoding` would make gnuplot warn in a locale without a
 * degree sign, such as C.
 */
static void head(const struct drawing *s, unsigned parts, struct buf *out, double lo, double hi)
{
    char paper[32] = "transparent";
    if (parts != BACKDROP_RAISED)
        snprintf(paper, sizeof paper, "background rgb '#%06x'", BACKDROP_PAPER);
    buf_printf(out,
        "reset\nset terminal pngcairo size %g,%g fontscale %.3f %s\n"
        "unset border\nunset tics\nunset key\n"
        "set lmargin at screen 0\nset rmargin at screen 1\n"
        "set bmargin at screen 0\nset tmargin at screen 1\n"
        "set style textbox opaque noborder fillcolor rgb '#%02x%06x' margins .4,.2\n"
        "set xrange [.5:%.3f]\nset yrange [%.3f:%.3f]\n",
        s->w, hi - lo, s->em / BACKDROP_FONT, paper, (unsigned)(255 * (1 - BACKDROP_BOXED)),
        BACKDROP_PAPER, s->w - .5 - UNIT, lo + .5, hi - .5 - UNIT);
}

/* Writes text in single quotes, where gnuplot treats only a quote specially. */
static void quoted(const char *text, struct buf *out)
{
    buf_append(out, "'", 1);
    for (; *text; text++) {
        if (*text == '\'') buf_append(out, "'", 1);
        buf_append(out, (unsigned char)*text < ' ' ? " " : text, 1);
    }
    buf_append(out, "'", 1);
}

static void label(const struct backdrop_mark *m, const struct backdrop_list *l, struct buf *out)
{
    const struct backdrop_at *at = l->at + m->first;
    buf_printf(out, "set label ");
    quoted((const char *)buf_data(&l->text) + m->text, out);
    buf_printf(out, " at %.2f,%.2f %s front noenhanced", at->x, at->y,
        m->align < 0   ? "left"
        : m->align > 0 ? "right"
                       : "center");
    if (m->turn != 0) buf_printf(out, " rotate by %.1f", m->turn);
    buf_printf(out, m->boxed ? " boxed\n" : "\n");
}

static void rectangle(const struct backdrop_mark *m, const struct backdrop_list *l, struct buf *out)
{
    const struct backdrop_at *at = l->at + m->first;
    buf_printf(out, "set object rect from %.2f,%.2f to %.2f,%.2f front fs %s rgb '#%06x'\n",
        at[0].x, at[0].y, at[1].x, at[1].y,
        m->kind == BACKDROP_BOX ? "empty border" : "solid noborder fc", m->rgb);
}

static bool is_block(const struct backdrop_mark *m) { return m->kind <= BACKDROP_DOTS; }

static bool is_empty_left_out(enum backdrop_kind kind)
{
    return kind == BACKDROP_LINES || kind == BACKDROP_NUMBERED || kind == BACKDROP_DOTS;
}

/* The name of a block; n: those of each kind so far. */
#define BLOCK 32
static void block_name(const struct backdrop_mark *m, int n[], char name[BLOCK])
{
    static const char *const names[] = {[BACKDROP_PLANE] = "$plane",
        [BACKDROP_AREA] = "$area",
        [BACKDROP_GRATICULE] = "$graticule",
        [BACKDROP_LINES] = "$lines",
        [BACKDROP_NUMBERED] = "$numbered",
        [BACKDROP_EDGES] = "$edges",
        [BACKDROP_DOTS] = "$dots"};
    const int k = n[m->kind]++;
    if (k || m->kind == BACKDROP_AREA) snprintf(name, BLOCK, "%s%d", names[m->kind], k);
    else snprintf(name, BLOCK, "%s", names[m->kind]);
}

/* A plane that is not seen is a point, because a plot needs one. */
static void block(
    const struct backdrop_mark *m, const struct backdrop_list *l, const char *name, struct buf *out)
{
    buf_printf(out, "%s << EOD\n", name);
    for (const struct backdrop_at *at = l->at + m->first, *end = at + m->n; at < end; at++)
        if (isnan(at->x)) buf_printf(out, "\n");
        else buf_printf(out, "%.2f %.2f\n", at->x, at->y);
    if (!m->n && m->kind == BACKDROP_PLANE) buf_printf(out, "0 0\n");
    buf_printf(out, "EOD\n");
}

/* Appends ", " and how gnuplot plots the block. */
static void plot(const struct backdrop_mark *m, const char *name, struct buf *out)
{
    buf_printf(out, ", %s with ", name);
    if (m->kind <= BACKDROP_AREA)
        buf_printf(out, "filledcurves closed fs solid noborder fc rgb '#%06x'", m->rgb);
    else if (m->kind == BACKDROP_DOTS)
        buf_printf(out, "points pt 7 ps %.3f lc rgb '#%06x'", m->width / POINT, m->rgb);
    else if (m->width < 1) buf_printf(out, "lines lw %.2g lc rgb '#%06x'", m->width, m->rgb);
    else buf_printf(out, "lines lc rgb '#%06x'", m->rgb);
}

static void write_list(const struct backdrop_list *l, struct buf *out)
{
    struct buf plots = {0};
    int n[BACKDROP_DOTS + 1] = {0};
    char name[BLOCK];
    for (const struct backdrop_mark *m = l->mark; m < l->mark + l->n_marks; m++) {
        if (m->kind == BACKDROP_LABEL) label(m, l, out);
        else if (!is_block(m)) rectangle(m, l, out);
        else {
            block_name(m, n, name);
            block(m, l, name, out);
            if (m->n || !is_empty_left_out(m->kind)) plot(m, name, &plots);
        }
    }
    if (buf_size(&plots)) buf_consume(&plots, 2);
    else buf_printf(&plots, "NaN");
    buf_printf(out, "plot ");
    buf_append(out, buf_data(&plots), buf_size(&plots));
    buf_printf(out, "\n");
    buf_free(&plots);
}

void backdrop_write_caption(const struct backdrop *b, struct buf *out)
{
    struct backdrop_list list = {.em = 0};
    struct drawing s;
    drawing_init(&s, b);
    backdrop_draw(b, NULL, BACKDROP_CAPTION, &list);
    head(&s, BACKDROP_CAPTION, out, -s.strip, ceil(BACKDROP_LINE * s.em) - s.strip);
    write_list(&list, out);
    backdrop_list_free(&list);
}

int backdrop_write(
    const struct backdrop *b, unsigned parts, struct buf *out, char err[BACKDROP_ERR])
{
    struct backdrop_lines *lines = backdrop_lines_read(b, err);
    struct backdrop_list list = {.em = 0};
    struct drawing s;
    if (!lines) return -1;
    drawing_init(&s, b);
    backdrop_draw(b, lines, parts, &list);
    head(&s, parts, out, -s.strip, s.h);
    write_list(&list, out);
    backdrop_list_free(&list);
    backdrop_lines_free(lines);
    return 0;
}
