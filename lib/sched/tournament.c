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

static bool equal(double a, double b) { return !(a < b) && !(a > b); }

void tournament_set(struct tournament *t, int32_t k, double key)
{
    double *at = t->key;
    for (int32_t i = t->n + k; i && !equal(at[i], key);) {
        at[i] = key;
        if ((i /= 2) != 0) key = fmin(at[2 * i], at[2 * i + 1]);
    }
}

double tournament_key(const struct tournament *t, int32_t k) { return t->key[t->n + k]; }

double tournament_top(const struct tournament *t) { return t->key[1]; }

/* May the best slot below place i be better than `best` (-1: none)? */
static bool may_win(
    const struct tournament *t, int32_t i, int32_t best, const struct tournament_filter *f)
{
    double most = best < 0 ? (double)INFINITY : tournament_key(t, best);
    if (f && f->under && !(f->under->key[i] < f->limit)) return false;
    if (best < 0 || !equal(t->key[i], most)) return t->key[i] < most;
    while (i < t->n) i *= 2; /* the lowest slot below it */
    return i - t->n < best;
}

/* The best slot below place i, or `best` if none there is better. Places with lesser keys come
 * first, so that few are looked at. */
static int32_t least_below(
    const struct tournament *t, int32_t i, int32_t best, const struct tournament_filter *f)
{
    if (!may_win(t, i, best, f)) return best;
    if (i >= t->n) return !f || !f->may || f->may(f->context, i - t->n) ? i - t->n : best;
    int32_t first = 2 * i + (t->key[2 * i + 1] < t->key[2 * i]);
    best = least_below(t, first, best, f);
    return least_below(t, first ^ 1, best, f);
}

int32_t tournament_least(const struct tournament *t, const struct tournament_filter *filter)
{
    return least_below(t, 1, -1, filter);
}
