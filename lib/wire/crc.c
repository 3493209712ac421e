/* The sums of records: crc of a body, sum of a line. */
#include "wire/wire.h"

#include <string.h>
#include <zlib.h>

uint32_t wire_crc(const void *p, size_t n)
{
    return (uint32_t)crc32(crc32(0, NULL, 0), p, (uInt)n);
}

void wire_seal(struct buf *b, size_t at)
{
    static const char hex[] = "0123456789abcdef";
    char seal[] = " sum=01234567\n";
    const unsigned char *line = buf_data(b) + at;
    size_t n = buf_size(b) - at;
    uint32_t sum = wire_crc(line, n);
    for (int i = 0; i < 8; i++) seal[5 + i] = hex[sum >> (28 - 4 * i) & 15];
    if (memchr(line, ' ', n)) buf_append(b, seal, sizeof seal - 1);
    else buf_append(b, "\n", 1);
}
