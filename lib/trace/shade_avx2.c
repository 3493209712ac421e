/* The shaders with 256-bit vectors. On x86-64 the Makefile compiles this file with -mavx2. */
#ifdef __AVX2__
#define SIMD_MOST 32
#include "trace/shade_impl.h"

const struct shaders *trace_shaders_avx2(void) { return isa_available(ISA_AVX2) ? &shaders : NULL; }
#else
#include "trace/shade.h"

const struct shaders *trace_shaders_avx2(void) { return NULL; }
#endif
