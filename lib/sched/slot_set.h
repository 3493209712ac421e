/*
 * Sets of slots in ring order. Each level is an array of 64-bit words; a bit of the level above is
 * set if the word below is not empty. Finding the next member takes as many steps as there are
 * levels. The hub and deal keep the slots that want work, or have some, in these sets.
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
void set_init(struct slot_set *s, int32_t n); /* n <= 1 << 20; allocates, set_free frees */
void set_free(struct slot_set *s);
bool set_has(const struct slot_set *s, int32_t k);
void set_put(struct slot_set *s, int32_t k, bool member);
/* The next member after k, or the last before it, in ring order; k itself comes last. -1: empty. */
int32_t set_after(const struct slot_set *s, int32_t k);
int32_t set_before(const struct slot_set *s, int32_t k);

#endif
