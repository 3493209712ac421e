/*
 * wave: the eye rays of neighbouring pixels are traced together, level by level. The rays of one
 * level are traced in packets. Then their shadow rays are traced, one light after another. The
 * secondary rays of the hit surfaces form the next level (as in P. Hanrahan, "Using caching and
 * breadth-first search to speed up ray-tracing", Graphics Interface 1986).
 *
 * Every ray is a node of its eye ray's tree and stores its weight. A tree's colours are summed in
 * preorder at the end, so a pixel does not depend on the other pixels of the wave. If the pool is
 * full, the rest of a tree is traced depth first, one ray at a time, with the same operations in
 * the same order.
 */
#include "trace/trace_int.h"

#include <stdlib.h>

#define POOL 1024 /* nodes of one wave */
#define NONE UINT32_MAX

struct node {
    struct ray ray;
    double weight; /* share of this ray's light in the eye ray's light */
    int level;
    uint32_t mirror, through; /* children */
    uint32_t from;            /* primitive it starts from; NONE: the eye or a curved primitive */
    bool late;                /* its secondary rays are traced during summation */
    struct hit h;
    struct point at;
    struct vec3 light; /* direct light only */
};

/* A shadow ray that waits for its packet. */
struct shadow_query {
    struct ray ray;
    struct vec3 light; /* contribution if the ray is not blocked */
    struct vec3 *sum;
    uint32_t prim;
};

struct wave {
    struct node node[POOL];
    uint32_t n;
    struct media *media; /* one per node; NULL if nothing transmits */
    struct shadow_query query[PACKET];
    uint32_t n_queries;
};

struct wave *wave_new(const struct tracer *t)
{
    struct wave *w = xmalloc(1, sizeof *w);
    w->media = t->transmits ? xmalloc(POOL, sizeof *w->media) : NULL;
    w->n_queries = 0;
    return w;
}

void wave_free(struct wave *w)
{
    if (w) free(w->media);
    free(w);
}

static struct vec3 background(const struct tracer *t)
{
    const double *b = t->scene->background;
    return v3(b[0], b[1], b[2]);
}

/* ---- lights ------------------------------------------------------------------------------ */

/* Traces the waiting shadow rays and adds their light. A packet holds each sum at most once: lights
 * are processed one after another. */
static void trace_shadows(struct tracer *t, struct wave *w)
{
    const struct ray *ray[PACKET];
    uint32_t n = w->n_queries;
    for (uint32_t i = 0; i < n; i++) {
        ray[i] = &w->query[i].ray;
        t->crossings[i].n = 0;
    }
    unsigned blocked = 0;
    if (n == 0) return;
    if (n == 1 || w->query[0].prim != w->query[n - 1].prim)
        for (uint32_t i = 0; i < n; i++)
            blocked |= (unsigned)t->k->blocked(&t->bvh, ray[i], t->transmits, &t->crossings[i])
                       << i;
    else blocked = t->k->blocked_packet(&t->bvh, ray, n, t->transmits, t->crossings);
    for (uint32_t i = 0; i < n; i++) {
        if (blocked >> i & 1) continue;
        const struct shadow_query *a = &w->query[i];
        double part = t->crossings[i].n ? light_through(t, &t->crossings[i]) : 1;
        *a->sum = v3_mad(*a->sum, a->light, part);
    }
    t->counts.shadow += n;
    w->n_queries = 0;
}

static void shade_direct(struct tracer *t, struct wave *w, uint32_t first, uint32_t end)
{
    for (uint32_t l = 0; l < t->scene->n_lights; l++) {
        for (uint32_t i = first; i < end; i++) {
            struct node *k = &w->node[i];
            struct shadow_query *a = &w->query[w->n_queries];
            if (k->h.item == NO_ITEM || !light_from(t, &k->at, l, &a->light, &a->ray)) continue;
            a->sum = &k->light;
            a->prim = k->level > 1 ? k->at.item->prim : NONE;
            if (++w->n_queries == PACKET) trace_shadows(t, w);
        }
        trace_shadows(t, w);
    }
}

/* Direct light of a single point, outside a wave. */
static struct vec3 light_one(struct tracer *t, const struct point *at)
{
    struct vec3 sum = v3(0, 0, 0), light;
    struct ray r;
    for (uint32_t l = 0; l < t->scene->n_lights; l++) {
        struct crossings *c = &t->crossings[0];
        if (!light_from(t, at, l, &light, &r)) continue;
        c->n = 0;
        t->counts.shadow++;
        if (t->k->blocked(&t->bvh, &r, t->transmits, c)) continue;
        sum = v3_mad(sum, light, c->n ? light_through(t, c) : 1);
    }
    return sum;
}

/* ---- depth first --------------------------------------------------------------------------- */

static void follow(struct tracer *t, struct ray r, double weight, int level,
    const struct media *outside, struct vec3 *sum);

/* Traces the mirrored ray of o, if any. The caller follows the transmitted ray. */
static void follow_mirror(struct tracer *t, const struct onward *o, double weight,
    const struct media *outside, struct vec3 *sum)
{
    if (!o->reflected) return;
    t->counts.reflected++;
    follow(t, o->mirror, weight * o->mirror_weight, o->mirror_level, outside, sum);
}

/* Follows a ray depth first. Transmitted rays are a loop, so recursion is bounded by levels. */
static void follow(struct tracer *t, struct ray r, double weight, int level,
    const struct media *outside, struct vec3 *sum)
{
    struct media in[2];
    int now = 0;
    media_copy(&in[0], outside);
    /* A straight ray crosses a surface at most twice. The bound guarantees that the loop ends. */
    for (uint64_t left = (uint64_t)2 * t->n_items + TRACE_DEPTH_MAX; left > 0; left--) {
        struct hit h;
        struct point at;
        struct onward o;
        t->k->closest(&t->bvh, &r, &h);
        if (h.item == NO_ITEM) {
            *sum = v3_mad(*sum, background(t), weight);
            return;
        }
        trace_hit_point(t, &r, &h, &at);
        *sum = v3_mad(*sum, light_one(t, &at), weight);
        if (level >= t->options.depth) return;
        trace_spawn_secondary(t, &r, &at, level, &in[now], &in[!now], &o);
        follow_mirror(t, &o, weight, &in[now], sum);
        if (!o.passed) return;
        t->counts.refracted++;
        r = o.through;
        weight *= o.through_weight;
        level = o.through_level;
        now = !now;
    }
}

static void follow_late(struct tracer *t, struct wave *w, const struct node *k, struct vec3 *sum)
{
    static const struct media nowhere;
    const struct media *outside = w->media ? &w->media[k - w->node] : &nowhere;
    struct media inside;
    struct onward o;
    trace_spawn_secondary(t, &k->ray, &k->at, k->level, outside, &inside, &o);
    follow_mirror(t, &o, k->weight, outside, sum);
    if (!o.passed) return;
    t->counts.refracted++;
    follow(t, o.through, k->weight * o.through_weight, o.through_level, &inside, sum);
}

/* ---- breadth first -------------------------------------------------------------------------- */

static struct node *add_node(
    struct wave *w, const struct ray *r, double weight, int level, uint32_t from)
{
    struct node *k = &w->node[w->n++];
    k->ray = *r;
    k->weight = weight;
    k->level = level;
    k->from = from;
    k->mirror = k->through = NONE;
    k->late = false;
    k->light = v3(0, 0, 0);
    return k;
}

static void find_hits(struct tracer *t, struct wave *w, uint32_t first, uint32_t end)
{
    for (uint32_t i = first; i < end; i += PACKET) {
        const struct ray *ray[PACKET];
        struct hit *h[PACKET];
        uint32_t n = end - i < PACKET ? end - i : PACKET;
        for (uint32_t k = 0; k < n; k++) {
            ray[k] = &w->node[i + k].ray;
            h[k] = &w->node[i + k].h;
        }
        if (n == 1 || w->node[i].from != w->node[i + n - 1].from ||
            (first && w->node[i].from == NONE))
            for (uint32_t k = 0; k < n; k++) t->k->closest(&t->bvh, ray[k], h[k]);
        else t->k->closest_packet(&t->bvh, ray, n, h);
        for (uint32_t k = 0; k < n; k++)
            if (h[k]->item != NO_ITEM) trace_hit_point(t, ray[k], h[k], &w->node[i + k].at);
    }
}

static void send_on(struct tracer *t, struct wave *w, uint32_t i)
{
    struct node *k = &w->node[i];
    const struct surface *f = k->at.surface;
    if (k->h.item == NO_ITEM || k->level >= t->options.depth || !(f->ks > 0 || f->t > 0)) return;
    k->late = w->n + 2 > POOL;
    if (k->late) return;
    struct onward o;
    uint32_t from = k->at.item->kind == ITEM_TRIANGLE ? k->at.item->prim : NONE;
    /* The transmitted ray's node comes after the mirrored ray's node, if any. Its media are copied
     * there. */
    struct media *m = w->media, inside;
    trace_spawn_secondary(t, &k->ray, &k->at, k->level, m ? &m[i] : NULL, &inside, &o);
    if (o.reflected) {
        t->counts.reflected++;
        k->mirror = w->n;
        if (m) media_copy(&m[w->n], &m[i]);
        add_node(w, &o.mirror, k->weight * o.mirror_weight, o.mirror_level, from);
    }
    if (o.passed) {
        t->counts.refracted++;
        k->through = w->n;
        media_copy(&m[w->n], &inside);
        add_node(w, &o.through, k->weight * o.through_weight, o.through_level, from);
    }
}

/* Preorder: a node, its mirrored subtree, its transmitted subtree. */
static void add_up(struct tracer *t, struct wave *w, uint32_t i, struct vec3 *sum)
{
    for (; i != NONE; i = w->node[i].through) {
        const struct node *k = &w->node[i];
        bool missed = k->h.item == NO_ITEM;
        *sum = v3_mad(*sum, missed ? background(t) : k->light, k->weight);
        if (k->late) follow_late(t, w, k, sum);
        if (k->mirror != NONE) add_up(t, w, k->mirror, sum);
    }
}

void wave_colours(struct tracer *t, const struct ray *eye, uint32_t n, struct vec3 *colour)
{
    struct wave *w = t->wave;
    w->n = 0;
    t->counts.eye += n;
    for (uint32_t i = 0; i < n; i++) {
        add_node(w, &eye[i], 1, 1, NONE);
        if (w->media) media_copy(&w->media[i], &t->around);
    }
    for (uint32_t first = 0, end = n; first < end; first = end, end = w->n) {
        find_hits(t, w, first, end);
        shade_direct(t, w, first, end);
        for (uint32_t i = first; i < end; i++) send_on(t, w, i);
    }
    for (uint32_t i = 0; i < n; i++) {
        colour[i] = v3(0, 0, 0);
        add_up(t, w, i, &colour[i]);
    }
}
