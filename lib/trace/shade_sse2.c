/* The shaders with the vectors that every machine of this architecture has (SSE2 on x86-64). */
#define SIMD_MOST 16
#include "trace/shade_impl.h"

const struct shaders *trace_shaders_sse2(void) { return &shaders; }
