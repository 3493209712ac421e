/* The kernel with 512-bit vectors. On x86-64 the Makefile compiles this file with
 * -mavx512f and related flags. */
#ifdef __AVX512F__
#include "volume/kernel.h"

const struct kernel *volume_kernel_avx512(void)
{
    return isa_available(ISA_AVX512) ? &table : NULL;
}
#else
#include "volume/batch.h"

const struct kernel *volume_kernel_avx512(void) { return 0; }
#endif
