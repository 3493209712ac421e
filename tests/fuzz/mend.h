/* What the fuzz targets that read records share: checks, and mutations that get past sums. */
#ifndef STORMRING_MEND_H
#define STORMRING_MEND_H

#include "coder/coder.h"
#include "wire/wire.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed);

#define MUST(x)                                                                                    \
    do {                                                                                           \
        if (!(x)) fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #x), abort();   \
    } while (0)

static uint8_t *find(uint8_t *at, const uint8_t *end, const char *text)
{
    const uint8_t *found =
        at < end ? text_find(at, (size_t)(end - at), text, strlen(text)) : NULL;
    return found ? at + (found - at) : NULL;
}

/* The line that ends in the first "sum=" at or after `at` gets the right one. */
static uint8_t *mend_sum(uint8_t *at, uint8_t *end)
{
    uint8_t *sum = find(at, end, " sum="), *begin = sum;
    char text[24];
    if (!sum || end - sum < 14) return NULL;
    while (begin > at && begin[-1] != '\n') begin--;
    snprintf(text, sizeof text, "%08lx", crc32(0, begin, (uInt)(sum - begin)));
    memcpy(sum + 5, text, 8);
    return sum + 13;
}

/* The number after the first `text` of the line [at, nl), or 0. */
static size_t number(uint8_t *at, const uint8_t *nl, const char *text)
{
    uint8_t *d = find(at, nl, text);
    size_t n = 0;
    for (d = d ? d + strlen(text) : NULL; d && d < nl && *d >= '0' && *d <= '9' && n < 1000000; d++)
        n = n * 10 + (size_t)(*d - '0');
    return n;
}

/* The crc of a body of n bytes as it is before it was packed, if it was. */
static unsigned long crc_of(uint8_t *at, uint8_t *nl, size_t n)
{
    size_t plain = number(at, nl, " plain=");
    unsigned char *out = xmalloc(plain ? plain : 1, 1);
    enum coder_form form = find(at, nl, "frag ")      ? CODER_PIXELS
                           : find(at, nl, " words=4") ? CODER_WORDS
                                                      : CODER_BYTES;
    bool packed = plain && coder_unpack(out, plain, form, nl + 1, n);
    unsigned long crc = crc32(0, packed ? out : nl + 1, (uInt)(packed ? plain : n));
    free(out);
    return crc;
}

/* The first "crc=" at or after `at` is made right for the body that the line announces. Where to
 * go on. */
static uint8_t *mend_crc(uint8_t *at, uint8_t *end)
{
    uint8_t *crc = find(at, end, "crc="), *bytes = find(at, end, "bytes=");
    if (!crc || !bytes) return NULL;
    uint8_t *nl = find(bytes, end, "\n"), *digits = crc + 4;
    size_t n = number(bytes, end, "bytes="), room = 0;
    uint8_t *line = crc;
    while (line > at && line[-1] != '\n') line--;
    while (digits + room < end && digits[room] >= '0' && digits[room] <= '9') room++;
    if (!nl || (size_t)(end - nl - 1) < n) return crc + 4;
    char text[24];
    snprintf(text, sizeof text, "%0*lu", (int)(room < 20 ? room : 20), crc_of(line, nl, n));
    if (strlen(text) == room) memcpy(digits, text, room);
    return nl + 1 + n;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    size = LLVMFuzzerMutate(data, size, most);
    for (uint8_t *at = data; at && seed % 4; at = mend_crc(at, data + size))
        ;
    for (uint8_t *at = data; at && seed % 4; at = mend_sum(at, data + size))
        ;
    return size;
}

#endif
