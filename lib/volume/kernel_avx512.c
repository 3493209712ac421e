/* kernel_avx512: the kernel at 512 bits; the Makefile compiles this file with -mavx512f and others
 * where there are such things. */
#ifdef __AVX512F__
#include "volume/kernel.h"

const struct kernel *kernel_avx512(void) { return isa_available(ISA_AVX512) ? &table : NULL; }
#else
#include "volume/batch.h"

const struct kernel *kernel_avx512(void) { return 0; }
#endif
