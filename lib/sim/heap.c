/* The event queue: a binary heap. */
#include "sim/heap.h"

#include <stdlib.h>

static bool before(const struct sim_key *a, const struct sim_key *b)
{
    return a->at_us != b->at_us ? a->at_us < b->at_us : a->order < b->order;
}

static void grow(struct sim_heap *h)
{
    size_t cap = h->cap ? 2 * h->cap : 256;
    h->at = xrealloc(h->at, cap, sizeof *h->at);
    h->bodies = xrealloc(h->bodies, cap, sizeof *h->bodies);
    for (; h->cap < cap; h->cap++) h->at[h->cap].body = h->cap;
}

void sim_heap_push(struct sim_heap *h, const struct sim_event *e)
{
    if (h->n == h->cap) grow(h);
    struct sim_key key = {e->at_us, h->order++, h->at[h->n].body};
    size_t i = h->n++;
    h->bodies[key.body] = *e;
    for (; i && before(&key, &h->at[(i - 1) / 2]); i = (i - 1) / 2) h->at[i] = h->at[(i - 1) / 2];
    h->at[i] = key;
}

bool sim_heap_pop(struct sim_heap *h, struct sim_event *e)
{
    if (!h->n) return false;
    size_t body = h->at[0].body, i = 0;
    *e = h->bodies[body];
    struct sim_key last = h->at[--h->n];
    for (size_t child; (child = 2 * i + 1) < h->n; i = child) {
        if (child + 1 < h->n && before(&h->at[child + 1], &h->at[child])) child++;
        if (!before(&h->at[child], &last)) break;
        h->at[i] = h->at[child];
    }
    h->at[i] = last;
    h->at[h->n].body = body;
    return true;
}

void sim_heap_free(struct sim_heap *h)
{
    free(h->at);
    free(h->bodies);
}
