/* rtworker: ray-traces the tasks it reads. */
#include "base/base.h"
#include "scene/scene.h"
#include "trace/trace.h"
#include "worker/worker.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define FORMAT_VERSION 5 /* raise it when a pixel of any scene changes */

struct options {
    struct trace_options trace;
    struct worker_options worker;
    bool inspect;     /* -i: print the frame and the job, render nothing */
    int w, h;         /* -s: size of that frame; 0: the scene's */
    const char *path; /* scene file; "-": the scene comes as a record */
    char with[80];    /* the program and its pixel-changing options, for `with=` */
};

/* The scene of the pictures of one generation. */
struct subject {
    struct scene scene;
    struct tracer *tracer;
    uint64_t hash;
    bool loaded;
};

struct renderer {
    const struct options *o;
    const char *name;
    struct subject subjects[GENERATIONS]; /* by generation, modulo GENERATIONS */
    struct subject *at;                   /* subject of the current frame */
    uint32_t w, h;
};

static void unload(struct subject *s)
{
    tracer_free(s->tracer);
    if (s->loaded) scene_free(&s->scene);
    *s = (struct subject){0};
}

static int load(struct renderer *r, struct subject *s, const char *text, size_t n, char *err)
{
    unload(s);
    s->loaded = nff_read(r->name, text, n, &s->scene, err) == 0;
    s->hash = hash64(HASH64_INIT, text, n);
    return s->loaded ? 0 : -1;
}

static int take_state(void *ctx, uint32_t generation, enum rec_kind kind, unsigned char *body,
    size_t n, char err[WORKER_ERR])
{
    struct renderer *r = ctx;
    bool streamed = strcmp(r->o->path, "-") == 0;
    if (kind == REC_SCENE && streamed)
        return load(r, &r->subjects[generation % GENERATIONS], (const char *)body, n, err);
    snprintf(err, WORKER_ERR, "record `%s`, expected %s", rec_name(kind),
        streamed ? "`scene`" : "no state records, because the scene is a file");
    return -1;
}

static void drop(void *ctx, uint32_t generation)
{
    unload(&((struct renderer *)ctx)->subjects[generation % GENERATIONS]);
}

static int ready(void *ctx, const struct frame_size *f, char err[WORKER_ERR])
{
    struct renderer *r = ctx;
    struct subject *s = r->at = &r->subjects[f->generation % GENERATIONS];
    if (!s->loaded) {
        snprintf(err, WORKER_ERR, "no scene, expected a `scene` record before the first task");
        return -1;
    }
    if (!s->tracer) s->tracer = tracer_new(&s->scene, &r->o->trace);
    tracer_frame(s->tracer, f->w, f->h);
    r->w = f->w;
    r->h = f->h;
    return 0;
}

static uint64_t job(void *ctx)
{
    struct renderer *r = ctx;
    const struct trace_options *t = &r->o->trace;
    char text[160];
    int n = snprintf(text, sizeof text,
        "rt %d depth=%d samples=%d threshold=%.17g budget=%.17g scene=%016" PRIx64, FORMAT_VERSION,
        t->depth, t->samples, t->threshold, t->budget, r->at->hash);
    const uint32_t size[2] = {r->w, r->h};
    return hash64_u32(hash64(HASH64_INIT, text, (size_t)n), size, 2);
}

static const char *with(void *ctx) { return ((struct renderer *)ctx)->o->with; }

static void render(void *ctx, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    struct renderer *r = ctx;
    tracer_pixels(r->at->tracer, at, n0, n, rgba);
}

/* Every primitive, a mirror, glass and a shadow, small enough to render in one or two
 * milliseconds. */
static const char selftest_nff[] =
    "b .1 .3 .7\nv from 3 4 5 at 0 0 .4 up 0 0 1 angle 40 hither 0 resolution 32 32\n"
    "l 5 3 9\nl -4 6 5 .5 .6 .7\nf 1 .9 .5 .8 .2 20 0 0\n"
    "p 5 -3 -3 0 3 -3 0 3 3 0 0 1 0 -3 3 .01\nf .9 .2 .2 .5 .5 30 0 0\ns 0 0 .8 .8\n"
    "f .2 .9 .3 .2 .1 10 .7 1.3\ns 1.2 1 .6 .6\nf .3 .4 1 .9 .1 5 0 0\n"
    "c -1.4 .8 0 .5 -1.4 .8 1.2 .2\npp 3 1 -1 0 0 0 1 2 -1.5 .3 .3 0 1 1.4 -.3 1.1 0 .4 1\n";

static void selftest(void *ctx, float *rgba, uint32_t *n)
{
    struct scene s;
    (void)ctx;
    char err[SCENE_ERR];
    if (nff_read("selftest", selftest_nff, sizeof selftest_nff - 1, &s, err) != 0)
        die(ST_SYSTEM, "%s", err);
    const struct trace_options o = TRACE_OPTIONS_DEFAULT;
    struct tracer *t = tracer_new(&s, &o);
    tracer_frame(t, 32, 32);
    const struct lattice all = {0, 0, 32, 32, 1, 1};
    *n = 32 * 32;
    tracer_pixels(t, &all, 0, *n, rgba);
    tracer_free(t);
    scene_free(&s);
}

static const struct worker_ops ops = {
    .program = "rtworker",
    .state = take_state,
    .drop = drop,
    .ready = ready,
    .job = job,
    .with = with,
    .render = render,
    .selftest = selftest,
};

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
        die(ST_USAGE, "-a %s: expected N:THRESHOLD, a number >= 0", s);
}

static void describe(struct options *o)
{
    const struct trace_options usual = TRACE_OPTIONS_DEFAULT, *t = &o->trace;
    size_t n = (size_t)snprintf(o->with, sizeof o->with, "rtworker");
    if (t->samples != usual.samples || t->threshold >= 0)
        n += (size_t)snprintf(o->with + n, sizeof o->with - n, ",-a%d", t->samples);
    if (t->threshold >= 0) {
        char text[32];
        print_real(text, t->threshold);
        n += (size_t)snprintf(o->with + n, sizeof o->with - n, ":%s", text);
    }
    if (t->depth != usual.depth)
        n += (size_t)snprintf(o->with + n, sizeof o->with - n, ",-d%d", t->depth);
    if (t->budget != usual.budget) {
        char text[32];
        print_real(text, t->budget);
        snprintf(o->with + n, sizeof o->with - n, ",-w%s", text);
    }
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-ch] [-a SAMPLES[:THRESHOLD]] [-d DEPTH] [-f PIXELS]\n"
        "           [-w BOUND] [-x sse2|avx2|avx512] [SCENE.nff|-]\n"
        "       rtworker -i [-a SAMPLES[:THRESHOLD]] [-d DEPTH] [-s WxH] [-w BOUND]\n"
        "                [SCENE.nff|-]";
    struct options o = {.trace = TRACE_OPTIONS_DEFAULT, .path = "-"};
    int opt;
    while ((opt = prog_getopt(argc, argv, "+a:d:his:w:x:" WORKER_OPTIONS)) != -1) {
        switch (opt) {
        case 'a': parse_sampling(optarg, &o.trace); break;
        case 'd': o.trace.depth = (int)opt_int(opt, optarg, 1, TRACE_DEPTH_MAX); break;
        case 'h': usage(ST_OK, text);
        case 'i':
            if (o.inspect) die(ST_USAGE, "-i: twice, expected it once");
            o.inspect = true;
            break;
        case 's': opt_size(opt, optarg, FRAME_SIDE_MAX, &o.w, &o.h); break;
        case 'w': o.trace.budget = opt_real(opt, optarg, 0, 1); break;
        case 'x': o.trace.isa = opt_isa(opt, optarg); break;
        default:
            if (!worker_option(&o.worker, opt, optarg)) usage(ST_USAGE, text);
        }
    }
    if (argc - optind > 1) usage(ST_USAGE, text);
    if (o.w && !o.inspect) die(ST_USAGE, "-s: expected -i with it");
    if (optind < argc) o.path = argv[optind];
    describe(&o);
    return o;
}

/* Reads the scene named on the command line. */
static void open_scene(struct renderer *r)
{
    struct buf text = {0};
    char err[WORKER_ERR];
    if (read_file(r->o->path, &text) != 0) die(ST_USAGE, "%s:", r->o->path);
    r->at = r->subjects;
    if (load(r, r->at, (const char *)buf_data(&text), buf_size(&text), err) != 0)
        die(ST_USAGE, "%s", err);
    buf_free(&text);
}

static void inspect(struct renderer *r)
{
    r->w = r->o->w ? (uint32_t)r->o->w : r->at->scene.view.res_x;
    r->h = r->o->w ? (uint32_t)r->o->h : r->at->scene.view.res_y;
    printf("frame %u %u\njob=%016" PRIx64 "\n", r->w, r->h, job(r));
    close_stdout();
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    bool streamed = strcmp(o.path, "-") == 0 && !o.inspect;
    struct renderer r = {.o = &o, .name = streamed || !strcmp(o.path, "-") ? "scene" : o.path};
    if (!streamed) open_scene(&r);
    int status = ST_OK;
    if (o.inspect) inspect(&r);
    else status = worker_run(&ops, &o.worker, &r);
    for (uint32_t i = 0; i < 2; i++) drop(&r, i);
    return status;
}
