/*
 * trace_bench: how long the phases of a picture take on one core, and how many rays it takes.
 *
 *     make && cc -O2 -D_DEFAULT_SOURCE -Ilib -o build/trace_bench tests/bench/trace_bench.c \
 *         build/libstormring.a -lm
 *     taskset -c 1 build/trace_bench [options] SCENE.nff
 *
 * Prints the median of -n runs of each phase; -u renders that many pixels a call instead of a row.
 */
#include "base/base.h"
#include "stats/stats.h"
#include "trace/trace.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define RUNS_MAX 101

struct options {
    struct trace_options trace;
    int runs;
    uint32_t w, h, unit; /* unit: pixels a call, 0 a row */
    const char *out, *scene;
};

struct phases {
    double parse_ms, build_ms, trace_ms;
};

static void render(struct tracer *t, const struct options *o, float *rgba)
{
    for (uint32_t y = 0; y < o->h; y++) {
        const struct lattice row = {0, y, o->w, 1, 1, 1};
        uint32_t step = o->unit ? o->unit : o->w;
        for (uint32_t x = 0; x < o->w; x += step) {
            uint32_t n = o->w - x < step ? o->w - x : step;
            tracer_pixels(t, &row, x, n, rgba + 4 * ((size_t)y * o->w + x));
        }
    }
}

static struct phases run(
    struct options *o, const struct buf *text, float **rgba, struct trace_counts *c)
{
    struct scene s;
    char err[SCENE_ERR];
    int64_t t0 = cpu_us();
    if (nff_read(o->scene, (const char *)buf_data(text), buf_size(text), &s, err) != 0)
        die(ST_USAGE, "%s", err);
    if (!o->w) o->w = s.view.res_x, o->h = s.view.res_y;
    *rgba = xrealloc(*rgba, (size_t)4 * o->w * o->h, sizeof **rgba);
    int64_t t1 = cpu_us();
    struct tracer *t = tracer_new(&s, &o->trace);
    int64_t t2 = cpu_us();
    tracer_frame(t, o->w, o->h);
    render(t, o, *rgba);
    int64_t t3 = cpu_us();
    tracer_counts(t, c);
    tracer_free(t);
    scene_free(&s);
    return (struct phases){
        (double)(t1 - t0) / 1000, (double)(t2 - t1) / 1000, (double)(t3 - t2) / 1000};
}

static void write_pfm(const char *path, const struct options *o, const float *rgba)
{
    FILE *f = fopen(path, "wb");
    if (!f) die(ST_SYSTEM, "%s:", path);
    fprintf(f, "PF\n%u %u\n-1.0\n", o->w, o->h);
    for (uint32_t y = o->h; y-- > 0;)
        for (uint32_t x = 0; x < o->w; x++) fwrite(rgba + 4 * ((size_t)y * o->w + x), 4, 3, f);
    if (fclose(f) != 0) die(ST_SYSTEM, "%s:", path);
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-a SAMPLES] [-d DEPTH] [-n RUNS] [-o OUT.pfm] [-s WxH] [-u PIXELS] [-x sse2|avx2|avx512] SCENE";
    struct options o = {.trace = TRACE_OPTIONS_DEFAULT, .runs = 5};
    int opt, w, h;
    while ((opt = getopt(argc, argv, "a:d:hn:o:s:u:x:")) != -1) {
        switch (opt) {
        case 'a': o.trace.samples = (int)opt_int(opt, optarg, 1, TRACE_SAMPLES_MAX); break;
        case 'd': o.trace.depth = (int)opt_int(opt, optarg, 1, TRACE_DEPTH_MAX); break;
        case 'h': usage(ST_OK, text);
        case 'n': o.runs = (int)opt_int(opt, optarg, 1, RUNS_MAX); break;
        case 'o': o.out = optarg; break;
        case 's':
            if (!parse_size(optarg, FRAME_SIDE_MAX, &w, &h))
                die(ST_USAGE, "-s %s: expected WxH", optarg);
            o.w = (uint32_t)w, o.h = (uint32_t)h;
            break;
        case 'u': o.unit = (uint32_t)opt_int(opt, optarg, 1, FRAME_SIDE_MAX); break;
        case 'x': o.trace.isa = opt_isa(opt, optarg); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (argc - optind != 1) usage(ST_USAGE, text);
    o.scene = argv[optind];
    return o;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct buf text = {0};
    if (read_file(o.scene, &text) != 0) die(ST_USAGE, "%s:", o.scene);
    double phase[3][RUNS_MAX];
    struct trace_counts c;
    float *rgba = NULL;
    for (int i = 0; i < o.runs; i++) {
        struct phases t = run(&o, &text, &rgba, &c);
        phase[0][i] = t.parse_ms, phase[1][i] = t.build_ms, phase[2][i] = t.trace_ms;
    }
    uint64_t rays = 0;
    for (int k = 0; k < RAY_KINDS; k++) rays += c.of[k].rays;
    size_t runs = (size_t)o.runs;
    double trace_ms = stats_median(phase[2], runs);
    printf("parse_ms\t%.2f\nbuild_ms\t%.2f\ntrace_ms\t%.2f\n", stats_median(phase[0], runs),
        stats_median(phase[1], runs), trace_ms);
    printf("eye\t%" PRIu64 "\nreflected\t%" PRIu64 "\nrefracted\t%" PRIu64 "\nshadow\t%" PRIu64
           "\n",
        c.of[RAY_EYE].rays, c.of[RAY_REFLECTED].rays, c.of[RAY_REFRACTED].rays,
        c.of[RAY_SHADOW].rays);
    printf("ns_per_ray\t%.1f\n", trace_ms * 1e6 / (double)rays);
    printf("hash\t%016" PRIx64 "\n", hash64(HASH64_INIT, rgba, (size_t)16 * o.w * o.h));
    if (o.out) write_pfm(o.out, &o, rgba);
    free(rgba);
    buf_free(&text);
    close_stdout();
    return ST_OK;
}
