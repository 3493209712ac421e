/*
 * embree_bench: the same picture by the same shading and the same rays, traced by our kernels and by
 * Embree's (I. Wald, S. Woop, C. Benthin, G. Johnson, M. Ernst, "Embree: A Kernel Framework for
 * Efficient CPU Ray Tracing", ACM Transactions on Graphics 33(4), 2014), on one thread.
 *
 *     embree_bench RUNS WxH SCENE.nff
 *
 * Embree stands behind struct kernels, one ray a call or sixteen. It computes in float: so its rays
 * begin a little off the surface (OFF of the scene's reach), and its pictures differ where rays
 * graze. Prints a line for each: kernels, ms to build, ms to trace (medians of the runs, in turns),
 * the picture's RMSE against ours, and its pixels that are further off than 1/255.
 *
 * Where the processor has no AVX-512, Embree has no packets of sixteen, and only the first line of
 * its three is there.
 */
#include "base/base.h"
#include "stats/stats.h"
#include "trace/trace_int.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RUNS_MAX 99
#define KINDS 4  /* ours, and three of Embree */
#define OFF 1e-5 /* some units of float's last place */

static RTCScene scene;
static struct tracer *tracer;
static float off;
static bool coherent;

/* ---- Embree as kernels ----------------------------------------------------------------------- */

/* Embree's geometry 0 has the triangles, 1 the spheres; which item is the n-th of each. */
static uint32_t *item_of[2];

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
    *h = (struct hit){(double)q.ray.tfar, NO_ITEM};
    if (q.hit.geomID != RTC_INVALID_GEOMETRY_ID) h->item = item_of[q.hit.geomID][q.hit.primID];
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

static void asked_init(struct asked *q, const uint8_t *transmits)
{
    rtcInitIntersectContext(&q->context);
    q->transmits = transmits;
    if (transmits) q->context.filter = cross;
    if (coherent) q->context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
}

static bool blocked(
    const struct bvh *b, const struct ray *r, const uint8_t *transmits, struct crossings *c)
{
    (void)b;
    struct asked q;
    struct RTCRay ray;
    asked_init(&q, transmits);
    q.c[0] = c;
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

static void fill16(struct RTCRay16 *to, int *valid, const struct ray *const *r, unsigned n)
{
    for (unsigned i = 0; i < 16; i++) {
        struct RTCRay one;
        valid[i] = i < n ? -1 : 0;
        fill(&one, r[i < n ? i : 0]);
        to->org_x[i] = one.org_x, to->org_y[i] = one.org_y, to->org_z[i] = one.org_z;
        to->dir_x[i] = one.dir_x, to->dir_y[i] = one.dir_y, to->dir_z[i] = one.dir_z;
        to->tnear[i] = one.tnear, to->tfar[i] = one.tfar;
        to->time[i] = 0, to->mask[i] = one.mask, to->id[i] = i, to->flags[i] = 0;
    }
}

static void closest_16(
    const struct bvh *b, const struct ray *const *r, unsigned n, struct hit *const *h)
{
    (void)b;
    _Alignas(64) struct RTCRayHit16 q;
    _Alignas(64) int valid[16];
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    fill16(&q.ray, valid, r, n);
    for (unsigned i = 0; i < 16; i++)
        q.hit.geomID[i] = q.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect16(valid, scene, &context, &q);
    for (unsigned i = 0; i < n; i++) {
        uint32_t g = q.hit.geomID[i];
        *h[i] = (struct hit){(double)q.ray.tfar[i],
            g == RTC_INVALID_GEOMETRY_ID ? NO_ITEM : item_of[g][q.hit.primID[i]]};
    }
}

static unsigned blocked_16(const struct bvh *b, const struct ray *const *r, unsigned n,
    const uint8_t *transmits, struct crossings *c)
{
    (void)b;
    _Alignas(64) struct RTCRay16 ray;
    _Alignas(64) int valid[16];
    struct asked q;
    unsigned bits = 0;
    asked_init(&q, transmits);
    for (unsigned i = 0; i < n; i++) q.c[i] = &c[i];
    fill16(&ray, valid, r, n);
    rtcOccluded16(valid, scene, &q.context, &ray);
    for (unsigned i = 0; i < n; i++) bits |= (unsigned)(ray.tfar[i] < 0) << i;
    return bits;
}

static const struct kernels embree[] = {
    {"Embree, a ray a call", closest, blocked, closest_each, blocked_each},
    {"Embree, 16 rays", closest, blocked, closest_16, blocked_16},
    {"Embree, 16 coherent rays", closest, blocked, closest_16, blocked_16},
};

/* ---- the scene for Embree -------------------------------------------------------------------- */

static void attach(RTCDevice device, enum RTCGeometryType type, uint32_t n, unsigned id)
{
    bool spheres = type == RTC_GEOMETRY_TYPE_SPHERE_POINT;
    if (!n) return;
    RTCGeometry g = rtcNewGeometry(device, type);
    const struct scene *s = tracer->scene;
    if (spheres) {
        float *v = rtcSetNewGeometryBuffer(
            g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof *v, n);
        for (uint32_t i = 0; i < n; i++) {
            const struct prim *p = &s->prims[tracer->items[item_of[1][i]].prim];
            v[4 * i] = (float)p->sphere.center.x, v[4 * i + 1] = (float)p->sphere.center.y;
            v[4 * i + 2] = (float)p->sphere.center.z, v[4 * i + 3] = (float)p->sphere.radius;
        }
    } else {
        float *v = rtcSetNewGeometryBuffer(
            g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof *v, s->n_vertices);
        uint32_t *corner = rtcSetNewGeometryBuffer(
            g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof *corner, n);
        for (uint32_t i = 0; i < s->n_vertices; i++)
            v[3 * i] = (float)s->vertices[i].x, v[3 * i + 1] = (float)s->vertices[i].y,
                  v[3 * i + 2] = (float)s->vertices[i].z;
        for (uint32_t i = 0; i < n; i++)
            memcpy(corner + 3 * i, tracer->items[item_of[0][i]].vertex, 3 * sizeof *corner);
    }
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(scene, g, id);
    rtcReleaseGeometry(g);
}

static void embree_build(RTCDevice device)
{
    uint32_t n[2] = {0};
    for (int k = 0; k < 2; k++) item_of[k] = xmalloc(tracer->n_items, sizeof **item_of);
    for (uint32_t i = 0; i < tracer->n_items; i++) {
        int k = tracer->items[i].kind;
        if (k == ITEM_CONE) die(ST_USAGE, "the scene has cones, which Embree has not");
        k = k == ITEM_SPHERE;
        item_of[k][n[k]++] = i;
    }
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    double reach = 1;
    for (uint32_t i = 0; i < tracer->scene->n_vertices; i++) {
        struct vec3 v = tracer->scene->vertices[i];
        reach = fmax(reach, fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z))));
    }
    off = (float)(reach * OFF);
    attach(device, RTC_GEOMETRY_TYPE_TRIANGLE, n[0], 0);
    attach(device, RTC_GEOMETRY_TYPE_SPHERE_POINT, n[1], 1);
    rtcCommitScene(scene);
}

/* ---- the comparison -------------------------------------------------------------------------- */

/* Milliseconds. */
static double render(const struct kernels *k, uint32_t w, uint32_t h, float *rgba)
{
    tracer->k = k;
    coherent = k == &embree[2];
    int64_t begin = cpu_us();
    for (uint32_t y = 0; y < h; y++) {
        const struct lattice row = {0, y, w, 1, 1, 1};
        tracer_pixels(tracer, &row, 0, w, rgba + (size_t)4 * y * w);
    }
    return (double)(cpu_us() - begin) / 1000;
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

static void compare(int runs, uint32_t w, uint32_t h, double ours_ms, double embree_ms, int n)
{
    const struct kernels *const k[KINDS] = {tracer->k, &embree[0], &embree[1], &embree[2]};
    size_t pixels = (size_t)w * h;
    double took_ms[KINDS][RUNS_MAX];
    float *rgba[KINDS];
    for (int i = 0; i < n; i++) rgba[i] = xmalloc(pixels, 4 * sizeof **rgba);
    for (int r = 0; r < runs; r++)
        for (int i = 0; i < n; i++) took_ms[i][r] = render(k[i], w, h, rgba[i]);
    for (int i = 0; i < n; i++) {
        size_t far;
        double rmse = apart(rgba[0], rgba[i], pixels, &far);
        printf("%s\t%.2f\t%.2f\t%.2g\t%zu\n", i ? k[i]->name : "ours", i ? embree_ms : ours_ms,
            stats_median(took_ms[i], (size_t)runs), rmse, far);
    }
    for (int i = 0; i < n; i++) free(rgba[i]);
}

int main(int argc, char **argv)
{
    struct buf text = {0};
    struct scene s;
    char err[SCENE_ERR];
    int w, h;
    const struct trace_options o = TRACE_OPTIONS_DEFAULT;
    prog_init(argv[0]);
    if (argc != 4 || !parse_size(argv[2], FRAME_SIDE_MAX, &w, &h))
        usage(ST_USAGE, "RUNS WxH SCENE");
    int runs = (int)opt_int('n', argv[1], 1, RUNS_MAX);
    if (read_file(argv[3], &text) != 0) die(ST_USAGE, "%s:", argv[3]);
    if (nff_read(argv[3], (const char *)buf_data(&text), buf_size(&text), &s, err) != 0)
        die(ST_USAGE, "%s", err);
    int64_t began = cpu_us();
    tracer = tracer_new(&s, &o);
    double ours_ms = (double)(cpu_us() - began) / 1000;
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    began = cpu_us();
    embree_build(device);
    double embree_ms = (double)(cpu_us() - began) / 1000;
    tracer_frame(tracer, (uint32_t)w, (uint32_t)h);
    bool packets = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
    compare(runs, (uint32_t)w, (uint32_t)h, ours_ms, embree_ms, packets ? KINDS : 2);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    tracer_free(tracer);
    scene_free(&s);
    buf_free(&text);
    for (int i = 0; i < 2; i++) free(item_of[i]);
    close_stdout();
    return ST_OK;
}
