/* The kernels with 512-bit vectors for packets and 256-bit vectors for nodes and blocks. On x86-64
 * the Makefile compiles this file with -mavx512f and related flags. */
#ifdef __AVX512F__
#include "trace/packet.h"

static const struct kernels table = {"avx512", closest, blocked, closest_packet, blocked_packet};

const struct kernels *trace_kernels_avx512(void)
{
    return isa_available(ISA_AVX512) ? &table : NULL;
}
#else
#include "trace/trace_int.h"

const struct kernels *trace_kernels_avx512(void) { return NULL; }
#endif
