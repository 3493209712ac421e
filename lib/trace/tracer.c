/* tracer: the items and hierarchy of a scene, and the functions of trace.h. */
#include "trace/shade.h"
#include "trace/trace_int.h"

#include <stdlib.h>

/* Adds an item. Adds a reference only if the item has a surface. */
static void add_item(struct tracer *t, struct ref *refs, uint32_t *n_refs, struct item it)
{
    const struct shape *shape = trace_shapes[it.kind];
    if (shape->init(t->scene, &it)) {
        struct vec3 lo, hi;
        shape->bounds(t->scene, &it, &lo, &hi);
        refs[(*n_refs)++] = (struct ref){{(float)lo.x, (float)lo.y, (float)lo.z}, t->n_items,
            {(float)hi.x, (float)hi.y, (float)hi.z}, it.kind};
    }
    t->items[t->n_items++] = it;
}

static bool is_poly(const struct prim *p)
{
    return p->kind == PRIM_POLYGON || p->kind == PRIM_PATCH;
}

static void count_items(const struct scene *s, uint32_t *n_items, uint32_t *largest)
{
    uint64_t n = 0;
    *largest = 3;
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *p = &s->prims[i];
        n += is_poly(p) ? p->poly.count - 2 : 1;
        if (is_poly(p) && p->poly.count > *largest) *largest = p->poly.count;
    }
    if (n > INT32_MAX) die(ST_SYSTEM, "too many primitives");
    *n_items = (uint32_t)n;
}

static uint32_t make_items(struct tracer *t, struct ref *refs, uint32_t largest)
{
    const struct scene *s = t->scene;
    struct triangle *tri = xmalloc(largest - 2, sizeof *tri);
    uint32_t n_refs = 0;
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *p = &s->prims[i];
        struct item it = {.prim = i, .material = p->material};
        if (is_poly(p)) {
            it.kind = ITEM_TRIANGLE;
            it.smooth = p->kind == PRIM_PATCH;
            uint32_t n = scene_triangulate(s, p, tri);
            for (uint32_t k = 0; k < n; k++) {
                for (int c = 0; c < 3; c++) it.vertex[c] = tri[k].v[c];
                add_item(t, refs, &n_refs, it);
            }
        } else {
            it.kind = p->kind == PRIM_SPHERE ? ITEM_SPHERE : ITEM_CONE;
            add_item(t, refs, &n_refs, it);
        }
    }
    free(tri);
    return n_refs;
}

static double farther(double reach, struct vec3 p)
{
    return fmax(reach, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
}

/* The largest absolute coordinate of a ray's origin or hit. */
static double reach_of(const struct scene *s)
{
    double reach = farther(0, s->view.from);
    for (uint32_t i = 0; i < s->n_lights; i++) reach = farther(reach, s->lights[i].pos);
    for (uint32_t i = 0; i < s->n_vertices; i++) reach = farther(reach, s->vertices[i]);
    for (uint32_t i = 0; i < s->n_prims; i++) {
        struct vec3 lo, hi;
        if (is_poly(&s->prims[i])) continue;
        scene_prim_bounds(s, &s->prims[i], &lo, &hi);
        reach = farther(farther(reach, lo), hi);
    }
    return reach;
}

static void make_surfaces(struct tracer *t)
{
    const struct scene *s = t->scene;
    t->surfaces = xmalloc(s->n_materials, sizeof *t->surfaces);
    for (uint32_t i = 0; i < s->n_materials; i++) {
        const struct material *m = &s->materials[i];
        struct vec3 c = v3(m->r * m->kd, m->g * m->kd, m->b * m->kd);
        /* A refractive index of 0 means opaque. On a transmitting material it means no bending. */
        t->surfaces[i] = (struct surface){
            c, m->ks, m->shine, m->t, m->ior > 0 ? m->ior : 1, c.x != 0 || c.y != 0 || c.z != 0};
    }
}

/* Leaves transmits NULL if no material transmits. Shadow rays then end at the first hit. */
static void make_transmits(struct tracer *t)
{
    bool any = false;
    for (uint32_t i = 0; i < t->scene->n_materials; i++) any = any || t->scene->materials[i].t > 0;
    if (!any) return;
    t->transmits = xmalloc(t->n_items, 1);
    for (uint32_t i = 0; i < t->n_items; i++)
        t->transmits[i] = t->scene->materials[t->items[i].material].t > 0;
}

static const struct kernels *choose_kernels(const struct trace_options *o)
{
    if (o->hierarchy != HIERARCHY_BVH || o->count_tests) return slabs_kernels();
    const struct kernels *k = NULL;
    if (o->isa == ISA_AUTO || o->isa == ISA_AVX512) k = trace_kernels_avx512();
    if (!k && o->isa != ISA_SSE2) k = trace_kernels_avx2();
    return k ? k : trace_kernels_sse2();
}

static const struct shaders *choose_shaders(enum isa isa)
{
    const struct shaders *wide = isa == ISA_SSE2 ? NULL : trace_shaders_avx2();
    return wide ? wide : trace_shaders_sse2();
}

/* Both ends of a shadow ray are within reach of 0 along each axis. So 8 * reach exceeds the bound
 * on the light's error (ends.h). */
static void mark_lights(struct tracer *t, double reach)
{
    const struct scene *s = t->scene;
    t->light_in_surface = xcalloc(s->n_lights, sizeof *t->light_in_surface);
    for (uint32_t i = 0; i < s->n_lights; i++)
        t->light_in_surface[i] =
            bvh_holds(&t->bvh, s, t->items, s->lights[i].pos, ERR_UNIT * 8 * reach);
}

struct tracer *tracer_new(const struct scene *s, const struct trace_options *o)
{
    struct tracer *t = xcalloc(1, sizeof *t);
    uint32_t n, largest;
    t->scene = s;
    t->options = *o;
    t->k = choose_kernels(o);
    t->shaders = choose_shaders(o->isa);
    count_items(s, &n, &largest);
    t->items = xmalloc(n, sizeof *t->items);
    struct ref *refs = xaligned(n, sizeof *refs);
    double reach = reach_of(s);
    uint32_t n_refs = make_items(t, refs, largest);
    make_surfaces(t);
    make_transmits(t);
    bound_radiance(t);
    if (o->hierarchy == HIERARCHY_BVH) bvh_build(&t->bvh, refs, n_refs, s, t->items, reach);
    else slabs_build(&t->bvh, refs, n_refs, s, t->items, reach, o->hierarchy == HIERARCHY_SLABS);
    t->bvh.tests = &t->tests;
    free(refs);
    mark_lights(t, reach);
    t->wave = wave_new(t);
    const struct view *v = &s->view;
    t->camera = camera_new(v->from, v->at, v->up, v->angle_deg);
    if (t->transmits) media_around(t, v3_mad(v->from, t->camera.forward, v->hither), &t->around);
    tracer_frame(t, v->res_x, v->res_y);
    return t;
}

void tracer_free(struct tracer *t)
{
    if (!t) return;
    bvh_free(&t->bvh);
    free(t->items);
    free(t->surfaces);
    free(t->transmits);
    free(t->light_in_surface);
    for (int i = 0; i < PACKET; i++) free(t->crossings[i].item);
    wave_free(t->wave);
    free(t);
}

void tracer_frame(struct tracer *t, uint32_t w, uint32_t h)
{
    t->camera.w = w;
    t->camera.h = h;
}

void tracer_counts(const struct tracer *t, struct trace_counts *c) { *c = t->counts; }

void tracer_tests(const struct tracer *t, struct trace_tests *c)
{
    *c = t->tests;
    c->bytes =
        t->bvh.slabs ? slabs_bytes(t->bvh.slabs) : (uint64_t)t->bvh.n_nodes * sizeof *t->bvh.nodes;
}
