/* The kernel with 512-bit vectors. On x86-64 the Makefile compiles this file with
 * -mavx512f and related flags. */
#ifdef __AVX512F__
#include "volume/stream_ray.h"

stream_kernel *volume_kernel_avx512(void) { return isa_available(ISA_AVX512) ? rays : NULL; }
#else
#include "volume/stream.h"

stream_kernel *volume_kernel_avx512(void) { return NULL; }
#endif
