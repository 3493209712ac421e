/* The event queue: a binary heap. */
#include "sim/heap.h"

static bool before(const struct sim_event *a, const struct sim_event *b)
{
    return a->at_us != b->at_us ? a->at_us < b->at_us : a->order < b->order;
}

void heap_push(struct sim_heap *h, struct sim_event e)
{
    if (h->n == h->cap) {
        h->cap = h->cap ? 2 * h->cap : 256;
        h->at = xrealloc(h->at, h->cap, sizeof *h->at);
    }
    e.order = h->order++;
    size_t i = h->n++;
    for (; i && before(&e, &h->at[(i - 1) / 2]); i = (i - 1) / 2) h->at[i] = h->at[(i - 1) / 2];
    h->at[i] = e;
}

bool heap_pop(struct sim_heap *h, struct sim_event *e)
{
    if (!h->n) return false;
    *e = h->at[0];
    struct sim_event last = h->at[--h->n];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < h->n; i = child) {
        if (child + 1 < h->n && before(&h->at[child + 1], &h->at[child])) child++;
        if (!before(&h->at[child], &last)) break;
        h->at[i] = h->at[child];
    }
    if (h->n) h->at[i] = last;
    return true;
}
