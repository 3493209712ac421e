/* backdrop: the script as a whole, and the lines on the map. */
#include "backdrop/drawing.h"

#include <string.h>

#define LINE 256

/* Two numbers of a line; false where there are not two. */
static bool numbers(char *line, double v[2])
{
    char *rest = line, *a = strtok_r(rest, " \t\r", &rest), *b = strtok_r(NULL, " \t\r", &rest);
    return a && b && !strtok_r(NULL, " \t\r", &rest) && parse_real(a, -GRID_MAX, GRID_MAX, &v[0]) &&
           parse_real(b, -GRID_MAX, GRID_MAX, &v[1]);
}

/* A line's next point; longitudes are taken round the globe to where the grid is. */
static void line_point(const struct drawing *s, double v[2], double *before)
{
    double x = v[0] - 360 * floor((v[0] - s->lo[0]) / 360);
    bool inside = x <= s->hi[0] && v[1] >= s->lo[1] && v[1] <= s->hi[1];
    if (!inside || fabs(x - *before) > 180) buf_printf(s->out, "\n");
    if (inside) backdrop_point(s, x, v[1], s->lo[2]);
    *before = x;
}

/* The next of them into line, cut where it does not fit: no two numbers are as long. */
static const char *next_line(const char *text, char line[LINE])
{
    size_t n = strcspn(text, "\n"), kept = n < LINE - 1 ? n : LINE - 1;
    memcpy(line, text, kept);
    line[kept] = '\0';
    return text[n] ? text + n + 1 : NULL;
}

static int lines(const struct drawing *s, char err[BACKDROP_ERR])
{
    double before = 0, v[2];
    char line[LINE];
    int number = 1;
    for (const char *rest = s->b->lines; rest; number++) {
        rest = next_line(rest, line);
        if (strchr("#>", line[0]))
            buf_printf(s->out, "\n"); /* or empty: strchr finds the end, too */
        else if (numbers(line, v)) line_point(s, v, &before);
        else {
            snprintf(err, BACKDROP_ERR, "%.128s:%d: expected longitude and latitude",
                s->b->lines_name, number);
            return -1;
        }
    }
    return 0;
}

static void head(const struct drawing *s)
{
    buf_printf(s->out,
        "set terminal pngcairo size %g,%g fontscale %.3f background rgb '" PAPER "'\n"
        "unset border\nunset tics\nunset key\nset encoding utf8\n"
        "set lmargin at screen 0\nset rmargin at screen 1\n"
        "set bmargin at screen 0\nset tmargin at screen 1\n"
        "set xrange [0:%g]\nset yrange [0:%g]\n",
        s->w, s->h, fmax(.4, s->h / 720), s->w, s->h);
}

int backdrop_write(const struct backdrop *b, struct buf *out, char err[BACKDROP_ERR])
{
    struct drawing drawing, *s = &drawing;
    drawing_init(s, b, out);
    head(s);
    backdrop_labels(s);
    backdrop_legend(s);
    buf_printf(s->out, "$plane << EOD\n");
    for (int i = 0; i <= 4; i++)
        backdrop_point(s, (i + 1) & 2 ? s->hi[0] : s->lo[0], i & 2 ? s->hi[1] : s->lo[1], s->lo[2]);
    buf_printf(s->out, "EOD\n$graticule << EOD\n");
    backdrop_graticule(s);
    buf_printf(s->out, "EOD\n$lines << EOD\n");
    if (b->lines && lines(s, err) != 0) return -1;
    buf_printf(s->out, "EOD\n$edges << EOD\n");
    backdrop_edges(s);
    buf_printf(s->out,
        "EOD\nplot $plane with filledcurves closed fc rgb '" SEA "', $graticule with lines lc "
        "rgb '" GRATICULE "', %s$edges with lines lc rgb '" FRAME "'\n",
        b->lines ? "$lines with lines lc rgb '" COAST "', " : "");
    return 0;
}
