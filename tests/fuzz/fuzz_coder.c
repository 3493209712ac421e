/*
 * Whatever the bytes: unpacking writes nothing beyond its room, and what is packed comes back as it
 * was. The first byte of an input is the form, the next two are the length that is expected.
 */
#include "coder/coder.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MUST(x)                                                                                    \
    do {                                                                                           \
        if (!(x)) fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #x), abort();   \
    } while (0)

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < 3) return 0;
    enum coder_form form = (enum coder_form)(data[0] % 3);
    size_t plain = data[1] | (size_t)data[2] << 8;
    const uint8_t *p = data + 3;
    size -= 3;
    unsigned char *out = xmalloc(plain ? plain : 1, 1);
    bool good = coder_unpack(out, plain, form, p, size);
    MUST(!good || (size < plain && size * CODER_RATIO_MAX >= plain));
    free(out);
    struct buf b = {0};
    if (coder_pack(&b, form, p, size)) {
        MUST(buf_size(&b) < size);
        out = xmalloc(size, 1);
        MUST(coder_unpack(out, size, form, buf_data(&b), buf_size(&b)));
        MUST(memcmp(out, p, size) == 0);
        free(out);
    }
    buf_free(&b);
    return 0;
}
