/* The kernel with 256-bit vectors. On x86-64 the Makefile compiles this file with
 * -mavx2. */
#ifdef __AVX2__
#include "volume/stream_ray.h"

stream_kernel *volume_kernel_avx2(void) { return isa_available(ISA_AVX2) ? rays : NULL; }
#else
#include "volume/stream.h"

stream_kernel *volume_kernel_avx2(void) { return NULL; }
#endif
