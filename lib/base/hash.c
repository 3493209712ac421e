/*
 * hash: XXH64 (Y. Collet, "xxHash fast digest algorithm", specification 0.1.1, 2018). Four lanes of
 * 64 bits take 32 bytes a step, because scenes and grids are large. All numbers are read least
 * significant byte first: the same hash on all machines.
 */
#include "base/base.h"

#include <string.h>

#define P1 UINT64_C(0x9e3779b185ebca87)
#define P2 UINT64_C(0xc2b2ae3d27d4eb4f)
#define P3 UINT64_C(0x165667b19e3779f9)
#define P4 UINT64_C(0x85ebca77c2b2ae63)
#define P5 UINT64_C(0x27d4eb2f165667c5)

#define LITTLE (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)

static inline uint64_t rotated(uint64_t v, int by) { return v << by | v >> (64 - by); }

static inline uint64_t mixed(uint64_t lane, uint64_t in)
{
    return rotated(lane + in * P2, 31) * P1;
}

/* `words`: the bytes are 32-bit numbers of this machine. */
static inline uint32_t read_32(const unsigned char *at, bool words)
{
    uint32_t v;
    memcpy(&v, at, sizeof v);
    return words || LITTLE ? v : __builtin_bswap32(v);
}

static inline uint64_t read_64(const unsigned char *at, bool words)
{
    return read_32(at, words) | (uint64_t)read_32(at + 4, words) << 32;
}

static inline uint64_t hash(uint64_t seed, const unsigned char *at, size_t n, bool words)
{
    const unsigned char *end = at + n;
    uint64_t h = seed + P5;
    if (n >= 32) {
        uint64_t lane[4] = {seed + P1 + P2, seed + P2, seed, seed - P1};
        for (; end - at >= 32; at += 32)
            for (int i = 0; i < 4; i++) lane[i] = mixed(lane[i], read_64(at + 8 * i, words));
        h = rotated(lane[0], 1) + rotated(lane[1], 7) + rotated(lane[2], 12) + rotated(lane[3], 18);
        for (int i = 0; i < 4; i++) h = (h ^ mixed(0, lane[i])) * P1 + P4;
    }
    h += n;
    for (; end - at >= 8; at += 8) h = rotated(h ^ mixed(0, read_64(at, words)), 27) * P1 + P4;
    for (; end - at >= 4; at += 4) h = rotated(h ^ read_32(at, words) * P1, 23) * P2 + P3;
    for (; at < end; at++) h = rotated(h ^ *at * P5, 11) * P1;
    h = (h ^ h >> 33) * P2;
    h = (h ^ h >> 29) * P3;
    return h ^ h >> 32;
}

uint64_t hash64(uint64_t seed, const void *p, size_t n) { return hash(seed, p, n, false); }

uint64_t hash64_u32(uint64_t seed, const void *p, size_t n)
{
    return hash(seed, p, n * sizeof(uint32_t), true);
}
