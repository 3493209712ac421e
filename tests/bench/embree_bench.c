/*
 * embree_bench: the same picture by the same shading and the same rays, traced by our kernels and
 * by Embree's (I. Wald, S. Woop, C. Benthin, G. Johnson, M. Ernst, "Embree: A Kernel Framework for
 * Efficient CPU Ray Tracing", ACM Transactions on Graphics 33(4), 2014), on one thread.
 *
 *     embree_bench [-e EMBREE_ISA] [-m ours|embree] [-n PAIRS] [-s WxH] [-x ISA] SCENE.nff
 *
 * Embree stands behind struct kernels. It has every way of asking that it offers: single rays,
 * packets of 8 and of 16, streams, packets and streams that it is told are coherent; each over a
 * hierarchy of medium and of high build quality. A packet size that the processor does not have
 * natively is left out. FTZ and DAZ are on for Embree, as its manual recommends, and off for ours.
 * Every way traces the picture once. The FINALISTS fastest then trace it in turns with ours: at
 * least PAIRS times and PAIRS_MS long.
 *
 * Embree computes in float. So its rays begin a little off the surface (OFF of the scene's reach),
 * and its pictures differ where rays graze. NFF's cones are open, and so are Embree's cones between
 * two neighbours. Streams have at most 16 rays, because wave.c asks for that many at once.
 *
 * Prints the time to read the scene, then a line for each way: kernels, build quality, pictures
 * traced, ms to build, ms to trace (median), our median / this median, the picture's RMSE against
 * ours, and the number of pixels that differ by more than 1/255. With -m one side alone builds and
 * traces one picture; prints its ms to build and to trace, and the peak of its memory in MiB.
 */
#include "base/base.h"
#include "stats/stats.h"
#include "trace/trace_int.h"

#include <embree3/rtcore.h>
#include <malloc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifdef __SSE2__
#include <immintrin.h>
#endif

#define RUNS_MAX 999
#define FINALISTS 2
#define PAIRS_MS 500
#define OFF 1e-5 /* some units of float's last place */

static RTCScene scene; /* that the kernels ask */
static struct tracer *tracer;
static float off;
static bool coherent;

/* ---- Embree as kernels ----------------------------------------------------------------------- */

/* Embree's geometry 0 has the triangles, 1 the spheres, 2 the cones. The index of the item that is
 * the n-th of its geometry: */
static uint32_t *item_of[ITEM_KINDS];

static void fill(struct RTCRay *to, const struct ray *r)
{
    *to = (struct RTCRay){.org_x = (float)r->o.x,
        .org_y = (float)r->o.y,
        .org_z = (float)r->o.z,
        .dir_x = (float)r->d.x,
        .dir_y = (float)r->d.y,
        .dir_z = (float)r->d.z,
        .tnear = fmaxf((float)r->t_min, off),
        .tfar = r->t_max < 1e30 ? (float)r->t_max - off : INFINITY,
        .mask = UINT32_MAX,
        .id = 0};
}

static struct hit hit_of(float t, unsigned geometry, unsigned primitive)
{
    bool none = geometry == RTC_INVALID_GEOMETRY_ID;
    return (struct hit){(double)t, none ? NO_ITEM : item_of[geometry][primitive]};
}

/* What a shadow ray crosses is collected by the filter, which lets transmitting items through. */
struct asked {
    struct RTCIntersectContext context; /* first: Embree hands a pointer to it back */
    struct crossings *c[PACKET];
    const uint8_t *transmits;
};

static void cross(const struct RTCFilterFunctionNArguments *a)
{
    struct asked *q = (struct asked *)a->context;
    for (unsigned i = 0; i < a->N; i++) {
        if (!a->valid[i]) continue;
        /* Arrays of N: a ray's eleventh number is its id, a hit's sixth and seventh say what. */
        const unsigned *ray = (const unsigned *)a->ray, *hit = (const unsigned *)a->hit;
        uint32_t item = item_of[hit[6 * a->N + i]][hit[5 * a->N + i]];
        if (!q->transmits[item]) continue;
        crossings_add(q->c[ray[10 * a->N + i]], item);
        a->valid[i] = 0;
    }
}

static void context_init(struct RTCIntersectContext *c)
{
    rtcInitIntersectContext(c);
    if (coherent) c->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
}

static void asked_init(
    struct asked *q, const uint8_t *transmits, struct crossings *c, unsigned first, unsigned n)
{
    context_init(&q->context);
    q->transmits = transmits;
    if (!transmits) return;
    q->context.filter = cross;
    for (unsigned i = 0; i < n; i++) q->c[i] = &c[first + i];
}

static void closest(const struct bvh *b, const struct ray *r, struct hit *h)
{
    (void)b;
    struct RTCRayHit q;
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    fill(&q.ray, r);
    q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &q);
    *h = hit_of(q.ray.tfar, q.hit.geomID, q.hit.primID);
}

static bool blocked(
    const struct bvh *b, const struct ray *r, const uint8_t *transmits, struct crossings *c)
{
    (void)b;
    struct asked q;
    struct RTCRay ray;
    asked_init(&q, transmits, c, 0, 1);
    fill(&ray, r);
    rtcOccluded1(scene, &q.context, &ray);
    return ray.tfar < 0;
}

static void closest_each(
    const struct bvh *b, const struct ray *const *r, unsigned n, struct hit *const *h)
{
    for (unsigned i = 0; i < n; i++) closest(b, r[i], h[i]);
}

static unsigned blocked_each(const struct bvh *b, const struct ray *const *r, unsigned n,
    const uint8_t *transmits, struct crossings *c)
{
    unsigned bits = 0;
    for (unsigned i = 0; i < n; i++) bits |= (unsigned)blocked(b, r[i], transmits, &c[i]) << i;
    return bits;
}

/* The kernels of packets of SIZE rays. */
#define PACKETS(SIZE)                                                                              \
    static void fill_##SIZE(                                                                       \
        struct RTCRay##SIZE *to, int *valid, const struct ray *const *r, unsigned n)               \
    {                                                                                              \
        for (unsigned i = 0; i < SIZE; i++) {                                                      \
            struct RTCRay one;                                                                     \
            valid[i] = i < n ? -1 : 0;                                                             \
            fill(&one, r[i < n ? i : 0]);                                                          \
            to->org_x[i] = one.org_x, to->org_y[i] = one.org_y, to->org_z[i] = one.org_z;          \
            to->dir_x[i] = one.dir_x, to->dir_y[i] = one.dir_y, to->dir_z[i] = one.dir_z;          \
            to->tnear[i] = one.tnear, to->tfar[i] = one.tfar;                                      \
            to->time[i] = 0, to->mask[i] = one.mask, to->id[i] = i, to->flags[i] = 0;              \
        }                                                                                          \
    }                                                                                              \
    static void closest_##SIZE(                                                                    \
        const struct bvh *b, const struct ray *const *r, unsigned n, struct hit *const *h)         \
    {                                                                                              \
        (void)b;                                                                                   \
        for (unsigned first = 0; first < n; first += SIZE) {                                       \
            _Alignas(64) struct RTCRayHit##SIZE q;                                                 \
            _Alignas(64) int valid[SIZE];                                                          \
            struct RTCIntersectContext context;                                                    \
            unsigned count = n - first < SIZE ? n - first : SIZE;                                  \
            context_init(&context);                                                                \
            fill_##SIZE(&q.ray, valid, r + first, count);                                          \
            for (unsigned i = 0; i < SIZE; i++)                                                    \
                q.hit.geomID[i] = q.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;                    \
            rtcIntersect##SIZE(valid, scene, &context, &q);                                        \
            for (unsigned i = 0; i < count; i++)                                                   \
                *h[first + i] = hit_of(q.ray.tfar[i], q.hit.geomID[i], q.hit.primID[i]);           \
        }                                                                                          \
    }                                                                                              \
    static unsigned blocked_##SIZE(const struct bvh *b, const struct ray *const *r, unsigned n,    \
        const uint8_t *transmits, struct crossings *c)                                             \
    {                                                                                              \
        unsigned bits = 0;                                                                         \
        (void)b;                                                                                   \
        for (unsigned first = 0; first < n; first += SIZE) {                                       \
            _Alignas(64) struct RTCRay##SIZE ray;                                                  \
            _Alignas(64) int valid[SIZE];                                                          \
            struct asked q;                                                                        \
            unsigned count = n - first < SIZE ? n - first : SIZE;                                  \
            asked_init(&q, transmits, c, first, count);                                            \
            fill_##SIZE(&ray, valid, r + first, count);                                            \
            rtcOccluded##SIZE(valid, scene, &q.context, &ray);                                     \
            for (unsigned i = 0; i < count; i++)                                                   \
                bits |= (unsigned)(ray.tfar[i] < 0) << (first + i);                                \
        }                                                                                          \
        return bits;                                                                               \
    }
PACKETS(8)
PACKETS(16)

static void closest_stream(
    const struct bvh *b, const struct ray *const *r, unsigned n, struct hit *const *h)
{
    (void)b;
    struct RTCRayHit q[PACKET];
    struct RTCIntersectContext context;
    context_init(&context);
    for (unsigned i = 0; i < n; i++) {
        fill(&q[i].ray, r[i]);
        q[i].hit.geomID = q[i].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect1M(scene, &context, q, n, sizeof *q);
    for (unsigned i = 0; i < n; i++)
        *h[i] = hit_of(q[i].ray.tfar, q[i].hit.geomID, q[i].hit.primID);
}

static unsigned blocked_stream(const struct bvh *b, const struct ray *const *r, unsigned n,
    const uint8_t *transmits, struct crossings *c)
{
    (void)b;
    struct RTCRay ray[PACKET];
    struct asked q;
    unsigned bits = 0;
    asked_init(&q, transmits, c, 0, n);
    for (unsigned i = 0; i < n; i++) {
        fill(&ray[i], r[i]);
        ray[i].id = i;
    }
    rtcOccluded1M(scene, &q.context, ray, n, sizeof *ray);
    for (unsigned i = 0; i < n; i++) bits |= (unsigned)(ray[i].tfar < 0) << i;
    return bits;
}

#define NATIVE(SIZE) RTC_DEVICE_PROPERTY_NATIVE_RAY##SIZE##_SUPPORTED
static const struct way {
    struct kernels k;
    bool coherent;
    int needs; /* a property of the device, or -1 */
} ways[] = {
    {{"single rays", closest, blocked, closest_each, blocked_each}, false, -1},
    {{"8 rays", closest, blocked, closest_8, blocked_8}, false, NATIVE(8)},
    {{"8 coherent rays", closest, blocked, closest_8, blocked_8}, true, NATIVE(8)},
    {{"16 rays", closest, blocked, closest_16, blocked_16}, false, NATIVE(16)},
    {{"16 coherent rays", closest, blocked, closest_16, blocked_16}, true, NATIVE(16)},
    {{"stream", closest, blocked, closest_stream, blocked_stream}, false,
        RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED},
    {{"coherent stream", closest, blocked, closest_stream, blocked_stream}, true,
        RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED},
};
#define WAYS ((int)(sizeof ways / sizeof *ways))

/* ---- the scene for Embree -------------------------------------------------------------------- */

static void put(float *to, struct vec3 p, double radius)
{
    to[0] = (float)p.x, to[1] = (float)p.y, to[2] = (float)p.z, to[3] = (float)radius;
}

static const struct prim *prim_of(enum item_kind kind, uint32_t i)
{
    return &tracer->scene->prims[tracer->items[item_of[kind][i]].prim];
}

static void fill_triangles(RTCGeometry g, uint32_t n)
{
    const struct scene *s = tracer->scene;
    float *v = rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof *v, s->n_vertices);
    uint32_t *corner = rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof *corner, n);
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        float *to = v + (size_t)3 * i;
        to[0] = (float)s->vertices[i].x, to[1] = (float)s->vertices[i].y;
        to[2] = (float)s->vertices[i].z;
    }
    for (uint32_t i = 0; i < n; i++)
        memcpy(corner + (size_t)3 * i, tracer->items[item_of[ITEM_TRIANGLE][i]].vertex,
            3 * sizeof *corner);
}

static void fill_spheres(RTCGeometry g, uint32_t n)
{
    float *v =
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof *v, n);
    for (uint32_t i = 0; i < n; i++) {
        const struct prim *p = prim_of(ITEM_SPHERE, i);
        put(v + (size_t)4 * i, p->sphere.center, p->sphere.radius);
    }
}

/* A curve of one segment. With neighbours said to be on both sides its ends are open. */
static void fill_cones(RTCGeometry g, uint32_t n)
{
    float *v = rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof *v, (size_t)2 * n);
    uint32_t *first =
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof *first, n);
    uint8_t *flags =
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR, sizeof *flags, n);
    for (uint32_t i = 0; i < n; i++) {
        const struct prim *p = prim_of(ITEM_CONE, i);
        put(v + (size_t)8 * i, p->cone.base, p->cone.base_radius);
        put(v + (size_t)8 * i + 4, p->cone.apex, p->cone.apex_radius);
        first[i] = 2 * i;
        flags[i] = RTC_CURVE_FLAG_NEIGHBOR_LEFT | RTC_CURVE_FLAG_NEIGHBOR_RIGHT;
    }
}

static const struct {
    enum RTCGeometryType type;
    void (*fill)(RTCGeometry g, uint32_t n);
} geometry_of[ITEM_KINDS] = {
    [ITEM_TRIANGLE] = {RTC_GEOMETRY_TYPE_TRIANGLE, fill_triangles},
    [ITEM_SPHERE] = {RTC_GEOMETRY_TYPE_SPHERE_POINT, fill_spheres},
    [ITEM_CONE] = {RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE, fill_cones},
};

static double ms_since(int64_t began) { return (double)(cpu_us() - began) / 1000; }

/* Returns a scene, and the milliseconds that it took. */
static RTCScene embree_build(
    RTCDevice device, enum RTCBuildQuality quality, const uint32_t n[ITEM_KINDS], double *ms)
{
    int64_t began = cpu_us();
    RTCScene s = rtcNewScene(device);
    if (tracer->transmits) rtcSetSceneFlags(s, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneBuildQuality(s, quality);
    for (unsigned k = 0; k < ITEM_KINDS; k++) {
        if (!n[k]) continue;
        if (!geometry_of[k].fill) die(ST_USAGE, "a primitive of the scene is unknown to Embree");
        RTCGeometry g = rtcNewGeometry(device, geometry_of[k].type);
        geometry_of[k].fill(g, n[k]);
        rtcCommitGeometry(g);
        rtcAttachGeometryByID(s, g, k);
        rtcReleaseGeometry(g);
    }
    rtcCommitScene(s);
    *ms = ms_since(began);
    struct RTCBounds b;
    rtcGetSceneBounds(s, &b);
    const float side[] = {b.lower_x, b.lower_y, b.lower_z, b.upper_x, b.upper_y, b.upper_z};
    double reach = 1;
    for (int i = 0; i < 6; i++) reach = fmax(reach, fabs((double)side[i]));
    off = (float)(reach * OFF);
    return s;
}

static void number_items(uint32_t n[ITEM_KINDS])
{
    for (int k = 0; k < ITEM_KINDS; k++)
        n[k] = 0, item_of[k] = xmalloc(tracer->n_items, sizeof **item_of);
    for (uint32_t i = 0; i < tracer->n_items; i++) {
        int k = tracer->items[i].kind;
        item_of[k][n[k]++] = i;
    }
}

/* ---- the comparison -------------------------------------------------------------------------- */

static const enum RTCBuildQuality qualities[] = {RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_HIGH};
static const char *const quality_names[] = {"medium", "high"};
#define QUALITIES 2

struct options {
    int pairs;
    uint32_t w, h;
    enum isa isa;
    const char *embree_isa, *alone, *scene;
};

/* One way over one hierarchy, or ours. */
struct entry {
    const struct kernels *k;
    const char *quality;
    RTCScene scene;
    double build_ms;
    float *rgba;
    double rmse;
    size_t far;
    double took_ms[RUNS_MAX];
    int runs;
    bool coherent;
};
#define ENTRIES (1 + QUALITIES * WAYS)

static void denormals_are_zero(bool on)
{
#ifdef __SSE2__
    _mm_setcsr(on ? _mm_getcsr() | 0x8040 : _mm_getcsr() & ~0x8040u);
#else
    (void)on;
#endif
}

static void render(struct entry *e, const struct options *o)
{
    tracer->k = e->k;
    scene = e->scene;
    coherent = e->coherent;
    denormals_are_zero(e->scene != NULL);
    int64_t begin = cpu_us();
    for (uint32_t y = 0; y < o->h; y++) {
        const struct lattice row = {0, y, o->w, 1, 1, 1};
        tracer_pixels(tracer, &row, 0, o->w, e->rgba + (size_t)4 * y * o->w);
    }
    e->took_ms[e->runs++] = ms_since(begin);
    denormals_are_zero(false);
}

/* How far b is from a: the RMSE, and the pixels that differ by more than 1/255. */
static double apart(const float *a, const float *b, size_t pixels, size_t *far)
{
    double sum = 0;
    *far = 0;
    for (size_t p = 0; p < pixels; p++) {
        double worst = 0;
        for (size_t c = 4 * p; c < 4 * p + 3; c++) {
            double d = (double)(a[c] - b[c]);
            sum += d * d;
            worst = fmax(worst, fabs(d));
        }
        *far += worst > 1.0 / 255;
    }
    return sqrt(sum / (3 * (double)pixels));
}

static int by_time(const void *a, const void *b)
{
    double x = ((const struct entry *)a)->took_ms[0], y = ((const struct entry *)b)->took_ms[0];
    return (x > y) - (x < y);
}

/* e[0] is ours. Sorts the others by the time of their first picture. */
static void compare(struct entry *e, int n, const struct options *o)
{
    size_t pixels = (size_t)o->w * o->h;
    float *ours = xmalloc(pixels, 4 * sizeof *ours), *theirs = xmalloc(pixels, 4 * sizeof *theirs);
    e[0].rgba = ours;
    render(&e[0], o);
    e[0].runs = 0; /* the first picture also pays for page faults */
    for (int i = 0; i < n; i++) {
        if (i) e[i].rgba = theirs;
        render(&e[i], o);
        e[i].rmse = apart(ours, e[i].rgba, pixels, &e[i].far);
    }
    double first_ms = e[0].took_ms[0];
    qsort(e + 1, (size_t)n - 1, sizeof *e, by_time);
    int64_t began = cpu_us();
    while (e[0].runs < RUNS_MAX && (e[0].runs <= o->pairs || ms_since(began) < PAIRS_MS))
        for (int i = 0; i <= FINALISTS && i < n; i++) render(&e[i], o);
    for (int i = 0; i < n; i++) {
        double ms = stats_median(e[i].took_ms, (size_t)e[i].runs);
        double ours_ms = i > FINALISTS ? first_ms : stats_median(e[0].took_ms, (size_t)e[0].runs);
        printf("%s\t%s\t%d\t%.2f\t%.2f\t%.3f\t%.2g\t%zu\n", i ? e[i].k->name : "ours", e[i].quality,
            e[i].runs, e[i].build_ms, ms, ours_ms / ms, e[i].rmse, e[i].far);
    }
    free(ours);
    free(theirs);
}

static void compare_all(RTCDevice device, double ours_ms, const struct options *o)
{
    static struct entry e[ENTRIES];
    RTCScene built[QUALITIES];
    uint32_t items[ITEM_KINDS];
    int n = 0;
    e[n++] = (struct entry){.k = tracer->k, .quality = tracer->k->name, .build_ms = ours_ms};
    number_items(items);
    for (int q = 0; q < QUALITIES; q++) {
        double ms;
        built[q] = embree_build(device, qualities[q], items, &ms);
        for (int i = 0; i < WAYS; i++) {
            const struct way *w = &ways[i];
            if (w->needs >= 0 && !rtcGetDeviceProperty(device, (enum RTCDeviceProperty)w->needs))
                continue;
            e[n++] = (struct entry){&w->k, quality_names[q], built[q], ms, .coherent = w->coherent};
        }
    }
    compare(e, n, o);
    for (int q = 0; q < QUALITIES; q++) rtcReleaseScene(built[q]);
}

/* ---- one side alone -------------------------------------------------------------------------- */

/* The peak of this process's memory in MiB; NaN if the system does not tell it. */
static double peak_mib(void)
{
    char line[256];
    double kib = NAN;
    FILE *f = fopen("/proc/self/status", "r");
    while (f && fgets(line, sizeof line, f)) {
        char *value = strchr(line, ':');
        if (value && strncmp(line, "VmHWM", 5) == 0) kib = strtod(value + 1, NULL);
    }
    if (f) fclose(f);
    return kib / 1024;
}

/* Embree's items come from a tracer: drops its hierarchy, and forgets the peak so far. */
static void drop_ours(void)
{
    bvh_free(&tracer->bvh);
    tracer->bvh = (struct bvh){0};
    malloc_trim(0);
    FILE *f = fopen("/proc/self/clear_refs", "w");
    if (!f || fputs("5", f) < 0 || fclose(f) != 0) die(ST_SYSTEM, "/proc/self/clear_refs:");
}

static void alone(RTCDevice device, double ours_ms, const struct options *o)
{
    struct entry e = {.k = tracer->k, .build_ms = ours_ms};
    uint32_t items[ITEM_KINDS];
    if (strcmp(o->alone, "ours") != 0) {
        drop_ours();
        number_items(items);
        e.k = &ways[0].k;
        e.scene = embree_build(device, RTC_BUILD_QUALITY_HIGH, items, &e.build_ms);
    }
    e.rgba = xmalloc((size_t)o->w * o->h, 4 * sizeof *e.rgba);
    render(&e, o);
    printf("%.2f\t%.2f\t%.1f\n", e.build_ms, e.took_ms[0], peak_mib());
    free(e.rgba);
    rtcReleaseScene(e.scene);
}

static struct options parse(int argc, char **argv)
{
    static const char text[] =
        "[-e EMBREE_ISA] [-m ours|embree] [-n PAIRS] [-s WxH] [-x ISA] SCENE";
    struct options o = {.pairs = 5, .w = 512, .h = 512};
    int opt, w, h;
    while ((opt = getopt(argc, argv, "e:hm:n:s:x:")) != -1) {
        switch (opt) {
        case 'e': o.embree_isa = optarg; break;
        case 'h': usage(ST_OK, text);
        case 'm': o.alone = optarg; break;
        case 'n': o.pairs = (int)opt_int(opt, optarg, 1, RUNS_MAX - 1); break;
        case 's':
            if (!parse_size(optarg, FRAME_SIDE_MAX, &w, &h))
                die(ST_USAGE, "-s %s: expected WxH", optarg);
            o.w = (uint32_t)w, o.h = (uint32_t)h;
            break;
        case 'x': o.isa = opt_isa(opt, optarg); break;
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
    struct scene s;
    char err[SCENE_ERR], config[64] = "threads=1,set_affinity=0";
    struct trace_options trace = TRACE_OPTIONS_DEFAULT;
    trace.isa = o.isa;
    if (o.embree_isa)
        snprintf(config, sizeof config, "threads=1,set_affinity=0,isa=%s", o.embree_isa);
    int64_t began = cpu_us();
    if (read_file(o.scene, &text) != 0) die(ST_USAGE, "%s:", o.scene);
    if (nff_read(o.scene, (const char *)buf_data(&text), buf_size(&text), &s, err) != 0)
        die(ST_USAGE, "%s", err);
    buf_free(&text);
    double read_ms = ms_since(began);
    began = cpu_us();
    tracer = tracer_new(&s, &trace);
    double ours_ms = ms_since(began);
    tracer_frame(tracer, o.w, o.h);
    RTCDevice device = o.alone && strcmp(o.alone, "ours") == 0 ? NULL : rtcNewDevice(config);
    if (!device && !o.alone) die(ST_SYSTEM, "Embree refuses \"%s\"", config);
    if (o.alone) {
        alone(device, ours_ms, &o);
    } else {
        printf("read\t%.2f\n", read_ms);
        compare_all(device, ours_ms, &o);
    }
    if (device) rtcReleaseDevice(device);
    tracer_free(tracer);
    scene_free(&s);
    for (int k = 0; k < ITEM_KINDS; k++) free(item_of[k]);
    close_stdout();
    return ST_OK;
}
