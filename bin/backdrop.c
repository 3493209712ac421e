/* backdrop: writes a map, frame and legend for the background of a picture of a grid, as a gnuplot
 * script; or, with -o, runs gnuplot and writes the backgrounds of many pictures. */
#include "backdrop/backdrop.h"
#include "crop/crop.h"
#include "image/image.h"
#include "job/job.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct options {
    int w, h;                               /* -s; 0: the specification's */
    const char *title;                      /* -t; NULL: from the grid's title */
    const char *unit;                       /* -z; NULL: from the grid's title */
    const char *lines;                      /* -m, or the third operand; NULL: none */
    struct image_out out, captions, raised; /* -o, -c, -f; pattern NULL: not given */
    char **files;                           /* grids, then specifications */
    int n_grids, n_specs;
};

/* What is read from the files. */
struct input {
    const struct options *o;
    const struct grid **grid;
    struct grid_file **file; /* of grid[], which have no values; NULL: it is whole */
    struct grid whole;
    struct spec *spec;
    struct buf lines;
    char (*time)[BACKDROP_TIME]; /* of each grid */
};

static const char usage_text[] =
    "[-h] [-s WxH] [-t TITLE] [-z UNIT] GRID.vtk SPEC [LINES]\n"
    "       backdrop -o OUT [-c OUT] [-f OUT] [-m LINES] [-s WxH] [-t TITLE]\n"
    "                [-z UNIT] GRID.vtk ... SPEC ...";

static void check_out(int opt, struct image_out *out, int pictures)
{
    if (!out->pattern) return;
    image_out_check(out);
    if (out->format != IMAGE_PNG)
        die(ST_USAGE, "-%c %s: expected a name that ends in .png", opt, out->pattern);
    if (pictures > 1 && out->naming != IMAGE_NAME_NUMBERED)
        die(ST_USAGE, "-%c %s: %d pictures, expected %%d in the name", opt, out->pattern, pictures);
    image_name_keep(out->pattern, 0, (uint32_t)pictures - 1);
}

/* No picture replaces another one of this run. */
static void check_names(const struct options *o)
{
    const char *of[] = {o->out.pattern, o->captions.pattern, o->raised.pattern};
    for (int i = 1; i < 3; i++)
        for (int k = 0; k < i; k++)
            if (of[i] && of[k] && strcmp(of[i], of[k]) == 0)
                die(ST_USAGE, "-%c %s: is also the name of -%c, expected another one", "ocf"[i],
                    of[i], "ocf"[k]);
}

static bool is_grid(const char *path)
{
    unsigned char first[JOB_FIRST];
    uint64_t size;
    struct stat st;
    if (strcmp(path, "-") == 0) return false; /* it is read once, and later */
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode))
        die(ST_USAGE, "%s: is a pipe or a device, expected a file", path);
    return job_is_grid(first, job_first(path, first, &size));
}

static void check_files(struct options *o, int n)
{
    if (!o->out.pattern) {
        if (n < 2 || n > 3 || o->captions.pattern || o->raised.pattern || o->lines)
            usage(ST_USAGE, usage_text);
        o->lines = o->files[2]; /* NULL if there is none */
        o->n_grids = o->n_specs = 1;
        return;
    }
    while (o->n_grids < n && is_grid(o->files[o->n_grids])) o->n_grids++;
    if (n < 2) usage(ST_USAGE, usage_text);
    if (!o->n_grids) o->n_grids = 1; /* the reader of grids says what is wrong with it */
    o->n_specs = n - o->n_grids;
    if (!o->n_specs)
        die(ST_USAGE, "%s: is a grid, expected a specification after the grids", o->files[n - 1]);
    for (int i = 0; i < n; i++) input_add(o->files[i], "an input");
    if (o->lines) input_add(o->lines, "an input");
    check_out('o', &o->out, o->n_grids * o->n_specs);
    check_out('c', &o->captions, o->n_grids * o->n_specs);
    check_out('f', &o->raised, o->n_grids * o->n_specs);
    check_names(o);
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.w = 0};
    for (int c; (c = prog_getopt(argc, argv, "c:f:hm:o:s:t:z:")) != -1;) switch (c) {
        case 'c': o.captions.pattern = opt_text(c, optarg); break;
        case 'f': o.raised.pattern = opt_text(c, optarg); break;
        case 'h': usage(ST_OK, usage_text);
        case 'm': o.lines = opt_text(c, optarg); break;
        case 'o': o.out.pattern = opt_text(c, optarg); break;
        case 's':
            if (!parse_size(optarg, 16384, &o.w, &o.h))
                die(ST_USAGE, "-s %s: expected a size such as 800x600, sides up to 16384", optarg);
            break;
        case 't': o.title = opt_text(c, optarg); break;
        case 'z': o.unit = opt_text(c, optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    o.files = argv + optind;
    check_files(&o, argc - optind);
    return o;
}

/* True if a picture has the colours of further grids, which its legend names. */
static bool by_further(const struct input *in)
{
    for (int i = 0; i < in->o->n_specs; i++)
        if (in->spec[i].n_colours || in->spec[i].flat) return true;
    return false;
}

static void load(struct input *in, const struct options *o)
{
    char err[ERR_BYTES];
    *in = (struct input){.o = o};
    in->grid = xcalloc((size_t)o->n_grids, sizeof *in->grid);
    in->file = xcalloc((size_t)o->n_grids, sizeof *in->file);
    in->time = xcalloc((size_t)o->n_grids, sizeof *in->time);
    in->spec = xcalloc((size_t)o->n_specs, sizeof *in->spec);
    if (!o->out.pattern && grid_load(o->files[0], &in->whole, err) != 0) die(ST_USAGE, "%s", err);
    in->grid[0] = &in->whole;
    for (int i = 0; i < o->n_grids; i++) {
        if (o->out.pattern && !(in->file[i] = grid_file_open(o->files[i], err)))
            die(ST_USAGE, "%s", err);
        if (in->file[i]) in->grid[i] = grid_file_grid(in->file[i]);
        if (in->grid[i]->brick.is)
            die(ST_USAGE, "%s: is a brick, expected a whole grid", o->files[i]);
        backdrop_time(in->grid[i]->title, in->time[i]);
    }
    for (int i = 0; i < o->n_specs; i++)
        if (spec_load(o->files[o->n_grids + i], &in->spec[i], err) != 0) die(ST_USAGE, "%s", err);
    for (int i = 0; i < o->n_grids; i++)
        if (in->file[i] && by_further(in) && !grid_file_further(in->file[i], err))
            die(ST_USAGE, "%s", err);
    if (o->lines && read_file(o->lines, &in->lines) != 0) die(ST_USAGE, "%s:", o->lines);
    if (buf_size(&in->lines) && memchr(buf_data(&in->lines), '\0', buf_size(&in->lines)))
        die(ST_USAGE, "%s: has a byte 0, expected text", o->lines);
    buf_append(&in->lines, "", 1);
}

static void unload(struct input *in)
{
    for (int i = 0; i < in->o->n_grids && in->file[i]; i++) grid_file_close(in->file[i]);
    grid_free(&in->whole);
    for (int i = 0; i < in->o->n_specs; i++) spec_free(&in->spec[i]);
    free(in->grid);
    free(in->file);
    free(in->time);
    free(in->spec);
    buf_free(&in->lines);
}

/* The background of the picture of grid g with specification s; n has its names. */
static struct backdrop describe(const struct input *in, int g, int s, struct backdrop_names *n)
{
    const struct options *o = in->o;
    struct backdrop b = {.grid = in->grid[g],
        .spec = &in->spec[s],
        .w = o->w ? (uint32_t)o->w : in->spec[s].w,
        .h = o->h ? (uint32_t)o->h : in->spec[s].h,
        .time = in->time[g],
        .lines_name = o->lines,
        .lines = o->lines ? (const char *)buf_data(&in->lines) : NULL};
    backdrop_name(&b, o->title, o->unit, n);
    return b;
}

/* ---- -o: pages of one script, each for all pictures that look the same ------------------- */

struct pages {
    struct buf script;
    int n;
    int *map, *raised, *caption; /* for each picture: its pages */
};

/* Adds these parts, to pages that may have a caption. */
static void add_maps(struct pages *p, const struct input *in, unsigned parts, int *page)
{
    const struct options *o = in->o;
    const bool apart = !(parts & BACKDROP_CAPTION);
    char err[BACKDROP_ERR];
    for (int g = 0; g < o->n_grids; g++) {
        int like = 0;
        while (!backdrop_alike(in->grid[like], in->grid[g]) ||
               (!apart && strcmp(in->time[like], in->time[g]) != 0))
            like++;
        for (int s = 0; s < o->n_specs; s++) {
            page[g * o->n_specs + s] = like < g ? page[like * o->n_specs + s] : p->n++;
            if (like < g) continue;
            struct backdrop_names names;
            struct backdrop b = describe(in, g, s, &names);
            if (backdrop_write(&b, parts, &p->script, err) != 0) die(ST_USAGE, "%s", err);
        }
    }
}

static void add_captions(struct pages *p, const struct input *in)
{
    const struct options *o = in->o;
    struct buf *script = xcalloc((size_t)o->n_grids * (size_t)o->n_specs, sizeof *script);
    for (int k = 0, i; k < o->n_grids * o->n_specs; k++) {
        struct backdrop_names names;
        struct backdrop b = describe(in, k / o->n_specs, k % o->n_specs, &names);
        backdrop_write_caption(&b, &script[k]);
        buf_append(&script[k], "", 1);
        const char *text = (const char *)buf_data(&script[k]);
        for (i = 0; strcmp((const char *)buf_data(&script[i]), text) != 0;) i++;
        p->caption[k] = i < k ? p->caption[i] : p->n++;
        if (i == k) buf_append(&p->script, text, strlen(text));
    }
    for (int k = 0; k < o->n_grids * o->n_specs; k++) buf_free(&script[k]);
    free(script);
}

/* Ends the program with the first line of gnuplot's message that has words. */
static _Noreturn void fail(const char *said)
{
    struct buf text = {0};
    bool read = read_file(said, &text) == 0;
    buf_append(&text, "", 1);
    const char *p = read ? (const char *)buf_data(&text) : "";
    while (*p && strchr(" \n\t^", *p)) p++;
    die(ST_SYSTEM, "gnuplot failed%s%.*s", *p ? ": " : "", (int)strcspn(p, "\n"), p);
}

/* Appends the PNGs of all pages. */
static void run_gnuplot(const struct buf *script, struct buf *pngs)
{
    /* -d: without the settings of the user */
    char shell[] = "sh", option[] = "-c", run[] = "exec gnuplot -d \"$1\" 2>\"$2\"";
    char path[4096], said[4096 + 8], err[CROP_ERR];
    snprintf(path, sizeof path, "%s/map.gp", crop_directory());
    snprintf(said, sizeof said, "%s.said", path);
    char *const words[] = {shell, option, run, shell, path, said, NULL};
    if (outfile_put(path, buf_data(script), buf_size(script)) != 0) die(ST_SYSTEM, "%s:", path);
    int status = crop_run(words, &(struct crop_place){0}, pngs, SIZE_MAX / 2, err);
    if (status == CROP_NOT_FOUND)
        die(ST_SYSTEM, "gnuplot is not there, expected it from the Debian package gnuplot-nox");
    if (status != 0) fail(said);
}

struct bytes {
    const unsigned char *p;
    size_t n;
};

static void save(const struct image_out *out, uint32_t number, struct bytes png)
{
    char *name = image_out_name(out, number);
    if (outfile_put(name, png.p, png.n) != 0) die(ST_SYSTEM, "%s:", name);
    free(name);
}

static void write_pages(const struct options *o, const struct pages *p, const struct buf *pngs)
{
    struct bytes *page = xcalloc((size_t)p->n, sizeof *page);
    const unsigned char *at = buf_data(pngs), *end = at + buf_size(pngs);
    uint32_t w, h;
    char err[IMAGE_ERR];
    for (int i = 0; i < p->n; i++, at += page[i - 1].n) {
        page[i] = (struct bytes){at, (size_t)(end - at)};
        if (png_inspect(at, &page[i].n, &w, &h, err) != 0)
            die(ST_SYSTEM, "gnuplot failed: picture %d of %d: %s", i + 1, p->n, err);
    }
    for (int k = 0; k < o->n_grids * o->n_specs; k++) {
        save(&o->out, (uint32_t)k, page[p->map[k]]);
        if (o->captions.pattern) save(&o->captions, (uint32_t)k, page[p->caption[k]]);
        if (o->raised.pattern) save(&o->raised, (uint32_t)k, page[p->raised[k]]);
    }
    free(page);
}

static void draw(const struct input *in)
{
    const size_t pictures = (size_t)in->o->n_grids * (size_t)in->o->n_specs;
    struct pages p = {.map = xcalloc(pictures, sizeof *p.map),
        .raised = xcalloc(pictures, sizeof *p.raised),
        .caption = xcalloc(pictures, sizeof *p.caption)};
    struct buf pngs = {0};
    unsigned parts = BACKDROP_ALL;
    if (in->o->captions.pattern) parts &= ~BACKDROP_CAPTION;
    if (in->o->raised.pattern) parts &= ~BACKDROP_RAISED;
    add_maps(&p, in, parts, p.map);
    if (in->o->raised.pattern) add_maps(&p, in, BACKDROP_RAISED, p.raised);
    if (in->o->captions.pattern) add_captions(&p, in);
    run_gnuplot(&p.script, &pngs);
    write_pages(in->o, &p, &pngs);
    buf_free(&pngs);
    buf_free(&p.script);
    free(p.map);
    free(p.raised);
    free(p.caption);
}

/* ---- the script for one picture ------------------------------------------------------------ */

static void print(const struct input *in)
{
    struct backdrop_names names;
    struct buf script = {0};
    char err[BACKDROP_ERR];
    struct backdrop b = describe(in, 0, 0, &names);
    if (backdrop_write(&b, BACKDROP_ALL, &script, err) != 0) die(ST_USAGE, "%s", err);
    put_stdout(buf_data(&script), buf_size(&script));
    buf_free(&script);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct input in;
    load(&in, &o);
    if (o.out.pattern) draw(&in);
    else print(&in);
    unload(&in);
    close_stdout();
    return ST_OK;
}
