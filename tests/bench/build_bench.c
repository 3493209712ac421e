/*
 * build_bench KIND SCENE: reads a scene and builds a hierarchy over it: `ours`, or Embree's at
 * `medium` or `high` quality. Prints tab-separated: CPU ms to read, CPU ms to build, the peak of the
 * resident set in MB, items, and the bytes of the peak for each item.
 *
 * Embree gets float copies of the same scene: triangles by our triangulation, which its time
 * includes as ours does, spheres, and cones as linear curves with cone segments.
 */
#include "base/base.h"
#include "scene/scene.h"
#include "trace/trace_int.h"

#include <embree3/rtcore.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

struct counts {
    uint32_t triangles, spheres, cones, largest;
};

static struct counts count(const struct scene *s)
{
    struct counts n = {.largest = 3};
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *p = &s->prims[i];
        if (p->kind == PRIM_SPHERE) n.spheres++;
        else if (p->kind == PRIM_CONE) n.cones++;
        else if (!prim_is_poly(p)) die(ST_USAGE, "primitive %u is unknown to Embree", i + 1);
        if (!prim_is_poly(p)) continue;
        n.triangles += p->poly.count - 2;
        if (p->poly.count > n.largest) n.largest = p->poly.count;
    }
    return n;
}

static void put(float *to, struct vec3 v)
{
    to[0] = (float)v.x;
    to[1] = (float)v.y;
    to[2] = (float)v.z;
}

static void attach(RTCScene scene, RTCGeometry g)
{
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene, g);
    rtcReleaseGeometry(g);
}

static void add_triangles(RTCDevice d, RTCScene to, const struct scene *s, const struct counts *n)
{
    RTCGeometry g = rtcNewGeometry(d, RTC_GEOMETRY_TYPE_TRIANGLE);
    uint32_t *corner = rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof *corner, n->triangles);
    struct triangle *some = xmalloc(n->largest - 2, sizeof *some);
    size_t k = 0;
    for (uint32_t i = 0; i < s->n_prims; i++) {
        if (!prim_is_poly(&s->prims[i])) continue;
        uint32_t found = scene_triangulate(s, &s->prims[i], some);
        memcpy(corner + 3 * k, some, found * sizeof *some);
        k += found;
    }
    memset(corner + 3 * k, 0, (n->triangles - k) * sizeof *some);
    free(some);
    float *v = rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof *v, s->n_vertices);
    for (size_t i = 0; i < s->n_vertices; i++) put(v + 3 * i, s->vertices[i]);
    attach(to, g);
}

static void add_spheres(RTCDevice d, RTCScene to, const struct scene *s, uint32_t n)
{
    RTCGeometry g = rtcNewGeometry(d, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    float *v =
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof *v, n);
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *p = &s->prims[i];
        if (p->kind != PRIM_SPHERE) continue;
        put(v, p->sphere.center);
        v[3] = (float)p->sphere.radius;
        v += 4;
    }
    attach(to, g);
}

static void add_cones(RTCDevice d, RTCScene to, const struct scene *s, uint32_t n)
{
    RTCGeometry g = rtcNewGeometry(d, RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE);
    float *v = rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof *v, (size_t)2 * n);
    uint32_t *first =
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof *first, n);
    for (uint32_t i = 0; i < n; i++) first[i] = 2 * i;
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *p = &s->prims[i];
        if (p->kind != PRIM_CONE) continue;
        put(v, p->cone.base);
        v[3] = (float)p->cone.base_radius;
        put(v + 4, p->cone.apex);
        v[7] = (float)p->cone.apex_radius;
        v += 8;
    }
    attach(to, g);
}

/* The scene stays: a picture is made with it. */
static void build_embree(const struct scene *s, enum RTCBuildQuality quality)
{
    struct counts n = count(s);
    RTCDevice d = rtcNewDevice("threads=1,set_affinity=0");
    RTCScene to = rtcNewScene(d);
    rtcSetSceneBuildQuality(to, quality);
    if (n.triangles) add_triangles(d, to, s, &n);
    if (n.spheres) add_spheres(d, to, s, n.spheres);
    if (n.cones) add_cones(d, to, s, n.cones);
    rtcCommitScene(to);
    if (rtcGetDeviceError(d) != RTC_ERROR_NONE) die(ST_SYSTEM, "Embree failed");
}

int main(int argc, char **argv)
{
    struct buf text = {0};
    struct scene s;
    struct rusage used;
    char err[SCENE_ERR];
    const struct trace_options o = TRACE_OPTIONS_DEFAULT;
    prog_init(argv[0]);
    if (argc != 3) usage(ST_USAGE, "ours|medium|high SCENE");
    int64_t began = cpu_us();
    if (read_file(argv[2], &text) != 0) die(ST_USAGE, "%s:", argv[2]);
    if (nff_read(argv[2], (const char *)buf_data(&text), buf_size(&text), &s, err) != 0)
        die(ST_USAGE, "%s", err);
    buf_free(&text);
    int64_t read = cpu_us();
    if (strcmp(argv[1], "ours") == 0) tracer_new(&s, &o);
    else if (strcmp(argv[1], "medium") == 0) build_embree(&s, RTC_BUILD_QUALITY_MEDIUM);
    else build_embree(&s, RTC_BUILD_QUALITY_HIGH);
    int64_t built = cpu_us();
    if (getrusage(RUSAGE_SELF, &used) != 0) die(ST_SYSTEM, "getrusage:");
    struct counts n = count(&s);
    uint32_t items = n.triangles + n.spheres + n.cones;
    printf("%.1f\t%.1f\t%.1f\t%u\t%.0f\n", (double)(read - began) / 1000,
        (double)(built - read) / 1000, (double)used.ru_maxrss / 1024, items,
        (double)used.ru_maxrss * 1024 / items);
    close_stdout();
    return ST_OK;
}
