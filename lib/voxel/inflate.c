/* inflate: zlib and gzip, no more than is wanted. */
#include "voxel/voxel_int.h"

#include <zlib.h>

#define PIECE (1U << 20) /* bytes that are unpacked at a time: a header that lies costs no more */

/* The next piece: begins again where one gzip file follows another. False at the end, or where the
 * bytes are damaged. */
static bool next_piece(z_stream *z, size_t *left)
{
    const uInt some = *left < PIECE ? (uInt)*left : PIECE;
    z->avail_in = some;
    const int rc = inflate(z, Z_NO_FLUSH);
    *left -= some - z->avail_in;
    if (rc == Z_STREAM_END) return *left && inflateReset(z) == Z_OK;
    return rc == Z_OK && (z->avail_in < some || !z->avail_out);
}

uint64_t voxel_inflate(
    const unsigned char *p, size_t n, uint64_t skip, uint64_t want, struct buf *out)
{
    z_stream z = {.next_in = (z_const Bytef *)(uintptr_t)p};
    uint64_t done = 0;
    if (inflateInit2(&z, 15 + 32) != Z_OK) die(ST_SYSTEM, "no memory to unpack");
    for (bool more = true; more && done < want;) {
        const uint64_t most = skip ? skip : want - done;
        const uInt room = most < PIECE ? (uInt)most : PIECE;
        z.next_out = buf_reserve(out, room);
        z.avail_out = room;
        more = next_piece(&z, &n);
        const uInt got = room - z.avail_out;
        if (skip) skip -= got;
        else done += got, out->len += got;
    }
    inflateEnd(&z);
    return done;
}
