/* kernel_avx2: the kernel at 256 bits; the Makefile compiles this file with -mavx2 where there is
 * such a thing. */
#ifdef __AVX2__
#include "volume/kernel.h"

const struct kernel *kernel_avx2(void) { return isa_available(ISA_AVX2) ? &table : NULL; }
#else
#include "volume/batch.h"

const struct kernel *kernel_avx2(void) { return 0; }
#endif
