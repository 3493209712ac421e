/* Checks pixels. It is called wherever a body is summed, so it must be cheap beside that. */
#include "wire/wire.h"

#include <float.h>
#include <string.h>

typedef float pixel __attribute__((vector_size(WIRE_PIXEL_BYTES)));
typedef int32_t lanes __attribute__((vector_size(WIRE_PIXEL_BYTES)));

static pixel load(const unsigned char *at)
{
    pixel p;
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    memcpy(&p, at, sizeof p);
#else
    float rgba[4];
    wire_pixels(at, 1, rgba);
    memcpy(&p, rgba, sizeof p);
#endif
    return p;
}

bool wire_light(const unsigned char *body, size_t n)
{
    const pixel least = {0, 0, 0, 0}, most = {FLT_MAX, FLT_MAX, FLT_MAX, 1};
    lanes good = {-1, -1, -1, -1};
    for (size_t i = 0; i + WIRE_PIXEL_BYTES <= n; i += WIRE_PIXEL_BYTES) {
        pixel p = load(body + i);
        good &= (p >= least) & (p <= most); /* both are false for NaN */
    }
    return good[0] & good[1] & good[2] & good[3];
}
