/* The kernels with the vectors that every machine of this architecture has (SSE2 on
 * x86-64). */
#define SIMD_MOST 16
#include "trace/packet.h"

static const struct kernels table = {"sse2", closest, blocked, closest_packet, blocked_packet};

const struct kernels *trace_kernels_sse2(void) { return &table; }
