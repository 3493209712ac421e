/* gridspec: prints a starter specification for a grid. */
#include "base/base.h"
#include "spec/spec.h"

#include <string.h>
#include <unistd.h>

struct options {
    struct spec_wish wish; /* -k, -p, -s */
    const char *grid;
};

static const char usage_text[] = "[-h] [-k KIND] [-p PALETTE] [-s WxH] GRID.vtk";

static struct options parse(int argc, char **argv)
{
    struct options o = {.wish = SPEC_WISH_DEFAULT};
    double colours[SPEC_PALETTE_POINTS][3];
    int w, h;
    for (int c; (c = prog_getopt(argc, argv, "hk:p:s:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 'k':
            if (!spec_kind(optarg, &o.wish.kind))
                die(ST_USAGE, "-k %s: expected " SPEC_KINDS, optarg);
            break;
        case 'p':
            o.wish.palette = opt_text(c, optarg);
            if (!spec_palette(optarg, strlen(optarg), colours))
                die(ST_USAGE, "-p %s: expected %s", optarg, SPEC_PALETTES);
            break;
        case 's':
            opt_size(c, optarg, SPEC_RESOLUTION_MAX, &w, &h);
            o.wish.w = (uint32_t)w, o.wish.h = (uint32_t)h;
            break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != 1) usage(ST_USAGE, usage_text);
    o.grid = argv[optind];
    return o;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct grid g;
    struct buf text = {0};
    char err[ERR_BYTES];
    if (grid_load(o.grid, &g, err) != 0) die(ST_USAGE, "%s", err);
    if (!spec_starter(&g, &o.wish, &text, err))
        die(ST_USAGE, "%s: %s", o.grid, err);
    put_stdout_buf(&text);
    buf_free(&text);
    grid_free(&g);
    close_stdout();
    return ST_OK;
}
