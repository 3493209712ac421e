/* grib2vtk: the fields of a GRIB file at several levels as a rectilinear grid. */
#include "base/base.h"
#include "grib/grib.h"
#include "image/image.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage_text[] =
    "[-h] [-L LEVELS] [-o FILE] [-t INDEX|all] FILE.grb VARIABLE | -l FILE.grb";

struct options {
    const char *levels; /* -L: a type of levels; NULL: that of which there are most */
    const char *out;    /* -o: a file, %d in it is the time's index; NULL: standard output */
    bool list;          /* -l */
    bool every;         /* -t all */
    size_t time;        /* -t INDEX */
    const char *file, *what;
};

/* The variables of a request: one, or the two of a derived one. */
struct source {
    struct grid_request request;
    struct gb_stack part[2];
};

static struct options parse(int argc, char **argv)
{
    struct options o = {0};
    for (int c; (c = getopt(argc, argv, "hL:lo:t:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 'L': o.levels = optarg; break;
        case 'l': o.list = true; break;
        case 'o': o.out = optarg; break;
        case 't':
            o.every = strcmp(optarg, "all") == 0;
            if (!o.every) o.time = (size_t)opt_int(c, optarg, 0, UINT32_MAX);
            break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != 2 - o.list) usage(ST_USAGE, usage_text);
    o.file = argv[optind];
    o.what = argv[optind + 1];
    enum image_naming naming = o.out ? image_name_check(o.out) : IMAGE_NAME_SINGLE;
    if (naming == IMAGE_NAME_BAD) die(ST_USAGE, "-o %s: expected one %%d in it at most", o.out);
    if (o.every && naming != IMAGE_NAME_NUMBERED)
        die(ST_USAGE, "-t all: expected -o with %%d in the name");
    return o;
}

/* ---- what was asked for --------------------------------------------------------------------- */

/* The variable at the levels that were asked for, or at those of which it has most. */
static struct gb_stack find_stack(
    const struct gb_index *x, const struct options *o, const char *name, int n)
{
    struct gb_stack best = {.n = 0};
    char err[VOLUME_ERR];
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
        die(ST_USAGE, "%s: no %.*s%s%s, expected one that -l lists", o->file, n, name,
            o->levels ? " at levels of type " : "", o->levels ? o->levels : "");
    if (tie)
        die(ST_USAGE, "%s: %.*s is at as many %s, expected -L", o->file, n, name, best.at->levels);
    if (!gb_stack_check(&best, err)) die(ST_USAGE, "%s: %.*s: %s", o->file, n, name, err);
    return best;
}

static struct source find(const struct gb_index *x, const struct options *o)
{
    struct source s = {.part[0].n = 0};
    if (!grid_request_parse(o->what, &s.request))
        die(ST_USAGE, "%s: expected a name before `='", o->what);
    for (int i = 0; i < s.request.n; i++)
        s.part[i] = find_stack(x, o, s.request.part[i], s.request.length[i]);
    if (s.request.n > 1 && !gb_same_axes(&s.part[0], &s.part[1]))
        die(ST_USAGE, "%s: %s: the two have different axes, expected the same", o->file, o->what);
    return s;
}

static void list(const struct gb_index *x)
{
    char err[VOLUME_ERR];
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

/* What is along the grid's axes, in which units; stormring-grid(5). */
static void describe(const struct source *s, size_t time, struct buf *b)
{
    const struct gb_entry *e = s->part[0].at + time * s->part[0].n_levels;
    const struct gb_measure *m = gb_measure_of(e->levels);
    buf_printf(b, "%s [%s]; ", s->request.name, e->units);
    if (gb_is_projected(e->kind)) buf_printf(b, "x %s_x [m]; y %s_y [m]; ", e->kind, e->kind);
    else if (strcmp(e->kind, "rotated_ll") == 0)
        buf_printf(b, "x grid_longitude [degrees]; y grid_latitude [degrees]; ");
    else buf_printf(b, "x longitude [degrees_east]; y latitude [degrees_north]; ");
    buf_printf(b, "z %s%s [%s]; t validity %012lld [YYYYMMDDhhmm]", m->down ? "-" : "", e->levels,
        m->units, (long long)e->when);
    buf_append(b, "", 1);
}

static void put(const struct options *o, size_t time, const struct buf *b)
{
    if (!o->out) {
        put_stdout(buf_data(b), buf_size(b));
        return;
    }
    char *path = image_name(o->out, (uint32_t)time);
    if (outfile_put(path, buf_data(b), buf_size(b)) != 0) die(ST_SYSTEM, "%s:", path);
    free(path);
}

static void convert_time(
    const struct options *o, const struct source *s, size_t time, struct grid *g)
{
    char err[VOLUME_ERR];
    struct buf title = {0}, b = {0};
    for (int i = 0; i < s->request.n; i++)
        if (!gb_values(o->file, &s->part[i], time, g, i > 0, err))
            die(ST_USAGE, "%s: %s: %s", o->file, o->what, err);
    describe(s, time, &title);
    grid_write(g, (const char *)buf_data(&title), &b);
    put(o, time, &b);
    buf_free(&title);
    buf_free(&b);
}

static void convert(const struct gb_index *x, const struct options *o)
{
    char err[VOLUME_ERR];
    struct grid g;
    struct source s = find(x, o);
    size_t times = s.part[0].n_times, end = o->every ? times : o->time + 1;
    if (end > times)
        die(ST_USAGE, "%s: %s: -t %zu: expected an index below %zu", o->file, o->what, o->time,
            times);
    if (!gb_axes(o->file, &s.part[0], &g, err)) die(ST_USAGE, "%s: %s: %s", o->file, o->what, err);
    memcpy(g.name, s.request.name, sizeof g.name);
    for (size_t time = o->every ? 0 : o->time; time < end; time++) convert_time(o, &s, time, &g);
    grid_free(&g);
}

int main(int argc, char **argv)
{
    char err[VOLUME_ERR];
    struct gb_index x;
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (!gb_index_read(o.file, &x, err)) die(ST_USAGE, "%s: %s", o.file, err);
    if (o.list) list(&x);
    else convert(&x, &o);
    gb_index_free(&x);
    close_stdout();
    return ST_OK;
}
