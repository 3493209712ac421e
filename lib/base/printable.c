/* printable: text of files and of other programs, as it may be shown. */
#include "base/base.h"

#include <string.h>

/* The bits and the least value of a character whose first byte c says that it has k bytes. */
static uint32_t first_bits(unsigned char c, size_t k, uint32_t *least)
{
    static const uint32_t of[] = {0, 0, 0x80, 0x800, 0x10000};
    *least = of[k];
    return c & (0x7fu >> k);
}

size_t utf8_shown(const void *text, size_t n)
{
    const unsigned char *s = text;
    uint32_t least;
    if (!n) return 0;
    if (*s < 0x80) return *s >= ' ' && *s != 0x7f;
    const size_t k = *s >= 0xf0 && *s < 0xf8 ? 4 : *s >= 0xe0 ? 3 : *s >= 0xc2 ? 2 : 0;
    if (!k || *s >= 0xf8 || k > n) return 0;
    uint32_t c = first_bits(*s, k, &least);
    for (size_t i = 1; i < k; i++) {
        if ((s[i] & 0xc0) != 0x80) return 0;
        c = c << 6 | (s[i] & 0x3fu);
    }
    const bool surrogate = c >= 0xd800 && c < 0xe000, control = c < 0xa0 || (c | 1) == 0xffff;
    return c < least || c > 0x10ffff || surrogate || control ? 0 : k;
}

size_t text_shown(char *out, size_t room, const char *s)
{
    size_t at = 0;
    for (size_t n = strlen(s), k; n; s += k, n -= k) {
        char hex[8];
        const size_t good = utf8_shown(s, n), bytes = good ? good : 4;
        k = good ? good : 1;
        if (at + bytes >= room) break;
        snprintf(hex, sizeof hex, "\\x%02x", (unsigned char)*s);
        memcpy(out + at, good ? s : hex, bytes);
        at += bytes;
    }
    out[at] = '\0';
    return at;
}
