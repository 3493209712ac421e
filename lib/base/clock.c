/* clock: clocks and hashing. */
#include "base/base.h"

#include <string.h>
#include <time.h>

static int64_t clock_us(clockid_t id)
{
    struct timespec t;
    if (clock_gettime(id, &t) != 0) die(ST_SYSTEM, "clock_gettime:");
    return (int64_t)t.tv_sec * 1000000 + t.tv_nsec / 1000;
}

int64_t now_us(void) { return clock_us(CLOCK_MONOTONIC); }
int64_t cpu_us(void) { return clock_us(CLOCK_PROCESS_CPUTIME_ID); }

uint64_t hash64(uint64_t h, const void *p, size_t n)
{
    const unsigned char *at = p;
    for (size_t i = 0; i < n; i++) h = (h ^ at[i]) * UINT64_C(0x100000001b3);
    return h;
}

uint64_t hash64_u32(uint64_t h, const void *p, size_t n)
{
    const unsigned char *at = p;
    for (size_t i = 0; i < n; i++) {
        uint32_t v;
        memcpy(&v, at + i * sizeof v, sizeof v);
        for (int k = 0; k < 32; k += 8) h = hash64(h, &(unsigned char){(unsigned char)(v >> k)}, 1);
    }
    return h;
}
