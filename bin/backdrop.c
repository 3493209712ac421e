/* backdrop: writes a map, frame and legend for the background of a picture of a grid, as a gnuplot
 * script. */
#include "backdrop/backdrop.h"

#include <string.h>
#include <strings.h>
#include <unistd.h>

struct options {
    int w, h;                        /* -s; 0: the specification's */
    const char *title;               /* -t; NULL: from the grid's title */
    const char *unit;                /* -z; NULL: from the grid's title */
    const char *grid, *spec, *lines; /* files; lines may be NULL */
};

static const char usage_text[] = "[-h] [-s WxH] [-t TITLE] [-z UNIT] GRID.vtk SPEC [LINES]";

static struct options parse(int argc, char **argv)
{
    struct options o = {.w = 0};
    for (int c; (c = prog_getopt(argc, argv, "hs:t:z:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 's':
            if (!parse_size(optarg, 16384, &o.w, &o.h))
                die(ST_USAGE, "-s %s: expected a size such as 800x600", optarg);
            break;
        case 't': o.title = opt_text(c, optarg); break;
        case 'z': o.unit = opt_text(c, optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind < 2 || argc - optind > 3) usage(ST_USAGE, usage_text);
    o.grid = argv[optind];
    o.spec = argv[optind + 1];
    o.lines = argv[optind + 2];
    return o;
}

/* Names from the grid's title, unless options give them. */
struct names {
    struct grid_named scalar, x, z;
    char title[2 * GRID_NAME + 2];
};

static void set_names(
    struct names *n, const struct options *o, const struct grid *g, struct backdrop *b)
{
    bool known = grid_title(g->title, 0, &n->scalar) && n->scalar.unit[0];
    if (known) snprintf(n->title, sizeof n->title, "%s, %s", n->scalar.name, n->scalar.unit);
    b->title = o->title ? o->title : known ? n->title : g->name;
    if (grid_title(g->title, 'x', &n->x) && n->x.unit[0] &&
        strncasecmp(n->x.unit, "degree", 6) != 0)
        b->flat = n->x.unit;
    known = grid_title(g->title, 'z', &n->z);
    b->down = o->unit ? o->unit[0] == '-' : known && n->z.down;
    b->unit = o->unit ? o->unit + b->down : known ? n->z.unit : "";
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct grid grid;
    struct spec spec;
    struct names names;
    struct buf lines = {0}, script = {0};
    char err[BACKDROP_ERR];
    if (grid_load(o.grid, &grid, err) != 0 || spec_load(o.spec, &spec, err) != 0)
        die(ST_USAGE, "%s", err);
    if (o.lines && read_file(o.lines, &lines) != 0) die(ST_USAGE, "%s:", o.lines);
    buf_append(&lines, "", 1);
    struct backdrop b = {.grid = &grid,
        .spec = &spec,
        .w = o.w ? (uint32_t)o.w : spec.w,
        .h = o.h ? (uint32_t)o.h : spec.h,
        .lines_name = o.lines,
        .lines = o.lines ? (const char *)buf_data(&lines) : NULL};
    set_names(&names, &o, &grid, &b);
    if (backdrop_write(&b, &script, err) != 0) die(ST_USAGE, "%s", err);
    put_stdout(buf_data(&script), buf_size(&script));
    buf_free(&script);
    buf_free(&lines);
    grid_free(&grid);
    spec_free(&spec);
    close_stdout();
    return ST_OK;
}
