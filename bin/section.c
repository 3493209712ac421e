/* section: cuts a grid along a line between two places: the field above it, as a grid. */
#include "backdrop/backdrop.h"
#include "layer/layer.h"

#include <stdlib.h>
#include <strings.h>
#include <unistd.h>

#define NODES 200
#define NODES_MAX 10000

struct options {
    struct layer_point end[2]; /* -l */
    uint32_t nodes;            /* -n */
    const char *path;
};

static const char usage_text[] = "[-h] -l X,Y,X,Y [-n NODES] GRID.vtk";

static void take_ends(const char *s, struct options *o)
{
    size_t n;
    double *v = opt_reals('l', s, -GRID_MAX, GRID_MAX, &n);
    if (n != 4) die(ST_USAGE, "-l %s: expected two places, such as 5.3,60.4,-2.1,57.1", s);
    for (int i = 0; i < 2; i++) o->end[i] = (struct layer_point){v[2 * i], v[2 * i + 1]};
    free(v);
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.nodes = NODES};
    bool has_ends = false;
    for (int c; (c = prog_getopt(argc, argv, "hl:n:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 'l':
            take_ends(optarg, &o);
            has_ends = true;
            break;
        case 'n': o.nodes = (uint32_t)opt_int(c, optarg, 2, NODES_MAX); break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != 1 || !has_ends) usage(ST_USAGE, usage_text);
    o.path = argv[optind];
    return o;
}

/* Places are longitude and latitude if the grid says where these are. */
static struct layer_on find_on(const struct options *o, const struct grid *g, struct plane **plane)
{
    char proj[GRID_TITLE], err[ERR_BYTES];
    struct grid_named x;
    struct layer_on on = {.globe = backdrop_on_globe(g)};
    on.circles = on.globe;
    if (on.globe || !grid_title_proj(g->title, proj) || !grid_title(g->title, 'x', &x)) return on;
    const struct plane_at lo = {g->at[0][0], g->at[1][0]},
                          hi = {g->at[0][g->n[0] - 1], g->at[1][g->n[1] - 1]};
    *plane = plane_open(proj, x.unit, lo, hi, err);
    if (!*plane) die(ST_USAGE, "%s: %s", o->path, err);
    return (struct layer_on){true, *plane, strncasecmp(x.unit, "degree", 6) == 0};
}

static void check(const struct options *o, const struct grid *g, const struct layer_on *on)
{
    if (g->brick.is) die(ST_USAGE, "%s: is a brick, expected a whole grid", o->path);
    for (int i = 0; i < 2; i++)
        if (on->plane && !layer_inside(g, o->end[i], on))
            die(ST_USAGE, "-l: %g,%g is outside of the grid, expected longitude and latitude in it",
                o->end[i].x, o->end[i].y);
        else if (!layer_inside(g, o->end[i], on))
            die(ST_USAGE,
                "-l: %g,%g is outside of the grid, expected x from %g to %g, y from %g to %g",
                o->end[i].x, o->end[i].y, g->at[0][0], g->at[0][g->n[0] - 1], g->at[1][0],
                g->at[1][g->n[1] - 1]);
    const double length = layer_length(o->end[0], o->end[1], on->globe);
    if (length / (o->nodes - 1) * .02 < GRID_STEP_MIN || length > GRID_MAX)
        die(ST_USAGE, "-l: a line of length %g, expected two places", length);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct grid g, section;
    struct grid_named x;
    struct buf out = {0};
    char err[ERR_BYTES];
    if (grid_load(o.path, &g, err) != 0) die(ST_USAGE, "%s", err);
    struct plane *plane = NULL;
    const struct layer_on on = find_on(&o, &g, &plane);
    check(&o, &g, &on);
    const char *unit = on.globe ? "km" : grid_title(g.title, 'x', &x) ? x.unit : "";
    layer_section(&g, o.end[0], o.end[1], &on, unit, o.nodes, &section);
    grid_write(&section, section.title, &out);
    put_stdout_buf(&out);
    buf_free(&out);
    grid_free(&section);
    grid_free(&g);
    plane_free(plane);
    close_stdout();
    return ST_OK;
}
