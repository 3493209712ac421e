/* grib2vtk: converts the fields of a GRIB file at several levels to a rectilinear grid. */
#include "base/base.h"
#include "convert/convert.h"
#include "grib/grib.h"

#include <string.h>
#include <unistd.h>

static const char usage_text[] = "[-ch] [-L LEVELS] [-o FILE] [-t INDEX|all] FILE.grb VARIABLE\n"
                                 "       grib2vtk -l FILE.grb";

struct options {
    struct convert_options common;
    const char *levels; /* -L: type of level; NULL: the type with the most levels */
};

/* The variables of a request: one, or two of a derived one. */
struct source {
    const struct convert_options *o;
    struct convert_request request;
    struct gb_stack part[2];
};

static struct options parse(int argc, char **argv)
{
    struct options o = {.levels = NULL};
    for (int c; (c = prog_getopt(argc, argv, "chL:lo:t:")) != -1;)
        if (c == 'L') o.levels = opt_text(c, optarg);
        else convert_option(&o.common, c, optarg, usage_text);
    convert_operands(&o.common, argc - optind, argv + optind, usage_text);
    return o;
}

/* ---- the request ---------------------------------------------------------------------------- */

/* Finds the variable at the requested type of level, or at the type with the most levels. */
static struct gb_stack find_stack(
    const struct gb_index *x, const struct options *o, const char *name, int n)
{
    struct gb_stack best = {.n = 0};
    char err[ERR_BYTES];
    bool tie = false;
    for (size_t i = 0; i < x->n;) {
        struct gb_stack s = gb_stack_at(x, i);
        i += s.n;
        if (strncmp(s.at->name, name, (size_t)n) != 0 || s.at->name[n]) continue;
        if (o->levels && strcmp(s.at->levels, o->levels) != 0) continue;
        if (best.n && s.n_levels == best.n_levels) tie = true;
        if (best.n && s.n_levels <= best.n_levels) continue;
        best = s;
        tie = false;
    }
    if (!best.n)
        die(ST_USAGE, "%s: no %.*s%s%s, expected one that -l lists", o->common.file, n, name,
            o->levels ? " at levels of type " : "", o->levels ? o->levels : "");
    if (tie)
        die(ST_USAGE, "%s: %.*s has levels of several types, such as %s, expected -L",
            o->common.file, n, name, best.at->levels);
    if (!gb_stack_check(&best, err)) die(ST_USAGE, "%s: %.*s: %s", o->common.file, n, name, err);
    return best;
}

static struct source find(const struct gb_index *x, const struct options *o)
{
    const char *file = o->common.file, *what = o->common.what;
    struct source s = {.o = &o->common};
    if (!convert_request_parse(what, &s.request))
        die(ST_USAGE, "%s: expected a variable, or NAME=hypot(U,V)", what);
    for (int i = 0; i < s.request.n; i++)
        s.part[i] = find_stack(x, o, s.request.part[i], s.request.length[i]);
    if (s.request.n > 1 && !gb_same_axes(&s.part[0], &s.part[1]))
        die(ST_USAGE, "%s: %s: the two have different axes, expected the same", file, what);
    return s;
}

static void list(const struct gb_index *x)
{
    char err[ERR_BYTES];
    for (size_t i = 0; i < x->n;) {
        struct gb_stack s = gb_stack_at(x, i);
        const struct gb_entry *e = s.at;
        i += s.n;
        if (!gb_stack_check(&s, err)) printf("# %s\t%s\t%s\n", e->name, e->levels, err);
        else
            printf("%s\t%s:%zu\t%s:%lldx%lld\tt:%zu\t[%s]\t%s\n", e->name, e->levels, s.n_levels,
                e->kind, (long long)e->nx, (long long)e->ny, s.n_times, e->units, e->long_name);
    }
}

/* ---- converting ----------------------------------------------------------------------------- */

static void axes(void *ctx, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    if (!gb_axes(s->o->file, &s->part[0], g, err))
        die(ST_USAGE, "%s: %s: %s", s->o->file, s->o->what, err);
}

static void values(void *ctx, size_t time, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    for (int i = 0; i < s->request.n; i++)
        if (!gb_values(s->o->file, &s->part[i], time, g, i > 0, err))
            die(ST_USAGE, "%s: %s: %s", s->o->file, s->o->what, err);
}

static void describe(const void *ctx, size_t time, struct buf *title)
{
    const struct source *s = ctx;
    const struct gb_entry *e = s->part[0].at + time * s->part[0].n_levels;
    const struct gb_measure *m = gb_measure_of(e->levels);
    buf_printf(title, "%s [%s]; ", s->request.name, e->units);
    if (gb_is_projected(e->kind)) buf_printf(title, "x %s_x [m]; y %s_y [m]; ", e->kind, e->kind);
    else if (strcmp(e->kind, "rotated_ll") == 0)
        buf_printf(title, "x grid_longitude [degrees]; y grid_latitude [degrees]; ");
    else buf_printf(title, "x longitude [degrees_east]; y latitude [degrees_north]; ");
    buf_printf(title, "z %s%s [%s]; t validity %012lld [YYYYMMDDhhmm]", m->down ? "-" : "",
        e->levels, m->units, (long long)e->when);
}

static void convert_stack(const struct gb_index *x, const struct options *o)
{
    struct source s = find(x, o);
    struct converter from = {.what = o->common.what,
        .name = s.request.name,
        .degrees = !gb_is_projected(s.part[0].at->kind),
        .times = s.part[0].n_times,
        .ctx = &s,
        .axes = axes,
        .values = values,
        .describe = describe};
    convert(&o->common, &from);
}

int main(int argc, char **argv)
{
    char err[ERR_BYTES];
    struct gb_index x;
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (!gb_index_read(o.common.file, &x, err)) die(ST_USAGE, "%s: %s", o.common.file, err);
    if (o.common.list) list(&x);
    else convert_stack(&x, &o);
    gb_index_free(&x);
    close_stdout();
    return ST_OK;
}
