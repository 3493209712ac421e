#include "sched/refuse.h"

#include "base/base.h"

#include <stdlib.h>

void refuse_free(struct refusals *r) { free(r->slots); }

/* Slot k refuses generations equal to g no longer. */
static void take_back(struct refusals *r, uint32_t g, int32_t k)
{
    if (!refuse_is(r, g, k)) return;
    r->slots[k].of[g / 64] &= ~(UINT64_C(1) << g % 64);
    r->at[g].n--;
    r->n--;
}

void refuse_begin(struct refusals *r, uint32_t generation)
{
    struct refused *at = &r->at[generation % GENERATIONS];
    if (at->generation == generation) return;
    at->generation = generation;
    for (int32_t k = 0; at->n && k < r->n_slots; k++) take_back(r, generation % GENERATIONS, k);
}

void refuse_add(struct refusals *r, uint32_t generation, int32_t k)
{
    const uint32_t g = generation % GENERATIONS;
    if (r->at[g].generation != generation || refuse_is(r, g, k)) return;
    if (k >= r->n_slots) {
        const int32_t n = k < 2 * r->n_slots ? 2 * r->n_slots : k + 1;
        r->slots = xrealloc(r->slots, (size_t)n, sizeof *r->slots);
        while (r->n_slots < n) r->slots[r->n_slots++] = (struct refuser){{0}};
    }
    r->slots[k].of[g / 64] |= UINT64_C(1) << g % 64;
    r->at[g].n++;
    r->n++;
}

void refuse_end(struct refusals *r, int32_t k)
{
    for (uint32_t g = 0; r->n && g < GENERATIONS; g++) take_back(r, g, k);
}

bool refuse_any(const struct refusals *r, int32_t k)
{
    uint64_t any = 0;
    for (int i = 0; k < r->n_slots && i < GENERATIONS / 64; i++) any |= r->slots[k].of[i];
    return any;
}

bool refuse_settle(struct refusals *r, int32_t up, int64_t now, uint32_t *generation)
{
    for (int g = 0; (r->n || r->n_all) && g < GENERATIONS; g++) {
        struct refused *at = &r->at[g];
        const bool all = at->n && at->n == up;
        if (all == at->all) continue;
        at->all = all;
        r->n_all += all ? 1 : -1;
        at->since_us = now;
        *generation = at->generation;
        return true;
    }
    return false;
}
