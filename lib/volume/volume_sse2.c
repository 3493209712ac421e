/* The kernel with 128-bit vectors, or the compiler's replacement for them. */
#include "volume/kernel.h"

const struct kernel *volume_kernel_sse2(void) { return &table; }
