/* nc2vtk: converts a variable of a NetCDF file to a rectilinear grid. */
#include "base/base.h"
#include "cf/cf.h"
#include "convert/convert.h"

#include <string.h>
#include <unistd.h>

static const char usage_text[] =
    "[-chzZ] [-d DIMENSION=INDEX|VALUE|mean|spread] ... [-o FILE] [-r LONGITUDE]\n"
    "              [-t INDEX|all] [-u UNIT] FILE.nc VARIABLE|NAME=EXPRESSION\n"
    "       nc2vtk -i|-l [-d DIMENSION=INDEX|VALUE|mean|spread] ... FILE.nc";

#define CHOICES_MOST CF_AXES_MAX

struct options {
    struct convert_options common;
    bool info;                             /* -i: list with ranges */
    struct cf_choice choice[CHOICES_MOST]; /* -d */
    size_t n_choices;
    enum convert_over over; /* of one of them */
};

/* The variables of a request. */
struct source {
    struct cf_file *c;
    const struct convert_options *o;
    struct convert_request request;
    struct cf_field part[CONVERT_PARTS];
    struct cf_heights heights; /* with -z */
};

/* -d member=3 */
static void choose(struct options *o, const char *text)
{
    const char *equals = strrchr(text, '=');
    if (o->n_choices == CHOICES_MOST) die(ST_USAGE, "-d: expected %d at most", CHOICES_MOST);
    if (!equals || equals == text || !equals[1])
        die(ST_USAGE, "-d %s: expected DIMENSION=INDEX, a value, mean or spread", text);
    const enum convert_over over = convert_over_of(equals + 1);
    if (over && o->over) die(ST_USAGE, "-d %s: expected mean or spread once", text);
    if (over) o->over = over;
    o->choice[o->n_choices++] =
        (struct cf_choice){text, (size_t)(equals - text), equals + 1, over != CONVERT_ONE};
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.info = false};
    for (int c; (c = prog_getopt(argc, argv, "cd:hilo:r:t:u:zZ")) != -1;)
        if (c == 'i') o.info = o.common.list = true;
        else if (c == 'd') choose(&o, optarg);
        else convert_option(&o.common, c, optarg, usage_text);
    convert_operands(&o.common, argc - optind, argv + optind, usage_text);
    return o;
}

/* ---- the request ---------------------------------------------------------------------------- */

static bool known(void *ctx, const char *name) { return cf_knows(ctx, name); }

/* Each choice must be of a dimension of a variable. */
static void check_choices(const struct source *s, const struct options *o)
{
    for (size_t k = 0; k < o->n_choices; k++) {
        const struct cf_choice *d = &o->choice[k];
        bool used = false;
        for (int p = 0; p < s->request.n; p++)
            for (int i = 0; i < s->part[p].n_axes; i++) {
                const struct cf_axis *a = &s->part[p].axis[i];
                used = used || (a->chosen && strncmp(a->name, d->dim, d->length) == 0 &&
                                   !a->name[d->length]);
            }
        if (!used)
            die(ST_USAGE, "%s: %s: -d %s: no such dimension, expected one that -l lists",
                o->common.file, o->common.what, d->dim);
    }
}

/* The members of all variables, of which some may have none. */
static size_t members(const struct source *s)
{
    size_t n = 1;
    for (int i = 0; i < s->request.n; i++) {
        const size_t has = cf_members(&s->part[i]);
        if (has > 1 && n > 1 && has != n)
            die(ST_USAGE, "%s: %s: %zu and %zu members, expected as many", s->o->file, s->o->what,
                n, has);
        if (has > n) n = has;
    }
    return n;
}

static struct source find(struct cf_file *c, const struct options *options)
{
    char err[ERR_BYTES];
    const struct convert_options *o = &options->common;
    struct source s = {.c = c, .o = o};
    struct convert_request *r = &s.request;
    const char *unit[CONVERT_PARTS];
    bool difference[CONVERT_PARTS];
    if (!convert_request_parse(o->what, known, c, r, err))
        die(ST_USAGE, "%s: %s: %s", o->file, o->what, err);
    for (int i = 0; i < r->n; i++) {
        if (!cf_find(c, r->part[i], strlen(r->part[i]), &s.part[i], err))
            die(ST_USAGE, "%s: %s: %s", o->file, r->part[i], err);
        if (!cf_same_axes(&s.part[0], &s.part[i]))
            die(ST_USAGE, "%s: %s: %s and %s have different axes, expected the same", o->file,
                o->what, r->part[0], r->part[i]);
        unit[i] = s.part[i].units;
        difference[i] = s.part[i].difference;
    }
    if (!convert_request_unit(r, unit, difference, err))
        die(ST_USAGE, "%s: %s: %s", o->file, o->what, err);
    check_choices(&s, options);
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
    for (size_t time = 0; good && time < (t ? t->n : 1); time++)
        for (size_t m = 0; good && m < cf_members(f); m++) {
            good = cf_values(c, f, time, m, &g, err);
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
    size_t n;
    if (!cf_each(c, o->info ? info_one : list_one, &table, &n, err))
        die(ST_USAGE, "%s: %s", o->common.file, err);
    if (!n)
        printf("# no variable has two dimensions or more, as a field on a grid has; ncdump -h "
               "lists the variables\n");
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

static void values(void *ctx, int part, size_t time, size_t member, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    if (!cf_values(s->c, &s->part[part], time, member, g, err))
        die(ST_USAGE, "%s: %s: %s", s->o->file, s->part[part].name, err);
}

static void heights(void *ctx, size_t time, size_t member, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    if (!cf_heights_values(s->c, &s->part[0], &s->heights, time, member, g, err))
        die(ST_USAGE, "%s: %s: -z: %s", s->o->file, s->request.name, err);
    if (s->heights.kind == CF_HEIGHTS_HYBRID) convert_pressures(g);
    if (s->heights.kind == CF_HEIGHTS_SEA) convert_sea_pressures(g);
}

static enum convert_levels levels_of(struct source *s)
{
    const struct cf_axis *z = cf_axis_of(&s->part[0], CF_Z);
    char err[ERR_BYTES];
    if (cf_looks_like_hectopascals(z))
        warn("%s: %s: %s has no unit; its numbers look like pressures in hPa, but it is drawn as a "
             "height that grows upwards",
            s->o->file, s->request.name, z->name);
    if (!s->o->heights) return CONVERT_LEVELS_OTHER;
    if (!cf_heights_find(s->c, &s->part[0], s->o->standard, &s->heights, err))
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
        const char *name = a->rotated && k == CF_X ? "grid_longitude" : a->name;
        buf_printf(title, "; %c %s%s [%s]", "xyz"[k], sign, name, a -> units);
    }
    if (z) buf_printf(title, "; z %s", z);
    const struct cf_axis *t = cf_axis_of(f, CF_T);
    if (!t || !t->at) return;
    double bounds[2] = {t->at[time], t->at[time]};
    buf_printf(title, "; t %s ", t->name);
    if (cf_interval(s->c, t, time, bounds)) {
        print_real(text, bounds[0], 9); /* a minute may be in the last digits */
        buf_printf(title, "%s to ", text);
    }
    print_real(text, bounds[1], 9);
    buf_printf(title, "%s [%s]", text, t->units);
}

static void convert_field(struct cf_file *c, const struct options *o)
{
    struct source s = find(c, o);
    const struct cf_axis *t = cf_axis_of(&s.part[0], CF_T);
    const struct cf_axis *z = cf_axis_of(&s.part[0], CF_Z);
    struct converter from = {.what = s.request.name,
        .request = &s.request,
        .levels = levels_of(&s),
        .levels_unit = z->units,
        .members = members(&s),
        .over = o->over,
        .degrees = cf_axis_is_longitude(cf_axis_of(&s.part[0], CF_X)),
        .times = t ? t->n : 1,
        .ctx = &s,
        .axes = axes,
        .values = values,
        .heights = heights,
        .plane = s.part[0].plane,
        .describe = describe};
    if (*s.part[0].plane_fault)
        warn("%s: %s: %s, so that maps have no coasts", o->common.file, s.request.name,
            s.part[0].plane_fault);
    const bool geopotential = s.heights.kind == CF_HEIGHTS_GEOPOTENTIAL;
    from.heights_by = geopotential ? s.heights.geopotential.name : z->name;
    from.standard_too = geopotential && z->pressure;
    convert(&o->common, &from);
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
    c.choice = o.choice;
    c.n_choices = o.n_choices;
    if (o.common.list) list(&c, &o);
    else convert_field(&c, &o);
    cf_close(&c);
    close_stdout();
    return ST_OK;
}
