/* convert: writes the grids to files. */
#include "convert/convert_int.h"
#include "image/image.h"
#include "units/units.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* True if the file holds something else. It is no input, so it is read without load_file. */
static bool holds_another(const char *path, const struct buf *b)
{
    unsigned char old[4096];
    const unsigned char *at = buf_data(b);
    size_t left = buf_size(b), n;
    FILE *f = fopen(path, "re");
    if (!f) return false;
    bool same = true;
    while (same && (n = fread(old, 1, sizeof old, f)) > 0) {
        same = n <= left && memcmp(old, at, n) == 0;
        at += n, left -= n <= left ? n : left;
    }
    fclose(f);
    return !same || left;
}

/* Writes a grid; notes the first file that held another one, of those with numbers. */
static void put(const struct convert_options *o, size_t time, const struct buf *b, char **replaced)
{
    if (!o->out) {
        put_stdout(buf_data(b), buf_size(b));
        return;
    }
    char *path = image_name(o->out, (uint32_t)time);
    if (o->every && !*replaced && holds_another(path, b)) *replaced = xstrdup(path);
    if (outfile_put(path, buf_data(b), buf_size(b)) != 0) die(ST_SYSTEM, "%s:", path);
    free(path);
}

/* ---- units and heights ---------------------------------------------------------------------- */

/* The state of a conversion. */
struct run {
    const struct convert_options *o;
    const struct converter *c;
    struct grid g, height;           /* height: for CONVERT_LEVELS_FIELD */
    struct grid part[CONVERT_PARTS]; /* of an expression */
    double *mean, *square;           /* of members, and how many have a value: */
    uint32_t *count;
    struct convert_roll roll;
    struct units_linear unit;
    bool closing, placed; /* placed: z has the heights of the first time */
    char *replaced;       /* a file that held another grid */
};

/* Rain is often in kg m-2 or kg m-2 s-1, and people ask for millimetres. */
static const char *advice(const char *from, const char *to)
{
    struct units_linear l;
    char err[ERR_BYTES];
    const bool amount = units_linear(from, "kg m-2", &l, err) && units_linear(to, "mm", &l, err);
    const bool rate =
        units_linear(from, "kg m-2 s-1", &l, err) && units_linear(to, "mm s-1", &l, err);
    return amount || rate
               ? "; 1 kg m-2 of water is 1 mm deep, so kg m-2 has the numbers of mm, and kg m-2 "
                 "day-1 those of mm/day"
               : "";
}

static struct units_linear conversion(const struct run *r, const char *from, const char *to)
{
    struct units_linear l = {1, 0};
    char err[ERR_BYTES];
    if (!*from)
        die(ST_USAGE, "%s: %s: has no unit, expected one to convert from", r->o->file, r->c->what);
    if (!units_linear(from, to, &l, err))
        die(ST_USAGE, "%s: %s: %s%s", r->o->file, r->c->what, err, advice(from, to));
    return l;
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
static void convert_columns(struct run *r, size_t time, size_t member)
{
    char err[ERR_BYTES];
    if (!r->o->heights || r->c->levels != CONVERT_LEVELS_FIELD) return;
    r->c->heights(r->c->ctx, time, member, &r->height);
    if (!r->placed && !convert_planes(&r->height, r->g.at[2], err))
        die(ST_USAGE, "%s: %s: -z: by %s: %s%s", r->o->file, r->c->what, r->c->heights_by, err,
            r->c->standard_too ? "; -Z takes the standard atmosphere" : "");
    r->placed = true;
    convert_to_planes(&r->g, &r->height, r->g.at[2]);
}

/* ---- expressions and members ----------------------------------------------------------------- */

/* Reads the values of one member, and computes those of an expression. */
static void read_member(struct run *r, size_t time, size_t member)
{
    const struct converter *c = r->c;
    const struct convert_request *q = c->request;
    const float *part[CONVERT_PARTS];
    const size_t nodes = grid_node(&r->g, 0, 0, r->g.n[2]);
    if (q->n_steps == 1) {
        c->values(c->ctx, 0, time, member, &r->g);
        return;
    }
    for (int i = 0; i < q->n; i++) {
        struct grid *p = &r->part[i];
        memcpy(p->n, r->g.n, sizeof p->n);
        if (!p->value) p->value = xmalloc(nodes, sizeof *p->value);
        c->values(c->ctx, i, time, member, p);
        part[i] = p->value;
    }
    for (size_t i = 0; i < nodes; i++) {
        const double v = convert_request_at(q, part, i);
        if (fabs(v) > GRID_MAX)
            die(ST_USAGE, "%s: %s: a value is %g, expected %g at most", r->o->file, c->what, v,
                GRID_MAX);
        r->g.value[i] = (float)v;
    }
}

/* Adds a member to the sums. (B.P. Welford, Technometrics 4, 1962) */
static void add_member(struct run *r, size_t nodes)
{
    for (size_t i = 0; i < nodes; i++) {
        const double v = (double)r->g.value[i], off = v - r->mean[i];
        if (isnan(v)) continue;
        r->mean[i] += off / ++r->count[i];
        r->square[i] += off * (v - r->mean[i]);
    }
}

/* Reads the values of one time, at their heights, of all members. */
static void convert_members(struct run *r, size_t time)
{
    const struct converter *c = r->c;
    const size_t nodes = grid_node(&r->g, 0, 0, r->g.n[2]);
    const bool several = c->over != CONVERT_ONE;
    if (several) {
        if (!r->mean) r->mean = xmalloc(nodes, sizeof *r->mean);
        if (!r->square) r->square = xmalloc(nodes, sizeof *r->square);
        if (!r->count) r->count = xmalloc(nodes, sizeof *r->count);
        memset(r->count, 0, nodes * sizeof *r->count);
        for (size_t i = 0; i < nodes; i++) r->mean[i] = r->square[i] = 0;
    }
    for (size_t m = 0; m < (several ? c->members : 1); m++) {
        read_member(r, time, m);
        convert_columns(r, time, m);
        if (several) add_member(r, nodes);
    }
    for (size_t i = 0; several && i < nodes; i++) {
        const uint32_t n = r->count[i];
        r->g.value[i] = !n                        ? NAN
                        : c->over == CONVERT_MEAN ? (float)r->mean[i]
                                                  : (float)sqrt(r->square[i] / n);
    }
}

/* ---- output ---------------------------------------------------------------------------------- */

/* A title that is cut would name another plane. */
static void add_plane(const struct run *r, struct buf *title)
{
    const char *plane = r->c->plane;
    if (!*plane) return;
    if (buf_size(title) + strlen("; proj ") + strlen(plane) < GRID_TITLE - 1)
        buf_printf(title, "; proj %s", plane);
    else
        warn("%s: %s: the title has no room for '%s', so that maps have no coasts", r->o->file,
            r->c->what, plane);
}

static void convert_time(struct run *r, size_t time)
{
    const struct converter *c = r->c;
    struct buf title = {0}, b = {0};
    convert_members(r, time);
    convert_values(r);
    convert_roll(&r->roll, &r->g);
    if (r->closing) convert_close(&r->g);
    buf_printf(&title, "%s [%s]", c->request->name, r->o->unit ? r->o->unit : c->request->unit);
    c->describe(c->ctx, time, r->o->heights ? "height [m]" : NULL, &title);
    add_plane(r, &title);
    buf_append(&title, "", 1);
    grid_write(&r->g, (const char *)buf_data(&title), &b);
    put(r->o, time, &b, &r->replaced);
    if (r->closing) r->g.n[0]--;
    buf_free(&title);
    buf_free(&b);
}

/* Says that another file's grids had the same names. */
static void tell_replaced(struct run *r, size_t end)
{
    if (!r->replaced) return;
    char *next = image_name(r->o->out, (uint32_t)end);
    const bool more = access(next, F_OK) == 0;
    warn("%s held another grid, which is replaced; another -o keeps both%s%s%s", r->replaced,
        more ? "; " : "", more ? next : "", more ? " stays" : "");
    free(next);
    free(r->replaced);
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
    if (o->unit) r.unit = conversion(&r, c->request->unit, o->unit);
    if (c->request->difference || c->over == CONVERT_SPREAD) r.unit.offset = 0;
    c->axes(c->ctx, &r.g);
    snprintf(r.g.name, sizeof r.g.name, "%s", c->request->name);
    convert_axis(&r);
    if (o->heights && c->levels == CONVERT_LEVELS_FIELD) c->axes(c->ctx, &r.height);
    if (o->roll) r.roll = convert_find_roll(o, c, &r.g);
    r.closing = o->round && convert_wants_closing(o, c, &r.g);
    for (size_t time = begin; time < end; time++) convert_time(&r, time);
    tell_replaced(&r, end);
    for (int i = 0; i < CONVERT_PARTS; i++) free(r.part[i].value);
    free(r.mean);
    free(r.square);
    free(r.count);
    grid_free(&r.g);
    grid_free(&r.height);
}
