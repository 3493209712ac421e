/* tracer: what a scene needs besides items and hierarchy, and the functions of trace.h. */
#include "trace/shade.h"
#include "trace/trace_int.h"

#include <stdlib.h>

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

/* If the light lies on an item, both ends of its shadow rays are within reach of 0 along each axis.
 * So 8 * reach exceeds the bound on the light's error (lanes.h). */
static void mark_lights(struct tracer *t)
{
    const struct scene *s = t->scene;
    for (uint32_t i = 0; i < s->n_lights; i++)
        t->light_in_surface[i] =
            bvh_holds(&t->bvh, s, t->items, s->lights[i].pos, ERR_UNIT * 8 * t->reach);
}

/*
 * A power of two, so that it is the same for most views, and views that have the same one need the
 * same blocks. Lights do not count: one that is far away would widen every edge and box.
 */
static double reach_of(const struct tracer *t, struct vec3 eye)
{
    int power;
    frexp(fmax(t->item_reach, fmax(fabs(eye.x), fmax(fabs(eye.y), fabs(eye.z)))), &power);
    return ldexp(1, power);
}

static bool same(struct vec3 a, struct vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static bool same_view(const struct view *a, const struct view *b)
{
    return same(a->from, b->from) && same(a->at, b->at) && same(a->up, b->up) &&
           a->angle_deg == b->angle_deg && a->hither == b->hither;
}

/* The size of the frame is lost. */
static void set_view(struct tracer *t, const struct view *v)
{
    t->view = *v;
    t->camera = camera_new(v->from, v->at, v->up, v->angle_deg);
}

struct tracer *tracer_new(const struct scene *s, const struct trace_options *o)
{
    struct tracer *t = xcalloc(1, sizeof *t);
    struct parallel *p = parallel_new(o->threads);
    uint32_t n_refs;
    t->scene = s;
    t->options = *o;
    t->k = choose_kernels(o);
    t->shaders = choose_shaders(o->isa);
    struct ref *refs = items_make(t, &n_refs, p);
    t->reach = reach_of(t, s->view.from);
    make_surfaces(t);
    bound_radiance(t);
    if (o->hierarchy == HIERARCHY_BVH) bvh_build(&t->bvh, refs, n_refs, s, t->items, t->reach, p);
    else slabs_build(&t->bvh, refs, n_refs, s, t->items, t->reach, o->hierarchy == HIERARCHY_SLABS);
    t->bvh.tests = &t->tests;
    free(refs);
    parallel_free(p);
    t->light_in_surface = xcalloc(s->n_lights, sizeof *t->light_in_surface);
    mark_lights(t);
    t->wave = wave_new();
    set_view(t, &s->view);
    tracer_frame(t, s->view.res_x, s->view.res_y);
    return t;
}

void tracer_free(struct tracer *t)
{
    if (!t) return;
    bvh_free(&t->bvh);
    free(t->items);
    free(t->surfaces);
    free(t->transmits);
    free(t->enclosing);
    free(t->light_in_surface);
    for (int i = 0; i < PACKET; i++) free(t->crossings[i].item);
    wave_free(t->wave);
    free(t);
}

/* Blocks and marks depend on the reach; all else that was built does not depend on the view. */
static void set_reach(struct tracer *t, double reach)
{
    struct parallel *p = parallel_new(t->options.threads);
    t->reach = reach;
    bvh_reach(&t->bvh, t->scene, t->items, reach, p);
    parallel_free(p);
    mark_lights(t);
}

void tracer_look(struct tracer *t, const struct view *v)
{
    const uint32_t w = t->camera.w, h = t->camera.h;
    if (!v) v = &t->scene->view;
    if (same_view(v, &t->view)) return;
    const double reach = reach_of(t, v->from);
    if (reach != t->reach) set_reach(t, reach);
    set_view(t, v);
    tracer_frame(t, w, h);
}

void tracer_frame(struct tracer *t, uint32_t w, uint32_t h)
{
    if (w == t->camera.w && h == t->camera.h) return;
    t->camera.w = w;
    t->camera.h = h;
    media_list_enclosing(t);
}

void tracer_counts(const struct tracer *t, struct trace_counts *c) { *c = t->counts; }

void tracer_tests(const struct tracer *t, struct trace_tests *c)
{
    *c = t->tests;
    c->bytes =
        t->bvh.slabs ? slabs_bytes(t->bvh.slabs) : (uint64_t)t->bvh.n_nodes * sizeof *t->bvh.nodes;
}
