/* clock: clocks. */
#include "base/base.h"

#include <time.h>

static int64_t clock_us(clockid_t id)
{
    struct timespec t;
    if (clock_gettime(id, &t) != 0) die(ST_SYSTEM, "clock_gettime:");
    return (int64_t)t.tv_sec * 1000000 + t.tv_nsec / 1000;
}

static int64_t forgotten_us;

int64_t now_us(void) { return clock_us(CLOCK_MONOTONIC) - forgotten_us; }
void clock_forget(int64_t us) { forgotten_us += us; }
int64_t cpu_us(void) { return clock_us(CLOCK_PROCESS_CPUTIME_ID); }
