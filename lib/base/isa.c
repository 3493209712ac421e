/* isa: the vector units that kernels are compiled for. */
#include "base/base.h"

#include <string.h>

bool isa_available(enum isa isa)
{
#ifdef __x86_64__
    return isa != ISA_AVX2 || __builtin_cpu_supports("avx2");
#else
    return isa != ISA_AVX2;
#endif
}

enum isa opt_isa(int opt, const char *s)
{
    enum isa isa = strcmp(s, "sse2") == 0 ? ISA_SSE2 : strcmp(s, "avx2") == 0 ? ISA_AVX2 : ISA_AUTO;
    if (isa == ISA_AUTO) die(ST_USAGE, "-%c %s: expected sse2 or avx2", opt, s);
    if (!isa_available(isa)) die(ST_USAGE, "-%c %s: not on this machine", opt, s);
    return isa;
}
