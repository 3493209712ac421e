/* pending: the heap and the pool of pending.h. */
#include "trace/pending.h"

#include <stdlib.h>

void pending_pool_init(struct pending_pool *pool)
{
    *pool = (struct pending_pool){.cap = 2 * WAVE_RAYS};
    pool->at = xmalloc(pool->cap, sizeof *pool->at);
    pool->unused = xmalloc(pool->cap, sizeof *pool->unused);
    while (pool->n_unused < pool->cap) {
        pool->unused[pool->n_unused] = pool->cap - 1 - pool->n_unused;
        pool->n_unused++;
    }
}

void pending_pool_free(struct pending_pool *pool)
{
    free(pool->at);
    media_free(&pool->media);
    free(pool->unused);
}

uint32_t pending_new(struct pending_pool *pool)
{
    if (!pool->n_unused) {
        uint32_t more = pool->cap;
        pool->cap += more;
        pool->at = xrealloc(pool->at, pool->cap, sizeof *pool->at);
        pool->unused = xrealloc(pool->unused, pool->cap, sizeof *pool->unused);
        for (; pool->n_unused < more; pool->n_unused++)
            pool->unused[pool->n_unused] = pool->cap - 1 - pool->n_unused;
    }
    uint32_t i = pool->unused[--pool->n_unused];
    pool->at[i].media = 0;
    return i;
}

void pending_release(struct pending_pool *pool, uint32_t i)
{
    media_drop(&pool->media, pool->at[i].media);
    pool->unused[pool->n_unused++] = i;
}

void pending_push(struct pending_rays *p, struct pending_pool *pool, uint32_t i)
{
    if (p->n >= PENDING_MOST) {
        pool->stack[pool->n_stack++] = i;
        return;
    }
    if (p->n == p->cap) {
        p->cap = p->cap ? 2 * p->cap : 8;
        p->heap = xrealloc(p->heap, p->cap, sizeof *p->heap);
    }
    uint32_t k = p->n++;
    for (uint32_t up; k > 0 && pool->at[p->heap[up = (k - 1) / 2]].weight < pool->at[i].weight;
         k = up)
        p->heap[k] = p->heap[up];
    p->heap[k] = i;
}

uint32_t pending_pop(struct pending_rays *p, struct pending_pool *pool)
{
    if (pool->n_stack) return pool->stack[--pool->n_stack];
    uint32_t top = p->heap[0], last = p->heap[--p->n], k = 0;
    p->over -= pool->at[top].bound;
    for (;;) {
        uint32_t down = 2 * k + 1;
        if (down >= p->n) break;
        if (down + 1 < p->n && pool->at[p->heap[down + 1]].weight > pool->at[p->heap[down]].weight)
            down++;
        if (!(pool->at[p->heap[down]].weight > pool->at[last].weight)) break;
        p->heap[k] = p->heap[down];
        k = down;
    }
    p->heap[k] = last;
    return top;
}

bool pending_end(struct pending_rays *p, struct pending_pool *pool, double budget)
{
    if (!p->n && !pool->n_stack) return true;
    if (budget <= 0 || pool->n_stack || p->over > 0) return false;
    p->over = -budget;
    for (uint32_t i = 0; i < p->n; i++) p->over += pool->at[p->heap[i]].bound;
    if (p->over > 0) return false;
    while (p->n) pending_release(pool, p->heap[--p->n]);
    return true;
}
