/* A tree of hubs: the nodes, level by level, and the room for them. */
#include "sim/tree.h"

#include <stdlib.h>

/* Adds n children of node i, from node `first` on. */
static void adopt(struct tree *t, int32_t i, int32_t first, int32_t n)
{
    t->nodes[i].first = first;
    t->nodes[i].n = n;
    for (int32_t k = 0; k < n; k++) {
        struct tree_node *child = &t->nodes[first + k];
        *child = (struct tree_node){.parent = i, .number = k};
    }
}

/* The first of n things, in equal parts, that belongs to part k of `parts`. */
static int32_t part(int32_t n, int32_t parts, int32_t k)
{
    return (int32_t)((int64_t)n * k / parts);
}

/* The number of hubs on each level is that of the groups so far, but no more than slots. */
static int32_t count_hubs(const struct sim_plan *p)
{
    int64_t level = 1, all = 1;
    for (size_t i = 0; i < p->levels; i++) {
        level *= p->groups[i];
        if (level > p->slots) level = p->slots;
        all += level;
    }
    return (int32_t)all;
}

void tree_build(struct tree *t)
{
    const struct sim_plan *p = t->plan;
    int32_t begin = 0, level = 1; /* hubs of the level above */
    t->n_hubs = count_hubs(p);
    t->nodes = xcalloc((size_t)t->n_hubs + (size_t)p->slots, sizeof *t->nodes);
    t->nodes[0].parent = -1;
    for (size_t i = 0; i <= p->levels; i++) {
        int64_t next = i == p->levels ? p->slots : (int64_t)level * p->groups[i];
        if (next > p->slots) next = p->slots;
        for (int32_t k = 0; k < level; k++) {
            int32_t from = part((int32_t)next, level, k), to = part((int32_t)next, level, k + 1);
            adopt(t, begin + k, begin + level + from, to - from);
        }
        begin += level;
        level = (int32_t)next;
    }
    t->hubs = xcalloc((size_t)t->n_hubs, sizeof *t->hubs);
    for (int32_t i = 0; i < t->n_hubs; i++) {
        t->hubs[i].state = t->policy->create(&p->params);
        t->hubs[i].wake_us = INT64_MAX;
    }
    t->workers = xcalloc((size_t)p->slots, sizeof *t->workers);
    for (int32_t k = 0; k < p->slots; k++) t->workers[k].clock = SIM_CLOCK_INIT;
    t->up = xcalloc(2 * (size_t)net_links(p), sizeof *t->up);
    t->down = t->up + net_links(p);
    t->committed = xcalloc((size_t)p->tasks, sizeof *t->committed);
    coverage_init(&t->sent, p->work->frame_w, p->work->frame_h);
}

void tree_close(struct tree *t)
{
    for (int32_t i = 0; i < t->n_hubs; i++) t->policy->destroy(t->hubs[i].state);
    for (int32_t k = 0; k < t->plan->slots; k++) free(t->workers[k].queue.at);
    coverage_free(&t->sent);
    free(t->committed);
    free(t->up);
    free(t->workers);
    free(t->hubs);
    free(t->nodes);
    sim_heap_free(&t->heap);
    free(t->acts.at);
}
