/*
 * volume_bench: the wind of the tests, seen 500 x 500, by a smooth map or a contour .5 m/s wide.
 *
 *     field FILE       resampled to 121x97x64 evenly spaced values, raw float; says its size
 *     map MAP          the view, then the knots, as text; MAP is smooth or contour
 *     time MAP         CPU us of one picture, its RMS error, counts, peak memory in KiB
 *     error MAP FILE   RMS error of another's picture of that field: raw float RGBA, rows from
 *                      the bottom
 *
 * Errors are against the same field's picture at a tolerance of 1e-7.
 */
#include "../unit/volume_scenes.h"

#include <sys/resource.h>

#define SIDE 500
#define LEVELS 64
#define TIMES 3 /* pictures: the fastest counts */

static struct scene scene_of(const char *map)
{
    struct scene c = wind_scene(SIDE);
    c.s.opacity_limit = 0.999;
    if (*map == 's') smooth_map(&c);
    else contour_map(&c, 0.5);
    return c;
}

static struct grid even_grid(void)
{
    struct grid from = wind_grid(), g = make_grid(121, 97, LEVELS);
    for (uint32_t k = 0; k < LEVELS; k++) {
        double z = from.at[2][17] * k / (LEVELS - 1);
        uint32_t low = 0;
        while (low < 16 && from.at[2][low + 1] <= z) low++;
        double w = (z - from.at[2][low]) / (from.at[2][low + 1] - from.at[2][low]);
        g.at[2][k] = z;
        for (uint32_t j = 0; j < 97; j++)
            for (uint32_t i = 0; i < 121; i++) {
                double a = (double)from.value[grid_node(&from, i, j, low)];
                double b = (double)from.value[grid_node(&from, i, j, low + 1)];
                g.value[grid_node(&g, i, j, k)] = (float)(a + (b - a) * w);
            }
    }
    free_grid(&from);
    return g;
}

static double rms(const float *a, const float *b)
{
    double sum = 0;
    for (size_t i = 0; i < (size_t)4 * SIDE * SIDE; i++) {
        double e = (double)a[i] - (double)b[i];
        sum += e * e;
    }
    return sqrt(sum / (4.0 * SIDE * SIDE));
}

static float *converged(const struct grid *g, struct scene *c)
{
    struct volume_options o = {VOLUME_ADAPTIVE, 1e-7, 0, ISA_AUTO};
    float *p = xmalloc((size_t)4 * SIDE * SIDE, sizeof *p);
    double limit = c->s.opacity_limit;
    c->s.knot = c->knot;
    c->s.opacity_limit = 1;
    render(g, &c->s, &o, p, NULL);
    c->s.opacity_limit = limit;
    return p;
}

/* The most memory that the process has had. */
static long peak_kib(void)
{
    struct rusage u;
    getrusage(RUSAGE_SELF, &u);
    return u.ru_maxrss;
}

static void put_time(const char *map)
{
    long before = peak_kib();
    struct grid g = wind_grid();
    struct scene c = scene_of(map);
    struct volume_options o = VOLUME_OPTIONS_DEFAULT;
    struct volume_counts n;
    float *p = xmalloc((size_t)4 * SIDE * SIDE, sizeof *p);
    int64_t best = INT64_MAX;
    c.s.knot = c.knot;
    for (int i = 0; i < TIMES; i++) {
        int64_t begin = cpu_us();
        render(&g, &c.s, &o, p, &n);
        int64_t took = cpu_us() - begin;
        best = took < best ? took : best;
    }
    long grown = peak_kib() - before;
    float *r = converged(&g, &c);
    printf("%lld %.3g %llu %llu %llu %llu %ld\n", (long long)best, rms(p, r),
        (unsigned long long)n.rays, (unsigned long long)n.hits, (unsigned long long)n.cells,
        (unsigned long long)n.samples, grown);
    free(r);
    free(p);
    free_grid(&g);
}

static void put_map(const char *map)
{
    struct scene c = scene_of(map);
    const struct spec *s = &c.s;
    const double *const triple[] = {s->from, s->at, s->up};
    for (int i = 0; i < 3; i++)
        printf("%.17g %.17g %.17g\n", triple[i][0], triple[i][1], triple[i][2]);
    printf("%.17g %d\n", s->angle, SIDE);
    for (size_t i = 0; i < s->n_knots; i++) {
        const struct spec_knot *k = &c.knot[i];
        printf("%.17g %.17g %.17g %.17g %.17g\n", k->s, k->rgb[0], k->rgb[1], k->rgb[2], k->k);
    }
}

static void put_field(const char *path)
{
    struct grid g = even_grid();
    FILE *f = fopen(path, "wb");
    size_t n = (size_t)g.n[0] * g.n[1] * g.n[2];
    if (!f || fwrite(g.value, sizeof *g.value, n, f) != n || fclose(f))
        die(ST_SYSTEM, "cannot write %s:", path);
    printf("%u %u %u %.17g\n", g.n[0], g.n[1], g.n[2], g.at[2][1]);
    free_grid(&g);
}

static void put_error(const char *map, const char *path)
{
    struct buf b = {0};
    struct grid g = even_grid();
    struct scene c = scene_of(map);
    float *r = converged(&g, &c), *p = xmalloc((size_t)4 * SIDE * SIDE, sizeof *p);
    if (read_file(path, &b) || buf_size(&b) != (size_t)16 * SIDE * SIDE)
        die(ST_USAGE, "%s: no picture", path);
    const float *from = (const float *)(const void *)buf_data(&b);
    for (size_t y = 0; y < SIDE; y++)
        for (size_t x = 0; x < 4 * SIDE; x++)
            p[y * 4 * SIDE + x] = from[(SIDE - 1 - y) * 4 * SIDE + x];
    printf("%.3g\n", rms(p, r));
    buf_free(&b);
    free(r);
    free(p);
    free_grid(&g);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    const char *what = argc > 1 ? argv[1] : "";
    if (argc == 3 && *what == 'f') put_field(argv[2]);
    else if (argc == 3 && *what == 'm') put_map(argv[2]);
    else if (argc == 3 && *what == 't') put_time(argv[2]);
    else if (argc == 4 && *what == 'e') put_error(argv[2], argv[3]);
    else usage(ST_USAGE, "field FILE | map MAP | time MAP | error MAP FILE");
    close_stdout();
    return 0;
}
