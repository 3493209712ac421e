/*
 * The slot with the least key, while keys change: tree selection (D. E. Knuth, "The Art of Computer
 * Programming" vol. 3, 5.2.3). Each place of the tree holds the lesser key of the two below it.
 * deal keeps slots by the time at which they need a task, the hub nodes by when they will end.
 */
#ifndef STORMRING_SCHED_TOURNAMENT_H
#define STORMRING_SCHED_TOURNAMENT_H

#include "base/base.h"

struct tournament {
    double *key; /* 1 is the root, 2 i and 2 i + 1 are below i; the slots are the last n */
    int32_t n;   /* a power of two */
};
/* Which slots may be found. All zero: each one. */
struct tournament_filter {
    const struct tournament *under; /* those whose key there, of as many slots, is below limit */
    double limit;
    bool (*may)(const void *context, int32_t k); /* those that this allows */
    const void *context;
};

/* For slots 0 to n - 1, of which none takes part. Allocates, tournament_free frees. */
void tournament_init(struct tournament *t, int32_t n);
void tournament_free(struct tournament *t);
/* INFINITY: slot k does not take part. */
void tournament_set(struct tournament *t, int32_t k, double key);
double tournament_key(const struct tournament *t, int32_t k);
/* The least key of all. */
double tournament_top(const struct tournament *t);
/* The slot with the least key that passes the filter (NULL: all do), the lowest of equals; -1:
 * none. Takes a time logarithmic in n, unless `may` refuses slots. */
int32_t tournament_least(const struct tournament *t, const struct tournament_filter *filter);

#endif
