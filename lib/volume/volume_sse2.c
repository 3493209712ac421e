/* The kernel with 128-bit vectors, or the compiler's replacement for them. */
#include "volume/stream_ray.h"

stream_kernel *volume_kernel_sse2(void) { return rays; }
