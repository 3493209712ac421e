/* The kernel with 256-bit vectors. On x86-64 the Makefile compiles this file with
 * -mavx2. */
#ifdef __AVX2__
#include "volume/kernel.h"

const struct kernel *volume_kernel_avx2(void) { return isa_available(ISA_AVX2) ? &table : NULL; }
#else
#include "volume/batch.h"

const struct kernel *volume_kernel_avx2(void) { return 0; }
#endif
