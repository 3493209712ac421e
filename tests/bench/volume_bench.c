/*
 * volume_bench: what pictures of fields cost that no test knows, 500 x 500 seen from above.
 *
 *     cast GRID LOOK METHOD   CPU ms of a picture, with all that is prepared for it
 *     field GRID FILE         the field for others: raw float; says its size and step
 *     scene GRID LOOK         from, at, up, angle and size, then the map's knots: for others
 *
 * GRID is FIELD:NXxNYxNZ: `smooth`, `noisy` (the same with noise at each node) or `sparse` (six
 * balls). LOOK is a map (`smooth`, `dense`, `none`, which shows nothing, or the width of a contour)
 * and any of +light, +fog and +iso, which stands for two surfaces.
 */
#include "../unit/volume_scenes.h"
#include "put_scene.h"

#include <string.h>

#define SIDE 500
#define LEAST_US 120000 /* pictures are made until they took this: the fastest counts */

/* ---- fields: x, y and z from 0, in parts of the grid's longest side ------------------------- */

static double smooth(double x, double y, double z)
{
    double a = (y - .45 - .1 * sin(8 * x)) / .12, b = (x - .6 - .07 * sin(9 * y)) / .1;
    double high = (z - .3) / .15, low = (z - .15) / .1;
    double waves = 6 * sin(11 * x) * cos(9 * y) + 4 * cos(7 * z + 3 * x);
    return 10 + waves + 50 * exp(-a * a - high * high) + 40 * exp(-b * b - low * low);
}
static double sparse(double x, double y, double z)
{
    double s = 0;
    for (uint64_t i = 0; i < 6; i++) {
        double a = x - rng_unit(5, 3 * i), b = y - rng_unit(5, 3 * i + 1);
        double c = z - rng_unit(5, 3 * i + 2) / 2;
        s += 70 * exp(-(a * a + b * b + c * c) / .003);
    }
    return s;
}
static double field_at(char kind, uint64_t node, double x, double y, double z)
{
    double noise = kind == 'n' ? 3 * (rng_unit(1, node) - .5) : 0;
    return kind == 'e' ? sparse(x, y, z) : smooth(x, y, z) + noise;
}

/* A number from 2 on, and what follows it. */
static uint32_t size_of(const char **s)
{
    uint32_t n = 0;
    while (**s >= '0' && **s <= '9' && n < 10000) n = 10 * n + (uint32_t)(*(*s)++ - '0');
    if (**s == 'x') (*s)++;
    return n;
}

static struct grid grid_of(const char *name)
{
    static const char *const kinds[] = {"smooth:", "noisy:", "sparse:"};
    const char *size = strchr(name, ':');
    size_t kind = 0, at = 0;
    while (kind < 3 && strncmp(name, kinds[kind], strlen(kinds[kind])) != 0) kind++;
    if (!size || kind == 3) die(ST_USAGE, "%s: expected smooth:, noisy: or sparse:", name);
    size++;
    uint32_t nx = size_of(&size), ny = size_of(&size), nz = size_of(&size);
    if (*size || nx < 2 || ny < 2 || nz < 2) die(ST_USAGE, "%s: expected FIELD:NXxNYxNZ", name);
    struct grid g = make_grid(nx, ny, nz);
    uint32_t most = nx > ny ? nx : ny;
    double unit = 1.0 / ((most > nz ? most : nz) - 1);
    for (uint32_t k = 0; k < nz; k++)
        for (uint32_t j = 0; j < ny; j++)
            for (uint32_t i = 0; i < nx; i++, at++)
                g.value[at] = (float)field_at("sne"[kind], at, i * unit, j * unit, k * unit);
    return g;
}

/* The extinction is that of the same picture at every size of the grid. */
static void look_at(struct scene *c, const struct grid *g, const char *look)
{
    const double side = g->n[0] - 1;
    const double from[3] = {-.1 * side, -.9 * side, 1.1 * side};
    const double at[3] = {.5 * side, .45 * side, .2 * side};
    char map[16] = "";
    double width, dense = strncmp(look, "dense", 5) == 0 ? 20 : 1;
    size_t n = strcspn(look, "+");
    if (n < sizeof map) memcpy(map, look, n);
    *c = make_scene(from, at);
    c->s.angle = 36, c->s.w = c->s.h = SIDE, c->s.opacity_limit = .9999;
    if (strcmp(map, "smooth") == 0 || strcmp(map, "dense") == 0) smooth_map(c);
    else if (strcmp(map, "none") == 0) knot(c, 2000, 1, 1, 1, 1), knot(c, 2001, 1, 1, 1, 1);
    else if (parse_real(map, 1e-6, 1e3, &width)) contour_map(c, width);
    else die(ST_USAGE, "%s: expected smooth, dense, none or a width", look);
    for (size_t i = 0; i < c->s.n_knots; i++) c->knot[i].k *= dense * 120 / side;
    if (strstr(look, "+iso")) iso(c, 40, 1, 1, 1, .5), iso(c, 25, 1, .3, .1, .3);
    if (strstr(look, "+fog")) c->s.attenuation = .6 / side;
    c->s.lit = strstr(look, "+light") != NULL;
    c->s.light[0] = -.2 * side, c->s.light[1] = -.4 * side, c->s.light[2] = 1.7 * side;
}

/* ---- what is printed ------------------------------------------------------------------------- */

static void put_cast(const struct grid *g, const struct spec *s, const char *method)
{
    static float p[4 * SIDE * SIDE];
    struct volume_options o = VOLUME_OPTIONS_DEFAULT;
    char err[ERR_BYTES];
    if (!volume_method_parse(method, &o, err)) die(ST_USAGE, "%s: expected %s", method, err);
    int64_t best = INT64_MAX, end = cpu_us() + LEAST_US;
    do {
        int64_t begin = cpu_us(), took;
        render(g, s, &o, p, NULL);
        took = cpu_us() - begin;
        best = took < best ? took : best;
    } while (cpu_us() < end);
    printf("%.5g\n", (double)best / 1e3);
}

static void put_field(const struct grid *g, const char *path)
{
    size_t n = (size_t)g->n[0] * g->n[1] * g->n[2];
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(g->value, sizeof *g->value, n, f) != n || fclose(f))
        die(ST_SYSTEM, "cannot write %s:", path);
    printf("%u %u %u 1\n", g->n[0], g->n[1], g->n[2]);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    const char *what = argc > 3 ? argv[1] : "";
    bool cast = strcmp(what, "cast") == 0 && argc == 5;
    if (!cast && !((strcmp(what, "field") == 0 || strcmp(what, "scene") == 0) && argc == 4))
        usage(ST_USAGE, "cast GRID LOOK METHOD | field GRID FILE | scene GRID LOOK");
    struct grid g = grid_of(argv[2]);
    struct scene c = {0};
    if (*what != 'f') look_at(&c, &g, argv[3]);
    c.s.knot = c.knot, c.s.iso = c.iso;
    if (cast) put_cast(&g, &c.s, argv[4]);
    else if (*what == 's') put_scene(SIDE, &c.s);
    else put_field(&g, argv[3]);
    free_grid(&g);
    close_stdout();
    return 0;
}
