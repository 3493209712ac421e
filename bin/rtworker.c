/* rtworker: ray-traces the tasks it reads. */
#include "base/base.h"
#include "proc/proc.h"
#include "scene/scene.h"
#include "trace/trace.h"
#include "worker/worker.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SCENE_TIMES 1.5  /* memory of a scene, by the bytes of its text: 2.4 to 7 in SPD's */
#define FORMAT_VERSION 9 /* raise it when a pixel of any scene changes */

struct options {
    struct trace_options trace;
    struct worker_options worker;
    struct worker_words words;         /* the options, for job hashes and `with=` */
    enum { RUN, INSPECT, COUNT } what; /* -i, -n */
    int w, h;                          /* -s: size of the frame of -i or -n; 0: the view's */
    const char *path;                  /* scene file; "-": the scene comes as a record */
    char *const *views;                /* files; none: views may come as records */
    int n_views;                       /* 0 or 1; with -i any number */
};

/* ---- the ray tracer ------------------------------------------------------------------------- */

enum { SCENE, VIEW }; /* the parts of the state */

/* All views of a scene share its tracer. */
struct held {
    struct scene scene;
    struct tracer *tracer; /* NULL: not needed yet */
};

static int scene_of(
    const void *options, const char *name, unsigned char *text, size_t n, void *held, char *err)
{
    const struct trace_options *o = options;
    struct held *h = held;
    return nff_read_parallel(name, (const char *)text, n, o->threads, &h->scene, err);
}

static int view_of(
    const void *options, const char *name, unsigned char *text, size_t n, void *view, char *err)
{
    (void)options;
    return nff_read_view(name, (const char *)text, n, view, err);
}

/* The primitives and the hierarchy over them, of the scene that takes least for its text. */
static double scene_needs(const unsigned char *start, size_t n, size_t bytes)
{
    (void)start, (void)n;
    return (double)bytes * SCENE_TIMES;
}

static void free_scene(void *held)
{
    struct held *h = held;
    tracer_free(h->tracer);
    scene_free(&h->scene);
}

static void free_view(void *view) { (void)view; }

/* A scene as it is seen. */
struct sight {
    struct tracer *tracer;
    const struct view *view; /* NULL: the scene's */
};

static void *build(const void *options, void *const value[])
{
    struct held *h = value[SCENE];
    struct sight *s = xmalloc(1, sizeof *s);
    if (!h->tracer) h->tracer = tracer_new(&h->scene, options);
    *s = (struct sight){h->tracer, value[VIEW]};
    return s;
}

static void frame(void *sight, uint32_t w, uint32_t h)
{
    const struct sight *s = sight;
    tracer_look(s->tracer, s->view);
    tracer_frame(s->tracer, w, h);
}

static void render(void *sight, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    tracer_pixels(((struct sight *)sight)->tracer, at, n0, n, rgba);
}

/* A mirror, glass and a shadow; every primitive is added. Small enough to render in one or two
 * milliseconds. */
static const char selftest_nff[] =
    "b .1 .3 .7\nv from 3 4 5 at 0 0 .4 up 0 0 1 angle 40 hither 0 resolution 32 32\n"
    "l 5 3 9\nl -4 6 5 .5 .6 .7\nf .2 .9 .3 .2 .1 10 .7 1.3\ns 1.2 1 .6 .6\n";

static void selftest(float *rgba, uint32_t *n)
{
    struct buf text = {0};
    struct scene s;
    char err[SCENE_ERR];
    buf_printf(&text, "%s", selftest_nff);
    for (int i = 0; i < PRIM_KINDS; i++) buf_printf(&text, "%s", scene_sample((enum prim_kind)i));
    if (nff_read("selftest", (const char *)buf_data(&text), buf_size(&text), &s, err) != 0)
        die(ST_SYSTEM, "%s", err);
    buf_free(&text);
    const struct trace_options o = TRACE_OPTIONS_DEFAULT;
    struct tracer *t = tracer_new(&s, &o);
    tracer_frame(t, 32, 32);
    const struct lattice all = {0, 0, 32, 32, 1, 1};
    *n = 32 * 32;
    tracer_pixels(t, &all, 0, *n, rgba);
    tracer_free(t);
    scene_free(&s);
}

static const struct worker_renderer renderer = {
    .program = "rtworker",
    .part = {[SCENE] = {REC_SCENE, false, sizeof(struct held), scene_of, free_scene, scene_needs},
        [VIEW] = {REC_VIEW, true, sizeof(struct view), view_of, free_view, NULL}},
    .n_parts = 2,
    .build = build,
    .free = free,
    .frame = frame,
    .render = render,
    .selftest = selftest,
};

/* ---- options -------------------------------------------------------------------------------- */

static void parse_sampling(const char *s, struct trace_options *t)
{
    char text[32];
    const char *colon = strchr(s, ':');
    size_t n = colon ? (size_t)(colon - s) : strlen(s);
    int64_t samples = 0;
    if (n < sizeof text) {
        memcpy(text, s, n);
        text[n] = '\0';
        if (!parse_int(text, 1, TRACE_SAMPLES_MAX, &samples)) samples = 0;
    }
    int64_t side = (int64_t)sqrt((double)samples);
    if (!samples || side * side != samples)
        die(ST_USAGE, "-a %s: expected a square number of samples up to %d", s, TRACE_SAMPLES_MAX);
    t->samples = (int)samples;
    t->threshold = -1;
    if (colon && !parse_real(colon + 1, 0, 1e6, &t->threshold))
        die(ST_USAGE, "-a %s: expected N:THRESHOLD, a number from 0 to 1000000", s);
}

static void parse_hierarchy(const char *s, struct trace_options *t)
{
    static const char *const name[] = {"bvh", "slabs", "none"};
    for (int i = 0; i < 3; i++)
        if (strcmp(s, name[i]) == 0) {
            t->hierarchy = (enum trace_hierarchy)i;
            return;
        }
    die(ST_USAGE, "-b %s: expected bvh, slabs or none", s);
}

static void describe(struct options *o)
{
    const struct trace_options usual = TRACE_OPTIONS_DEFAULT, *t = &o->trace;
    struct worker_words *s = &o->words;
    snprintf(s->job, sizeof s->job, "rt %d depth=%d samples=%d threshold=%.17g budget=%.17g",
        FORMAT_VERSION, t->depth, t->samples, t->threshold, t->budget);
    size_t n = (size_t)snprintf(s->with, sizeof s->with, "rtworker");
    if (t->samples != usual.samples || t->threshold >= 0)
        n += (size_t)snprintf(s->with + n, sizeof s->with - n, ",-a%d", t->samples);
    if (t->threshold >= 0) {
        char text[32];
        print_real(text, t->threshold, 6);
        n += (size_t)snprintf(s->with + n, sizeof s->with - n, ":%s", text);
    }
    if (t->depth != usual.depth)
        n += (size_t)snprintf(s->with + n, sizeof s->with - n, ",-d%d", t->depth);
    if (t->budget != usual.budget) {
        char text[32];
        print_real(text, t->budget, 6);
        snprintf(s->with + n, sizeof s->with - n, ",-w%s", text);
    }
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-ch] [-a SAMPLES[:THRESHOLD]] [-b bvh|slabs|none] [-d DEPTH] [-f PIXELS]\n"
        "           [-j SLOTS] [-w BOUND] [-x sse2|avx2|avx512] [SCENE.nff|- [VIEW]]\n"
        "       rtworker -i [-a SAMPLES[:THRESHOLD]] [-d DEPTH] [-s WxH] [-w BOUND]\n"
        "                [SCENE.nff|- [VIEW ...]]\n"
        "       rtworker -n [-b bvh|slabs|none] [-d DEPTH] [-s WxH] [-x sse2|avx2|avx512]\n"
        "                [SCENE.nff|- [VIEW]]";
    struct options o = {.trace = TRACE_OPTIONS_DEFAULT, .path = "-"};
    int opt;
    while ((opt = prog_getopt(argc, argv, "+a:b:d:hij:ns:w:x:" WORKER_OPTIONS)) != -1) {
        switch (opt) {
        case 'a': parse_sampling(optarg, &o.trace); break;
        case 'b': parse_hierarchy(optarg, &o.trace); break;
        case 'd': o.trace.depth = (int)opt_int(opt, optarg, 1, TRACE_DEPTH_MAX); break;
        case 'h': usage(ST_OK, text);
        case 'i':
        case 'n':
            if (o.what != RUN) die(ST_USAGE, "-%c: expected one of -i and -n, once", opt);
            o.what = opt == 'i' ? INSPECT : COUNT;
            break;
        case 's': opt_size(opt, optarg, FRAME_SIDE_MAX, &o.w, &o.h); break;
        case 'w': o.trace.budget = opt_real(opt, optarg, 0, 1); break;
        case 'x': o.trace.isa = opt_isa(opt, optarg); break;
        default:
            if (!worker_option(&o.worker, opt, optarg)) usage(ST_USAGE, text);
        }
    }
    if (argc - optind > 2 && o.what != INSPECT) usage(ST_USAGE, text);
    if (o.w && o.what == RUN) die(ST_USAGE, "-s: expected -i or -n with it");
    const struct trace_options usual = TRACE_OPTIONS_DEFAULT;
    if (o.what == COUNT && (o.trace.samples != usual.samples || o.trace.budget != usual.budget))
        die(ST_USAGE, "-n: expected no -a or -w with it");
    /* -i checks a scene before a run that will use all processors. */
    int jobs = o.what == INSPECT ? WORKER_JOBS_MOST : o.worker.jobs;
    if (jobs > 1) {
        int cores = cores_available();
        o.trace.threads = jobs < cores ? jobs : cores;
    }
    if (optind < argc) o.path = argv[optind++];
    o.views = argv + optind;
    o.n_views = argc - optind;
    for (int i = 0; i < o.n_views; i++)
        if (strcmp(o.views[i], "-") == 0) die(ST_USAGE, "-: expected a view in a file");
    describe(&o);
    return o;
}

/* The size of the frame of -i or -n. */
static struct frame_size size_of(const struct worker_states *s, const struct options *o)
{
    const struct held *held = worker_states_value(s, SCENE);
    const struct view *v = worker_states_value(s, VIEW);
    if (o->w) return (struct frame_size){.w = (uint32_t)o->w, .h = (uint32_t)o->h};
    if (!v || !v->res_x) v = &held->scene.view;
    return (struct frame_size){.w = v->res_x, .h = v->res_y};
}

static void inspect(struct worker_states *s, const struct options *o)
{
    for (int i = 0; i < o->n_views || !i; i++) {
        if (i) worker_states_load(s, VIEW, o->views[i]);
        const struct frame_size f = size_of(s, o);
        char job[WIRE_JOB];
        worker_states_job(s, f.w, f.h, job);
        printf("frame %u %u\njob=%s\n", f.w, f.h, job);
    }
    close_stdout();
}

/* Rays by SPD's procedure, through each corner of the pixels, without leaving out any; and the
 * tests of these rays. */
static void count(const struct worker_states *s, const struct options *o)
{
    static const char *const name[RAY_KINDS] = {"eye", "reflected", "refracted", "shadow"};
    struct trace_options all = o->trace;
    all.budget = 0;
    all.by_spd = all.count_tests = true;
    const struct held *held = worker_states_value(s, SCENE);
    const struct frame_size f = size_of(s, o);
    struct tracer *t = tracer_new(&held->scene, &all);
    tracer_look(t, worker_states_value(s, VIEW));
    tracer_frame(t, f.w, f.h);
    tracer_corners(t);
    struct trace_counts rays;
    struct trace_tests tests;
    tracer_counts(t, &rays);
    tracer_tests(t, &tests);
    tracer_free(t);
    printf("quantity\tvalue\nrays\t%" PRIu64 "\n", tests.rays);
    for (int k = 0; k < RAY_KINDS; k++)
        printf("%s_rays\t%" PRIu64 "\n%s_hits\t%" PRIu64 "\n", name[k], rays.of[k].rays, name[k],
            rays.of[k].hits);
    printf("turned_back\t%" PRIu64 "\nvolume_tests\t%" PRIu64 "\n", rays.turned_back, tests.boxes);
    printf(
        "primitive_tests\t%" PRIu64 "\nhierarchy_bytes\t%" PRIu64 "\n", tests.items, tests.bytes);
    close_stdout();
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct worker_states *s = worker_states_new(&renderer, &o.trace, &o.words);
    if (o.what != RUN || strcmp(o.path, "-") != 0) worker_states_load(s, SCENE, o.path);
    if (o.n_views) worker_states_load(s, VIEW, *o.views);
    int status = ST_OK;
    if (o.what == INSPECT) inspect(s, &o);
    else if (o.what == COUNT) count(s, &o);
    else status = worker_render(s, &o.worker);
    worker_states_free(s);
    return status;
}
