#include "sched/tournament.h"

#include <stdlib.h>

void tournament_init(struct tournament *t, int32_t n)
{
    t->n = 1;
    while (t->n < n) t->n *= 2;
    t->key = xmalloc(2 * (size_t)t->n, sizeof *t->key);
    for (int32_t i = 0; i < 2 * t->n; i++) t->key[i] = (double)INFINITY;
}

void tournament_free(struct tournament *t) { free(t->key); }

void tournament_set(struct tournament *t, int32_t k, double key)
{
    int32_t i = t->n + k;
    t->key[i] = key;
    while ((i /= 2) != 0) t->key[i] = fmin(t->key[2 * i], t->key[2 * i + 1]);
}

double tournament_key(const struct tournament *t, int32_t k) { return t->key[t->n + k]; }

/* The best slot below place i, or `best` (-1: none) if none there is better. Places with lesser
 * keys come first, so that few are looked at. */
static int32_t least_below(const struct tournament *t, int32_t i, int32_t best,
    bool (*may)(const void *context, int32_t k), const void *context)
{
    double most = best < 0 ? (double)INFINITY : tournament_key(t, best);
    if (!(t->key[i] < most)) return best;
    if (i >= t->n) return !may || may(context, i - t->n) ? i - t->n : best;
    int32_t first = 2 * i + (t->key[2 * i + 1] < t->key[2 * i]);
    best = least_below(t, first, best, may, context);
    return least_below(t, first ^ 1, best, may, context);
}

int32_t tournament_least(
    const struct tournament *t, bool (*may)(const void *context, int32_t k), const void *context)
{
    return least_below(t, 1, -1, may, context);
}
