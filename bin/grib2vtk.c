/* grib2vtk: converts the fields of a GRIB file at several levels to a rectilinear grid. */
#include "base/base.h"
#include "convert/convert.h"
#include "grib/grib.h"

#include <string.h>
#include <unistd.h>

static const char usage_text[] =
    "[-chzZ] [-L LEVELS] [-o FILE] [-r LONGITUDE] [-t INDEX|all] [-u UNIT]\n"
    "                [-w KEY=VALUE,...] FILE.grb VARIABLE|NAME=EXPRESSION\n"
    "       grib2vtk -l [-w KEY=VALUE,...] FILE.grb";

#define WHERE_MOST 16

struct options {
    struct convert_options common;
    const char *levels;                /* -L: type of level; NULL: the type with the most levels */
    struct gb_where where[WHERE_MOST]; /* -w */
    size_t n_where;
    enum convert_over over; /* of the messages of one of its keys */
};

/* The variables of a request. */
struct source {
    const struct convert_options *o;
    struct convert_request request;
    struct gb_stack part[CONVERT_PARTS];
    struct gb_heights heights; /* with -z */
};

/* -w number=3,stepType=avg */
static void choose(struct options *o, char *text)
{
    for (char *word, *rest = text; (word = text_part(&rest, ',')) != NULL;) {
        const size_t n = strcspn(word, "=");
        if (o->n_where == WHERE_MOST) die(ST_USAGE, "-w: expected %d keys at most", WHERE_MOST);
        if (!n || !word[n] || !word[n + 1])
            die(ST_USAGE, "-w %s: expected KEY=VALUE, KEY=mean or KEY=spread", word);
        word[n] = '\0';
        const char *value = word + n + 1;
        const enum convert_over over = convert_over_of(value);
        if (over && o->over) die(ST_USAGE, "-w %s: expected mean or spread once", word);
        if (over) o->over = over;
        o->where[o->n_where++] = (struct gb_where){word, value, over != CONVERT_ONE};
    }
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.levels = NULL};
    for (int c; (c = prog_getopt(argc, argv, "chL:lo:r:t:u:w:zZ")) != -1;)
        if (c == 'L') o.levels = opt_text(c, optarg);
        else if (c == 'w') choose(&o, optarg);
        else convert_option(&o.common, c, optarg, usage_text);
    convert_operands(&o.common, argc - optind, argv + optind, usage_text);
    return o;
}

/* ---- the request ---------------------------------------------------------------------------- */

/* Finds the variable at the requested type of level, or at the type with the most levels. */
static struct gb_stack find_stack(
    const struct gb_index *x, const struct options *o, const char *name)
{
    struct gb_stack best = {.n = 0};
    char err[ERR_BYTES];
    bool tie = false;
    for (size_t i = 0; i < x->n;) {
        struct gb_stack s = gb_stack_at(x, i);
        i += s.n;
        if (strcmp(s.at->name, name) != 0) continue;
        if (o->levels && strcmp(s.at->levels, o->levels) != 0) continue;
        if (best.n && s.n_levels == best.n_levels) tie = true;
        if (best.n && s.n_levels <= best.n_levels) continue;
        best = s;
        tie = false;
    }
    if (!best.n)
        die(ST_USAGE, "%s: no %s%s%s, expected one that -l lists", o->common.file, name,
            o->levels ? " at levels of type " : "", o->levels ? o->levels : "");
    if (tie)
        die(ST_USAGE, "%s: %s has levels of several types, such as %s, expected -L", o->common.file,
            name, best.at->levels);
    if (!gb_stack_check(&best, err)) die(ST_USAGE, "%s: %s: %s", o->common.file, name, err);
    return best;
}

static bool known(void *ctx, const char *name)
{
    const struct gb_index *x = ctx;
    for (size_t i = 0; i < x->n; i++)
        if (strcmp(x->at[i].name, name) == 0) return true;
    return false;
}

static struct source find(struct gb_index *x, const struct options *o)
{
    const char *file = o->common.file, *what = o->common.what, *unit[CONVERT_PARTS];
    char err[ERR_BYTES];
    struct source s = {.o = &o->common};
    struct convert_request *r = &s.request;
    if (!convert_request_parse(what, known, x, r, err))
        die(ST_USAGE, "%s: %s: %s", file, what, err);
    for (int i = 0; i < r->n; i++) {
        s.part[i] = find_stack(x, o, r->part[i]);
        if (!gb_same_axes(&s.part[0], &s.part[i]))
            die(ST_USAGE, "%s: %s: %s and %s have different axes, expected the same", file, what,
                r->part[0], r->part[i]);
        unit[i] = s.part[i].at->units;
    }
    if (!convert_request_unit(r, unit, NULL, err)) die(ST_USAGE, "%s: %s: %s", file, what, err);
    return s;
}

/* ---- listing -------------------------------------------------------------------------------- */

/* Finds the range of all values. */
static bool find_range(
    const char *file, const struct gb_stack *s, struct convert_range *range, char err[ERR_BYTES])
{
    struct grid g;
    if (!gb_stack_check(s, err) || !gb_axes(file, s, &g, err)) return false;
    bool good = true;
    for (size_t m = 0; good && m < s->n_members; m++) {
        const struct gb_stack one = gb_member(s, m);
        for (size_t time = 0; good && time < s->n_times; time++) {
            good = gb_values(file, &one, time, &g, err);
            if (good) convert_range_add(range, &g);
        }
    }
    grid_free(&g);
    return good;
}

/* Writes YYYY-MM-DD hh:mm. */
static void put_time(char text[32], int64_t when)
{
    snprintf(text, 32, "%04d-%02d-%02d %02d:%02d", (int)(when / 100000000 % 10000),
        (int)(when / 1000000 % 100), (int)(when / 10000 % 100), (int)(when / 100 % 100),
        (int)(when % 100));
}

static void list_one(const char *file, const struct gb_stack *s, struct convert_table *table)
{
    const struct gb_entry *e = s->at;
    struct convert_range range = {.any = false};
    char err[ERR_BYTES], name[CONVERT_TEXT], shape[CONVERT_TEXT], values[CONVERT_TEXT];
    char times[CONVERT_TEXT], first[32], last[32];
    snprintf(name, sizeof name, "%s\t%s", e->name, e->levels);
    if (!find_range(file, s, &range, err)) {
        convert_table_refused(table, name, err);
        return;
    }
    snprintf(shape, sizeof shape, "%lldx%lldx%zu %s %s", (long long)e->nx, (long long)e->ny,
        s->n_levels, e->kind, e->levels);
    put_time(first, e->when);
    put_time(last, s->at[s->n - 1].when);
    snprintf(
        times, sizeof times, s->n_times > 1 ? "%zu: %s to %s" : "%zu: %s", s->n_times, first, last);
    convert_table_row(table, (const char *const[]){e->name, shape, e->units,
                                 convert_range_text(&range, values), times, e->long_name});
}

static void list(const char *file, const struct gb_index *x)
{
    struct convert_table table = {.width = {0}};
    for (size_t i = 0; i < x->n;) {
        struct gb_stack s = gb_stack_at(x, i);
        i += s.n;
        list_one(file, &s, &table);
    }
    convert_table_print(&table);
}

/* ---- converting ----------------------------------------------------------------------------- */

static void axes(void *ctx, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    if (!gb_axes(s->o->file, &s->part[0], g, err))
        die(ST_USAGE, "%s: %s: %s", s->o->file, s->o->what, err);
}

static void values(void *ctx, int part, size_t time, size_t member, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    const struct gb_stack one = gb_member(&s->part[part], member);
    if (!gb_values(s->o->file, &one, time, g, err))
        die(ST_USAGE, "%s: %s: %s", s->o->file, s->o->what, err);
}

static void heights(void *ctx, size_t time, size_t member, struct grid *g)
{
    struct source *s = ctx;
    char err[ERR_BYTES];
    struct gb_heights of = s->heights;
    const struct gb_stack one = gb_member(&s->part[0], member);
    of.field = gb_member(&s->heights.field, member);
    if (!gb_heights_values(s->o->file, &one, &of, time, g, err))
        die(ST_USAGE, "%s: %s: -z: %s", s->o->file, s->o->what, err);
    if (of.kind == GB_HEIGHTS_HYBRID) convert_pressures(g);
}

static enum convert_levels levels_of(const struct gb_index *x, struct source *s)
{
    const char *levels = s->part[0].at->levels;
    if (!s->o->heights) return CONVERT_LEVELS_OTHER;
    gb_heights_find(x, &s->part[0], s->o->standard, &s->heights);
    if (s->heights.kind != GB_HEIGHTS_NONE) return CONVERT_LEVELS_FIELD;
    if (strncmp(levels, "isobaric", 8) == 0) return CONVERT_LEVELS_PRESSURE;
    return convert_levels_of(gb_measure_of(levels)->units);
}

static void describe(const void *ctx, size_t time, const char *z, struct buf *title)
{
    const struct source *s = ctx;
    const struct gb_entry *e = s->part[0].at + time * s->part[0].n_levels;
    const struct gb_measure *m = gb_measure_of(e->levels);
    buf_printf(title, "; ");
    if (gb_is_projected(e->kind)) buf_printf(title, "x %s_x [m]; y %s_y [m]; ", e->kind, e->kind);
    else if (strcmp(e->kind, "rotated_ll") == 0)
        buf_printf(title, "x grid_longitude [degrees]; y grid_latitude [degrees]; ");
    else buf_printf(title, "x longitude [degrees_east]; y latitude [degrees_north]; ");
    if (z) buf_printf(title, "z %s", z);
    else
        buf_printf(
            title, "z %s%s [%s]", gb_counts_down(s->part[0].at) ? "-" : "", e->levels, m->units);
    buf_printf(title, "; t validity ");
    if (e->begin) buf_printf(title, "%012lld to ", (long long)e->begin);
    buf_printf(title, "%012lld [YYYYMMDDhhmm]", (long long)e->when);
}

static void convert_stack(struct gb_index *x, const struct options *o)
{
    char plane[PROJECTION_TEXT], err[ERR_BYTES];
    struct source s = find(x, o);
    if (!gb_plane_of(o->common.file, &s.part[0], plane, err))
        die(ST_USAGE, "%s: %s: %s", o->common.file, o->common.what, err);
    struct converter from = {.what = o->common.what,
        .request = &s.request,
        .levels = levels_of(x, &s),
        .levels_unit = gb_measure_of(s.part[0].at->levels)->units,
        .degrees = !gb_is_projected(s.part[0].at->kind),
        .times = s.part[0].n_times,
        .members = s.part[0].n_members,
        .over = o->over,
        .ctx = &s,
        .axes = axes,
        .values = values,
        .heights = heights,
        .plane = plane,
        .describe = describe};
    const bool geopotential = s.heights.kind == GB_HEIGHTS_GEOPOTENTIAL;
    if (s.heights.kind != GB_HEIGHTS_NONE) from.heights_by = s.heights.field.at->name;
    from.standard_too = geopotential && strncmp(s.part[0].at->levels, "isobaric", 8) == 0;
    convert(&o->common, &from);
}

int main(int argc, char **argv)
{
    char err[ERR_BYTES];
    struct gb_index x;
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (!gb_index_read(o.common.file, o.where, o.n_where, &x, err))
        die(ST_USAGE, "%s: %s", o.common.file, err);
    if (o.common.list) list(o.common.file, &x);
    else convert_stack(&x, &o);
    gb_index_free(&x);
    close_stdout();
    return ST_OK;
}
