/*
 * items: the items of a scene, and a reference to each that has a surface. Threads take chunks of
 * CHUNK primitives. Items have the same numbers with any number of threads.
 */
#include "os/os.h"
#include "trace/trace_int.h"

#include <stdlib.h>
#include <string.h>

#define CHUNK 2048 /* primitives */

struct part {
    uint32_t first;           /* room for its items begins here */
    uint32_t most;            /* items at most: triangulation may find fewer */
    uint32_t n_items, n_refs; /* those made, from first on */
    uint32_t largest;         /* vertices of the largest polygon */
    double reach;
};

struct making {
    struct tracer *t;
    struct ref *refs;
    struct part *parts;
};

static double larger(double a, double b) { return a > b ? a : b; }

static double farther(double reach, struct vec3 p)
{
    return larger(reach, larger(fabs(p.x), larger(fabs(p.y), fabs(p.z))));
}

static uint32_t end_of(const struct scene *s, uint32_t chunk)
{
    uint32_t end = (chunk + 1) * CHUNK;
    return end < s->n_prims ? end : s->n_prims;
}

static void count_part(void *ctx, uint32_t i)
{
    struct making *m = ctx;
    const struct scene *s = m->t->scene;
    struct part part = {.largest = 3};
    for (uint32_t k = i * CHUNK, end = end_of(s, i); k < end; k++) {
        const struct prim *p = &s->prims[k];
        if (prim_is_poly(p)) {
            part.most += p->poly.count - 2;
            if (p->poly.count > part.largest) part.largest = p->poly.count;
            for (uint32_t v = 0; v < p->poly.count; v++)
                part.reach = farther(part.reach, s->vertices[p->poly.first + v]);
        } else {
            struct vec3 lo, hi;
            part.most++;
            scene_prim_bounds(s, p, &lo, &hi);
            part.reach = farther(farther(part.reach, lo), hi);
        }
    }
    m->parts[i] = part;
}

/* Adds an item. Adds a reference only if the item has a surface. */
static void add_item(struct making *m, struct part *part, struct item it)
{
    struct tracer *t = m->t;
    const struct shape *shape = trace_shapes[it.kind];
    uint32_t at = part->first + part->n_items++;
    if (shape->has_surface(t->scene, &it)) {
        struct vec3 lo, hi;
        shape->bounds(t->scene, &it, &lo, &hi);
        m->refs[part->first + part->n_refs++] =
            (struct ref){{(float)lo.x, (float)lo.y, (float)lo.z}, at,
                {(float)hi.x, (float)hi.y, (float)hi.z}, it.kind};
    }
    t->items[at] = it;
}

static void make_part(void *ctx, uint32_t i)
{
    struct making *m = ctx;
    const struct scene *s = m->t->scene;
    struct part *part = &m->parts[i];
    struct triangle *tri = xmalloc(part->largest - 2, sizeof *tri);
    os_populate(m->t->items + part->first, part->most * sizeof *m->t->items);
    os_populate(m->refs + part->first, part->most * sizeof *m->refs);
    for (uint32_t k = i * CHUNK, end = end_of(s, i); k < end; k++) {
        const struct prim *p = &s->prims[k];
        struct item it = {.prim = k, .material = p->material & MATERIAL_MASK};
        it.kind = trace_kind_of(p);
        if (it.kind != ITEM_TRIANGLE) {
            add_item(m, part, it);
            continue;
        }
        it.smooth = p->kind == PRIM_PATCH;
        uint32_t n = scene_triangulate(s, p, tri);
        for (uint32_t j = 0; j < n; j++) {
            memcpy(it.vertex, tri[j].v, sizeof it.vertex);
            add_item(m, part, it);
        }
    }
    free(tri);
}

/* Closes the gaps between the parts. Returns the number of references. */
static uint32_t close_gaps(struct making *m, uint32_t n_parts)
{
    struct tracer *t = m->t;
    uint32_t n_refs = 0;
    for (uint32_t i = 0; i < n_parts; i++) {
        const struct part *p = &m->parts[i];
        uint32_t gap = p->first - t->n_items;
        if (gap) memmove(t->items + t->n_items, t->items + p->first, p->n_items * sizeof *t->items);
        if (p->first > n_refs)
            memmove(m->refs + n_refs, m->refs + p->first, p->n_refs * sizeof *m->refs);
        for (uint32_t k = 0; gap && k < p->n_refs; k++) m->refs[n_refs + k].item -= gap;
        t->n_items += p->n_items;
        n_refs += p->n_refs;
    }
    return n_refs;
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

struct ref *items_make(struct tracer *t, uint32_t *n_refs, struct parallel *p)
{
    const struct scene *s = t->scene;
    uint32_t n_parts = (s->n_prims + CHUNK - 1) / CHUNK;
    uint64_t n = 0;
    struct making m = {t, NULL, xmalloc(n_parts, sizeof *m.parts)};
    if (s->n_materials > MATERIAL_MASK) die(ST_SYSTEM, "too many materials");
    parallel_run(p, n_parts, count_part, &m);
    for (uint32_t i = 0; i < n_parts; i++) {
        m.parts[i].first = (uint32_t)n;
        n += m.parts[i].most;
        if (n > INT32_MAX) die(ST_SYSTEM, "too many primitives");
        t->item_reach = larger(t->item_reach, m.parts[i].reach);
    }
    t->items = xmalloc(n, sizeof *t->items);
    m.refs = xaligned(n, sizeof *m.refs);
    parallel_run(p, n_parts, make_part, &m);
    *n_refs = close_gaps(&m, n_parts);
    free(m.parts);
    make_transmits(t);
    return m.refs;
}
