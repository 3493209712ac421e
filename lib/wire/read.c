/* Reading a descriptor to its end. */
#include "wire/wire.h"

#include <errno.h>
#include <string.h>

#define READ_BYTES 65536

int wire_read(int fd, wire_taker *take, void *ctx, char why[WIRE_WHY])
{
    struct decoder d = {0};
    struct record r;
    enum wire_result got = WIRE_MORE;
    ptrdiff_t n;
    do {
        n = read_some(fd, &d.in, READ_BYTES);
        if (n == 0) wire_end(&d);
        while (n >= 0 && (got = wire_next(&d, &r)) == WIRE_RECORD) take(ctx, &r);
    } while (n > 0 && got != WIRE_BAD);
    int err = errno;
    if (got == WIRE_BAD) memcpy(why, d.why, WIRE_WHY);
    wire_free(&d);
    errno = err;
    return n < 0 ? -1 : got == WIRE_BAD;
}
