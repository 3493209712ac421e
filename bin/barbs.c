/* barbs: prints wind barbs of a level of two grids, for the map of backdrop. */
#include "backdrop/backdrop.h"
#include "layer/layer.h"
#include "units/units.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ACROSS 20
#define ACROSS_MAX 500
#define LENGTH .8 /* of the distance between barbs */
#define POLE 89.0 /* degrees: beyond there are none */

struct options {
    int across;       /* -n: along the longer side */
    bool has_z, flat; /* flat: -m: on the map, whatever the height */
    double z;         /* -z; otherwise the lowest level */
    char **path;
};

static const char usage_text[] = "[-hm] [-n NUMBER] [-z HEIGHT] EAST.vtk NORTH.vtk";

static struct options parse(int argc, char **argv)
{
    struct options o = {.across = ACROSS};
    for (int c; (c = prog_getopt(argc, argv, "hmn:z:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 'm': o.flat = true; break;
        case 'n': o.across = (int)opt_int(c, optarg, 1, ACROSS_MAX); break;
        case 'z':
            o.z = opt_real(c, optarg, -GRID_MAX, GRID_MAX);
            o.has_z = true;
            break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != 2) usage(ST_USAGE, usage_text);
    o.path = argv + optind;
    return o;
}

/* A component of the wind. */
struct part {
    struct grid g;
    float *level;
    struct units_linear knots;
};

static void load(const struct options *o, int i, struct part *p)
{
    char err[ERR_BYTES];
    struct grid_named scalar;
    if (grid_load(o->path[i], &p->g, err) != 0) die(ST_USAGE, "%s", err);
    if (!grid_title(p->g.title, 0, &scalar))
        die(ST_USAGE, "%s: the title has no unit of the wind, expected one such as U [m/s]",
            o->path[i]);
    p->knots = (struct units_linear){1, 0};
    if (strcmp(scalar.unit, "knots") != 0 && !units_linear(scalar.unit, "knots", &p->knots, err))
        die(ST_USAGE, "%s: %s", o->path[i], err);
    if (!layer_level(&p->g, o->has_z ? o->z : p->g.at[2][0], &p->level, err))
        die(ST_USAGE, "-z %s", err);
}

static void check_same(const struct options *o, const struct grid *a, const struct grid *b)
{
    for (int i = 0; i < 3; i++)
        if (a->n[i] != b->n[i] || memcmp(a->at[i], b->at[i], a->n[i] * sizeof *a->at[i]) != 0)
            die(ST_USAGE, "%s: %c differs from that of %s, expected the same grid", o->path[1],
                "xyz"[i], o -> path[0]);
}

static void print(void *ctx, const struct layer_point *at, size_t n)
{
    (void)ctx;
    printf("> line\n");
    for (size_t i = 0; i < n; i++) printf("%.15g %.15g\n", at[i].x, at[i].y);
}

static double knots_at(const struct part *p, struct layer_point at)
{
    return p->knots.factor * layer_at(&p->g, p->level, at) + p->knots.offset;
}

/* On the globe, a degree of longitude is shorter than one of latitude: a barb shows the way of the
 * air on the map. */
static void barb(const struct part p[2], struct layer_point at, bool globe, double length)
{
    double east = knots_at(&p[0], at), north = knots_at(&p[1], at);
    struct layer_barb b = {.foot = at, .length = length, .knots = hypot(east, north)};
    if (isnan(b.knots) || (globe && fabs(at.y) > POLE)) return;
    b.southern = globe && at.y < 0;
    if (globe) east /= cos(at.y * 3.14159265358979323846 / 180);
    const double size = hypot(east, north);
    if (size > 0) b.to = (struct layer_point){east / size, north / size};
    else b.to.x = 1;
    layer_barb(&b, print, NULL);
}

/* Of barbs along a side: one at least, in its middle. */
static int number_on(double side, double step) { return (int)fmax(1, round(side / step)); }

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct part p[2];
    for (int i = 0; i < 2; i++) load(&o, i, &p[i]);
    const struct grid *g = &p[0].g;
    check_same(&o, g, &p[1].g);
    const bool globe = backdrop_on_globe(g);
    double side[2];
    for (int a = 0; a < 2; a++) side[a] = g->at[a][g->n[a] - 1] - g->at[a][0];
    const double step = fmax(side[0], side[1]) / o.across;
    printf("%s", backdrop_head(g));
    if (o.has_z && !o.flat) printf("> height %.15g\n", o.z);
    const int n[] = {number_on(side[0], step), number_on(side[1], step)};
    for (int j = 0; j < n[1]; j++)
        for (int i = 0; i < n[0]; i++)
            barb(p,
                (struct layer_point){g->at[0][0] + side[0] / 2 + (i - (n[0] - 1) / 2.) * step,
                    g->at[1][0] + side[1] / 2 + (j - (n[1] - 1) / 2.) * step},
                globe, LENGTH * step);
    printf("%s", backdrop_tail(g));
    for (int i = 0; i < 2; i++) {
        free(p[i].level);
        grid_free(&p[i].g);
    }
    close_stdout();
    return ST_OK;
}
