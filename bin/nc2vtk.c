/* nc2vtk: converts a variable of a NetCDF file to a rectilinear grid. */
#include "base/base.h"
#include "cf/cf.h"
#include "convert/convert.h"

#include <unistd.h>

static const char usage_text[] = "[-chz] [-o FILE] [-t INDEX|all] [-u UNIT] FILE.nc VARIABLE\n"
                                 "       nc2vtk -i|-l FILE.nc";

struct options {
    struct convert_options common;
    bool info; /* -i: list with ranges */
};

/* The variables of a request: one, or two of a derived one. */
struct source {
    struct cf_file *c;
    const struct convert_options *o;
    struct convert_request request;
    struct cf_field part[2];
    struct cf_heights heights; /* with -z */
};

static struct options parse(int argc, char **argv)
{
    struct options o = {.info = false};
    for (int c; (c = prog_getopt(argc, argv, "chilo:t:u:z")) != -1;)
        if (c == 'i') o.info = o.common.list = true;
        else convert_option(&o.common, c, optarg, usage_text);
    convert_operands(&o.common, argc - optind, argv + optind, usage_text);
    return o;
}

/* ---- the request ---------------------------------------------------------------------------- */

static struct source find(struct cf_file *c, const struct convert_options *o)
{
    char err[ERR_BYTES];
    struct source s = {.c = c, .o = o};
    const struct convert_request *r = &s.request;
    if (!convert_request_parse(o->what, &s.request))
        die(ST_USAGE, "%s: expected a variable, or NAME=hypot(U,V)", o->what);
    for (int i = 0; i < r->n; i++)
        if (!cf_find(c, r->part[i], (size_t)r->length[i], &s.part[i], err))
            die(ST_USAGE, "%s: %.*s: %s", o->file, r->length[i], r->part[i], err);
    if (r->n > 1 && !cf_same_axes(&s.part[0], &s.part[1]))
        die(ST_USAGE, "%s: %s: the two have different axes, expected the same", o->file, o->what);
    if (r->n > 1) convert_check_units(o, s.part[0].units, s.part[1].units);
    return s;
}

/* ---- listing --------------------------------------------------------------------------------- */

static void list_one(struct cf_file *c, int group, int id, const char *path, void *arg)
{
    struct cf_field f;
    char err[ERR_BYTES];
    (void)arg;
    if (!cf_field_read(c, group, id, &f, err)) printf("# %s\t%s\n", path, err);
    else {
        printf("%s", path);
        for (int k = CF_X; k <= CF_T; k++) {
            const struct cf_axis *a = cf_axis_of(&f, (enum cf_kind)k);
            const char *sign = a && k == CF_Z && a->down ? "-" : "";
            if (a) printf("\t%c=%s%s:%zu", "xyzt"[k], sign, a -> name, a -> n);
            else printf("\t-");
        }
        printf("\t[%s]\t%s\n", f.units, f.long_name);
    }
    cf_field_free(&f);
}

/* Finds the range of all values. */
static bool find_range(
    struct cf_file *c, const struct cf_field *f, struct convert_range *range, char err[ERR_BYTES])
{
    const struct cf_axis *t = cf_axis_of(f, CF_T);
    struct grid g;
    if (!cf_axes(f, &g, err)) return false;
    bool good = true;
    for (size_t time = 0; good && time < (t ? t->n : 1); time++) {
        good = cf_values(c, f, time, &g, false, err);
        if (good) convert_range_add(range, &g);
    }
    grid_free(&g);
    return good;
}

static void info_one(struct cf_file *c, int group, int id, const char *path, void *arg)
{
    struct convert_table *table = arg;
    struct cf_field f;
    struct convert_range range = {.any = false};
    char err[ERR_BYTES], values[CONVERT_TEXT], shape[CONVERT_TEXT], times[CONVERT_TEXT] = "1";
    if (!cf_field_read(c, group, id, &f, err) || !find_range(c, &f, &range, err))
        convert_table_refused(table, path, err);
    else {
        const struct cf_axis *t = cf_axis_of(&f, CF_T);
        snprintf(shape, sizeof shape, "%zux%zux%zu", cf_axis_of(&f, CF_X)->n,
            cf_axis_of(&f, CF_Y)->n, cf_axis_of(&f, CF_Z)->n);
        if (t && t->at && t->n > 1)
            snprintf(times, sizeof times, "%zu: %.9g to %.9g %s", t->n, t->at[0], t->at[t->n - 1],
                t->units);
        else if (t && t->at && t->n)
            snprintf(times, sizeof times, "1: %.9g %s", t->at[0], t->units);
        else if (t) snprintf(times, sizeof times, "%zu", t->n);
        convert_table_row(table, (const char *const[]){path + 1, shape, f.units,
                                     convert_range_text(&range, values), times, f.long_name});
    }
    cf_field_free(&f);
}

static void list(struct cf_file *c, const struct options *o)
{
    char err[ERR_BYTES];
    struct convert_table table = {.width = {0}};
    if (!cf_each(c, o->info ? info_one : list_one, &table, err))
        die(ST_USAGE, "%s: %s", o->common.file, err);
    convert_table_print(&table);
}

/* ---- converting ------------------------------------------------------------------------------ */

static void axes(void *ctx, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    if (!cf_axes(&s->part[0], g, err))
        die(ST_USAGE, "%s: %s: %s", s->o->file, s->request.name, err);
}

static void values(void *ctx, size_t time, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    for (int i = 0; i < s->request.n; i++)
        if (!cf_values(s->c, &s->part[i], time, g, i > 0, err))
            die(ST_USAGE, "%s: %s: %s", s->o->file, s->part[i].name, err);
}

static void heights(void *ctx, size_t time, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    if (!cf_heights_values(s->c, &s->part[0], &s->heights, time, g, err))
        die(ST_USAGE, "%s: %s: -z: %s", s->o->file, s->request.name, err);
    if (s->heights.kind == CF_HEIGHTS_HYBRID) convert_pressures(g);
}

static enum convert_levels levels_of(struct source *s)
{
    const struct cf_axis *z = cf_axis_of(&s->part[0], CF_Z);
    char err[ERR_BYTES];
    if (!s->o->heights) return CONVERT_LEVELS_OTHER;
    if (!cf_heights_find(s->c, &s->part[0], &s->heights, err))
        die(ST_USAGE, "%s: %s: -z: %s", s->o->file, s->request.name, err);
    if (s->heights.kind != CF_HEIGHTS_NONE) return CONVERT_LEVELS_FIELD;
    return z->pressure ? CONVERT_LEVELS_PRESSURE : convert_levels_of(z->units);
}

static void describe(const void *ctx, size_t time, const char *z, struct buf *title)
{
    const struct source *s = ctx;
    const struct cf_field *f = &s->part[0];
    char text[32];
    for (int k = CF_X; k <= (z ? CF_Y : CF_Z); k++) {
        const struct cf_axis *a = cf_axis_of(f, (enum cf_kind)k);
        const char *sign = k == CF_Z && a->down ? "-" : "";
        const char *name = a->rotated ? "grid_longitude" : a->name;
        buf_printf(title, "; %c %s%s [%s]", "xyz"[k], sign, name, a -> units);
    }
    if (z) buf_printf(title, "; z %s", z);
    const struct cf_axis *t = cf_axis_of(f, CF_T);
    if (!t || !t->at) return;
    print_real(text, t->at[time], 9); /* a minute may be in the last digits */
    buf_printf(title, "; t %s %s [%s]", t->name, text, t->units);
}

static void convert_field(struct cf_file *c, const struct convert_options *o)
{
    struct source s = find(c, o);
    const struct cf_axis *t = cf_axis_of(&s.part[0], CF_T);
    struct converter from = {.what = s.request.name,
        .name = s.request.name,
        .unit = s.part[0].units,
        .difference = s.part[0].difference,
        .levels = levels_of(&s),
        .levels_unit = cf_axis_of(&s.part[0], CF_Z)->units,
        .degrees = cf_axis_is_longitude(cf_axis_of(&s.part[0], CF_X)),
        .times = t ? t->n : 1,
        .ctx = &s,
        .axes = axes,
        .values = values,
        .heights = heights,
        .describe = describe};
    convert(o, &from);
    for (int i = 0; i < s.request.n; i++) cf_field_free(&s.part[i]);
    cf_heights_free(&s.heights);
}

int main(int argc, char **argv)
{
    char err[ERR_BYTES];
    struct cf_file c;
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (!cf_open(o.common.file, &c, err)) die(ST_USAGE, "%s: %s", o.common.file, err);
    if (o.common.list) list(&c, &o);
    else convert_field(&c, &o.common);
    cf_close(&c);
    close_stdout();
    return ST_OK;
}
