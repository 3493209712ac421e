/*
 * wave: the samples of neighbouring pixels are traced together. In each round every unfinished
 * sample traces one ray: first the eye ray, then the pending ray of largest weight. The rays
 * of a round are traced in packets, and shaded in vectors (shade.h). Then their shadow rays are
 * traced, one light after another. Rays that can bring too little are dropped (pending.h), and so
 * are shadow rays.
 *
 * The order of a sample's rays depends only on that sample, so a pixel does not depend on the other
 * pixels of the wave.
 */
#include "trace/pending.h"
#include "trace/shade.h"
#include "trace/trace_int.h"

#include <stdlib.h>

#define ALONE 256 /* pending rays of a sample that is finished alone, so that memory is bounded */
#define PACKET_MIN 3 /* fewer rays are traced one by one */
/* A shadow ray is dropped if it can bring at most this part of the remaining shadow budget. */
#define SHADOW_PART 0.0625

/* A sample, and the ray that it traces in this round. */
struct sample {
    struct pending_rays rays;
    struct vec3 *colour;
    double shadow_budget; /* not spent yet */
    const struct ray *eye;
    uint32_t around; /* the media of the eye ray */
    uint32_t now;    /* index of the ray in the pool */
    struct hit h;
    struct hit_point at;
    struct vec3 light; /* direct light only */
};

/* A shadow ray that waits for its packet. */
struct shadow_query {
    struct ray ray;
    struct vec3 light; /* contribution if the ray is not blocked */
    struct vec3 *sum;
};

struct wave {
    struct sample sample[WAVE_RAYS];
    struct pending_pool pool;
    struct shadow_query query[PACKET];
    uint32_t n_queries;
    struct shade_points at; /* of the samples that are shaded */
    struct shade_light lit;
    uint32_t eye; /* the entry of the pool that all eye rays share, except ray and media */
};

struct wave *wave_new(void)
{
    struct wave *w = xcalloc(1, sizeof *w);
    pending_pool_init(&w->pool);
    w->eye = pending_new(&w->pool);
    w->pool.at[w->eye] = (struct pending){.weight = 1, .level = 1};
    return w;
}

void wave_free(struct wave *w)
{
    for (int i = 0; w && i < WAVE_RAYS; i++) free(w->sample[i].rays.heap);
    if (w) pending_pool_free(&w->pool);
    free(w);
}

static inline const struct ray *ray_now(const struct wave *w, const struct sample *s)
{
    return s->now == w->eye ? s->eye : &w->pool.at[s->now].ray;
}

static inline uint32_t media_now(const struct wave *w, const struct sample *s)
{
    return s->now == w->eye ? s->around : w->pool.at[s->now].media;
}

/* Adds the light that the ray of this round brings. */
static inline void bring(struct wave *w, struct sample *s, struct vec3 light)
{
    *s->colour = v3_mad(*s->colour, light, w->pool.at[s->now].weight);
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
    if (n < PACKET_MIN)
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
    t->counts.of[RAY_SHADOW].rays += n;
    t->counts.of[RAY_SHADOW].hits += (uint64_t)__builtin_popcount(blocked);
    w->n_queries = 0;
}

/* True if the sample's budget covers the loss of this light. */
static bool dropped(struct sample *s, struct vec3 light, double weight)
{
    double most = light.y > light.z ? light.y : light.z;
    double loss = weight * (light.x > most ? light.x : most);
    if (loss > s->shadow_budget * SHADOW_PART) return false;
    s->shadow_budget -= loss;
    return true;
}

/* Copies the points of the listed samples to lanes. */
static void gather_points(struct wave *w, struct sample *const *list, uint32_t n)
{
    struct shade_points *to = &w->at;
    for (uint32_t i = 0; i < n; i++) {
        const struct hit_point *at = &list[i]->at;
        const struct surface *f = at->surface;
        to->p[0][i] = at->p.x, to->p[1][i] = at->p.y, to->p[2][i] = at->p.z;
        to->n[0][i] = at->n.x, to->n[1][i] = at->n.y, to->n[2][i] = at->n.z;
        to->mirrored[0][i] = at->mirrored.x, to->mirrored[1][i] = at->mirrored.y;
        to->mirrored[2][i] = at->mirrored.z, to->err[i] = at->err;
        to->colour_kd[0][i] = f->colour_kd.x, to->colour_kd[1][i] = f->colour_kd.y;
        to->colour_kd[2][i] = f->colour_kd.z, to->ks[i] = f->ks, to->shine[i] = f->shine;
    }
}

/* The next query has a shadow ray of s and its light: keeps it, unless it brings too little. */
static inline void keep_query(struct tracer *t, struct wave *w, struct sample *s)
{
    const struct pending *k = &w->pool.at[s->now];
    struct shadow_query *a = &w->query[w->n_queries];
    if (!t->options.by_spd && dropped(s, a->light, k->weight)) return;
    a->sum = &s->light;
    if (++w->n_queries == PACKET) trace_shadows(t, w);
}

static void query_all(
    struct tracer *t, struct wave *w, struct sample *const *list, uint32_t n, uint32_t l)
{
    const struct shade_light *lit = &w->lit;
    uint64_t bits = t->shaders->light(&w->at, n, &t->scene->lights[l], &w->lit);
    for (; bits; bits &= bits - 1) {
        int i = __builtin_ctzll(bits);
        struct sample *s = list[i];
        struct shadow_query *a = &w->query[w->n_queries];
        a->light = v3(lit->light[0][i], lit->light[1][i], lit->light[2][i]);
        a->ray = (struct ray){s->at.p, v3(lit->d[0][i], lit->d[1][i], lit->d[2][i]), 0,
            lit->distance[i], s->at.err, t->light_in_surface[l], s->at.start};
        keep_query(t, w, s);
    }
}

static void shade_direct(struct tracer *t, struct wave *w, struct sample *const *list, uint32_t n)
{
    w->at.all = t->options.by_spd;
    if (n > 1) gather_points(w, list, n);
    for (uint32_t l = 0; l < t->scene->n_lights; l++) {
        struct shadow_query *a = &w->query[0];
        if (n > 1) query_all(t, w, list, n, l);
        else if (light_from(t, &list[0]->at, l, &a->light, &a->ray)) keep_query(t, w, list[0]);
        trace_shadows(t, w);
    }
}

/* ---- rounds ------------------------------------------------------------------------------- */

static inline void count_ray(struct tracer *t, const struct wave *w, const struct sample *s)
{
    bool mirrored = w->pool.at[s->now].mirrored;
    enum ray_kind kind = s->now == w->eye ? RAY_EYE : mirrored ? RAY_REFLECTED : RAY_REFRACTED;
    t->counts.of[kind].rays++;
    t->counts.of[kind].hits += s->h.item != NO_ITEM;
}

/* Finds what the rays of the listed samples hit. Rays that hit nothing bring the background; the
 * other samples are left in the list. Returns their number. */
static uint32_t find_hits(struct tracer *t, struct wave *w, struct sample **list, uint32_t n)
{
    const double *b = t->scene->background;
    uint32_t hits = 0;
    for (uint32_t i = 0; i < n; i += PACKET) {
        const struct ray *ray[PACKET];
        struct hit *h[PACKET];
        uint32_t end = n - i < PACKET ? n - i : PACKET;
        for (uint32_t k = 0; k < end; k++) {
            ray[k] = ray_now(w, list[i + k]);
            h[k] = &list[i + k]->h;
        }
        if (end < PACKET_MIN)
            for (uint32_t k = 0; k < end; k++) t->k->closest(&t->bvh, ray[k], h[k]);
        else t->k->closest_packet(&t->bvh, ray, end, h);
        for (uint32_t k = 0; k < end; k++) {
            struct sample *s = list[i + k];
            count_ray(t, w, s);
            if (h[k]->item == NO_ITEM) {
                bring(w, s, v3(b[0], b[1], b[2]));
                continue;
            }
            trace_hit_point(t, ray[k], h[k], &s->at);
            list[hits++] = s;
        }
    }
    return hits;
}

/* Adds a ray to the sample's pending ones. It becomes the user of `media`. */
static void add_ray(const struct tracer *t, struct wave *w, struct sample *s, const struct ray *r,
    double weight, int level, uint32_t media, uint64_t hops, bool mirrored)
{
    uint32_t i = pending_new(&w->pool);
    struct pending *k = &w->pool.at[i];
    k->ray = *r;
    k->weight = weight;
    k->bound = weight * t->radiance[level];
    k->hops = hops;
    k->level = level;
    k->mirrored = mirrored;
    k->media = media;
    pending_push(&s->rays, &w->pool, i);
}

/* Adds the secondary rays of the ray that the sample has traced. */
static void send_on(struct tracer *t, struct wave *w, struct sample *s)
{
    const struct pending *k = &w->pool.at[s->now];
    const struct surface *f = s->at.surface;
    if (!(f->ks > 0 || f->t > 0) || k->level >= t->options.depth) return;
    /* A straight ray crosses a surface at most twice. The bound guarantees that a tree ends. */
    if (k->hops > ((uint64_t)2 * t->n_items + 1) * TRACE_DEPTH_MAX) return;
    struct onward o;
    struct media *m = &w->pool.media;
    uint32_t outside = media_now(w, s);
    trace_spawn_secondary(t, ray_now(w, s), &s->at, k->level, m, outside, &o);
    uint64_t hops = k->hops + 1;
    double weight = k->weight; /* adding rays may move k */
    t->counts.turned_back += f->t > 0 && !o.passed;
    if (o.passed)
        add_ray(
            t, w, s, &o.through, weight * o.through_weight, o.through_level, o.inside, hops, false);
    if (o.reflected)
        add_ray(t, w, s, &o.mirror, weight * o.mirror_weight, o.mirror_level,
            media_keep(m, outside), hops, true);
}

/* Traces the rays `now` of the listed samples, and leaves the samples whose rays hit something in
 * the list. Returns their number. */
static uint32_t trace_round(struct tracer *t, struct wave *w, struct sample **list, uint32_t n)
{
    uint32_t hits = find_hits(t, w, list, n);
    for (uint32_t i = 0; i < hits; i++) list[i]->light = v3(0, 0, 0);
    if (hits) shade_direct(t, w, list, hits);
    for (uint32_t i = 0; i < hits; i++) {
        bring(w, list[i], list[i]->light);
        send_on(t, w, list[i]);
    }
    return hits;
}

/* The same for the pending rays of largest weight. */
static void trace_pending(struct tracer *t, struct wave *w, struct sample *const *list, uint32_t n)
{
    struct sample *round[WAVE_RAYS];
    for (uint32_t i = 0; i < n; i++) {
        struct sample *s = round[i] = list[i];
        s->now = pending_pop(&s->rays, &w->pool);
    }
    trace_round(t, w, round, n);
    for (uint32_t i = 0; i < n; i++) pending_release(&w->pool, list[i]->now);
}

/* Removes the finished samples from list[first .. n). Samples with more than `most` pending rays
 * come first then, and *first counts them. Returns the number of samples. */
static uint32_t unfinished(const struct tracer *t, struct wave *w, struct sample **list, uint32_t n,
    uint32_t *first, uint32_t most)
{
    uint32_t end = *first;
    for (uint32_t i = *first; i < n; i++) {
        struct sample *s = list[i];
        if (pending_end(&s->rays, &w->pool, t->options.budget / 2)) continue;
        list[end++] = s;
        if (s->rays.n <= most) continue;
        list[end - 1] = list[*first];
        list[(*first)++] = s;
    }
    return end;
}

/* Traces pending rays of the listed samples until each is finished or has more than `most` pending
 * rays. Returns the number of these; they come first. */
static uint32_t trace_samples(
    struct tracer *t, struct wave *w, struct sample **list, uint32_t n, uint32_t most)
{
    uint32_t large = 0;
    for (n = unfinished(t, w, list, n, &large, most); large < n;
         n = unfinished(t, w, list, n, &large, most))
        trace_pending(t, w, list + large, n - large);
    return large;
}

void wave_colours(struct tracer *t, const struct ray *eye, uint32_t n, struct vec3 *colour)
{
    struct wave *w = t->wave;
    struct sample *list[WAVE_RAYS];
    for (uint32_t i = 0; i < n; i++) {
        struct sample *s = list[i] = &w->sample[i];
        colour[i] = v3(0, 0, 0);
        s->colour = &colour[i];
        s->rays.over = 0;
        s->shadow_budget = t->options.budget / 2;
        s->eye = &eye[i];
        s->around = media_around(t, v3_mad(eye[i].o, eye[i].d, eye[i].t_min), &w->pool.media);
        s->now = w->eye;
    }
    uint32_t hits = trace_round(t, w, list, n);
    for (uint32_t i = 0; i < n; i++) media_drop(&w->pool.media, w->sample[i].around);
    uint32_t large = trace_samples(t, w, list, hits, n > 1 ? ALONE : UINT32_MAX);
    for (uint32_t i = 0; i < large; i++) trace_samples(t, w, &list[i], 1, UINT32_MAX);
}
