/*
 * gridcut: cuts a grid into bricks for hosts with less memory; prints bricks in their order of
 * sight.
 *
 * The bricks of a grid form a lattice. A ray that leaves the eye moves away from it on each axis.
 * So of two bricks on one ray, the nearer one is nowhere farther: the order by the distances from
 * the eye along x, then y, then z is an order of sight.
 */
#include "base/base.h"
#include "grid/grid.h"
#include "image/image.h"
#include "spec/spec.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MIB_MAX 2047 /* a record has less than 2 GiB */

struct options {
    double mib;        /* -m: the most memory of a brick's values; 0: parts is given */
    uint32_t parts[3]; /* -n: bricks along x, y, z */
    const char *out;   /* -o */
    const char *spec;  /* -s: print bricks in order instead */
    char **path;       /* the grid, or the bricks */
    int n;
};

static const char usage_text[] = "[-h] -m MIB|-n X,Y,Z -o PATTERN GRID.vtk\n"
                                 "       gridcut -s SPEC BRICK.vtk ...";

static void take_parts(const char *s, uint32_t parts[3])
{
    size_t n;
    double *number = opt_reals('n', s, 1, GRID_BRICKS_MAX, &n), all = 1;
    for (size_t a = 0; a < 3 && n == 3; a++) {
        parts[a] = (uint32_t)number[a];
        all *= number[a] == floor(number[a]) ? number[a] : HUGE_VAL;
    }
    if (n != 3 || all > GRID_BRICKS_MAX)
        die(ST_USAGE, "-n %s: expected bricks along x, y and z, such as 1,1,4, and %d at most", s,
            GRID_BRICKS_MAX);
    free(number);
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.mib = 0};
    for (int c; (c = prog_getopt(argc, argv, "hm:n:o:s:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 'm': o.mib = opt_real(c, optarg, 1e-6, MIB_MAX); break;
        case 'n': take_parts(optarg, o.parts); break;
        case 'o': o.out = opt_text(c, optarg); break;
        case 's': o.spec = opt_text(c, optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    o.path = argv + optind;
    o.n = argc - optind;
    bool cuts = o.mib > 0 || o.parts[0];
    if (o.n < 1 || (!o.spec && (o.n != 1 || !o.out)) || cuts == (o.spec != NULL) ||
        (o.mib > 0 && o.parts[0]) || (o.spec && o.out))
        usage(ST_USAGE, usage_text);
    if (o.out && image_name_check(o.out) != IMAGE_NAME_NUMBERED)
        die(ST_USAGE, "-o %s: expected one %%d in it, for the number of the brick", o.out);
    return o;
}

/* ---- cutting -------------------------------------------------------------------------------- */

/* The most nodes of a brick along an axis, with the overlap. */
static double nodes_of(const struct grid *g, int a, uint32_t parts)
{
    uint32_t most = (g->n[a] - 2) / parts + 4;
    return most < g->n[a] ? most : g->n[a];
}

/* Cuts the longest edge of the bricks once more until they fit. Of equal edges, the one that varies
 * slowest, so that bricks have long rows. */
static void fit(const struct options *o, const struct grid *g, uint32_t parts[3])
{
    for (;;) {
        double nodes = 1, longest = 0;
        int cut = 2;
        for (int a = 2; a >= 0; a--) {
            double edge = (double)(g->n[a] - 1) / parts[a];
            nodes *= nodes_of(g, a, parts[a]);
            if (edge > longest) longest = edge, cut = a;
        }
        if (nodes * sizeof(float) <= o->mib * 1048576) return;
        if (longest <= 1)
            die(ST_USAGE, "-m %g: a brick of one cell takes %g, expected that at least", o->mib,
                nodes * sizeof(float) / 1048576);
        parts[cut]++;
        if ((uint64_t)parts[0] * parts[1] * parts[2] > GRID_BRICKS_MAX)
            die(ST_USAGE, "-m %g: more than %d bricks, expected more memory for each", o->mib,
                GRID_BRICKS_MAX);
    }
}

static void cut(const struct options *o)
{
    char err[ERR_BYTES];
    input_add(o->path[0], "the grid");
    struct grid_file *f = grid_file_open(o->path[0], err);
    if (!f) die(ST_USAGE, "%s", err);
    const struct grid *g = grid_file_grid(f);
    if (g->brick.is) die(ST_USAGE, "%s: is a brick, expected a whole grid", o->path[0]);
    if (g->n[2] == 1)
        die(ST_USAGE, "%s: has one level, expected several: one level needs no bricks", o->path[0]);
    uint32_t parts[3] = {1, 1, 1};
    if (o->mib > 0) fit(o, g, parts);
    else memcpy(parts, o->parts, sizeof parts);
    for (int a = 0; a < 3; a++)
        if (parts[a] > g->n[a] - 1)
            die(ST_USAGE,
                "-n: %" PRIu32 " bricks along %c, expected %" PRIu32 " at most: a cell each",
                parts[a], "xyz"[a], g -> n[a] - 1);
    uint32_t n = parts[0] * parts[1] * parts[2];
    char **path = xcalloc(n, sizeof *path);
    image_name_keep(o->out, 0, n - 1);
    for (uint32_t i = 0; i < n; i++) path[i] = image_name(o->out, i);
    int status = grid_file_cut(f, parts, path, err);
    if (status != ST_OK) die(status, "%s", err);
    for (uint32_t i = 0; i < n; i++) free(path[i]);
    free(path);
    grid_file_close(f);
}

/* ---- the order of sight --------------------------------------------------------------------- */

struct brick {
    const char *path;
    double whole[3][2], own[3][2], away[3];
};

static struct brick load_brick(const char *path, const struct spec *s)
{
    char err[ERR_BYTES];
    struct brick b = {.path = path};
    struct grid_file *f = grid_file_open(path, err);
    if (!f) die(ST_USAGE, "%s", err);
    const struct grid *g = grid_file_grid(f);
    if (!g->brick.is) die(ST_USAGE, "%s: is no brick, expected one that gridcut wrote", path);
    memcpy(b.whole, g->brick.whole, sizeof b.whole);
    for (int a = 0; a < 3; a++) {
        for (int end = 0; end < 2; end++) b.own[a][end] = g->at[a][g->brick.own[a][end]];
        double x = b.own[a][0] * s->scale[a], y = b.own[a][1] * s->scale[a], eye = s->from[a];
        b.away[a] = fmax(0, fmax(fmin(x, y) - eye, eye - fmax(x, y)));
    }
    grid_file_close(f);
    return b;
}

static int by_sight(const void *a, const void *b)
{
    const double *x = ((const struct brick *)a)->away, *y = ((const struct brick *)b)->away;
    for (int i = 0; i < 3; i++)
        if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
    return 0;
}

static bool overlap(const struct brick *a, const struct brick *b)
{
    for (int i = 0; i < 3; i++)
        if (a->own[i][1] <= b->own[i][0] || b->own[i][1] <= a->own[i][0]) return false;
    return true;
}

/* True if this face of a brick is a face of the whole, or just that of another brick. */
static bool is_joined(const struct brick *all, int n, const struct brick *b, int a, int end)
{
    bool joined = b->own[a][end] == b->whole[a][end];
    for (int k = 0; k < n && !joined; k++) {
        joined = all[k].own[a][!end] == b->own[a][end];
        for (int i = 1; i < 3; i++)
            joined &= memcmp(all[k].own[(a + i) % 3], b->own[(a + i) % 3], sizeof b->own[a]) == 0;
    }
    return joined;
}

/* Bricks that do not overlap, and whose faces all are joined, are a whole lattice. */
static void check_bricks(const struct brick *b, int n)
{
    for (int i = 0; i < n; i++) {
        if (memcmp(b[i].whole, b[0].whole, sizeof b[i].whole) != 0)
            die(ST_USAGE, "%s and %s are of two grids, expected bricks of one", b[0].path,
                b[i].path);
        for (int k = 0; k < i; k++)
            if (overlap(&b[i], &b[k]))
                die(ST_USAGE, "%s and %s have a cell in common, expected bricks of one cut",
                    b[k].path, b[i].path);
    }
    for (int i = 0; i < 6 * n; i++)
        if (!is_joined(b, n, &b[i / 6], i % 3, i % 2))
            die(ST_USAGE, "bricks are missing: %s has none beside it along %c, expected all",
                b[i / 6].path, "xyz"[i % 3]);
}

static void order(const struct options *o)
{
    struct spec s;
    char err[ERR_BYTES];
    if (spec_load(o->spec, &s, err) != 0) die(ST_USAGE, "%s", err);
    struct brick *b = xcalloc((size_t)o->n, sizeof *b);
    for (int i = 0; i < o->n; i++) b[i] = load_brick(o->path[i], &s);
    check_bricks(b, o->n);
    qsort(b, (size_t)o->n, sizeof *b, by_sight);
    for (int i = 0; i < o->n; i++) printf("%s\n", b[i].path);
    free(b);
    spec_free(&s);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (o.spec) order(&o);
    else cut(&o);
    close_stdout();
    return ST_OK;
}
