/* backdrop: a map, frame and legend to put under a picture of a grid, as a gnuplot script. */
#include "backdrop/backdrop.h"

#include <string.h>
#include <unistd.h>

struct options {
    int w, h;          /* -s; 0: the specification's */
    const char *title; /* -t; NULL: the scalar's name */
    const char *unit;  /* -z, without the minus sign that is in `down` */
    bool down;
    const char *grid, *spec, *lines; /* files; lines may be NULL */
};

static const char usage_text[] = "[-h] [-s WxH] [-t TITLE] [-z UNIT] GRID.vtk SPEC [LINES]";

static struct options parse(int argc, char **argv)
{
    struct options o = {.unit = ""};
    for (int c; (c = getopt(argc, argv, "hs:t:z:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 's':
            if (!parse_size(optarg, 16384, &o.w, &o.h))
                die(ST_USAGE, "-s %s: expected a size such as 800x600", optarg);
            break;
        case 't': o.title = optarg; break;
        case 'z':
            o.down = optarg[0] == '-';
            o.unit = optarg + (o.down ? 1 : 0);
            break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind < 2 || argc - optind > 3) usage(ST_USAGE, usage_text);
    o.grid = argv[optind];
    o.spec = argv[optind + 1];
    o.lines = argv[optind + 2];
    return o;
}

static void open_grid(const char *path, struct grid *g)
{
    struct buf bytes = {0};
    char err[VOLUME_ERR];
    if (read_file(path, &bytes) != 0) die(ST_USAGE, "%s:", path);
    if (grid_read(path, buf_data(&bytes), buf_size(&bytes), g, err) != 0) die(ST_USAGE, "%s", err);
    buf_free(&bytes);
}

static void open_spec(const char *path, struct spec *s)
{
    struct buf text = {0};
    char err[VOLUME_ERR];
    if (read_file(path, &text) != 0) die(ST_USAGE, "%s:", path);
    if (spec_read(path, (const char *)buf_data(&text), buf_size(&text), s, err) != 0)
        die(ST_USAGE, "%s", err);
    buf_free(&text);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct grid grid;
    struct spec spec;
    struct buf lines = {0}, script = {0};
    char err[BACKDROP_ERR];
    open_grid(o.grid, &grid);
    open_spec(o.spec, &spec);
    if (o.lines && read_file(o.lines, &lines) != 0) die(ST_USAGE, "%s:", o.lines);
    buf_append(&lines, "", 1);
    struct backdrop b = {.grid = &grid,
        .spec = &spec,
        .w = o.w ? (uint32_t)o.w : spec.w,
        .h = o.h ? (uint32_t)o.h : spec.h,
        .title = o.title ? o.title : grid.name,
        .unit = o.unit,
        .down = o.down,
        .lines_name = o.lines,
        .lines = o.lines ? (const char *)buf_data(&lines) : NULL};
    if (backdrop_write(&b, &script, err) != 0) die(ST_USAGE, "%s", err);
    put_stdout(buf_data(&script), buf_size(&script));
    buf_free(&script);
    buf_free(&lines);
    grid_free(&grid);
    spec_free(&spec);
    close_stdout();
    return ST_OK;
}
