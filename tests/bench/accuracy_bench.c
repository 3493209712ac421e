/*
 * accuracy_bench: what pictures of the tests' wind cost, and what they are wrong by: seen from
 * above, 500 x 500, by the smooth map, the same of an extinction 20 times as high, or a contour of
 * this many m/s.
 *
 *     reference MAP FILE        a picture that has converged, as raw float RGBA; ends the program
 *                               where marching in long double, at some pixels, sees another
 *     cast MAP FILE METHOD ...  METHOD, CPU ms of a picture, with all that is prepared for it, and
 *                               its RMS error against FILE
 *     compare FILE PICTURE ...  PICTURE, its RMS error against FILE
 *     field FILE                the even field for others: raw float; says its size and step
 *     scene MAP                 from, at, up, angle and size, then the map's knots: for others
 *
 * MAP is `smooth`, `dense` or a width; even:MAP is the field resampled to 64 even levels. METHOD is
 * one of vcworker -m; METHOD/LIMIT ends rays at this opacity, which none does otherwise. Marching
 * (volume_scenes.h) shares no code with what is measured.
 */
#include "../unit/volume_scenes.h"
#include "put_scene.h"

#include <string.h>

#define SIDE 500
#define SAMPLES ((size_t)4 * SIDE * SIDE)
#define EVERY 36 /* pixel of every such row is marched through */
#define REF_SIDE (SIDE / EVERY)
#define REF_VALUES ((size_t)4 * REF_SIDE * REF_SIDE)
#define REF_STEPS 24 /* in each stretch between faces, to find knots by */
#define CONVERGED "adaptive:1e-7"
#define CONVERGED_RMS 2e-6 /* from marching, whose own errors are most of that */
#define LEVELS 64
#define DENSE 20        /* times the smooth map's extinction: most rays end before the grid does */
#define LEAST_US 120000 /* pictures are made until they took this: the fastest counts */
static const struct lattice all = {0, 0, SIDE, SIDE, 1, 1};

/* A view of the wind: what MAP says. `c.s` points into c: not to be copied. */
struct look {
    struct grid g;
    struct scene c;
};

/* The wind at LEVELS levels as far apart as each other. */
static struct grid even_grid(void)
{
    struct grid from = wind_grid(), g = make_grid(from.n[0], from.n[1], LEVELS);
    double top = from.at[2][from.n[2] - 1];
    for (uint32_t k = 0; k < LEVELS; k++) {
        g.at[2][k] = k + 1 < LEVELS ? top * k / (LEVELS - 1) : top;
        for (uint32_t j = 0; j < g.n[1]; j++)
            for (uint32_t i = 0; i < g.n[0]; i++) {
                const double p[3] = {i, j, g.at[2][k]};
                g.value[grid_node(&g, i, j, k)] = (float)grid_at(&from, p);
            }
    }
    free_grid(&from);
    return g;
}

static void look_at(struct look *l, const char *map)
{
    bool even = strncmp(map, "even:", 5) == 0;
    const char *name = even ? map + 5 : map;
    double width;
    l->c = wind_scene(SIDE);
    if (strcmp(name, "smooth") == 0 || strcmp(name, "dense") == 0) smooth_map(&l->c);
    else if (parse_real(name, 1e-6, 1e3, &width)) contour_map(&l->c, width);
    else die(ST_USAGE, "%s: expected smooth, dense or a width, or even: and one of these", map);
    for (size_t i = 0; *name == 'd' && i < l->c.s.n_knots; i++) l->c.knot[i].k *= DENSE;
    l->g = even ? even_grid() : wind_grid();
}

/* What METHOD says; the limit goes to the scene. */
static struct volume_options method_of(struct look *l, const char *name)
{
    struct volume_options o = VOLUME_OPTIONS_DEFAULT;
    char err[ERR_BYTES], method[VOLUME_METHOD] = "";
    size_t n = strcspn(name, "/");
    const char *limit = name[n] ? name + n : NULL;
    if (n < sizeof method) memcpy(method, name, n);
    if (!volume_method_parse(method, &o, err)) die(ST_USAGE, "%s: expected %s", name, err);
    l->c.s.opacity_limit = 1;
    if (limit && !parse_real(limit + 1, 1e-9, 1, &l->c.s.opacity_limit))
        die(ST_USAGE, "%s: expected a limit from 1e-9 to 1", name);
    return o;
}

static void draw(struct look *l, const char *method, const struct lattice *pixels, float *p)
{
    struct volume_options o = method_of(l, method);
    struct volume *v = volume_new(&l->g, &l->c.s, &o);
    volume_frame(v, SIDE, SIDE);
    volume_pixels(v, pixels, 0, pixels->w * pixels->h, p);
    volume_free(v);
}

/* How far METHOD is from what marching sees: the RMS of all channels. */
static double from_marching(struct look *l, const char *method)
{
    static float p[REF_VALUES];
    const struct lattice some = {0, 0, REF_SIDE, REF_SIDE, EVERY, EVERY};
    double sum = 0;
    draw(l, method, &some, p);
    for (uint32_t i = 0; i < REF_SIDE * REF_SIDE; i++) {
        real ref[4];
        ref_pixel(&l->g, &l->c.s, i % REF_SIDE * EVERY, i / REF_SIDE * EVERY, REF_STEPS, ref);
        for (size_t c = 0; c < 4; c++) {
            double e = (double)((real)p[4 * (size_t)i + c] - ref[c]);
            sum += e * e;
        }
    }
    return sqrt(sum / (double)REF_VALUES);
}

/* ---- pictures -------------------------------------------------------------------------------- */

static void write_raw(const char *path, const float *v, size_t n)
{
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(v, sizeof *v, n, f) != n || fclose(f))
        die(ST_SYSTEM, "cannot write %s:", path);
}

/* SAMPLES of them; the caller frees the bytes. */
static const float *read_picture(const char *path, struct buf *b)
{
    if (read_file(path, b) || buf_size(b) != SAMPLES * sizeof(float))
        die(ST_USAGE, "%s: no picture, expected %d x %d of float RGBA", path, SIDE, SIDE);
    return (const float *)(const void *)buf_data(b);
}

static double rms_error(const float *p, const float *ref)
{
    double sum = 0;
    for (size_t i = 0; i < SAMPLES; i++) {
        double e = (double)p[i] - (double)ref[i];
        sum += e * e;
    }
    return sqrt(sum / (double)SAMPLES);
}

static void put_reference(struct look *l, const char *path)
{
    static float p[SAMPLES];
    double rms = from_marching(l, CONVERGED);
    if (!(rms < CONVERGED_RMS))
        die(ST_PARTIAL, "marching differs by %.3g, expected less than %g", rms, CONVERGED_RMS);
    draw(l, CONVERGED, &all, p);
    write_raw(path, p, SAMPLES);
}

static void put_cast(struct look *l, const char *method, const float *ref)
{
    static float p[SAMPLES];
    int64_t best = INT64_MAX, end = cpu_us() + LEAST_US;
    do {
        int64_t begin = cpu_us(), took;
        draw(l, method, &all, p);
        took = cpu_us() - begin;
        best = took < best ? took : best;
    } while (cpu_us() < end);
    printf("%s %.5g %.3g\n", method, (double)best / 1e3, rms_error(p, ref));
}

/* METHODs of a look or, where there is none, pictures of others. */
static void put_casts(struct look *l, const char *path, char *const *word, int n)
{
    struct buf b = {0};
    const float *ref = read_picture(path, &b);
    for (int i = 0; i < n; i++) {
        struct buf p = {0};
        if (l) put_cast(l, word[i], ref);
        else printf("%s %.3g\n", word[i], rms_error(read_picture(word[i], &p), ref));
        buf_free(&p);
    }
    buf_free(&b);
}

/* ---- for others ------------------------------------------------------------------------------ */

static void put_field(const char *path)
{
    struct grid g = even_grid();
    write_raw(path, g.value, (size_t)g.n[0] * g.n[1] * g.n[2]);
    printf("%u %u %u %.17g\n", g.n[0], g.n[1], g.n[2], g.at[2][1]);
    free_grid(&g);
}

int main(int argc, char **argv)
{
    static struct look l;
    prog_init(argv[0]);
    const char *what = argc > 2 ? argv[1] : "";
    bool looks = *what && strcmp(what, "field") != 0 && strcmp(what, "compare") != 0;
    if (looks) look_at(&l, argv[2]);
    if (strcmp(what, "reference") == 0 && argc == 4) put_reference(&l, argv[3]);
    else if (strcmp(what, "cast") == 0 && argc > 4) put_casts(&l, argv[3], argv + 4, argc - 4);
    else if (strcmp(what, "compare") == 0 && argc > 3) put_casts(NULL, argv[2], argv + 3, argc - 3);
    else if (strcmp(what, "field") == 0 && argc == 3) put_field(argv[2]);
    else if (strcmp(what, "scene") == 0 && argc == 3) put_scene(SIDE, &l.c.s);
    else
        usage(ST_USAGE, "reference MAP FILE | cast MAP FILE METHOD ... | "
                        "compare FILE PICTURE ... | field FILE | scene MAP");
    free_grid(&l.g);
    close_stdout();
    return 0;
}
