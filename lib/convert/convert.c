/* convert: writes the grids to files. */
#include "convert/convert.h"
#include "image/image.h"

#include <stdlib.h>
#include <string.h>

static void put(const struct convert_options *o, size_t time, const struct buf *b)
{
    if (!o->out) {
        put_stdout(buf_data(b), buf_size(b));
        return;
    }
    char *path = image_name(o->out, (uint32_t)time);
    if (outfile_put(path, buf_data(b), buf_size(b)) != 0) die(ST_SYSTEM, "%s:", path);
    free(path);
}

/* ---- the last column of a globe ------------------------------------------------------------- */

#define SLACK .01 /* of a step: coordinates are rounded, to float or to some decimals */

/* True if x lacks exactly one step, no wider than the others, to a full circle. */
static bool wants_closing(
    const struct convert_options *o, const struct converter *c, const struct grid *g)
{
    const double *x = g->at[0], range = x[g->n[0] - 1] - x[0];
    double step = 0;
    if (!c->degrees) die(ST_USAGE, "%s: %s: -c: x is not a longitude in degrees", o->file, c->what);
    for (uint32_t i = 1; i < g->n[0]; i++) step = fmax(step, x[i] - x[i - 1]);
    if (fabs(360 - range) <= SLACK * step) return false;
    if (range > 360 || 360 - range > (1 + SLACK) * step)
        die(ST_USAGE, "%s: %s: -c: x goes from %g to %g, expected a circle without its last step",
            o->file, c->what, x[0], x[0] + range);
    return true;
}

/* Makes room for one more column. */
static void make_room(struct grid *g)
{
    g->at[0] = xrealloc(g->at[0], g->n[0] + 1, sizeof *g->at[0]);
    g->at[0][g->n[0]] = g->at[0][0] + 360;
    g->value = xrealloc(g->value, (size_t)(g->n[0] + 1) * g->n[1], g->n[2] * sizeof *g->value);
}

/* Copies the first column to the end of each row. */
static void close_round(struct grid *g)
{
    const size_t n = g->n[0]++;
    for (size_t row = (size_t)g->n[1] * g->n[2]; row-- > 0;) {
        float *to = g->value + row * (n + 1);
        memmove(to, g->value + row * n, n * sizeof *to);
        to[n] = to[0];
    }
}

/* ---- output ---------------------------------------------------------------------------------- */

static void convert_time(const struct convert_options *o, const struct converter *c, size_t time,
    bool closing, struct grid *g)
{
    struct buf title = {0}, b = {0};
    c->values(c->ctx, time, g);
    if (closing) close_round(g);
    c->describe(c->ctx, time, &title);
    buf_append(&title, "", 1);
    grid_write(g, (const char *)buf_data(&title), &b);
    put(o, time, &b);
    if (closing) g->n[0]--;
    buf_free(&title);
    buf_free(&b);
}

void convert(const struct convert_options *o, const struct converter *c)
{
    struct grid g;
    size_t end = o->every ? c->times : o->time + 1;
    if (end > c->times || !c->times)
        die(ST_USAGE, "%s: %s: -t %zu: expected an index below %zu", o->file, c->what, o->time,
            c->times);
    c->axes(c->ctx, &g);
    snprintf(g.name, sizeof g.name, "%s", c->name);
    bool closing = o->round && wants_closing(o, c, &g);
    if (closing) make_room(&g);
    for (size_t time = o->every ? 0 : o->time; time < end; time++)
        convert_time(o, c, time, closing, &g);
    grid_free(&g);
}
