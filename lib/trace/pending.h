/*
 * pending: the rays of one sample that are still to be traced, the one of largest weight first.
 * When those that remain can change the sample by no more than the error budget together, the
 * sample is finished and they are dropped. So the sum of all that is dropped is bounded, unlike in
 * R. Hall, D. Greenberg, "A testbed for realistic image synthesis", IEEE CG&A 3(8), 1983, where
 * each ray ends below a fixed weight. The order depends on nothing but the sample's own rays. In
 * order of bound, nested glass took up to a third more rays.
 *
 * The rays of all samples of a wave share one pool.
 */
#ifndef STORMRING_TRACE_PENDING_H
#define STORMRING_TRACE_PENDING_H

#include "trace/trace_int.h"

/* A ray that is to be traced. */
struct pending {
    struct ray ray;
    double weight; /* share of this ray's light in the sample */
    double bound;  /* the most light that it can bring to the sample */
    uint64_t hops; /* rays before it in its tree: guarantees that a tree ends */
    int level;
    bool mirrored;  /* reflected, not transmitted */
    uint32_t media; /* the list of those that contain it */
};

/* When a sample has PENDING_MOST rays, further ones are traced depth first, so memory stays
 * bounded: a ray adds at most two, and the mirrored one is a level deeper. Only a sample that is
 * traced alone may have more. */
#define PENDING_MOST 65536
struct pending_pool {
    struct pending *at;
    struct media media;
    uint32_t *unused; /* indices of free entries: n_unused, the next one last */
    uint32_t n_unused, cap;
    uint32_t stack[TRACE_DEPTH_MAX + 2], n_stack;
};

/* One per sample. */
struct pending_rays {
    uint32_t *heap; /* indices into the pool, a binary heap by weight */
    uint32_t n, cap;
    double over; /* sum of the bounds - budget, when last computed, less the bounds of the rays
                  * traced since. Above 0: the sum still exceeds the budget */
};

void pending_pool_init(struct pending_pool *pool);
void pending_pool_free(struct pending_pool *pool);
/* Takes an entry from the pool, with no media. Pointers into the pool become invalid. */
uint32_t pending_new(struct pending_pool *pool);
/* Drops the ray's media as well. */
void pending_release(struct pending_pool *pool, uint32_t i);

void pending_push(struct pending_rays *p, struct pending_pool *pool, uint32_t i);
/* The ray to be traced next. There must be one. */
uint32_t pending_pop(struct pending_rays *p, struct pending_pool *pool);
/* True if no ray is left, or those that are left bring at most `budget` together: they are
 * released. A budget of 0 drops no ray. */
bool pending_end(struct pending_rays *p, struct pending_pool *pool, double budget);

#endif
