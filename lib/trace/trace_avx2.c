/* The kernels with 256-bit vectors. On x86-64 the Makefile compiles this file with
 * -mavx2. */
#ifdef __AVX2__
#include "trace/packet.h"

static const struct kernels table = {"avx2", closest, blocked, closest_packet, blocked_packet};

const struct kernels *trace_kernels_avx2(void) { return isa_available(ISA_AVX2) ? &table : NULL; }
#else
#include "trace/trace_int.h"

const struct kernels *trace_kernels_avx2(void) { return NULL; }
#endif
