/* isa: the vector units that kernels are compiled for. */
#include "base/base.h"

#include <string.h>

bool isa_available(enum isa isa)
{
#ifdef __x86_64__
    bool avx2 = __builtin_cpu_supports("avx2");
    bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
#else
    bool avx2 = false, avx512 = false;
#endif
    return isa == ISA_AVX512 ? avx512 : isa == ISA_AVX2 ? avx2 : true;
}

enum isa opt_isa(int opt, const char *s)
{
    static const char *const names[] = {
        [ISA_SSE2] = "sse2", [ISA_AVX2] = "avx2", [ISA_AVX512] = "avx512"};
    enum isa isa = ISA_AVX512;
    while (isa != ISA_AUTO && strcmp(s, names[isa]) != 0) isa--;
    if (isa == ISA_AUTO) die(ST_USAGE, "-%c %s: expected sse2, avx2 or avx512", opt, s);
    if (!isa_available(isa))
        die(ST_USAGE, "-%c %s: this processor does not have it, expected another", opt, s);
    return isa;
}
