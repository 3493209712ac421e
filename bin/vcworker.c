/* vcworker: ray-casts the tasks it reads. */
#include "base/base.h"
#include "proc/proc.h"
#include "stats/stats.h"
#include "volume/volume.h"
#include "worker/worker.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define FORMAT_VERSION 10 /* raise it when a pixel of any volume changes */

struct options {
    struct volume_options volume;
    bool transparent; /* -t: without the backgrounds of specifications */
    struct worker_options worker;
    struct worker_words words;         /* the options, for job hashes and `with=` */
    enum { RUN, INSPECT, COUNT } what; /* -i, -n */
    const char *grid, *const *specs;   /* files; "-": it comes as a record */
    int n_specs;                       /* 1; with -i any number */
    int w, h;                          /* -s: size for -i; 0: the specification's */
};

/* ---- the ray caster ------------------------------------------------------------------------- */

enum { GRID, SPEC }; /* the parts of the state */

static int grid_of(
    const void *options, const char *name, unsigned char *bytes, size_t n, void *grid, char *err)
{
    (void)options;
    return grid_consume(name, bytes, n, grid, err);
}

static int spec_of(
    const void *options, const char *name, unsigned char *text, size_t n, void *spec, char *err)
{
    struct spec *s = spec;
    if (spec_read(name, (const char *)text, n, s, err) != 0) return -1;
    if (((const struct options *)options)->transparent) s->backed = false;
    return 0;
}

/* As float; fewer bytes than values are a mistake, which reading names. */
static double grid_needs(const unsigned char *start, size_t n, size_t bytes)
{
    const uint64_t nodes = start ? grid_nodes(start, n) : 0;
    return nodes <= bytes ? (double)nodes * sizeof(float) : 0;
}

static void free_grid(void *grid) { grid_free(grid); }
static void free_spec(void *spec) { spec_free(spec); }

static bool check(void *const value[], char err[WORKER_ERR])
{
    return volume_check(value[GRID], value[SPEC], err);
}

static void *build(const void *options, void *const value[])
{
    return volume_new(value[GRID], value[SPEC], &((const struct options *)options)->volume);
}

static void free_volume(void *v) { volume_free(v); }

static void frame(void *v, uint32_t w, uint32_t h) { volume_frame(v, w, h); }

static void render(void *v, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    volume_pixels(v, at, n0, n, rgba);
}

/* ---- the self-test -------------------------------------------------------------------------- */

/* Uneven planes, a missing corner, a jump, a surface and a light, in one or two milliseconds. */
static const unsigned char selftest_vtk[] =
    "# vtk DataFile Version 3.0\nselftest\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 4 3 3\n"
    "X_COORDINATES 4 float\n-2 -.5 .7 2\nY_COORDINATES 3 float\n1.5 .2 -1.5\n"
    "Z_COORDINATES 3 float\n-1 .1 1\nPOINT_DATA 36\nSCALARS s float 1\nLOOKUP_TABLE default\n"
    "1 3 7 2 4 9 6 1 2 5 3 8\n7 2 .5 6 9 4.5 8 3 1 6 2 7\n3 8 1 5 2 7 4 9 6 1 5 nan\n";
#define SELFTEST_VIEW "from 3 -6 4\nat 0 0 0\nup 0 0 1\nangle 36\nresolution 32 32\n"
#define SELFTEST_MAP "map 1 .1 .2 .9 0\nmap 4 .3 .9 .2 .4\nmap 4 .9 .8 .1 1.5\nmap 9 .9 .1 .1 .2\n"
/* Without and with light, attenuation and a surface. */
static const char *const selftest_specs[] = {SELFTEST_VIEW SELFTEST_MAP,
    SELFTEST_VIEW SELFTEST_MAP "light 2 -5 9\nattenuation .01\niso 6 .8 .8 1 .5\n"};

static void selftest_look(const struct grid *g, const char *text, float *rgba, uint32_t *n)
{
    struct spec s;
    char err[ERR_BYTES];
    const struct volume_options o = VOLUME_OPTIONS_DEFAULT;
    if (spec_read("selftest", text, strlen(text), &s, err) != 0) die(ST_SYSTEM, "%s", err);
    struct volume *v = volume_new(g, &s, &o);
    volume_frame(v, s.w, s.h);
    const struct lattice all = {0, 0, s.w, s.h, 1, 1};
    volume_pixels(v, &all, 0, s.w * s.h, rgba + 4 * (size_t)*n);
    *n += s.w * s.h;
    volume_free(v);
    spec_free(&s);
}

static void selftest(float *rgba, uint32_t *n)
{
    struct grid g;
    char err[ERR_BYTES];
    if (grid_read("selftest", selftest_vtk, sizeof selftest_vtk - 1, &g, err) != 0)
        die(ST_SYSTEM, "%s", err);
    *n = 0;
    for (int i = 0; i < 2; i++) selftest_look(&g, selftest_specs[i], rgba, n);
    grid_free(&g);
}

static const struct worker_renderer renderer = {
    .program = "vcworker",
    .part = {[GRID] = {REC_GRID, false, sizeof(struct grid), grid_of, free_grid, grid_needs},
        [SPEC] = {REC_SPEC, false, sizeof(struct spec), spec_of, free_spec, NULL}},
    .n_parts = 2,
    .check = check,
    .build = build,
    .free = free_volume,
    .frame = frame,
    .render = render,
    .selftest = selftest,
};

/* ---- options -------------------------------------------------------------------------------- */

static void describe(struct options *o)
{
    const struct volume_options *v = &o->volume;
    struct worker_words *w = &o->words;
    char method[VOLUME_METHOD];
    bool usual = volume_method_print(v, method);
    snprintf(w->with, sizeof w->with, usual ? "vcworker" : "vcworker,-m%s", method);
    snprintf(w->job, sizeof w->job, "vc %d method=%d tolerance=%.17g n=%d%s", FORMAT_VERSION,
        (int)v->method, v->tolerance, v->n, o->transparent ? " transparent" : "");
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-cht] [-f PIXELS] [-j SLOTS] [-m METHOD] [-x sse2|avx2|avx512]\n"
        "                [GRID.vtk|- SPEC|-]\n"
        "       vcworker -i [-t] [-m METHOD] [-s WxH] GRID.vtk|- SPEC|- ...\n"
        "       vcworker -n [-m METHOD] GRID.vtk|- SPEC|-\n"
        "METHOD: adaptive[:E], doubling[:E], trapezoid:N, gauss:M";
    static const char *const record[] = {"-"};
    struct options o = {
        .volume = VOLUME_OPTIONS_DEFAULT, .grid = "-", .specs = record, .n_specs = 1};
    char err[ERR_BYTES];
    for (int opt; (opt = prog_getopt(argc, argv, "+hij:m:ns:tx:" WORKER_OPTIONS)) != -1;) {
        switch (opt) {
        case 'h': usage(ST_OK, text);
        case 'i':
        case 'n':
            if (o.what != RUN) die(ST_USAGE, "-%c: expected one of -i and -n, once", opt);
            o.what = opt == 'i' ? INSPECT : COUNT;
            break;
        case 'm':
            if (!volume_method_parse(optarg, &o.volume, err))
                die(ST_USAGE, "-m %s: expected %s", optarg, err);
            break;
        case 's': opt_size(opt, optarg, FRAME_SIDE_MAX, &o.w, &o.h); break;
        case 't': o.transparent = true; break;
        case 'x': o.volume.isa = opt_isa(opt, optarg); break;
        default:
            if (!worker_option(&o.worker, opt, optarg)) usage(ST_USAGE, text);
        }
    }
    if (argc - optind != 2 && argc != optind && (o.what != INSPECT || argc - optind < 2))
        usage(ST_USAGE, text);
    if (o.w && o.what != INSPECT) die(ST_USAGE, "-s: expected -i with it");
    if (argc != optind) {
        o.grid = argv[optind];
        o.specs = (const char *const *)argv + optind + 1;
        o.n_specs = argc - optind - 1;
    }
    if (o.worker.jobs > 1) {
        int cores = cores_available();
        o.volume.threads = o.worker.jobs < cores ? o.worker.jobs : cores;
    }
    describe(&o);
    return o;
}

/* ---- -i and -n ------------------------------------------------------------------------------ */

#define COVERED .99 /* of the grid, from which the rest does not matter */

/* A ground that is not below all of the grid may be that of another place. */
static void check_ground(const struct options *o, const struct grid *g)
{
    const double share = grid_over_ground(g);
    if (share < COVERED)
        warn("%s: the ground is below %.2g %% of the grid: x %g to %g and y %g to %g below x %g to "
             "%g and y %g to %g",
            o->grid, 100 * share, g->ground->at[0][0], g->ground->at[0][g->ground->n[0] - 1],
            g->ground->at[1][0], g->ground->at[1][g->ground->n[1] - 1], g->at[0][0],
            g->at[0][g->n[0] - 1], g->at[1][0], g->at[1][g->n[1] - 1]);
}

static void inspect(struct worker_states *s, const struct options *o)
{
    char err[ERR_BYTES];
    bool checked = false;
    for (int i = 0; i < o->n_specs; i++) {
        if (i) worker_states_load(s, SPEC, o->specs[i]);
        const struct spec *spec = worker_states_value(s, SPEC);
        if (!volume_check(worker_states_value(s, GRID), spec, err))
            die(ST_USAGE, "%s: %s", o->specs[i], err);
        if (spec->n_grounds && !checked) check_ground(o, worker_states_value(s, GRID));
        checked = checked || spec->n_grounds;
        uint32_t w = o->w ? (uint32_t)o->w : spec->w, h = o->w ? (uint32_t)o->h : spec->h;
        char job[WIRE_JOB];
        worker_states_job(s, w, h, job);
        printf("frame %u %u\njob=%s\n", w, h, job);
    }
    close_stdout();
}

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Times in seconds of rays that hit the grid, or of rays that miss it. */
struct sample {
    double *s;
    size_t n;
};

static void print_time(const char *name, const double v[2], const struct sample of[2])
{
    printf("%s", name);
    for (int i = 0; i < 2; i++)
        if (of[i].n) printf("\t%.9f", v[i]);
        else printf("\t-");
    printf("\n");
}

static void print_times(const struct sample of[2])
{
    double v[5][2] = {{0}};
    static const char *const names[] = {"min_s", "max_s", "median_s", "mean_s", "sd_s"};
    for (int i = 0; i < 2; i++) {
        if (!of[i].n) continue;
        v[2][i] = stats_median(of[i].s, of[i].n); /* sorts, so first and last are the extremes */
        double first = of[i].s[0], last = of[i].s[of[i].n - 1];
        v[0][i] = fmin(first, last);
        v[1][i] = fmax(first, last);
        v[3][i] = stats_mean(of[i].s, of[i].n);
        v[4][i] = sqrt(stats_variance(of[i].s, of[i].n));
    }
    for (int k = 0; k < 5; k++) print_time(names[k], v[k], of);
}

/* Prints Table 1 of the StormView paper for the specification's frame, ray by ray. */
static void count(struct worker_states *s)
{
    float rgba[4];
    const struct spec *spec = worker_states_value(s, SPEC);
    const struct lattice all = {0, 0, spec->w, spec->h, 1, 1};
    uint64_t rays = lattice_count(&all);
    struct sample of[2] = {{xmalloc(rays, sizeof(double)), 0}, {xmalloc(rays, sizeof(double)), 0}};
    struct volume_counts c = {0};
    struct volume *v = worker_states_built(s, spec->w, spec->h);
    for (uint64_t p = 0; p < rays; p++) {
        uint64_t hits = c.hits;
        double start = now_s();
        volume_pixels(v, &all, p, 1, rgba);
        double took = now_s() - start;
        volume_counts(v, &c);
        struct sample *t = &of[c.hits == hits];
        t->s[t->n++] = took;
    }
    printf("quantity\thit\tmiss\nrays\t%zu\t%zu\n", of[0].n, of[1].n);
    print_times(of);
    printf("cells\t%" PRIu64 "\t-\nsamples\t%" PRIu64 "\t-\nmost_cells\t%u\t-\n", c.cells,
        c.samples, c.most_cells);
    free(of[0].s);
    free(of[1].s);
    close_stdout();
}

/* One of the files of -i and -n may be standard input: the grid or the first specification. */
static void check_files(const struct options *o)
{
    bool used = strcmp(o->grid, "-") == 0;
    for (int i = 0; i < o->n_specs; i++)
        if (strcmp(o->specs[i], "-") == 0 && (used || i))
            die(ST_USAGE, "-%c: expected GRID.vtk SPEC, one of them at most -",
                o->what == COUNT ? 'n' : 'i');
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    if (o.what != RUN) check_files(&o);
    struct worker_states *s = worker_states_new(&renderer, &o, &o.words);
    if (o.what != RUN || strcmp(o.grid, "-") != 0) worker_states_load(s, GRID, o.grid);
    if (o.what != RUN || strcmp(*o.specs, "-") != 0) worker_states_load(s, SPEC, *o.specs);
    int status = ST_OK;
    if (o.what == RUN) status = worker_render(s, &o.worker);
    else if (o.what == COUNT) count(s);
    else inspect(s, &o);
    worker_states_free(s);
    return status;
}
