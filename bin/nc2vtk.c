/* nc2vtk: a variable of a NetCDF file as a rectilinear grid. */
#include "base/base.h"
#include "cf/cf.h"
#include "image/image.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage_text[] = "[-h] [-o FILE] [-t INDEX|all] FILE.nc VARIABLE | -l FILE.nc";

struct options {
    const char *out; /* -o: a file, %d in it is the time's index; NULL: standard output */
    bool list;       /* -l */
    bool every;      /* -t all */
    size_t time;     /* -t INDEX */
    const char *file, *what;
};

/* The variables of a request: one, or the two of a derived one. */
struct source {
    struct grid_request request;
    struct cf_field part[2];
};

static struct options parse(int argc, char **argv)
{
    struct options o = {0};
    for (int c; (c = getopt(argc, argv, "hlo:t:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
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

/* ---- what was asked for ---------------------------------------------------------------------- */

static struct source find(struct cf_file *c, const struct options *o)
{
    char err[VOLUME_ERR];
    struct source s = {.part[0].n_axes = 0};
    const struct grid_request *r = &s.request;
    if (!grid_request_parse(o->what, &s.request))
        die(ST_USAGE, "%s: expected a name before `='", o->what);
    for (int i = 0; i < r->n; i++)
        if (!cf_find(c, r->part[i], (size_t)r->length[i], &s.part[i], err))
            die(ST_USAGE, "%s: %.*s: %s", o->file, r->length[i], r->part[i], err);
    if (r->n > 1 && !cf_same_axes(&s.part[0], &s.part[1]))
        die(ST_USAGE, "%s: %s: the two have different axes, expected the same", o->file, o->what);
    return s;
}

/* ---- listing --------------------------------------------------------------------------------- */

static void list_one(struct cf_file *c, int group, int id, const char *path, void *arg)
{
    struct cf_field f;
    char err[VOLUME_ERR];
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

static void list(struct cf_file *c, const struct options *o)
{
    char err[VOLUME_ERR];
    if (!cf_each(c, list_one, NULL, err)) die(ST_USAGE, "%s: %s", o->file, err);
}

/* ---- converting ------------------------------------------------------------------------------ */

/* What is along the grid's axes, in which units; stormring-grid(5). */
static void describe(const struct source *s, size_t time, struct buf *b)
{
    const struct cf_field *f = &s->part[0];
    buf_printf(b, "%s [%s]", s->request.name, f->units);
    for (int k = CF_X; k <= CF_Z; k++) {
        const struct cf_axis *a = cf_axis_of(f, (enum cf_kind)k);
        const char *sign = k == CF_Z && a->down ? "-" : "";
        buf_printf(b, "; %c %s%s [%s]", "xyz"[k], sign, a -> name, a -> units);
    }
    const struct cf_axis *t = cf_axis_of(f, CF_T);
    if (t && t->at) buf_printf(b, "; t %s %.9g [%s]", t->name, t->at[time], t->units);
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
    struct cf_file *c, const struct options *o, const struct source *s, size_t time, struct grid *g)
{
    char err[VOLUME_ERR];
    struct buf title = {0}, b = {0};
    for (int i = 0; i < s->request.n; i++)
        if (!cf_values(c, &s->part[i], time, g, i > 0, err))
            die(ST_USAGE, "%s: %s: %s", o->file, s->part[i].name, err);
    describe(s, time, &title);
    grid_write(g, (const char *)buf_data(&title), &b);
    put(o, time, &b);
    buf_free(&title);
    buf_free(&b);
}

static void convert(struct cf_file *c, const struct options *o)
{
    char err[VOLUME_ERR];
    struct grid g;
    struct source s = find(c, o);
    const struct cf_axis *t = cf_axis_of(&s.part[0], CF_T);
    size_t times = t ? t->n : 1, end = o->every ? times : o->time + 1;
    if (end > times || !times)
        die(ST_USAGE, "%s: %s: -t %zu: expected an index below %zu", o->file, s.request.name,
            o->time, times);
    if (!cf_axes(&s.part[0], &g, err)) die(ST_USAGE, "%s: %s: %s", o->file, s.request.name, err);
    memcpy(g.name, s.request.name, sizeof g.name);
    for (size_t time = o->every ? 0 : o->time; time < end; time++) convert_time(c, o, &s, time, &g);
    for (int i = 0; i < s.request.n; i++) cf_field_free(&s.part[i]);
    grid_free(&g);
}

int main(int argc, char **argv)
{
    char err[VOLUME_ERR];
    struct cf_file c;
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (!cf_open(o.file, &c, err)) die(ST_USAGE, "%s: %s", o.file, err);
    if (o.list) list(&c, &o);
    else convert(&c, &o);
    cf_close(&c);
    close_stdout();
    return ST_OK;
}
