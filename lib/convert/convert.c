/* convert: writes the grids to files. */
#include "convert/convert.h"
#include "image/image.h"
#include "units/units.h"

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

/* ---- units and heights ---------------------------------------------------------------------- */

/* The state of a conversion. */
struct run {
    const struct convert_options *o;
    const struct converter *c;
    struct grid g, height; /* height: for CONVERT_LEVELS_FIELD */
    struct units_linear unit;
    bool closing, placed; /* placed: z has the heights of the first time */
};

static struct units_linear conversion(const struct run *r, const char *from, const char *to)
{
    struct units_linear l = {1, 0};
    char err[ERR_BYTES];
    if (!*from)
        die(ST_USAGE, "%s: %s: has no unit, expected one to convert from", r->o->file, r->c->what);
    if (!units_linear(from, to, &l, err)) die(ST_USAGE, "%s: %s: %s", r->o->file, r->c->what, err);
    return l;
}

void convert_check_units(const struct convert_options *o, const char *a, const char *b)
{
    struct units_linear l;
    char err[ERR_BYTES];
    if (strcmp(a, b) == 0) return;
    if (!units_linear(a, b, &l, err) || fabs(l.factor - 1) >= 1e-9 || fabs(l.offset) >= 1e-9)
        die(ST_USAGE, "%s: %s: the two are in '%s' and '%s', expected one unit", o->file, o->what,
            a, b);
}

static void convert_values(struct run *r)
{
    const size_t n = grid_node(&r->g, 0, 0, r->g.n[2]);
    if (!r->o->unit) return;
    for (size_t i = 0; i < n; i++) {
        double v = (double)r->g.value[i] * r->unit.factor + r->unit.offset;
        if (fabs(v) > GRID_MAX)
            die(ST_USAGE, "%s: %s: a value is %g %s, expected %g at most", r->o->file, r->c->what,
                v, r->o->unit, GRID_MAX);
        r->g.value[i] = (float)v;
    }
}

/* Makes heights of z where all columns have the same. */
static void convert_axis(struct run *r)
{
    const struct converter *c = r->c;
    bool pressure = c->levels == CONVERT_LEVELS_PRESSURE;
    if (!r->o->heights || c->levels == CONVERT_LEVELS_FIELD) return;
    if (c->levels == CONVERT_LEVELS_OTHER)
        die(ST_USAGE,
            "%s: %s: -z: no heights, expected pressures, hybrid levels with a surface pressure, or "
            "a geopotential on the same levels",
            r->o->file, c->what);
    struct units_linear l = conversion(r, c->levels_unit, pressure ? "Pa" : "m");
    for (uint32_t k = 0; k < r->g.n[2]; k++) {
        double *z = &r->g.at[2][k], v = (pressure ? -*z : *z) * l.factor + l.offset;
        if (pressure && !(v > 0))
            die(ST_USAGE, "%s: %s: -z: a level has the pressure %g, expected more than 0",
                r->o->file, c->what, -*z);
        *z = pressure ? convert_standard_height(v) : v;
    }
}

/* Moves the values to common heights, those of the first time that is converted. */
static void convert_columns(struct run *r, size_t time)
{
    char err[ERR_BYTES];
    if (!r->o->heights || r->c->levels != CONVERT_LEVELS_FIELD) return;
    r->c->heights(r->c->ctx, time, &r->height);
    if (!r->placed && !convert_planes(&r->height, r->g.at[2], err))
        die(ST_USAGE, "%s: %s: -z: %s", r->o->file, r->c->what, err);
    r->placed = true;
    convert_to_planes(&r->g, &r->height, r->g.at[2]);
}

/* ---- output ---------------------------------------------------------------------------------- */

static void convert_time(struct run *r, size_t time)
{
    const struct converter *c = r->c;
    struct buf title = {0}, b = {0};
    c->values(c->ctx, time, &r->g);
    convert_columns(r, time);
    convert_values(r);
    if (r->closing) close_round(&r->g);
    buf_printf(&title, "%s [%s]", c->name, r->o->unit ? r->o->unit : c->unit);
    c->describe(c->ctx, time, r->o->heights ? "height [m]" : NULL, &title);
    buf_append(&title, "", 1);
    grid_write(&r->g, (const char *)buf_data(&title), &b);
    put(r->o, time, &b);
    if (r->closing) r->g.n[0]--;
    buf_free(&title);
    buf_free(&b);
}

void convert(const struct convert_options *o, const struct converter *c)
{
    struct run r = {.o = o, .c = c};
    const size_t begin = o->every ? 0 : o->time, end = o->every ? c->times : o->time + 1;
    if (!c->times) die(ST_USAGE, "%s: %s: no times, expected one at least", o->file, c->what);
    if (end > c->times)
        die(ST_USAGE, "%s: %s: -t %zu: expected an index below %zu", o->file, c->what, o->time,
            c->times);
    input_add(o->file, "an input");
    if (o->out) image_name_keep(o->out, (uint32_t)begin, (uint32_t)end - 1);
    if (o->unit) r.unit = conversion(&r, c->unit, o->unit);
    if (c->difference) r.unit.offset = 0;
    c->axes(c->ctx, &r.g);
    snprintf(r.g.name, sizeof r.g.name, "%s", c->name);
    convert_axis(&r);
    if (o->heights && c->levels == CONVERT_LEVELS_FIELD) c->axes(c->ctx, &r.height);
    r.closing = o->round && wants_closing(o, c, &r.g);
    if (r.closing) make_room(&r.g);
    for (size_t time = begin; time < end; time++) convert_time(&r, time);
    grid_free(&r.g);
    grid_free(&r.height);
}
