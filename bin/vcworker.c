/* vcworker: ray-casts the tasks it reads. */
#include "base/base.h"
#include "stats/stats.h"
#include "volume/volume.h"
#include "worker/worker.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define FORMAT_VERSION 6 /* raise it when a pixel of any volume changes */

struct options {
    struct volume_options volume;
    struct worker_options worker;
    enum { RUN, INSPECT, COUNT } what; /* -i, -n */
    const char *grid, *const *specs;   /* files; "-": it comes as a record */
    int n_specs;                       /* 1; with -i any number */
    int w, h;                          /* -s: size for -i; 0: the specification's */
    char with[80];                     /* the program and its pixel-changing options, for `with=` */
};

/* A grid or a specification, shared by the generations that use it. */
struct shared {
    struct grid grid;
    struct spec spec;
    uint64_t hash;
    int users;
};

/* The data of the pictures of one generation. */
struct subject {
    struct shared *grid, *spec; /* NULL: not received yet */
    struct volume *volume;      /* built from both when first needed */
};

struct renderer {
    const struct options *o;
    struct subject subjects[GENERATIONS]; /* by generation, modulo GENERATIONS */
    uint32_t latest;                      /* latest generation */
    struct subject *at;                   /* subject of the current frame */
    uint32_t w, h;
};

/* ---- state ---------------------------------------------------------------------------------- */

static void drop_part(struct subject *s, struct shared **part)
{
    volume_free(s->volume);
    s->volume = NULL;
    if (*part && --(*part)->users == 0) {
        grid_free(&(*part)->grid);
        spec_free(&(*part)->spec);
        free(*part);
    }
    *part = NULL;
}

static void drop(void *ctx, uint32_t generation)
{
    struct subject *s = &((struct renderer *)ctx)->subjects[generation % GENERATIONS];
    drop_part(s, &s->grid);
    drop_part(s, &s->spec);
}

/* Frees the replaced grid first, because grids are large. */
static int load_grid(struct subject *s, const char *name, unsigned char *bytes, size_t n, char *err)
{
    drop_part(s, &s->grid);
    struct shared *g = xcalloc(1, sizeof *g);
    *g = (struct shared){.hash = hash64(HASH64_INIT, bytes, n), .users = 1};
    if (grid_consume(name, bytes, n, &g->grid, err) == 0) s->grid = g;
    else free(g);
    return s->grid ? 0 : -1;
}

static int load_spec(
    struct subject *s, const char *name, const unsigned char *text, size_t n, char *err)
{
    drop_part(s, &s->spec);
    struct shared *p = xcalloc(1, sizeof *p);
    *p = (struct shared){.hash = hash64(HASH64_INIT, text, n), .users = 1};
    if (spec_read(name, (const char *)text, n, &p->spec, err) == 0) s->spec = p;
    else free(p);
    return s->spec ? 0 : -1;
}

/* A new generation starts with the state of the previous one. */
static struct subject *subject_of(struct renderer *r, uint32_t generation)
{
    struct subject *s = &r->subjects[generation % GENERATIONS],
                   *before = &r->subjects[(generation - 1) % GENERATIONS];
    if (generation == r->latest) return s;
    r->latest = generation;
    drop(r, generation);
    *s = (struct subject){before->grid, before->spec, NULL};
    if (s->grid) s->grid->users++;
    if (s->spec) s->spec->users++;
    return s;
}

static int take_state(void *ctx, uint32_t generation, enum rec_kind kind, unsigned char *body,
    size_t n, char err[WORKER_ERR])
{
    struct renderer *r = ctx;
    const char *file = kind == REC_GRID ? r->o->grid : kind == REC_SPEC ? *r->o->specs : "";
    if (strcmp(file, "-") != 0) {
        snprintf(err, WORKER_ERR, "record `%s`, expected `grid` or `spec` for an operand -",
            rec_name(kind));
        return -1;
    }
    struct subject *s = subject_of(r, generation);
    return kind == REC_GRID ? load_grid(s, "grid", body, n, err)
                            : load_spec(s, "spec", body, n, err);
}

static int ready(void *ctx, const struct frame_size *f, char err[WORKER_ERR])
{
    struct renderer *r = ctx;
    struct subject *s = r->at = &r->subjects[f->generation % GENERATIONS];
    if (!s->grid || !s->spec) {
        const char *missing = s->grid ? "spec" : "grid";
        snprintf(err, WORKER_ERR, "no %s, expected a `%s` record before the first task", missing,
            missing);
        return -1;
    }
    if (!s->volume) s->volume = volume_new(&s->grid->grid, &s->spec->spec, &r->o->volume);
    volume_frame(s->volume, f->w, f->h);
    r->w = f->w;
    r->h = f->h;
    return 0;
}

static uint64_t job(void *ctx)
{
    struct renderer *r = ctx;
    const struct volume_options *v = &r->o->volume;
    char text[160];
    int n = snprintf(text, sizeof text,
        "vc %d method=%d tolerance=%.17g n=%d grid=%016" PRIx64 " spec=%016" PRIx64, FORMAT_VERSION,
        (int)v->method, v->tolerance, v->n, r->at->grid->hash, r->at->spec->hash);
    const uint32_t size[2] = {r->w, r->h};
    return hash64_u32(hash64(HASH64_INIT, text, (size_t)n), size, 2);
}

static const char *with(void *ctx) { return ((struct renderer *)ctx)->o->with; }

static void render(void *ctx, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    struct renderer *r = ctx;
    volume_pixels(r->at->volume, at, n0, n, rgba);
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
/* Lit pictures are integrated cell by cell, others in streams of rays. */
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

static void selftest(void *ctx, float *rgba, uint32_t *n)
{
    (void)ctx;
    struct grid g;
    char err[ERR_BYTES];
    if (grid_read("selftest", selftest_vtk, sizeof selftest_vtk - 1, &g, err) != 0)
        die(ST_SYSTEM, "%s", err);
    *n = 0;
    for (int i = 0; i < 2; i++) selftest_look(&g, selftest_specs[i], rgba, n);
    grid_free(&g);
}

static const struct worker_ops ops = {
    .program = "vcworker",
    .state = take_state,
    .drop = drop,
    .ready = ready,
    .job = job,
    .with = with,
    .render = render,
    .selftest = selftest,
};

/* ---- options -------------------------------------------------------------------------------- */

static void describe(struct options *o)
{
    char method[VOLUME_METHOD];
    bool usual = volume_method_print(&o->volume, method);
    snprintf(o->with, sizeof o->with, usual ? "vcworker" : "vcworker,-m%s", method);
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-ch] [-f PIXELS] [-m METHOD] [-x sse2|avx2|avx512] [GRID.vtk|- SPEC|-]\n"
        "       vcworker -i [-m METHOD] [-s WxH] GRID.vtk|- SPEC|- ...\n"
        "       vcworker -n [-m METHOD] GRID.vtk|- SPEC|-\n"
        "METHOD: adaptive[:E], doubling[:E], trapezoid:N, gauss:M";
    static const char *const record[] = {"-"};
    struct options o = {
        .volume = VOLUME_OPTIONS_DEFAULT, .grid = "-", .specs = record, .n_specs = 1};
    char err[ERR_BYTES];
    for (int opt; (opt = prog_getopt(argc, argv, "+him:ns:x:" WORKER_OPTIONS)) != -1;) {
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
    describe(&o);
    return o;
}

/* ---- files ---------------------------------------------------------------------------------- */

/* Maps the file's bytes, private and freed page by page. NULL if it cannot be mapped. */
static unsigned char *map_file(const char *path, size_t *n)
{
    struct stat st;
    void *p = MAP_FAILED;
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return NULL;
    if (fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_size > 0) {
        *n = (size_t)st.st_size;
        p = mmap(NULL, *n, PROT_READ, MAP_PRIVATE, fd, 0);
    }
    close(fd);
    return p == MAP_FAILED ? NULL : p;
}

static void open_grid(struct renderer *r)
{
    char err[WORKER_ERR];
    size_t n = 0;
    struct buf bytes = {0};
    unsigned char *map = map_file(r->o->grid, &n);
    if (!map) {
        if (read_file(r->o->grid, &bytes) != 0) die(ST_USAGE, "%s:", r->o->grid);
        n = buf_size(&bytes);
    }
    if (load_grid(r->at, r->o->grid, map ? map : bytes.data, n, err) != 0) die(ST_USAGE, "%s", err);
    if (map) munmap(map, n);
    buf_free(&bytes);
}

static void open_spec(struct renderer *r, const char *path)
{
    char err[WORKER_ERR];
    struct buf b = {0};
    if (read_file(path, &b) != 0) die(ST_USAGE, "%s:", path);
    if (load_spec(r->at, path, buf_data(&b), buf_size(&b), err) != 0) die(ST_USAGE, "%s", err);
    buf_free(&b);
}

/* ---- -i and -n ------------------------------------------------------------------------------ */

static void inspect(struct renderer *r)
{
    for (int i = 0; i < r->o->n_specs; i++) {
        if (i) open_spec(r, r->o->specs[i]);
        r->w = r->o->w ? (uint32_t)r->o->w : r->at->spec->spec.w;
        r->h = r->o->w ? (uint32_t)r->o->h : r->at->spec->spec.h;
        printf("frame %u %u\njob=%016" PRIx64 "\n", r->w, r->h, job(r));
    }
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
static void count(struct renderer *r)
{
    char err[WORKER_ERR];
    float rgba[4];
    const struct frame_size f = {.w = r->at->spec->spec.w, .h = r->at->spec->spec.h};
    const struct lattice all = {0, 0, f.w, f.h, 1, 1};
    uint64_t rays = lattice_count(&all);
    struct sample of[2] = {{xmalloc(rays, sizeof(double)), 0}, {xmalloc(rays, sizeof(double)), 0}};
    struct volume_counts c = {0};
    if (ready(r, &f, err) != 0) die(ST_USAGE, "%s", err);
    for (uint64_t p = 0; p < rays; p++) {
        uint64_t hits = c.hits;
        double start = now_s();
        volume_pixels(r->at->volume, &all, p, 1, rgba);
        double took = now_s() - start;
        volume_counts(r->at->volume, &c);
        struct sample *s = &of[c.hits == hits];
        s->s[s->n++] = took;
    }
    printf("quantity\thit\tmiss\nrays\t%zu\t%zu\n", of[0].n, of[1].n);
    print_times(of);
    printf("cells\t%" PRIu64 "\t-\nsamples\t%" PRIu64 "\t-\nmost_cells\t%u\t-\n", c.cells,
        c.samples, c.most_cells);
    free(of[0].s);
    free(of[1].s);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct renderer r = {.o = &o};
    r.at = r.subjects;
    bool streamed = o.what == RUN, named = strcmp(o.grid, "-") != 0;
    for (int i = 0; i < o.n_specs; i++)
        if (strcmp(o.specs[i], "-") == 0 && !streamed && (!named || i))
            die(ST_USAGE, "-%c: expected GRID.vtk SPEC, one of them at most -",
                o.what == COUNT ? 'n' : 'i');
    if (!streamed || named) open_grid(&r);
    if (!streamed || strcmp(*o.specs, "-") != 0) open_spec(&r, *o.specs);
    int status = ST_OK;
    if (streamed) status = worker_run(&ops, &o.worker, &r);
    else if (o.what == COUNT) count(&r);
    else inspect(&r);
    if (!streamed) close_stdout();
    for (uint32_t i = 0; i < 2; i++) drop(&r, i);
    return status;
}
