/*
 * The slot with the least key, while keys change: a tree in which each place holds the lesser key
 * of the two below it. The hub keeps nodes by the times that it expects.
 */
#ifndef STORMRING_SCHED_TOURNAMENT_H
#define STORMRING_SCHED_TOURNAMENT_H

#include "base/base.h"

struct tournament {
    double *key; /* 1 is the root, 2 i and 2 i + 1 are below i; the slots are the last n */
    int32_t n;   /* a power of two */
};

/* For slots 0 to n - 1, of which none takes part. Allocates, tournament_free frees. */
void tournament_init(struct tournament *t, int32_t n);
void tournament_free(struct tournament *t);
/* INFINITY: slot k does not take part. */
void tournament_set(struct tournament *t, int32_t k, double key);
double tournament_key(const struct tournament *t, int32_t k);
/* The slot with the least key that `may` allows (NULL: all), one of equals; -1: none. */
int32_t tournament_least(
    const struct tournament *t, bool (*may)(const void *context, int32_t k), const void *context);

#endif
