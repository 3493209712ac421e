/* Sets of slots: trees of bits with 64 children per node (van Emde Boas, 1977; fixed degree). */
#include "sched/slot_set.h"

#include <stdlib.h>

static size_t words(int32_t n, int level)
{
    for (int i = 0; i <= level; i++) n = (n + 63) / 64;
    return n > 0 ? (size_t)n : 1;
}

void set_init(struct slot_set *s, int32_t n)
{
    *s = (struct slot_set){.n = n};
    for (int i = 0; i < SET_LEVELS; i++) s->level[i] = xcalloc(words(n, i), sizeof **s->level);
}

void set_free(struct slot_set *s)
{
    for (int i = 0; i < SET_LEVELS; i++) free(s->level[i]);
}

bool set_has(const struct slot_set *s, int32_t k) { return s->level[0][k >> 6] >> (k & 63) & 1; }

void set_put(struct slot_set *s, int32_t k, bool member)
{
    if (set_has(s, k) == member) return;
    s->count += member ? 1 : -1;
    for (int i = 0; i < SET_LEVELS; i++, k >>= 6) {
        uint64_t *word = &s->level[i][k >> 6], bit = UINT64_C(1) << (k & 63);
        *word = member ? *word | bit : *word & ~bit;
        if (!member && *word) return;
    }
}

/* The first member at or after k; -1 if none. */
static int32_t upward(const struct slot_set *s, int32_t k)
{
    int i = 0;
    for (; i < SET_LEVELS; i++, k = (k >> 6) + 1) {
        if ((size_t)(k >> 6) >= words(s->n, i)) return -1;
        uint64_t word = s->level[i][k >> 6] >> (k & 63);
        if (!word) continue;
        k += __builtin_ctzll(word);
        break;
    }
    if (i == SET_LEVELS) return -1;
    while (i--) k = (k << 6) + __builtin_ctzll(s->level[i][k]);
    return k;
}

/* The last member at or before k; -1 if none. */
static int32_t downward(const struct slot_set *s, int32_t k)
{
    int i = 0;
    for (; i < SET_LEVELS; i++, k = (k >> 6) - 1) {
        if (k < 0) return -1;
        uint64_t word = s->level[i][k >> 6] << (63 - (k & 63));
        if (!word) continue;
        k -= __builtin_clzll(word);
        break;
    }
    if (i == SET_LEVELS) return -1;
    while (i--) k = (k << 6) + 63 - __builtin_clzll(s->level[i][k]);
    return k;
}

int32_t set_after(const struct slot_set *s, int32_t k)
{
    int32_t found = upward(s, k + 1);
    return found >= 0 ? found : upward(s, 0);
}

int32_t set_before(const struct slot_set *s, int32_t k)
{
    int32_t found = k > 0 ? downward(s, k - 1) : -1;
    return found >= 0 ? found : downward(s, s->n - 1);
}
