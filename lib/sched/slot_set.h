/*
 * Sets of slots, around the ring: bits in words of 64, and above each level one of a bit for each
 * word that is not empty, so that the next member is found in as many steps as there are levels.
 * The hub of the ring and deal keep who wants what in them.
 */
#ifndef STORMRING_SCHED_SLOT_SET_H
#define STORMRING_SCHED_SLOT_SET_H

#include "base/base.h"

#define SET_LEVELS 4
struct slot_set {
    uint64_t *level[SET_LEVELS];
    int32_t n; /* slots 0 .. n-1 may be members */
    int32_t count;
};
void set_init(struct slot_set *s, int32_t n); /* n <= 1 << 20 */
void set_free(struct slot_set *s);
bool set_has(const struct slot_set *s, int32_t k);
void set_put(struct slot_set *s, int32_t k, bool member);
/* The first member after k, or before it, around the ring, k itself the last; -1: it is empty. */
int32_t set_after(const struct slot_set *s, int32_t k);
int32_t set_before(const struct slot_set *s, int32_t k);

#endif
