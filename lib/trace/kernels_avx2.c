/* kernels_avx2: the kernels at 256 bits; the Makefile compiles this file with -mavx2 where there
 * is such a thing. */
#ifdef __AVX2__
#include "trace/packet.h"

static const struct kernels table = {"avx2", closest, blocked, closest_packet, blocked_packet};

const struct kernels *kernels_avx2(void) { return isa_available(ISA_AVX2) ? &table : NULL; }
#else
#include "trace/trace_int.h"

const struct kernels *kernels_avx2(void) { return NULL; }
#endif
