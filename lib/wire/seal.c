/* seal: checks the sum in which a line ends: wire_int.h. */
#include "wire/wire_int.h"

#include <string.h>

static int hex(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

bool wire_check_seal(const struct record *r, bool upward, char why[WIRE_WHY])
{
    if (!rec_sealed(r)) {
        if (!upward || r->kind == REC_HELLO || !memchr(r->line, ' ', r->line_len)) return true;
        return wire_fail(why, "no sum", "sum=HHHHHHHH at the end of the line (stormring-frag(5))");
    }
    size_t n = r->line_len - WIRE_SEAL_BYTES;
    uint32_t sum = 0;
    for (size_t i = r->line_len - 8; i < r->line_len; i++) {
        int v = hex(r->line[i]);
        if (v < 0) return wire_fail(why, "sum out of range", "8 hexadecimal digits");
        sum = sum << 4 | (uint32_t)v;
    }
    return sum == wire_crc(r->line, n) ? true
                                       : wire_fail(why, "sum differs", "the line that was sent");
}
